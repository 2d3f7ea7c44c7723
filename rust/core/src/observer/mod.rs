//! Observers of the external torque.

mod momentum_observer;

pub use momentum_observer::MomentumObserver;
