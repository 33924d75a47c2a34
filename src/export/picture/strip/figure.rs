//! A simple clothed body around the joints of a pose: limbs as hulls of balls.
//!
//! Widths hold for a body of 1.75 m and scale with the legs. Feet are fitted to a frame in which they stand flat, the
//! head to how it is carried on average, so that no axis of the file's joints matters.

use glam::DVec3;

use super::fit::{Foot, fit_foot, fit_head, ground};
use super::landmarks::{Axes, Landmarks, Sides};
use crate::clip::Clip;
use crate::clip::contacts::{ContactPoint, contact_point, sampled_frames};
use crate::clip::roles::is_helper;
use crate::clip::working::WORKING_STEP;
use crate::export::gltf::body_mesh::body_scale;
use crate::index::JointId;
use crate::skeleton::{JointFrame, JointRole, Skeleton};

/// What a part of the body is drawn like.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Cloth {
    Shirt,
    PartnerShirt,
    Trousers,
    Skin,
    Hair,
    Shoe,
    Bone,
    Thing,
}

/// A ball of flesh, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Ball {
    /// In the world.
    pub(super) centre: DVec3,
    /// Above 0.
    pub(super) radius: f64,
}

/// The convex hull of balls.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Part {
    pub(super) cloth: Cloth,
    /// Has an outline.
    pub(super) rim: bool,
    /// Along the part, from its beginning to its end.
    pub(super) balls: Vec<Ball>,
}

/// Parts that share an outline, in drawing order.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Group {
    pub(super) kind: Kind,
    pub(super) parts: Vec<Part>,
    /// Added to how near the group is when groups are put in order, metres.
    pub(super) bias: f64,
}

/// What is drawn as one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Trunk,
    Head,
    Limb,
    Thing,
}

/// What is fitted to a whole clip, to draw any of its poses.
pub(super) struct Figure<'a> {
    skeleton: &'a Skeleton,
    /// Over a body of 1.75 m.
    scale: f64,
    /// Height of the ground, metres.
    pub(super) ground: f64,
    feet: Sides<Option<Foot>>,
    /// Joint that carries the head, with the head's axes in it.
    head: Option<(JointId, Axes)>,
}

/// Base of the neck to the base of the skull at most, metres: files put head joints anywhere up to the forehead.
const LONGEST_NECK: f64 = 0.1;
/// The neck stands out of the shirt, whichever is nearer by a little, metres.
const HEAD_BIAS: f64 = 0.05;
/// The outline of the seat is drawn first, metres: farther than any limb reaches.
const SEAT_BIAS: f64 = -5.0;
/// The shirt hangs over a stretched leg that is nearer by less, metres.
const LEG_BIAS: f64 = 0.12;

impl<'a> Figure<'a> {
    /// Fits a body to the usable frames of `clip`. Cost: linear in the clip.
    pub(super) fn new(clip: &'a Clip) -> Self {
        let skeleton = clip.skeleton.as_ref();
        let poses = sampled_frames(clip, clip.usable.0, clip.usable.1, clip.fps * WORKING_STEP);
        let rest: Vec<DVec3> =
            skeleton.forward_kinematics(&skeleton.rest_pose()).iter().map(|frame| frame.position).collect();
        let scale = body_scale(skeleton, &rest);
        let ground = ground(skeleton, &poses, scale);
        let feet = Sides::each(|side| {
            let (heel, toe) = side.pick(
                (ContactPoint::LeftHeel, ContactPoint::LeftToe),
                (ContactPoint::RightHeel, ContactPoint::RightToe),
            );
            fit_foot(&poses, contact_point(skeleton, heel)?, contact_point(skeleton, toe), (ground, scale))
        });
        Self { skeleton, scale, ground, feet, head: fit_head(skeleton, &poses) }
    }

    /// The body in one pose, of which `frames` are the world frames of all joints.
    pub(super) fn groups(&self, frames: &[JointFrame]) -> Vec<Group> {
        let Some(marks) = Landmarks::of(self.skeleton, frames) else {
            return self.bones(frames);
        };
        let group = |kind, parts, bias| Group { kind, parts, bias };
        let trunk = self.trunk(&marks);
        let seat =
            trunk.iter().filter(|part| !part.rim).map(|part| Part { rim: true, ..part.clone() }).collect();
        let mut groups = vec![
            group(Kind::Trunk, seat, SEAT_BIAS),
            group(Kind::Trunk, trunk, 0.0),
            group(Kind::Head, self.head(&marks, frames), HEAD_BIAS),
        ];
        for side in Sides::<()>::BOTH {
            let (arm, leg) = (marks.arms.get(side), marks.legs.get(side));
            groups.push(group(Kind::Limb, self.arm(arm, marks.axes, frames), 0.0));
            let parts = self.leg(leg, self.feet.get(side).as_ref(), frames);
            groups.push(group(Kind::Limb, parts, leg_bias(leg, marks.hip_axes, frames)));
        }
        groups.retain(|group| !group.parts.is_empty());
        groups
    }

    fn part(&self, cloth: Cloth, balls: &[(DVec3, f64)]) -> Part {
        let balls =
            balls.iter().map(|(centre, radius)| Ball { centre: *centre, radius: radius * self.scale });
        Part { cloth, rim: true, balls: balls.collect() }
    }

    fn trunk(&self, marks: &Landmarks) -> Vec<Part> {
        let s = self.scale;
        let Axes { left, ahead, up } = marks.hip_axes;
        let (hips, middle, top) = (marks.hips, marks.middle, marks.top);
        let seat =
            |sign: f64| (hips + left * (sign * 0.062 * s) + up * (0.01 * s) - ahead * (0.008 * s), 0.098);
        let waist = hips.lerp(middle, 0.55);
        let pelvis = self.part(Cloth::Trousers, &[seat(1.0), seat(-1.0), (waist - up * (0.03 * s), 0.1)]);
        // Its outline lies behind everything: none runs across trousers.
        let pelvis = Part { rim: false, ..pelvis };
        let belly = |sign: f64| (waist + left * (sign * 0.035 * s) + ahead * (0.006 * s), 0.098);
        let ribs = |sign: f64| (middle + marks.axes.left * (sign * 0.06 * s), 0.102);
        let lower = self.part(Cloth::Shirt, &[belly(1.0), belly(-1.0), ribs(1.0), ribs(-1.0)]);
        let chest = middle.lerp(top, 0.6);
        let breast =
            |sign: f64| (chest + marks.axes.left * (sign * 0.075 * s) + marks.axes.ahead * (0.012 * s), 0.1);
        let mut upper = vec![ribs(1.0), ribs(-1.0), breast(1.0), breast(-1.0)];
        upper.push((marks.neck - marks.axes.up * (0.025 * s), 0.062));
        upper.extend(marks.shoulders.iter().map(|shoulder| (top.lerp(*shoulder, 0.8), 0.056)));
        vec![pelvis, lower, self.part(Cloth::Shirt, &upper)]
    }

    /// Neck and head; hair before or after the face is settled by depth.
    fn head(&self, marks: &Landmarks, frames: &[JointFrame]) -> Vec<Part> {
        let s = self.scale;
        let (base, Axes { ahead, up, .. }) = match &self.head {
            Some((joint, axes)) => {
                let frame = frames[joint.as_usize()];
                let axes = axes.turned(frame.rotation);
                let is_head = self.skeleton.joints[joint.as_usize()].role == Some(JointRole::Head);
                let neck = if is_head { frame.position - marks.neck } else { axes.up * s };
                (marks.neck + neck.clamp_length_max(LONGEST_NECK * s), axes)
            }
            None => (marks.neck + marks.axes.up * (LONGEST_NECK * s), marks.axes),
        };
        let at = |upwards: f64, forward: f64| base + up * (upwards * s) + ahead * (forward * s);
        let neck = self.part(Cloth::Skin, &[(marks.neck, 0.052), (at(0.03, -0.005), 0.05)]);
        let face = self.part(Cloth::Skin, &[(at(0.108, 0.018), 0.084), (at(0.028, 0.052), 0.043)]);
        let nose = self.part(Cloth::Skin, &[(at(0.092, 0.092), 0.012), (at(0.062, 0.106), 0.015)]);
        let hair = self.part(Cloth::Hair, &[(at(0.142, -0.012), 0.077), (at(0.085, -0.042), 0.057)]);
        vec![neck, nose, face, hair]
    }

    /// From the shoulder on; `joints`: shoulder, elbow, wrist as far as they are known.
    fn arm(&self, joints: &[Option<JointId>; 3], axes: Axes, frames: &[JointFrame]) -> Vec<Part> {
        let [Some(shoulder), Some(elbow), wrist] = *joints else {
            return Vec::new();
        };
        let place = |joint: JointId| frames[joint.as_usize()].position;
        let upper = self.part(Cloth::Shirt, &[(place(shoulder), 0.057), (place(elbow), 0.044)]);
        let Some(wrist) = wrist else {
            let end = self.end_of(elbow, frames).unwrap_or(place(elbow) - axes.up * (0.25 * self.scale));
            return vec![self.part(Cloth::Skin, &[(place(elbow), 0.04), (end, 0.03)]), upper];
        };
        let along = (place(wrist) - place(elbow)).normalize_or(-axes.up);
        let hand = self.end_of(wrist, frames).map_or(along, |end| (end - place(wrist)).normalize_or(along));
        let fore = self.part(Cloth::Skin, &[(place(elbow), 0.041), (place(wrist), 0.028)]);
        let fist = [
            (place(wrist) + hand * (0.02 * self.scale), 0.03),
            (place(wrist) + hand * (0.09 * self.scale), 0.032),
        ];
        vec![self.part(Cloth::Skin, &fist), fore, upper]
    }

    /// From the hip on; `joints`: hip, knee, ankle as far as they are known.
    fn leg(&self, joints: &[Option<JointId>; 3], foot: Option<&Foot>, frames: &[JointFrame]) -> Vec<Part> {
        let [Some(hip), Some(knee), ankle] = *joints else {
            return Vec::new();
        };
        let place = |joint: JointId| frames[joint.as_usize()].position;
        let thigh = self.part(Cloth::Trousers, &[(place(hip), 0.088), (place(knee), 0.059)]);
        let end = ankle.map(place).or_else(|| self.end_of(knee, frames));
        let Some(ankle) = end else {
            return vec![thigh];
        };
        let calf = place(knee).lerp(ankle, 0.3);
        let shank = self.part(Cloth::Trousers, &[(place(knee), 0.058), (calf, 0.058), (ankle, 0.04)]);
        let shoe = foot.map_or(Vec::new(), |foot| {
            let [heel, ball, tip] = [foot.heel, foot.ball, foot.tip].map(|point| point.place(frames));
            vec![
                self.part(Cloth::Shoe, &[(ball, 0.036), (tip, 0.027)]),
                self.part(Cloth::Shoe, &[(ankle, 0.042), (heel, 0.037), (ball, 0.037)]),
            ]
        });
        shoe.into_iter().chain([shank, thigh]).collect()
    }

    /// End of the segment below `joint` in the world: its end site, else its first joint.
    fn end_of(&self, joint: JointId, frames: &[JointFrame]) -> Option<DVec3> {
        let frame = frames[joint.as_usize()];
        let plausible = |end: &DVec3| (0.02..0.6).contains(&(frame.position.distance(*end) / self.scale));
        let site =
            self.skeleton.joints[joint.as_usize()].end_site.map(|end| frame.position + frame.rotation * end);
        let below = self
            .skeleton
            .joints
            .iter()
            .zip(frames)
            .filter(|(below, _)| below.parent == Some(joint) && !is_helper(&below.name));
        below.map(|(_, frame)| frame.position).chain(site).find(plausible)
    }

    /// Thin bones, each by itself, for bodies of which too little is known.
    fn bones(&self, frames: &[JointFrame]) -> Vec<Group> {
        let mut groups = Vec::new();
        for (index, joint) in
            self.skeleton.joints.iter().enumerate().filter(|(_, joint)| !is_helper(&joint.name))
        {
            let frame = frames[index];
            let site = joint.end_site.map(|end| frame.position + frame.rotation * end);
            let above = joint.parent.map(|parent| frames[parent.as_usize()].position);
            for other in above.into_iter().chain(site) {
                let parts = vec![self.part(Cloth::Bone, &[(other, 0.026), (frame.position, 0.022)])];
                groups.push(Group { kind: Kind::Limb, parts, bias: 0.0 });
            }
        }
        groups
    }
}

/// How far a leg steps back behind the shirt: all the way when stretched, not at all when the thigh is raised.
fn leg_bias(joints: &[Option<JointId>; 3], axes: Axes, frames: &[JointFrame]) -> f64 {
    let [Some(hip), Some(knee), _] = *joints else {
        return 0.0;
    };
    let thigh = frames[knee.as_usize()].position - frames[hip.as_usize()].position;
    LEG_BIAS * thigh.normalize_or_zero().dot(axes.up).min(0.0)
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;
    use crate::clip::builtin::generate;
    use crate::index::SourceFrame;

    fn lowest_and_highest(clip: &Clip, frame: u32) -> (f64, f64) {
        let figure = Figure::new(clip);
        let frames = clip.skeleton.forward_kinematics(&clip.pose(SourceFrame(frame)));
        let groups = figure.groups(&frames);
        let balls = groups.iter().flat_map(|group| &group.parts).flat_map(|part| &part.balls);
        balls.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), ball| {
            (low.min(ball.centre.y - ball.radius), high.max(ball.centre.y + ball.radius))
        })
    }

    #[test]
    fn who_stands_stands_on_the_ground_and_is_as_tall_as_asked() {
        for stature in [1.3, 1.75, 2.1] {
            let asked = BTreeMap::from([("stature".to_owned(), stature)]);
            let idle = generate("idle", &asked).expect("a generated clip");
            let (low, high) = lowest_and_highest(&idle, 10);
            // A fist's breadth: shoes have soles, heads have hair.
            assert!(low.abs() < 0.03, "{low}");
            assert!((high - stature).abs() < 0.08 * stature, "{high} for {stature}");
        }
    }

    #[test]
    fn a_body_without_hips_is_drawn_as_bones() {
        let mut idle = generate("idle", &BTreeMap::new()).expect("a generated clip");
        let mut skeleton = idle.skeleton.as_ref().clone();
        skeleton.joints.iter_mut().for_each(|joint| joint.role = None);
        idle.skeleton = skeleton.into();
        let figure = Figure::new(&idle);
        let frames = idle.skeleton.forward_kinematics(&idle.pose(SourceFrame(0)));
        let groups = figure.groups(&frames);
        assert!(groups.len() >= idle.skeleton.joints.len() - 1);
        assert!(groups.iter().flat_map(|group| &group.parts).all(|part| part.cloth == Cloth::Bone));
    }
}
