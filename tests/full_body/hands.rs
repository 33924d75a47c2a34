//! Hands that bear, and hands that reach out.

use std::path::Path;

use cotillion::clip::contacts::{ContactPoint, contact_point};
use cotillion::full_body::chain::arms;
use cotillion::full_body::{BodyInput, Effector, Jerks, PlantMode, PlantedPoint, Seams, Target, refine};
use cotillion::skeleton::{Pose, Skeleton};
use glam::DVec3;
use libtest_mimic::Failed;

use crate::bend::bent;
use crate::clips::{ON_HANDS, Stretch, load};
use crate::measure::bone_change;
use crate::{BONES, DRIFT, EDITS, edited, refined, tell};

/// Every stated contact keeps the capture's drift, which it would not if nothing were done.
pub(crate) fn bears_on_hands(folder: &Path, file: &str) -> Result<(), Failed> {
    let walk = load(folder, file)?;
    let stretch = walk.stretch((0, walk.poses.len() - 1));
    let stated = ON_HANDS.iter().find(|(name, _)| *name == file).map_or(0, |(_, stated)| stated.len());
    let is_hand =
        |plant: &&PlantedPoint| matches!(plant.point, ContactPoint::LeftHand | ContactPoint::RightHand);
    let (mut worst, mut untreated) = (0.0_f64, 0.0_f64);
    for edit in EDITS {
        let moved = bent(&stretch, edit);
        let result = refined(&stretch, &moved, PlantMode::AsCaptured);
        let hands: Vec<&PlantedPoint> = result.report.plants.iter().filter(is_hand).collect();
        if hands.len() != stated {
            return Err(format!("{hands:?} of {stated}").into());
        }
        for hand in hands {
            worst = worst.max((hand.drift - hand.captured_drift).abs());
            untreated = untreated.max(drift_without(&stretch, &moved, hand));
        }
    }
    tell(&format!("{file} hands drift {worst:e} m more than captured, {untreated:.3} m untreated"));
    if worst < DRIFT && untreated > DRIFT {
        return Ok(());
    }
    Err(format!("{worst} m beyond the captured drift, {untreated} m untreated").into())
}

/// By how much more a hand drifts where nothing is done about it, metres.
fn drift_without(stretch: &Stretch, moved: &[Pose], hand: &PlantedPoint) -> f64 {
    let skeleton = stretch.walk.skeleton();
    let Some(at) = contact_point(skeleton, hand.point) else { return 0.0 };
    let places: Vec<DVec3> = moved[hand.first..=hand.last]
        .iter()
        .map(|pose| at.place(&skeleton.forward_kinematics(pose)))
        .collect();
    let mean = places.iter().sum::<DVec3>() / places.len() as f64;
    let drift = places.iter().map(|place| place.distance(mean)).fold(0.0, f64::max);
    drift - hand.captured_drift
}

/// Twice on the way each hand is for a fifth of a second a little higher and nearer to its shoulder than it would be, which
/// arms reach.
pub(crate) fn reaches(folder: &Path, file: &str) -> Result<(), Failed> {
    let walk = load(folder, file)?;
    let skeleton = walk.skeleton();
    let mut faults = Vec::new();
    for edit in EDITS {
        for frames in edited(&walk, edit) {
            let stretch = walk.stretch(frames);
            let moved = bent(&stretch, edit);
            let input = BodyInput {
                times: stretch.times.clone(),
                rest: stretch.rest.to_vec(),
                contacts: stretch.contacts.to_vec(),
                effectors: reaching(skeleton, &refined(&stretch, &moved, PlantMode::AsCaptured).poses),
                seams: Seams::default(),
                source: Jerks::default(),
                moved,
            };
            let result = refine(skeleton, &input, PlantMode::AsCaptured);
            let bones = bone_change(skeleton, stretch.rest, &result.poses);
            if !result.report.shortfalls.is_empty() || bones > BONES {
                faults.push(format!("{frames:?} {}: {:?}", edit.name(), result.report.shortfalls));
            }
        }
    }
    if faults.is_empty() { Ok(()) } else { Err(faults.join("\n").into()) }
}

/// Frames that a hand is somewhere.
const HELD: usize = 6;

fn reaching(skeleton: &Skeleton, poses: &[Pose]) -> Vec<Effector> {
    let limbs = arms(skeleton).into_iter().flatten();
    let ends = limbs.flat_map(|limb| {
        let target = move |pose: &Pose| {
            let place = limb.place(skeleton, pose).limb;
            let nearer = (place.upper - place.lower) * 0.1;
            Target { position: place.lower + nearer + DVec3::Y * 0.05, rotation: None }
        };
        let starts = [poses.len() / 3, 2 * poses.len() / 3];
        starts.map(move |first| {
            let held = poses.iter().skip(first).take(HELD);
            Effector { joint: limb.lower, first, targets: held.map(target).collect(), holds: false }
        })
    });
    ends.collect()
}
