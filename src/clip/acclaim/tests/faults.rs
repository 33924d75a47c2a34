//! What is wrong, where: one thing spoilt at a time.

use super::*;
use crate::clip::text::TextError;

fn skeleton_fault(what: &str, by: &str) -> AsfError {
    match read_texts(&spoilt(SKELETON, what, by), MOTION) {
        Err(AcclaimError::Skeleton(error)) => error,
        other => panic!("no fault of the skeleton: {other:?}"),
    }
}

fn motion_fault(what: &str, by: &str) -> AmcError {
    match read_texts(SKELETON, &spoilt(MOTION, what, by)) {
        Err(AcclaimError::Motion(error)) => error,
        other => panic!("no fault of the motion: {other:?}"),
    }
}

#[test]
fn faults_of_the_skeleton_name_what_and_where() {
    use AsfError as E;
    let text = String::from;
    let lacks = |field, line| E::BoneLacks { at: at(line, 3), bone: text("hip"), field };
    let cases = [
        (
            "# made by hand\n:version",
            "HIERARCHY\n:version",
            E::NotAsf { at: at(1, 1), found: text("`HIERARCHY`") },
        ),
        (
            "length 0.45",
            "length 0",
            E::OutOfRange { at: at(6, 10), found: 0.0, what: "unit of length", least: 1e-6, most: 1e6 },
        ),
        (
            "length 2",
            "length -2",
            E::OutOfRange { at: at(20, 12), found: -2.0, what: "length", least: 0.0, most: 1e9 },
        ),
        (
            "direction 0 -1 0",
            "direction 0 -1e10 0",
            E::OutOfRange { at: at(19, 17), found: -1e10, what: "coordinate", least: -1e9, most: 1e9 },
        ),
        ("length 2", "length 2\n    length 3", E::Repeated { at: at(21, 5), what: text("length") }),
        (":hierarchy", ":root\n:hierarchy", E::Repeated { at: at(33, 1), what: text(":root") }),
        ("    direction 0 -1 0\n", "", lacks("direction", 24)),
        ("    length 2\n", "", lacks("length", 24)),
        ("    axis 0 0 90 XYZ\n", "", lacks("axis", 24)),
        ("    name hip\n", "", E::BoneLacks { at: at(24, 3), bone: text(""), field: "name" }),
        ("name knee", "name hip", E::NameTaken { at: at(28, 10), name: text("hip") }),
        ("name knee", "name root", E::NameTaken { at: at(28, 10), name: text("root") }),
        ("90 XYZ", "90 XYY", E::RotationOrder { at: at(21, 17), found: text("XYY") }),
        ("90 XYZ", "90 XYZX", E::RotationOrder { at: at(21, 17), found: text("XYZX") }),
        (
            "RX RY RZ",
            "RX RY RW",
            E::UnknownDof {
                at: at(11, 24),
                found: text("RW"),
                known: "the root has TX, TY, TZ, RX, RY and RZ",
            },
        ),
        ("RX RY RZ", "RX RY RX", E::Repeated { at: at(11, 24), what: text("RX") }),
        (
            "dof rx rz",
            "dof rx rw",
            E::UnknownDof { at: at(22, 12), found: text("rw"), known: "bones have rx, ry and rz" },
        ),
        ("dof rx rz", "dof rx rx", E::Repeated { at: at(22, 12), what: text("rx") }),
        ("dof rx rz", "dof rx tz", E::MovingBone { at: at(22, 12), bone: text("hip"), found: text("tz") }),
        ("dof rx rz", "dof rx l", E::MovingBone { at: at(22, 12), bone: text("hip"), found: text("l") }),
        ("dof rx rz", "dof rx", E::LimitCount { at: at(23, 5), bone: text("hip"), dofs: 1, found: 2 }),
        (
            "           (-70.0 inf)\n",
            "",
            E::LimitCount { at: at(23, 5), bone: text("hip"), dofs: 2, found: 1 },
        ),
        ("(-160.0 20.0)", "(20 -160)", E::LimitsCross { at: at(23, 12), low: 20.0, high: -160.0 }),
        ("root hip", "root hap", E::UnknownBone { at: at(35, 10), name: text("hap") }),
        ("hip knee", "hop knee", E::UnknownBone { at: at(36, 5), name: text("hop") }),
        ("hip knee", "hip knee hip", E::SecondParent { at: at(36, 14), bone: text("hip") }),
        ("hip knee", "hip root", E::UnknownBone { at: at(36, 9), name: text("root") }),
        (
            "root hip\n    hip knee",
            "knee hip\n    hip knee",
            E::NotConnected { at: at(18, 10), bone: text("hip") },
        ),
        ("    hip knee\n", "", E::NotConnected { at: at(28, 10), bone: text("knee") }),
    ];
    for (what, by, expected) in cases {
        let found = skeleton_fault(what, by);
        assert_eq!(found, expected, "{what} → {by}");
        assert!(found.to_string().starts_with(&found.position().to_string()), "{found}");
    }
}

#[test]
fn words_that_do_not_belong_are_quoted_with_their_place() {
    let unexpected =
        |at, expected, found: &str| TextError::Unexpected { at, expected, found: format!("`{found}`") };
    let text = AsfError::Text;
    let cases = [
        ("mass 1.0", "weight 1.0", text(unexpected(at(5, 3), "mass, length or angle", "weight"))),
        ("angle deg", "angle gon", text(unexpected(at(7, 9), "deg or rad", "gon"))),
        (
            "order TX",
            "orders TX",
            text(unexpected(at(11, 3), "order, axis, position or orientation", "orders")),
        ),
        ("id 2", "sort 2", text(unexpected(at(27, 5), "a field of a bone, or its end", "sort"))),
        (
            "(-160.0 20.0)",
            "(-160.0 20.0 30.0)",
            text(unexpected(at(23, 25), "a closing parenthesis", "30.0")),
        ),
        ("(-160.0 20.0)", "(-160.0 20.0)x", text(unexpected(at(23, 25), "an opening parenthesis", "x"))),
        (
            "  end\n:hierarchy",
            ":hierarchy",
            text(unexpected(at(32, 1), "a field of a bone, or its end", ":hierarchy")),
        ),
        ("length 2", "length two", text(TextError::NotANumber { at: at(20, 12), found: "two".to_owned() })),
        ("length 2", "length nan", text(TextError::NotFinite { at: at(20, 12), found: "nan".to_owned() })),
        ("(-160.0", "(nan", text(TextError::NotFinite { at: at(23, 13), found: "nan".to_owned() })),
    ];
    for (what, by, expected) in cases {
        assert_eq!(skeleton_fault(what, by), expected, "{what} → {by}");
    }
    let end = |text: &str| read_texts(text, MOTION).expect_err("a file cut short");
    assert!(matches!(end(""), AcclaimError::Skeleton(AsfError::NotAsf { .. })));
    let cut = |until: &str| end(&SKELETON[..SKELETON.find(until).expect("a word")]);
    assert!(matches!(
        cut(":hierarchy"),
        AcclaimError::Skeleton(AsfError::NoSection { section: ":hierarchy", .. })
    ));
    assert!(matches!(
        cut(":bonedata"),
        AcclaimError::Skeleton(AsfError::NoSection { section: ":bonedata", .. })
    ));
    assert!(matches!(cut("hip knee"), AcclaimError::Skeleton(AsfError::Text(TextError::EndOfFile { .. }))));
    assert!(end("").is_in_skeleton());
}

#[test]
fn faults_of_the_motion_name_bone_and_frame() {
    use AmcError as E;
    let hip = || "hip".to_owned();
    let cases = [
        ("\n2\n", "\n3\n", E::FrameNumber { at: at(7, 1), expected: 2, found: 3 }),
        ("\n2\n", "\n1\n", E::FrameNumber { at: at(7, 1), expected: 2, found: 1 }),
        ("hip 90 0\n", "", E::MissingBone { at: at(4, 1), bone: hip(), frame: 1 }),
        ("root 1 2 4 90 0 90\n", "", E::MissingBone { at: at(7, 1), bone: "root".to_owned(), frame: 2 }),
        ("hip 90 0\n", "hip 90 0\nhip 90 0\n", E::RepeatedBone { at: at(7, 1), bone: hip(), frame: 1 }),
        ("hip 90 0\n", "hap 90 0\n", E::UnknownBone { at: at(6, 1), name: "hap".to_owned(), frame: 1 }),
        (
            "hip 90 0\n",
            "hip 90\n",
            E::ValueCount { at: at(6, 1), bone: hip(), frame: 1, expected: 2, found: 1 },
        ),
        (
            "hip 90 0\n",
            "hip 90 0 0\n",
            E::ValueCount { at: at(6, 1), bone: hip(), frame: 1, expected: 2, found: 3 },
        ),
        ("root 1 2 3", "root 1 2e9 3", E::TooFar { at: at(5, 8), found: 2e9, most: 1e9 }),
        (
            "hip 90 0\n",
            "hip 90 nan\n",
            E::Text(TextError::NotFinite { at: at(6, 8), found: "nan".to_owned() }),
        ),
        ("hip 90 0\n", "hip 90 x\n", E::Text(TextError::NotANumber { at: at(6, 8), found: "x".to_owned() })),
    ];
    for (what, by, expected) in cases {
        assert_eq!(motion_fault(what, by), expected, "{what} → {by}");
    }
    let unexpected = |what, by, place| {
        let found = motion_fault(what, by);
        assert!(matches!(found, E::Text(TextError::Unexpected { at, .. }) if at == place), "{found}");
    };
    unexpected(":DEGREES\n1\n", ":DEGREES\n", at(4, 1));
    unexpected("\n2\n", "\n2 x\n", at(7, 3));
    unexpected(":DEGREES", ":GRADS", at(3, 1));
    let rate = motion_fault(":DEGREES", ":SAMPLES-PER-SECOND 0");
    assert_eq!(rate, E::Rate { at: at(3, 1), found: 0.0 });
    let count = motion_fault("\n2\n", "\n4294967296\n");
    assert!(
        matches!(count, E::Text(TextError::NotACount { at: Position { line: 7, column: 1 }, .. })),
        "{count}"
    );
    let empty = read_texts(SKELETON, ":FULLY-SPECIFIED\n").expect_err("no frames");
    assert_eq!(empty, AcclaimError::Motion(E::NoFrames { at: at(2, 1) }));
    assert!(!empty.is_in_skeleton());
}
