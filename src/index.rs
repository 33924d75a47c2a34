//! Index types: a frame, a joint or a character is not a bare number.

/// Defines one index type over `u32` with conversions to and from per-item storage.
macro_rules! index {
    ($(#[$doc:meta])* $name:ident) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub struct $name(pub u32);

        impl $name {
            /// Position in per-item storage.
            pub const fn as_usize(self) -> usize {
                self.0 as usize
            }

            /// Index of position `position` in per-item storage.
            ///
            /// # Panics
            /// Above `u32::MAX`, more items than fit in memory.
            pub fn from_usize(position: usize) -> Self {
                Self(u32::try_from(position).expect("fewer than 2^32 items fit in memory"))
            }
        }
    };
}

index! {
    /// Working frame of a path or track, counted from 0 at its first frame; frames are `h` = 1/30 s apart at rest.
    FrameIndex
}
index! {
    /// Frame of a clip's file, counted from 0.
    SourceFrame
}
index! {
    /// Joint of a skeleton; parents come before their children, 0 is the root.
    JointId
}
index! {
    /// Frame of a motion graph: the working frames of its clips, one clip after another.
    GraphFrame
}
index! {
    /// Clip of a scene, in the order of its `[clips]` table.
    ClipId
}
index! {
    /// Character of a scene, in the order of the file.
    CharacterId
}
index! {
    /// Object of a scene, in the order of the file.
    ObjectId
}
index! {
    /// Constraint of a scene, in the order of [`crate::scene::Scene::constraints`].
    ConstraintId
}

/// Largest whole number at or below `value`, as a position in storage; negative values and NaN give 0.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "the cast saturates, which is what is documented"
)]
pub fn floor_index(value: f64) -> usize {
    // Above 0 the cast rounds down by itself.
    value.max(0.0) as usize
}
