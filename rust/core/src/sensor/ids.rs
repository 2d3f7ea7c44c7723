//! Indices of sensors.

use crate::robot::ids::index;

index! {
    /// Which of the sensors that an object was made with, in their order.
    ///
    /// ```
    /// use contactsense::sensor::SensorIndex;
    ///
    /// let sensors = ["left wrist", "right wrist"];
    /// assert_eq!(sensors[SensorIndex::new(1).get()], "right wrist");
    /// ```
    SensorIndex
}
