//! Objects keep their promises: somebody or nobody has them at any time, they never jump, hands stay on them, and places
//! held relative to them are held where they are.

mod agree;
mod relay;

use cotillion::constraint::{ConstraintKind, Strength};
use cotillion::edit::{Edit, EditError, Editor, Moved, Target};
use cotillion::geometry::{c64, cis, plan_of, wrap};
use cotillion::index::{CharacterId, ConstraintId};
use cotillion::object::{Course, ObjectPose};
use cotillion::object_motion::{ObjectMotion, Owner, Performance, moment_time, object_motions};
use cotillion::reach::{Stage, carry_targets};
use cotillion::residual::residuals;
use cotillion::scene::Scene;
use cotillion::ties::Ties;
use proptest::prelude::*;
use relay::{RELAY, load, solved};

/// What the project promises of hand-overs, metres.
const CONTINUOUS: f64 = 1e-9;
/// Hard constraints hold to this, metres and radians.
const HARD: f64 = 1e-9;
/// Rounding of a few rigid motions of some metres.
const ROUNDING: f64 = 1e-12;

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
    let ties = Ties::of(&scene);
    let stage = Stage { scene: &scene, performance: &moved, objects: &objects, ties: &ties };
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
fn who_carries_a_box_cannot_help_with_another_meanwhile() {
    let text = format!(
        "{RELAY}
[[object]]
name = \"cup\"
size = [0.1, 0.1, 0.1]
position = [6.0, 4.0]
[[carry]]
name = \"third\"
object = \"cup\"
by = [\"ann\", \"bob\"]
during = [\"bob/walk:20\", \"bob/walk:100\"]
"
    );
    // Only times tell: ann has the box by her own moments, the cup by those of bob.
    let mut editor = Editor::new(load(&text).scene).expect("a regular scene");
    let before = editor.edit().clone();
    let error = editor.solve().expect_err("ann has two hands");
    match &error {
        EditError::HandsTaken { character, first, second, seconds } => {
            let names = [character, &first.name, &second.name].map(String::as_str);
            assert_eq!(names, ["ann", "first", "third"]);
            assert!(*seconds > 1.0 && second.line > first.line, "{error}");
        }
        other => panic!("{other}"),
    }
    assert_eq!(*editor.edit(), before, "the result of before stays");
    let alone = text.replace("by = [\"ann\", \"bob\"]", "by = [\"bob\"]");
    assert_ne!(alone, text);
    let (scene, edit) = solved(&alone);
    assert_sound(&scene, &edit);
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
