//! Feet that rest on something higher than the floor: steps, slopes, boxes, uneven ground.
//!
//! A foot off the floor rests on something where it is still and the body stands on it: the other foot is on its way, the
//! body passes over the foot, on a leg that is nearly stretched. Feet that are merely held up (a raised leg, legs that
//! dangle from a seat, the top of a swing or a leap) carry nobody. A foot that rests on the same level beside one that
//! carries bears as well.

use std::ops::RangeInclusive;

use glam::DVec3;

use crate::clip::contacts::{
    BodyPoint, ContactPoint, ContactSettings, Contacts, contact_point, floor_of, latched, percentile, runs,
    speeds, tidy,
};
use crate::clip::working::WORKING_STEP;
use crate::skeleton::{JointFrame, JointRole, Skeleton};

/// When a foot rests on something higher than the floor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RaisedSettings {
    /// A point rests below this speed, m/s: a thrown one is slower for two frames at most.
    pub speed: f64,
    /// For at least so many frames.
    pub shortest_rest: usize,
    /// What rests is the lowest point of its foot, or higher by less than this, metres.
    pub lowest: f64,
    /// Feet are on the same level when their heights differ by less than this, metres; so are heel and toe of one foot.
    pub same_level: f64,
    /// The foot carries with the middle of the hips within this distance of its ankle on the plan, metres …
    pub balance: f64,
    /// … its hip higher than its ankle by this share of its leg …
    pub stretched: f64,
    /// … and the other foot on its way, in at least so many frames.
    pub shortest_carry: usize,
    /// A contact reaches at most so many frames beyond the rest it is found by.
    pub farthest: usize,
}

impl Default for RaisedSettings {
    fn default() -> Self {
        Self {
            speed: 0.2,
            shortest_rest: 3,
            lowest: 0.03,
            same_level: 0.08,
            balance: 0.15,
            stretched: 0.7,
            shortest_carry: 2,
            farthest: 15,
        }
    }
}

/// Ground that is not the floor, under one point of a foot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RaisedGround {
    /// What rests there.
    pub point: ContactPoint,
    /// First working frame.
    pub first: usize,
    /// Last working frame.
    pub last: usize,
    /// Above the floor, metres.
    pub height: f64,
}

/// Adds to `contacts` (of [`crate::clip::contacts::foot_contacts`]) those with higher ground, which it returns in the order
/// of points, then of time. Bodies without a whole leg have none.
///
/// `poses`, `floor_poses`: as there. Cost: linear in frames times joints.
pub fn raise(
    skeleton: &Skeleton,
    (poses, floor_poses): (&[Vec<JointFrame>], &[Vec<JointFrame>]),
    contacts: &mut [Contacts],
    (settings, contact_settings): (&RaisedSettings, &ContactSettings),
) -> Vec<RaisedGround> {
    let feet = SIDES.map(|side| Foot::of(skeleton, side, (poses, floor_poses), contacts));
    let [Some(left), Some(right)] = feet else {
        return Vec::new();
    };
    let rests = [(&left, &right), (&right, &left)].map(|(foot, other)| {
        foot.rests(settings)
            .into_iter()
            .map(|rest| Rest { carries: foot.carries(other, &rest, (settings, contact_settings)), ..rest })
            .collect::<Vec<_>>()
    });
    let mut grounds = Vec::new();
    for (side, foot) in [&left, &right].into_iter().enumerate() {
        let beside = |rest: &Rest| rest.is_beside_one_that_carries(&rests[1 - side], settings);
        let bearing: Vec<&Rest> = rests[side].iter().filter(|rest| rest.carries || beside(rest)).collect();
        for point in &foot.points {
            grounds.extend(point.grounds(&bearing, (settings, contact_settings)));
        }
    }
    for ground in &grounds {
        contacts[ground.first..=ground.last].iter_mut().for_each(|contact| contact.set(ground.point, true));
    }
    grounds
}

/// Heel and toe, hip, knee and ankle of the left and of the right leg.
const SIDES: [([ContactPoint; 2], [JointRole; 3]); 2] = [
    (
        [ContactPoint::LeftHeel, ContactPoint::LeftToe],
        [JointRole::LeftHip, JointRole::LeftKnee, JointRole::LeftFoot],
    ),
    (
        [ContactPoint::RightHeel, ContactPoint::RightToe],
        [JointRole::RightHip, JointRole::RightKnee, JointRole::RightFoot],
    ),
];

/// One point of a foot along time.
struct Track {
    point: ContactPoint,
    /// Above its height on the floor, metres.
    heights: Vec<f64>,
    /// m/s.
    speeds: Vec<f64>,
}

/// One foot along time.
struct Foot {
    points: Vec<Track>,
    /// Height of its lowest point above the floor, metres.
    heights: Vec<f64>,
    /// Whether it bears on the floor.
    on_floor: Vec<bool>,
    /// From the ankle to the middle of the hips on the plan, metres.
    off_balance: Vec<f64>,
    /// Height of the hip over the ankle, share of the leg.
    stretch: Vec<f64>,
}

/// Frames in which a raised foot is still.
struct Rest {
    frames: RangeInclusive<usize>,
    /// Of the foot's lowest point above the floor, metres.
    height: f64,
    /// Whether the body stands on this foot alone.
    carries: bool,
}

impl Rest {
    /// Whether one of `others` (in the order of time) carries on the same level meanwhile.
    fn is_beside_one_that_carries(&self, others: &[Self], settings: &RaisedSettings) -> bool {
        let from = others.partition_point(|other| other.frames.end() < self.frames.start());
        let meanwhile = others[from..].iter().take_while(|other| other.frames.start() <= self.frames.end());
        let is_level = |other: &Self| (self.height - other.height).abs() < settings.same_level;
        meanwhile.into_iter().any(|other| other.carries && is_level(other))
    }
}

impl Foot {
    fn of(
        skeleton: &Skeleton,
        (points, leg): ([ContactPoint; 2], [JointRole; 3]),
        (poses, floor_poses): (&[Vec<JointFrame>], &[Vec<JointFrame>]),
        contacts: &[Contacts],
    ) -> Option<Self> {
        let track = |point: ContactPoint| {
            let at = contact_point(skeleton, point)?;
            Some(Track::of(point, &at, (poses, floor_poses)))
        };
        let points: Vec<Track> = points.into_iter().filter_map(track).collect();
        let [hip, knee, ankle] = leg.map(|role| skeleton.joint_of(role));
        let (hip, knee, ankle) = (hip?.as_usize(), knee?.as_usize(), ankle?.as_usize());
        let hips = [JointRole::LeftHip, JointRole::RightHip].map(|role| skeleton.joint_of(role));
        let [left, right] = [hips[0]?.as_usize(), hips[1]?.as_usize()];
        let lowest = |at: usize| points.iter().map(|track| track.heights[at]).fold(f64::INFINITY, f64::min);
        let off_balance = |frames: &Vec<JointFrame>| {
            let middle = 0.5 * (frames[left].position + frames[right].position);
            (middle - frames[ankle].position).with_y(0.0).length()
        };
        let stretch = |frames: &Vec<JointFrame>| {
            let [hip, knee, ankle] = [hip, knee, ankle].map(|joint| frames[joint].position);
            (hip.y - ankle.y) / (hip.distance(knee) + knee.distance(ankle)).max(f64::MIN_POSITIVE)
        };
        Some(Self {
            heights: (0..poses.len()).map(lowest).collect(),
            on_floor: contacts
                .iter()
                .map(|contact| points.iter().any(|track| contact.at(track.point)))
                .collect(),
            off_balance: poses.iter().map(off_balance).collect(),
            stretch: poses.iter().map(stretch).collect(),
            points,
        })
    }

    /// Whether the lowest point is still at frame `at`, or one hardly higher.
    fn is_still(&self, at: usize, settings: &RaisedSettings) -> bool {
        let highest = self.heights[at] + settings.lowest;
        self.points.iter().any(|track| track.speeds[at] < settings.speed && track.heights[at] < highest)
    }

    /// Whether it is too low at frame `at` to tell that it does not bear on the floor, sliding.
    fn is_low(&self, at: usize, settings: &ContactSettings) -> bool {
        self.points.iter().any(|track| track.heights[at] < settings.hysteresis * settings.height(track.point))
    }

    /// Where it is still off the floor; nothing is said yet of what it carries.
    fn rests(&self, settings: &RaisedSettings) -> Vec<Rest> {
        let is_still = |at: usize| !self.on_floor[at] && self.is_still(at, settings);
        let still: Vec<bool> = (0..self.heights.len()).map(is_still).collect();
        let rests =
            runs(&still).into_iter().filter(|(first, last)| last + 1 - first >= settings.shortest_rest);
        let rest = |(first, last): (usize, usize)| Rest {
            frames: first..=last,
            height: percentile(self.heights[first..=last].to_vec(), 0.5),
            carries: false,
        };
        rests.map(rest).collect()
    }

    /// Whether the body stands on this foot alone at some time of `rest`, while the `other` foot is on its way.
    fn carries(
        &self,
        other: &Self,
        rest: &Rest,
        (settings, contact_settings): (&RaisedSettings, &ContactSettings),
    ) -> bool {
        let is_balanced =
            |at: &usize| self.off_balance[*at] < settings.balance && self.stretch[*at] > settings.stretched;
        let is_away = |at: &usize| !other.is_still(*at, settings) && !other.is_low(*at, contact_settings);
        let carries = rest.frames.clone().filter(|at| is_balanced(at) && is_away(at)).count();
        rest.height > contact_settings.toe_height && carries >= settings.shortest_carry
    }
}

impl Track {
    fn of(
        point: ContactPoint,
        at: &BodyPoint,
        (poses, floor_poses): (&[Vec<JointFrame>], &[Vec<JointFrame>]),
    ) -> Self {
        let places: Vec<DVec3> = poses.iter().map(|frames| at.place(frames)).collect();
        let floor = floor_of(at, floor_poses);
        Self {
            point,
            heights: places.iter().map(|place| place.y - floor).collect(),
            speeds: speeds(&places, WORKING_STEP),
        }
    }

    /// The contacts of this point about `rests` of its foot, as on a floor at the height at which the point is still.
    fn grounds(
        &self,
        rests: &[&Rest],
        (settings, contact_settings): (&RaisedSettings, &ContactSettings),
    ) -> Vec<RaisedGround> {
        let mut grounds: Vec<RaisedGround> = Vec::new();
        for (index, rest) in rests.iter().enumerate() {
            let Some(height) = self.height_in(rest, settings) else {
                continue;
            };
            let (start, end) = (*rest.frames.start(), *rest.frames.end());
            let before = index.checked_sub(1).map_or(0, |before| rests[before].frames.end() + 1);
            let after = rests.get(index + 1).map_or(self.heights.len(), |after| *after.frames.start());
            let first = start.saturating_sub(settings.farthest).max(before);
            let last = (end + settings.farthest + 1).min(after);
            let above: Vec<f64> = self.heights[first..last].iter().map(|own| (own - height).abs()).collect();
            let own_height = contact_settings.height(self.point);
            let mut labels = latched(&above, &self.speeds[first..last], own_height, contact_settings);
            tidy(&mut labels, contact_settings);
            let touching = runs(&labels).into_iter().map(|(from, to)| (first + from, first + to));
            let own = touching.filter(|(from, to)| from <= &end && to >= &start);
            grounds.extend(own.map(|(first, last)| RaisedGround { point: self.point, first, last, height }));
        }
        grounds
    }

    /// Median height of this point where it is still during `rest`; `None` where it is not, or hangs in the air above the
    /// ground of its foot.
    fn height_in(&self, rest: &Rest, settings: &RaisedSettings) -> Option<f64> {
        let still = rest.frames.clone().filter(|at| self.speeds[*at] < settings.speed);
        let heights: Vec<f64> = still.map(|at| self.heights[at]).collect();
        let is_long = heights.len() >= settings.shortest_carry;
        let height = percentile(heights, 0.5);
        (is_long && height < rest.height + settings.same_level).then_some(height)
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;
    use crate::clip::builtin::generate;
    use crate::clip::contacts::foot_contacts;
    use crate::index::SourceFrame;

    /// Frames of a generated walk, and its skeleton.
    fn walk() -> (Skeleton, Vec<Vec<JointFrame>>) {
        let clip = generate("walk", &BTreeMap::new()).expect("a generated clip");
        let frames = |frame| clip.skeleton.forward_kinematics(&clip.pose(SourceFrame::from_usize(frame)));
        (clip.skeleton.as_ref().clone(), (0..clip.frame_count()).map(frames).collect())
    }

    fn found(
        skeleton: &Skeleton,
        poses: &[Vec<JointFrame>],
        floor: &[Vec<JointFrame>],
    ) -> (Vec<Contacts>, Vec<RaisedGround>) {
        let settings = ContactSettings::default();
        let mut contacts = foot_contacts(skeleton, poses, floor, &settings);
        let raised = (&RaisedSettings::default(), &settings);
        let grounds = raise(skeleton, (poses, floor), &mut contacts, raised);
        (contacts, grounds)
    }

    fn lifted(poses: &[Vec<JointFrame>], height: f64) -> Vec<Vec<JointFrame>> {
        let lift = |frame: &JointFrame| JointFrame { position: frame.position + DVec3::Y * height, ..*frame };
        poses.iter().map(|frames| frames.iter().map(lift).collect()).collect()
    }

    #[test]
    fn a_walk_on_a_table_bears_where_a_walk_on_the_floor_does() {
        /// Ends of contacts, frames: thresholds are above the height at which a foot is still, not above its lowest.
        const ENDS: usize = 2;
        let (skeleton, poses) = walk();
        let (on_floor, none) = found(&skeleton, &poses, &poses);
        assert!(none.is_empty());
        for height in [0.2, 0.7] {
            let (on_table, grounds) = found(&skeleton, &lifted(&poses, height), &poses);
            assert!(grounds.iter().all(|ground| (ground.height - height).abs() < 0.03), "{grounds:?}");
            for point in ContactPoint::FEET {
                let bears = |contacts: &[Contacts]| -> Vec<bool> {
                    contacts.iter().map(|own| own.at(point)).collect()
                };
                let [expected, own] = [&on_floor, &on_table].map(|contacts| runs(&bears(contacts)));
                // A foot that lands as the clip ends has not carried anybody yet.
                let whole = |run: &&(usize, usize)| run.1 + 1 < poses.len() && run.0 > 0;
                for run in expected.iter().filter(whole) {
                    let is_near = |own: &&(usize, usize)| {
                        run.0.abs_diff(own.0) <= ENDS && run.1.abs_diff(own.1) <= ENDS
                    };
                    assert!(own.iter().any(|own| is_near(&own)), "{point:?}: {run:?} in {own:?}");
                }
                assert!(own.len() <= expected.len(), "{point:?}: {own:?} for {expected:?}");
            }
        }
    }

    /// Sitting and hanging alike: nothing moves, so that no foot shows that it carries.
    #[test]
    fn a_body_that_hangs_still_bears_nowhere() {
        let (skeleton, poses) = walk();
        let still = vec![poses[7].clone(); 60];
        let (contacts, grounds) = found(&skeleton, &lifted(&still, 0.5), &poses);
        assert!(grounds.is_empty() && contacts.iter().all(|contact| !contact.any()));
    }
}
