//! Observers of the external torque and of the wrenches on force/torque sensors.

mod bank;
mod momentum_observer;
mod order;
mod step;
mod wrench_observer;

pub(crate) use bank::ObserverBank;
pub use momentum_observer::MomentumObserver;
pub(crate) use order::Order;
pub(crate) use step::Step;
pub(crate) use wrench_observer::WrenchObserver;
