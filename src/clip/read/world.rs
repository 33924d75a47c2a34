//! From the units and axes of a file to metres with y up.

use std::sync::Arc;

use glam::{DQuat, DVec3};

use super::Up;
use crate::clip::Clip;
use crate::skeleton::Axis;

/// Turns a clip in file units and axes into one in metres with y up.
pub(super) fn to_world(clip: &mut Clip, unit_to_m: f64, up: Up) {
    let place = |file: DVec3| match up {
        Up::Y => file * unit_to_m,
        Up::Z => DVec3::new(file.x, file.z, -file.y) * unit_to_m,
    };
    let skeleton = Arc::make_mut(&mut clip.skeleton);
    for joint in &mut skeleton.joints {
        joint.offset = place(joint.offset);
        joint.end_site = joint.end_site.map(place);
        if up == Up::Z {
            joint.rotation_order = joint.rotation_order.map(turned_axis);
        }
    }
    for root in &mut clip.root_positions {
        *root = place(*root);
    }
    for offset in clip.moving_offsets.iter_mut().flat_map(|moving| &mut moving.offsets) {
        *offset = place(*offset);
    }
    if up == Up::Z {
        for rotation in &mut clip.rotations {
            *rotation = DQuat::from_xyzw(rotation.x, rotation.z, -rotation.y, rotation.w);
        }
    }
}

/// Axis that takes the part of `axis` when z up becomes y up.
fn turned_axis(axis: Axis) -> Axis {
    match axis {
        Axis::X => Axis::X,
        Axis::Y => Axis::Z,
        Axis::Z => Axis::Y,
    }
}
