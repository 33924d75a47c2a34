//! From the text of a file to a clip in the file's units and axes: channels to quaternions.

use std::collections::{BTreeMap, HashSet};
use std::sync::Arc;

use glam::{DQuat, DVec3};
use rayon::prelude::*;

use super::parse::{Channel, RawBvh, RawJoint};
use crate::clip::note::ReadNote;
use crate::clip::roles::assign_roles;
use crate::clip::{Clip, MovingOffset};
use crate::geometry::sin_cos_of_half;
use crate::index::{JointId, SourceFrame};
use crate::skeleton::{Axis, Joint, Skeleton};

/// Offsets below this, file units, count as unchanged.
const OFFSET_ROUNDING: f64 = 1e-9;

/// The clip in the file's own units and axes; all frames usable.
pub(super) fn clip_in_file_units(raw: &RawBvh, name: &str, fps: f64, notes: &mut Vec<ReadNote>) -> Clip {
    let mut joints: Vec<Joint> = raw.joints.iter().map(|joint| to_joint(joint, notes)).collect();
    note_duplicates(&joints, notes);
    assign_roles(&mut joints);
    let starts = channel_starts(&raw.joints);
    let width = starts[joints.len()];
    let row = |frame: usize| &raw.values[frame * width..(frame + 1) * width];
    let mut rotations = vec![DQuat::IDENTITY; raw.frame_count * joints.len()];
    rotations.par_chunks_mut(joints.len()).with_min_len(64).enumerate().for_each(|(frame, turns)| {
        let row = row(frame);
        for ((turn, joint), columns) in turns.iter_mut().zip(&raw.joints).zip(starts.windows(2)) {
            *turn = rotation(&joint.channels, &row[columns[0]..columns[1]]);
        }
    });
    let root = &raw.joints[0];
    let root_positions = (0..raw.frame_count)
        .map(|frame| position(root, DVec3::from_array(root.offset), &row(frame)[..starts[1]]))
        .collect();
    Clip {
        name: name.to_owned(),
        skeleton: Arc::new(Skeleton { joints }),
        fps,
        root_positions,
        rotations,
        moving_offsets: moving_offsets(raw, &starts, notes),
        events: BTreeMap::new(),
        contacts: Vec::new(),
        usable: (SourceFrame(0), SourceFrame::from_usize(raw.frame_count - 1)),
    }
}

fn to_joint(raw: &RawJoint, notes: &mut Vec<ReadNote>) -> Joint {
    if raw.end_sites.len() > 1 {
        notes.push(ReadNote::EndSitesDropped { joint: raw.name.clone() });
    }
    Joint {
        name: raw.name.clone(),
        parent: raw.parent.map(JointId::from_usize),
        offset: DVec3::from_array(raw.offset),
        end_site: raw.end_sites.first().copied().map(DVec3::from_array),
        rotation_order: rotation_order(&raw.channels),
        role: None,
    }
}

fn note_duplicates(joints: &[Joint], notes: &mut Vec<ReadNote>) {
    let mut seen = HashSet::new();
    let mut noted = HashSet::new();
    for joint in joints {
        if !seen.insert(&joint.name) && noted.insert(&joint.name) {
            notes.push(ReadNote::DuplicateName { name: joint.name.clone() });
        }
    }
}

/// Axes in the order of the file, completed by those that have no channel.
fn rotation_order(channels: &[Channel]) -> [Axis; 3] {
    let mut order: Vec<Axis> = channels
        .iter()
        .filter_map(|channel| match channel {
            Channel::Rotation(axis) => Some(*axis),
            Channel::Position(_) => None,
        })
        .collect();
    for axis in [Axis::Z, Axis::X, Axis::Y] {
        if !order.contains(&axis) {
            order.push(axis);
        }
    }
    [order[0], order[1], order[2]]
}

/// Where the channels of each joint start in a row, and at the end the length of a row.
fn channel_starts(joints: &[RawJoint]) -> Vec<usize> {
    let mut starts = vec![0];
    for joint in joints {
        starts.push(starts[starts.len() - 1] + joint.channels.len());
    }
    starts
}

/// Product of the rotation channels in their order.
fn rotation(channels: &[Channel], values: &[f64]) -> DQuat {
    let [mut x, mut y, mut z, mut w] = [0.0, 0.0, 0.0, 1.0];
    for (channel, value) in channels.iter().zip(values) {
        let Channel::Rotation(axis) = channel else { continue };
        // Many channels of many files are never used.
        if *value == 0.0 {
            continue;
        }
        let (s, c) = sin_cos_of_half(*value);
        // Products with s i + c, s j + c, s k + c.
        [x, y, z, w] = match axis {
            Axis::X => [x * c + w * s, y * c + z * s, z * c - y * s, w * c - x * s],
            Axis::Y => [x * c - z * s, y * c + w * s, z * c + x * s, w * c - y * s],
            Axis::Z => [x * c + y * s, y * c - x * s, z * c + w * s, w * c - z * s],
        };
    }
    DQuat::from_xyzw(x, y, z, w)
}

/// Position channels of a joint, over `otherwise` where an axis has none.
fn position(joint: &RawJoint, otherwise: DVec3, values: &[f64]) -> DVec3 {
    let mut place = otherwise;
    for (channel, value) in joint.channels.iter().zip(values) {
        match channel {
            Channel::Position(Axis::X) => place.x = *value,
            Channel::Position(Axis::Y) => place.y = *value,
            Channel::Position(Axis::Z) => place.z = *value,
            Channel::Rotation(_) => {}
        }
    }
    place
}

/// Joints below the root whose position channels say anything, with their offsets.
fn moving_offsets(raw: &RawBvh, starts: &[usize], notes: &mut Vec<ReadNote>) -> Vec<MovingOffset> {
    let has_position =
        |joint: &RawJoint| joint.channels.iter().any(|channel| matches!(channel, Channel::Position(_)));
    let movers: Vec<usize> =
        (1..raw.joints.len()).filter(|&index| has_position(&raw.joints[index])).collect();
    if movers.is_empty() {
        return Vec::new();
    }
    let width = starts[raw.joints.len()];
    let values = |index: usize, frame: usize| {
        &raw.values[frame * width + starts[index]..frame * width + starts[index + 1]]
    };
    let place = |index: usize, frame: usize| {
        let joint = &raw.joints[index];
        position(joint, DVec3::from_array(joint.offset), values(index, frame))
    };
    let adds = are_displacements(raw, &movers, place);
    if adds {
        notes.push(ReadNote::DisplacementChannels);
    }
    let mut moving = Vec::new();
    for index in movers {
        let joint = &raw.joints[index];
        let rest = DVec3::from_array(joint.offset);
        let offset = |frame| {
            if adds { rest + position(joint, DVec3::ZERO, values(index, frame)) } else { place(index, frame) }
        };
        let offsets: Vec<DVec3> = (0..raw.frame_count).map(offset).collect();
        if offsets.iter().any(|offset| offset.distance(rest) > OFFSET_ROUNDING) {
            moving.push(MovingOffset { joint: JointId::from_usize(index), offsets });
        }
    }
    moving
}

/// Whether the position channels below the root are nearer to zero than to the offsets, over all joints and frames.
fn are_displacements(raw: &RawBvh, movers: &[usize], place: impl Fn(usize, usize) -> DVec3) -> bool {
    let mut from_zero = 0.0;
    let mut from_rest = 0.0;
    for &index in movers {
        for frame in 0..raw.frame_count {
            from_zero += place(index, frame).length();
            from_rest += place(index, frame).distance(DVec3::from_array(raw.joints[index].offset));
        }
    }
    from_zero < from_rest
}
