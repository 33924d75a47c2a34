//! Hands and feet where they must be: the poses of an edited track corrected frame by frame.

pub mod displacement;
pub mod limb;
