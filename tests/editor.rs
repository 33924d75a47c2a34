//! The editor follows its handles: factored once, dragged often, and nobody moves whom nothing concerns.

use std::path::Path;

use cotillion::edit::clash::Miss;
use cotillion::edit::{Edit, EditError, EditNote, Editor, Target};
use cotillion::geometry::{c64, cis, plan_of, wrap};
use cotillion::index::ConstraintId;
use cotillion::resample::time_of;
use cotillion::scene::{ClipFolders, Scene, load_text};
use proptest::prelude::*;

/// Rounding of solves on paths of some metres.
const ROUNDING: f64 = 1e-9;

const THREE: &str = r#"
[clips]
walk = { builtin = "walk", stop = 1, seconds = 4.0 }
slap = "builtin:slap"
[[character]]
name = "ann"
track = ["walk", "slap"]
[[character]]
name = "bo"
track = ["walk", "slap"]
position = [6.0, 0.5]
facing = 170.0
[[character]]
name = "cy"
track = ["walk", "slap"]
position = [0.0, 9.0]
[[object]]
name = "box"
size = [0.4, 0.3, 0.3]
position = [2.0, -3.0]
facing = 90.0
[[pin]]
name = "ann starts"
at = "ann:start"
position = [0.0, 0.0]
facing = 0.0
strength = "hard"
[[pin]]
name = "bo starts"
at = "bo:start"
position = [6.0, 0.0]
strength = "hard"
[[pin]]
name = "cy ends"
at = "cy:end"
position = [1.0, 12.0]
[[relative]]
name = "slap"
at = "bo/slap:hit"
to = "ann/slap:hit"
offset = [0.9, -0.4]
facing = 180.0
strength = "hard"
[[sync]]
name = "together"
moments = ["ann/slap:hit", "bo/slap:hit"]
strength = "hard"
[[time]]
name = "when"
at = "ann/slap:hit"
seconds = 6.0
strength = "hard"
"#;

fn scene(text: &str) -> Scene {
    load_text(text, Path::new("editor.toml"), &ClipFolders::default()).expect("a sound scene").scene
}

fn editor(text: &str) -> Editor {
    Editor::new(scene(text)).expect("a regular scene")
}

fn id(editor: &Editor, name: &str) -> ConstraintId {
    let place = editor.scene().constraints.iter().position(|constraint| constraint.name == name);
    ConstraintId::from_usize(place.expect("the scene has this constraint"))
}

fn drag(editor: &mut Editor, name: &str, target: Target) -> Edit {
    let id = id(editor, name);
    editor.move_target(id, target).expect("the constraint has such a target");
    editor.solve().expect("the scene has an answer").clone()
}

/// Track frame at which somebody slaps.
fn hit(editor: &Editor, character: usize) -> f64 {
    let track = &editor.scene().characters[character].track;
    let working = f64::from(track.clips[1].clip.events["hit"].0);
    track.locate(cotillion::constraint::Instant::Frame { entry: 1, working }).expect("events are shown")
}

/// Where bo is in ann's body-facing frame at the slap, and how they face each other.
fn meeting(editor: &Editor, edit: &Edit) -> (c64, f64) {
    let stance = |character: usize| {
        let track = &editor.scene().characters[character].track;
        let pose = edit.characters[character].pose(track, hit(editor, character));
        let skeleton = &track.clips[0].clip.skeleton;
        let heading = cotillion::clip::facing::facing(skeleton, &skeleton.forward_kinematics(&pose));
        (plan_of(pose.root), heading.expect("people who stand face somewhere"))
    };
    let ((ann, ann_faces), (bo, bo_faces)) = (stance(0), stance(1));
    ((bo - ann) * cis(-ann_faces), wrap(bo_faces - ann_faces))
}

/// Whether a note names a constraint as implied by others.
fn implied(note: &EditNote, name: &str) -> bool {
    matches!(note, EditNote::Redundant(named) if named.iter().any(|named| named.name == name))
}

#[test]
fn a_hard_meeting_holds_on_the_motion_itself() {
    let mut editor = editor(THREE);
    let edit = editor.solve().expect("the scene has an answer").clone();
    let (offset, facing) = meeting(&editor, &edit);
    assert!((offset - c64::new(0.9, -0.4)).norm() < ROUNDING);
    assert!((facing.abs() - std::f64::consts::PI).abs() < ROUNDING);
    for character in 0..2 {
        let time = time_of(&edit.characters[character].times, hit(&editor, character));
        assert!((time - 6.0).abs() < ROUNDING);
    }
}

#[test]
fn every_kind_of_target_can_be_dragged() {
    let mut editor = editor(THREE);
    let edit = drag(&mut editor, "slap", Target::Offset(c64::new(1.2, 0.1)));
    assert!((meeting(&editor, &edit).0 - c64::new(1.2, 0.1)).norm() < ROUNDING);
    let edit = drag(&mut editor, "slap", Target::Facing(2.0));
    assert!((meeting(&editor, &edit).1 - 2.0).abs() < ROUNDING);
    let edit = drag(&mut editor, "when", Target::Seconds(7.0));
    assert!((time_of(&edit.characters[1].times, hit(&editor, 1)) - 7.0).abs() < ROUNDING);
    let edit = drag(&mut editor, "together", Target::Seconds(0.5));
    assert!((time_of(&edit.characters[1].times, hit(&editor, 1)) - 6.5).abs() < ROUNDING);
    let edit = drag(&mut editor, "bo starts", Target::Position(c64::new(5.0, 2.0)));
    assert!((edit.characters[1].positions[0] - c64::new(5.0, 2.0)).norm() < ROUNDING);
    let edit = drag(&mut editor, "ann starts", Target::Facing(0.3));
    let track = &editor.scene().characters[0].track;
    let turned = track.heading(0.0) + edit.characters[0].turns.at(0.0);
    assert!(wrap(turned - 0.3).abs() < ROUNDING);
}

#[test]
fn targets_that_make_no_sense_are_refused() {
    let mut editor = editor(THREE);
    let (slap, pin) = (id(&editor, "slap"), id(&editor, "bo starts"));
    let refused = editor.move_target(pin, Target::Position(c64::new(f64::NAN, 0.0)));
    assert!(matches!(refused, Err(EditError::NotFinite(_))));
    assert!(matches!(editor.move_target(pin, Target::Facing(0.0)), Err(EditError::NoSuchTarget(..))));
    assert!(matches!(editor.move_target(slap, Target::Seconds(0.0)), Err(EditError::NoSuchTarget(..))));
}

#[test]
fn strangers_are_unaffected_bit_for_bit() {
    let mut editor = editor(THREE);
    let before = editor.solve().expect("the scene has an answer").characters[2].clone();
    let after = drag(&mut editor, "bo starts", Target::Position(c64::new(4.0, -3.0)));
    assert!(before == after.characters[2]);
}

#[test]
fn a_relative_place_beside_an_object_follows_the_object_frame() {
    let text = format!(
        "{THREE}\n[[relative]]\nname = \"at the box\"\nat = \"cy:start\"\nto = \"box\"\noffset = [-0.5, 0.2]\nfacing = 0.0\nstrength = \"hard\"\n"
    );
    let mut editor = editor(&text);
    let edit = editor.solve().expect("the scene has an answer").clone();
    // Behind a box that looks along +y of the plan, and to its left, which is −x.
    let expected = c64::new(2.0 - 0.2, -3.0 - 0.5);
    assert!((edit.characters[2].positions[0] - expected).norm() < ROUNDING);
    let edit = drag(&mut editor, "at the box", Target::Offset(c64::new(-1.0, 0.0)));
    assert!((edit.characters[2].positions[0] - c64::new(2.0, -4.0)).norm() < ROUNDING);
}

#[test]
fn redundant_constraints_are_named_in_a_note() {
    let text = format!(
        "{THREE}\n[[pin]]\nname = \"once more\"\nat = \"bo:start\"\nposition = [6.0, 0.0]\nstrength = \"hard\"\n"
    );
    let mut editor = editor(&text);
    let edit = editor.solve().expect("the two agree");
    let named = edit.notes.iter().any(|note| implied(note, "once more"));
    assert!(named, "{:?}", edit.notes);
}

#[test]
fn a_conflict_names_the_constraints_and_the_editor_recovers() {
    let text = format!(
        "{THREE}\n[[pin]]\nname = \"elsewhere\"\nat = \"bo:start\"\nposition = [6.0, 1.0]\nstrength = \"hard\"\n"
    );
    let mut editor = editor(&text);
    match editor.solve() {
        Err(EditError::Conflict { constraints, miss }) => {
            let names: Vec<&str> = constraints.iter().map(|named| named.name.as_str()).collect();
            assert_eq!(names, ["bo starts", "elsewhere"]);
            assert!(matches!(miss, Miss::Metres(miss) if (miss - 1.0).abs() < ROUNDING));
        }
        other => panic!("expected a conflict, found {other:?}"),
    }
    let edit = drag(&mut editor, "elsewhere", Target::Position(c64::new(6.0, 0.0)));
    assert!((edit.characters[1].positions[0] - c64::new(6.0, 0.0)).norm() < ROUNDING);
}

#[test]
fn who_stands_can_look_at_two_places_in_turn() {
    let text = "[clips]\nidle = \"builtin:idle\"\n[[character]]\nname = \"a\"\ntrack = [\"idle\"]\n\
                [[pin]]\nname = \"left\"\nat = \"a:10\"\nfacing = 30.0\nstrength = \"hard\"\n\
                [[pin]]\nname = \"right\"\nat = \"a:80\"\nfacing = 120.0\nstrength = \"hard\"\n";
    let mut editor = editor(text);
    let edit = editor.solve().expect("people turn on the spot").clone();
    for residual in cotillion::residual::residuals(editor.scene(), &edit) {
        assert!(residual.facing.is_some_and(|miss| miss < ROUNDING), "{residual:?}");
    }
    let clash =
        format!("{text}[[pin]]\nname = \"back\"\nat = \"a:80\"\nfacing = 210.0\nstrength = \"hard\"\n");
    match Editor::new(scene(&clash)).expect("regular").solve() {
        Err(EditError::Conflict { constraints, miss: Miss::Radians(radians) }) => {
            let names: Vec<&str> = constraints.iter().map(|named| named.name.as_str()).collect();
            assert_eq!(names, ["right", "back"]);
            assert!((radians.to_degrees() - 90.0).abs() < 1e-6);
        }
        other => panic!("expected a conflict of facings, found {other:?}"),
    }
    let clash = text.replace("a:80", "a:10");
    let solved = Editor::new(scene(&clash)).expect("regular").solve().map(|_| ());
    match solved {
        Err(EditError::Conflict { miss: Miss::Radians(radians), .. }) => {
            assert!((radians.to_degrees() - 90.0).abs() < 1e-6);
        }
        other => panic!("expected a conflict of facings, found {other:?}"),
    }
}

#[test]
fn a_stand_that_was_pulled_apart_is_whole_again_when_the_drag_returns() {
    let text = "[clips]\nidle = \"builtin:idle\"\n[[character]]\nname = \"a\"\ntrack = [\"idle\"]\nposition = [0.0, 0.0]\n\
                [[pin]]\nname = \"first\"\nat = \"a:0\"\nposition = [0.0, 0.0]\nstrength = \"hard\"\n\
                [[pin]]\nname = \"last\"\nat = \"a:90\"\nposition = [0.0, 0.0]\nstrength = \"hard\"\n";
    let released = |edit: &Edit| edit.notes.iter().any(|note| matches!(note, EditNote::Released { .. }));
    let mut editor = editor(text);
    let before = editor.solve().expect("the clip ends where it began").clone();
    let apart = drag(&mut editor, "last", Target::Position(c64::new(0.5, 0.0)));
    assert!(!released(&before) && released(&apart));
    assert!((apart.characters[0].positions[90] - c64::new(0.5, 0.0)).norm() < ROUNDING);
    let again = drag(&mut editor, "last", Target::Position(c64::new(0.6, 0.1)));
    assert!(released(&again));
    assert!(drag(&mut editor, "last", Target::Position(c64::default())) == before);
}

#[test]
fn a_failed_solve_leaves_the_last_result() {
    let clash = format!("{THREE}\n[[pin]]\nat = \"bo:start\"\nposition = [6.0, 0.0]\nstrength = \"hard\"\n");
    let mut clashing = Editor::new(scene(&clash)).expect("regular");
    clashing.solve().expect("the two pins agree at first");
    let known = clashing.edit().clone();
    let (when, pin) = (id(&clashing, "when"), id(&clashing, "bo starts"));
    clashing.move_target(when, Target::Seconds(9.0)).expect("a time");
    clashing.move_target(pin, Target::Position(c64::new(5.0, 5.0))).expect("a place");
    assert!(clashing.solve().is_err());
    assert!(*clashing.edit() == known);
}

#[test]
fn offsets_follow_a_body_that_turns_on_the_spot() {
    let text = "[clips]\nidle = \"builtin:idle\"\nwalk = \"builtin:walk\"\n\
                [[character]]\nname = \"a\"\ntrack = [\"idle\"]\n[[character]]\nname = \"b\"\ntrack = [\"walk\"]\n\
                [[pin]]\nat = \"a:10\"\nfacing = 30.0\nstrength = \"hard\"\n\
                [[pin]]\nat = \"a:80\"\nfacing = 120.0\nstrength = \"hard\"\n\
                [[relative]]\nat = \"b:end\"\nto = \"a:80\"\noffset = [1.0, 0.5]\nfacing = 180.0\nstrength = \"hard\"\n\
                [[sync]]\nmoments = [\"b:end\", \"a:80\"]\nstrength = \"hard\"\n";
    let mut editor = editor(text);
    let edit = editor.solve().expect("an answer").clone();
    for residual in cotillion::residual::residuals(editor.scene(), &edit) {
        for miss in [residual.position, residual.facing, residual.seconds].into_iter().flatten() {
            assert!(miss < ROUNDING, "{residual:?}");
        }
    }
}

#[test]
fn pins_moved_apart_and_a_relative_facing_turn_people_without_stretching_them() {
    let text = "[clips]\nwalk = \"builtin:walk\"\n[[character]]\nname = \"a\"\ntrack = [\"walk\"]\nposition = [0.0, 0.0]\n\
                [[character]]\nname = \"b\"\ntrack = [\"walk\"]\nposition = [0.0, 3.0]\n\
                [[pin]]\nat = \"a:start\"\nposition = [0.0, 0.0]\n[[pin]]\nat = \"b:start\"\nposition = [10.0, 3.0]\n\
                [[relative]]\nat = \"b:40\"\nto = \"a:40\"\noffset = \"free\"\nfacing = 70.0\n";
    let mut editor = editor(text);
    let edit = editor.solve().expect("an answer");
    for character in &edit.characters {
        let length = cotillion::edit::energy::length;
        let ratio = length(&character.positions) / length(&character.rest.positions);
        assert!((ratio - 1.0).abs() < 0.02, "stretched by {ratio}");
    }
}

/// The stretches that one offset cannot follow are squeezed to 8e-6 m in the shape phase; their direction comes from points up to
/// 9 m away, rounded to 1e-15 m each, some ten of which add up: radians.
const SHRUNK_FACING: f64 = 1e-8;

const INTERVALS: &str = r#"
[[relative]]
name = "stay together"
during = ["bo/slap:start", "bo/slap:end"]
to = ["ann/slap:start", "ann/slap:end"]
offset = [0.9, -0.4]
facing = 180.0
strength = "hard"
[[sync]]
name = "in step"
intervals = [["ann/slap:start", "ann/slap:end"], ["bo/slap:start", "bo/slap:end"]]
strength = "hard"
"#;

#[test]
fn hard_intervals_hold_at_every_sample() {
    let mut editor = editor(&format!("{THREE}{INTERVALS}"));
    let edit = editor.solve().expect("people who stand can stand together").clone();
    let residuals = cotillion::residual::residuals(editor.scene(), &edit);
    for name in ["stay together", "in step", "slap"] {
        let residual = residuals[id(&editor, name).as_usize()];
        for miss in [residual.position, residual.seconds].into_iter().flatten() {
            assert!(miss < ROUNDING, "{name} misses by {miss:e}");
        }
        let facing = residual.facing.unwrap_or(0.0);
        assert!(facing < SHRUNK_FACING, "{name} misses by {facing:e} rad");
    }
    let released = edit.notes.iter().filter(|note| matches!(note, EditNote::Released { .. })).count();
    assert_eq!(released, 2, "both sway in their own way, which one offset cannot follow: {:?}", edit.notes);
}

#[test]
fn a_soft_interval_pulls_more_the_longer_it_is() {
    let pulled = |last: u32| {
        let text = format!(
            "[clips]\nwalk = {{ builtin = \"walk\", seconds = 6.0 }}\n[[character]]\nname = \"a\"\ntrack = [\"walk\"]\n\
             position = [0.0, 0.0]\nfacing = 0.0\n\
             [[pin]]\nat = \"a:start\"\nposition = [0.0, 0.0]\nstrength = \"hard\"\n\
             [[pin]]\nat = \"a:end\"\nposition = [7.0, 0.0]\nstrength = \"hard\"\n\
             [[pin]]\nduring = [\"a:90\", \"a:{last}\"]\nposition = [3.6, 1.0]\nstrength = 1e-7\n"
        );
        let mut editor = editor(&text);
        editor.solve().expect("an answer").characters[0].positions[90].im
    };
    let (short, long) = (pulled(91), pulled(110));
    assert!(short > 0.0 && long > 3.0 * short, "weights count frames: {short} and {long}");
}

#[test]
fn the_order_of_characters_permutes_the_result() {
    let block = |name: &str| {
        let start = THREE.find(&format!("[[character]]\nname = \"{name}\"")).expect("in the scene");
        let length = THREE[start + 2..].find("[[").map_or(THREE.len(), |end| end + 2);
        &THREE[start..start + length]
    };
    let (ann, bo, cy) = (block("ann"), block("bo"), block("cy"));
    let reordered = THREE.replace(&format!("{ann}{bo}{cy}"), &format!("{cy}{bo}{ann}"));
    assert_ne!(reordered, THREE);
    let (mut a, mut b) = (editor(THREE), editor(&reordered));
    let (a, b) = (a.solve().expect("an answer"), b.solve().expect("an answer"));
    for (own, other) in a.characters.iter().zip(b.characters.iter().rev()) {
        for (p, q) in own.positions.iter().zip(&other.positions) {
            assert!((p - q).norm() < ROUNDING, "order does not matter");
        }
        for (s, t) in own.times.iter().zip(&other.times) {
            assert!((s - t).abs() < ROUNDING);
        }
    }
}

#[test]
fn the_paper_mode_needs_no_bounds_and_refuses_time_that_runs_backwards() {
    let backwards =
        THREE.replace("seconds = 6.0", "seconds = 0.5").replace("[clips]", "mode = \"paper\"\n[clips]");
    let text = format!("{backwards}\n[[time]]\nat = \"ann:start\"\nseconds = 1.0\nstrength = \"hard\"\n");
    assert!(matches!(editor(&text).solve(), Err(EditError::BackwardTime { .. })));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    /// Two drags give the same result in either order, and the same as fresh solves at the final targets.
    #[test]
    fn drags_commute(x in 3.0..8.0_f64, y in -3.0..3.0_f64, seconds in 5.0..8.0_f64, facing in -1.0..1.0_f64) {
        let moves = [
            ("bo starts", Target::Position(c64::new(x, y))),
            ("when", Target::Seconds(seconds)),
            ("ann starts", Target::Facing(facing)),
        ];
        let mut results = Vec::new();
        for order in [[0, 1, 2], [2, 0, 1]] {
            let mut editor = editor(THREE);
            editor.solve().expect("the scene has an answer");
            for step in order {
                drag(&mut editor, moves[step].0, moves[step].1);
            }
            results.push(editor.edit().clone());
        }
        for (a, b) in results[0].characters.iter().zip(&results[1].characters) {
            for (p, q) in a.positions.iter().zip(&b.positions) {
                prop_assert!((p - q).norm() < 1e-10);
            }
            for (s, t) in a.times.iter().zip(&b.times) {
                prop_assert!((s - t).abs() < 1e-10);
            }
        }
    }

    /// The whole scene, targets and rest places alike, moved rigidly: the same result, moved.
    #[test]
    fn moving_everything_rigidly_moves_the_result(x in -5.0..5.0_f64, y in -5.0..5.0_f64, degrees in -180.0..180.0_f64) {
        let turn = cis(degrees.to_radians());
        let place = |p: c64| { let q = turn * p + c64::new(x, y); format!("[{:?}, {:?}]", q.re, q.im) };
        let moved = THREE
            .replace("track = [\"walk\", \"slap\"]\n[[character]]\nname = \"bo\"", &format!(
                "track = [\"walk\", \"slap\"]\nposition = {}\nfacing = {degrees:?}\n[[character]]\nname = \"bo\"",
                place(c64::default())))
            .replace("position = [6.0, 0.5]\nfacing = 170.0", &format!("position = {}\nfacing = {:?}", place(c64::new(6.0, 0.5)), 170.0 + degrees))
            .replace("position = [0.0, 9.0]", &format!("position = {}\nfacing = {:?}", place(c64::new(0.0, 9.0)), -90.0 + degrees))
            .replace("position = [0.0, 0.0]\nfacing = 0.0", &format!("position = {}\nfacing = {degrees:?}", place(c64::default())))
            .replace("position = [6.0, 0.0]", &format!("position = {}", place(c64::new(6.0, 0.0))))
            .replace("position = [1.0, 12.0]", &format!("position = {}", place(c64::new(1.0, 12.0))));
        let still = THREE
            .replace("track = [\"walk\", \"slap\"]\n[[character]]\nname = \"bo\"",
                "track = [\"walk\", \"slap\"]\nposition = [0.0, 0.0]\nfacing = 0.0\n[[character]]\nname = \"bo\"")
            .replace("position = [0.0, 9.0]", "position = [0.0, 9.0]\nfacing = -90.0");
        let (mut a, mut b) = (editor(&still), editor(&moved));
        let (a, b) = (a.solve().expect("an answer"), b.solve().expect("an answer"));
        for (still, moved) in a.characters.iter().zip(&b.characters) {
            for (p, q) in still.positions.iter().zip(&moved.positions) {
                prop_assert!((turn * p + c64::new(x, y) - q).norm() < 1e-8);
            }
        }
        prop_assert!((a.energy.total - b.energy.total).abs() < 1e-6 * (1.0 + a.energy.total));
    }
}
