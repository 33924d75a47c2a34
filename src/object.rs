//! Things in a scene: how big they are, where they are by themselves, and who carries them when.

use std::collections::BTreeMap;

use glam::DVec3;

use crate::constraint::Moment;
use crate::geometry::{c64, cis, lerp_angle, plan_of, world_of, yaw};
use crate::index::{CharacterId, ObjectId};

/// Where an object is. It stays level: its y axis points up.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ObjectPose {
    /// Middle of its base in the world, metres.
    pub position: DVec3,
    /// Heading of its front, radians.
    pub facing: f64,
}

/// Where an object is at one time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ObjectKey {
    /// Scene time.
    pub seconds: f64,
    /// Where.
    pub pose: ObjectPose,
}

/// Where an object is as long as nobody carries it.
#[derive(Clone, Debug, PartialEq)]
pub enum Course {
    /// It stands still.
    Still(ObjectPose),
    /// It moves from key to key, in straight lines at even speed, turning on the shorter arc: keys are met exactly and nothing
    /// overshoots them. Before the first key it is there, after the last one there. One or more, rising in time.
    Keys(Vec<ObjectKey>),
}

/// A thing in the scene, a box. Its axes are x ahead, y up, z to the right, from the middle of its base.
#[derive(Clone, Debug, PartialEq)]
pub struct Object {
    /// Unique among characters and objects.
    pub name: String,
    /// Ahead, up, across, metres.
    pub size: [f64; 3],
    /// Where it is by itself.
    pub course: Course,
}

/// Who has an object when; before and after it stays where it is.
#[derive(Clone, Debug, PartialEq)]
pub struct Carry {
    /// Its author's name for it, or `carry[0]` … in the order of the file.
    pub name: String,
    /// Line of the scene file, from 1; 0 where the scene does not come from a file.
    pub line: u32,
    /// What is carried; it stands still by itself.
    pub object: ObjectId,
    /// One or two, between whose hands it is; their skeletons have hands.
    pub by: Vec<CharacterId>,
    /// First and last moment, of one of the carriers.
    pub during: (Moment, Moment),
}

impl ObjectPose {
    /// Where `point`, in the object's axes, is in the world.
    pub fn apply(&self, point: DVec3) -> DVec3 {
        self.position + yaw(self.facing) * point
    }

    /// Where a world point is in the object's axes.
    pub fn local(&self, point: DVec3) -> DVec3 {
        yaw(-self.facing) * (point - self.position)
    }

    /// A pose in this one's axes, in the world.
    pub fn compose(&self, inner: &Self) -> Self {
        Self { position: self.apply(inner.position), facing: self.facing + inner.facing }
    }

    /// A pose of the world in this one's axes: `self.compose(&self.relative(other))` is `other`.
    pub fn relative(&self, other: &Self) -> Self {
        Self { position: self.local(other.position), facing: other.facing - self.facing }
    }

    /// Ground plan of the middle of its base, metres.
    pub fn plan(&self) -> c64 {
        plan_of(self.position)
    }

    /// Plan point at an offset ahead + i·left of the object, metres.
    pub fn beside(&self, offset: c64) -> c64 {
        self.plan() + cis(self.facing) * offset
    }

    /// The pose on the ground at a plan point.
    pub fn on_ground(position: c64, facing: f64) -> Self {
        Self { position: world_of(position, 0.0), facing }
    }
}

impl Course {
    /// Pose at a scene time. Cost: logarithmic in keys.
    pub fn pose_at(&self, seconds: f64) -> ObjectPose {
        let keys = match self {
            Self::Still(pose) => return *pose,
            Self::Keys(keys) => keys,
        };
        let after = keys.partition_point(|key| key.seconds <= seconds);
        match (after.checked_sub(1).map(|before| keys[before]), keys.get(after)) {
            (Some(a), Some(b)) => {
                let share = (seconds - a.seconds) / (b.seconds - a.seconds);
                ObjectPose {
                    position: a.pose.position.lerp(b.pose.position, share),
                    facing: lerp_angle(a.pose.facing, b.pose.facing, share),
                }
            }
            (Some(a), None) => a.pose,
            (None, b) => b.map_or(ObjectPose::default(), |b| b.pose),
        }
    }
}

/// Pairs of carries that follow each other with the same object, by position in `carries`, in the order of the second ones.
pub fn hand_overs(carries: &[Carry]) -> impl Iterator<Item = (usize, usize)> {
    let mut last: BTreeMap<ObjectId, usize> = BTreeMap::new();
    carries.iter().enumerate().filter_map(move |(next, carry)| Some((last.insert(carry.object, next)?, next)))
}

/// Pairs of carries of different objects by the same hands, by position in `carries`, and whose these are; in the order of the
/// second ones. Cost: linear in carries, but for those of one character.
pub fn same_hands(carries: &[Carry]) -> Vec<(usize, usize, CharacterId)> {
    let mut of: BTreeMap<CharacterId, Vec<usize>> = BTreeMap::new();
    let mut pairs = Vec::new();
    for (second, carry) in carries.iter().enumerate() {
        for who in &carry.by {
            let own = of.entry(*who).or_default();
            let others = own.iter().filter(|first| carries[**first].object != carry.object);
            pairs.extend(others.map(|first| (*first, second, *who)));
            own.push(second);
        }
    }
    pairs
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Rounding of a few operations on numbers below 10.
    const ROUNDING: f64 = 1e-12;

    fn key(seconds: f64, x: f64, degrees: f64) -> ObjectKey {
        let pose = ObjectPose { position: DVec3::new(x, 0.5, -1.0), facing: degrees.to_radians() };
        ObjectKey { seconds, pose }
    }

    #[test]
    fn keys_are_met_and_between_them_the_way_is_straight_and_the_turn_the_shorter_one() {
        let course = Course::Keys(vec![key(1.0, 0.0, 170.0), key(3.0, 4.0, -170.0)]);
        assert_eq!(course.pose_at(0.0), key(1.0, 0.0, 170.0).pose);
        assert_eq!(course.pose_at(1.0), key(1.0, 0.0, 170.0).pose);
        assert_eq!(course.pose_at(9.0), key(3.0, 4.0, -170.0).pose);
        let middle = course.pose_at(2.0);
        assert!((middle.position.x - 2.0).abs() < ROUNDING);
        assert!((middle.facing.to_degrees() - 180.0).abs() < 1e-9);
        let last = course.pose_at(3.0 - 1e-12).facing;
        assert!(crate::geometry::wrap(last - (-170_f64).to_radians()).abs() < 1e-9);
    }

    #[test]
    fn axes_are_ahead_up_and_to_the_right() {
        let pose = ObjectPose::on_ground(c64::new(1.0, 2.0), 90_f64.to_radians());
        let ahead = pose.apply(DVec3::X);
        assert!((plan_of(ahead) - c64::new(1.0, 3.0)).norm() < ROUNDING);
        let right = pose.apply(DVec3::Z);
        assert!((plan_of(right) - c64::new(2.0, 2.0)).norm() < ROUNDING);
        assert!((pose.beside(c64::new(0.0, -1.0)) - plan_of(right)).norm() < ROUNDING);
    }

    proptest! {
        #[test]
        fn relative_undoes_compose(
            a in [-5.0..5.0_f64, 0.0..2.0, -5.0..5.0, -9.0..9.0],
            b in [-5.0..5.0_f64, 0.0..2.0, -5.0..5.0, -9.0..9.0],
        ) {
            let pose = |p: [f64; 4]| ObjectPose { position: DVec3::new(p[0], p[1], p[2]), facing: p[3] };
            let back = pose(a).compose(&pose(a).relative(&pose(b)));
            prop_assert!((back.position - pose(b).position).length() < ROUNDING);
            prop_assert!((back.facing - pose(b).facing).abs() < ROUNDING);
        }
    }
}
