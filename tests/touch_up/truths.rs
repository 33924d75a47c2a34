//! How far captured performers lean.

use std::path::Path;

use libtest_mimic::Failed;

use crate::lean::{Strides, balancing, left, mean};
use crate::performer::{Edited, load};
use crate::{WALK, tell};

/// Into the speed-up, or into the curve: how far, and how far physics asks.
const LEANS: [(&str, Direction); 4] = [
    (WALK, Direction::Inwards),
    ("amc/cmu_16_13_walk_veer_right.amc", Direction::Inwards),
    ("bvh/snu_spiral_walk_normal.bvh", Direction::Inwards),
    ("amc/cmu_127_04_walk_to_run_transition.amc", Direction::Ahead),
];

#[derive(Clone, Copy, Debug, PartialEq)]
enum Direction {
    Ahead,
    Inwards,
}

pub(crate) fn leans(folder: &Path, _: &str) -> Result<(), Failed> {
    for (file, direction) in LEANS {
        let capture = Edited::untouched(&load(folder, file)?);
        let strides = Strides::of(&capture.clip, &capture.body, capture.stride());
        // A quarter of a second of slack for the differences.
        let frames = strides.frames(capture.stride() / 4);
        let towards = |frame: usize| {
            let ahead = strides.ahead(frame);
            let aside = left(ahead) * strides.acceleration(frame).dot(left(ahead)).signum();
            if direction == Direction::Ahead { ahead } else { aside }
        };
        let lean = mean(frames.clone().map(|frame| strides.lean(frame, towards(frame)))).to_degrees();
        let asked =
            mean(frames.clone().map(|frame| balancing(strides.acceleration(frame).dot(towards(frame)))))
                .to_degrees();
        tell(&format!("{file}: leans {lean:.1} degrees, balanced at {asked:.1} ({frames:?}, {direction:?})"));
        if !(lean.is_finite() && asked.is_finite()) {
            return Err(format!("{file}: {lean}, {asked}").into());
        }
    }
    Ok(())
}
