//! Foot contacts, flights and stationary stretches of a clip.

/// Which points of the feet bear on the ground in one frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[expect(missing_docs, reason = "the names say it")]
pub struct FootContacts {
    pub left_heel: bool,
    pub left_toe: bool,
    pub right_heel: bool,
    pub right_toe: bool,
}
