//! Real captures load with the facts their manifest states, and survive being written and read again.
//!
//! Looks in `$COTILLION_MOCAP`, else in `../shared/mocap` beside the checkout; where neither exists every test is ignored,
//! by name.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use cotillion::clip::Clip;

use cotillion::clip::contacts::runs;
use cotillion::clip::inspect::{facts_text, inspect};
use cotillion::clip::note::ReadNote;
use cotillion::clip::read::{Capture, ReadClip, ReadOptions, Up, read};
use cotillion::clip::roles::missing_roles;
use cotillion::clip::stationary::{StationarySettings, stationary};
use cotillion::clip::working::WorkingClip;
use cotillion::export::bvh::to_bvh;
use cotillion::geometry::log;
use cotillion::index::SourceFrame;
use cotillion::metrics::{foot_slide_working, root_path, standing_height};
use libtest_mimic::{Arguments, Failed, Trial};

/// The manifest's files, known by name so that they can be reported as ignored where they are missing.
const FILES: [&str; 29] = [
    "cmu_01_01_forward_jumps",
    "cmu_10_03_kick_ball",
    "cmu_12_01_walk",
    "cmu_131_01_start_walk_stop",
    "cmu_131_01_start_walk_stop_metres",
    "cmu_131_03_start_hop_stop",
    "cmu_18_01_shake_hands_A",
    "cmu_37_01_walk",
    "cmu_60_05_salsa_A",
    "cmu_60_10_salsa_A",
    "cmu_61_05_salsa_B",
    "cmu_61_10_salsa_B",
    "mass_backflip",
    "mass_cart",
    "mass_pirouette",
    "mass_run",
    "mass_walk",
    "snu_broad_jump",
    "snu_cross_walk_90",
    "snu_slope_up_10",
    "snu_slope_up_16",
    "snu_spiral_left_fast",
    "snu_spiral_walk_normal",
    "snu_u_turn",
    "snu_walk_left_90",
    "snu_walk_stop_walk",
    "snu_walk_straight_normal",
    "snu_walk_to_slope_and_back",
    "snu_walk_turn_180",
];

/// Stretches of a clip on working frames, first and last.
type Stretches = &'static [(usize, usize)];

/// Stationary stretches of whole clips, by speed alone and with both feet down as well.
const STATIONARY: [(&str, Stretches, Stretches); 6] = [
    ("snu_walk_straight_normal", &[(0, 51), (189, 199)], &[(0, 53), (176, 199)]),
    ("snu_spiral_walk_normal", &[(0, 77)], &[(0, 77)]),
    ("snu_u_turn", &[(0, 42), (535, 548), (764, 776)], &[(0, 48), (527, 550), (636, 656), (755, 776)]),
    ("cmu_131_01_start_walk_stop", &[(10, 22), (204, 248)], &[(10, 22), (198, 248)]),
    ("cmu_12_01_walk", &[], &[]),
    ("cmu_37_01_walk", &[], &[]),
];

/// Mean speed of the feet in contact before any clean-up, m/s, measured apart from this program.
const FOOT_SLIDES: [(&str, f64); 2] = [("cmu_131_01_start_walk_stop", 0.115), ("snu_u_turn", 0.053)];

/// Ten decimals of a metre and of a degree, through a chain of up to ten joints; asked for are 1e-5.
const ROUND_TRIP_METRES: f64 = 1e-8;
/// See [`ROUND_TRIP_METRES`].
const ROUND_TRIP_DEGREES: f64 = 1e-8;

fn main() {
    let arguments = Arguments::from_args();
    let folder = mocap_folder();
    let trial = |name: String, run: fn(&Path, &str) -> Result<(), Failed>, file: &'static str| {
        let folder = folder.clone();
        let is_missing = folder.is_none();
        Trial::test(name, move || match folder {
            Some(folder) => run(&folder, file),
            None => Err("no captures found".into()),
        })
        .with_ignored_flag(is_missing)
    };
    let mut trials = Vec::new();
    for file in FILES {
        trials.push(trial(format!("{file} loads to the manifest's facts"), facts_agree, file));
        trials.push(trial(format!("{file} is read back as written"), round_trip, file));
        trials.push(trial(format!("{file} can be inspected"), can_be_inspected, file));
    }
    for (file, ..) in STATIONARY {
        trials.push(trial(format!("{file} stands where it stands"), stationary_agrees, file));
    }
    for (file, _) in FOOT_SLIDES {
        trials.push(trial(format!("{file} slides as it does"), slide_agrees, file));
    }
    trials.push(trial("snu_broad_jump flies once".to_owned(), flies_once, "snu_broad_jump"));
    for file in ["snu_slope_up_10", "cmu_12_01_walk", "cmu_37_01_walk", "mass_cart"] {
        trials.push(trial(format!("{file} never flies"), never_flies, file));
    }
    trials.push(trial("odd files end in a clip or an error".to_owned(), odd_files, "odd"));
    libtest_mimic::run(&arguments, trials).exit();
}

fn mocap_folder() -> Option<PathBuf> {
    let beside = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/mocap");
    let set = std::env::var_os("COTILLION_MOCAP").map(PathBuf::from);
    [set, Some(beside)].into_iter().flatten().find(|folder| folder.is_dir())
}

fn load(folder: &Path, file: &str, options: &ReadOptions) -> Result<ReadClip, Failed> {
    let bytes = std::fs::read(folder.join(format!("bvh/{file}.bvh")))?;
    Ok(read(Capture::Bvh(&bytes), file, options)?)
}

/// One row of the manifest, by the names of its columns.
struct Row {
    columns: Vec<String>,
    values: Vec<String>,
}

impl Row {
    fn of(folder: &Path, file: &str) -> Result<Self, Failed> {
        let text = std::fs::read_to_string(folder.join("MANIFEST.tsv"))?;
        let split = |line: &str| line.split('\t').map(str::to_owned).collect::<Vec<_>>();
        let columns = split(text.lines().next().unwrap_or(""));
        let start = format!("bvh/{file}.bvh\t");
        let values = text.lines().find(|line| line.starts_with(&start)).map(split);
        Ok(Self { columns, values: values.ok_or("no row in the manifest")? })
    }

    fn text(&self, column: &str) -> Result<&str, Failed> {
        let at = self.columns.iter().position(|name| name == column).ok_or("no such column")?;
        Ok(self.values.get(at).ok_or("short row")?)
    }

    fn number(&self, column: &str) -> Result<f64, Failed> {
        Ok(self.text(column)?.parse()?)
    }
}

fn facts_agree(folder: &Path, file: &str) -> Result<(), Failed> {
    let row = Row::of(folder, file)?;
    let read = load(folder, file, &ReadOptions::default())?;
    let clip = &read.clip;
    let last = SourceFrame::from_usize(clip.frame_count() - 1);
    let mut faults = Vec::new();
    // (column, found, share of the stated value by which it may differ, and half a unit of its last digit)
    let checks = [
        ("joints", clip.skeleton.joints.len() as f64, 0.0, 0.0),
        ("frames", clip.frame_count() as f64, 0.0, 0.0),
        ("header_fps", read.header_fps, 0.0, 0.005),
        ("unit_to_m", read.unit_to_m, 1e-4, 0.0),
        ("top_joint_height_m", standing_height(clip, SourceFrame(1), last), 0.001, 0.005),
        ("root_ground_path_m", root_path(clip, SourceFrame(1), last), 0.005, 0.005),
    ];
    for (column, found, share, digits) in checks {
        let stated = row.number(column)?;
        if (found - stated).abs() > share * stated.abs() + digits {
            faults.push(format!("{column}: {found}, stated {stated}"));
        }
    }
    let rest_pose = read.notes.iter().any(|note| matches!(note, ReadNote::RestPoseLeftOut { .. }));
    if rest_pose != (row.text("frame0_jump_rest_pose")? == "yes") {
        faults.push(format!("rest pose at frame 0: {rest_pose}"));
    }
    if rest_pose != (clip.usable.0 > SourceFrame(0)) || read.up != Up::Y {
        faults.push(format!("usable {:?}, up {}", clip.usable, read.up));
    }
    let missing = missing_roles(&clip.skeleton);
    if !missing.is_empty() {
        faults.push(format!("missing {missing:?}"));
    }
    if faults.is_empty() { Ok(()) } else { Err(faults.join("; ").into()) }
}

fn round_trip(folder: &Path, file: &str) -> Result<(), Failed> {
    let before = load(folder, file, &ReadOptions::default())?.clip;
    // What is written is in metres with y up; a reader who is not told finds out.
    let back = read(Capture::Bvh(to_bvh(&before).as_bytes()), file, &ReadOptions::default())?;
    let after = &back.clip;
    if back.unit_to_m != 1.0 || back.up != Up::Y || before.usable != after.usable || before.fps != after.fps {
        return Err(
            format!("{} m, {} up, {} fps, {:?}", back.unit_to_m, back.up, after.fps, after.usable).into()
        );
    }
    let (metres, radians) = largest_difference(&before, after);
    let matches = before.skeleton.matches(&after.skeleton);
    if matches && metres < ROUND_TRIP_METRES && radians.to_degrees() < ROUND_TRIP_DEGREES {
        return Ok(());
    }
    let degrees = radians.to_degrees();
    Err(format!("{metres:e} m, {degrees:e} degrees, same skeleton: {matches}").into())
}

/// Largest distance of joints, metres, and largest angle between their rotations, radians.
fn largest_difference(before: &Clip, after: &Clip) -> (f64, f64) {
    let (mut metres, mut radians) = (0.0_f64, 0.0_f64);
    for frame in 0..before.frame_count() {
        let frame = SourceFrame::from_usize(frame);
        let (a, b) = (before.pose(frame), after.pose(frame));
        let places = |clip: &Clip, pose| clip.skeleton.forward_kinematics(pose);
        for (a, b) in places(before, &a).iter().zip(places(after, &b)) {
            metres = metres.max(a.position.distance(b.position));
        }
        for (a, b) in a.rotations.iter().zip(&b.rotations) {
            radians = radians.max(log(a.inverse() * *b).length());
        }
    }
    (metres, radians)
}

fn can_be_inspected(folder: &Path, file: &str) -> Result<(), Failed> {
    let read = load(folder, file, &ReadOptions::default())?;
    let facts = inspect(file, &read);
    let text = facts_text(&facts);
    let last = read.clip.usable.1.0;
    let in_range = |from: u32, to: u32| from <= to && to <= last;
    let sound = facts.contacts.iter().chain(&facts.flights).all(|range| in_range(range.from, range.to))
        && facts.stationary.iter().all(|range| in_range(range.from, range.to));
    if sound && !facts.contacts.is_empty() && text.lines().count() < 40 {
        return Ok(());
    }
    Err(text.into())
}

fn whole(folder: &Path, file: &str) -> Result<WorkingClip, Failed> {
    let clip = load(folder, file, &ReadOptions::default())?.clip;
    let (first, last) = clip.usable;
    Ok(WorkingClip::new(file, Arc::new(clip), first, last))
}

fn stationary_agrees(folder: &Path, file: &str) -> Result<(), Failed> {
    let working = whole(folder, file)?;
    let by_speed_alone =
        StationarySettings { both_feet_shortest: usize::MAX, ..StationarySettings::default() };
    let slow = runs(&stationary(&working.positions, &working.contacts, &by_speed_alone));
    let all = runs(&working.stationary);
    let expected = STATIONARY.iter().find(|(name, ..)| *name == file).ok_or("no expectation")?;
    if slow == expected.1 && all == expected.2 {
        return Ok(());
    }
    Err(format!("by speed {slow:?}, with feet {all:?}, expected {expected:?}").into())
}

fn slide_agrees(folder: &Path, file: &str) -> Result<(), Failed> {
    let found = foot_slide_working(&whole(folder, file)?).ok_or("no contact")?;
    let expected = FOOT_SLIDES.iter().find(|(name, _)| *name == file).ok_or("no expectation")?.1;
    // Three decimals are stated.
    if (found - expected).abs() < 0.0006 {
        Ok(())
    } else {
        Err(format!("{found}, expected {expected}").into())
    }
}

/// The manifest has nine frames airborne from frame 50 (joints 8 cm up); feet leave the floor a little earlier.
fn flies_once(folder: &Path, file: &str) -> Result<(), Failed> {
    let found = runs(&whole(folder, file)?.flight);
    match found[..] {
        [(first, last)] if (46..=51).contains(&first) && (57..=62).contains(&last) => Ok(()),
        _ => Err(format!("{found:?}").into()),
    }
}

fn never_flies(folder: &Path, file: &str) -> Result<(), Failed> {
    let found = runs(&whole(folder, file)?.flight);
    if found.is_empty() { Ok(()) } else { Err(format!("{found:?}").into()) }
}

/// Every file called broken is refused with a place, and so are one that announces more frames than it has and one without
/// any; every other one gives a clip that can be inspected.
fn odd_files(folder: &Path, odd: &str) -> Result<(), Failed> {
    let mut faults = Vec::new();
    for entry in std::fs::read_dir(folder.join(odd))? {
        let path = entry?.path();
        let name = path.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
        if path.extension().is_none_or(|extension| extension != "bvh") {
            continue;
        }
        let is_broken = name.starts_with("broken_")
            || ["frames_header_303_but_one_row", "valid_zero_frames"].contains(&name.as_str());
        match read(Capture::Bvh(&std::fs::read(&path)?), &name, &ReadOptions::default()) {
            Ok(_) if is_broken => faults.push(format!("{name} was read")),
            Ok(read) => drop(facts_text(&inspect(&name, &read))),
            Err(error) if is_broken && error.to_string().starts_with("line ") => {}
            Err(error) => faults.push(format!("{name}: {error}")),
        }
    }
    if faults.is_empty() { Ok(()) } else { Err(faults.join("; ").into()) }
}
