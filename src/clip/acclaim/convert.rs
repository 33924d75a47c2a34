//! From the text of both files to a clip in the file's units and axes: angles to quaternions.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::{DQuat, DVec3};

use super::motion::{Columns, RawMotion};
use super::skeleton::{AngleUnit, Dof, RawSkeleton, Turns};
use crate::clip::Clip;
use crate::clip::roles::assign_roles;
use crate::index::{JointId, SourceFrame};
use crate::skeleton::{Axis, Joint, Skeleton};

/// The clip in the file's own units and axes; all frames usable.
pub(super) fn clip_in_file_units(
    skeleton: &RawSkeleton<'_>,
    columns: &Columns,
    motion: &RawMotion,
    name: &str,
    fps: f64,
) -> Clip {
    let mut joints = joints(skeleton);
    assign_roles(&mut joints);
    let turners = turners(skeleton);
    let rest = DVec3::from_array(skeleton.root.position);
    let mut root_positions = Vec::with_capacity(motion.frame_count);
    let mut rotations = Vec::with_capacity(motion.frame_count * joints.len());
    for frame in 0..motion.frame_count {
        let start = frame * columns.width();
        let row = &motion.values[start..start + columns.width()];
        root_positions.push(rest + displacement(columns, row));
        for (joint, turner) in turners.iter().enumerate() {
            let values = columns.starts[joint]..columns.starts[joint + 1];
            rotations.push(turner.rotation(&columns.dofs[values.clone()], &row[values]));
        }
    }
    Clip {
        name: name.to_owned(),
        skeleton: Arc::new(Skeleton { joints }),
        fps,
        root_positions,
        rotations,
        moving_offsets: Vec::new(),
        events: BTreeMap::new(),
        contacts: Vec::new(),
        usable: (SourceFrame(0), SourceFrame::from_usize(motion.frame_count - 1)),
    }
}

/// The root, then for each bone the joint at which it starts: where its parent ends.
fn joints(skeleton: &RawSkeleton<'_>) -> Vec<Joint> {
    let mut joints = vec![Joint {
        name: "root".to_owned(),
        parent: None,
        offset: DVec3::from_array(skeleton.root.position),
        end_site: None,
        rotation_order: rotation_order(&skeleton.root.dofs),
        role: None,
    }];
    let mut is_leaf = vec![true; skeleton.bones.len()];
    for bone in &skeleton.bones {
        if let Some(parent) = bone.parent {
            is_leaf[parent] = false;
        }
    }
    for (bone, is_leaf) in skeleton.bones.iter().zip(is_leaf) {
        let offset = bone.parent.map_or(DVec3::ZERO, |parent| skeleton.bones[parent].reach.into());
        let dofs: Vec<Dof> = bone.dofs.iter().copied().map(Dof::Turn).collect();
        joints.push(Joint {
            name: String::from_utf8_lossy(bone.name.bytes).into_owned(),
            parent: Some(JointId::from_usize(bone.parent.map_or(0, |parent| parent + 1))),
            offset,
            end_site: is_leaf.then(|| bone.reach.into()),
            rotation_order: rotation_order(&dofs),
            role: None,
        });
    }
    joints
}

/// Axes in the order of their product, in which what is turned first stands last; those without values come first.
fn rotation_order(dofs: &[Dof]) -> [Axis; 3] {
    let mut order: Vec<Axis> = dofs.iter().filter_map(turned_axis).collect();
    for axis in [Axis::X, Axis::Y, Axis::Z] {
        if !order.contains(&axis) {
            order.push(axis);
        }
    }
    [order[2], order[1], order[0]]
}

fn turned_axis(dof: &Dof) -> Option<Axis> {
    match dof {
        Dof::Turn(axis) => Some(*axis),
        Dof::Place(_) => None,
    }
}

/// Turns `before · M · after` of a joint, `M` being what the values of a frame say.
struct Turner {
    before: DQuat,
    after: DQuat,
}

impl Turner {
    fn rotation(&self, dofs: &[Dof], degrees: &[f64]) -> DQuat {
        let mut turn = DQuat::IDENTITY;
        for (dof, degrees) in dofs.iter().zip(degrees) {
            if let Dof::Turn(axis) = dof {
                turn = about(*axis, *degrees) * turn;
            }
        }
        self.before * turn * self.after
    }
}

/// Of the root, whose axes turn with its orientation; then of each bone, which turns about its own axes but whose
/// direction is written in the body's.
fn turners(skeleton: &RawSkeleton<'_>) -> Vec<Turner> {
    let root =
        Turner { before: rotation_of(skeleton.root.orientation, skeleton.angles), after: DQuat::IDENTITY };
    let bones = skeleton.bones.iter().map(|bone| {
        let axes = rotation_of(bone.axis, skeleton.angles);
        Turner { before: axes, after: axes.inverse() }
    });
    std::iter::once(root).chain(bones).collect()
}

fn rotation_of(turns: Turns, unit: AngleUnit) -> DQuat {
    let mut rotation = DQuat::IDENTITY;
    for axis in turns.order {
        let [x, y, z] = turns.angles;
        let angle = match axis {
            Axis::X => x,
            Axis::Y => y,
            Axis::Z => z,
        };
        rotation = about(axis, unit.to_degrees(angle)) * rotation;
    }
    rotation
}

fn about(axis: Axis, degrees: f64) -> DQuat {
    // Whole turns add nothing but rounding.
    let angle = (degrees % 360.0).to_radians();
    match axis {
        Axis::X => DQuat::from_rotation_x(angle),
        Axis::Y => DQuat::from_rotation_y(angle),
        Axis::Z => DQuat::from_rotation_z(angle),
    }
}

/// What the root's values add to its position.
fn displacement(columns: &Columns, row: &[f64]) -> DVec3 {
    let mut place = DVec3::ZERO;
    for (dof, value) in columns.dofs[..columns.starts[1]].iter().zip(row) {
        match dof {
            Dof::Place(Axis::X) => place.x = *value,
            Dof::Place(Axis::Y) => place.y = *value,
            Dof::Place(Axis::Z) => place.z = *value,
            Dof::Turn(_) => {}
        }
    }
    place
}
