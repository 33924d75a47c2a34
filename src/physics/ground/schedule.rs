//! In which order which parts turn, how far, and how smoothly.

use crate::physics::ground::parts::Part;

/// One step of a schedule.
#[derive(Clone, Debug, PartialEq)]
pub struct Step {
    /// Turn, all by one angle.
    pub turned: Vec<Part>,
    /// Are carried by what turns, without being turned.
    pub carried: Vec<Part>,
    /// Width of the kernel that smooths the displacement, frames at 30 fps.
    pub width: f64,
    /// Share of the turn that is done, 0 to 1.
    pub share: f64,
    /// Turns are no larger than this, radians.
    pub largest_turn: f64,
}

/// Largest turn of a step but for arms, radians.
const LARGEST_TURN: f64 = 0.5;
/// Largest turn of arms, radians: a lever of 1 to 3 cm moves the point nowhere far.
const LARGEST_TURN_OF_ARMS: f64 = 0.15;

impl Step {
    /// Legs and pelvis turn about where the point is to be and carry the rest.
    pub fn lower() -> Self {
        Self {
            turned: vec![Part::Lower],
            carried: vec![Part::Upper],
            width: 40.0,
            share: 0.5,
            largest_turn: LARGEST_TURN,
        }
    }

    /// All above the pelvis turns.
    pub fn upper() -> Self {
        Self {
            turned: vec![Part::Upper],
            carried: Vec::new(),
            width: 20.0,
            share: 0.3,
            largest_turn: LARGEST_TURN,
        }
    }

    /// Arms turn about the shoulders.
    pub fn arms() -> Self {
        Self {
            turned: vec![Part::Arms],
            carried: Vec::new(),
            width: 10.0,
            share: 0.2,
            largest_turn: LARGEST_TURN_OF_ARMS,
        }
    }
}

/// Lower body, upper body, arms: for walks and runs on the level.
pub fn level() -> Vec<Step> {
    vec![Step::lower(), Step::upper(), Step::arms()]
}

/// The first two swapped: for slopes.
pub fn uphill() -> Vec<Step> {
    vec![Step::upper(), Step::lower(), Step::arms()]
}

/// Five steps of the lower body, five of the upper, two of the arms: of the paper's figure 9.
pub fn five_five_two() -> Vec<Step> {
    let steps = [(Step::lower(), 5), (Step::upper(), 5), (Step::arms(), 2)];
    steps.into_iter().flat_map(|(step, times)| std::iter::repeat_n(step, times)).collect()
}
