//! The walking, running and turning clips among the captures, and the stretches of them that have a direction.

use std::path::Path;
use std::sync::Arc;

use cotillion::clip::contacts::Contacts;
use cotillion::clip::contacts::annotated::{AnnotatedContact, point_named};
use cotillion::clip::working::{WORKING_STEP, WorkingClip};
use cotillion::geometry::plan_of;
use cotillion::index::{SourceFrame, floor_index};
use cotillion::skeleton::{Pose, Skeleton};
use libtest_mimic::Failed;

use crate::captures::read_at_own_rate;

/// Every clip whose name or description in the manifest says walk, run, jog or turn (dives and jumps between runs too).
pub(crate) const CLIPS: [&str; 45] = [
    "amc/cmu_02_01_walk_straight.amc",
    "amc/cmu_02_03_run_jog_straight.amc",
    "amc/cmu_03_01_walk_on_uneven_terrain_step_down.amc",
    "amc/cmu_03_02_walk_on_uneven_terrain.amc",
    "amc/cmu_09_01_run_straight.amc",
    "amc/cmu_09_12_navigate_forward_backward_sideways.amc",
    "amc/cmu_127_04_walk_to_run_transition.amc",
    "amc/cmu_127_05_run_to_quick_stop.amc",
    "amc/cmu_127_13_run_side_step_left.amc",
    "amc/cmu_127_14_run_side_step_right.amc",
    "amc/cmu_127_16_run_turn_right.amc",
    "amc/cmu_127_21_run_jump_stop_run.amc",
    "amc/cmu_127_23_run_dive_over_and_roll_run.amc",
    "amc/cmu_127_25_run_jump_over_obstacle.amc",
    "amc/cmu_127_29_run_duck_underneath.amc",
    "amc/cmu_127_33_run_over_low_obstacle.amc",
    "amc/cmu_127_37_run_duck_underneath_low.amc",
    "amc/cmu_16_11_walk_veer_left.amc",
    "amc/cmu_16_13_walk_veer_right.amc",
    "amc/cmu_16_15_walk_straight.amc",
    "amc/cmu_16_17_walk_90_degree_left_turn.amc",
    "amc/cmu_16_19_walk_90_degree_right_turn.amc",
    "amc/cmu_16_33_slow_walk_then_stop.amc",
    "amc/cmu_16_35_jog_straight.amc",
    "amc/cmu_16_37_jog_veer_left.amc",
    "amc/cmu_16_41_jog_90_degree_left_turn.amc",
    "amc/cmu_16_57_jog_sudden_stop.amc",
    "amc/cmu_49_01_walk_straight_gymnast.amc",
    "amc/cmu_49_04_run_and_leap.amc",
    "bvh/cmu_12_01_walk.bvh",
    "bvh/cmu_131_01_start_walk_stop.bvh",
    "bvh/cmu_37_01_walk.bvh",
    "bvh/mass_run.bvh",
    "bvh/mass_walk.bvh",
    "bvh/snu_cross_walk_90.bvh",
    "bvh/snu_slope_up_10.bvh",
    "bvh/snu_slope_up_16.bvh",
    "bvh/snu_spiral_left_fast.bvh",
    "bvh/snu_spiral_walk_normal.bvh",
    "bvh/snu_u_turn.bvh",
    "bvh/snu_walk_left_90.bvh",
    "bvh/snu_walk_stop_walk.bvh",
    "bvh/snu_walk_straight_normal.bvh",
    "bvh/snu_walk_to_slope_and_back.bvh",
    "bvh/snu_walk_turn_180.bvh",
];

/// Those of [`CLIPS`] that go in laps or spirals: far to the side of a short chord.
pub(crate) const WINDING: [&str; 6] = [
    "amc/cmu_09_12_navigate_forward_backward_sideways.amc",
    "bvh/snu_spiral_left_fast.bvh",
    "bvh/snu_spiral_walk_normal.bvh",
    "bvh/snu_walk_stop_walk.bvh",
    "bvh/snu_walk_to_slope_and_back.bvh",
    "bvh/snu_walk_turn_180.bvh",
];

/// Skeletons of 13 joints without toes or ends of feet, rigs of 43 joints, steps and stools.
pub(crate) const OTHERS: [&str; 9] = [
    "deepmimic/humanoid3d_jog.txt",
    "deepmimic/humanoid3d_run.txt",
    "deepmimic/humanoid3d_walk.txt",
    "bvh/cmu_10_03_kick_ball.bvh",
    "bvh/cmu_60_05_salsa_A.bvh",
    "bvh/cmu_61_05_salsa_B.bvh",
    "amc/cmu_14_21_climb_3_steps_up_and_down.amc",
    "amc/cmu_14_27_sit_on_high_stool_and_stand_up.amc",
    "amc/cmu_14_31_sit_on_stepstool_and_stand_up.amc",
];

/// Clips of these that stand on steps, slopes, uneven ground or an obstacle.
pub(crate) const RAISED: [&str; 7] = [
    "amc/cmu_03_01_walk_on_uneven_terrain_step_down.amc",
    "amc/cmu_03_02_walk_on_uneven_terrain.amc",
    "amc/cmu_127_33_run_over_low_obstacle.amc",
    "amc/cmu_14_21_climb_3_steps_up_and_down.amc",
    "bvh/snu_slope_up_10.bvh",
    "bvh/snu_slope_up_16.bvh",
    "bvh/snu_walk_to_slope_and_back.bvh",
];

/// Joint, first and last file frame of each time that a hand bears.
type OnHands = &'static [(&'static str, u32, u32)];

/// Clips in which hands bear: all but the first, a dive and roll, are cartwheels.
pub(crate) const ON_HANDS: [(&str, OnHands); 5] = [
    ("amc/cmu_127_23_run_dive_over_and_roll_run.amc", &[("left_hand", 156, 172)]),
    ("amc/cmu_49_06_cartwheel.amc", &[("left_hand", 268, 308), ("right_hand", 220, 272)]),
    (
        "amc/cmu_49_08_two_cartwheels.amc",
        &[("left_hand", 76, 128), ("right_hand", 52, 100), ("lhand", 412, 468), ("rhand", 384, 440)],
    ),
    ("bvh/mass_cart.bvh", &[("left_hand", 92, 144), ("right_hand", 116, 180)]),
    ("deepmimic/humanoid3d_cartwheel.txt", &[("left_hand", 65, 82), ("right_hand", 76, 96)]),
];

/// A clip, on working frames or on its own.
pub(crate) struct Walk {
    pub(crate) working: WorkingClip,
    pub(crate) times: Vec<f64>,
    pub(crate) poses: Vec<Pose>,
    pub(crate) contacts: Vec<Contacts>,
}

impl Walk {
    pub(crate) fn skeleton(&self) -> &Skeleton {
        &self.working.clip.skeleton
    }

    pub(crate) fn stretch(&self, (first, last): (usize, usize)) -> Stretch<'_> {
        Stretch {
            walk: self,
            times: self.times[first..=last].to_vec(),
            rest: &self.poses[first..=last],
            contacts: &self.contacts[first..=last],
        }
    }

    /// The same at `fps`; each pose has the contacts of the nearest working frame.
    pub(crate) fn at_rate(&self, fps: f64) -> Self {
        let working = self.working.clone();
        let last = (working.frame_count() - 1) as f64;
        let frames: Vec<f64> =
            (0..).map(|k| f64::from(k) / fps / WORKING_STEP).take_while(|frame| *frame <= last).collect();
        let nearest = |frame: &f64| working.contacts[floor_index(frame.round())];
        Self {
            times: frames.iter().map(|frame| frame * WORKING_STEP).collect(),
            poses: frames.iter().map(|frame| working.pose(*frame)).collect(),
            contacts: frames.iter().map(nearest).collect(),
            working,
        }
    }
}

/// Successive frames of a clip.
pub(crate) struct Stretch<'a> {
    pub(crate) walk: &'a Walk,
    pub(crate) times: Vec<f64>,
    pub(crate) rest: &'a [Pose],
    pub(crate) contacts: &'a [Contacts],
}

pub(crate) fn load(folder: &Path, file: &str) -> Result<Walk, Failed> {
    let mut clip = read_at_own_rate(folder, file)?;
    let stated = ON_HANDS.iter().find(|(name, _)| *name == file).map_or(&[][..], |(_, stated)| stated);
    for (joint, from, to) in stated {
        let point = point_named(&clip.skeleton, joint)?;
        clip.contacts.push(AnnotatedContact { point, from: SourceFrame(*from), to: SourceFrame(*to) });
    }
    let (first, last) = clip.usable;
    let working = WorkingClip::new(file, Arc::new(clip), first, last);
    let frames = 0..working.frame_count();
    let times = frames.clone().map(|frame| frame as f64 * WORKING_STEP).collect();
    let poses = frames.map(|frame| working.pose(frame as f64)).collect();
    let contacts = working.contacts.clone();
    Ok(Walk { working, times, poses, contacts })
}

/// A stretch longer than this times its chord has no direction.
const TURNED: f64 = 1.5;

/// Stretches into which a path is cut are at most so much longer than their chords.
const STRAIGHT: f64 = 1.2;

/// Shorter stretches are no walk, metres.
const SHORTEST: f64 = 1.0;

/// The stretches of a path that have a direction: first and last frames.
pub(crate) fn stretches(poses: &[Pose]) -> Vec<(usize, usize)> {
    let lengths = lengths(poses);
    let chord = |first: usize, last: usize| (plan_of(poses[last].root) - plan_of(poses[first].root)).norm();
    let last = poses.len() - 1;
    let mut found = Vec::new();
    let mut first = 0;
    while first < last {
        let far = |end: &usize| lengths[*end] - lengths[first] > SHORTEST;
        let straight = |end: &usize| lengths[*end] - lengths[first] <= STRAIGHT * chord(first, *end);
        let turned = |end: &usize| far(end) && lengths[*end] - lengths[first] > TURNED * chord(first, *end);
        let until = (first..=last).find(turned).unwrap_or(last);
        let end = (first..=until).rev().find(|end| far(end) && straight(end));
        found.extend(end.map(|end| (first, end)));
        first = end.unwrap_or(until).max(first + 1);
    }
    found
}

/// Length of the root's path up to each frame, metres.
fn lengths(poses: &[Pose]) -> Vec<f64> {
    let mut lengths = vec![0.0];
    for pair in poses.windows(2) {
        lengths.push(lengths[lengths.len() - 1] + (plan_of(pair[1].root) - plan_of(pair[0].root)).norm());
    }
    lengths
}
