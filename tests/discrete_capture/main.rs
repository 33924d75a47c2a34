//! Walks of the captures whose end is pulled: steps come and go where strides would be stretched, and standing where time
//! would; what bends stays whole. Reported as skipped where there is no capture.
//!
//! `COTILLION_WRITE_DOCS=1` writes the table of `docs/discrete_editing.md` anew.

mod joints;
mod look;
mod pull;

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use cotillion::clip::working::WorkingClip;
use cotillion::discrete::settings::DiscreteSettings;
use cotillion::geometry::{c64, wrap};
use cotillion::graph::facts::transition_facts;
use cotillion::graph::{GraphSettings, motion_graph};
use cotillion::index::floor_index;
use cotillion::metrics::foot_slide_working;
use cotillion::scene::{Mode, Plants, Scene};
use cotillion::track::Splice;
use joints::{seams, usual};
use libtest_mimic::{Arguments, Failed, Trial};
use pull::{End, Feet, Pulled, clip, ends, feet, pull, read, shown, shown_slide};

/// Walks whose end is pulled to twice the distance and back to 0.6 of it, and how near their strides stay at twice.
const WALKS: [(&str, f64); 5] = [
    ("amc/cmu_16_15_walk_straight.amc", 0.1),
    ("bvh/cmu_12_01_walk.bvh", 0.1),
    ("amc/cmu_02_01_walk_straight.amc", 0.1),
    ("bvh/cmu_37_01_walk.bvh", 0.15),
    ("bvh/snu_walk_straight_normal.bvh", 0.1),
];
/// Who stands, walks and stands, and file frames.
const HALTS: [(&str, Option<(u32, u32)>); 2] =
    [("bvh/snu_walk_straight_normal.bvh", None), ("bvh/snu_u_turn.bvh", Some((0, 140)))];
const TURNING: &str = "amc/cmu_16_17_walk_90_degree_left_turn.amc";
const STYLISED: &str = "bvh/cmu_131_01_start_walk_stop.bvh";

/// Share of a cycle by which what comes or goes may differ from whole ones.
const PHASE: f64 = 0.1;
/// Stretch that remains besides that of half a cycle too much or too little.
const BEYOND_HALF: f64 = 0.02;
/// Slide of the feet before they are cleaned up: over the clip's own, and over that without discrete edits.
const SLIDE: f64 = 1.6;
const SLIDE_LEFT: f64 = 1.0 / 6.0;
/// Slide after the clean-up, as captured, over that of the clip where frames count as often as they are shown: at seams a
/// contact passes from one frame's drift to another's.
const CLEANED: f64 = 1.01;
/// Remaining stretch, in length and in time, where stands are prolonged; most that one frame is shown.
const LENGTH_LEFT: f64 = 0.01;
const TIME_LEFT: f64 = 0.1;
const COPIES: usize = 6;
/// A turn survives if the seams add less than this, radians: 25°; slide then, m/s. Lost it is beyond this: 60°.
const SEAM_TURNS: f64 = 0.436;
const TURN_SLIDE: f64 = 0.16;
const LOST_TURN: f64 = 1.047;
/// What an edit adds to how a body turns, a frame: 6°. The clip's own turns are up to 11°.
const HEADING: f64 = 0.105;
/// Duplications tried at random.
const DUPLICATIONS: usize = 100;

/// What is tried on the folder of captures.
type Test = Box<dyn FnOnce(&Path) -> Result<(), Failed> + Send>;

fn main() {
    let arguments = Arguments::from_args();
    let named = std::env::var_os("COTILLION_MOCAP").map(PathBuf::from);
    let folder = named.unwrap_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/mocap"));
    let skipped = !folder.is_dir();
    let mut trials = Vec::new();
    let mut add = |name: String, test: Test| {
        let folder = folder.clone();
        trials.push(Trial::test(name, move || test(&folder)).with_ignored_flag(skipped));
    };
    for (name, tolerance) in WALKS {
        let stem = stem(name);
        add(
            format!("{stem}_stretched_adds_whole_cycles"),
            Box::new(move |at| stretched(at, name, tolerance)),
        );
        add(format!("{stem}_shortened_takes_whole_cycles"), Box::new(move |at| shortened(at, name)));
    }
    for (name, range) in HALTS {
        for factor in [1.5, 0.8] {
            let title = format!("{}_lasting_{factor}_times_as_long_stands_for_it", stem(name));
            add(title, Box::new(move |at| lasting(at, (name, range), factor)));
        }
    }
    add("a_turn_pulled_sideways_stays".into(), Box::new(sideways));
    add("a_stylised_walk_is_not_spun_round".into(), Box::new(stylised));
    add("any_whole_cycle_can_be_shown_twice".into(), Box::new(duplications));
    add("who_passes_a_seam_neither_darts_nor_slides_nor_crosses_legs".into(), Box::new(look::ten_seams));
    add("the_table_of_all_drags_is_what_they_give".into(), Box::new(table));
    libtest_mimic::run(&arguments, trials).exit();
}

fn stem(name: &str) -> &str {
    Path::new(name).file_stem().and_then(|stem| stem.to_str()).unwrap_or(name)
}

fn check(holds: bool, what: impl FnOnce() -> String) -> Result<(), Failed> {
    if holds { Ok(()) } else { Err(what().into()) }
}

fn settings() -> DiscreteSettings {
    DiscreteSettings::of(Mode::Production)
}

fn none() -> DiscreteSettings {
    DiscreteSettings { kinds: Vec::new(), ..settings() }
}

/// The end of a scene at `factor` times the distance, reached in steps of 5 %.
fn away(scene: &Scene, factor: f64) -> Vec<End> {
    let (start, end) = ends(scene);
    factors(factor).map(|factor| (start + factor * (end - start), None)).collect()
}

/// The end where it is, at `factor` times the time, reached in steps of 5 %.
fn later(scene: &Scene, factor: f64) -> Vec<End> {
    let (_, end) = ends(scene);
    let seconds = (clip(scene).frame_count() - 1) as f64 / 30.0;
    factors(factor).map(|factor| (end, Some(factor * seconds))).collect()
}

fn factors(to: f64) -> impl Iterator<Item = f64> {
    let steps = floor_index(((to - 1.0).abs() / 0.05).round());
    (0..=steps).map(move |step| 1.0 + (to - 1.0) * step as f64 / steps as f64)
}

/// Frames of the clip's cycle.
fn cycle(clip: &Arc<WorkingClip>) -> Result<f64, Failed> {
    let graph = motion_graph(std::slice::from_ref(clip), &GraphSettings::default());
    let cycle = transition_facts(&graph, 0, clip).cycle.ok_or("a walk has cycles")?;
    Ok(cycle as f64)
}

/// Only whole cycles come and go, and what is left to stretch is half of one.
fn whole_cycles(scene: &Scene, pulled: &Pulled) -> Result<(), Failed> {
    let cycle = cycle(clip(scene))?;
    for change in &pulled.outcome.log {
        let cycles = change.frames as f64 / cycle;
        let whole = (cycles - cycles.round()).abs() < PHASE && cycles.round() != 0.0;
        check(whole, || format!("{:?} {} at {}: cycle {cycle}", change.kind, change.frames, change.at))?;
    }
    let (longest, used) = (longest_cycle(clip(scene), cycle), cycles_used(pulled));
    for step in &pulled.steps {
        let left = (step.edited / step.rest - 1.0).abs();
        // The one used last; before any is, the longest that could be.
        let used = step.changes.checked_sub(1).map_or(longest, |last| used[last]);
        check(left <= used / (2.0 * step.rest) + BEYOND_HALF, || {
            format!("{left:.4} left: {step:?}, a cycle is {used}, {:?}", pulled.outcome.log)
        })?;
    }
    all_seams(scene, pulled)
}

/// Ground length of the longest cycle of `frames` frames that the graph has, metres.
fn longest_cycle(clip: &Arc<WorkingClip>, frames: f64) -> f64 {
    let graph = motion_graph(std::slice::from_ref(clip), &GraphSettings::default());
    let pairs = graph.pairs().map(|(i, j, _)| (graph.place(i).1.as_usize(), graph.place(j).1.as_usize()));
    let whole = pairs.filter(|(i, j)| (i.abs_diff(*j) as f64 / frames - 1.0).abs() < PHASE);
    let path = |(i, j): (usize, usize)| -> f64 {
        clip.positions[i.min(j)..=i.max(j)].windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum()
    };
    whole.map(path).fold(0.0, f64::max)
}

/// By how many metres each change makes the track longer or shorter: the length of the cycle that comes or goes.
fn cycles_used(pulled: &Pulled) -> Vec<f64> {
    let changes = pulled.steps.windows(2).filter(|pair| pair[0].changes < pair[1].changes);
    changes.map(|pair| (pair[1].rest - pair[0].rest).abs()).collect()
}

/// Those of the track after every change.
fn all_seams(scene: &Scene, pulled: &Pulled) -> Result<(), Failed> {
    let usual = usual(clip(scene));
    pulled.changed.iter().try_for_each(|track| seams(&usual, track).map(|_| ()))
}

/// The feet of the clip itself.
fn own_feet(scene: &Scene) -> Result<Feet, Failed> {
    let (_, end) = ends(scene);
    let seconds = (clip(scene).frame_count() - 1) as f64 / 30.0;
    let timed = (scene.constraints.len() > 3).then_some(seconds);
    feet(&pull(scene, &[(end, timed)], none())?.outcome)
}

fn stretched(folder: &Path, name: &str, tolerance: f64) -> Result<(), Failed> {
    let scene = read(folder, name, None, false)?;
    let pulled = pull(&scene, &away(&scene, 2.0), settings())?;
    whole_cycles(&scene, &pulled)?;
    let last = pulled.steps[pulled.steps.len() - 1];
    let more = (last.frames - pulled.steps[0].frames) as f64 / cycle(clip(&scene))?;
    check((3.0..=4.0).contains(&more.round()), || format!("{more} cycles more"))?;
    let (own, found) = (own_feet(&scene)?, feet(&pulled.outcome)?);
    let bent = feet(&pull(&scene, &away(&scene, 2.0), none())?.outcome)?;
    let slide = foot_slide_working(clip(&scene)).ok_or("a walk has contacts")?;
    let shown = shown_slide(&pulled.outcome.scene.characters[0].track);
    let mut pinned = pulled.outcome.clone();
    pinned.scene.full_body.plants = Plants::Pinned;
    let pinned = feet(&pinned)?;
    let told = || format!("own {own:?} ({slide}), found {found:?} of {shown}, {pinned:?}, bent {bent:?}");
    check((found.stride / own.stride - 1.0).abs() <= tolerance, told)?;
    check(found.before <= SLIDE * slide && found.before <= SLIDE_LEFT * bent.before, told)?;
    check(pinned.after <= slide, told)?;
    check(found.after <= CLEANED * shown, told)
}

fn shortened(folder: &Path, name: &str) -> Result<(), Failed> {
    let scene = read(folder, name, None, false)?;
    let pulled = pull(&scene, &away(&scene, 0.6), settings())?;
    whole_cycles(&scene, &pulled)
}

fn lasting(folder: &Path, (name, range): (&str, Option<(u32, u32)>), factor: f64) -> Result<(), Failed> {
    let scene = read(folder, name, range, true)?;
    let pulled = pull(&scene, &later(&scene, factor), settings())?;
    let clip = clip(&scene);
    let counts = shown(&pulled.outcome.scene);
    for frame in (0..clip.frame_count()).filter(|frame| counts.get(frame) != Some(&1)) {
        check(clip.stationary[frame], || format!("frame {frame} walks: {:?}", pulled.outcome.log))?;
    }
    let track = pulled.outcome.tracks[0];
    let (own, found) = (own_feet(&scene)?, feet(&pulled.outcome)?);
    let told = || format!("{track:?} own {own:?} found {found:?}");
    check((track.length - 1.0).abs() <= LENGTH_LEFT && (track.time - 1.0).abs() <= TIME_LEFT, told)?;
    check((found.stride / own.stride - 1.0).abs() <= LENGTH_LEFT && track.copies <= COPIES, told)?;
    all_seams(&scene, &pulled)
}

/// The end of a scene 3 m to the left of where it is, in steps of 25 cm.
fn aside(scene: &Scene) -> Vec<End> {
    let (start, end) = ends(scene);
    let left = c64::i() * (end - start) / (end - start).norm();
    (0..=12).map(|step| (end + left * 0.25 * f64::from(step), None)).collect()
}

fn sideways(folder: &Path) -> Result<(), Failed> {
    let scene = read(folder, TURNING, None, false)?;
    let pulled = pull(&scene, &aside(&scene), settings())?;
    let (track, found) = (pulled.outcome.tracks[0], feet(&pulled.outcome)?);
    let told = || format!("{track:?} {found:?} {:?}", pulled.outcome.log);
    check(track.turns < SEAM_TURNS && found.before <= TURN_SLIDE, told)?;
    all_seams(&scene, &pulled)?;
    let without = pull(&scene, &aside(&scene), DiscreteSettings { turn_weight: 0.0, ..settings() })?;
    let lost = without.outcome.tracks[0];
    check(lost.turns > LOST_TURN, || format!("{lost:?} {:?}", without.outcome.log))
}

fn stylised(folder: &Path) -> Result<(), Failed> {
    let scene = read(folder, STYLISED, None, false)?;
    let pulled = pull(&scene, &away(&scene, 1.1), settings())?;
    let edited = &pulled.outcome.edit.characters[0];
    let turned = |frame: usize| edited.turns.at(frame as f64);
    for frame in 1..edited.positions.len() {
        let turn = wrap(turned(frame) - turned(frame - 1)).abs();
        check(turn < HEADING, || format!("{turn} at {frame}"))?;
    }
    Ok(())
}

fn duplications(folder: &Path) -> Result<(), Failed> {
    let mut state: u64 = 1;
    let mut random = |below: usize| {
        // SplitMix64.
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut mixed = (state ^ (state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        usize::try_from((mixed ^ (mixed >> 31)) % below as u64).unwrap_or(0)
    };
    let names = WALKS.iter().map(|(name, _)| *name).chain([TURNING, STYLISED, HALTS[1].0]);
    let scenes: Vec<Scene> = names.map(|name| read(folder, name, None, false)).collect::<Result<_, _>>()?;
    let settings = settings();
    let mut tried = 0;
    while tried < DUPLICATIONS {
        let scene = &scenes[random(scenes.len())];
        let (clip, track) = (clip(scene), &scene.characters[0].track);
        let graph = motion_graph(std::slice::from_ref(clip), &GraphSettings::default());
        let pairs: Vec<(usize, usize)> = graph
            .pairs()
            .map(|(i, j, _)| (graph.place(i).1.as_usize(), graph.place(j).1.as_usize()))
            .map(|(i, j)| (i.min(j), i.max(j)))
            .filter(|(i, j)| (settings.shortest..=settings.longest).contains(&(j - i)))
            .filter(|(i, j)| {
                *j + 1 >= settings.shortest_run && clip.frame_count() - i > settings.shortest_run
            })
            .collect();
        let (i, j) = pairs[random(pairs.len())];
        let told = |failed: Failed| format!("{} {i}..{j}: {failed:?}", clip.name);
        seams(&usual(clip), &track.spliced(&Splice::duplicate(i, j))).map_err(told)?;
        tried += 1;
    }
    Ok(())
}

const HEAD: &str = "\
| clip | drag | frames | L′/L | time | stride | slide | seam turns | copies |
|---|---|---|---|---|---|---|---|---|
";

fn table(folder: &Path) -> Result<(), Failed> {
    let mut rows = String::from(HEAD);
    for (name, _) in WALKS {
        for factor in [1.2, 1.5, 2.0, 0.7] {
            let scene = read(folder, name, None, false)?;
            row(&mut rows, &scene, (stem(name), &format!("space × {factor}")), &away(&scene, factor))?;
        }
    }
    for factor in [1.5, 2.0] {
        let name = "bvh/snu_walk_stop_walk.bvh";
        let scene = read(folder, name, Some((0, 150)), false)?;
        row(&mut rows, &scene, (stem(name), &format!("space × {factor}")), &away(&scene, factor))?;
    }
    for (name, range) in HALTS.into_iter().chain([(STYLISED, None)]) {
        for factor in [1.2, 1.5, 0.8] {
            let scene = read(folder, name, range, true)?;
            row(&mut rows, &scene, (stem(name), &format!("time × {factor}")), &later(&scene, factor))?;
        }
    }
    let scene = read(folder, TURNING, None, false)?;
    row(&mut rows, &scene, (stem(TURNING), "3 m aside"), &aside(&scene))?;
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/discrete_editing.md");
    let text = fs::read_to_string(&path)?;
    let (before, rest) = text.split_once(HEAD).ok_or("the docs have the table")?;
    let end = rest.lines().take_while(|line| line.starts_with('|')).map(|line| line.len() + 1).sum();
    let written = format!("{before}{rows}{}", &rest[end..]);
    if std::env::var_os("COTILLION_WRITE_DOCS").is_some() {
        fs::write(&path, &written)?;
    }
    check(fs::read_to_string(&path)? == written, || format!("the table should be\n{rows}"))
}

fn row(rows: &mut String, scene: &Scene, (name, drag): (&str, &str), to: &[End]) -> Result<(), Failed> {
    let pulled = pull(scene, to, settings())?;
    let (own, found) = (own_feet(scene)?, feet(&pulled.outcome)?);
    let bent = feet(&pull(scene, to, none())?.outcome)?;
    let (track, steps) = (pulled.outcome.tracks[0], &pulled.steps);
    let _ = writeln!(
        rows,
        "| {name} | {drag} | {}→{} | {:.3} | {:.3} | {:.2} | {:.3} / {:.3}, {:.3} / {:.3} | {:.0}° | {} |",
        clip(scene).frame_count(),
        steps[steps.len() - 1].frames,
        track.length,
        track.time,
        found.stride / own.stride,
        own.before,
        found.before,
        found.after,
        bent.before,
        track.turns.to_degrees(),
        track.copies,
    );
    Ok(())
}
