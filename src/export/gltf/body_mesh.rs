//! A simple body around a skeleton: a tapered limb along every bone, each bound to one joint.

use std::f64::consts::TAU;

use glam::DVec3;

use crate::skeleton::{JointRole, Skeleton};

/// Triangles in the rest pose, each vertex moved by one joint.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct BodyMesh {
    pub(super) positions: Vec<DVec3>,
    pub(super) normals: Vec<DVec3>,
    /// Joint of each vertex.
    pub(super) joints: Vec<usize>,
    pub(super) triangles: Vec<[usize; 3]>,
}

/// A limb along a bone, in the rest pose, metres.
struct Limb {
    joint: usize,
    from: DVec3,
    to: DVec3,
    /// Half width across and half depth, at its start and at its end.
    girth: [[f64; 2]; 2],
}

/// Sides of a limb's cross section.
const SIDES: usize = 8;
/// Bones shorter than this get no limb, metres.
const SHORTEST: f64 = 1e-3;

/// The body of `skeleton` in its rest pose. Joints without a role get limbs only where they lie between joints that have
/// one; a skeleton without any role gets thin bones everywhere.
pub(super) fn body_mesh(skeleton: &Skeleton) -> BodyMesh {
    let rest: Vec<DVec3> =
        skeleton.forward_kinematics(&skeleton.rest_pose()).iter().map(|frame| frame.position).collect();
    let scale = body_scale(skeleton, &rest);
    let across = across(skeleton, &rest);
    let mut mesh = BodyMesh::default();
    for limb in limbs(skeleton, &rest, scale) {
        if limb.from.distance(limb.to) > SHORTEST {
            mesh.add_limb(&limb, across);
        }
    }
    mesh.compute_normals();
    mesh
}

impl BodyMesh {
    /// Rings of vertices along the limb, closed by a low dome at each end.
    fn add_limb(&mut self, limb: &Limb, body_across: DVec3) {
        let axis = limb.to - limb.from;
        let along = axis.normalize();
        // A limb stretched sideways, as an arm at rest, is broad where a body is deep.
        let reference = if along.dot(body_across).abs() > 0.7 {
            body_across.cross(DVec3::Y).normalize()
        } else {
            body_across
        };
        let across = reference.reject_from(along).normalize();
        let depth = along.cross(across);
        let [start, end] = limb.girth;
        let dome = |girth: [f64; 2]| 0.5 * girth[0].min(girth[1]);
        let rings = [
            (limb.from - along * (0.7 * dome(start)), start.map(|half| 0.65 * half)),
            (limb.from + axis * 0.02, start),
            (limb.to - axis * 0.02, end),
            (limb.to + along * (0.7 * dome(end)), end.map(|half| 0.65 * half)),
        ];
        let first = self.positions.len();
        for (middle, half) in rings {
            for side in 0..SIDES {
                let angle = TAU * side as f64 / SIDES as f64;
                self.positions
                    .push(middle + across * (half[0] * angle.cos()) + depth * (half[1] * angle.sin()));
            }
        }
        self.positions.push(limb.from - along * dome(start));
        self.positions.push(limb.to + along * dome(end));
        self.joints.resize(self.positions.len(), limb.joint);
        self.close(first, rings.len());
    }

    /// Triangles of a limb with `rings` rings and two poles whose vertices start at `first`.
    fn close(&mut self, first: usize, rings: usize) {
        let vertex = |ring: usize, side: usize| first + ring * SIDES + side % SIDES;
        let (bottom, top) = (first + rings * SIDES, first + rings * SIDES + 1);
        for side in 0..SIDES {
            for ring in 1..rings {
                let [a, b] = [vertex(ring - 1, side), vertex(ring - 1, side + 1)];
                let [c, d] = [vertex(ring, side), vertex(ring, side + 1)];
                self.triangles.push([a, b, d]);
                self.triangles.push([a, d, c]);
            }
            self.triangles.push([bottom, vertex(0, side + 1), vertex(0, side)]);
            self.triangles.push([top, vertex(rings - 1, side), vertex(rings - 1, side + 1)]);
        }
    }

    /// Normal of a vertex: mean of its triangles' normals, larger ones counting more.
    fn compute_normals(&mut self) {
        self.normals = vec![DVec3::ZERO; self.positions.len()];
        for triangle in &self.triangles {
            let [a, b, c] = triangle.map(|vertex| self.positions[vertex]);
            let normal = (b - a).cross(c - a);
            for vertex in triangle {
                self.normals[*vertex] += normal;
            }
        }
        for normal in &mut self.normals {
            *normal = normal.normalize_or(DVec3::Y);
        }
    }
}

/// How large the body is against one of 1.75 m: by its legs, else by its height.
pub(in crate::export) fn body_scale(skeleton: &Skeleton, rest: &[DVec3]) -> f64 {
    let place = |role| skeleton.joint_of(role).map(|joint| rest[joint.as_usize()]);
    let leg = [JointRole::LeftHip, JointRole::LeftKnee, JointRole::LeftFoot].map(place);
    if let [Some(hip), Some(knee), Some(ankle)] = leg {
        let length = hip.distance(knee) + knee.distance(ankle);
        if length > 0.1 {
            return length / 0.82;
        }
    }
    let lowest = rest.iter().map(|p| p.y).fold(f64::INFINITY, f64::min);
    let highest = rest.iter().map(|p| p.y).fold(f64::NEG_INFINITY, f64::max);
    ((highest - lowest) / 1.5).clamp(0.2, 2.0)
}

/// Left of the body at rest.
fn across(skeleton: &Skeleton, rest: &[DVec3]) -> DVec3 {
    let place = |role| skeleton.joint_of(role).map(|joint| rest[joint.as_usize()]);
    match (place(JointRole::LeftHip), place(JointRole::RightHip)) {
        (Some(left), Some(right)) => (left - right).with_y(0.0).normalize_or(DVec3::X),
        _ => DVec3::X,
    }
}

fn limbs(skeleton: &Skeleton, rest: &[DVec3], scale: f64) -> Vec<Limb> {
    let joints = &skeleton.joints;
    let roleless = joints.iter().all(|joint| joint.role.is_none());
    // The role a joint has or, through helpers, leads to.
    let mut leads_to: Vec<Option<JointRole>> = joints.iter().map(|joint| joint.role).collect();
    for (index, joint) in joints.iter().enumerate().rev() {
        if let Some(parent) = joint.parent
            && leads_to[parent.as_usize()].is_none()
        {
            leads_to[parent.as_usize()] = leads_to[index];
        }
    }
    let mut limbs = Vec::new();
    for (index, joint) in joints.iter().enumerate() {
        if let Some(parent) = joint.parent
            && (roleless || leads_to[index].is_some())
        {
            let above = role_above(skeleton, index);
            let girth = scaled(girth(above, leads_to[index]), scale);
            limbs.push(Limb {
                joint: parent.as_usize(),
                from: rest[parent.as_usize()],
                to: rest[index],
                girth,
            });
        }
        let is_last = !joints.iter().enumerate().any(|(child, below)| {
            below.parent.is_some_and(|parent| parent.as_usize() == index) && leads_to[child].is_some()
        });
        if (joint.role.is_some() || roleless) && is_last {
            limbs.extend(last_limb(skeleton, rest, index, scale));
        }
    }
    limbs
}

/// Role of the nearest joint above `index` that has one.
fn role_above(skeleton: &Skeleton, index: usize) -> Option<JointRole> {
    let mut above = skeleton.joints[index].parent;
    while let Some(joint) = above {
        let joint = &skeleton.joints[joint.as_usize()];
        if joint.role.is_some() {
            return joint.role;
        }
        above = joint.parent;
    }
    None
}

/// Limb from a joint that nothing with a role follows: to its end site, else a guess for heads and hands.
fn last_limb(skeleton: &Skeleton, rest: &[DVec3], index: usize, scale: f64) -> Option<Limb> {
    let joint = &skeleton.joints[index];
    let guess = match joint.role {
        Some(JointRole::Head) => Some(DVec3::Y * (0.18 * scale)),
        Some(JointRole::LeftHand | JointRole::RightHand) => {
            Some(joint.offset.normalize_or_zero() * (0.16 * scale))
        }
        _ => None,
    };
    let end =
        joint.end_site.filter(|end| end.length() > 0.02 * scale && end.length() < 0.5 * scale).or(guess)?;
    Some(Limb {
        joint: index,
        from: rest[index],
        to: rest[index] + end,
        girth: scaled(girth(joint.role, None), scale),
    })
}

/// Half widths and half depths of the limb between two roles, for a body of 1.75 m, metres.
fn girth(from: Option<JointRole>, to: Option<JointRole>) -> [[f64; 2]; 2] {
    use JointRole as R;
    match (from, to) {
        (Some(R::Pelvis), Some(R::LeftHip | R::RightHip)) => [[0.09, 0.09], [0.085, 0.09]],
        (Some(R::Pelvis), Some(_)) => [[0.15, 0.10], [0.135, 0.09]],
        (_, Some(R::LeftClavicle | R::RightClavicle)) => [[0.07, 0.08], [0.06, 0.07]],
        (_, Some(R::LeftShoulder | R::RightShoulder)) => [[0.065, 0.06], [0.06, 0.055]],
        (Some(R::Spine), Some(_)) => [[0.135, 0.09], [0.16, 0.105]],
        (Some(R::Chest), Some(_)) => [[0.165, 0.11], [0.085, 0.07]],
        (Some(R::Neck), _) => [[0.052, 0.055], [0.05, 0.055]],
        (Some(R::Head), _) => [[0.066, 0.082], [0.062, 0.078]],
        (Some(R::LeftShoulder | R::RightShoulder), _) => [[0.052, 0.05], [0.042, 0.042]],
        (Some(R::LeftElbow | R::RightElbow), _) => [[0.042, 0.042], [0.03, 0.027]],
        (Some(R::LeftHand | R::RightHand), _) => [[0.042, 0.02], [0.034, 0.014]],
        (Some(R::LeftHip | R::RightHip), _) => [[0.085, 0.09], [0.056, 0.06]],
        (Some(R::LeftKnee | R::RightKnee), _) => [[0.054, 0.06], [0.036, 0.042]],
        (Some(R::LeftFoot | R::RightFoot), _) => [[0.038, 0.04], [0.046, 0.022]],
        (Some(R::LeftToe | R::RightToe), _) => [[0.045, 0.02], [0.038, 0.015]],
        _ => [[0.02, 0.02], [0.015, 0.015]],
    }
}

fn scaled(girth: [[f64; 2]; 2], scale: f64) -> [[f64; 2]; 2] {
    girth.map(|half| half.map(|width| width * scale))
}
