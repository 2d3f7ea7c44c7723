//! Indices of bodies and links, each of a type of its own, so that one cannot be taken for the other.

/// Declares the type of an index.
macro_rules! index {
    ($(#[$doc:meta])* $name:ident) => {
        $(#[$doc])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
        #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
        pub struct $name(usize);

        impl $name {
            /// From a number, the first is 0.
            pub const fn new(index: usize) -> Self {
                Self(index)
            }

            /// The number.
            #[inline]
            pub const fn get(self) -> usize {
                self.0
            }
        }
    };
}
pub(crate) use index;

impl BodyIndex {
    /// What does not move.
    pub const WORLD: BodyIndex = BodyIndex(0);
}

index! {
    /// Which body of a robot: 0 is the world, k the one that the k-th joint moves.
    ///
    /// ```
    /// use contactsense::robot::{BodyIndex, Kinematics, Robot};
    ///
    /// let robot = Robot::example_arm();
    /// let body = robot[robot.link("link_3")?].body();
    /// assert_eq!((BodyIndex::WORLD.get(), body), (0, BodyIndex::new(3)));
    /// let mut kinematics = Kinematics::new(&robot);
    /// kinematics.set_configuration(&robot, &[0.0; 7]);
    /// assert!((kinematics[body].position.z - 0.6).abs() < 1e-12);
    /// # Ok::<(), contactsense::Error>(())
    /// ```
    BodyIndex
}

index! {
    /// Which of [`Robot::links`](super::Robot::links).
    ///
    /// ```
    /// use contactsense::robot::{LinkIndex, Robot};
    ///
    /// let robot = Robot::example_arm();
    /// let link = robot.link("link_3")?;
    /// assert_eq!((link, robot[link].name.as_str()), (LinkIndex::new(2), "link_3"));
    /// # Ok::<(), contactsense::Error>(())
    /// ```
    LinkIndex
}
