//! How far captured performers lean: to the side that edits of straight walks are made to lean to, where tests of these ask for a share
//! above 0 of the same figure.

use std::path::Path;

use libtest_mimic::Failed;

use crate::lean::{Strides, balancing, left, mean};
use crate::performance::{load, verdict};
use crate::performer::Edited;
use crate::{WALK, tell};

/// Into the curve, or into the speed-up.
const LEANS: [(&str, Direction); 3] = [
    ("amc/cmu_16_13_walk_veer_right.amc", Direction::Inwards),
    ("bvh/snu_spiral_walk_normal.bvh", Direction::Inwards),
    (TRANSITION, Direction::Ahead),
];

/// Speeds up; so many moments of that are looked at.
const TRANSITION: &str = "amc/cmu_127_04_walk_to_run_transition.amc";
const MOMENTS: usize = 3;

/// Up a ramp the centre of mass stays over the feet, as on the level.
const RAMP: &str = "bvh/snu_slope_up_10.bvh";

#[derive(Clone, Copy, Debug, PartialEq)]
enum Direction {
    Ahead,
    Inwards,
}

/// A capture averaged over strides.
struct Truth {
    strides: Strides,
    frames: std::ops::Range<usize>,
    direction: Direction,
}

impl Truth {
    fn of(folder: &Path, file: &str, direction: Direction) -> Result<Self, Failed> {
        let capture = Edited::untouched(&load(folder, file)?);
        let strides = Strides::of(&capture.clip, &capture.body, capture.stride());
        // A quarter of a stride of slack for the differences.
        let frames = strides.frames(capture.stride() / 4);
        Ok(Self { strides, frames, direction })
    }

    fn towards(&self, frame: usize) -> glam::DVec2 {
        let ahead = self.strides.ahead(frame);
        match self.direction {
            Direction::Ahead => ahead,
            Direction::Inwards => left(ahead) * self.strides.acceleration(frame).dot(left(ahead)).signum(),
        }
    }

    /// Lean, and what physics asks for, degrees.
    fn lean(&self, frame: usize) -> [f64; 2] {
        let towards = self.towards(frame);
        let asked = balancing(self.strides.acceleration(frame).dot(towards));
        [self.strides.lean(frame, towards), asked].map(f64::to_degrees)
    }

    fn mean(&self) -> [f64; 2] {
        [0, 1].map(|at| mean(self.frames.clone().map(|frame| self.lean(frame)[at])))
    }
}

/// Tells of a lean and what is asked for; a fault where they have not one sign.
fn told(name: &str, [lean, asked]: [f64; 2]) -> Option<String> {
    let text = format!("{name}: leans {lean:.1} degrees, {:.2} of the {asked:.1} asked for", lean / asked);
    tell(&text);
    (asked <= 0.0 || lean <= 0.0).then_some(text)
}

pub(crate) fn leans(folder: &Path, _: &str) -> Result<(), Failed> {
    let mut faults = Vec::new();
    for (file, direction) in LEANS {
        let truth = Truth::of(folder, file, direction)?;
        faults.extend(told(file, truth.mean()));
        if file == TRANSITION {
            let moments =
                (1..=MOMENTS).map(|moment| truth.frames.start + moment * truth.frames.len() / (MOMENTS + 1));
            faults.extend(moments.filter_map(|frame| told(&format!("    frame {frame}"), truth.lean(frame))));
        }
    }
    faults.extend(told(RAMP, on_ramp(folder)?));
    verdict(faults)
}

/// What is added on the ramp to the lean on the level, were that tilted as the ramp is, and that tilt, degrees.
fn on_ramp(folder: &Path) -> Result<[f64; 2], Failed> {
    let level = Truth::of(folder, WALK, Direction::Ahead)?;
    let ramp = Truth::of(folder, RAMP, Direction::Ahead)?;
    let climb = ramp.strides.climb(ramp.frames.start, ramp.frames.end - 1).to_degrees();
    tell(&format!("    on the level {:.1} degrees, on the ramp {:.1}", level.mean()[0], ramp.mean()[0]));
    Ok([ramp.mean()[0] - (level.mean()[0] - climb), climb])
}
