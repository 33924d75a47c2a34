//! A small motion, and what happens when one thing in it is spoilt.

use glam::{DQuat, DVec3};

use super::*;
use crate::clip::Clip;
use crate::clip::text::{Position, TextError};
use crate::index::SourceFrame;
use crate::skeleton::JointRole;

/// A row: duration, place, the root's quaternion, everything else unturned but for the angles of knees and elbows.
fn row(seconds: &str, place: &str, root: &str, angle: &str) -> String {
    let leg = format!("1, 0, 0, 0, {angle}, 1, 0, 0, 0");
    let arm = format!("1, 0, 0, 0, {angle}");
    let rest = "1, 0, 0, 0";
    format!("[{seconds}, {place}, {root}, {rest}, {rest}, {leg}, {arm}, {leg}, {arm}]")
}

fn small() -> String {
    let first = row("0.033332", "0, 0.9, 0", "1, 0, 0, 0", "-0.5");
    let second = row("0.033332", "0.1, 0.9, 0", "0.5, 0.5, 0.5, 0.5", "0");
    let third = row("0", "0.2, 0.9, 0", "1, 0, 0, 0", "0");
    format!("{{\n\"Loop\": \"wrap\",\n\"Frames\":\n[\n{first},\n{second},\n{third}\n]\n}}\n")
}

fn read_text(text: &str) -> Result<FileMotion, DeepMimicError> {
    super::motion(text.as_bytes(), "small", false)
}

fn valid(text: &str) -> FileMotion {
    read_text(text).expect("a valid file")
}

fn spoilt(what: &str, by: &str) -> String {
    let text = small();
    assert!(text.contains(what), "{what}");
    text.replacen(what, by, 1)
}

fn fault(what: &str, by: &str) -> DeepMimicError {
    read_text(&spoilt(what, by)).expect_err("a spoilt file")
}

const fn at(line: usize, column: usize) -> Position {
    Position { line, column }
}

/// A few roundings of sines and cosines.
const ROUNDING: f64 = 1e-14;

fn place(clip: &Clip, frame: u32, joint: &str) -> DVec3 {
    let frames = clip.skeleton.forward_kinematics(&clip.pose(SourceFrame(frame)));
    frames[clip.skeleton.joint_named(joint).expect("a joint of the body").as_usize()].position
}

#[test]
fn a_row_turns_the_humanoid() {
    let read = valid(&small());
    let clip = &read.clip;
    assert_eq!((read.header_fps, clip.fps, read.unit_to_m, read.up), (30.0, 30.0, Some(1.0), Some(Up::Y)));
    assert_eq!(read.notes, []);
    assert_eq!(clip.root_positions[1], DVec3::new(0.1, 0.9, 0.0));
    assert_eq!(clip.rotations[13], DQuat::from_xyzw(0.5, 0.5, 0.5, 0.5));
    let (sin, cos) = 0.5_f64.sin_cos();
    // A knee bent by a negative angle takes the ankle back, which is −x.
    let ankle = place(clip, 0, "left_ankle");
    let expected = DVec3::new(-0.40987 * sin, 0.9 - 0.421546 - 0.40987 * cos, -0.084887);
    assert!(ankle.distance(expected) < ROUNDING, "{ankle}");
    assert!(place(clip, 0, "right_hip").z > 0.0);
}

#[test]
fn the_body_has_thirteen_joints_and_all_their_roles() {
    use JointRole as R;
    let clip = valid(&small()).clip;
    let roles: Vec<(&str, Option<JointRole>)> =
        clip.skeleton.joints.iter().map(|joint| (joint.name.as_str(), joint.role)).collect();
    let expected = [
        ("root", R::Pelvis),
        ("chest", R::Chest),
        ("neck", R::Neck),
        ("right_shoulder", R::RightShoulder),
        ("right_elbow", R::RightElbow),
        ("left_shoulder", R::LeftShoulder),
        ("left_elbow", R::LeftElbow),
        ("right_hip", R::RightHip),
        ("right_knee", R::RightKnee),
        ("right_ankle", R::RightFoot),
        ("left_hip", R::LeftHip),
        ("left_knee", R::LeftKnee),
        ("left_ankle", R::LeftFoot),
    ];
    assert_eq!(roles, expected.map(|(name, role)| (name, Some(role))));
}

/// Each joint's numbers stand where the paper's order has them: turning one joint moves its own end, and none elsewhere.
#[test]
fn each_column_turns_its_own_joint() {
    let order = [
        ("root", 4),
        ("chest", 4),
        ("neck", 4),
        ("right_hip", 4),
        ("right_knee", 1),
        ("right_ankle", 4),
        ("right_shoulder", 4),
        ("right_elbow", 1),
        ("left_hip", 4),
        ("left_knee", 1),
        ("left_ankle", 4),
        ("left_shoulder", 4),
        ("left_elbow", 1),
    ];
    let mut column = 4;
    for (name, width) in order {
        let text = small();
        let row_start = text.find("[0,").expect("the last row");
        let row: Vec<&str> = text[row_start + 1..text.find("]\n]").expect("its end")].split(", ").collect();
        let mut turned: Vec<String> = row.iter().map(|&number| number.to_owned()).collect();
        if width == 4 {
            turned[column] = "0".to_owned();
            turned[column + 1] = "1".to_owned();
        } else {
            turned[column] = "1.5".to_owned();
        }
        let clip = valid(&text.replace(&row.join(", "), &turned.join(", "))).clip;
        let changed: Vec<&str> = (0..13)
            .filter(|&joint| clip.rotations[26 + joint] != DQuat::IDENTITY)
            .map(|joint| clip.skeleton.joints[joint].name.as_str())
            .collect();
        assert_eq!(changed, [name]);
        column += width;
    }
    assert_eq!(column, 44);
}

#[test]
fn blanks_line_ends_key_order_and_unknown_keys_do_not_matter() {
    let plain = valid(&small()).clip;
    let frames = small();
    let frames = &frames[frames.find("\"Frames\"").expect("a key")..frames.rfind("\n}").expect("the end")];
    let variants = [
        small().replace('\n', "\r\n"),
        small().replace('\n', ""),
        small().replace(' ', ""),
        small().replace(' ', "\t"),
        format!("\u{feff}{}", small()),
        format!("{{{frames}}}"),
        format!("{{{frames}, \"Loop\": \"none\"}}"),
        spoilt(
            "\"Loop\"",
            "\"RightJoints\": [3, 4, [], {}, {\"a\": [null, true, \"\\\"]\", -1.5e3]}], \"Loop\"",
        ),
        small().replace("0.9,", "9e-1,"),
    ];
    for text in variants {
        assert_eq!(valid(&text).clip, plain, "{text}");
    }
}

#[test]
fn faults_carry_line_and_column() {
    use DeepMimicError as E;
    let text = E::Text;
    let unexpected =
        |at, expected, found: &str| text(TextError::Unexpected { at, expected, found: format!("`{found}`") });
    let cases = [
        ("{\n\"Loop\"", "[\n\"Loop\"", E::NotDeepMimic { at: at(1, 1), found: "`[`".to_owned() }),
        (
            "\"Loop\": \"wrap\"",
            "\"Loop\": \"wrap\", \"Loop\": \"wrap\"",
            E::RepeatedKey { at: at(2, 17), key: "Loop" },
        ),
        ("\n]\n}", "\n], \"Frames\": []\n}", E::RepeatedKey { at: at(8, 4), key: "Frames" }),
        ("\"Frames\"", "\"frames\"", E::NoFramesKey { at: at(10, 1) }),
        ("\"wrap\"", "\"round\"", unexpected(at(2, 9), "\"wrap\" or \"none\"", "round")),
        ("\"wrap\"", "1", unexpected(at(2, 9), "\"wrap\" or \"none\"", "1")),
        ("\"Loop\":", "Loop:", unexpected(at(2, 1), "a key in quotation marks", "Loop")),
        ("\"Loop\":", "\"Loop\"", unexpected(at(2, 8), "a colon", "\\\"")),
        ("\n}\n", "\n} x\n", unexpected(at(9, 3), "the end of the file", "x")),
        ("\"wrap\",", "\"wrap\"", unexpected(at(3, 1), "a comma or a closing brace", "\\\"")),
        ("[\n[", "[\n[[", unexpected(at(5, 2), "a number", "[")),
        ("],\n", "]\n", unexpected(at(6, 1), "a comma or a closing bracket", "[")),
        ("]\n]", "],\n]", unexpected(at(8, 1), "a row of numbers in brackets", "]")),
        ("0.033332, 0, 0.9", "0.033332, 0 0.9", unexpected(at(5, 14), "a comma or a closing bracket", "0.9")),
        ("0.1, 0.9", "0.1, nan", text(TextError::NotFinite { at: at(6, 17), found: "nan".to_owned() })),
        ("0.1, 0.9", "0.1, 1e999", text(TextError::NotFinite { at: at(6, 17), found: "1e999".to_owned() })),
        ("0.1, 0.9", "0.1, null", text(TextError::NotANumber { at: at(6, 17), found: "null".to_owned() })),
        ("0.1, 0.9", "0.1, 2e9", E::TooFar { at: at(6, 17), found: 2e9, most: 1e9 }),
        ("0.1, 0.9,", "0.1,", E::RowLength { at: at(6, 1), row: 2, expected: 44, found: 43 }),
        ("0.1, 0.9,", "0.1, 0.9, 1,", E::RowLength { at: at(6, 1), row: 2, expected: 44, found: 45 }),
        (
            "[0.033332, 0.1",
            "[], [0.033332, 0.1",
            E::RowLength { at: at(6, 1), row: 2, expected: 44, found: 0 },
        ),
        ("[0.033332, 0.1", "[-0.03, 0.1", E::Duration { at: at(6, 2), row: 2, found: -0.03 }),
        (
            "0.5, 0.5, 0.5, 0.5",
            "0, 0, 0, 0",
            E::NoRotation { at: at(6, 25), row: 2, joint: "root", length: 0.0 },
        ),
        (
            "0.5, 0.5, 0.5, 0.5",
            "0, 3, 0, 0",
            E::NoRotation { at: at(6, 25), row: 2, joint: "root", length: 3.0 },
        ),
        ("[0.033332, 0.1", "[0.05, 0.1", E::Uneven { at: at(5, 2), row: 1, found: 0.033_332, usual: 0.05 }),
    ];
    for (what, by, expected) in cases {
        let found = fault(what, by);
        assert_eq!(found, expected, "{what} → {by}");
        assert!(found.to_string().starts_with(&found.position().to_string()), "{found}");
    }
    let no_rows = read_text("{\"Frames\": []}").expect_err("no rows");
    assert_eq!(no_rows, E::NoFrames { at: at(1, 12) });
    assert_eq!(read_text("{}").err(), Some(E::NoFramesKey { at: at(1, 3) }));
    assert!(matches!(read_text(""), Err(E::NotDeepMimic { at: Position { line: 1, column: 1 }, .. })));
}

#[test]
fn a_file_cut_anywhere_is_an_error() {
    let text = small();
    let whole = text.trim_end().len();
    for end in 0..whole {
        assert!(read_text(&text[..end]).is_err(), "cut at {end}");
    }
    assert!(read_text(&text[..whole]).is_ok());
}

#[test]
fn quaternions_that_are_a_little_off_are_scaled_and_noted() {
    let read = valid(&spoilt("0.5, 0.5, 0.5, 0.5", "0.6, 0.6, 0.6, 0.6"));
    assert!((read.clip.rotations[13].length() - 1.0).abs() < ROUNDING);
    let [ReadNote::RotationsScaled { frames, length }] = &read.notes[..] else {
        panic!("{:?}", read.notes);
    };
    assert_eq!(frames, &[SourceFrame(1)]);
    assert!((length - 1.2).abs() < ROUNDING);
    assert_eq!(valid(&spoilt("0.5, 0.5, 0.5, 0.5", "0.501, 0.501, 0.501, 0.501")).notes, []);
}

/// Rows of the given durations.
fn lasting(seconds: &[&str]) -> String {
    let rows: Vec<String> =
        seconds.iter().map(|seconds| row(seconds, "0, 0.9, 0", "1, 0, 0, 0", "0")).collect();
    format!("{{\"Frames\": [{}]}}", rows.join(","))
}

#[test]
fn the_rate_is_that_of_most_frames() {
    for (seconds, fps) in [("0.016666", 60.0), ("0.0625", 16.0), ("0.041708", 1.0 / 0.041_708)] {
        let read = valid(&lasting(&[seconds, seconds, seconds, "0"]));
        assert_eq!((read.header_fps, read.notes), (fps, vec![]));
    }
    let mut seconds = vec!["0.016666"; 12];
    seconds[4] = "0.032666";
    let read = valid(&lasting(&seconds));
    assert_eq!((read.header_fps, read.clip.frame_count()), (60.0, 12));
    assert_eq!(read.notes, [ReadNote::UnevenFrames { frames: vec![SourceFrame(4)] }]);
    seconds[5] = "0.032666";
    assert!(matches!(read_text(&lasting(&seconds)), Err(DeepMimicError::Uneven { row: 5, .. })));
    let pose = valid(&lasting(&["0"]));
    assert_eq!((pose.header_fps, pose.notes), (30.0, vec![ReadNote::RateAssumed { fps: 30.0 }]));
    assert!(matches!(read_text(&lasting(&["0", "0"])), Err(DeepMimicError::Duration { row: 1, .. })));
    assert!(matches!(read_text(&lasting(&["11", "0"])), Err(DeepMimicError::Duration { row: 1, .. })));
}

#[test]
fn values_that_are_no_numbers_are_filled_in_on_request() {
    let plain = valid(&small()).clip;
    for word in ["NaN", "Infinity", "null", "1e999"] {
        let text = spoilt("[0.033332, 0.1", &format!("[0.033332, {word}"));
        let read = super::motion(text.as_bytes(), "small", true).expect("a single value to repair");
        assert_eq!(read.clip, plain);
        assert_eq!(read.notes, [ReadNote::ValuesFilledIn { frames: vec![SourceFrame(1)] }]);
    }
    let text = small().replace("0.9, 0,", "null, 0,");
    let expected = DeepMimicError::LongGap { at: at(5, 15), limit: 3 };
    assert_eq!(super::motion(text.as_bytes(), "small", true).err(), Some(expected));
}

#[test]
fn deep_nesting_needs_no_stack() {
    let depth = 200_000;
    let nested = format!("\"x\": {}{}, \"Loop\"", "[".repeat(depth), "]".repeat(depth));
    assert!(read_text(&spoilt("\"Loop\"", &nested)).is_ok());
    let open = format!("\"x\": {}, \"Loop\"", "{\"y\":".repeat(depth));
    assert!(read_text(&spoilt("\"Loop\"", &open)).is_err());
}
