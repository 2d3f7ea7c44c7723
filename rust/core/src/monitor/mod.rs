//! The pipeline: one call a control tick.

mod bias;
mod contact_monitor;
mod release;
mod sensing;

pub use bias::BiasTracker;
pub use contact_monitor::{ContactMonitor, ContactReport, MonitorOptions};
pub use release::ReleaseDetector;
