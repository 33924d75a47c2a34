//! Captured jumps fly as bodies do after the flight pass, and change hardly.
//!
//! Looks in `$COTILLION_MOCAP`, else in `../shared/mocap` beside the checkout; where neither exists every test is ignored,
//! by name.

#[path = "../captures/mod.rs"]
mod captures;
mod glitch;
mod jumps;
#[path = "../captures/performance.rs"]
mod performance;

use std::path::Path;

use captures::{Run, mocap_folder};
use cotillion::clip::Clip;
use cotillion::clip::contacts::BodyPoint;
use cotillion::physics::flight::report::{FAR_TURN_DEG, FlightFacts};
use cotillion::physics::flight::{FlightSettings, Flown, MomentumTarget, fly, halves_in_turn};
use cotillion::physics::ground::{GroundSettings, ground_pass};
use cotillion::physics::posed::PosedClip;
use cotillion::physics::stages::{Bearer, Phase};
use cotillion::physics::zmp::DistanceSummary;
use glam::DVec3;
use jumps::on_arc;
use libtest_mimic::{Arguments, Failed};
use performance::{Performance, load, load_as, verdict};

const FORWARD: &str = "amc/cmu_16_05_forward_jump.amc";
const FLIP: &str = "bvh/mass_backflip.bvh";
const HOPS: &str = "amc/cmu_49_02_jump_up_and_down_hop_on_one_foot.amc";

/// Captured jumps, and how far the whole body may turn, degrees.
const JUMPS: [(&str, f64); 7] = [
    (FORWARD, 1.0),
    ("amc/cmu_16_03_high_jump_in_place.amc", 5.0),
    ("amc/cmu_02_04_jump_then_balance_on_one_leg.amc", 5.0),
    (HOPS, 5.0),
    ("amc/cmu_127_21_run_jump_stop_run.amc", 5.0),
    ("amc/cmu_127_25_run_jump_over_obstacle.amc", 5.0),
    ("bvh/snu_broad_jump.bvh", 5.0),
];

/// The flight of [`HOPS`] that turns farther, first frame: see [`glitch`].
const GLITCH: usize = 751;
/// By so much, degrees.
const GLITCH_TURN: f64 = 8.0;

/// Of the momentum.
const MOMENTUM_KEPT: f64 = 1e-6;
/// Metres.
const ON_PARABOLA: f64 = 1e-6;
/// What planted feet may move, metres.
const PLANTED: f64 = 1e-4;

fn main() {
    let arguments = Arguments::from_args();
    let folder = mocap_folder();
    let trial =
        |name: String, run: Run, file: &'static str| captures::trial(folder.as_deref(), name, run, file);
    let mut trials = vec![
        trial("bent jumps fly as bodies do".to_owned(), bent_fly, FORWARD),
        trial("the back flip flies, and is doubtful".to_owned(), flip_flies, FLIP),
        trial("a jump declared too slow is left whole".to_owned(), too_slow_is_whole, FORWARD),
        trial("a jump in another unit is left whole".to_owned(), too_large_is_whole, FORWARD),
        trial("49_02 has a glitch of its own".to_owned(), glitch::is_captured, HOPS),
        trial("49_02 without its glitch turns as others do".to_owned(), glitch::is_of_one_thigh, HOPS),
        trial("halves may turn first".to_owned(), halves_fly, FORWARD),
        trial("planted feet stay beside a turned landing".to_owned(), feet_stay, FORWARD),
        trial(
            "a ground pass first leaves the borders better than they came".to_owned(),
            borders_get_better,
            FORWARD,
        ),
        trial("the same comes out twice".to_owned(), same_twice, FORWARD),
    ];
    for (file, _) in JUMPS {
        trials.push(trial(format!("{file} flies as bodies do"), flies, file));
    }
    libtest_mimic::run(&arguments, trials).exit();
}

fn flown(jump: &Performance, settings: &FlightSettings) -> Result<Flown, Failed> {
    Ok(fly(&jump.clip, &jump.body, &jump.stages, settings)?)
}

/// Whether a flight is exact, and its borders are what they were.
fn is_exact(facts: &FlightFacts) -> bool {
    let momentum = match facts.relative_momentum_errors() {
        Some([_, after]) => after < MOMENTUM_KEPT,
        None => facts.momentum_errors[1] < MOMENTUM_KEPT,
    };
    momentum && facts.center_errors[1] < ON_PARABOLA && facts.borders_kept && facts.border_turns == [0.0; 2]
}

/// Frames on the ground that changed.
fn changed_ground(jump: &Performance, flown: &Clip) -> usize {
    let joints = jump.clip.skeleton.joints.len();
    let is_same = |frame: usize| {
        let own = frame * joints..(frame + 1) * joints;
        jump.clip.root_positions[frame] == flown.root_positions[frame]
            && jump.clip.rotations[own.clone()] == flown.rotations[own]
    };
    let on_ground = (0..flown.frame_count()).filter(|frame| jump.stages.phases[*frame] != Phase::Flight);
    on_ground.filter(|frame| !is_same(*frame)).count()
}

fn flies(folder: &Path, file: &str) -> Result<(), Failed> {
    let jump = load(folder, file)?;
    let flown = flown(&jump, &FlightSettings::default())?;
    let (_, farthest) = JUMPS.iter().find(|(name, _)| *name == file).ok_or("no expectation")?;
    let mut faults = Vec::new();
    for facts in &flown.report.flights {
        let is_glitch = file == HOPS && facts.first == GLITCH;
        let farthest = if is_glitch { GLITCH_TURN } else { *farthest };
        let is_small = facts.largest_turn.to_degrees() < farthest;
        let is_told = facts.momentum_break.is_some() == is_glitch;
        let is_fine =
            is_exact(facts) && is_small && is_told && facts.newton_steps <= 2 && !facts.is_doubtful();
        if !is_fine || facts.to_string().contains("doubtful") {
            faults.push(facts.to_string());
        }
    }
    if changed_ground(&jump, &flown.clip) > 0 || flown.report.flights.is_empty() {
        faults.push("the ground changed, or nothing flew".to_owned());
    }
    verdict(faults)
}

/// Mean distance, metres.
fn mean(summary: Option<DistanceSummary>) -> Result<f64, Failed> {
    Ok(summary.ok_or("nothing counts beside the flight")?.mean)
}

/// Zero moment points beside the flight get no farther away than this many times.
const BESIDE: f64 = 3.0;

fn bent_fly(folder: &Path, file: &str) -> Result<(), Failed> {
    let mut faults = Vec::new();
    for degrees in [30.0, 60.0, -30.0, -60.0] {
        let jump = on_arc(load(folder, file)?, degrees);
        let flown = flown(&jump, &FlightSettings::default())?;
        let [facts] = &flown.report.flights[..] else { return Err("one flight".into()) };
        let [before, after] = [mean(facts.beside[0])?, mean(facts.beside[1])?];
        // Captured on R 1: 5.4 degrees.
        let is_small = facts.largest_turn.to_degrees() < 6.0 && facts.newton_steps <= 2;
        if !is_exact(facts) || !is_small || after > BESIDE * before || changed_ground(&jump, &flown.clip) > 0
        {
            faults.push(format!("{degrees}°: {facts}; beside {before} {after}"));
        }
    }
    verdict(faults)
}

/// Flights disturb the ground beside them; where that was put right first, zero moment points end nearer than they started.
fn borders_get_better(folder: &Path, file: &str) -> Result<(), Failed> {
    let mut faults = Vec::new();
    for degrees in [30.0, 60.0, -30.0, -60.0] {
        let jump = on_arc(load(folder, file)?, degrees);
        let alone = flown(&jump, &FlightSettings::default())?.report.flights;
        let (clip, _) = ground_pass(&jump.clip, &jump.body, &jump.stages, None, &GroundSettings::default())?;
        let after = flown(&Performance { clip, ..jump }, &FlightSettings::default())?.report.flights;
        let starts = [mean(alone[0].beside[0])?, mean(alone[0].beside_judged[0])?];
        let ends = [mean(after[0].beside[1])?, mean(after[0].beside_judged[1])?];
        if ends[0] > starts[0] || ends[1] > starts[1] || !is_exact(&after[0]) {
            faults.push(format!("{degrees}°: {starts:?} {ends:?} {}", after[0]));
        }
    }
    verdict(faults)
}

/// Largest step of the root from frame to frame, metres.
fn largest_step(clip: &Clip) -> f64 {
    clip.root_positions.windows(2).map(|pair| pair[0].distance(pair[1])).fold(0.0, f64::max)
}

/// No step of the root grows beyond this many times the largest that was captured.
const UNBROKEN: f64 = 1.5;

/// Exact, doubtful, and not broken: no frame under ground, no leap.
fn is_whole(jump: &Performance, flown: &Flown) -> Result<FlightFacts, Failed> {
    let longest = flown.report.flights.iter().max_by_key(|facts| facts.last - facts.first);
    let facts = longest.ok_or("no flight")?.clone();
    let steps = [&jump.clip, &flown.clip].map(largest_step);
    let is_fine = flown.report.flights.iter().all(is_exact)
        && facts.is_doubtful()
        && facts.to_string().contains("labels, rate or scale doubtful")
        && steps[1] < UNBROKEN * steps[0]
        && changed_ground(jump, &flown.clip) == 0;
    if is_fine { Ok(facts) } else { Err(format!("{facts}; steps of {steps:?}").into()) }
}

fn flip_flies(folder: &Path, file: &str) -> Result<(), Failed> {
    let jump = load(folder, file)?;
    let facts = is_whole(&jump, &flown(&jump, &FlightSettings::default())?)?;
    let check = facts.check.ok_or("no claim")?;
    let rate = check.mending_rate.unwrap_or(0.0);
    let is_told = (56.0..=60.0).contains(&check.gravity) && (49.0..=50.0).contains(&rate);
    if !is_told || facts.gravity != check.gravity || facts.newton_steps > 3 {
        return Err(facts.to_string().into());
    }
    let says = format!("more than {FAR_TURN_DEG:.0}° are doubtful");
    if facts.momentum_break.is_none() || !facts.turns_far() || !facts.to_string().contains(&says) {
        return Err("no word of the turn".into());
    }
    // True gravity at the wrong rate buries the body, but as exactly as asked for.
    let settings = FlightSettings { trusts_fall: false, ..FlightSettings::default() };
    let buried = flown(&jump, &settings)?;
    let is_fine = buried.report.flights.iter().all(|facts| is_exact(facts) && facts.gravity == 9.81);
    if is_fine { Ok(()) } else { Err("by true gravity".into()) }
}

fn too_slow_is_whole(folder: &Path, file: &str) -> Result<(), Failed> {
    let jump = load_as(folder, file, Some(60.0), 1.0)?;
    let facts = is_whole(&jump, &flown(&jump, &FlightSettings::default())?)?;
    let check = facts.check.ok_or("no claim")?;
    let rate = check.mending_rate.unwrap_or(0.0);
    let is_told = (check.gravity - 2.4).abs() < 0.1 && (rate - 120.0).abs() < 1.0;
    if is_told && facts.largest_turn.to_degrees() < 1.0 { Ok(()) } else { Err(facts.to_string().into()) }
}

fn too_large_is_whole(folder: &Path, file: &str) -> Result<(), Failed> {
    let jump = load_as(folder, file, None, 2.54)?;
    let facts = is_whole(&jump, &flown(&jump, &FlightSettings::default())?)?;
    let check = facts.check.ok_or("no claim")?;
    let scale = check.mending_scale.unwrap_or(0.0);
    // 24.3 was measured by a whole run of labels, 24.9 is true.
    let is_told = (check.gravity - 24.3).abs() < 1.0 && (scale * 2.54 - 1.0).abs() < 0.015;
    if is_told { Ok(()) } else { Err(facts.to_string().into()) }
}

fn halves_fly(folder: &Path, file: &str) -> Result<(), Failed> {
    let mut faults = Vec::new();
    for degrees in [0.0, 60.0] {
        let jump = load(folder, file)?;
        let jump = if degrees == 0.0 { jump } else { on_arc(jump, degrees) };
        let whole = flown(&jump, &FlightSettings::default())?;
        let halves = flown(&jump, &FlightSettings { steps: halves_in_turn(), ..FlightSettings::default() })?;
        let [own, other] = [&halves, &whole].map(|flown| &flown.report.flights[0]);
        // Halves take over what the whole body would have to do.
        let is_less = own.largest_turn < other.largest_turn;
        if !is_exact(own) || !is_less || changed_ground(&jump, &halves.clip) > 0 {
            faults.push(format!("{degrees}°: {own}\n{other}"));
        }
    }
    verdict(faults)
}

/// World places of the points of soles that bear, of all frames.
fn planted(jump: &Performance, clip: &Clip) -> Vec<(usize, DVec3)> {
    let posed = PosedClip::of(clip);
    let soles = jump.stages.supports.iter().filter(|own| matches!(own.bearer, Bearer::Sole(..)));
    let bearing = soles.flat_map(|own| {
        let frames = own.bears.iter().enumerate().filter(|(_, bears)| **bears).map(|(frame, _)| frame);
        frames.map(|frame| (frame, own.points[0])).collect::<Vec<(usize, BodyPoint)>>()
    });
    bearing.map(|(frame, point)| (frame, point.place(posed.frame(frame)))).collect()
}

fn feet_stay(folder: &Path, file: &str) -> Result<(), Failed> {
    let jump = on_arc(load(folder, file)?, 60.0);
    let flown = flown(&jump, &FlightSettings { target: MomentumTarget::Mean, ..FlightSettings::default() })?;
    let [facts] = &flown.report.flights[..] else { return Err("one flight".into()) };
    let turned = facts.border_turns.iter().sum::<f64>().to_degrees();
    let is_exact = facts.momentum_errors[1] < MOMENTUM_KEPT * facts.momentum.length()
        && facts.center_errors[1] < ON_PARABOLA;
    // Borders themselves belong to the flight.
    let borders = [facts.first - 1, facts.last + 1];
    let pairs = planted(&jump, &jump.clip).into_iter().zip(planted(&jump, &flown.clip));
    let moved = pairs
        .filter(|((frame, _), _)| !borders.contains(frame))
        .map(|((_, before), (_, after))| before.distance(after))
        .fold(0.0, f64::max);
    let reach = 61;
    let far = (0..facts.first.saturating_sub(reach)).chain(facts.last + reach..flown.clip.frame_count());
    let is_far_kept =
        far.into_iter().all(|frame| flown.clip.root_positions[frame] == jump.clip.root_positions[frame]);
    if is_exact && turned > 0.1 && moved < PLANTED && is_far_kept {
        return Ok(());
    }
    Err(format!("{facts}; turned {turned}°, moved {moved} m, far {is_far_kept}").into())
}

fn same_twice(folder: &Path, file: &str) -> Result<(), Failed> {
    let jump = on_arc(load(folder, file)?, 30.0);
    let both = [flown(&jump, &FlightSettings::default())?, flown(&jump, &FlightSettings::default())?];
    if both[0] == both[1] { Ok(()) } else { Err("two results".into()) }
}
