//! Foot contacts of a clip.
//!
//! Heights and speeds with hysteresis; the thresholds were measured on captures.

use glam::DVec3;

use crate::clip::Clip;
use crate::clip::working::WORKING_STEP;
use crate::index::{JointId, SourceFrame, floor_index};
use crate::skeleton::{JointFrame, JointRole, Skeleton};

/// Which points of the feet bear on the ground in one frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[expect(missing_docs, reason = "the names say it")]
pub struct FootContacts {
    pub left_heel: bool,
    pub left_toe: bool,
    pub right_heel: bool,
    pub right_toe: bool,
}

impl FootContacts {
    /// Whether `point` bears.
    pub const fn at(self, point: FootPoint) -> bool {
        match point {
            FootPoint::LeftHeel => self.left_heel,
            FootPoint::LeftToe => self.left_toe,
            FootPoint::RightHeel => self.right_heel,
            FootPoint::RightToe => self.right_toe,
        }
    }

    /// Says whether `point` bears.
    pub const fn set(&mut self, point: FootPoint, bears: bool) {
        match point {
            FootPoint::LeftHeel => self.left_heel = bears,
            FootPoint::LeftToe => self.left_toe = bears,
            FootPoint::RightHeel => self.right_heel = bears,
            FootPoint::RightToe => self.right_toe = bears,
        }
    }

    /// Whether any point of any foot bears.
    pub const fn any(self) -> bool {
        self.left_heel || self.left_toe || self.right_heel || self.right_toe
    }

    /// Whether any point of each foot bears.
    pub const fn both_feet(self) -> bool {
        (self.left_heel || self.left_toe) && (self.right_heel || self.right_toe)
    }
}

/// A point of a foot that can bear: the heel is the ankle joint, the toe the toe joint or, without one, the end of the foot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[expect(missing_docs, reason = "the names say it")]
pub enum FootPoint {
    LeftHeel,
    LeftToe,
    RightHeel,
    RightToe,
}

impl FootPoint {
    /// All four, in the order of [`FootContacts`].
    pub const ALL: [Self; 4] = [Self::LeftHeel, Self::LeftToe, Self::RightHeel, Self::RightToe];

    /// Whether it is a toe.
    pub const fn is_toe(self) -> bool {
        matches!(self, Self::LeftToe | Self::RightToe)
    }
}

/// When a foot point bears.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactSettings {
    /// A toe bears below this height above its floor, metres.
    pub toe_height: f64,
    /// A heel (ankle joint) bears below this height above its floor, metres.
    pub heel_height: f64,
    /// A point bears below this speed, m/s.
    pub speed: f64,
    /// A contact lasts up to this many times both thresholds.
    pub hysteresis: f64,
    /// Shorter contacts are dropped, frames.
    pub shortest_contact: usize,
    /// Gaps up to this long are filled, frames.
    pub longest_gap: usize,
}

impl Default for ContactSettings {
    fn default() -> Self {
        Self {
            toe_height: 0.05,
            heel_height: 0.08,
            speed: 0.4,
            hysteresis: 1.5,
            shortest_contact: 3,
            longest_gap: 2,
        }
    }
}

/// Share of the frames in which a point is lower than its floor.
const FLOOR_PERCENTILE: f64 = 0.01;

/// An end site farther from its foot joint than this is a stray one, metres.
const LONGEST_FOOT: f64 = 0.5;

/// A point fixed to a joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyPoint {
    /// The joint.
    pub joint: JointId,
    /// In the joint's axes, metres.
    pub local: DVec3,
}

impl BodyPoint {
    /// World position in the pose with world frames `frames`, metres.
    pub fn place(&self, frames: &[JointFrame]) -> DVec3 {
        let frame = &frames[self.joint.as_usize()];
        frame.position + frame.rotation * self.local
    }
}

/// Where `point` sits on `skeleton`; `None` where the skeleton does not have it.
pub fn foot_point(skeleton: &Skeleton, point: FootPoint) -> Option<BodyPoint> {
    let at_joint = |joint| BodyPoint { joint, local: DVec3::ZERO };
    match point {
        FootPoint::LeftHeel => skeleton.joint_of(JointRole::LeftFoot).map(at_joint),
        FootPoint::RightHeel => skeleton.joint_of(JointRole::RightFoot).map(at_joint),
        FootPoint::LeftToe => {
            let toe = skeleton.joint_of(JointRole::LeftToe).map(at_joint);
            toe.or_else(|| end_of(skeleton, skeleton.joint_of(JointRole::LeftFoot)?))
        }
        FootPoint::RightToe => {
            let toe = skeleton.joint_of(JointRole::RightToe).map(at_joint);
            toe.or_else(|| end_of(skeleton, skeleton.joint_of(JointRole::RightFoot)?))
        }
    }
}

/// End of the segment of `joint`, without stray end sites.
pub(crate) fn end_of(skeleton: &Skeleton, joint: JointId) -> Option<BodyPoint> {
    let local = skeleton.joints[joint.as_usize()].end_site?;
    (local.length() < LONGEST_FOOT).then_some(BodyPoint { joint, local })
}

/// World frames of all joints at frames `first`, `first + step` … of `clip` up to `last` (a rounding beyond counts).
pub fn sampled_frames(clip: &Clip, first: SourceFrame, last: SourceFrame, step: f64) -> Vec<Vec<JointFrame>> {
    let span = f64::from(last.0.saturating_sub(first.0));
    (0..=floor_index(span / step + 1e-9))
        .map(|index| clip.sample(f64::from(first.0) + index as f64 * step))
        .map(|pose| clip.skeleton.forward_kinematics(&pose))
        .collect()
}

/// Contacts of successive poses, [`WORKING_STEP`] apart.
///
/// `poses`: world frames of all joints of each. `floor_poses`: the poses whose lowest heights are each point's floor
/// (its 1st percentile); mostly the same ones.
pub fn foot_contacts(
    skeleton: &Skeleton,
    poses: &[Vec<JointFrame>],
    floor_poses: &[Vec<JointFrame>],
    settings: &ContactSettings,
) -> Vec<FootContacts> {
    let mut contacts = vec![FootContacts::default(); poses.len()];
    for point in FootPoint::ALL {
        let Some(at) = foot_point(skeleton, point) else {
            continue;
        };
        let places: Vec<DVec3> = poses.iter().map(|frames| at.place(frames)).collect();
        let heights = floor_poses.iter().map(|frames| at.place(frames).y).collect();
        let floor = percentile(heights, FLOOR_PERCENTILE);
        for (contact, bears) in contacts.iter_mut().zip(bearing(&places, floor, point, settings)) {
            contact.set(point, bears);
        }
    }
    contacts
}

/// When one point bears: hysteresis, then gaps filled, then short contacts dropped.
fn bearing(places: &[DVec3], floor: f64, point: FootPoint, settings: &ContactSettings) -> Vec<bool> {
    let height = if point.is_toe() { settings.toe_height } else { settings.heel_height };
    let speeds = speeds(places, WORKING_STEP);
    let mut bears = false;
    let mut labels: Vec<bool> = places
        .iter()
        .zip(&speeds)
        .map(|(place, speed)| {
            let slack = if bears { settings.hysteresis } else { 1.0 };
            bears = place.y - floor < slack * height && *speed < slack * settings.speed;
            bears
        })
        .collect();
    fill_gaps(&mut labels, settings.longest_gap);
    // A range shorter than the shortest contact may be all contact.
    drop_short(&mut labels, settings.shortest_contact.min(places.len()));
    labels
}

/// Speed at each of successive places `step` seconds apart, m/s: central differences, one-sided at the ends.
pub fn speeds(places: &[DVec3], step: f64) -> Vec<f64> {
    let last = places.len().saturating_sub(1);
    (0..places.len())
        .map(|index| {
            let (before, after) = (index.saturating_sub(1), (index + 1).min(last));
            let steps = (after - before).max(1) as f64;
            places[before].distance(places[after]) / (steps * step)
        })
        .collect()
}

/// Value below which the share `share` of `values` lies, linear between neighbours; 0 of none.
pub fn percentile(mut values: Vec<f64>, share: f64) -> f64 {
    values.sort_by(f64::total_cmp);
    let Some(last) = values.len().checked_sub(1) else {
        return 0.0;
    };
    let at = share * last as f64;
    let lower = floor_index(at).min(last);
    let upper = (lower + 1).min(last);
    values[lower] + (at - lower as f64) * (values[upper] - values[lower])
}

/// Maximal runs of `true`: first and last index of each.
pub fn runs(labels: &[bool]) -> Vec<(usize, usize)> {
    let mut runs: Vec<(usize, usize)> = Vec::new();
    for (index, _) in labels.iter().enumerate().filter(|(_, label)| **label) {
        match runs.last_mut() {
            Some((_, last)) if *last + 1 == index => *last = index,
            _ => runs.push((index, index)),
        }
    }
    runs
}

/// Sets runs of `false` between two runs of `true` where they are at most `longest` long.
pub(crate) fn fill_gaps(labels: &mut [bool], longest: usize) {
    let runs = runs(labels);
    for pair in runs.windows(2) {
        let (gap_first, gap_end) = (pair[0].1 + 1, pair[1].0);
        if gap_end - gap_first <= longest {
            labels[gap_first..gap_end].fill(true);
        }
    }
}

/// Clears runs of `true` shorter than `shortest`.
pub(crate) fn drop_short(labels: &mut [bool], shortest: usize) {
    for (first, last) in runs(labels) {
        if last + 1 - first < shortest {
            labels[first..=last].fill(false);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gaps_are_filled_before_short_contacts_go() {
        let mut labels = [1, 1, 0, 0, 1, 0, 0, 0, 1, 1].map(|label| label == 1);
        fill_gaps(&mut labels, 2);
        drop_short(&mut labels, 3);
        assert_eq!(runs(&labels), vec![(0, 4)]);
    }

    #[test]
    fn a_percentile_lies_between_neighbours() {
        assert_eq!(percentile(vec![3.0, 1.0, 2.0], 0.5), 2.0);
        assert_eq!(percentile(vec![0.0, 10.0], 0.25), 2.5);
        assert_eq!(percentile(vec![4.0], 0.01), 4.0);
        assert_eq!(percentile(Vec::new(), 0.5), 0.0);
    }

    /// A toe that rests, creeps upwards through the threshold and returns.
    #[test]
    fn a_contact_leaves_later_than_it_starts() {
        let heights = [0.06, 0.06, 0.04, 0.04, 0.06, 0.07, 0.08, 0.08, 0.06, 0.06];
        let places: Vec<DVec3> = heights.iter().map(|&height| DVec3::Y * height).collect();
        let labels = bearing(&places, 0.0, FootPoint::LeftToe, &ContactSettings::default());
        assert_eq!(runs(&labels), vec![(2, 5)]);
    }
}
