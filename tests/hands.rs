//! Hands stay on what they carry: in every output frame and at every constrained moment of a carry, however the path is
//! bent, for one carrier and for two.

use std::fmt::Write;
use std::path::Path;

use cotillion::edit::{Editor, Moved};
use cotillion::embody::{Body, embody};
use cotillion::geometry::cis;
use cotillion::object_motion::{Owner, object_motions};
use cotillion::reach::{Stage, carry_residuals};
use cotillion::resample::resample;
use cotillion::scene::{ClipFolders, Scene, load_text};
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

/// Largest distance of a hand from where it holds what it carries, on all samples of all carriers, metres.
fn largest_miss(scene: &Scene) -> f64 {
    let mut editor = Editor::new(scene.clone()).expect("a regular scene");
    let edit = editor.solve().expect("the constraints agree");
    let mut resampled = resample(scene, edit).expect("a result of usual length");
    let embodied = embody(scene, edit, &mut resampled);
    let moved = Moved { scene, characters: &edit.characters };
    let objects = object_motions(scene, &moved);
    let mut worst = 0.0_f64;
    for (motion, span) in
        objects.iter().flat_map(|motion| motion.spans.iter().map(move |span| (motion, span)))
    {
        let Owner::Carried(hold) = &span.owner else { continue };
        for grip in &hold.grips {
            let Body { times, poses, .. } = &embodied.bodies[grip.character.as_usize()];
            let skeleton = &scene.characters[grip.character.as_usize()].track.clips[0].clip.skeleton;
            let own = times.iter().zip(poses).filter(|(time, _)| (span.from..=span.to).contains(*time));
            for (time, pose) in own {
                let hand = skeleton.forward_kinematics(pose)[grip.joint.as_usize()].position;
                let on_box = motion.pose_at(scene, &moved, *time).apply(grip.point);
                worst = worst.max(hand.distance(on_box));
            }
        }
    }
    let stage = Stage { scene, performance: &moved, objects: &objects };
    let told = carry_residuals(&stage, &embodied).into_iter().fold(0.0, f64::max);
    assert!(told >= worst - 1e-12 && told < worst + ON_THE_BOX, "{told} is told of {worst}");
    worst
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
