//! Crouching: knees, hips and back bend together, the centre of mass stays over the feet.

use super::keyed::Curve;
use super::performance::Performance;
use super::stand;

/// What a full crouch has: the pelvis lower by metres at 1.75 m, its pitch and the back's bend in radians, and the centre of
/// mass ahead of the ankles in metres at 1.75 m.
const DROP: f64 = 0.50;
const PITCH: f64 = 0.46;
const BEND: f64 = 1.08;
const AHEAD: f64 = 0.055;

/// Stands at time 0, is `depth` (0 to 1) of a full crouch low between two times, and stands again: four times, seconds.
pub(super) fn down_and_up(act: &mut Performance, depth: f64, times: [f64; 4]) {
    let key = |still: f64, deep: f64| {
        let low = still + depth * (deep - still);
        Curve::through(&[(times[0], still), (times[1], low), (times[2], low), (times[3], still)])
    };
    set(act, key);
}

/// The depth, from 0 to 1, below which `is_high` says a crouch is not deep enough.
pub(super) fn bisect(mut is_high: impl FnMut(f64) -> bool) -> f64 {
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..40 {
        let middle = 0.5 * (low + high);
        if is_high(middle) { low = middle } else { high = middle }
    }
    high
}

/// Stays as low as that.
pub(super) fn still(act: &mut Performance, depth: f64) {
    set(act, |still, deep| Curve::constant(still + depth * (deep - still)));
}

/// As deep as `key` has it, which is told what standing and what a full crouch have.
pub(super) fn set(act: &mut Performance, key: impl Fn(f64, f64) -> Curve) {
    let (scale, height) = (act.body.scale, stand::pelvis_height(&act.body));
    let ahead = Performance::standing_center(&act.body).z;
    act.height.pelvis = key(height, height - DROP * scale);
    act.over[1] = key(ahead, AHEAD * scale);
    act.trunk.pitch = key(0.0, PITCH);
    act.trunk.bend = key(stand::LEAN, BEND);
}
