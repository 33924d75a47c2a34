//! Facts of captures beside what the manifest states of them.

use std::path::Path;

use cotillion::clip::Clip;
use cotillion::clip::contacts::percentile;
use cotillion::clip::note::ReadNote;
use cotillion::clip::read::{ReadClip, ReadOptions};
use cotillion::clip::roles::missing_roles;
use cotillion::geometry::{plan_of, wrap};
use cotillion::index::SourceFrame;
use cotillion::metrics::{root_path, standing_height};
use cotillion::skeleton::{Joint, JointFrame};
use libtest_mimic::Failed;

use super::files::{MOTIONS, ODD, SKELETONS};
use super::load;

/// One row of the manifest, by the names of its columns.
pub(crate) struct Row {
    columns: Vec<String>,
    values: Vec<String>,
}

impl Row {
    pub(crate) fn of(folder: &Path, file: &str) -> Result<Self, Failed> {
        let mut rows = rows(folder)?;
        let at = rows.iter().position(|row| row.values.first().is_some_and(|name| name == file));
        Ok(rows.swap_remove(at.ok_or("no row in the manifest")?))
    }

    pub(crate) fn text(&self, column: &str) -> Result<&str, Failed> {
        let at = self.columns.iter().position(|name| name == column).ok_or("no such column")?;
        // Rows end with their last word.
        Ok(self.values.get(at).map_or("", String::as_str))
    }

    /// The number of a column, where one is stated.
    fn number(&self, column: &str) -> Result<Option<f64>, Failed> {
        let text = self.text(column)?;
        Ok(if text.is_empty() { None } else { Some(text.parse()?) })
    }
}

fn rows(folder: &Path) -> Result<Vec<Row>, Failed> {
    let text = std::fs::read_to_string(folder.join("MANIFEST.tsv"))?;
    let split = |line: &str| line.split('\t').map(str::to_owned).collect::<Vec<_>>();
    let columns = split(text.lines().next().unwrap_or(""));
    let row = |line: &str| Row { columns: columns.clone(), values: split(line) };
    Ok(text.lines().skip(1).map(row).collect())
}

/// Every row of the manifest belongs to a test, and every test to a row.
pub(crate) fn manifest_is_covered(folder: &Path, _: &str) -> Result<(), Failed> {
    let mut tested: Vec<&str> =
        MOTIONS.into_iter().chain(SKELETONS).chain(ODD.map(|(file, _)| file)).collect();
    let rows = rows(folder)?;
    let mut stated: Vec<&str> =
        rows.iter().filter_map(|row| row.values.first()).map(String::as_str).collect();
    tested.sort_unstable();
    tested.dedup();
    stated.sort_unstable();
    if tested == stated { Ok(()) } else { Err("the manifest lists other files".into()) }
}

/// A skeleton has no motion of its own: it is read with the first motion of its performer.
pub(crate) fn skeleton_agrees(folder: &Path, file: &str) -> Result<(), Failed> {
    let row = Row::of(folder, file)?;
    let performer = format!("{}_", file.strip_suffix(".asf").ok_or("no skeleton")?);
    let motion = MOTIONS.into_iter().find(|motion| motion.starts_with(&performer)).ok_or("no motion")?;
    let read = load(folder, motion, &ReadOptions::default())?;
    let mut faults = Vec::new();
    compare("joints", read.clip.skeleton.joints.len() as f64, row.number("joints")?, [0.0; 2], &mut faults);
    compare("unit_to_m", read.unit_to_m, row.number("unit_to_m")?, [1e-4, 0.0], &mut faults);
    told(faults)
}

pub(crate) fn facts_agree(folder: &Path, file: &str) -> Result<(), Failed> {
    let row = Row::of(folder, file)?;
    let read = load(folder, file, &ReadOptions::default())?;
    let mut faults = stated_facts(&read, &row, file)?;
    let missing = missing_roles(&read.clip.skeleton);
    if !missing.is_empty() {
        faults.push(format!("missing {missing:?}"));
    }
    let rest_pose = read.notes.iter().any(|note| matches!(note, ReadNote::RestPoseLeftOut { .. }));
    if rest_pose != (row.text("frame0_jump_rest_pose")? == "yes") {
        faults.push(format!("rest pose at frame 0: {rest_pose}"));
    }
    if rest_pose != (read.clip.usable.0 > SourceFrame(0)) {
        faults.push(format!("usable {:?}", read.clip.usable));
    }
    told(faults)
}

fn told(faults: Vec<String>) -> Result<(), Failed> {
    if faults.is_empty() { Ok(()) } else { Err(faults.join("; ").into()) }
}

/// Numbers that the row states and the clip does not have.
pub(crate) fn stated_facts(read: &ReadClip, row: &Row, file: &str) -> Result<Vec<String>, Failed> {
    let clip = &read.clip;
    let last = SourceFrame::from_usize(clip.frame_count() - 1);
    let way = Way::of(file);
    let first = if way == Way::RootOnly { SourceFrame(0) } else { SourceFrame(1).min(last) };
    let mut faults = Vec::new();
    // (column, found, share of the stated value by which it may differ, and half a unit of its last digit)
    let checks = [
        ("joints", clip.skeleton.joints.len() as f64, [0.0, 0.0]),
        ("frames", clip.frame_count() as f64, [0.0, 0.0]),
        ("header_fps", read.header_fps, [0.0, 0.005]),
        ("unit_to_m", read.unit_to_m, [1e-4, 0.0]),
        ("top_joint_height_m", height(clip, way, first, last), [0.001, 0.005]),
        ("root_ground_path_m", path(clip, way, first, last), [0.01, 0.005]),
    ];
    for (column, found, tolerance) in checks {
        compare(column, found, row.number(column)?, tolerance, &mut faults);
    }
    let up = row.text("up")?.to_ascii_lowercase();
    if !up.is_empty() && up != read.up.to_string() {
        faults.push(format!("{} up, stated {up}", read.up));
    }
    let hips = row.text("hip_height_min_max_m")?;
    if let Some((low, high)) = hips.split_once("..") {
        let found = hip_heights(clip, way, first, last);
        compare("lowest hips", found[0], Some(low.parse()?), [0.0, HIP_ROUNDING], &mut faults);
        compare("highest hips", found[1], Some(high.parse()?), [0.0, HIP_ROUNDING], &mut faults);
    }
    // Ours counts counter-clockwise.
    let turn = -turn(clip, first, last).to_degrees();
    let mut turn_faults = Vec::new();
    compare("turn_deg", turn, row.number("turn_deg")?, [0.0, TURN_ROUNDING], &mut turn_faults);
    let is_excused = NOT_COMPARABLE.iter().any(|(name, _)| *name == file);
    match (is_excused, turn_faults.is_empty()) {
        (false, _) => faults.append(&mut turn_faults),
        (true, true) => faults.push("turn_deg agrees, though it is listed as not comparable".to_owned()),
        (true, false) => {}
    }
    Ok(faults)
}

/// How the manifest measured a file.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Way {
    /// From frame 1 on; end sites left out.
    Joints,
    /// Acclaim counts a joint at the far end of each bone: ours at the near ends and the end sites together.
    BoneEnds,
    /// DeepMimic: places of the root as they stand, frame 0 too, frame by frame; the ground is at 0.
    RootOnly,
}

impl Way {
    fn of(file: &str) -> Self {
        match file.rsplit('.').next() {
            Some("amc") => Self::BoneEnds,
            Some("txt") => Self::RootOnly,
            _ => Self::Joints,
        }
    }
}

/// Heights of all that counts as a joint in one frame, metres.
fn heights(clip: &Clip, way: Way, frame: SourceFrame) -> Vec<f64> {
    let frames = clip.skeleton.forward_kinematics(&clip.pose(frame));
    let ends = clip.skeleton.joints.iter().zip(&frames).filter(|_| way == Way::BoneEnds);
    let end = |(joint, at): (&Joint, &JointFrame)| Some((at.position + at.rotation * joint.end_site?).y);
    frames.iter().map(|at| at.position.y).chain(ends.filter_map(end)).collect()
}

fn height(clip: &Clip, way: Way, first: SourceFrame, last: SourceFrame) -> f64 {
    if way != Way::BoneEnds {
        return standing_height(clip, first, last);
    }
    let extent = |frame| {
        let heights = heights(clip, way, frame);
        heights.iter().copied().fold(f64::NEG_INFINITY, f64::max)
            - heights.into_iter().fold(f64::INFINITY, f64::min)
    };
    // The share of `standing_height`.
    percentile((first.0..=last.0).map(SourceFrame).map(extent).collect(), 0.6)
}

fn path(clip: &Clip, way: Way, first: SourceFrame, last: SourceFrame) -> f64 {
    if way != Way::RootOnly {
        return root_path(clip, first, last);
    }
    clip.root_positions.windows(2).map(|pair| (plan_of(pair[1]) - plan_of(pair[0])).norm()).sum()
}

/// Two decimals are stated, and of the ground level as well.
const HIP_ROUNDING: f64 = 0.015;

/// The ground is where the lowest joint is in all but so few frames: feet sink in now and then.
const GROUND_SHARE: f64 = 0.1;

/// How far a direction of travel depends on how it is smoothed, degrees.
const TURN_ROUNDING: f64 = 20.0;

/// Clips whose direction of travel is not comparable, and why.
///
/// The manifest says that it means nothing for clips that stay in place; how it smooths a direction it does not say, and a
/// turn in place is a whole turn more or less by that.
const NOT_COMPARABLE: [(&str, &str); 17] = [
    ("amc/cmu_02_04_jump_then_balance_on_one_leg.amc", "stays in place"),
    ("amc/cmu_02_06_bend_over_scoop_up_rise_lift_arm.amc", "stays in place"),
    ("amc/cmu_14_21_climb_3_steps_up_and_down.amc", "turns round in place on top of the steps"),
    ("amc/cmu_14_27_sit_on_high_stool_and_stand_up.amc", "stays in place"),
    ("amc/cmu_14_37_stand_in_place_drinking_soda.amc", "stays in place"),
    ("amc/cmu_16_41_jog_90_degree_left_turn.amc", "0 is stated of a turn by 90 degrees; ours is 74"),
    ("amc/cmu_49_02_jump_up_and_down_hop_on_one_foot.amc", "stays in place"),
    ("bvh/cmu_01_01_forward_jumps.bvh", "turns round in place between jumps: half a turn, or one and a half"),
    ("bvh/cmu_18_01_shake_hands_A.bvh", "stays in place"),
    ("bvh/cmu_60_05_salsa_A.bvh", "dances in place"),
    ("bvh/cmu_60_10_salsa_A.bvh", "dances in place"),
    ("bvh/cmu_61_05_salsa_B.bvh", "dances in place"),
    ("bvh/cmu_61_10_salsa_B.bvh", "dances in place"),
    ("bvh/mass_cart.bvh", "steps aside after the wheel"),
    ("bvh/snu_broad_jump.bvh", "stands, jumps once, stands"),
    ("bvh/snu_walk_to_slope_and_back.bvh", "turns back in place: one whole turn more"),
    ("odd/cmu_88_04_flips_root_displaced.bvh", "flips in place"),
];

fn compare(what: &str, found: f64, stated: Option<f64>, [share, digits]: [f64; 2], faults: &mut Vec<String>) {
    if let Some(stated) = stated
        && (found - stated).abs() > share * stated.abs() + digits
    {
        faults.push(format!("{what}: {found}, stated {stated}"));
    }
}

/// Least and largest height of the root above the ground, metres.
fn hip_heights(clip: &Clip, way: Way, first: SourceFrame, last: SourceFrame) -> [f64; 2] {
    let lowest = |frame| heights(clip, way, frame).into_iter().fold(f64::INFINITY, f64::min);
    let ground = match way {
        Way::RootOnly => 0.0,
        _ => percentile((first.0..=last.0).map(SourceFrame).map(lowest).collect(), GROUND_SHARE),
    };
    let roots = || clip.root_positions[first.as_usize()..].iter().map(|root| root.y - ground);
    [roots().fold(f64::INFINITY, f64::min), roots().fold(f64::NEG_INFINITY, f64::max)]
}

/// Change of the direction of travel seen from above, radians, counter-clockwise: of steps of 0.1 s of the root's path,
/// averaged over 0.5 s, where it goes faster than 0.2 m/s.
fn turn(clip: &Clip, first: SourceFrame, last: SourceFrame) -> f64 {
    let step = (0.1 * clip.fps).max(1.0);
    let mut places = Vec::new();
    let mut at = f64::from(first.0);
    while at <= f64::from(last.0) {
        places.push(plan_of(clip.root_at(at)));
        at += step;
    }
    let averaged: Vec<_> = (0..places.len())
        .map(|index| {
            let near = &places[index.saturating_sub(2)..(index + 3).min(places.len())];
            near.iter().sum::<cotillion::geometry::c64>() / near.len() as f64
        })
        .collect();
    let directions: Vec<f64> = averaged
        .windows(2)
        .map(|pair| pair[1] - pair[0])
        .filter(|step| step.norm() > 0.02)
        .map(|step| step.arg())
        .collect();
    directions.windows(2).map(|pair| wrap(pair[1] - pair[0])).sum()
}
