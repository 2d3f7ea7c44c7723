//! Observers of the external torque.

mod momentum_observer;
mod step;

pub use momentum_observer::MomentumObserver;
pub(crate) use step::{check_time_step, Step, LONGEST_STEP};
