//! A clip laid from its chord onto an arc.

use crate::clip::Clip;
use crate::clip::working::WORKING_STEP;
use crate::geometry::{c64, cis, plan_of, world_of, yaw};
use crate::index::floor_index;

/// Why a clip lies on no arc.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ArcError {
    /// An arc of no radius.
    #[error("an arc has a radius other than 0, not {radius} m")]
    NoRadius {
        /// What was asked for, metres.
        radius: f64,
    },
    /// A clip that ends where it begins.
    #[error("the clip ends {chord:.3} m from where it begins: it has no chord")]
    NoChord {
        /// Metres.
        chord: f64,
    },
}

/// Shorter chords have no direction, metres.
const SHORTEST_CHORD: f64 = 0.1;

/// `clip` with its chord, from the first root to the last on the plan, laid onto an arc of `radius` metres, to the left where that is
/// positive: what was along the chord is along the arc, what was left of it left, and everybody turns with it. Stated contacts
/// stay. Cost: linear.
///
/// The path is that of frames 1/30 s apart, straight between; what a root does beside it (mostly noise) is turned, not stretched.
///
/// # Errors
/// [`ArcError`] without radius or chord.
pub fn bent(clip: &Clip, radius: f64) -> Result<Clip, ArcError> {
    if radius == 0.0 || !radius.is_finite() {
        return Err(ArcError::NoRadius { radius });
    }
    let (first, last) = (clip.usable.0.as_usize(), clip.usable.1.as_usize());
    let start = plan_of(clip.root_positions[first]);
    let chord = plan_of(clip.root_positions[last]) - start;
    if chord.norm() < SHORTEST_CHORD {
        return Err(ArcError::NoChord { chord: chord.norm() });
    }
    let ahead = chord / chord.norm();
    let lay = |place: c64| {
        let local = (place - start) / ahead;
        let turn = local.re / radius;
        let center = c64::new(0.0, radius);
        (start + ahead * (center + c64::new(0.0, local.im - radius) * cis(turn)), turn)
    };
    let every = floor_index((clip.fps * WORKING_STEP).round()).max(1);
    let mut moved = clip.clone();
    let joint_count = clip.skeleton.joints.len();
    for (frame, root) in clip.root_positions.iter().enumerate() {
        let low = (frame / every * every).min((clip.frame_count() - 1).saturating_sub(every));
        let high = (low + every).min(clip.frame_count() - 1);
        let share = if high > low { (frame - low) as f64 / (high - low) as f64 } else { 0.0 };
        let [from, to] = [low, high].map(|at| plan_of(clip.root_positions[at]));
        let [(laid_from, turn_from), (laid_to, turn_to)] = [from, to].map(lay);
        let turn = turn_from + share * (turn_to - turn_from);
        let beside = plan_of(*root) - (from + (to - from) * share);
        let place = laid_from + (laid_to - laid_from) * share + cis(turn) * beside;
        moved.root_positions[frame] = world_of(place, root.y);
        moved.rotations[frame * joint_count] = yaw(turn) * clip.rotations[frame * joint_count];
    }
    Ok(moved)
}
