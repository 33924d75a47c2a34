//! Builds a body model: segments from chains of joints.

use glam::{DMat3, DVec3};

use super::parts::{ARMS, LEGS, Parts, SAME_PLACE};
use super::shape::{Shape, grown, inertia_tensor, principal_moments};
use super::table::{REFERENCE_MASS, Segment, TRUNK, UPPER_TRUNK, UPPER_TRUNK_CENTER, length};
use super::{BodyError, BodyModel, BodySettings, Link, MassTable};
use crate::index::JointId;
use crate::skeleton::{JointRole, Skeleton};

/// A piece of bone from the joint that turns it.
struct Piece {
    joint: JointId,
    /// From the joint to the proximal and the distal end, rest axes, metres.
    ends: [DVec3; 2],
    segment: Segment,
    /// Share of the body's mass.
    fraction: f64,
    /// Of the mass along the piece, share of its length.
    center: f64,
}

struct Builder<'a> {
    parts: Parts<'a>,
    stature: f64,
    /// Lateral axis (to the left) and the one ahead, rest axes, unit.
    axes: [DVec3; 2],
    pieces: Vec<Piece>,
}

pub(super) fn build(skeleton: &Skeleton, settings: &BodySettings) -> Result<BodyModel, BodyError> {
    if !(settings.mass.is_finite() && settings.mass > 0.0) {
        return Err(BodyError::NoMass { mass: settings.mass });
    }
    let parts = Parts::of(skeleton);
    for (leg, side) in LEGS.iter().zip(["left", "right"]) {
        if !parts.has(&leg[..3]) {
            return Err(BodyError::NoLeg { side, joints: parts.names() });
        }
    }
    let stature = stature(&parts)?;
    let axes = rest_axes(&parts);
    let mut builder = Builder { parts, stature, axes, pieces: Vec::new() };
    builder.legs();
    builder.trunk()?;
    builder.head();
    builder.arms();
    Ok(weigh(builder, settings))
}

/// By the legs' length, mean of both.
fn stature(parts: &Parts<'_>) -> Result<f64, BodyError> {
    let of = |[hip, knee, foot, _]: [JointRole; 4]| {
        let places = [hip, knee, foot].map(|role| parts.place(role).unwrap_or_default());
        places[0].distance(places[1]) + places[1].distance(places[2])
    };
    let length = 0.5 * (of(LEGS[0]) + of(LEGS[1]));
    let stature = length / length::LEG;
    // Dolls and giants are bodies; a point or an overflow is none.
    if stature.is_finite() && stature > 1e-3 { Ok(stature) } else { Err(BodyError::NoStature { length }) }
}

fn rest_axes(parts: &Parts<'_>) -> [DVec3; 2] {
    let [left, right] = LEGS.map(|leg| parts.place(leg[0]).unwrap_or_default());
    let flat = DVec3::new(left.x - right.x, 0.0, left.z - right.z);
    let lateral = flat.try_normalize().unwrap_or(DVec3::X);
    [lateral, lateral.cross(DVec3::Y)]
}

impl Builder<'_> {
    fn legs(&mut self) {
        for [hip, knee, foot, toe] in LEGS {
            self.limb(hip, knee, Segment::Thigh);
            self.limb(knee, foot, Segment::Shank);
            let Some(ankle) = self.parts.joint(foot) else { continue };
            let ball = self.parts.place(toe).map(|place| place - self.parts.at(ankle));
            let end = self.parts.skeleton.joints[ankle.as_usize()].end_site;
            let likely = |to: &DVec3| (0.03..0.2).contains(&(to.length() / self.stature));
            let ahead = self.axes[1] * length::ANKLE_TO_BALL - DVec3::Y * length::ANKLE_HEIGHT;
            let to = ball.filter(likely).or(end.filter(likely)).unwrap_or(ahead * self.stature);
            self.piece(ankle, [DVec3::ZERO, to], Segment::Foot, 1.0);
        }
    }

    fn arms(&mut self) {
        for [shoulder, elbow, hand] in ARMS {
            let (Some(upper), Some(fore)) = (self.parts.joint(shoulder), self.parts.joint(elbow)) else {
                continue;
            };
            self.limb(shoulder, elbow, Segment::UpperArm);
            let along = (self.parts.at(fore) - self.parts.at(upper)).normalize_or(self.axes[0]);
            let end = self.parts.skeleton.joints[fore.as_usize()].end_site;
            let likely = |to: &DVec3| (0.05..0.25).contains(&(to.length() / self.stature));
            let wrist = end.filter(likely).unwrap_or(along * length::FOREARM * self.stature);
            match self.parts.joint(hand) {
                Some(joint) => {
                    self.limb(elbow, hand, Segment::Forearm);
                    let along = (self.parts.at(joint) - self.parts.at(fore)).normalize_or(along);
                    let to = self.knuckle(joint).unwrap_or(along * length::HAND * self.stature);
                    self.piece(joint, [DVec3::ZERO, to], Segment::Hand, 1.0);
                }
                None => {
                    self.piece(fore, [DVec3::ZERO, wrist], Segment::Forearm, 1.0);
                    let tip = wrist + wrist.normalize_or(along) * length::HAND * self.stature;
                    self.piece(fore, [wrist, tip], Segment::Hand, 1.0);
                }
            }
        }
    }

    /// From the wrist to the nearest joint or end site below it that can be a knuckle.
    fn knuckle(&self, hand: JointId) -> Option<DVec3> {
        let wrist = self.parts.at(hand);
        let own = std::iter::once(hand).chain(self.parts.below(hand));
        let places = own.flat_map(|joint| {
            let end = self.parts.skeleton.joints[joint.as_usize()].end_site;
            let at = self.parts.at(joint);
            [Some(at - wrist), end.map(|end| at + end - wrist)]
        });
        // Nearer is a thumb, farther a stray end site.
        let likely = |to: &DVec3| (0.03..0.15).contains(&(to.length() / self.stature));
        places.flatten().filter(likely).min_by(|a, b| a.length().total_cmp(&b.length()))
    }

    /// Joints below the pelvis up to the chest, then the middle of the shoulders.
    fn trunk(&mut self) -> Result<(), BodyError> {
        let pelvis = self.parts.joint(JointRole::Pelvis).unwrap_or(JointId(0));
        let top = self.top();
        let top_joint =
            [JointRole::Chest, JointRole::Spine].into_iter().find_map(|role| self.parts.joint(role));
        let chain = top_joint.map_or(Vec::new(), |chest| self.parts.chain(pelvis, chest));
        let Some(top) = top.or(chain.last().map(|chest| self.parts.at(*chest))) else {
            return Err(BodyError::NoTrunk { joints: self.parts.names() });
        };
        let from = self.parts.at(pelvis);
        let Some(first) = chain.get(1) else {
            // From the hips up: the root of such a skeleton may be anywhere along the trunk.
            let hips = self.parts.middle(LEGS[0][0], LEGS[1][0]).unwrap_or(from);
            let share = TRUNK / Segment::Pelvis.fraction();
            self.piece(pelvis, [hips - from, top - from], Segment::Pelvis, share);
            return Ok(());
        };
        let waist = self.parts.at(*first);
        self.piece(pelvis, [DVec3::ZERO, waist - from], Segment::Pelvis, 1.0);
        self.spine(&chain[1..], top);
        Ok(())
    }

    /// Upper end of the trunk: the middle of the shoulders or the neck, whichever is lower (rest poses may raise the shoulders, or bend
    /// the neck high up), else the head.
    fn top(&self) -> Option<DVec3> {
        let shoulders = self.parts.middle(ARMS[0][0], ARMS[1][0]);
        let ends = [shoulders, self.parts.place(JointRole::Neck)];
        let lower = ends.into_iter().flatten().min_by(|a, b| a.y.total_cmp(&b.y));
        lower.or_else(|| self.parts.place(JointRole::Head))
    }

    /// Shares abdomen and thorax among `joints` (from below), the last of which reaches up to `top`.
    fn spine(&mut self, joints: &[JointId], top: DVec3) {
        let places: Vec<DVec3> = joints.iter().map(|joint| self.parts.at(*joint)).chain([top]).collect();
        // What lies at shoulder height, or above it, has no length.
        let up = (top - places[0]).normalize_or(DVec3::Y);
        let lengths: Vec<f64> = places.windows(2).map(|ends| (ends[1] - ends[0]).dot(up).max(0.0)).collect();
        let bearing: Vec<usize> = (0..joints.len()).filter(|&at| lengths[at] > SAME_PLACE).collect();
        let total: f64 = bearing.iter().map(|&at| lengths[at]).sum();
        let ends = |at: usize| [DVec3::ZERO, places[at + 1] - places[at]];
        match bearing[..] {
            [] => self.upper_trunk(joints[0], ends(0), Segment::Thorax, UPPER_TRUNK, UPPER_TRUNK_CENTER),
            [at] => self.upper_trunk(joints[at], ends(at), Segment::Thorax, UPPER_TRUNK, UPPER_TRUNK_CENTER),
            [abdomen, thorax] if lengths[abdomen].min(lengths[thorax]) > 0.05 * self.stature => {
                self.piece(joints[abdomen], ends(abdomen), Segment::Abdomen, 1.0);
                self.piece(joints[thorax], ends(thorax), Segment::Thorax, 1.0);
            }
            _ => {
                let mut below = 0.0;
                let segments: Vec<Segment> = bearing
                    .iter()
                    .map(|&at| {
                        let middle = (below + 0.5 * lengths[at]) / total;
                        below += lengths[at];
                        let is_low = middle < Segment::Abdomen.fraction() / UPPER_TRUNK;
                        if is_low { Segment::Abdomen } else { Segment::Thorax }
                    })
                    .collect();
                for (&at, segment) in bearing.iter().zip(&segments) {
                    let alike = bearing.iter().zip(&segments).filter(|(_, other)| *other == segment);
                    let length: f64 = alike.map(|(&other, _)| lengths[other]).sum();
                    let has_both =
                        segments.contains(&Segment::Abdomen) && segments.contains(&Segment::Thorax);
                    let fraction = if has_both { segment.fraction() } else { UPPER_TRUNK };
                    self.upper_trunk(joints[at], ends(at), *segment, fraction * lengths[at] / length, 0.5);
                }
            }
        }
    }

    fn upper_trunk(
        &mut self,
        joint: JointId,
        ends: [DVec3; 2],
        segment: Segment,
        fraction: f64,
        center: f64,
    ) {
        self.pieces.push(Piece { joint, ends, segment, fraction, center });
    }

    /// The ear canal is at the joint of the head where the neck has its own, else at the end site, but no higher than ears are.
    fn head(&mut self) {
        let (neck, head) = (self.parts.joint(JointRole::Neck), self.parts.joint(JointRole::Head));
        if let (Some(neck), Some(head)) = (neck, head) {
            let from = self.parts.at(neck) - self.parts.at(head);
            if from.length() > SAME_PLACE {
                let ear = from - from.clamp_length_max(length::EAR_ABOVE_NECK * self.stature);
                self.piece(head, [from, ear], Segment::Head, 1.0);
                return;
            }
        }
        let up = DVec3::Y * (length::EAR_ABOVE_SHOULDER * self.stature);
        let chest = self.parts.joint(JointRole::Chest);
        let Some(joint) = head.or(neck).or(chest) else { return };
        let end = self.parts.skeleton.joints[joint.as_usize()].end_site;
        let likely = end.filter(|end| (0.03..0.25).contains(&(end.length() / self.stature)));
        let ear = likely.map_or(up, |end| end.clamp_length_max(up.length()));
        self.piece(joint, [DVec3::ZERO, ear], Segment::Head, 1.0);
    }

    /// A segment between the joints of two roles; joints between them share its mass by length.
    fn limb(&mut self, above: JointRole, below: JointRole, segment: Segment) {
        let (Some(above), Some(below)) = (self.parts.joint(above), self.parts.joint(below)) else {
            return;
        };
        let chain = self.parts.chain(above, below);
        let bones: Vec<(JointId, DVec3)> =
            chain.windows(2).map(|pair| (pair[0], self.parts.at(pair[1]) - self.parts.at(pair[0]))).collect();
        let total: f64 = bones.iter().map(|(_, bone)| bone.length()).sum();
        for (joint, bone) in bones {
            if bone.length() > 0.0 {
                self.piece(joint, [DVec3::ZERO, bone], segment, bone.length() / total);
            }
        }
    }

    /// `share`: of the segment's mass.
    fn piece(&mut self, joint: JointId, ends: [DVec3; 2], segment: Segment, share: f64) {
        let (fraction, center) = (share * segment.fraction(), segment.center());
        self.pieces.push(Piece { joint, ends, segment, fraction, center });
    }
}

/// Pieces with their masses; those of Winter's table together weigh what is asked for, those of Xiao's what that prints.
fn weigh(builder: Builder<'_>, settings: &BodySettings) -> BodyModel {
    let Builder { mut pieces, axes, stature, .. } = builder;
    pieces.sort_by_key(|piece| piece.joint);
    let found: f64 = pieces.iter().map(|piece| piece.fraction).sum();
    let links: Vec<Link> = pieces
        .into_iter()
        .map(|piece| {
            let mass = piece.fraction / found * settings.mass;
            let printed = piece.segment.xiao_mass() / (piece.segment.fraction() * REFERENCE_MASS);
            let factor = if settings.table == MassTable::Xiao2005 { printed } else { 1.0 };
            let inertia = inertia(&piece, mass * factor, axes);
            let com = piece.ends[0].lerp(piece.ends[1], piece.center);
            Link { joint: piece.joint, segment: piece.segment, mass: mass * factor, com, inertia }
        })
        .collect();
    BodyModel { mass: links.iter().map(|link| link.mass).sum(), links, stature }
}

/// Cylinders are as long as the bone is, boxes keep their proportions.
fn inertia(piece: &Piece, mass: f64, axes: [DVec3; 2]) -> DMat3 {
    let bone = piece.ends[1] - piece.ends[0];
    let shape = match piece.segment.reference_shape() {
        Shape::Cylinder { .. } => Shape::Cylinder { length: bone.length().max(SAME_PLACE) },
        shape => grown(shape, mass / (piece.segment.fraction() * REFERENCE_MASS)),
    };
    let moments = principal_moments(shape, mass, piece.segment.density());
    inertia_tensor(moments, bone.normalize_or(DVec3::Y), axes)
}
