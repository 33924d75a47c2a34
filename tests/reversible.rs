//! Reversible manipulation: what comes of drags depends on the motion at rest and on where the handles are, not on the way
//! they took. Otherwise it may, but changes can be taken back.

mod paths;

use std::f64::consts::TAU;
use std::path::Path;
use std::sync::Arc;

use cotillion::clip::working::WorkingClip;
use cotillion::constraint::{ChangeKind, Evaluator, Instant, Target};
use cotillion::discrete::editor::{DiscreteEditor, Occasion};
use cotillion::discrete::settings::DiscreteSettings;
use cotillion::geometry::c64;
use cotillion::graph::MotionGraph;
use cotillion::graph::scene::{graph_settings, scene_clips};
use cotillion::graph_cache::cached_graph;
use cotillion::index::ConstraintId;
use cotillion::scene::{ClipFolders, Mode, Scene, load_text};
use cotillion::track::Run;
use paths::{graph, path_clip, pin, scene, time};
use proptest::prelude::*;

/// Somebody who stands, then walks, with hard places and times at both ends.
struct Rehearsed {
    scene: Scene,
    graph: Arc<MotionGraph>,
    clips: Vec<Arc<WorkingClip>>,
    ends: (c64, c64),
    seconds: f64,
}

/// Pins and times in [`Rehearsed`].
const END: ConstraintId = ConstraintId(1);
const LAST: ConstraintId = ConstraintId(3);

/// Where the end is dragged: so many times as far, turned by so many radians, in so many times the time.
type Place = (f64, f64, f64);

const AT_REST: Place = (1.0, 0.0, 1.0);

fn rehearsed(mode: Mode) -> Rehearsed {
    let text = "[clips]\nidle = { builtin = \"idle\", seconds = 3 }\nwalk = { builtin = \"walk\", seconds = 5 }\n\
        [[character]]\nname = \"ann\"\ntrack = [\"idle\", \"walk\"]\nposition = [0.0, 0.0]\nfacing = 0.0\n";
    let folders = ClipFolders::default();
    let mut scene = load_text(text, Path::new("walk.toml"), &folders).expect("a sound scene").scene;
    scene.mode = mode;
    let path = scene.characters[0].track.rest_path();
    let ends = (path.positions[0], path.positions[path.len() - 1]);
    let seconds = (path.len() - 1) as f64 / 30.0;
    scene.constraints = vec![
        pin(Instant::TrackStart, ends.0),
        pin(Instant::TrackEnd, ends.1),
        time(Instant::TrackStart, 0.0),
        time(Instant::TrackEnd, seconds),
    ];
    let clips = scene_clips(&scene);
    let graph = Arc::new(cached_graph(&clips, &graph_settings(mode), None).0);
    Rehearsed { scene, graph, clips, ends, seconds }
}

impl Rehearsed {
    fn settings(&self, reversible: bool) -> DiscreteSettings {
        DiscreteSettings { reversible, ..DiscreteSettings::of(self.scene.mode) }
    }

    fn editor(&self, settings: DiscreteSettings) -> DiscreteEditor {
        let given = (Arc::clone(&self.graph), self.clips.as_slice());
        DiscreteEditor::new(self.scene.clone(), given, settings).expect("a regular scene")
    }

    fn drag(&self, editor: &mut DiscreteEditor, (far, turn, slow): Place) {
        let to = self.ends.0 + (self.ends.1 - self.ends.0) * c64::from_polar(far, turn);
        editor.move_target(END, Target::Position(to)).expect("a pin");
        editor.move_target(LAST, Target::Seconds(slow * self.seconds)).expect("a time");
        editor.update(Occasion::First).expect("an answer");
    }

    /// After drags to all of `places`, one after the other.
    fn taken_through(&self, places: &[Place], settings: DiscreteSettings) -> DiscreteEditor {
        let mut editor = self.editor(settings);
        places.iter().for_each(|place| self.drag(&mut editor, *place));
        editor
    }
}

fn runs(editor: &DiscreteEditor) -> Vec<Vec<Run>> {
    editor.scene().characters.iter().map(|character| character.track.runs.clone()).collect()
}

/// Panics unless both have the same tracks, paths, times and energy, bit for bit.
fn assert_same(own: &DiscreteEditor, other: &DiscreteEditor) {
    assert_eq!(runs(own), runs(other));
    let differs =
        own.edit().characters.iter().zip(&other.edit().characters).position(|(own, other)| own != other);
    assert_eq!(differs, None, "paths and times");
    assert_eq!(own.energy().total.to_bits(), other.energy().total.to_bits());
}

/// The log tells how the tracks got as long as they are.
fn assert_log_adds_up(editor: &DiscreteEditor, rest: &Scene) {
    for (who, (now, before)) in editor.scene().characters.iter().zip(&rest.characters).enumerate() {
        let own = editor.log().iter().filter(|entry| entry.character.as_usize() == who);
        let sum: i64 = own.map(|entry| entry.frames).sum();
        let frames = |count: usize| i64::try_from(count).expect("few");
        assert_eq!(sum, frames(now.track.frame_count()) - frames(before.track.frame_count()));
    }
}

#[test]
fn out_and_back_is_where_it_was() {
    let rehearsed = rehearsed(Mode::Production);
    let (a, b) = ((1.3, 0.1, 1.0), (1.9, -0.3, 1.2));
    let mut editor = rehearsed.taken_through(&[a], rehearsed.settings(true));
    let first = rehearsed.taken_through(&[a], rehearsed.settings(true));
    rehearsed.drag(&mut editor, b);
    assert_ne!(runs(&editor), runs(&first), "the way leads somewhere");
    rehearsed.drag(&mut editor, a);
    assert_same(&editor, &first);
    assert!(editor.log().iter().any(|entry| entry.undo));
    assert_log_adds_up(&editor, &rehearsed.scene);
    rehearsed.drag(&mut editor, AT_REST);
    assert_same(&editor, &rehearsed.taken_through(&[AT_REST], rehearsed.settings(true)));
    assert_log_adds_up(&editor, &rehearsed.scene);
}

#[test]
fn a_detour_makes_no_difference() {
    for mode in [Mode::Production, Mode::Paper] {
        let rehearsed = rehearsed(mode);
        let (a, b, c) = ((1.1, 0.0, 1.0), (1.6, 0.2, 1.1), (0.7, -0.4, 0.9));
        let detour = rehearsed.taken_through(&[a, c, b], rehearsed.settings(true));
        assert_same(&detour, &rehearsed.taken_through(&[a, b], rehearsed.settings(true)));
        assert_same(&detour, &rehearsed.taken_through(&[b], rehearsed.settings(true)));
    }
}

#[test]
fn weighing_all_finds_the_same() {
    let rehearsed = rehearsed(Mode::Production);
    let places = [(1.7, 0.2, 1.1)];
    let brute = DiscreteSettings { evaluator: Evaluator::BruteForce, ..rehearsed.settings(true) };
    let exact = rehearsed.taken_through(&places, rehearsed.settings(true));
    assert!(!exact.log().is_empty());
    assert_same(&exact, &rehearsed.taken_through(&places, brute));
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 12, ..ProptestConfig::default() })]
    /// Whatever drags come before the last one, it ends as if it were the only one.
    #[test]
    fn drags_are_forgotten(
        way in prop::collection::vec((0.6..2.0_f64, -0.6..0.6_f64, 0.8..1.4_f64), 1..5),
        last in (0.6..2.0_f64, -0.6..0.6_f64, 0.8..1.4_f64),
    ) {
        let rehearsed = rehearsed(Mode::Production);
        let mut editor = rehearsed.taken_through(&way, rehearsed.settings(true));
        rehearsed.drag(&mut editor, last);
        assert_same(&editor, &rehearsed.taken_through(&[last], rehearsed.settings(true)));
        assert_log_adds_up(&editor, &rehearsed.scene);
    }
}

/// Ways to a place, and how many of them end elsewhere than the direct one.
#[test]
#[expect(clippy::print_stderr, reason = "how many is a record, not a promise")]
fn otherwise_the_way_may_make_a_difference() {
    let rehearsed = rehearsed(Mode::Production);
    let (mut differ, mut all) = (0, 0);
    for far in [0.8, 1.2, 1.5, 1.8] {
        for turn in [-0.3, 0.0, 0.3] {
            let (b, c) = ((far, turn, 1.0), (2.3 - far, -turn, 1.0));
            let steps = |from: Place, to: Place| {
                (1..=5).map(move |step| {
                    let share = f64::from(step) / 5.0;
                    let mix = |a: f64, b: f64| a + share * (b - a);
                    (mix(from.0, to.0), mix(from.1, to.1), 1.0)
                })
            };
            let direct: Vec<Place> = steps(AT_REST, b).collect();
            let detour: Vec<Place> = steps(AT_REST, c).chain(steps(c, b)).collect();
            let [direct, detour] = [direct, detour]
                .map(|places| runs(&rehearsed.taken_through(&places, rehearsed.settings(false))));
            all += 1;
            differ += usize::from(direct != detour);
        }
    }
    eprintln!("{differ} of {all} detours end with other tracks");
    assert!(differ > 0, "then the docs need not recommend reversible drags for this");
}

/// A straight walk in cycles of 30 frames, pinned at both ends.
fn straight(mode: Mode) -> (Scene, Arc<MotionGraph>, Vec<Arc<WorkingClip>>, c64) {
    let points: Vec<c64> = (0..181)
        .map(|frame| c64::new(0.04 * f64::from(frame), 0.004 * (TAU * f64::from(frame) / 30.0).sin()))
        .collect();
    let clip = path_clip(&points, None);
    let pairs: Vec<(usize, usize, f64)> = (0..151).map(|i| (i, i + 30, 0.0)).collect();
    let graph = Arc::new(graph(&[points.len()], &pairs));
    let clips = vec![clip];
    let mut scene =
        scene(&clips, vec![pin(Instant::TrackStart, points[0]), pin(Instant::TrackEnd, points[180])]);
    scene.mode = mode;
    (scene, graph, clips, points[180])
}

#[test]
fn one_update_takes_as_many_changes_as_it_needs() {
    let (scene, graph, clips, end) = straight(Mode::Paper);
    let kinds = vec![ChangeKind::Delete, ChangeKind::Duplicate];
    let settings = DiscreteSettings { reversible: true, kinds, ..DiscreteSettings::of(Mode::Paper) };
    let mut editor = DiscreteEditor::new(scene.clone(), (graph, &clips), settings).expect("regular");
    for (stretch, frames) in [(2.0, 361), (1.5, 271), (1.0, 181), (1.3, 241)] {
        editor.move_target(ConstraintId(1), Target::Position(stretch * end)).expect("a pin");
        editor.update(Occasion::First).expect("solvable");
        assert_eq!(editor.scene().characters[0].track.frame_count(), frames, "x{stretch}");
        assert_log_adds_up(&editor, &scene);
        let changes = editor.log().len();
        assert!(stretch < 2.0 || changes == 6, "x{stretch}: {changes} changes");
    }
}

#[test]
fn out_and_back_on_a_straight_walk_ends_with_the_frames_it_began_with() {
    let (scene, graph, clips, end) = straight(Mode::Production);
    for (undo, back) in [(true, true), (false, false)] {
        // The graph alone could not shorten again.
        let settings =
            DiscreteSettings { kinds: vec![ChangeKind::Duplicate], undo, ..DiscreteSettings::of(scene.mode) };
        let mut editor =
            DiscreteEditor::new(scene.clone(), (Arc::clone(&graph), &clips), settings).expect("regular");
        for step in (1..=20).chain((0..20).rev()) {
            let stretch = 1.0 + 0.05 * f64::from(step);
            editor.move_target(ConstraintId(1), Target::Position(stretch * end)).expect("a pin");
            editor.update(Occasion::First).expect("solvable");
            let frames = editor.scene().characters[0].track.frame_count();
            if step == 20 {
                assert_eq!(frames, 361);
            }
        }
        assert_eq!(runs(&editor)[0] == scene.characters[0].track.runs, back);
        assert_eq!(editor.log().iter().any(|entry| entry.undo && entry.frames < 0), back);
    }
}

#[test]
fn strangers_are_found_each_by_themselves() {
    let rehearsed = rehearsed(Mode::Production);
    let alone = rehearsed.taken_through(&[(1.5, 0.1, 1.0)], rehearsed.settings(true));
    let mut two = Rehearsed {
        scene: rehearsed.scene.clone(),
        graph: Arc::clone(&rehearsed.graph),
        clips: rehearsed.clips.clone(),
        ..rehearsed
    };
    let mut other = two.scene.characters[0].clone();
    other.name = "bob".to_owned();
    two.scene.characters.push(other);
    let mut both = two.taken_through(&[(1.5, 0.1, 1.0)], two.settings(true));
    assert_eq!(runs(&both)[0], runs(&alone)[0]);
    assert_eq!(both.edit().characters[0], alone.edit().characters[0]);
    assert_eq!(
        runs(&both)[1],
        vec![two.scene.characters[1].track.runs[0], two.scene.characters[1].track.runs[1]]
    );
    two.drag(&mut both, AT_REST);
    assert_eq!(runs(&both)[0], runs(&both)[1]);
}
