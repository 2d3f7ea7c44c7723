//! The pipeline: one call a control tick.

mod bias;
mod clock;
mod contact_monitor;
mod external;
mod judgement;
mod limits;
mod options;
mod payload;
mod payload_fit;
mod payload_proposal;
mod recent_motion;
mod report;
mod rest_readings;
mod sensing;
mod settings;
mod source;
mod tare;

pub use contact_monitor::ContactMonitor;
pub use options::MonitorOptions;
pub use payload_proposal::PayloadProposal;
pub use report::ContactReport;
