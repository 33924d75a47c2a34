//! Feet of captured walks, runs and turns stand as they must after their paths are bent and stretched, and stay as they
//! are where nothing is edited.
//!
//! Looks in `$COTILLION_MOCAP`, else in `../shared/mocap` beside the checkout; where neither exists every test is ignored,
//! by name. With `$COTILLION_TABLE` set, every measure is printed.

mod bend;
#[path = "../captures/mod.rs"]
mod captures;
mod clips;
mod hands;
mod measure;
mod roll;
mod still;
mod stride;
mod tear;

use std::f64::consts::FRAC_PI_2;
use std::path::Path;

use bend::{Bend, bent};
use captures::{Run, mocap_folder};
use clips::{CLIPS, ON_HANDS, OTHERS, RAISED, Stretch, WINDING, Walk, load, stretches};
use cotillion::full_body::{BodyInput, Jerks, PlantMode, PlantedPoint, Refined, Seams, refine};
use cotillion::skeleton::Pose;
use hands::{bears_on_hands, reaches};
use libtest_mimic::{Arguments, Failed};
use measure::{
    below_ground, beyond_limits, bone_change, height_change, knee_acceleration, largest_change, slide,
};
use roll::{ROLLS, rolls_too_far_to_be_held};
use still::{
    bearing_frames, hardly_changes, hardly_changes_at_own_rate, held_points, lands_softly, stands_all_along,
};
use stride::{STRIDES, strides_too_far_to_be_held};
use tear::{Strides, factors, is_torn};

/// Bent by 90° to either side, stretched by ±30 %, and both.
const EDITS: [Bend; 6] = [
    Bend { turn: FRAC_PI_2, stretch: 1.0 },
    Bend { turn: -FRAC_PI_2, stretch: 1.0 },
    Bend { turn: 0.0, stretch: 1.3 },
    Bend { turn: 0.0, stretch: 0.7 },
    Bend { turn: FRAC_PI_2, stretch: 1.3 },
    Bend { turn: FRAC_PI_2, stretch: 0.7 },
];

/// Asked for: a millimetre, of drift over a contact (beyond the captured one, or at all) and of any shortfall.
const DRIFT: f64 = 1e-3;
/// Most captures have so many frames a second.
const OWN_RATE: f64 = 120.0;
/// Left out at its own rate. Bent and stretched by 1.3, its knee leaves the last stance before the dive at 29°, straightening
/// by 1200°/s; to stop before it is straight takes 1.3 times the hardest captured jerk evenly from the first moment
/// on, and what rounds knees off does 2.9 times.
const DIVE: &str = "amc/cmu_127_23_run_dive_over_and_roll_run.amc";
/// Rounding of a bone's length, metres.
const BONES: f64 = 1e-9;
/// Knees may be jerked so many times harder than in the capture.
const KNEES: f64 = 1.5;
/// Rounding of a mean slide, m/s.
const SLIDE: f64 = 1e-6;
/// Joint angles of an edit that changes nothing stay within this, radians.
const UNTOUCHED: f64 = 1e-6;
/// Largest change of a joint where feet are pinned and nothing else is edited, radians: 5°.
const PINNED_CHANGE: f64 = 5.0 * std::f64::consts::PI / 180.0;
/// Share of the time of contacts in which neither heel nor toe may be held, where feet are pinned: landings and take-offs are most
/// of the contacts of who runs and jogs.
const OFF_POINTS: f64 = 0.53;
/// Feet stay above the lowest captured place but for this, metres: captured feet are no more exact.
const GROUND: f64 = 5e-3;

/// Contacts that are not held from end to end where all are to be: some frames are let go, so that no knee is jerked more than half
/// as hard again as the capture does any. Who sits down on a stool there has a hip that is a centimetre aside in one captured frame.
const LET_GO: &str = "amc/cmu_14_27_sit_on_high_stool_and_stand_up.amc";
/// There at least so much of the contacts is held, by points and frames.
const MOSTLY_HELD: f64 = 0.94;

fn main() {
    let arguments = Arguments::from_args();
    let folder = mocap_folder();
    let mut trials = Vec::new();
    let mut push = |name: String, run: Run, file: &'static str| {
        trials.push(captures::trial(folder.as_deref(), name, run, file));
    };
    for file in CLIPS.into_iter().chain(OTHERS) {
        push(
            format!("{file} keeps its plants as captured when bent and stretched"),
            stands_as_captured,
            file,
        );
        push(format!("{file} stands still where pinned when bent and stretched"), stands_pinned, file);
        push(format!("{file} reaches out with its hands when bent and stretched"), reaches, file);
        push(format!("{file} stays untouched where nothing is edited"), stays_untouched, file);
    }
    for (file, _) in ON_HANDS.into_iter().filter(|(file, _)| !CLIPS.contains(file)) {
        push(
            format!("{file} keeps its plants as captured when bent and stretched"),
            stands_as_captured,
            file,
        );
        push(format!("{file} stands still where pinned when bent and stretched"), stands_pinned, file);
        push(format!("{file} stays untouched where nothing is edited"), stays_untouched, file);
    }
    for (file, _) in ON_HANDS {
        push(format!("{file} bears on its hands"), bears_on_hands, file);
    }
    for file in RAISED {
        push(format!("{file} stands off the floor"), stands_off_the_floor, file);
    }
    for file in CLIPS.into_iter().chain(OTHERS) {
        push(
            format!("{file} stands still all along its contacts when bent and stretched"),
            stands_whole,
            file,
        );
    }
    for file in CLIPS {
        push(format!("{file} stands still all along where nothing is edited"), stands_all_along, file);
    }
    for file in CLIPS.into_iter().filter(|file| file.contains("cmu_16") && file.contains("walk")) {
        push(format!("{file} hardly changes when pinned"), hardly_changes, file);
        push(format!("{file} lands softly where held all along at 120 frames a second"), lands_softly, file);
        push(
            format!("{file} hardly changes when pinned at 120 frames a second"),
            hardly_changes_at_own_rate,
            file,
        );
    }
    for file in CLIPS.into_iter().filter(|file| file.contains("snu_")) {
        push(format!("{file} hardly changes when pinned"), hardly_changes, file);
    }
    push(
        format!("{ROLLS} rolls over its feet too far to hold whole contacts within 5 degrees"),
        rolls_too_far_to_be_held,
        ROLLS,
    );
    for file in STRIDES {
        push(
            format!("{file} strides too far to hold whole contacts within 5 degrees"),
            strides_too_far_to_be_held,
            file,
        );
    }
    for file in CLIPS.into_iter().filter(|file| file.contains(".amc") && *file != DIVE) {
        push(format!("{file} keeps its plants at 120 frames a second"), stands_at_own_rate, file);
    }
    for file in CLIPS {
        push(format!("{file} can be bent as a whole unless it winds"), is_bent_whole, file);
    }
    libtest_mimic::run(&arguments, trials).exit();
}

fn refined(stretch: &Stretch, moved: &[Pose], mode: PlantMode) -> Refined {
    let input = BodyInput {
        times: stretch.times.clone(),
        rest: stretch.rest.to_vec(),
        moved: moved.to_vec(),
        contacts: stretch.contacts.to_vec(),
        effectors: Vec::new(),
        seams: Seams::default(),
        source: Jerks::of(stretch.walk.skeleton(), &stretch.walk.times, &stretch.walk.poses),
    };
    refine(stretch.walk.skeleton(), &input, mode)
}

fn stands_as_captured(folder: &Path, file: &str) -> Result<(), Failed> {
    stands(&load(folder, file)?, PlantMode::AsCaptured)
}

fn stands_pinned(folder: &Path, file: &str) -> Result<(), Failed> {
    stands(&load(folder, file)?, PlantMode::Pinned)
}

fn stands_whole(folder: &Path, file: &str) -> Result<(), Failed> {
    stands(&load(folder, file)?, PlantMode::Whole)
}

fn stands_at_own_rate(folder: &Path, file: &str) -> Result<(), Failed> {
    stands(&load(folder, file)?.at_rate(OWN_RATE), PlantMode::AsCaptured)
}

fn stands(walk: &Walk, mode: PlantMode) -> Result<(), Failed> {
    let captured_knees = knee_acceleration(walk.skeleton(), &walk.times, &walk.poses);
    let mut faults = Vec::new();
    for edit in EDITS {
        if is_torn_whole(walk, edit) {
            faults.extend(stands_within_reach(walk, edit, mode));
        }
        for frames in edited(walk, edit) {
            let stretch = walk.stretch(frames);
            let moved = bent(&stretch, edit);
            let result = refined(&stretch, &moved, mode);
            let mut found = Measures::of(&stretch, &result, mode, captured_knees);
            if walk.working.name == LET_GO && found.held > MOSTLY_HELD {
                (found.unheld, found.whole_drift) = (0, 0.0);
            }
            tell(&format!("{} {mode:?} {frames:?} {} {found:?}", walk.working.name, edit.name()));
            faults.extend(
                found.faults().into_iter().map(|fault| format!("{frames:?} {}: {fault}", edit.name())),
            );
        }
    }
    if faults.is_empty() { Ok(()) } else { Err(faults.join("\n").into()) }
}

/// What of a torn clip holds all the same, as a whole: bones, the ground, and every plant that legs reach.
fn stands_within_reach(walk: &Walk, edit: Bend, mode: PlantMode) -> Vec<String> {
    let stretch = whole(walk);
    let moved = bent(&stretch, edit);
    let result = refined(&stretch, &moved, mode);
    let strides = Strides::of(&stretch, &moved);
    let mut found = Measures::of(&stretch, &result, mode, f64::INFINITY);
    let allowed =
        |plant: &PlantedPoint| if mode != PlantMode::AsCaptured { 0.0 } else { plant.captured_drift };
    let reached: Vec<_> = result.report.plants.iter().filter(|plant| strides.reach(plant)).collect();
    found.drift = reached.iter().map(|plant| plant.drift - allowed(plant)).fold(0.0, f64::max);
    if mode == PlantMode::AsCaptured {
        let holds = |plant: &PlantedPoint, frame: usize| (plant.first..=plant.last).contains(&frame);
        let counts = |point, frame| reached.iter().any(|plant| plant.point == point && holds(plant, frame));
        found.height = height_change(&stretch, &result.poses, counts);
    }
    (found.unheld, found.whole_drift) = (0, 0.0);
    let too_long = strides.are_too_long();
    tell(&format!(
        "{} torn, {}: {:?}, feet beyond reach: {too_long}",
        walk.working.name,
        edit.name(),
        factors(&stretch, edit)
    ));
    if too_long {
        (found.slide, found.shortfall) = (0.0, 0.0);
    }
    found.faults().into_iter().map(|fault| format!("torn, {}: {fault}", edit.name())).collect()
}

/// The whole clip.
fn whole(walk: &Walk) -> Stretch<'_> {
    walk.stretch((0, walk.poses.len() - 1))
}

fn is_torn_whole(walk: &Walk, edit: Bend) -> bool {
    is_torn(&whole(walk), edit)
}

/// First and last frames of what is edited at once: all of a clip, but of one that would be torn the stretches that have a
/// direction.
fn edited(walk: &Walk, edit: Bend) -> Vec<(usize, usize)> {
    if is_torn_whole(walk, edit) { stretches(&walk.poses) } else { vec![(0, walk.poses.len() - 1)] }
}

fn is_bent_whole(folder: &Path, file: &str) -> Result<(), Failed> {
    let walk = load(folder, file)?;
    let torn = EDITS.into_iter().filter(|edit| is_torn_whole(&walk, *edit)).count();
    match (WINDING.contains(&file), torn) {
        (false, 0) | (true, 1..) => Ok(()),
        (_, torn) => Err(format!("torn by {torn} edits").into()),
    }
}

/// What must hold of a result.
#[derive(Debug)]
struct Measures {
    /// Largest drift of a plant beyond what is allowed to it, metres.
    drift: f64,
    /// Largest change of the height of a planted point, metres; nothing where feet are pinned.
    height: f64,
    /// Mean slide beyond the capture's, m/s.
    slide: f64,
    /// Metres.
    bones: f64,
    /// Knee acceleration by the capture's.
    knees: f64,
    /// Metres.
    below_ground: f64,
    /// Largest of the report, metres.
    shortfall: f64,
    /// Share of the frames at which a foot bears in which its heel or its toe is planted.
    on_a_point: f64,
    /// Contacts that are not held from their first frame to their last, and how far any drifts, metres; none where feet need not
    /// be.
    unheld: usize,
    whole_drift: f64,
    /// Share of the points that bear, by frames, which are planted.
    held: f64,
}

impl Measures {
    fn of(stretch: &Stretch, result: &Refined, mode: PlantMode, captured_knees: f64) -> Self {
        let skeleton = stretch.walk.skeleton();
        let allowed = |captured: f64| if mode != PlantMode::AsCaptured { 0.0 } else { captured };
        let drifts = result.report.plants.iter().map(|plant| plant.drift - allowed(plant.captured_drift));
        let whole = if mode == PlantMode::Whole { &result.report.contacts[..] } else { &[] };
        let slide = |poses: &[Pose]| slide(skeleton, poses, stretch.contacts);
        Self {
            drift: drifts.fold(0.0, f64::max),
            height: match mode {
                PlantMode::AsCaptured => height_change(stretch, &result.poses, |_, _| true),
                PlantMode::Pinned | PlantMode::Whole => 0.0,
            },
            slide: slide(&result.poses) - slide(stretch.rest),
            bones: bone_change(skeleton, stretch.rest, &result.poses),
            knees: knee_acceleration(skeleton, &stretch.times, &result.poses) / captured_knees,
            below_ground: below_ground(skeleton, stretch.rest, &result.poses),
            shortfall: result.report.shortfalls.iter().map(|miss| miss.metres).fold(0.0, f64::max),
            on_a_point: bearing_frames(&result.planted) as f64 / bearing_frames(stretch.contacts) as f64,
            unheld: whole.iter().filter(|contact| contact.held < 1.0).count(),
            whole_drift: whole.iter().map(|contact| contact.drift).fold(0.0, f64::max),
            held: held_points(&result.planted) as f64 / held_points(stretch.contacts) as f64,
        }
    }

    fn faults(&self) -> Vec<String> {
        let checks = [
            ("drift", self.drift, DRIFT),
            ("height", self.height, DRIFT),
            ("slide", self.slide, SLIDE),
            ("bones", self.bones, BONES),
            ("knees", self.knees, KNEES),
            ("below the ground", self.below_ground, GROUND),
            ("shortfall", self.shortfall, DRIFT),
            ("time on no point that stands", 1.0 - self.on_a_point, OFF_POINTS),
            ("contacts let go of", self.unheld as f64, 0.0),
            ("whole contacts drift", self.whole_drift, DRIFT),
        ];
        let over = checks.into_iter().filter(|(_, found, most)| found > most);
        over.map(|(name, found, most)| format!("{name} {found:.5} above {most}")).collect()
    }
}

/// Some contact is on ground a hand's breadth or more above the floor.
fn stands_off_the_floor(folder: &Path, file: &str) -> Result<(), Failed> {
    let walk = load(folder, file)?;
    let highest = walk.working.grounds.iter().map(|ground| ground.height).fold(0.0, f64::max);
    if highest > HANDBREADTH { Ok(()) } else { Err(format!("at most {highest} m above the floor").into()) }
}

/// Metres.
const HANDBREADTH: f64 = 0.1;

fn stays_untouched(folder: &Path, file: &str) -> Result<(), Failed> {
    let walk = load(folder, file)?;
    let stretch = walk.stretch((0, walk.poses.len() - 1));
    let result = refined(&stretch, stretch.rest, PlantMode::AsCaptured);
    if result.poses != stretch.rest {
        return Err("some bits change".into());
    }
    let beyond = beyond_limits(walk.skeleton(), stretch.rest);
    if beyond > 0.0 {
        return Err(format!("limits are {beyond} rad narrower than the capture").into());
    }
    // A place and a turn change nothing either, but for rounding.
    let placed = bend::placed(stretch.rest, 0.7);
    let result = refined(&stretch, &placed, PlantMode::AsCaptured);
    let change = largest_change(&placed, &result.poses);
    if change < UNTOUCHED {
        Ok(())
    } else {
        Err(format!("placed and turned, a joint turns by {change:e}").into())
    }
}

#[expect(clippy::print_stderr, reason = "the table is asked for")]
fn tell(line: &str) {
    if std::env::var_os("COTILLION_TABLE").is_some() {
        eprintln!("{line}");
    }
}
