//! Bodies that something else has changed since: feet stand again, hands are back where they must be.

use std::collections::{BTreeMap, BTreeSet};

use rayon::prelude::*;

use super::hips::{hips, within_legs};
use super::source::source_jerks;
use super::{Body, Embodied, SoFar, effectors, in_turn, known_by, plant_mode, rounds, sample_times, show};
use crate::clip::Clip;
use crate::edit::Moved;
use crate::full_body::{BodyInput, BodyReport, Effector, PlantedPoint, Seams, refine};
use crate::index::CharacterId;
use crate::object_motion::{Performance, skeleton_of};
use crate::reach::Stage;
use crate::resample::{Resampled, shown_contacts_at};
use crate::skeleton::Pose;

/// Corrects those anew whose poses were `changed` (one a sample of their bodies), and those who reach them; all others stay as they
/// are, to the bit. Feet stand as in the changed poses, and hips are back where hard constraints hold them. Where the full body is off, nobody is corrected.
/// Cost: that of [`super::embody_some`] for these.
///
/// # Panics
/// If somebody is changed who has no body in `embodied`.
pub fn embody_again(
    stage: &Stage<'_, Moved<'_>>,
    embodied: &mut Embodied<'_>,
    changed: BTreeMap<CharacterId, Vec<Pose>>,
    resampled: &mut Resampled,
) {
    let concerned: BTreeSet<CharacterId> = changed.keys().copied().collect();
    let mut done: BTreeMap<CharacterId, Body> =
        embodied.members.iter().copied().zip(std::mem::take(&mut embodied.bodies)).collect();
    let mut upright: BTreeMap<CharacterId, Vec<Pose>> = BTreeMap::new();
    for (who, poses) in changed {
        let body = done.get_mut(&who).expect("only bodies are changed");
        upright.insert(who, std::mem::replace(&mut body.poses, poses));
    }
    if stage.scene.full_body.enabled {
        let is_concerned = |group: &&Vec<CharacterId>| {
            group.iter().any(|who| !known_by(stage, *who).is_disjoint(&concerned))
        };
        let rounds = rounds(stage, &embodied.members);
        let corrected_anew = rounds.iter().flatten().filter(is_concerned).flatten();
        let start: BTreeMap<CharacterId, Body> =
            corrected_anew.filter_map(|who| Some((*who, done.get(who)?.clone()))).collect();
        for round in rounds {
            let make = |so_far: &SoFar<'_>, who: CharacterId| {
                let body = &start[&who];
                let hold = |before: &Vec<Pose>| hips(stage, who, &body.times, (before, &body.poses));
                corrected(stage, so_far, (who, body), upright.get(&who).map_or(Vec::new(), hold))
            };
            let turn = |group: &Vec<CharacterId>| in_turn(stage.performance, &done, group, &make);
            let bodies: Vec<(CharacterId, Body)> =
                round.par_iter().filter(&is_concerned).flat_map_iter(turn).collect();
            done.extend(bodies);
        }
    }
    embodied.bodies = done.into_values().collect();
    show(&embodied.bodies, resampled);
}

/// So often hips that legs do not reach are tried lower.
const DESCENTS: usize = 3;

/// `hips`: where they are held.
fn corrected(
    stage: &Stage<'_, Moved<'_>>,
    so_far: &SoFar<'_>,
    (who, start): (CharacterId, &Body),
    hips: Vec<Effector>,
) -> Body {
    let (scene, moved) = (stage.scene, stage.performance);
    let frames: Vec<f64> = start.times.iter().map(|time| moved.frame(who, *time)).collect();
    let mut input = BodyInput {
        rest: start.poses.clone(),
        moved: start.poses.clone(),
        contacts: shown_contacts_at(&scene.characters[who.as_usize()].track, &frames),
        effectors: effectors(stage, so_far, who, &start.times)
            .into_iter()
            .chain(hips.iter().cloned())
            .collect(),
        // Joined motion is one by now.
        seams: Seams::default(),
        source: source_jerks(scene, who),
        times: start.times.clone(),
    };
    let skeleton = skeleton_of(scene, who);
    let mut refined = refine(skeleton, &input, plant_mode(scene));
    for _ in 0..DESCENTS {
        let own = input.effectors.len() - hips.len();
        let Some(lower) = within_legs(&input.effectors[own..], &refined.poses) else { break };
        input.effectors.truncate(own);
        input.effectors.extend(lower);
        refined = refine(skeleton, &input, plant_mode(scene));
    }
    Body {
        times: input.times,
        moved: start.moved.clone(),
        poses: refined.poses,
        planted: refined.planted,
        report: again(&start.report, refined.report),
    }
}

/// What was done the first time, with what is out of reach now and how plants drift now, against how they do as captured.
fn again(first: &BodyReport, now: BodyReport) -> BodyReport {
    let captured = |point: PlantedPoint| {
        let same =
            |own: &&PlantedPoint| (own.point, own.first, own.last) == (point.point, point.first, point.last);
        let known = first.plants.iter().find(same);
        PlantedPoint { captured_drift: known.map_or(point.captured_drift, |own| own.captured_drift), ..point }
    };
    let mut contacts = now.contacts;
    for (own, first) in contacts.iter_mut().zip(&first.contacts) {
        own.captured_drift = first.captured_drift;
    }
    BodyReport {
        shortfalls: now.shortfalls,
        plants: now.plants.into_iter().map(captured).collect(),
        contacts,
        ..first.clone()
    }
}

/// Bodies of those in `resampled` as they are before the full body.
pub fn unembodied(stage: &Stage<'_, Moved<'_>>, resampled: &Resampled) -> Vec<Body> {
    let (scene, moved) = (stage.scene, stage.performance);
    let body = |(who, clip): (&CharacterId, &Clip)| {
        let times =
            sample_times((scene, stage.ties), moved, *who, (resampled.start_time, clip.frame_count()));
        let frames: Vec<f64> = times.iter().map(|time| moved.frame(*who, *time)).collect();
        let poses: Vec<Pose> = frames.iter().map(|frame| moved.pose(*who, *frame)).collect();
        let planted = shown_contacts_at(&scene.characters[who.as_usize()].track, &frames);
        Body { times, moved: poses.clone(), poses, planted, report: BodyReport::default() }
    };
    resampled.members.iter().zip(&resampled.clips).map(body).collect()
}
