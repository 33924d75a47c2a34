//! Frames in which nothing touches the ground.
//!
//! A contact label makes ground, and short flights are repaired. Other joints than the feet count as touching when
//! they are near the floor (hands of a cartwheel, a rolling back), and a run whose body does not fall is no flight but
//! support on something higher (a slope, a step, a seat).

use glam::DVec3;

use crate::clip::contacts::{
    BodyPoint, ContactPoint, Contacts, contact_point, drop_short, end_of, percentile, runs, speeds,
};
use crate::clip::roles::is_helper;
use crate::clip::working::WORKING_STEP;
use crate::index::JointId;
use crate::skeleton::{JointFrame, JointRole, Skeleton};

/// When a body touches the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlightSettings {
    /// A point of a foot touches below this height above its floor, metres.
    pub foot_height: f64,
    /// Any other joint touches below this height above the lowest floor of the feet, metres; flesh is thick.
    pub joint_height: f64,
    /// And slower than this, m/s.
    pub speed: f64,
    /// Shorter flights are ground, frames.
    pub shortest: usize,
    /// In flight the joints fall at least so fast on average, m/s²; checked from `shortest_fitted` frames on.
    pub least_gravity: f64,
    /// Shorter flights are too short to fit a parabola, frames.
    pub shortest_fitted: usize,
}

impl Default for FlightSettings {
    fn default() -> Self {
        Self {
            foot_height: 0.03,
            joint_height: 0.12,
            speed: 1.5,
            shortest: 3,
            least_gravity: 3.0,
            shortest_fitted: 5,
        }
    }
}

/// Share of the frames in which a point is lower than its floor.
const FLOOR_PERCENTILE: f64 = 0.05;

/// Frames in flight among successive poses, [`WORKING_STEP`] apart. A body without feet never flies.
///
/// `poses`, `floor_poses`: as in [`crate::clip::contacts::foot_contacts`]; `contacts`: what that found.
pub fn flight(
    skeleton: &Skeleton,
    poses: &[Vec<JointFrame>],
    floor_poses: &[Vec<JointFrame>],
    contacts: &[Contacts],
    settings: &FlightSettings,
) -> Vec<bool> {
    let feet = bearing_points(skeleton);
    if feet.is_empty() {
        return vec![false; poses.len()];
    }
    let mut airborne: Vec<bool> = contacts.iter().map(|contact| !contact.any()).collect();
    let mut lowest_floor = f64::INFINITY;
    for point in &feet {
        let floor =
            percentile(floor_poses.iter().map(|frames| point.place(frames).y).collect(), FLOOR_PERCENTILE);
        lowest_floor = lowest_floor.min(floor);
        clear_touching(&mut airborne, point, poses, floor + settings.foot_height, settings.speed);
    }
    for joint in other_joints(skeleton) {
        clear_touching(&mut airborne, &joint, poses, lowest_floor + settings.joint_height, settings.speed);
    }
    drop_short(&mut airborne, settings.shortest);
    let heights = mean_heights(skeleton, poses);
    for (first, last) in runs(&airborne) {
        let is_fitted = last + 1 - first >= settings.shortest_fitted;
        if is_fitted && fitted_gravity(&heights[first..=last], WORKING_STEP) < settings.least_gravity {
            airborne[first..=last].fill(false);
        }
    }
    airborne
}

/// Heels, toes and tips of both feet.
fn bearing_points(skeleton: &Skeleton) -> Vec<BodyPoint> {
    let tips =
        [JointRole::LeftToe, JointRole::RightToe].map(|role| end_of(skeleton, skeleton.joint_of(role)?));
    ContactPoint::FEET.iter().map(|&point| contact_point(skeleton, point)).chain(tips).flatten().collect()
}

/// All joints but the feet, what hangs on them, and helpers.
pub(crate) fn other_joints(skeleton: &Skeleton) -> Vec<BodyPoint> {
    let mut of_foot: Vec<bool> = Vec::with_capacity(skeleton.joints.len());
    for joint in &skeleton.joints {
        let is_foot = matches!(joint.role, Some(JointRole::LeftFoot | JointRole::RightFoot));
        of_foot.push(is_foot || joint.parent.is_some_and(|parent| of_foot[parent.as_usize()]));
    }
    (0..skeleton.joints.len())
        .filter(|&index| !of_foot[index] && !is_helper(&skeleton.joints[index].name))
        .map(|index| BodyPoint { joint: JointId::from_usize(index), local: DVec3::ZERO })
        .collect()
}

/// Clears the frames in which `point` is below `height` and slower than `speed`.
fn clear_touching(
    airborne: &mut [bool],
    point: &BodyPoint,
    poses: &[Vec<JointFrame>],
    height: f64,
    speed: f64,
) {
    let places: Vec<DVec3> = poses.iter().map(|frames| point.place(frames)).collect();
    for (index, at) in speeds(&places, WORKING_STEP).into_iter().enumerate() {
        if places[index].y < height && at < speed {
            airborne[index] = false;
        }
    }
}

/// Mean height of the joints of each pose, helpers left out, metres.
pub fn mean_heights(skeleton: &Skeleton, poses: &[Vec<JointFrame>]) -> Vec<f64> {
    let counted: Vec<usize> =
        (0..skeleton.joints.len()).filter(|&index| !is_helper(&skeleton.joints[index].name)).collect();
    poses
        .iter()
        .map(|frames| {
            counted.iter().map(|&index| frames[index].position.y).sum::<f64>() / counted.len().max(1) as f64
        })
        .collect()
}

/// Downward acceleration of the parabola nearest to `heights`, `step` seconds apart, m/s²; 0 of fewer than three.
pub fn fitted_gravity(heights: &[f64], step: f64) -> f64 {
    let middle = 0.5 * (heights.len() as f64 - 1.0);
    let time_sq = |index: usize| ((index as f64 - middle) * step).powi(2);
    let mean = (0..heights.len()).map(time_sq).sum::<f64>() / heights.len().max(1) as f64;
    // Quadratic orthogonal to constants and (by symmetry) to lines.
    let quadratic = |index: usize| time_sq(index) - mean;
    let norm_sq: f64 = (0..heights.len()).map(|index| quadratic(index).powi(2)).sum();
    if heights.len() < 3 {
        return 0.0;
    }
    let product: f64 = heights.iter().enumerate().map(|(index, height)| quadratic(index) * height).sum();
    -2.0 * product / norm_sq
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_thrown_body_falls_with_its_gravity() {
        let heights: Vec<f64> = (0..9)
            .map(|k| {
                let t = f64::from(k) * WORKING_STEP;
                1.0 + 1.3 * t - 0.5 * 9.81 * t * t
            })
            .collect();
        assert!((fitted_gravity(&heights, WORKING_STEP) - 9.81).abs() < 1e-9);
        assert_eq!(fitted_gravity(&heights[..2], WORKING_STEP), 0.0);
    }
}
