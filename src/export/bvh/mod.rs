//! Writes clips as BVH, y up: in metres, each joint in its own rotation order, unless asked otherwise ([`BvhOptions`]).
//!
//! The root has six channels, joints that move against their parents too, all others three. Angles are unwrapped from
//! frame to frame, so that whoever interpolates the file's numbers gets a sensible motion; ten decimals (of a metre, of a
//! degree) are read back to 1e-10.

use std::fmt::Write as _;

use glam::DVec3;

mod angles;
mod names;
mod options;

pub use angles::{euler_angles, rotation_of};
pub use names::JointNames;
pub use options::{BvhOptions, to_bvh_with};

use crate::clip::Clip;
use crate::skeleton::{Axis, Joint};

/// Joints nested deeper are not indented further.
const DEEPEST_INDENT: usize = 32;

/// The clip as the text of a BVH file. All frames are written, usable or not. Cost: linear in the clip.
pub fn to_bvh(clip: &Clip) -> String {
    let layout = Layout::of(clip);
    let mut text = String::from("HIERARCHY\n");
    write_hierarchy(&mut text, clip, &layout);
    text.push_str("MOTION\n");
    line(&mut text, 0, format_args!("Frames: {}", clip.frame_count()));
    // So many digits that readers who take a short number for a rounded one do not.
    line(&mut text, 0, format_args!("Frame Time: {:.20}", 1.0 / clip.fps));
    write_rows(&mut text, clip, &layout);
    text
}

/// Joints in the order of the file, depth first, with how deep each is and whether it has position channels.
struct Layout {
    order: Vec<(usize, usize)>,
    /// Index into the clip's moving offsets, by joint.
    moving: Vec<Option<usize>>,
}

impl Layout {
    fn of(clip: &Clip) -> Self {
        let joints = &clip.skeleton.joints;
        let mut children: Vec<Vec<usize>> = vec![Vec::new(); joints.len()];
        for (index, joint) in joints.iter().enumerate() {
            if let Some(parent) = joint.parent {
                children[parent.as_usize()].push(index);
            }
        }
        let mut order = Vec::with_capacity(joints.len());
        let mut waiting = vec![(0, 0)];
        while let Some((joint, depth)) = waiting.pop() {
            order.push((joint, depth));
            waiting.extend(children[joint].iter().rev().map(|&child| (child, depth + 1)));
        }
        let mut moving = vec![None; joints.len()];
        for (index, offsets) in clip.moving_offsets.iter().enumerate() {
            moving[offsets.joint.as_usize()] = Some(index);
        }
        Self { order, moving }
    }
}

fn write_hierarchy(text: &mut String, clip: &Clip, layout: &Layout) {
    let mut open = 0;
    for &(index, depth) in &layout.order {
        while open > depth {
            open -= 1;
            line(text, open, format_args!("}}"));
        }
        let joint = &clip.skeleton.joints[index];
        let has_position = index == 0 || layout.moving[index].is_some();
        write_joint(text, joint, depth, has_position);
        open = depth + 1;
    }
    while open > 0 {
        open -= 1;
        line(text, open, format_args!("}}"));
    }
}

/// Everything of a joint but its children and its closing brace.
fn write_joint(text: &mut String, joint: &Joint, depth: usize, has_position: bool) {
    let keyword = if joint.parent.is_none() { "ROOT" } else { "JOINT" };
    line(text, depth, format_args!("{keyword} {}", joint.name));
    line(text, depth, format_args!("{{"));
    line(text, depth + 1, format_args!("OFFSET {}", triple(joint.offset)));
    let [a, b, c] = joint.rotation_order.map(letter);
    let (count, positions) = if has_position { (6, "Xposition Yposition Zposition ") } else { (3, "") };
    line(text, depth + 1, format_args!("CHANNELS {count} {positions}{a}rotation {b}rotation {c}rotation"));
    if let Some(end) = joint.end_site {
        line(text, depth + 1, format_args!("End Site"));
        line(text, depth + 1, format_args!("{{"));
        line(text, depth + 2, format_args!("OFFSET {}", triple(end)));
        line(text, depth + 1, format_args!("}}"));
    }
}

fn write_rows(text: &mut String, clip: &Clip, layout: &Layout) {
    let joints = &clip.skeleton.joints;
    let mut angles = vec![[0.0; 3]; joints.len()];
    for frame in 0..clip.frame_count() {
        let mut separator = "";
        for &(index, _) in &layout.order {
            let position = match layout.moving[index] {
                _ if index == 0 => Some(clip.root_positions[frame]),
                Some(moving) => Some(clip.moving_offsets[moving].offsets[frame]),
                None => None,
            };
            if let Some(position) = position {
                append(text, format_args!("{separator}{}", triple(position)));
                separator = " ";
            }
            let rotation = clip.rotations[frame * joints.len() + index];
            angles[index] = euler_angles(rotation, joints[index].rotation_order, angles[index]);
            let degrees = DVec3::from_array(angles[index].map(f64::to_degrees));
            append(text, format_args!("{separator}{}", triple(degrees)));
            separator = " ";
        }
        text.push('\n');
    }
}

fn letter(axis: Axis) -> char {
    match axis {
        Axis::X => 'X',
        Axis::Y => 'Y',
        Axis::Z => 'Z',
    }
}

/// Three numbers of ten decimals, without negative zeros.
fn triple(vector: DVec3) -> String {
    let digits = |value: f64| {
        let text = format!("{value:.10}");
        if text == "-0.0000000000" { text[1..].to_owned() } else { text }
    };
    format!("{} {} {}", digits(vector.x), digits(vector.y), digits(vector.z))
}

fn line(text: &mut String, depth: usize, content: std::fmt::Arguments<'_>) {
    text.extend(std::iter::repeat_n('\t', depth.min(DEEPEST_INDENT)));
    append(text, content);
    text.push('\n');
}

fn append(text: &mut String, content: std::fmt::Arguments<'_>) {
    text.write_fmt(content).expect("writing to a string does not fail");
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_2;
    use std::sync::Arc;

    use glam::DQuat;

    use super::*;
    use crate::clip::read::{Capture, ReadOptions, Up, read};
    use crate::geometry::log;
    use crate::index::{JointId, SourceFrame};
    use crate::skeleton::{Pose, Skeleton};

    const ORDERS: [[Axis; 3]; 6] = [
        [Axis::X, Axis::Y, Axis::Z],
        [Axis::Y, Axis::Z, Axis::X],
        [Axis::Z, Axis::X, Axis::Y],
        [Axis::X, Axis::Z, Axis::Y],
        [Axis::Y, Axis::X, Axis::Z],
        [Axis::Z, Axis::Y, Axis::X],
    ];

    fn angle_between(a: DQuat, b: DQuat) -> f64 {
        log(a.inverse() * b).length()
    }

    /// Joints out of depth-first order, a moving one, a name with spaces, angles in gimbal lock.
    #[test]
    fn what_is_written_is_read_back() {
        let joint = |name: &str, parent: Option<u32>, order| Joint {
            name: name.to_owned(),
            parent: parent.map(JointId),
            offset: DVec3::new(0.1, 0.9, -0.2),
            end_site: parent.map(|_| DVec3::new(0.0, 0.3, 1e-7)),
            rotation_order: order,
            role: None,
        };
        let skeleton = Skeleton {
            joints: vec![
                joint("the root", None, ORDERS[0]),
                joint("left", Some(0), ORDERS[1]),
                joint("right", Some(0), ORDERS[5]),
                joint("left end", Some(1), ORDERS[3]),
            ],
        };
        let poses: Vec<Pose> = (0..40)
            .map(|frame| Pose {
                root: DVec3::new(1.0, 2.0, 0.01 * f64::from(frame)),
                rotations: (0..4)
                    .map(|index| {
                        rotation_of([0.3 * f64::from(frame), FRAC_PI_2, f64::from(index)], ORDERS[1])
                    })
                    .collect(),
                offsets: vec![(JointId(2), DVec3::new(0.0, 1.0, 0.02 * f64::from(frame)))],
            })
            .collect();
        let clip = Clip::from_poses("four joints", Arc::new(skeleton), 1.0 / 0.0417, &poses);
        let options = ReadOptions { unit_to_m: Some(1.0), up: Some(Up::Y), ..ReadOptions::default() };
        let back =
            read(Capture::Bvh(to_bvh(&clip).as_bytes()), "four joints", &options).expect("a valid file").clip;
        assert!((back.fps - clip.fps).abs() < 1e-12);
        // Depth first: the root, left, left end, right.
        for (here, there) in [(0, 0), (1, 1), (2, 3), (3, 2)] {
            assert_eq!(clip.skeleton.joints[here].name, back.skeleton.joints[there].name);
            for frame in (0..40).map(SourceFrame) {
                let before = clip.skeleton.forward_kinematics(&clip.pose(frame))[here];
                let after = back.skeleton.forward_kinematics(&back.pose(frame))[there];
                assert!(before.position.distance(after.position) < 1e-8);
                assert!(angle_between(before.rotation, after.rotation) < 1e-8);
            }
        }
    }
}
