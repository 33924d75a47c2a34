//! A small valid file, and what happens when one thing in it is spoilt.

use glam::{DQuat, DVec3};
use proptest::prelude::*;

use super::*;
use crate::clip::text::TextError;
use crate::skeleton::Axis;

const SMALL: &str = "HIERARCHY
ROOT Hips
{
  OFFSET 7 8 9
  CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
  JOINT Left Arm
  {
    OFFSET 0 1 0
    CHANNELS 3 Xrotation Yrotation Zrotation
    End Site
    {
      OFFSET 0 0.5 0
    }
  }
}
MOTION
Frames: 2
Frame Time: .0083333
1 2 3 90 0 0 0 0 90
1 2 4 0 0 0 0 0 0
";

fn options() -> ReadOptions {
    ReadOptions { unit_to_m: Some(1.0), up: Some(Up::Y), ..ReadOptions::default() }
}

fn read_text(text: &str) -> Result<ReadClip, BvhError> {
    read(Capture::Bvh(text.as_bytes()), "small", &options()).map_err(|error| match error {
        ReadError::Bvh(error) => error,
        other => panic!("no fault of the text: {other}"),
    })
}

fn read_spoilt(what: &str, by: &str) -> BvhError {
    assert!(SMALL.contains(what));
    read_text(&SMALL.replacen(what, by, 1)).expect_err("a spoilt file")
}

#[test]
fn root_channels_replace_the_offset_and_rotations_multiply_in_their_order() {
    let read = read_text(SMALL).expect("a valid file");
    let clip = &read.clip;
    assert_eq!(clip.fps, 120.0);
    assert_eq!(clip.root_positions, vec![DVec3::new(1.0, 2.0, 3.0), DVec3::new(1.0, 2.0, 4.0)]);
    assert_eq!(clip.skeleton.joints[1].name, "Left Arm");
    assert_eq!(clip.skeleton.joints[1].rotation_order, [Axis::X, Axis::Y, Axis::Z]);
    assert_eq!(clip.skeleton.joints[1].end_site, Some(DVec3::Y * 0.5));
    let frames = clip.skeleton.forward_kinematics(&clip.pose(SourceFrame(0)));
    assert!(frames[1].position.distance(DVec3::new(0.0, 2.0, 3.0)) < 1e-15);
    assert!((frames[1].rotation * DVec3::X).distance(DVec3::NEG_X) < 1e-15);
}

#[test]
fn line_ends_blanks_byte_order_mark_and_case_do_not_matter() {
    let plain = read_text(SMALL).expect("a valid file");
    let variants = [
        SMALL.replace('\n', "\r\n"),
        SMALL.replace('\n', "\r"),
        SMALL.replace('\n', "\n\n \t"),
        format!("\u{feff}{SMALL}"),
        SMALL.trim_end().to_owned(),
        SMALL.replace("Xposition", "XPOSITION").replace("Zrotation", "ZROTATION"),
        SMALL.replace("Hips\n{", "Hips {"),
        SMALL.replace(' ', "\t").replace("Left\tArm", "Left Arm"),
    ];
    for variant in variants {
        assert_eq!(read_text(&variant).expect("a valid variant"), plain, "{variant:?}");
    }
}

#[test]
fn faults_carry_line_and_column() {
    let at = |line, column| Position { line, column };
    assert_eq!(
        read_spoilt("1 2 4 0", "1 2 nan 0"),
        BvhError::Text(TextError::NotFinite { at: at(20, 5), found: "nan".to_owned() })
    );
    assert_eq!(
        read_spoilt("1 2 4 0", "1 2 4 é x"),
        BvhError::Text(TextError::NotANumber { at: at(20, 7), found: "é".to_owned() })
    );
    let text = SMALL.replace('\n', "\r\n").replace("0 1 0", "0 1e999 0");
    let error = read_text(&text).expect_err("an overflow");
    assert_eq!(error, BvhError::Text(TextError::NotFinite { at: at(8, 14), found: "1e999".to_owned() }));
    assert!(error.to_string().starts_with("line 8, column 14: `1e999` is not a finite number"));
}

#[test]
fn wrong_counts_name_both_numbers() {
    let row =
        |found| BvhError::RowLength { at: Position { line: 20, column: 1 }, row: 2, expected: 9, found };
    assert_eq!(read_spoilt("1 2 4 0 0 0", "1 2 4 0 0"), row(8));
    assert_eq!(read_spoilt("1 2 4 0 0 0", "1 2 4 0 0 0 0"), row(10));
    assert!(matches!(
        read_spoilt("Frames: 2", "Frames: 4000000000"),
        BvhError::RowsMissing { announced: 4_000_000_000, found: 2, .. }
    ));
    assert!(matches!(read_spoilt("Frames: 2", "Frames: 1"), BvhError::RowsLeft { announced: 1, .. }));
    assert!(matches!(
        read_spoilt("CHANNELS 3", "CHANNELS 2"),
        BvhError::ChannelCount { announced: 2, found: 3, .. }
    ));
    assert!(matches!(
        read_spoilt("CHANNELS 3", "CHANNELS 4"),
        BvhError::ChannelCount { announced: 4, found: 3, .. }
    ));
    assert!(matches!(read_spoilt("Frames: 2", "Frames: -2"), BvhError::Text(TextError::NotACount { .. })));
    assert!(matches!(read_spoilt("Frames: 2", "Frames: 0"), BvhError::NoFrames { .. }));
}

#[test]
fn spoilt_words_are_named() {
    assert!(matches!(read_spoilt("HIERARCHY", "MZ\u{0}"), BvhError::NotBvh { .. }));
    assert!(matches!(
        read_spoilt("Xrotation Yrotation Z", "Xrotation Yrotation W"),
        BvhError::UnknownChannel { .. }
    ));
    assert!(matches!(read_spoilt("JOINT Left Arm", "JOINT"), BvhError::NoName { .. }));
    assert!(matches!(read_spoilt("MOTION", "ROOT Other"), BvhError::SecondRoot { .. }));
    assert!(matches!(read_spoilt("}\nMOTION", "MOTION"), BvhError::MissingBrace { .. }));
    assert!(matches!(read_spoilt("}\nMOTION", "}\n}\nMOTION"), BvhError::Text(TextError::Unexpected { .. })));
    assert!(matches!(read_spoilt(".0083333", "0"), BvhError::FrameTime { .. }));
    assert!(matches!(read_spoilt(".0083333", "-0.1"), BvhError::FrameTime { .. }));
    assert!(matches!(read_spoilt("OFFSET 7 8 9", "OFFSET 7 8 9 OFFSET 7 8 9"), BvhError::Repeated { .. }));
    assert!(matches!(read_spoilt("OFFSET 7 8 9", ""), BvhError::NoOffset { .. }));
    assert!(matches!(
        read_spoilt("3 Xrotation Yrotation", "3 Xrotation Xrotation"),
        BvhError::RepeatedChannel { .. }
    ));
}

#[test]
fn frame_times_in_few_digits_mean_the_usual_rate() {
    let rates = [
        (".0083333", 120.0),
        ("0.008333", 120.0),
        ("0.033333", 30.0),
        ("0.0333333", 30.0),
        ("0.0416667", 24.0),
        ("3.3333e-2", 30.0),
        ("0.04", 25.0),
        ("0.01", 100.0),
        ("0.016", 60.0),
        ("0.0417083", 1.0 / 0.0417083),
        ("0.041708333333333333", 1.0 / 0.041_708_333_333_333_33),
        ("0.0111111111111111", 90.0),
        ("0.0270270270270270", 37.0),
    ];
    for (written, fps) in rates {
        let read = read_text(&SMALL.replace(".0083333", written)).expect("a valid file");
        assert_eq!(read.header_fps, fps, "{written}");
    }
}

#[test]
fn a_chain_of_thousands_of_joints_needs_no_stack() {
    let depth = 20_000;
    let mut text = String::from("HIERARCHY\nROOT a\n{\nOFFSET 0 0 0\nCHANNELS 1 Xrotation\n");
    for _ in 0..depth {
        text.push_str("JOINT b\n{\nOFFSET 0 1 0\n");
    }
    text.push_str(&"}\n".repeat(depth + 1));
    text.push_str("MOTION\nFrames: 1\nFrame Time: 0.1\n0\n");
    let read = read_text(&text).expect("a valid file");
    assert_eq!(read.clip.skeleton.joints.len(), depth + 1);
    assert_eq!(read.clip.root_positions[0], DVec3::ZERO);
}

#[test]
fn position_channels_below_the_root_move_joints() {
    let channels = "CHANNELS 6 Xrotation Yrotation Zrotation Xposition Yposition Zposition";
    let text = SMALL
        .replace("CHANNELS 3 Xrotation Yrotation Zrotation", channels)
        .replace("0 0 90\n", "0 0 90 0 1.25 0\n")
        .replace("0 0 0 0 0 0\n", "0 0 0 0 0 0 0 1 0\n");
    let clip = read_text(&text).expect("a valid file").clip;
    assert_eq!(clip.moving_offsets.len(), 1);
    assert_eq!(clip.moving_offsets[0].offsets, vec![DVec3::Y * 1.25, DVec3::Y]);
    let added = text
        .replace("0 1.25 0\n", "0 .25 0\n")
        .replace("0 1 0\nEnd", "")
        .replace("0 0 0 1 0\n", "0 0 0 0 0\n");
    let read = read_text(&added).expect("a valid file");
    assert_eq!(read.clip.moving_offsets, clip.moving_offsets);
    assert!(read.notes.contains(&ReadNote::DisplacementChannels));
}

/// A body read as z up is the y-up body turned by −90° about x.
#[test]
fn z_up_is_turned_with_its_joint_axes() {
    let y_up = read_text(SMALL).expect("a valid file").clip;
    let options = ReadOptions { up: Some(Up::Z), ..options() };
    let z_up = read(Capture::Bvh(SMALL.as_bytes()), "small", &options).expect("a valid file").clip;
    let turn = DQuat::from_rotation_x(-std::f64::consts::FRAC_PI_2);
    for frame in [SourceFrame(0), SourceFrame(1)] {
        let before = y_up.skeleton.forward_kinematics(&y_up.pose(frame));
        let after = z_up.skeleton.forward_kinematics(&z_up.pose(frame));
        for (before, after) in before.iter().zip(&after) {
            assert!((turn * before.position).distance(after.position) < 1e-12);
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    /// Whatever bytes come, reading ends in an error or in a clip that can be worked with.
    #[test]
    fn mutated_bytes_never_panic(
        edits in prop::collection::vec((0..SMALL.len(), any::<u8>(), 0..4_u8), 1..12),
        cut in 0..2 * SMALL.len(),
    ) {
        let mut bytes = SMALL.as_bytes().to_vec();
        for (at, byte, kind) in edits {
            let at = at.min(bytes.len().saturating_sub(1));
            match kind {
                0 => bytes[at] = byte,
                1 => bytes.insert(at, byte),
                2 if bytes.len() > 1 => { bytes.remove(at); }
                _ => bytes[at] = b"0129.-e{}\n x"[usize::from(byte) % 12],
            }
        }
        bytes.truncate(cut.max(1));
        if let Ok(read) = read(Capture::Bvh(&bytes), "mutated", &ReadOptions::default()) {
            let facts = crate::clip::inspect::inspect("mutated", &read);
            prop_assert_eq!(facts.frames, read.clip.frame_count());
        }
    }
}

#[test]
fn what_no_text_pays_for_is_refused_at_once() {
    let still =
        SMALL.replace("  CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation\n", "");
    let still = still.replace("    CHANNELS 3 Xrotation Yrotation Zrotation\n", "");
    let announced = still.replace("Frames: 2", "Frames: 4294967295");
    for text in [&still, &announced] {
        let error = read_text(text).expect_err("no channels");
        assert_eq!(error, BvhError::NoChannels { at: Position { line: 15, column: 9 } });
    }
    let joints = "JOINT a\n{\nOFFSET 0 1 0\n}\n".repeat(9_999);
    let start = "HIERARCHY\nROOT a\n{\nOFFSET 0 0 0\nCHANNELS 1 Xrotation\n";
    let rows = "0\n".repeat(200);
    let text = format!("{start}{joints}}}\nMOTION\nFrames: 200\nFrame Time: .01\n{rows}");
    let error = read_text(&text).err();
    let expected = Some(BvhError::TooManyRotations {
        at: Position { line: 40_004, column: 9 },
        joints: 10_000,
        frames: 200,
    });
    assert_eq!(error, expected);
}

#[test]
fn coordinates_beyond_all_bodies_are_refused() {
    let offset = read_spoilt("OFFSET 0 1 0", "OFFSET 0 -2e9 0");
    assert_eq!(offset, BvhError::TooFar { at: Position { line: 8, column: 14 }, found: -2e9, most: 1e9 });
    let place = read_spoilt("1 2 4 0", "1 2e9 4 0");
    assert_eq!(place, BvhError::TooFar { at: Position { line: 20, column: 1 }, found: 2e9, most: 1e9 });
    let angle = read_spoilt("1 2 4 0", "1 2 4 2e9");
    assert_eq!(angle, place);
}
