//! Whatever frames come and go: moments show the frames they name, intervals keep pairing, what is carried stays in the
//! hands, and what is as before the edit stays what it was before all changes.

use std::path::Path;
use std::sync::Arc;

use cotillion::constraint::Instant;
use cotillion::discrete::candidates::{Candidate, Seen, candidates};
use cotillion::discrete::editor::DiscreteEditor;
use cotillion::discrete::remap::{protected, spliced};
use cotillion::discrete::settings::DiscreteSettings;
use cotillion::edit::{Edit, Editor};
use cotillion::embody::embody;
use cotillion::graph::MotionGraph;
use cotillion::graph::scene::{entries, graph_settings, scene_clips};
use cotillion::graph_cache::cached_graph;
use cotillion::index::{CharacterId, floor_index};
use cotillion::object_motion::{object_motions, skeleton_of};
use cotillion::reach::{REACHED, Stage, carry_residuals, effector_residuals};
use cotillion::resample::resample;
use cotillion::residual::residuals;
use cotillion::scene::{ClipFolders, Scene, load_text};
use cotillion::skeleton::JointRole;
use cotillion::ties::Ties;
use cotillion::track::Track;

/// Hard constraints hold to this, metres, radians, seconds.
const HARD: f64 = 1e-9;

/// Ann carries a box, bob walks beside her all the while as in the rehearsal, and touches her shoulder at the end.
const SCENE: &str = r#"
title = "Escort"
[clips]
come = { builtin = "walk", start = 1, stop = 1, seconds = 3 }
pick_up = "builtin:pick_up"
carry = { builtin = "carry", take = 0, give = 0, seconds = 5 }
put_down = "builtin:put_down"
walk = { builtin = "walk", start = 1, stop = 1, seconds = 8 }
slap = "builtin:slap"
[[character]]
name = "ann"
track = ["pick_up", "carry", "put_down"]
position = [0.0, 0.0]
facing = 0.0
[[character]]
name = "bob"
track = ["come", "walk", "slap"]
position = [-3.0, -1.0]
facing = 0.0
[[object]]
name = "box"
size = [0.3, 0.3, 0.3]
position = [0.5, 0.0]
facing = 0.0
[[carry]]
name = "ann has it"
object = "box"
by = ["ann"]
during = ["ann/pick_up:grasp", "ann/put_down:release"]
[[relative]]
name = "ann at the box"
at = "ann/pick_up:grasp"
to = "box"
[[relative]]
name = "beside her"
during = ["bob/walk:start", "bob/walk:end"]
to = ["ann/carry:start", "ann/carry:end"]
strength = 1.0
[[sync]]
name = "with her"
intervals = [["bob/walk:start", "bob/walk:end"], ["ann/carry:start", "ann/carry:end"]]
strength = "hard"
[[relative]]
name = "as in the rehearsal"
at = "bob/walk:60"
to = "ann/carry:60"
strength = "hard"
[[end_effector]]
at = "bob/slap:hit"
joint = "right_hand"
target = { position = [4.2, 1.4, 0.8] }
[[time]]
at = "ann:start"
seconds = 0.0
strength = "hard"
[discrete]
"#;

struct Rehearsed {
    scene: Scene,
    graph: Arc<MotionGraph>,
    clips: Vec<Arc<cotillion::clip::working::WorkingClip>>,
    settings: DiscreteSettings,
}

fn rehearsed() -> Rehearsed {
    let folders = ClipFolders::default();
    let scene = load_text(SCENE, Path::new("escort.toml"), &folders).expect("a sound scene").scene;
    let clips = scene_clips(&scene);
    let graph = Arc::new(cached_graph(&clips, &graph_settings(scene.mode), None).0);
    let settings = DiscreteSettings::of_scene(&scene);
    let editor = DiscreteEditor::new(scene, (Arc::clone(&graph), &clips), settings.clone());
    let scene = editor.expect("a regular scene").scene().clone();
    Rehearsed { scene, graph, clips, settings }
}

impl Rehearsed {
    fn candidates(&self, scene: &Scene) -> Vec<Candidate> {
        let all = scene.characters.iter().enumerate().flat_map(|(who, character)| {
            let (id, track) = (CharacterId::from_usize(who), &character.track);
            let clips: Vec<usize> = entries(&self.clips, track).into_iter().flatten().collect();
            let still = track.collect(|clip, frame, _| clip.stationary[frame]);
            let (protected, open) = (protected(scene, id), vec![true; track.frame_count()]);
            let seen = Seen {
                character: id,
                track,
                clips: &clips,
                protected: &protected,
                still: &still,
                open: &open,
            };
            candidates(&self.graph, &seen, &self.settings)
        });
        all.collect()
    }
}

/// Clip and working frame that a track shows at a track frame, the fraction of a frame after it left out.
fn shown(track: &Track, frame: f64) -> (usize, usize) {
    let place = floor_index(frame);
    let found = track.placed_runs().filter(|(_, start)| *start <= place).last();
    let (run, start) = found.expect("the first run starts at 0");
    (run.entry, run.last.as_usize().min(run.first.as_usize() + place - start))
}

/// What every moment shows.
fn moments(scene: &Scene) -> Vec<(usize, usize)> {
    let shown = |moment: &cotillion::constraint::Moment| {
        let Instant::Shown(frame) = moment.instant else { panic!("{} is bound", moment.name) };
        shown(&scene.characters[moment.character.as_usize()].track, frame)
    };
    scene.moments().map(shown).collect()
}

/// Checks an edit: hard constraints, and hands on what they carry. Whether the legs of all carriers span their steps; where
/// they do not, as in changes that nobody would choose, bodies go down too far for their hands.
fn holds(scene: &Scene, edit: &Edit) -> bool {
    for (constraint, residual) in scene.constraints.iter().zip(residuals(scene, edit)) {
        if constraint.strength == cotillion::constraint::Strength::Hard {
            let all = [residual.position, residual.path_position, residual.facing, residual.seconds];
            let miss = all.into_iter().flatten().fold(0.0, f64::max);
            assert!(miss < HARD, "{}: {residual:?}", constraint.name);
        }
    }
    let mut resampled = resample(scene, edit).expect("a result of usual length");
    let embodied = embody(scene, edit, &mut resampled);
    let objects = object_motions(scene, &embodied.moved);
    let ties = Ties::of(scene);
    let stage = Stage { scene, performance: &embodied.moved, objects: &objects, ties: &ties };
    let touches = effector_residuals(&stage, &embodied);
    assert_eq!(touches.len(), 1);
    let (ann, skeleton) = (&embodied.bodies[0].report, skeleton_of(scene, CharacterId(0)));
    let feet = [JointRole::LeftFoot, JointRole::RightFoot].map(|role| skeleton.joint_of(role));
    let spanned = !ann.shortfalls.iter().any(|shortfall| feet.contains(&Some(shortfall.joint)));
    for miss in carry_residuals(&stage, &embodied) {
        assert!(!spanned || miss < REACHED, "a hand {miss} m off the box");
    }
    spanned
}

#[test]
fn moments_carries_and_intervals_follow_every_change() {
    /// Changes one after the other, and how many of each generation are tried.
    const GENERATIONS: usize = 3;
    const TRIED: usize = 6;
    let rehearsed = rehearsed();
    let named = moments(&rehearsed.scene);
    let mut scene = rehearsed.scene.clone();
    let mut editor = Editor::new(scene.clone()).expect("a regular scene");
    let edit = editor.solve().expect("an answer").clone();
    assert!(holds(editor.scene(), &edit));
    let mut spanned = Vec::new();
    for generation in 0..GENERATIONS {
        let found = rehearsed.candidates(&scene);
        assert!(found.len() > TRIED, "{} candidates", found.len());
        let mut next = None;
        for candidate in found.iter().skip(generation).step_by(found.len() / TRIED) {
            let changed = spliced(&scene, candidate.character, &candidate.splice, candidate.keep)
                .expect("a candidate keeps every moment");
            assert_eq!(moments(&changed), named, "{candidate:?}");
            assert_eq!(changed.captured, rehearsed.scene.captured, "as before all changes");
            let mut editor = Editor::new(changed).expect("a regular scene");
            let edit = editor.solve().expect("an answer").clone();
            spanned.push(holds(editor.scene(), &edit));
            next = Some(editor.scene().clone());
        }
        scene = next.expect("some were tried");
    }
    let held = spanned.iter().filter(|spanned| **spanned).count();
    assert!(4 * held > 3 * spanned.len(), "hands were looked at in {held} of {} changes", spanned.len());
}
