//! Contacts of a clip: which points of the feet bear on the ground, and where somebody says that hands do.
//!
//! Heights and speeds with hysteresis; the thresholds were measured on captures. That finds feet on a flat floor;
//! [`raised`] finds those that rest on something higher, [`annotated`] has what is stated.

pub mod annotated;
pub mod raised;

use glam::DVec3;

use crate::clip::Clip;
use crate::clip::working::WORKING_STEP;
use crate::index::{JointId, SourceFrame, floor_index};
use crate::skeleton::{JointFrame, JointRole, Skeleton};

/// Which points of the body bear in one frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[expect(missing_docs, reason = "the names say it")]
pub struct Contacts {
    pub left_heel: bool,
    pub left_toe: bool,
    pub right_heel: bool,
    pub right_toe: bool,
    pub left_hand: bool,
    pub right_hand: bool,
}

impl Contacts {
    /// Whether `point` bears.
    pub const fn at(self, point: ContactPoint) -> bool {
        match point {
            ContactPoint::LeftHeel => self.left_heel,
            ContactPoint::LeftToe => self.left_toe,
            ContactPoint::RightHeel => self.right_heel,
            ContactPoint::RightToe => self.right_toe,
            ContactPoint::LeftHand => self.left_hand,
            ContactPoint::RightHand => self.right_hand,
        }
    }

    /// Says whether `point` bears.
    pub const fn set(&mut self, point: ContactPoint, bears: bool) {
        match point {
            ContactPoint::LeftHeel => self.left_heel = bears,
            ContactPoint::LeftToe => self.left_toe = bears,
            ContactPoint::RightHeel => self.right_heel = bears,
            ContactPoint::RightToe => self.right_toe = bears,
            ContactPoint::LeftHand => self.left_hand = bears,
            ContactPoint::RightHand => self.right_hand = bears,
        }
    }

    /// Whether any foot or hand bears.
    pub const fn any(self) -> bool {
        self.left_foot() || self.right_foot() || self.left_hand || self.right_hand
    }

    /// Whether any point of each foot bears.
    pub const fn both_feet(self) -> bool {
        self.left_foot() && self.right_foot()
    }

    /// Whether any point of the left foot bears.
    pub const fn left_foot(self) -> bool {
        self.left_heel || self.left_toe
    }

    /// Whether any point of the right foot bears.
    pub const fn right_foot(self) -> bool {
        self.right_heel || self.right_toe
    }
}

/// A point of the body that can bear: the heel is the ankle joint, the toe the toe joint or, without one, the end of the
/// foot, the hand its joint or, without one, the end of the forearm.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[expect(missing_docs, reason = "the names say it")]
pub enum ContactPoint {
    LeftHeel,
    LeftToe,
    RightHeel,
    RightToe,
    LeftHand,
    RightHand,
}

impl ContactPoint {
    /// All six, in the order of [`Contacts`].
    pub const ALL: [Self; 6] =
        [Self::LeftHeel, Self::LeftToe, Self::RightHeel, Self::RightToe, Self::LeftHand, Self::RightHand];

    /// Those of the feet, whose contacts are found.
    pub const FEET: [Self; 4] = [Self::LeftHeel, Self::LeftToe, Self::RightHeel, Self::RightToe];

    /// Its name in reports.
    pub const fn keyword(self) -> &'static str {
        match self {
            Self::LeftHeel => "left_heel",
            Self::LeftToe => "left_toe",
            Self::RightHeel => "right_heel",
            Self::RightToe => "right_toe",
            Self::LeftHand => "left_hand",
            Self::RightHand => "right_hand",
        }
    }

    /// Whether it is a toe.
    pub const fn is_toe(self) -> bool {
        matches!(self, Self::LeftToe | Self::RightToe)
    }

    /// The role of its joint, where the skeleton has that joint.
    pub const fn role(self) -> JointRole {
        match self {
            Self::LeftHeel => JointRole::LeftFoot,
            Self::LeftToe => JointRole::LeftToe,
            Self::RightHeel => JointRole::RightFoot,
            Self::RightToe => JointRole::RightToe,
            Self::LeftHand => JointRole::LeftHand,
            Self::RightHand => JointRole::RightHand,
        }
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

impl ContactSettings {
    /// Below this height above its ground `point` bears, metres.
    const fn height(&self, point: ContactPoint) -> f64 {
        if point.is_toe() { self.toe_height } else { self.heel_height }
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
pub fn contact_point(skeleton: &Skeleton, point: ContactPoint) -> Option<BodyPoint> {
    let own = skeleton.joint_of(point.role()).map(|joint| BodyPoint { joint, local: DVec3::ZERO });
    let above = match point {
        ContactPoint::LeftToe => JointRole::LeftFoot,
        ContactPoint::RightToe => JointRole::RightFoot,
        ContactPoint::LeftHand => JointRole::LeftElbow,
        ContactPoint::RightHand => JointRole::RightElbow,
        ContactPoint::LeftHeel | ContactPoint::RightHeel => return own,
    };
    own.or_else(|| end_of(skeleton, skeleton.joint_of(above)?))
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

/// Contacts of the feet with a flat floor in successive poses, [`WORKING_STEP`] apart.
///
/// `poses`: world frames of all joints of each. `floor_poses`: the poses whose lowest heights are each point's floor
/// (its 1st percentile); mostly the same ones.
pub fn foot_contacts(
    skeleton: &Skeleton,
    poses: &[Vec<JointFrame>],
    floor_poses: &[Vec<JointFrame>],
    settings: &ContactSettings,
) -> Vec<Contacts> {
    let mut contacts = vec![Contacts::default(); poses.len()];
    for point in ContactPoint::FEET {
        let Some(at) = contact_point(skeleton, point) else {
            continue;
        };
        let places: Vec<DVec3> = poses.iter().map(|frames| at.place(frames)).collect();
        let floor = floor_of(&at, floor_poses);
        for (contact, bears) in contacts.iter_mut().zip(bearing(&places, floor, point, settings)) {
            contact.set(point, bears);
        }
    }
    contacts
}

/// Height of a point of a foot that stands on the floor, metres: its 1st percentile over `floor_poses`.
fn floor_of(point: &BodyPoint, floor_poses: &[Vec<JointFrame>]) -> f64 {
    percentile(floor_poses.iter().map(|frames| point.place(frames).y).collect(), FLOOR_PERCENTILE)
}

/// When one point bears on the floor: hysteresis, then gaps filled, then short contacts dropped.
fn bearing(places: &[DVec3], floor: f64, point: ContactPoint, settings: &ContactSettings) -> Vec<bool> {
    let heights: Vec<f64> = places.iter().map(|place| place.y - floor).collect();
    let speeds = speeds(places, WORKING_STEP);
    let mut labels = latched(&heights, &speeds, settings.height(point), settings);
    tidy(&mut labels, settings);
    labels
}

/// When a point is low and slow; once it is, up to `settings.hysteresis` times both thresholds.
pub(crate) fn latched(heights: &[f64], speeds: &[f64], height: f64, settings: &ContactSettings) -> Vec<bool> {
    let mut bears = false;
    heights
        .iter()
        .zip(speeds)
        .map(|(own, speed)| {
            let slack = if bears { settings.hysteresis } else { 1.0 };
            bears = *own < slack * height && *speed < slack * settings.speed;
            bears
        })
        .collect()
}

/// Fills gaps, then drops short contacts. A range shorter than the shortest contact may be all contact.
pub(crate) fn tidy(labels: &mut [bool], settings: &ContactSettings) {
    fill_gaps(labels, settings.longest_gap);
    drop_short(labels, settings.shortest_contact.min(labels.len()));
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
        let labels = bearing(&places, 0.0, ContactPoint::LeftToe, &ContactSettings::default());
        assert_eq!(runs(&labels), vec![(2, 5)]);
    }
}
