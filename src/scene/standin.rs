//! Stand-ins for the clip readers until they are merged: same names, same signatures, toy contents.

#![allow(
    dead_code,
    missing_docs,
    unreachable_pub,
    reason = "gone as soon as the readers are merged"
)]

use std::collections::BTreeMap;
use std::f64::consts::FRAC_PI_2;
use std::sync::Arc;

use glam::{DQuat, DVec3};

use crate::clip::Clip;
use crate::clip::contacts::FootContacts;
use crate::clip::working::{WORKING_STEP, WorkingClip};
use crate::geometry::plan_of;
use crate::index::{FrameIndex, SourceFrame};
use crate::skeleton::{Axis, Joint, Skeleton};

fn toy(name: &str, joints: usize, frames: u32, (fps, step): (f64, f64)) -> Clip {
    let joint = Joint {
        name: "hips".to_owned(),
        parent: None, // of every joint: it is a toy
        offset: DVec3::new(0.0, 1.0, 0.0),
        end_site: None,
        rotation_order: [Axis::Z, Axis::X, Axis::Y],
        role: None,
    };
    Clip {
        name: name.to_owned(),
        skeleton: Arc::new(Skeleton {
            joints: vec![joint; joints],
        }),
        fps,
        root_positions: (0..frames)
            .map(|k| DVec3::new(f64::from(k) * step, 1.0, 0.0))
            .collect(),
        rotations: vec![DQuat::from_rotation_y(FRAC_PI_2); frames as usize * joints],
        moving_offsets: Vec::new(),
        events: BTreeMap::new(),
        usable: (SourceFrame(0), SourceFrame(frames.saturating_sub(1))),
    }
}

impl WorkingClip {
    /// The frames `first` to `last` of `clip` on working frames.
    pub fn new(name: &str, clip: Arc<Clip>, first: SourceFrame, last: SourceFrame) -> Self {
        let exact = f64::from(last.0 - first.0) / (clip.fps * WORKING_STEP);
        let count = crate::index::floor_index(exact + 1e-9) + 1;
        let at = |working: usize| {
            let frame =
                f64::from(first.0) + f64::from(FrameIndex::from_usize(working).0) * clip.fps * WORKING_STEP;
            plan_of(clip.root_positions[crate::index::floor_index(frame + 1e-9)])
        };
        Self {
            name: name.to_owned(),
            first,
            last,
            overhang: 0.0,
            positions: (0..count).map(at).collect(),
            headings: vec![0.0; count],
            contacts: vec![FootContacts::default(); count],
            flight: vec![false; count],
            stationary: vec![false; count],
            clip,
        }
    }
}

/// Stand-in for the generated clips.
pub mod builtin {
    use super::{BTreeMap, Clip, SourceFrame, toy};

    /// Why there is no such clip.
    #[derive(Debug, thiserror::Error)]
    pub enum BuiltinError {
        /// No clip of this name.
        #[error("no generated clip \"{0}\" (known: \"walk\", \"idle\", \"slap\")")]
        Unknown(String),
        /// No parameter of this name.
        #[error("generated clips have no parameter \"{0}\" (known: \"speed\")")]
        Parameter(String),
    }

    /// A toy clip.
    pub fn generate(name: &str, parameters: &BTreeMap<String, f64>) -> Result<Clip, BuiltinError> {
        if let Some(unknown) = parameters.keys().find(|key| *key != "speed") {
            return Err(BuiltinError::Parameter(unknown.clone()));
        }
        match name {
            "walk" => Ok(toy(name, 1, 121, (30.0, 1.2 / 30.0))),
            "idle" => Ok(toy(name, 1, 91, (30.0, 0.0))),
            "slap" => {
                let mut clip = toy(name, 1, 121, (30.0, 0.01));
                clip.events.insert("hit".to_owned(), SourceFrame(60));
                Ok(clip)
            }
            _ => Err(BuiltinError::Unknown(name.to_owned())),
        }
    }
}

/// Stand-in for the BVH reader.
pub mod bvh {
    use super::{Clip, toy};

    /// How to read a file.
    #[derive(Debug, Default)]
    pub struct ReadOptions {
        pub fps: Option<f64>,
        pub unit_to_m: Option<f64>,
        pub up: Option<Up>,
    }

    /// The axis that points up.
    #[derive(Clone, Copy, Debug)]
    pub enum Up {
        Y,
        Z,
    }

    /// A clip and what was guessed.
    #[derive(Debug)]
    pub struct ReadClip {
        pub clip: Clip,
        pub notes: Vec<String>,
    }

    /// Why a file is no clip.
    #[derive(Debug, thiserror::Error)]
    pub enum BvhError {
        /// It does not begin as BVH does.
        #[error("1:1: expected HIERARCHY")]
        NoHierarchy,
        /// A number is missing.
        #[error("{0}:1: expected a number")]
        Number(usize),
    }

    /// Reads the header of the motion only.
    pub fn read(bytes: &[u8], name: &str, options: &ReadOptions) -> Result<ReadClip, BvhError> {
        let text = String::from_utf8_lossy(bytes);
        if !text.starts_with("HIERARCHY") {
            return Err(BvhError::NoHierarchy);
        }
        let mut frames = 0;
        let mut fps = options.fps.unwrap_or(30.0);
        for (index, line) in text.lines().enumerate() {
            if let Some(count) = line.strip_prefix("Frames:") {
                frames = count.trim().parse().map_err(|_| BvhError::Number(index + 1))?;
            }
            if let (None, Some(step)) = (options.fps, line.strip_prefix("Frame Time:")) {
                fps = 1.0
                    / step
                        .trim()
                        .parse::<f64>()
                        .map_err(|_| BvhError::Number(index + 1))?;
            }
        }
        let mut notes = Vec::new();
        if options.unit_to_m.is_none() {
            notes.push("unit guessed: centimetres".to_owned());
        }
        Ok(ReadClip {
            clip: toy(name, 2, frames, (fps, 0.01)),
            notes,
        })
    }
}
