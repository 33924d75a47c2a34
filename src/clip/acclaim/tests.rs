//! A small skeleton and motion, and what happens when one thing in them is spoilt.

mod faults;

use glam::{DQuat, DVec3};

use super::*;
use crate::clip::Clip;
use crate::clip::read::{Capture, ReadOptions, read};
use crate::clip::text::Position;
use crate::skeleton::Axis;

const SKELETON: &str = "# made by hand
:version 1.10
:name small
:units
  mass 1.0
  length 0.45
  angle deg
:documentation
  no body
:root
  order TX TY TZ RX RY RZ
  axis XYZ
  position 0 0 0
  orientation 0 0 0
:bonedata
  begin
    id 1
    name hip
    direction 0 -1 0
    length 2
    axis 0 0 90 XYZ
    dof rx rz
    limits (-160.0 20.0)
           (-70.0 inf)
  end
  begin
    id 2
    name knee
    direction 1 0 0
    length 3
    axis 0 0 0 XYZ
  end
:hierarchy
  begin
    root hip
    hip knee
  end
";

const MOTION: &str = "#!OML:ASF x
:FULLY-SPECIFIED
:DEGREES
1
root 1 2 3 0 0 90
hip 90 0
2
hip 0 90
root 1 2 4 90 0 90
";

fn read_texts(skeleton: &str, motion: &str) -> Result<FileMotion, AcclaimError> {
    super::motion(skeleton.as_bytes(), motion.as_bytes(), "small", false)
}

fn valid(skeleton: &str, motion: &str) -> FileMotion {
    read_texts(skeleton, motion).expect("valid files")
}

/// `text` with its first `what` replaced.
fn spoilt(text: &str, what: &str, by: &str) -> String {
    assert!(text.contains(what), "{what}");
    text.replacen(what, by, 1)
}

const fn at(line: usize, column: usize) -> Position {
    Position { line, column }
}

/// A few roundings of sines and cosines of coordinates below 10.
const ROUNDING: f64 = 1e-14;

fn places(clip: &Clip, frame: u32) -> Vec<DVec3> {
    let frames = clip.skeleton.forward_kinematics(&clip.pose(SourceFrame(frame)));
    frames.iter().map(|frame| frame.position).collect()
}

fn same_clip(a: &Clip, b: &Clip) -> bool {
    let turns = a.rotations.iter().zip(&b.rotations);
    a.skeleton == b.skeleton
        && a.root_positions == b.root_positions
        && a.rotations.len() == b.rotations.len()
        && turns.into_iter().all(|(a, b)| a.dot(*b).abs() > 1.0 - ROUNDING)
}

#[test]
fn joints_stand_where_bones_start_and_leaves_have_ends() {
    let read = valid(SKELETON, MOTION);
    let joints = &read.clip.skeleton.joints;
    let names: Vec<&str> = joints.iter().map(|joint| joint.name.as_str()).collect();
    assert_eq!(names, ["root", "hip", "knee"]);
    assert_eq!(joints[1].offset, DVec3::ZERO);
    assert_eq!(joints[2].offset, DVec3::NEG_Y * 2.0);
    assert_eq!(
        [joints[0].end_site, joints[1].end_site, joints[2].end_site],
        [None, None, Some(DVec3::X * 3.0)]
    );
    assert_eq!(joints[0].rotation_order, [Axis::Z, Axis::Y, Axis::X]);
    assert_eq!(read.unit_to_m, Some(0.0254 / 0.45));
    assert_eq!((read.clip.frame_count(), read.header_fps, read.up), (2, 120.0, Some(Up::Y)));
    assert_eq!(read.notes, [ReadNote::RateAssumed { fps: 120.0 }]);
}

#[test]
fn bones_turn_about_their_own_axes_and_the_first_angle_turns_first() {
    let clip = valid(SKELETON, MOTION).clip;
    // The hip's x axis is the body's y: 90° about it turn x to −z. The root's 90° about z come on top.
    let turned = DQuat::from_rotation_z(90_f64.to_radians()) * DQuat::from_rotation_y(90_f64.to_radians());
    let frames = clip.skeleton.forward_kinematics(&clip.pose(SourceFrame(0)));
    assert!(frames[1].rotation.dot(turned).abs() > 1.0 - ROUNDING);
    assert!(places(&clip, 0)[2].distance(DVec3::new(3.0, 2.0, 3.0)) < ROUNDING);
    // 90° about x, then 90° about z: y goes to z, which stays.
    let frames = clip.skeleton.forward_kinematics(&clip.pose(SourceFrame(1)));
    assert!((frames[0].rotation * DVec3::Y).distance(DVec3::Z) < ROUNDING);
    assert_eq!(clip.root_positions[1], DVec3::new(1.0, 2.0, 4.0));
}

#[test]
fn line_ends_blanks_comments_case_and_order_do_not_matter() {
    let plain = valid(SKELETON, MOTION).clip;
    let hierarchy = &SKELETON[SKELETON.find(":hierarchy").expect("a section")..];
    let hierarchy_first = format!("{hierarchy}{}", SKELETON.replace(hierarchy, ""));
    let skeletons = [
        SKELETON.replace('\n', "\r\n"),
        SKELETON.replace('\n', "\r"),
        SKELETON.replace('\n', " # words\n\n\t"),
        format!("\u{feff}{SKELETON}"),
        SKELETON.trim_end().to_owned(),
        SKELETON.replace(":units", ":UNITS").replace("begin", "Begin").replace("dof rx", "DOF RX"),
        SKELETON.replace("(-160.0 20.0)", "( -160.0\n20.0 )").replace("(-70.0", "(-70"),
        SKELETON.replace("20.0)\n           (", "20.0)("),
        SKELETON.replace(":bonedata", ":skin x\n what follows\n:bonedata"),
        hierarchy_first,
    ];
    for skeleton in skeletons {
        assert!(same_clip(&valid(&skeleton, MOTION).clip, &plain), "{skeleton}");
    }
    let motions = [
        MOTION.replace('\n', "\r\n"),
        MOTION.replace('\n', "\r"),
        MOTION.replace('\n', "\n# words\n\n \t"),
        MOTION.replace("root", "ROOT").replace(":DEGREES", ":degrees"),
        MOTION.replace(":DEGREES\n", ""),
        MOTION.replace("1\nroot", "41\nroot").replace("2\nhip", "42\nhip"),
        format!("{MOTION}knee\n"),
    ];
    for motion in motions {
        assert!(same_clip(&valid(SKELETON, &motion).clip, &plain), "{motion}");
    }
}

#[test]
fn radians_are_honoured_in_either_file() {
    let plain = valid(SKELETON, MOTION).clip;
    let quarter = std::f64::consts::FRAC_PI_2.to_string();
    let skeleton =
        SKELETON.replace("angle deg", "angle rad").replace("0 0 90 XYZ", &format!("0 0 {quarter} XYZ"));
    assert!(same_clip(&valid(&skeleton, MOTION).clip, &plain));
    let motion = MOTION.replace("90", &quarter);
    assert!(same_clip(&valid(SKELETON, &motion.replace(":DEGREES", ":RADIANS")).clip, &plain));
    // Without a word of the motion's the skeleton's unit holds.
    assert!(same_clip(&valid(&skeleton, &motion.replace(":DEGREES\n", "")).clip, &plain));
}

#[test]
fn the_root_has_its_values_in_any_order_and_starts_where_the_skeleton_says() {
    let plain = valid(SKELETON, MOTION).clip;
    let skeleton = SKELETON.replace("TX TY TZ RX RY RZ", "rx tz ry tx rz ty");
    let motion = MOTION
        .replace("root 1 2 3 0 0 90", "root 0 3 0 1 90 2")
        .replace("root 1 2 4 90 0 90", "root 90 4 0 1 90 2");
    assert!(same_clip(&valid(&skeleton, &motion).clip, &plain));
    let moved = valid(
        &SKELETON
            .replace("position 0 0 0", "position 10 0 0")
            .replace("orientation 0 0 0", "orientation 0 0 90"),
        &MOTION.replace("root 1 2 3 0 0 90", "root 1 2 3 0 0 0"),
    )
    .clip;
    assert_eq!(moved.root_positions[0], DVec3::new(11.0, 2.0, 3.0));
    assert!(moved.rotations[0].dot(plain.rotations[0]).abs() > 1.0 - ROUNDING);
}

#[test]
fn units_that_mean_nothing_are_left_to_be_guessed() {
    for skeleton in [SKELETON.replace("length 0.45", "length 1.0"), SKELETON.replace("  length 0.45\n", "")] {
        assert_eq!(valid(&skeleton, MOTION).unit_to_m, None);
    }
}

#[test]
fn a_rate_is_taken_where_one_is_stated_or_given() {
    let motion = MOTION.replace(":DEGREES", ":SAMPLES-PER-SECOND 60\n:DEGREES");
    let read = valid(SKELETON, &motion);
    assert_eq!((read.header_fps, read.clip.fps, read.notes), (60.0, 60.0, vec![]));
    let capture = Capture::Acclaim { skeleton: SKELETON.as_bytes(), motion: MOTION.as_bytes() };
    let assumed = |options: &ReadOptions| {
        let read = crate::clip::read::read(capture, "small", options).expect("valid files");
        read.notes.iter().any(|note| matches!(note, ReadNote::RateAssumed { .. }))
    };
    assert!(assumed(&ReadOptions::default()));
    assert!(!assumed(&ReadOptions { fps: Some(120.0), ..ReadOptions::default() }));
}

/// A motion of `count` frames in which the root's x and the hip's first angle are the frame's number, but for `spoil`.
fn counted(count: u32, spoil: impl Fn(u32) -> Option<String>) -> String {
    let usual = |k| format!("{k}\nroot {k} 2 3 0 0 0\nhip {k} 0\n");
    (1..=count).map(|k| spoil(k).unwrap_or_else(|| usual(k))).collect()
}

#[test]
fn values_and_frames_that_are_missing_are_filled_in_on_request() {
    let whole = valid(SKELETON, &counted(6, |_| None)).clip;
    let repaired = |text: &str| super::motion(SKELETON.as_bytes(), text.as_bytes(), "small", true);
    let nan = counted(6, |k| (k == 3).then(|| "3\nroot nan 2 3 0 0 0\nhip inf 0\n".to_owned()));
    let read = repaired(&nan).expect("a single frame to repair");
    assert!(same_clip(&read.clip, &whole));
    assert!(read.notes.contains(&ReadNote::ValuesFilledIn { frames: vec![SourceFrame(2)] }));
    let left_out = counted(6, |k| (3..6).contains(&k).then(String::new));
    let read = repaired(&left_out).expect("three frames to repair");
    assert!(same_clip(&read.clip, &whole));
    assert!(read.notes.contains(&ReadNote::ValuesFilledIn {
        frames: vec![2, 3, 4].into_iter().map(SourceFrame).collect()
    }));
    let longer = repaired(&counted(7, |k| (3..7).contains(&k).then(String::new)));
    let expected = AmcError::FrameNumber { at: at(7, 1), expected: 3, found: 7 };
    assert_eq!(longer.err(), Some(AcclaimError::Motion(expected)));
    let long =
        repaired(&counted(7, |k| (3..7).contains(&k).then(|| format!("{k}\nroot nan 2 3 0 0 0\nhip 0 0\n"))));
    let expected = AmcError::LongGap { at: at(8, 6), limit: 3 };
    assert_eq!(long.err(), Some(AcclaimError::Motion(expected)));
    let repeated = repaired(&counted(3, |k| (k == 3).then(|| "2\nroot 0 0 0 0 0 0\nhip 0 0\n".to_owned())));
    assert!(matches!(
        repeated,
        Err(AcclaimError::Motion(AmcError::FrameNumber { expected: 3, found: 2, .. }))
    ));
}

/// A chain of `count` bones.
fn chain(count: usize) -> String {
    let start = &SKELETON[..SKELETON.find("  begin").expect("a bone")];
    let bone = |k| format!("begin name b{k} direction 0 1 0 length 1 axis 0 0 0 XYZ end\n");
    let bones: String = (0..count).map(bone).collect();
    let links: String = (1..count).map(|k| format!("b{} b{k}\n", k - 1)).collect();
    format!("{start}{bones}:hierarchy\nbegin\nroot b0\n{links}end\n")
}

#[test]
fn a_chain_of_thousands_of_bones_needs_no_stack_and_more_than_the_limit_are_refused() {
    let motion = "1\nroot 0 0 0 0 0 0\n";
    let deep = valid(&chain(20_000), motion).clip;
    assert_eq!(places(&deep, 0)[20_000], DVec3::Y * 19_999.0);
    let error = read_texts(&chain(65_536), motion).expect_err("too many bones");
    assert!(matches!(error, AcclaimError::Skeleton(AsfError::TooManyBones { limit: 65_535, .. })), "{error}");
}

#[test]
fn joints_without_values_cannot_fill_the_memory() {
    let frames: String = (1..=60).map(|k| format!("{k}\nroot 0 0 0 0 0 0\n")).collect();
    let error = read_texts(&chain(20_000), &frames).expect_err("more rotations than the text speaks of");
    let expected = AmcError::TooManyRotations { at: at(53, 1), joints: 20_001, frames: 27 };
    assert_eq!(error, AcclaimError::Motion(expected));
}

#[test]
fn a_whole_body_of_cmu_has_its_roles() {
    use crate::skeleton::JointRole as R;
    let names = [
        ("root", "lhipjoint", None),
        ("lhipjoint", "lfemur", Some(R::LeftHip)),
        ("lfemur", "ltibia", Some(R::LeftKnee)),
        ("ltibia", "lfoot", Some(R::LeftFoot)),
        ("lfoot", "ltoes", Some(R::LeftToe)),
        ("root", "lowerback", Some(R::Spine)),
        ("lowerback", "thorax", Some(R::Chest)),
        ("thorax", "lowerneck", Some(R::Neck)),
        ("lowerneck", "head", Some(R::Head)),
        ("thorax", "lclavicle", Some(R::LeftClavicle)),
        ("lclavicle", "lhumerus", Some(R::LeftShoulder)),
        ("lhumerus", "lradius", Some(R::LeftElbow)),
        ("lradius", "lwrist", Some(R::LeftHand)),
        ("lwrist", "lthumb", None),
        ("thorax", "rclavicle", Some(R::RightClavicle)),
        ("rclavicle", "rhumerus", Some(R::RightShoulder)),
    ];
    let start = &SKELETON[..SKELETON.find("  begin").expect("a bone")];
    let bones: String = names
        .iter()
        .map(|(_, name, _)| format!("begin name {name} direction 0 1 0 length 1 axis 0 0 0 XYZ end\n"))
        .collect();
    let links: String = names.iter().map(|(parent, name, _)| format!("{parent} {name}\n")).collect();
    let skeleton = format!("{start}{bones}:hierarchy\nbegin\n{links}end\n");
    let capture = Capture::Acclaim { skeleton: skeleton.as_bytes(), motion: b"1\nroot 0 0 0 0 0 0\n" };
    let clip = read(capture, "body", &ReadOptions::default()).expect("valid files").clip;
    for (_, name, role) in names {
        let joint = clip.skeleton.joint_named(name).expect("every bone is a joint");
        assert_eq!(clip.skeleton.joints[joint.as_usize()].role, role, "{name}");
    }
}
