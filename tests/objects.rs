//! Objects keep their promises: somebody or nobody has them at any time, they never jump, hands stay on them, and places
//! held relative to them are held where they are.

mod agree;

use std::path::Path;

use cotillion::constraint::{ConstraintKind, Strength, When};
use cotillion::discrete::outcome::Outcome;
use cotillion::edit::{Edit, EditError, Editor, Moved, Target};
use cotillion::embody::embody;
use cotillion::export::bvh::BvhOptions;
use cotillion::export::report::report;
use cotillion::export::scene::scene_files;
use cotillion::geometry::{c64, cis, plan_of, wrap};
use cotillion::index::{CharacterId, ConstraintId};
use cotillion::object::{Course, ObjectPose};
use cotillion::object_motion::{ObjectMotion, Owner, Performance, moment_time, object_motions};
use cotillion::reach::{
    JointTarget, Source, Stage, carry_targets, constrained_times, effector_residuals, effector_targets,
};
use cotillion::resample::resample;
use cotillion::residual::residuals;
use cotillion::scene::{ClipFolders, Loaded, Scene, load_text};
use proptest::prelude::*;
use serde_json::Value;

/// What the project promises of hand-overs, metres.
const CONTINUOUS: f64 = 1e-9;
/// Hard constraints hold to this, metres and radians.
const HARD: f64 = 1e-9;
/// Rounding of a few rigid motions of some metres.
const ROUNDING: f64 = 1e-12;
/// Hands are turned exactly, degrees; near 0 the angle of a rotation has half the digits.
const TURNED: f64 = 1e-5;

/// Ann carries a box to bob, who carries it on; a cart drives by.
const RELAY: &str = r#"
[clips]
pick_up = "builtin:pick_up"
carry = { builtin = "carry", take = 0, give = 0, width = 0.31, seconds = 5 }
hand_over = "builtin:hand_over"
walk = { builtin = "walk", start = 1, stop = 1, seconds = 5 }
take_over = "builtin:take_over"
put_down = "builtin:put_down"
idle = "builtin:idle"
[[character]]
name = "ann"
track = ["pick_up", "carry", "hand_over", "walk"]
[[character]]
name = "bob"
track = ["walk", "take_over", "carry", "put_down", "idle"]
position = [6.0, 4.0]
facing = -90.0
[[object]]
name = "box"
size = [0.3, 0.3, 0.35]
position = [0.6, 0.0]
[[object]]
name = "cart"
size = [1.0, 0.6, 0.6]
keys = [{ seconds = 2, position = [9, 9] }, { seconds = 12, position = [4, 9], facing = 90 }]
[[carry]]
name = "first"
object = "box"
by = ["ann"]
during = ["ann/pick_up:grasp", "ann/hand_over:release"]
[[carry]]
name = "second"
object = "box"
by = ["bob"]
during = ["bob/take_over:grasp", "bob/put_down:release"]
[[relative]]
name = "grasp"
at = "ann/pick_up:grasp"
to = "box"
offset = [-0.58, 0.0]
facing = 0.0
strength = "hard"
[[relative]]
name = "meet"
at = "bob/take_over:grasp"
to = "box"
offset = [0.58, 0.0]
facing = 180.0
strength = "hard"
[[pin]]
name = "there"
at = "ann/hand_over:release"
position = [3.2, 1.6]
facing = 60.0
[[pin]]
name = "mark"
at = "bob/put_down:release"
position = [5.5, 0.5]
strength = "hard"
[[time]]
name = "begin"
at = "ann:start"
seconds = 0.0
strength = "hard"
[[sync]]
name = "together"
moments = ["bob/take_over:grasp", "ann/hand_over:release"]
strength = "hard"
"#;

fn load(text: &str) -> Loaded {
    load_text(text, Path::new("objects.toml"), &ClipFolders::default()).expect("a sound scene")
}

fn solved(text: &str) -> (Scene, Edit) {
    let mut editor = Editor::new(load(text).scene).expect("a regular scene");
    let edit = editor.solve().expect("the constraints agree").clone();
    (editor.scene().clone(), edit)
}

fn id(scene: &Scene, name: &str) -> ConstraintId {
    let place = scene.constraints.iter().position(|constraint| constraint.name == name);
    ConstraintId::from_usize(place.expect("the scene has this constraint"))
}

fn apart(a: ObjectPose, b: ObjectPose) -> f64 {
    a.position.distance(b.position).max(wrap(a.facing - b.facing).abs())
}

/// Largest jump of an object where its owner changes.
fn largest_jump(moved: &Moved<'_>, motion: &ObjectMotion) -> f64 {
    let jump = |time: f64| {
        let [before, after] =
            [time.next_down(), time.next_up()].map(|time| motion.pose_at(moved.scene, moved, time));
        apart(before, after)
    };
    motion.spans[1..].iter().map(|span| jump(span.from)).fold(0.0, f64::max)
}

fn assert_sound(scene: &Scene, edit: &Edit) {
    let moved = Moved { scene, characters: &edit.characters };
    for motion in object_motions(scene, &moved) {
        assert_eq!(motion.spans[0].from, f64::NEG_INFINITY);
        assert_eq!(motion.spans.last().map(|span| span.to), Some(f64::INFINITY));
        assert!(motion.spans.windows(2).all(|pair| pair[0].to == pair[1].from), "no gap, no overlap");
        let jump = largest_jump(&moved, &motion);
        assert!(jump < CONTINUOUS, "{jump:e}");
    }
    for (constraint, residual) in scene.constraints.iter().zip(residuals(scene, edit)) {
        let hard = constraint.strength == Strength::Hard;
        for miss in [residual.position, residual.facing, residual.seconds].into_iter().flatten() {
            assert!(!hard || miss < HARD, "{} misses by {miss:e}", constraint.name);
        }
    }
}

/// Poses of the box ten times a second.
fn way(scene: &Scene, edit: &Edit) -> Vec<ObjectPose> {
    let moved = Moved { scene, characters: &edit.characters };
    let motion = &object_motions(scene, &moved)[0];
    (0..240).map(|k| motion.pose_at(scene, &moved, f64::from(k) * 0.1)).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// Wherever the meeting and the mark are dragged, the box does not jump, and a drag does not depend on its way.
    #[test]
    fn a_box_that_is_handed_over_never_jumps(
        there in [2.0..4.5_f64, -3.0..3.0],
        mark in [3.0..8.0_f64, -3.0..6.0],
        turn in -3.0..3.0_f64,
        close in 0.3..0.9_f64,
    ) {
        let mut editor = Editor::new(load(RELAY).scene).expect("a regular scene");
        editor.solve().expect("the constraints agree");
        let targets = [
            ("there", Target::Position(c64::new(there[0], there[1]))),
            ("there", Target::Facing(turn)),
            ("mark", Target::Position(c64::new(mark[0], mark[1]))),
            ("meet", Target::Offset(c64::new(close, 0.1))),
        ];
        for (name, target) in targets {
            let id = id(editor.scene(), name);
            editor.move_target(id, target).expect("the constraint has such a target");
            editor.solve().expect("the constraints agree");
        }
        assert_sound(editor.scene(), editor.edit());
        let mut fresh = Editor::new(editor.scene().clone()).expect("a regular scene");
        let fresh = fresh.solve().expect("the constraints agree");
        for (a, b) in way(editor.scene(), editor.edit()).into_iter().zip(way(editor.scene(), fresh)) {
            prop_assert!(apart(a, b) < HARD);
        }
        agree::both_backends(editor.scene()).map_err(TestCaseError::fail)?;
    }

    /// Bent, turned or stretched, a carried box keeps its place between the hands.
    #[test]
    fn what_is_carried_is_rigid_to_the_hands(there in [2.0..5.0_f64, -3.0..3.0]) {
        let text = RELAY.replace("position = [3.2, 1.6]", &format!("position = [{}, {}]", there[0], there[1]));
        let (scene, edit) = solved(&text);
        let moved = Moved { scene: &scene, characters: &edit.characters };
        let motions = object_motions(&scene, &moved);
        for span in &motions[0].spans {
            let Owner::Carried(hold) = &span.owner else { continue };
            let middles: Vec<_> = (0..=100)
                .map(|k| {
                    let time = span.from + f64::from(k) / 100.0 * (span.to - span.from);
                    let frames = hold.grips.iter().map(|grip| {
                        let skeleton = &scene.characters[grip.character.as_usize()].track.clips[0].clip.skeleton;
                        let pose = moved.pose(grip.character, moved.frame(grip.character, time));
                        skeleton.forward_kinematics(&pose)[grip.joint.as_usize()].position
                    });
                    let hands: Vec<_> = frames.collect();
                    motions[0].pose_at(&scene, &moved, time).local(hands[0].midpoint(hands[1]))
                })
                .collect();
            let widest = middles.iter().map(|middle| middle.distance(middles[0])).fold(0.0, f64::max);
            prop_assert!(widest < ROUNDING, "{widest:e}");
        }
    }
}

#[test]
fn a_scene_is_the_same_wherever_it_lies() {
    /// Soft pins and what follows from them are solved to this, metres and radians.
    const SOLVED: f64 = 1e-7;
    let moved = |point: c64| cis(0.7) * point + c64::new(3.0, -2.0);
    let (scene, edit) = solved(RELAY);
    let mut other = scene.clone();
    for constraint in &mut other.constraints {
        if let ConstraintKind::Pin { position, facing, .. } = &mut constraint.kind {
            *position = position.map(moved);
            *facing = facing.map(|facing| facing + 0.7);
        }
    }
    other.objects[0].course = Course::Still(ObjectPose::on_ground(moved(c64::new(0.6, 0.0)), 0.7));
    let mut editor = Editor::new(other.clone()).expect("a regular scene");
    let there = editor.solve().expect("the constraints agree");
    for (here, there) in way(&scene, &edit).into_iter().zip(way(&other, there)) {
        assert!((moved(here.plan()) - there.plan()).norm() < SOLVED);
        assert!(wrap(here.facing + 0.7 - there.facing).abs() < SOLVED);
    }
}

#[test]
fn owners_follow_each_other_as_the_carries_say() {
    let (scene, edit) = solved(RELAY);
    assert_sound(&scene, &edit);
    let moved = Moved { scene: &scene, characters: &edit.characters };
    let motion = &object_motions(&scene, &moved)[0];
    let told: Vec<String> = motion
        .spans
        .iter()
        .map(|span| match &span.owner {
            Owner::Itself => "itself".to_owned(),
            Owner::Carried(hold) => scene.carries[hold.carry].name.clone(),
            Owner::Left { carry, .. } => format!("left by {}", scene.carries[*carry].name),
        })
        .collect();
    // Ann lets go in the very moment bob grasps: in between the box is left for no time.
    assert_eq!(told, ["itself", "first", "second", "left by second"]);
    let time = |moment| moment_time(&scene, &moved, moment);
    assert_eq!(motion.spans[1].from, time(&scene.carries[0].during.0));
    assert_eq!(motion.spans[3].from, time(&scene.carries[1].during.1));
    let put = motion.pose_at(&scene, &moved, 1e3);
    assert!(put.position.y.abs() < 1e-3, "put_down is pick_up backwards: {}", put.position.y);
}

#[test]
fn who_carries_comes_to_whom_the_box_is_for() {
    let pinned = "at = \"bob/take_over:grasp\"\nposition = [2.0, 3.5]\nstrength = \"hard\"\n";
    let text =
        RELAY.replace("at = \"ann/hand_over:release\"\nposition = [3.2, 1.6]\nfacing = 60.0\n", pinned);
    assert_ne!(text, RELAY);
    let (scene, edit) = solved(&text);
    assert_sound(&scene, &edit);
    let release = scene.frame_of(&scene.carries[0].during.1);
    let ann = edit.characters[0].pose(&scene.characters[0].track, release);
    let apart = (plan_of(ann.root) - c64::new(2.0, 3.5)).norm();
    assert!((1.0..1.3).contains(&apart), "at arm's length on either side of the box: {apart}");
    agree::both_backends(&scene).expect("the backends agree");
}

#[test]
fn hands_hold_the_box_where_they_grasped_it() {
    let (scene, edit) = solved(RELAY);
    let moved = Moved { scene: &scene, characters: &edit.characters };
    let objects = object_motions(&scene, &moved);
    let stage = Stage { scene: &scene, performance: &moved, objects: &objects };
    let ann = CharacterId(0);
    let mut samples: Vec<f64> = (0..600).map(|k| f64::from(k) / 30.0).collect();
    samples.extend(constrained_times(&scene, &moved, ann));
    samples.sort_by(f64::total_cmp);
    let targets = carry_targets(&stage, ann, &samples);
    assert_eq!(targets.iter().map(|target| target.source).collect::<Vec<_>>(), [Source::Carry(0); 2]);
    let span = &objects[0].spans[1];
    for JointTarget { samples: range, positions, .. } in &targets {
        assert_eq!(
            (samples[range.start], samples[range.end - 1]),
            (span.from, span.to),
            "moments are samples"
        );
        let on_box = |k: usize| {
            let pose = objects[0].pose_at(&scene, &moved, samples[range.start + k]);
            pose.local(positions[k])
        };
        for k in 0..positions.len() {
            assert!(on_box(k).distance(on_box(0)) < ROUNDING);
        }
        assert!((on_box(0).z.abs() - 0.175).abs() < 1e-3, "on its sides: {}", on_box(0));
    }
}

#[test]
fn a_hand_far_from_the_box_reaches_for_its_surface() {
    let text = RELAY.replace("offset = [-0.58, 0.0]", "offset = [-1.6, 0.0]");
    let (scene, edit) = solved(&text);
    let moved = Moved { scene: &scene, characters: &edit.characters };
    let objects = object_motions(&scene, &moved);
    let Owner::Carried(hold) = &objects[0].spans[1].owner else { panic!("ann carries") };
    for grip in &hold.grips {
        assert!((grip.point.x - (-0.15)).abs() < 0.1 + ROUNDING, "a palm from its back: {}", grip.point);
    }
}

#[test]
fn a_place_beside_a_cart_is_where_the_cart_is_at_that_time() {
    let text = format!(
        "{RELAY}
[[relative]]
name = \"beside\"
at = \"ann:end\"
to = \"cart\"
offset = [0.0, 1.0]
facing = 0.0
strength = \"hard\"
[[time]]
name = \"then\"
at = \"ann:end\"
seconds = 18.0
strength = \"hard\"
"
    );
    let mut editor = Editor::new(load(&text).scene).expect("a regular scene");
    for seconds in [18.0, 16.0, 18.0] {
        let late = id(editor.scene(), "then");
        editor.move_target(late, Target::Seconds(seconds)).expect("a time");
        editor.solve().expect("the constraints agree");
        assert_sound(editor.scene(), editor.edit());
        let ann = &editor.edit().characters[0];
        let end = ann.pose_at(&editor.scene().characters[0].track, seconds);
        // After its last key the cart stands at (4, 9), facing +y of the plan: its left is −x.
        assert!((plan_of(end.root) - c64::new(3.0, 9.0)).norm() < HARD);
    }
    let late = id(editor.scene(), "then");
    // Ann comes while the cart still moves: it is at (9 − s/2, 9), turned by 9° a second, s seconds after 2 s.
    let text = text.replace("{ seconds = 12,", "{ seconds = 32,");
    let mut editor = Editor::new(load(&text).scene).expect("a regular scene");
    for seconds in [17.0, 19.0] {
        editor.move_target(late, Target::Seconds(seconds)).expect("a time");
        let edit = editor.solve().expect("the constraints agree");
        let s = (seconds - 2.0) / 30.0;
        let cart = c64::new(9.0 - 5.0 * s, 9.0);
        let expected = cart + cis((90.0 * s).to_radians()) * c64::new(0.0, 1.0);
        let found = edit.characters[0].positions.last().expect("a path has points");
        assert!((found - expected).norm() < HARD, "{found} or {expected}");
        assert_sound(editor.scene(), editor.edit());
    }
    agree::both_backends(editor.scene()).expect("the backends agree");
}

#[test]
fn an_unconstrained_cart_scene_stays_at_rest() {
    let text = "
[clips]
walk = \"builtin:walk\"
[[character]]
name = \"ann\"
track = [\"walk\"]
[[object]]
name = \"cart\"
size = [1, 1, 1]
keys = [{ seconds = 0, position = [0, 1] }, { seconds = 3, position = [3, 1] }]
[[relative]]
during = [\"ann:start\", \"ann:end\"]
to = \"cart\"
facing = \"rest\"
";
    let (_, edit) = solved(text);
    let ann = &edit.characters[0];
    for (rest, edited) in ann.rest.positions.iter().zip(&ann.positions) {
        assert!((rest - edited).norm() < 1e-9, "what was so before the edit costs nothing");
    }
}

#[test]
fn who_put_a_box_down_can_come_back_to_it() {
    let text = "
[clips]
pick_up = \"builtin:pick_up\"
put_down = \"builtin:put_down\"
walk = { builtin = \"walk\", start = 1, stop = 1, seconds = 5 }
[[character]]
name = \"ann\"
track = [\"pick_up\", \"put_down\", \"walk\"]
[[object]]
name = \"box\"
size = [0.3, 0.3, 0.35]
position = [0.6, 0.0]
[[carry]]
object = \"box\"
by = [\"ann\"]
during = [\"ann/pick_up:grasp\", \"ann/put_down:release\"]
[[pin]]
at = \"ann:start\"
position = [0.0, 0.0]
facing = 0.0
strength = \"hard\"
[[relative]]
at = \"ann:end\"
to = \"box\"
offset = [0.0, 2.5]
strength = \"hard\"
";
    let (scene, edit) = solved(text);
    assert_sound(&scene, &edit);
    agree::both_backends(&scene).expect("the backends agree");
}

#[test]
fn two_carry_one_box_between_them() {
    let text = "
[clips]
carry = \"builtin:carry\"
[[character]]
name = \"ann\"
track = [\"carry\"]
[[character]]
name = \"bob\"
track = [\"carry\"]
position = [1.4, 0.0]
facing = 180
[[object]]
name = \"sofa\"
size = [1.0, 0.5, 0.6]
height = 0.9
position = [0.7, 0.0]
[[carry]]
object = \"sofa\"
by = [\"ann\", \"bob\"]
during = [\"ann/carry:grasp\", \"ann/carry:release\"]
[[sync]]
moments = [\"ann/carry:grasp\", \"bob/carry:grasp\"]
strength = \"hard\"
[[pin]]
at = \"ann:end\"
position = [3.0, 2.0]
[[relative]]
during = [\"bob/carry:grasp\", \"bob/carry:release\"]
to = [\"ann/carry:grasp\", \"ann/carry:release\"]
offset = [1.4, 0.0]
facing = 180.0
";
    let (scene, edit) = solved(text);
    assert_sound(&scene, &edit);
    let moved = Moved { scene: &scene, characters: &edit.characters };
    let objects = object_motions(&scene, &moved);
    let Owner::Carried(hold) = &objects[0].spans[1].owner else { panic!("both carry") };
    assert_eq!(hold.grips.len(), 4);
    assert!(hold.by_hands);
    let stage = Stage { scene: &scene, performance: &moved, objects: &objects };
    let samples: Vec<f64> = (0..200).map(|k| f64::from(k) / 30.0).collect();
    for who in [CharacterId(0), CharacterId(1)] {
        assert_eq!(carry_targets(&stage, who, &samples).len(), 2);
    }
}

#[test]
fn carries_that_overlap_in_time_are_named() {
    let text = RELAY.replace("strength = \"hard\"\n\"#", "").replace(
        "moments = [\"bob/take_over:grasp\", \"ann/hand_over:release\"]",
        "moments = [\"bob/take_over:grasp\", \"ann/hand_over:release\"]\noffset = -0.5",
    );
    let mut editor = Editor::new(load(&text).scene).expect("a regular scene");
    let before = editor.edit().clone();
    let error = editor.solve().expect_err("bob grasps what ann still has").to_string();
    assert!(error.contains("\"first\"") && error.contains("\"second\""), "{error}");
    assert!(error.contains("0.500000 s"), "{error}");
    assert_eq!(*editor.edit(), before, "the result of before stays");
    let together = id(editor.scene(), "together");
    editor.move_target(together, Target::Seconds(0.0)).expect("an offset");
    editor.solve().expect("now she has let go");
    assert_sound(editor.scene(), editor.edit());
    editor.move_target(together, Target::Seconds(1.5)).expect("an offset");
    editor.solve().expect("the box stays in the air for a while");
    assert_sound(editor.scene(), editor.edit());
}

#[test]
fn nobody_is_held_relative_to_their_own_load() {
    let text = format!(
        "{RELAY}\n[[relative]]\nname = \"odd\"\nat = \"ann/carry:start\"\nto = \"box\"\noffset = [-1.0, 0.0]\n"
    );
    let mut editor = Editor::new(load(&text).scene).expect("a regular scene");
    match editor.solve() {
        Err(EditError::OwnLoad { constraint, carry }) => {
            assert_eq!((constraint.name.as_str(), carry.name.as_str()), ("odd", "first"));
        }
        other => panic!("{:?}", other.map(|_| ())),
    }
}

const SLAP: &str = r#"
[clips]
slap = "builtin:slap"
[[character]]
name = "ann"
track = ["slap"]
[[character]]
name = "bob"
track = ["slap"]
position = [1.2, -0.4]
facing = 180
[[object]]
name = "table"
size = [0.5, 0.8, 0.5]
position = [0.0, 0.6]
[[relative]]
at = "bob:hit"
to = "ann:hit"
[[sync]]
moments = ["ann:hit", "bob:hit"]
strength = "hard"
[[end_effector]]
at = "ann:hit"
joint = "right_hand"
orientation = "rest"
target = { character = "bob", joint = "right_hand", at = "bob:hit" }
[[end_effector]]
during = ["ann:start", "ann:end"]
joint = "left_hand"
orientation = [0, 90, 0]
target = { object = "table", point = [0.0, 0.8, 0.1] }
"#;

#[test]
fn hands_that_meet_do_so_in_the_middle() {
    let (scene, edit) = solved(SLAP);
    let moved = Moved { scene: &scene, characters: &edit.characters };
    let objects = object_motions(&scene, &moved);
    let stage = Stage { scene: &scene, performance: &moved, objects: &objects };
    let targets = [CharacterId(0), CharacterId(1)].map(|who| {
        let samples = constrained_times(&scene, &moved, who);
        effector_targets(&stage, who, &samples)
    });
    assert_eq!((targets[0].len(), targets[1].len()), (2, 1));
    let (ann, bob) = (&targets[0][0], &targets[1][0]);
    assert!(ann.positions[0].distance(bob.positions[0]) < ROUNDING, "one place for both");
    let mut hands = scene.end_effectors[0].when.moments().into_iter().map(|hit| {
        let time = moment_time(&scene, &moved, hit);
        [CharacterId(0), CharacterId(1)].map(|who| {
            let skeleton = &scene.characters[who.as_usize()].track.clips[0].clip.skeleton;
            let pose = moved.pose(who, moved.frame(who, time));
            skeleton.forward_kinematics(&pose)[scene.end_effectors[0].joint.as_usize()].position
        })
    });
    let [own, theirs] = hands.next().expect("one moment");
    assert!(ann.positions[0].distance(own.midpoint(theirs)) < ROUNDING);
    let missed = effector_residuals(&stage, &moved);
    assert!((missed[0].metres - own.distance(theirs)).abs() < ROUNDING);
    assert_eq!(ann.rotations.len(), 1);
    assert!(bob.rotations.is_empty());
}

#[test]
fn a_hand_on_a_table_stays_there_and_is_turned_as_asked() {
    let (scene, edit) = solved(SLAP);
    assert!(matches!(scene.end_effectors[1].when, When::During(..)));
    let moved = Moved { scene: &scene, characters: &edit.characters };
    let objects = object_motions(&scene, &moved);
    let stage = Stage { scene: &scene, performance: &moved, objects: &objects };
    let samples: Vec<f64> = (0..60).map(|k| f64::from(k) / 30.0).collect();
    let targets = effector_targets(&stage, CharacterId(0), &samples);
    let table = targets.iter().find(|target| target.source == Source::EndEffector(1)).expect("a target");
    assert!(table.samples.len() > 30 && table.positions.len() == table.samples.len());
    // Its right is +z of the world.
    assert!(table.positions.iter().all(|p| p.distance(glam::DVec3::new(0.0, 0.8, -0.5)) < ROUNDING));
    let turned = table.rotations[0] * glam::DVec3::X;
    assert!(turned.distance(glam::DVec3::NEG_Z) < ROUNDING, "a quarter turn about up: {turned}");
}

#[test]
fn reports_tell_who_has_what_and_what_is_not_reached() {
    let told = |text: &str| {
        let (scene, edit) = solved(text);
        let mut resampled = resample(&scene, &edit).expect("a result of usual length");
        let embodied = embody(&scene, &edit, &mut resampled);
        let files = scene_files(&scene, &edit, &resampled, &BvhOptions::default());
        let svg = files.iter().find(|file| file.name == "scene.svg").expect("a picture");
        let svg = String::from_utf8(svg.bytes.clone()).expect("text");
        (
            serde_json::to_value(report(
                &embodied,
                &Outcome::plain((scene.clone(), edit.clone())),
                &resampled,
            ))
            .expect("JSON"),
            svg,
        )
    };
    let (relay, svg) = told(RELAY);
    for meaning in ["way of an object", "grasped", "released"] {
        assert!(svg.contains(meaning), "{meaning}");
    }
    let objects = relay["objects"].as_array().expect("objects");
    let owners = objects[0]["owners"].as_array().expect("owners");
    let kinds: Vec<&str> = owners.iter().filter_map(|owner| owner["kind"].as_str()).collect();
    assert_eq!(kinds, ["itself", "carried", "carried", "left"]);
    assert_eq!(owners[1]["by"], serde_json::json!(["ann"]));
    assert!(owners.windows(2).all(|pair| pair[0]["to"] == pair[1]["from"]));
    assert_eq!(owners[0]["from"], relay["start_time"]);
    let carry = relay["constraints"].as_array().and_then(|all| all.iter().find(|one| one["name"] == "first"));
    let off = carry.and_then(|carry| carry["residual"].as_f64()).expect("hands are measured");
    assert!(off < 0.05, "clips of boxes of one width hold them so far apart: {off}");
    let path = objects[0]["path"].as_array().expect("a path");
    assert_eq!(path[path.len() - 1]["time"], owners[3]["to"]);
    let straight = c64::new(0.6, 0.0) - c64::new(5.5, 0.5);
    let length = objects[0]["path_length"].as_f64().expect("metres");
    assert!(length > straight.norm() - 1.0 && length < 3.0 * straight.norm(), "{length}");
    assert_eq!(objects[1]["owners"].as_array().map(Vec::len), Some(1), "the cart is by itself");

    let (slap, _) = told(SLAP);
    assert_eq!(slap["objects"][0]["path"].as_array().map(Vec::len), Some(1), "the table stands");
    let constraints = slap["constraints"].as_array().expect("constraints");
    let reach = &constraints[constraints.len() - 1];
    assert_eq!((&reach["kind"], &reach["unit"]), (&"end_effector".into(), &"m".into()));
    assert!(reach["residual"].as_f64() < Some(1e-3) && reach.get("shortfall").is_none(), "{reach}");
    let turned = |reach: &Value| reach["orientation_residual"].as_f64().expect("how far it is turned off");
    let slap_hand = &constraints[constraints.len() - 2];
    assert!(turned(reach) < TURNED && turned(slap_hand) < TURNED, "{reach} {slap_hand}");
    let (off, _) = told(&format!("{SLAP}[full_body]\nenabled = false\n"));
    let constraints_off = off["constraints"].as_array().expect("constraints");
    let missed = &constraints_off[constraints_off.len() - 1];
    assert!(missed["shortfall"].as_f64() > Some(0.1), "nobody moves the hand: {missed}");
    assert_eq!(missed["shortfall"], missed["residual"]);
    assert!(turned(missed) > 30.0, "hands hang down, this one must lie across: {missed}");
    assert!(reach.get("strength").is_none());
    let names: Vec<&Value> = slap["moments"].as_array().into_iter().flatten().map(|m| &m["name"]).collect();
    assert!(names.contains(&&Value::from("ann:start")), "moments of reaches are told: {names:?}");
}

#[test]
fn reaches_and_hand_overs_that_nothing_ties_are_warned_of() {
    let warned = |text: &str| -> Vec<String> {
        load(text).warnings.into_iter().map(|warning| warning.message).collect()
    };
    assert_eq!(warned(RELAY), [""; 0]);
    assert_eq!(warned(SLAP), [""; 0]);
    let untied = RELAY.replace("[[sync]]\nname = \"together\"", "[[sync]]\nname = \"other\"").replace(
        "moments = [\"bob/take_over:grasp\", \"ann/hand_over:release\"]",
        "moments = [\"bob:start\", \"ann:start\"]",
    );
    let messages = warned(&untied);
    assert!(messages.iter().any(|message| message.contains("nothing ties the time")), "{messages:?}");
    let lonely = SLAP.replace("[[relative]]\nat = \"bob:hit\"\nto = \"ann:hit\"\n", "");
    let messages = warned(&lonely);
    assert_eq!(messages.len(), 2, "{messages:?}");
    assert!(messages.iter().all(|message| message.contains("nothing brings the body near")), "{messages:?}");
    let alone = SLAP.replace("[[sync]]\nmoments = [\"ann:hit\", \"bob:hit\"]\nstrength = \"hard\"\n", "");
    let messages = warned(&alone);
    assert!(messages.iter().any(|message| message.contains("happen together")), "{messages:?}");
}
