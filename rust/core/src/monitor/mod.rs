//! The pipeline: one call a control tick.

mod bias;
mod clock;
mod contact_monitor;
mod options;
mod report;
mod sensing;
mod settings;

pub use contact_monitor::ContactMonitor;
pub use options::MonitorOptions;
pub use report::ContactReport;
