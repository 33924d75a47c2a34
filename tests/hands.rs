//! Hands stay on what they carry: in every output frame and at every constrained moment of a carry, however the path is
//! bent, for one carrier and for two. Hands meet, and reach bodies where these come to be.

mod fingers;

use std::fmt::Write;
use std::path::Path;

use cotillion::edit::{Editor, Moved};
use cotillion::embody::{Body, embody};
use cotillion::geometry::cis;
use cotillion::index::CharacterId;
use cotillion::object_motion::{Owner, Performance, object_motions};
use cotillion::reach::{REACHED, Stage, carry_residuals, effector_residuals};
use cotillion::resample::resample;
use cotillion::scene::{ClipFolders, Scene, load_text};
use cotillion::skeleton::JointRole;
use cotillion::ties::Ties;
use fingers::hand_points;
use glam::DVec3;
use proptest::prelude::*;

/// What the project promises of hands on a box, metres.
const ON_THE_BOX: f64 = 1e-3;

/// Ann picks up a box, carries it for some seconds and puts it down; a moment of the carry is between two output frames.
const ONE: &str = "
[clips]
pick_up = \"builtin:pick_up\"
carry = { builtin = \"carry\", take = 0, give = 0, width = 0.31, seconds = 12 }
put_down = \"builtin:put_down\"
[[character]]
name = \"ann\"
track = [\"pick_up\", \"carry\", \"put_down\"]
facing = 0.0
[[object]]
name = \"box\"
size = [0.3, 0.3, 0.35]
position = [0.6, 0.0]
[[carry]]
object = \"box\"
by = [\"ann\"]
during = [\"ann/pick_up:grasp\", \"ann/put_down:release\"]
[[relative]]
at = \"ann/pick_up:grasp\"
to = \"box\"
offset = [-0.58, 0.0]
facing = 0.0
strength = \"hard\"
[[time]]
at = \"ann/carry:100\"
seconds = 5.017
strength = \"hard\"
";

/// Ann and bob walk side by side, a bench between them.
const TWO: &str = "
[clips]
carry = { builtin = \"carry\", seconds = 10 }
[[character]]
name = \"ann\"
track = [\"carry\"]
facing = 0.0
[[character]]
name = \"bob\"
track = [\"carry\"]
position = [0.0, -1.0]
facing = 0.0
[[object]]
name = \"bench\"
size = [0.4, 0.3, 1.3]
height = 0.9
position = [0.4, -0.5]
[[carry]]
object = \"bench\"
by = [\"ann\", \"bob\"]
during = [\"ann/carry:grasp\", \"ann/carry:release\"]
[[sync]]
intervals = [[\"ann/carry:grasp\", \"ann/carry:release\"], [\"bob/carry:grasp\", \"bob/carry:release\"]]
strength = \"hard\"
[[relative]]
at = \"ann/carry:grasp\"
to = \"bench\"
offset = [-0.4, 0.5]
facing = 0.0
strength = \"hard\"
[[relative]]
during = [\"bob/carry:grasp\", \"bob/carry:release\"]
to = [\"ann/carry:grasp\", \"ann/carry:release\"]
offset = [0.0, -1.0]
facing = 0.0
strength = \"hard\"
[[time]]
at = \"ann/carry:100\"
seconds = 4.017
strength = \"hard\"
";

/// Largest distance of a hand from where it holds what it carries, or of its fingertips from where they first were on it,
/// on all samples of all carriers, metres.
fn largest_miss(scene: &Scene) -> f64 {
    let mut editor = Editor::new(scene.clone()).expect("a regular scene");
    let edit = editor.solve().expect("the constraints agree");
    let mut resampled = resample(scene, edit).expect("a result of usual length");
    let embodied = embody(scene, edit, &mut resampled);
    let moved = Moved { scene, characters: &edit.characters };
    let objects = object_motions(scene, &moved);
    let (mut worst, mut slip) = (0.0_f64, 0.0_f64);
    for (motion, span) in
        objects.iter().flat_map(|motion| motion.spans.iter().map(move |span| (motion, span)))
    {
        let Owner::Carried(hold) = &span.owner else { continue };
        for grip in &hold.grips {
            let Body { times, poses, .. } = &embodied.bodies[grip.character.as_usize()];
            let skeleton = &scene.characters[grip.character.as_usize()].track.clips[0].clip.skeleton;
            let own = times.iter().zip(poses).filter(|(time, _)| (span.from..=span.to).contains(*time));
            let mut held: Option<Vec<DVec3>> = None;
            for (time, pose) in own {
                let box_pose = motion.pose_at(scene, &moved, *time);
                let hand = hand_points(skeleton, pose, grip.joint);
                worst = worst.max(hand[0].distance(box_pose.apply(grip.point)));
                let on_box: Vec<DVec3> = hand.into_iter().map(|point| box_pose.local(point)).collect();
                assert!(on_box.len() > 1, "hands have an end");
                let slips = held.iter().flatten().zip(&on_box).map(|(held, now)| held.distance(*now));
                slip = slips.fold(slip, f64::max);
                held.get_or_insert(on_box);
            }
        }
    }
    let ties = Ties::of(scene);
    let stage = Stage { scene, performance: &moved, objects: &objects, ties: &ties };
    let told = carry_residuals(&stage, &embodied).into_iter().fold(0.0, f64::max);
    assert!(told >= worst - 1e-12 && told < worst + ON_THE_BOX, "{told} is told of {worst}");
    worst.max(slip)
}

fn load(text: &str) -> Scene {
    load_text(text, Path::new("hands.toml"), &ClipFolders::default()).expect("a sound scene").scene
}

/// Frames of ann's track that are pinned: all on her way.
const PINNED: [usize; 4] = [120, 165, 210, 255];

/// `text` with ann's way through [`PINNED`] laid in turns, radians, one after the other, and stretched.
fn bent(text: &str, turns: [f64; 4], stretch: f64) -> Scene {
    let rest = Editor::new(load(text)).expect("a regular scene").edit().characters[0].rest.positions.clone();
    let mut text = text.to_owned();
    let (mut place, mut heading, mut before) = (rest[PINNED[0] - 45], 0.0, rest[PINNED[0] - 45]);
    for (frame, turn) in PINNED.into_iter().zip(turns) {
        heading += turn;
        place += stretch * cis(heading) * (rest[frame] - before);
        before = rest[frame];
        let _ = write!(text, "[[pin]]\nat = \"ann:{frame}\"\nposition = [{:?}, {:?}]\n", place.re, place.im);
        text.push_str("strength = \"hard\"\n");
    }
    load(&text)
}

#[test]
fn hands_stay_on_a_box_however_its_carrier_is_bent() {
    for turns in [[0.0; 4], [1.2, 1.2, 1.2, 1.2], [1.5, -1.5, 1.5, -1.5], [0.0, 2.0, 0.0, -2.0]] {
        let miss = largest_miss(&bent(ONE, turns, 1.0));
        assert!(miss < ON_THE_BOX, "{turns:?}: {miss}");
    }
}

#[test]
fn hands_of_two_stay_on_what_they_carry_between_them_however_they_are_bent() {
    for turns in [[0.0; 4], [0.4, 0.4, 0.4, 0.4], [0.8, 0.8, 0.8, 0.8], [0.8, -0.8, 0.8, -0.8]] {
        let miss = largest_miss(&bent(TWO, turns, 1.0));
        assert!(miss < ON_THE_BOX, "{turns:?}: {miss}");
    }
}

/// Two people who come face to face, somewhat more than an arm apart, when they clap.
const FACE_TO_FACE: &str = "
[clips]
walk = { builtin = \"walk\", start = 1, stop = 1, seconds = 3, stature = STATURE }
clap = { builtin = \"slap\", stature = STATURE }
long_walk = { builtin = \"walk\", start = 1, stop = 1, seconds = 3, stature = 2.2 }
long_clap = { builtin = \"slap\", stature = 2.2 }
[[character]]
name = \"ann\"
track = [\"walk\", \"clap\"]
facing = 0.0
[[character]]
name = \"bob\"
track = [\"long_walk\", \"long_clap\"]
position = [6.0, 0.0]
facing = 180.0
[[time]]
at = \"ann/clap:hit\"
seconds = 4.017
strength = \"hard\"
[[sync]]
moments = [\"ann/clap:hit\", \"bob/long_clap:hit\"]
strength = \"hard\"
[[relative]]
at = \"bob/long_clap:hit\"
to = \"ann/clap:hit\"
offset = [DISTANCE, 0.0]
facing = 180.0
strength = \"hard\"
";

/// By how much each end effector of a scene is missed, metres, and the right hand of the first character at 4 s, half a frame before they
/// meet.
fn misses(text: &str) -> (Vec<f64>, DVec3) {
    let scene = load(text);
    let mut editor = Editor::new(scene.clone()).expect("a regular scene");
    let edit = editor.solve().expect("the constraints agree");
    let mut resampled = resample(&scene, edit).expect("a result of usual length");
    let embodied = embody(&scene, edit, &mut resampled);
    let moved = Moved { scene: &scene, characters: &edit.characters };
    let objects = object_motions(&scene, &moved);
    let ties = Ties::of(&scene);
    let stage = Stage { scene: &scene, performance: &moved, objects: &objects, ties: &ties };
    let ann = CharacterId(0);
    let skeleton = &scene.characters[0].track.clips[0].clip.skeleton;
    let hand = skeleton.joint_of(JointRole::RightHand).expect("generated bodies have hands");
    let pose = embodied.pose(ann, embodied.frame(ann, 4.0));
    let hand = skeleton.forward_kinematics(&pose)[hand.as_usize()].position;
    (effector_residuals(&stage, &embodied).into_iter().map(|miss| miss.metres).collect(), hand)
}

fn face_to_face(stature: f64, distance: f64) -> String {
    FACE_TO_FACE.replace("STATURE", &stature.to_string()).replace("DISTANCE", &distance.to_string())
}

/// Two people who stand face to face with their arms hanging, and take each other by the hand.
const HAND_IN_HAND: &str = "
[clips]
idle = { builtin = \"idle\", seconds = 4 }
[[character]]
name = \"ann\"
track = [\"idle\"]
facing = 0.0
[[character]]
name = \"bob\"
track = [\"idle\"]
position = [0.8, 0.0]
facing = 180.0
[[end_effector]]
during = [\"ann:40\", \"ann:80\"]
joint = \"right_hand\"
target = { character = \"bob\", joint = \"left_hand\" }
";

#[test]
fn hands_that_hang_out_of_each_others_reach_are_raised_and_nobody_squats() {
    /// What arms that are nearly straight leave to the body, metres.
    const STILL: f64 = 0.01;
    for distance in ["0.6", "0.8", "0.95"] {
        let text = HAND_IN_HAND.replace("0.8", distance);
        let (miss, _) = misses(&text);
        assert!(miss[0] < REACHED, "{distance} m apart: {}", miss[0]);
        let scene = load(&text);
        let mut editor = Editor::new(scene.clone()).expect("a regular scene");
        let edit = editor.solve().expect("nothing is constrained");
        let mut resampled = resample(&scene, edit).expect("a result of usual length");
        for body in embody(&scene, edit, &mut resampled).bodies {
            let shift = body.report.root_shift;
            assert!(shift < STILL, "{distance} m apart, {shift} m pulled");
        }
    }
}

#[test]
fn where_a_short_arm_does_not_reach_the_middle_the_longer_one_comes_to_it() {
    for (joint, at) in [("right_hand", ", at = \"bob/long_clap:hit\""), ("right_hand", "")] {
        let target = format!("{{ character = \"bob\", joint = \"{joint}\"{at} }}");
        let meet =
            format!("[[end_effector]]\nat = \"ann/clap:hit\"\njoint = \"right_hand\"\ntarget = {target}\n");
        let (miss, _) = misses(&(face_to_face(1.2, 0.95) + &meet));
        assert!(miss[0] < REACHED, "{at}: {}", miss[0]);
        let (miss, _) = misses(&(face_to_face(1.2, 3.5) + &meet));
        assert!(miss[0] > 0.3, "what no arm spans is missed: {}", miss[0]);
    }
}

#[test]
fn bodies_are_reached_where_they_come_to_be() {
    let low = "[[end_effector]]\nat = \"bob/long_clap:hit\"\njoint = \"left_hand\"
        target = { character = \"ann\", joint = \"left_hip\", at = \"ann/clap:hit\" }\n";
    let chest = "[[end_effector]]\nat = \"ann/clap:hit\"\njoint = \"right_hand\"
        target = { character = \"bob\", joint = \"chest\", point = [0.0, 0.1, 0.15], at = \"bob/long_clap:hit\" }\n";
    let scene = face_to_face(1.75, 0.55);
    // Bob stoops to ann's hip, and she reaches for his chest: either order of the file, and both know each other.
    for ends in [[low, chest], [chest, low]] {
        let (miss, _) = misses(&(scene.clone() + &ends.concat()));
        assert!(miss.iter().all(|miss| *miss < REACHED), "{miss:?}");
    }
    // Who reaches nobody waits for nobody.
    let (_, alone) = misses(&scene);
    let (_, reached) = misses(&(scene.clone() + low));
    assert!(alone.distance(reached) < 1e-9, "ann is reached and stays as she was");
    let (_, reaching) = misses(&(scene.clone() + chest));
    assert!(alone.distance(reaching) > 0.01, "who reaches does not: {}", alone.distance(reaching));
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(16) })]

    #[test]
    fn hands_stay_on_a_box_wherever_its_carrier_is_pinned(
        turns in prop::array::uniform4(-1.5..1.5_f64),
        stretch in 0.7..1.3_f64,
    ) {
        let miss = largest_miss(&bent(ONE, turns, stretch));
        prop_assert!(miss < ON_THE_BOX, "{miss}");
    }

    #[test]
    fn hands_of_two_stay_on_a_bench_wherever_the_first_is_pinned(
        turns in prop::array::uniform4(-0.8..0.8_f64),
        stretch in 0.7..1.3_f64,
    ) {
        let miss = largest_miss(&bent(TWO, turns, stretch));
        prop_assert!(miss < ON_THE_BOX, "{miss}");
    }
}
