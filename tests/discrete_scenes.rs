//! The exact evaluator chooses what brute force chooses, its bounds are bounds, and both on any number of threads.

mod paths;
mod things;

use std::f64::consts::TAU;
use std::sync::Arc;

use cotillion::clip::working::WorkingClip;
use cotillion::constraint::{
    Constraint, ConstraintKind, Evaluator, Instant, Partner, Relation, Strength, Target, When,
};
use cotillion::discrete::editor::{DiscreteEditor, LogEntry, Occasion};
use cotillion::discrete::settings::DiscreteSettings;
use cotillion::edit::EditError;
use cotillion::geometry::c64;
use cotillion::graph::MotionGraph;
use cotillion::index::ConstraintId;
use cotillion::scene::{Mode, Scene};
use paths::{graph, hard, moment, path_clip, pin, scene, time};
use things::add_things;

/// Ê of one group solved alone and of all solved anew: the same sums in the same order.
const SAME: f64 = 1e-12;
/// Ê of what-ifs and of systems built anew: relative, and where both are next to nothing.
const WHAT_IF: (f64, f64) = (1e-8, 1e-12);
/// Scenes tried; some of them contradict themselves.
const SCENES: u64 = 500;
/// So many at most are made to find them, and twice as many where there are things.
const MOST_SEEDS: u64 = 2 * SCENES;
/// Scenes with things that stand, move, or are carried.
const WITH_THINGS: u64 = 200;
/// Test functions that share them.
const SHARES: u64 = 4;

/// A sequence of numbers that a seed decides. Source: Steele, Lea, Flood, *Fast splittable pseudorandom number generators*,
/// OOPSLA 2014.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn below(&mut self, count: usize) -> usize {
        usize::try_from(self.next() % count as u64).unwrap_or(0)
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (self.next() >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn chance(&mut self, share: f64) -> bool {
        self.between(0.0, 1.0) < share
    }

    fn strength(&mut self) -> Strength {
        if self.chance(0.5) { Strength::Hard } else { Strength::Soft(10_f64.powf(self.between(-2.0, 1.5))) }
    }
}

/// Steps of 20 frames: straight on; along a bend; with a stand from frame 36 to 65.
fn clips() -> [Arc<WorkingClip>; 3] {
    let walk = |frames: usize, turn: f64, stand: Option<(usize, usize)>| {
        let (mut at, mut heading) = (c64::default(), 0.0);
        let mut points = vec![at];
        for frame in 1..frames {
            let still = stand.is_some_and(|(first, last)| (first + 1..=last).contains(&frame));
            let phase = TAU * frame as f64 / 20.0;
            heading += turn;
            let step = if still {
                c64::new(0.0002 * phase.cos(), 0.0003 * phase.sin())
            } else {
                c64::new(0.04 * (1.0 + 0.2 * (2.0 * phase).cos()), 0.006 * phase.cos())
            };
            at += step * c64::cis(heading);
            points.push(at);
        }
        path_clip(&points, stand)
    };
    [walk(70, 0.0, None), walk(80, 0.02, None), walk(100, 0.0, Some((36, 65)))]
}

fn transitions() -> MotionGraph {
    let own = [[(12, 32), (17, 37), (25, 45)], [(10, 30), (28, 48), (33, 53)], [(8, 28), (38, 62), (70, 90)]];
    let starts = [0, 70, 150];
    let mut pairs = Vec::new();
    for (start, own) in starts.iter().zip(own) {
        pairs.extend(own.into_iter().enumerate().map(|(n, (i, j))| (start + i, start + j, 0.1 * n as f64)));
    }
    pairs.extend([(12, 70 + 10, 0.25), (45, 70 + 48, 0.35)]);
    graph(&[70, 80, 100], &pairs)
}

/// A scene of one to four characters, and the constraint that is dragged, with the place it starts from.
fn random_scene(random: &mut Random, clips: &[Arc<WorkingClip>; 3]) -> (Scene, (ConstraintId, c64)) {
    let count = 1 + random.below(4);
    let cast: Vec<Arc<WorkingClip>> = (0..count).map(|_| Arc::clone(&clips[random.below(3)])).collect();
    let mut constraints = Vec::new();
    for (who, clip) in cast.iter().enumerate() {
        constraints.extend(of_one(random, who, clip));
    }
    for who in 1..count {
        constraints.extend(of_two(random, (who, &cast[who]), (who - 1, &cast[who - 1])));
    }
    let last = cast[0].positions[cast[0].frame_count() - 1];
    let dragged = ConstraintId::from_usize(constraints.len());
    constraints.push(Constraint { strength: random.strength(), ..pin(Instant::TrackEnd, last) });
    if random.chance(0.5) {
        constraints.push(pin(Instant::TrackStart, cast[0].positions[0]));
    }
    if random.chance(0.4) {
        let seconds = (cast[0].frame_count() - 1) as f64 / 30.0 * random.between(0.75, 1.4);
        constraints.push(time(Instant::TrackStart, 0.0));
        constraints.push(Constraint { strength: random.strength(), ..time(Instant::TrackEnd, seconds) });
    }
    let mut scene = scene(&cast, constraints);
    scene.mode = if random.chance(0.5) { Mode::Paper } else { Mode::Production };
    (scene, (dragged, last))
}

fn frame(random: &mut Random, clip: &WorkingClip) -> Instant {
    let whole = random.below(clip.frame_count()) as f64;
    let working = if random.chance(0.2) { (whole - 0.4).max(0.0) } else { whole };
    Instant::Frame { entry: 0, working }
}

/// Places, facings, stretches and durations of one character.
fn of_one(random: &mut Random, who: usize, clip: &WorkingClip) -> Vec<Constraint> {
    let mut all = Vec::new();
    if random.chance(0.7) {
        let at = random.below(clip.frame_count());
        let when = When::At(moment(who, Instant::Frame { entry: 0, working: at as f64 }));
        let near = clip.positions[at] + c64::new(random.between(-0.4, 0.4), random.between(-0.4, 0.4));
        let facing = random.chance(0.4).then(|| clip.headings[at] + random.between(-0.5, 0.5));
        let kind = ConstraintKind::Pin { when, position: Some(near), facing };
        all.push(Constraint { strength: random.strength(), ..hard("place", kind) });
    }
    if random.chance(0.2) {
        let ends = [5.0, 42.0].map(|working| moment(who, Instant::Frame { entry: 0, working }));
        let [from, to] = ends;
        let kind = ConstraintKind::Pin { when: When::During(from, to), position: None, facing: Some(0.3) };
        all.push(Constraint { strength: Strength::Soft(0.05), ..hard("stretch", kind) });
    }
    if random.chance(0.3) {
        let [from, to] = [5.0, 55.0].map(|working| moment(who, Instant::Frame { entry: 0, working }));
        let seconds = random.between(1.2, 2.4);
        let kind = ConstraintKind::Duration { from, to, seconds };
        all.push(Constraint { strength: random.strength(), ..hard("duration", kind) });
    }
    all
}

/// Offsets, facings and times that tie one character to another.
fn of_two(
    random: &mut Random,
    (who, clip): (usize, &WorkingClip),
    (other, partner): (usize, &WorkingClip),
) -> Vec<Constraint> {
    let mut all = Vec::new();
    let (at, to) = (frame(random, clip), frame(random, partner));
    if random.chance(0.6) {
        let kind = ConstraintKind::Relative {
            when: When::At(moment(who, at)),
            partner: Partner::Character(When::At(moment(other, to))),
            offset: if random.chance(0.5) {
                Relation::AsBefore
            } else {
                Relation::Given(c64::new(random.between(0.3, 1.2), random.between(-1.0, 1.0)))
            },
            facing: if random.chance(0.5) { Relation::Free } else { Relation::AsBefore },
        };
        all.push(Constraint { strength: random.strength(), ..hard("beside", kind) });
    }
    if random.chance(0.5) {
        let moments = vec![When::At(moment(who, at)), When::At(moment(other, to))];
        let kind = ConstraintKind::Sync { moments, offset: random.between(-0.2, 0.2) };
        all.push(Constraint { strength: random.strength(), ..hard("together", kind) });
    }
    all
}

fn editor(
    scene: &Scene,
    (graph, clips): (&Arc<MotionGraph>, &[Arc<WorkingClip>]),
    evaluator: Evaluator,
) -> Result<DiscreteEditor, EditError> {
    let settings = DiscreteSettings { evaluator, ..DiscreteSettings::of(scene.mode) };
    DiscreteEditor::new(scene.clone(), (Arc::clone(graph), clips), settings)
}

/// Drags one end in two steps; what came of each. Panics where the evaluators differ or a bound is none.
fn compare(
    seed: u64,
    given: (&Arc<MotionGraph>, &[Arc<WorkingClip>; 3]),
    with_things: bool,
) -> Option<[usize; 3]> {
    let mut random = Random(seed);
    let (mut scene, (dragged, from)) = random_scene(&mut random, given.1);
    if with_things {
        add_things(&mut random, &mut scene);
    }
    let given = (given.0, given.1.as_slice());
    let mut exact = editor(&scene, given, Evaluator::Exact).ok()?;
    let mut brute = editor(&scene, given, Evaluator::BruteForce).ok()?;
    let (mut changes, mut known, mut others) = (0, 0, 0);
    for step in 0..2 {
        let stretch = random.between(0.6, 1.7);
        let target = Target::Position(from * stretch + c64::new(0.0, random.between(-0.5, 0.5)));
        exact.move_target(dragged, target).expect("a pin");
        brute.move_target(dragged, target).expect("a pin");
        let (own, other) = (exact.update(Occasion::First), brute.update(Occasion::First));
        assert_eq!(own.is_ok(), other.is_ok(), "seed {seed}, step {step}");
        changes += usize::from(own.ok()?);
        same_log(seed, exact.log(), brute.log());
        let (own, other) = (exact.energy().total, brute.energy().total);
        assert!((own - other).abs() <= SAME * (1.0 + own), "seed {seed}: {own} and {other}");
        if step == 0 {
            let (told, untold) = bounds_hold(seed, &mut exact);
            known += told;
            others += untold;
        }
    }
    Some([changes, known, others])
}

fn same_log(seed: u64, own: &[LogEntry], other: &[LogEntry]) {
    let what =
        |entry: &LogEntry| (entry.character, entry.kind, entry.interval, entry.frames, entry.at.clone());
    let (left, right): (Vec<_>, Vec<_>) = (own.iter().map(what).collect(), other.iter().map(what).collect());
    assert_eq!(left, right, "seed {seed}");
    for (a, b) in own.iter().zip(other) {
        assert!((a.energy.1 - b.energy.1).abs() <= SAME * (1.0 + b.energy.1), "seed {seed}: {a:?} and {b:?}");
    }
}

/// Every bound is one, every energy that of the whole scene solved anew, every what-if to rounding. How many of these there were,
/// and how many candidates have an energy and no what-if.
fn bounds_hold(seed: u64, editor: &mut DiscreteEditor) -> (usize, usize) {
    let (mut known, mut others) = (0, 0);
    for appraisal in editor.appraise() {
        let anew = editor.weigh(&appraisal.candidate);
        match (appraisal.energy, anew) {
            (Some(own), Some(anew)) => {
                assert!((own - anew).abs() <= SAME * (1.0 + anew), "seed {seed}: {own} for {anew}");
                assert!(appraisal.bound <= own, "seed {seed}: {own} below {appraisal:?}");
            }
            (own, anew) => assert_eq!(own, anew, "seed {seed}: {appraisal:?}"),
        }
        if let (Some(own), Some(anew)) = (appraisal.estimate, anew) {
            let allowed = WHAT_IF.0 * anew + WHAT_IF.1;
            assert!((own - anew).abs() <= allowed, "seed {seed}: {own} for {anew}");
            known += 1;
        } else if anew.is_some() {
            others += 1;
        }
    }
    (known, others)
}

fn compare_share(share: u64, (scenes, with_things): (u64, bool)) {
    let (clips, graph) = (clips(), Arc::new(transitions()));
    let count = usize::try_from(scenes / SHARES).expect("few");
    let most = if with_things { 2 * MOST_SEEDS } else { MOST_SEEDS };
    let results: Vec<[usize; 3]> = (0..most)
        .filter(|seed| seed % SHARES == share)
        .filter_map(|seed| compare(seed, (&graph, &clips), with_things))
        .take(count)
        .collect();
    let sum = [0, 1, 2].map(|number| results.iter().map(|own| own[number]).sum::<usize>());
    let least = count / 2;
    // Where somebody has had what others are held beside, whole scenes are solved.
    let asked = if with_things { &sum[..] } else { &sum[..2] };
    let enough = asked.iter().all(|number| *number > least);
    assert!(results.len() == count && enough, "{} scenes, {sum:?}", results.len());
}

#[test]
fn the_exact_evaluator_chooses_as_brute_force_does_first_quarter() {
    compare_share(0, (SCENES, false));
}

#[test]
fn the_exact_evaluator_chooses_as_brute_force_does_second_quarter() {
    compare_share(1, (SCENES, false));
}

#[test]
fn the_exact_evaluator_chooses_as_brute_force_does_third_quarter() {
    compare_share(2, (SCENES, false));
}

#[test]
fn the_exact_evaluator_chooses_as_brute_force_does_last_quarter() {
    compare_share(3, (SCENES, false));
}

#[test]
fn among_things_the_exact_evaluator_chooses_as_brute_force_does_first_quarter() {
    compare_share(0, (WITH_THINGS, true));
}

#[test]
fn among_things_the_exact_evaluator_chooses_as_brute_force_does_second_quarter() {
    compare_share(1, (WITH_THINGS, true));
}

#[test]
fn among_things_the_exact_evaluator_chooses_as_brute_force_does_third_quarter() {
    compare_share(2, (WITH_THINGS, true));
}

#[test]
fn among_things_the_exact_evaluator_chooses_as_brute_force_does_last_quarter() {
    compare_share(3, (WITH_THINGS, true));
}

#[test]
fn one_thread_and_three_choose_the_same() {
    let (clips, graph) = (clips(), Arc::new(transitions()));
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        let update = |seed: u64| {
            let mut random = Random(seed);
            let (mut scene, (dragged, from)) = random_scene(&mut random, &clips);
            if seed.is_multiple_of(2) {
                add_things(&mut random, &mut scene);
            }
            let mut editor = editor(&scene, (&graph, &clips), Evaluator::Exact).ok()?;
            editor.move_target(dragged, Target::Position(1.5 * from)).expect("a pin");
            editor.update(Occasion::First).ok()?;
            Some((editor.log().to_vec(), editor.energy().total.to_bits()))
        };
        pool.install(|| (MOST_SEEDS..MOST_SEEDS + 20).map(update).collect::<Vec<_>>())
    };
    assert_eq!(run(1), run(3));
}
