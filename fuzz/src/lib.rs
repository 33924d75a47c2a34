//! The readers of captures and what they promise of their results.
//!
//! The modules are those of the product, by path: with all its dependencies, instrumented, building would take longer than
//! fuzzing.

// The readers need one name of the solvers, and none of their libraries.
extern crate self as cotillion_solvers;

/// Complex numbers, under the name the product has for them.
#[allow(non_camel_case_types)]
pub type c64 = num_complex::Complex<f64>;

#[path = "../../src/index.rs"]
pub mod index;
#[path = "../../src/geometry.rs"]
pub mod geometry;
#[path = "../../src/skeleton.rs"]
pub mod skeleton;
#[path = "../../src/limb.rs"]
pub mod limb;
#[path = "../../src/clip/mod.rs"]
pub mod clip;

use clip::Clip;
use clip::read::{Capture, ReadOptions, read};

/// A skeleton to read motions with.
pub const ASF: &[u8] = include_bytes!("../seeds/asf/small.asf");

/// A motion to read skeletons with.
pub const AMC: &[u8] = include_bytes!("../seeds/amc/small.amc");

/// Rotations are products of a few unit quaternions.
const UNIT_ROUNDING: f64 = 1e-9;

/// Reads `capture`.
///
/// # Panics
/// If the reader does, or if a clip comes out with numbers that are none.
pub fn check(capture: Capture<'_>, options: &ReadOptions) {
    if let Ok(read) = read(capture, "fuzz", options) {
        assert!(read.unit_to_m.is_finite() && read.unit_to_m > 0.0, "unit {}", read.unit_to_m);
        assert!(read.header_fps.is_finite() && read.header_fps > 0.0, "rate {}", read.header_fps);
        check_clip(&read.clip);
        // Texts of notes are made of what the file says.
        read.notes.iter().for_each(|note| drop(note.to_string()));
    }
}

fn check_clip(clip: &Clip) {
    let joints = &clip.skeleton.joints;
    assert!(clip.frame_count() > 0 && clip.rotations.len() == clip.frame_count() * joints.len());
    assert!(clip.usable.0 <= clip.usable.1 && clip.usable.1.as_usize() < clip.frame_count());
    let ends = joints.iter().flat_map(|joint| [Some(joint.offset), joint.end_site]).flatten();
    let moving = clip.moving_offsets.iter().flat_map(|moving| moving.offsets.iter().copied());
    let mut places = clip.root_positions.iter().copied().chain(ends).chain(moving);
    assert!(places.all(|place| place.is_finite()), "a place that is none");
    let is_unit = |turn: &glam::DQuat| (turn.length() - 1.0).abs() < UNIT_ROUNDING;
    assert!(clip.rotations.iter().all(is_unit), "a rotation that is none");
    let posed = clip.skeleton.forward_kinematics(&clip.pose(clip.usable.0));
    assert!(posed.iter().all(|joint| joint.position.is_finite()), "a joint nowhere");
}
