//! What discrete editing never does: change what rests, change twice in an update, change for the worse, bring or take too
//! little or too much, tear at what is held, or leave where it may change something.

#[allow(dead_code, reason = "shared with tests that need more of it")]
mod paths;

use std::sync::Arc;

use cotillion::constraint::{
    ChangeKind, Constraint, ConstraintKind, Discrete, Evaluator, Instant, Target, When,
};
use cotillion::discrete::candidates::Candidate;
use cotillion::discrete::editor::{DiscreteEditor, Occasion};
use cotillion::discrete::settings::DiscreteSettings;
use cotillion::geometry::c64;
use cotillion::index::{CharacterId, ConstraintId};
use cotillion::scene::{Mode, Scene};
use paths::{graph, hard, moment, path_clip, pin, scene};

/// Frames of a step cycle, and metres a frame.
const CYCLE: usize = 30;
const STEP: f64 = 0.04;
/// Ê of what rests: rounding.
const NOTHING: f64 = 1e-9;
/// Frames that come or go: 0.3 to 2 s.
const SHORTEST: usize = 9;
const LONGEST: usize = 60;

/// Straight ahead, `frames` long.
fn straight(frames: usize) -> Vec<c64> {
    (0..frames).map(|frame| c64::new(STEP * frame as f64, 0.0)).collect()
}

fn last_pin(who: usize, position: c64) -> Constraint {
    let when = When::At(moment(who, Instant::TrackEnd));
    hard("end", ConstraintKind::Pin { when, position: Some(position), facing: None })
}

/// `count` people, each from their start to `stretch` times their end; the ends are the first constraints.
fn walkers(count: usize, frames: usize, stretch: f64) -> Scene {
    let clip = path_clip(&straight(frames), None);
    let end = STEP * (frames - 1) as f64;
    let mut constraints: Vec<Constraint> =
        (0..count).map(|who| last_pin(who, c64::new(stretch * end, 0.0))).collect();
    constraints.extend((0..count).map(|who| {
        let when = When::At(moment(who, Instant::TrackStart));
        hard("start", ConstraintKind::Pin { when, position: Some(c64::default()), facing: None })
    }));
    scene(&vec![clip; count], constraints)
}

fn editor(scene: Scene, pairs: &[(usize, usize, f64)], mode: Mode) -> DiscreteEditor {
    let clips = [Arc::clone(&scene.characters[0].track.clips[0])];
    let graph = Arc::new(graph(&[clips[0].frame_count()], pairs));
    let mut settings = DiscreteSettings::of(mode);
    if let Some(discrete) = &scene.discrete {
        settings.kinds.clone_from(&discrete.kinds);
    }
    DiscreteEditor::new(scene, (graph, &clips), settings).expect("a regular scene")
}

/// Every frame like those one, two, … cycles on, as far as edits reach; every fifth frame.
fn cyclic(frames: usize) -> Vec<(usize, usize, f64)> {
    let from = |i: usize| [i + CYCLE, i + 2 * CYCLE].map(|j| (i, j, 0.0));
    (0..frames).step_by(5).flat_map(from).filter(|(_, j, _)| *j < frames).collect()
}

fn proposed(editor: &mut DiscreteEditor) -> Vec<Candidate> {
    editor.update(Occasion::First).expect("there is a solution");
    editor.appraise().into_iter().map(|appraisal| appraisal.candidate).collect()
}

/// Track frames that it takes out, and frames that it brings.
fn exchanged(candidate: &Candidate) -> (usize, usize) {
    let splice = &candidate.splice;
    let put_in: usize = splice.inserted.iter().map(|s| s.last.as_usize() - s.first.as_usize() + 1).sum();
    let again = (splice.after + 1).saturating_sub(splice.resume);
    (splice.resume.saturating_sub(splice.after + 1), put_in + again)
}

#[test]
fn what_rests_stays_as_it_is() {
    for mode in [Mode::Paper, Mode::Production] {
        let mut editor = editor(walkers(2, 181, 1.0), &cyclic(181), mode);
        assert!(!editor.update(Occasion::First).expect("there is a solution"));
        assert_eq!(editor.settle().expect("there is a solution"), 0);
        assert!(editor.log().is_empty() && editor.energy().total < NOTHING, "{:?}", editor.energy());
    }
}

#[test]
fn an_update_makes_one_change_at_most_and_each_lowers_the_energy() {
    for mode in [Mode::Paper, Mode::Production] {
        let mut editor = editor(walkers(2, 181, 1.0), &cyclic(181), mode);
        editor.update(Occasion::First).expect("there is a solution");
        for step in 1..=5 {
            let end = 1.0 + 0.2 * f64::from(step);
            for who in 0..2 {
                let target = Target::Position(c64::new(end * STEP * 180.0, 0.0));
                editor.move_target(ConstraintId(who), target).expect("a pin");
            }
            let before = editor.log().len();
            let changed = editor.update(Occasion::First).expect("there is a solution");
            assert_eq!(editor.log().len(), before + usize::from(changed), "{mode:?}, step {step}");
        }
        let settled = editor.settle().expect("there is a solution");
        assert!(settled > 0 && editor.log().len() > 5, "{mode:?}: {:?}", editor.log());
        assert!(editor.log().iter().all(|entry| entry.energy.1 < entry.energy.0), "{:?}", editor.log());
        assert!(!editor.update(Occasion::First).expect("there is a solution"), "it has settled");
    }
}

#[test]
fn what_comes_or_goes_lasts_from_a_third_of_a_second_to_two() {
    let gaps = [5, SHORTEST - 1, SHORTEST, 30, LONGEST, LONGEST + 1, 70];
    let mut at = 10;
    let mut pairs = Vec::new();
    for gap in gaps {
        pairs.push((at, at + gap, 0.1));
        at += gap + 10;
    }
    let found = proposed(&mut editor(walkers(1, at + 20, 1.0), &pairs, Mode::Paper));
    let lengths: Vec<(usize, usize)> = found.iter().map(exchanged).collect();
    let fits = |count: &usize| *count == 0 || (SHORTEST..=LONGEST).contains(count);
    assert!(lengths.iter().all(|(out, back)| fits(out) && fits(back) && out + back > 0), "{lengths:?}");
    for gap in [SHORTEST, 30, LONGEST] {
        assert!(lengths.contains(&(gap, 0)) && lengths.contains(&(0, gap)), "{gap} of {lengths:?}");
    }
}

#[test]
fn no_change_encloses_a_smaller_one_of_its_type() {
    let pairs: Vec<(usize, usize, f64)> = (10..80)
        .step_by(7)
        .flat_map(|i| [(i, i + 12, 0.2), (i, i + 25, 0.1), (i + 3, i + 50, 0.0)])
        .collect();
    let found = proposed(&mut editor(walkers(1, 150, 1.0), &pairs, Mode::Paper));
    for own in found.iter().filter(|own| [ChangeKind::Delete, ChangeKind::Duplicate].contains(&own.kind)) {
        let encloses = |other: &&Candidate| {
            let (outer, inner) = (own.interval, other.interval);
            other.kind == own.kind && outer != inner && outer.0 <= inner.0 && inner.1 <= outer.1
        };
        assert_eq!(found.iter().find(encloses), None, "within {own:?}");
    }
    assert!(found.iter().any(|own| own.kind == ChangeKind::Delete));
}

#[test]
fn candidates_of_a_steady_walk_grow_with_its_frames() {
    let count = |frames: usize| {
        let mut editor = editor(walkers(1, frames, 1.0), &cyclic(frames), Mode::Paper);
        editor.update(Occasion::First).expect("there is a solution");
        editor.candidates() as f64
    };
    let [once, twice, four_times] = [181, 361, 721].map(count);
    let (first, second) = (twice - once, four_times - twice);
    assert!(first > 0.0 && (second / first - 2.0).abs() < 0.2, "{once} {twice} {four_times}");
}

#[test]
fn ends_and_held_frames_are_never_taken_out() {
    let mut scene = walkers(1, 181, 1.0);
    scene.constraints.push(pin(Instant::Frame { entry: 0, working: 90.0 }, c64::new(STEP * 90.0, 0.0)));
    let found = proposed(&mut editor(scene, &cyclic(181), Mode::Paper));
    let gone = |own: &Candidate| own.splice.after + 1..own.splice.resume.max(own.splice.after + 1);
    let torn: Vec<_> =
        found.iter().filter(|own| [0, 90, 180].iter().any(|frame| gone(own).contains(frame))).collect();
    assert!(torn.is_empty() && found.iter().any(|own| !gone(own).is_empty()), "{torn:?}");
}

#[test]
fn types_characters_times_and_places_that_are_not_allowed_stay_as_they_are() {
    let everything = Discrete {
        kinds: ChangeKind::ALL.to_vec(),
        characters: None,
        times: None,
        regions: None,
        evaluator: Evaluator::default(),
        settle: true,
        reversible: false,
    };
    let found = |discrete: Discrete| {
        let mut scene = walkers(2, 181, 1.0);
        scene.discrete = Some(discrete);
        proposed(&mut editor(scene, &cyclic(181), Mode::Paper))
    };
    let all = found(everything.clone());
    let holds = |discrete: Discrete, allowed: &dyn Fn(&Candidate) -> bool| {
        let some = found(discrete);
        assert!(!some.is_empty() && some.len() < all.len(), "{} of {}", some.len(), all.len());
        assert!(some.iter().all(allowed), "{some:?}");
    };
    let kinds = vec![ChangeKind::Duplicate];
    holds(Discrete { kinds, ..everything.clone() }, &|own| own.kind == ChangeKind::Duplicate);
    let characters = Some(vec![CharacterId(1)]);
    holds(Discrete { characters, ..everything.clone() }, &|own| own.character == CharacterId(1));
    let within = |own: &Candidate| own.interval.0 >= 50 && own.interval.1 <= 120;
    let at = |working: f64| moment(0, Instant::Frame { entry: 0, working });
    let times = Some(vec![(at(50.0), at(120.0))]);
    holds(Discrete { times, ..everything.clone() }, &|own| own.character == CharacterId(0) && within(own));
    let corners = (c64::new(STEP * 50.0, -1.0), c64::new(STEP * 120.0, 1.0));
    holds(Discrete { regions: Some(vec![corners]), ..everything.clone() }, &within);
}
