//! The full body of everybody in a scene: poses on the clock and at constrained moments, their feet planted, their hands
//! where they must be.
//!
//! What is carried is between the hands as they are before this stage; bodies are reached where they are after it. So who
//! reaches somebody waits for them, and all others are corrected in parallel. Those who reach each other, or whose hands
//! meet, are corrected in turn, four times: hands meet in the middle, and where one falls short the other comes to it.

mod again;
mod hips;
mod source;

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use rayon::prelude::*;

use crate::clip::Clip;
use crate::clip::contacts::annotated::AnnotatedContact;
use crate::clip::contacts::{ContactPoint, Contacts, runs};
use crate::edit::{Edit, Moved};
use crate::embody::source::{seams, source_jerks};
use crate::fingers::hold_fingers;
use crate::full_body::{BodyInput, BodyReport, Effector, PlantMode, Target, refine};
use crate::geometry::slerp;
use crate::index::{CharacterId, SourceFrame};
use crate::object_motion::{Performance, object_motions, skeleton_of};
use crate::reach::{
    JointTarget, Others, Source, Stage, carry_targets, constrained_times, effector_targets, partners,
};
use crate::resample::{Resampled, shown_contacts_at};
use crate::scene::{Plants, Scene};
use crate::skeleton::Pose;
use crate::ties::Ties;

pub use again::{embody_again, unembodied};

/// Moments this near to an output frame are at it, seconds.
const AT_FRAME: f64 = 1e-7;

/// One character's samples and what became of them.
#[derive(Clone, Debug, PartialEq)]
pub struct Body {
    /// Scene times: output frames, and constrained moments between them; rising, seconds.
    pub times: Vec<f64>,
    /// Before this stage.
    pub moved: Vec<Pose>,
    /// After it.
    pub poses: Vec<Pose>,
    /// Which points of the feet are planted.
    pub planted: Vec<Contacts>,
    /// What was done, and what could not be.
    pub report: BodyReport,
}

/// Everybody after this stage, or some.
#[derive(Clone)]
pub struct Embodied<'a> {
    /// Before it.
    pub moved: Moved<'a>,
    /// Whose bodies these are, rising.
    pub members: Vec<CharacterId>,
    /// Of each of these; empty where the stage is off.
    pub bodies: Vec<Body>,
}

impl Embodied<'_> {
    /// Body of a character; `None` where it is not among these, or the stage is off.
    pub fn body(&self, who: CharacterId) -> Option<&Body> {
        self.bodies.get(self.members.binary_search(&who).ok()?)
    }
}

/// Corrects everybody, where the scene wants it. `resampled`: the edit on the clock, whose clips are replaced.
/// Cost: linear in output frames, joints and constrained moments.
pub fn embody<'a>(scene: &'a Scene, edit: &'a Edit, resampled: &mut Resampled) -> Embodied<'a> {
    let moved = Moved { scene, characters: &edit.characters };
    let (objects, ties) = (object_motions(scene, &moved), Ties::of(scene));
    embody_some(&Stage { scene, performance: &moved, objects: &objects, ties: &ties }, resampled)
}

/// [`embody`] of those who are in `resampled`; all that one of them reaches must be ([`closed_groups`]).
pub fn embody_some<'a>(stage: &Stage<'_, Moved<'a>>, resampled: &mut Resampled) -> Embodied<'a> {
    let (scene, moved) = (stage.scene, *stage.performance);
    let members = resampled.members.clone();
    if !scene.full_body.enabled {
        return Embodied { moved, members, bodies: Vec::new() };
    }
    let start = resampled.start_time;
    let clocks: BTreeMap<CharacterId, (f64, usize)> =
        members.iter().zip(&resampled.clips).map(|(who, clip)| (*who, (start, clip.frame_count()))).collect();
    let mut done: BTreeMap<CharacterId, Body> = BTreeMap::new();
    for round in rounds(stage, &members) {
        let make = |so_far: &SoFar<'_>, who: CharacterId| body(stage, so_far, (who, clocks[&who]));
        let turn = |group: &Vec<CharacterId>| in_turn(stage.performance, &done, group, &make);
        let bodies: Vec<(CharacterId, Body)> = round.par_iter().flat_map_iter(turn).collect();
        done.extend(bodies);
    }
    let bodies: Vec<Body> = done.into_values().collect();
    show(&bodies, resampled);
    Embodied { moved, members, bodies }
}

/// Replaces the clips by what became of the bodies.
fn show(bodies: &[Body], resampled: &mut Resampled) {
    let start = resampled.start_time;
    for (clip, body) in resampled.clips.iter_mut().zip(bodies) {
        let frames = 0..clip.frame_count();
        let samples: Vec<usize> = frames.map(|frame| body.nearest(start + frame as f64 / clip.fps)).collect();
        let poses: Vec<Pose> = samples.iter().map(|sample| body.poses[*sample].clone()).collect();
        let planted: Vec<Contacts> = samples.iter().map(|sample| body.planted[*sample]).collect();
        let made = Clip::from_poses(&clip.name, Arc::clone(&clip.skeleton), clip.fps, &poses);
        *clip = Clip { contacts: stated_hands(&planted), ..made };
    }
}

/// What is to be stated of a clip whose points bear as in `planted`, one a frame: hands, which nobody finds.
pub fn stated_hands(planted: &[Contacts]) -> Vec<AnnotatedContact> {
    let of_point = |point: ContactPoint| {
        let bears: Vec<bool> = planted.iter().map(|contact| contact.at(point)).collect();
        let contact = move |(first, last)| AnnotatedContact {
            point,
            from: SourceFrame::from_usize(first),
            to: SourceFrame::from_usize(last),
        };
        runs(&bears).into_iter().map(contact)
    };
    [ContactPoint::LeftHand, ContactPoint::RightHand].into_iter().flat_map(of_point).collect()
}

/// Who is corrected when: groups of characters that reach each other, those of one round in parallel, each after all that it
/// reaches. Cost: quadratic in characters that reach one another in a row, linear in all others.
fn rounds<P>(stage: &Stage<'_, P>, members: &[CharacterId]) -> Vec<Vec<Vec<CharacterId>>> {
    let known: BTreeMap<CharacterId, BTreeSet<CharacterId>> =
        members.iter().map(|who| (*who, known_by(stage, *who))).collect();
    let mut rounds: BTreeMap<usize, Vec<Vec<CharacterId>>> = BTreeMap::new();
    for (who, others) in &known {
        let who = *who;
        let mutual = others.iter().filter(|other| known[other].contains(&who));
        let group: Vec<CharacterId> = mutual.copied().collect();
        if group[0] == who {
            // Who knows a group from outside knows more than it does.
            rounds.entry(others.len()).or_default().push(group);
        }
    }
    rounds.into_values().collect()
}

/// The characters of a scene in groups that reach nobody outside, in the order of the scene: what can be corrected one after the
/// other. Cost: linear in characters and end effectors.
pub fn closed_groups(scene: &Scene, ties: &Ties) -> Vec<Vec<CharacterId>> {
    let everybody = || (0..scene.characters.len()).map(CharacterId::from_usize);
    let mut beside: Vec<Vec<CharacterId>> = vec![Vec::new(); scene.characters.len()];
    for who in everybody() {
        for partner in partners(scene, ties, who) {
            beside[who.as_usize()].push(partner);
            beside[partner.as_usize()].push(who);
        }
    }
    let mut is_placed = vec![false; beside.len()];
    let mut groups = Vec::new();
    for first in everybody() {
        let (mut group, mut open) = (Vec::new(), vec![first]);
        while let Some(who) = open.pop() {
            if !std::mem::replace(&mut is_placed[who.as_usize()], true) {
                group.push(who);
                open.extend(&beside[who.as_usize()]);
            }
        }
        group.sort_unstable();
        groups.extend((!group.is_empty()).then_some(group));
    }
    groups
}

/// A character, all whose bodies it must know, and all whose these must.
fn known_by<P>(stage: &Stage<'_, P>, who: CharacterId) -> BTreeSet<CharacterId> {
    let mut known = BTreeSet::from([who]);
    let mut open = vec![who];
    while let Some(next) = open.pop() {
        let partners = partners(stage.scene, stage.ties, next);
        open.extend(partners.into_iter().filter(|partner| known.insert(*partner)));
    }
    known
}

/// Sweeps over characters that reach each other: after the second hands are where they meet, after the third also turned as asked
/// by a hand that goes with its forearm, after the fourth also where bodies have to come nearer.
const SWEEPS: usize = 4;

/// Corrects a group, each by `make`, which is told how everybody is so far; `done`: of everybody who is corrected already.
fn in_turn(
    moved: &Moved<'_>,
    done: &BTreeMap<CharacterId, Body>,
    group: &[CharacterId],
    make: &impl Fn(&SoFar<'_>, CharacterId) -> Body,
) -> Vec<(CharacterId, Body)> {
    let mut bodies: Vec<(CharacterId, Body)> = Vec::with_capacity(group.len());
    let sweeps = if group.len() > 1 { SWEEPS } else { 1 };
    for who in std::iter::repeat_n(group, sweeps).flatten() {
        let body = make(&SoFar { moved, done, group: &bodies }, *who);
        match bodies.iter_mut().find(|(known, _)| known == who) {
            Some((_, known)) => *known = body,
            None => bodies.push((*who, body)),
        }
    }
    bodies
}

/// Everybody as corrected so far.
struct SoFar<'a> {
    moved: &'a Moved<'a>,
    done: &'a BTreeMap<CharacterId, Body>,
    group: &'a [(CharacterId, Body)],
}

impl SoFar<'_> {
    fn body(&self, who: CharacterId) -> Option<&Body> {
        let in_group = self.group.iter().find(|(known, _)| *known == who).map(|(_, body)| body);
        in_group.or(self.done.get(&who))
    }
}

/// One character; `clock`: scene time of output frame 0, and how many the character has.
fn body(stage: &Stage<'_, Moved<'_>>, so_far: &SoFar<'_>, (who, clock): (CharacterId, (f64, usize))) -> Body {
    let (scene, moved) = (stage.scene, stage.performance);
    let times = sample_times((scene, stage.ties), moved, who, clock);
    let track = &scene.characters[who.as_usize()].track;
    let frames: Vec<f64> = times.iter().map(|time| moved.frame(who, *time)).collect();
    let effectors = effectors(stage, so_far, who, &times);
    let before: Vec<Pose> = frames.iter().map(|frame| moved.pose(who, *frame)).collect();
    let mut input = BodyInput {
        rest: frames.iter().map(|frame| track.pose(*frame)).collect(),
        moved: before.clone(),
        contacts: shown_contacts_at(track, &frames),
        effectors,
        seams: seams(track, &frames),
        source: source_jerks(scene, who),
        times,
    };
    hold_fingers(stage, who, (&input.times, &mut input.moved));
    let refined = refine(skeleton_of(scene, who), &input, plant_mode(scene));
    Body {
        times: input.times,
        moved: before,
        poses: refined.poses,
        planted: refined.planted,
        report: refined.report,
    }
}

fn plant_mode(scene: &Scene) -> PlantMode {
    match scene.full_body.plants {
        Plants::AsCaptured => PlantMode::AsCaptured,
        Plants::Pinned => PlantMode::Pinned,
        Plants::Whole => PlantMode::Whole,
    }
}

/// Where hands and other ends of somebody must be, as others are so far.
fn effectors(
    stage: &Stage<'_, Moved<'_>>,
    so_far: &SoFar<'_>,
    who: CharacterId,
    times: &[f64],
) -> Vec<Effector> {
    let mut targets = carry_targets(stage, who, times);
    let others = Others { performance: so_far, corrected: &|who| so_far.body(who).is_some() };
    targets.extend(effector_targets(stage, &others, who, times));
    targets.iter().map(effector).collect()
}

/// Scene times at which a character is looked at: output frames, and constrained moments between them; rising. `clock`: scene
/// time of output frame 0, and how many the character has.
pub fn sample_times(
    (scene, ties): (&Scene, &Ties),
    performance: &impl Performance,
    who: CharacterId,
    (start, count): (f64, usize),
) -> Vec<f64> {
    let fps = scene.fps;
    let frame_time = |frame: usize| start + frame as f64 / fps;
    let mut times: Vec<f64> = (0..count).map(frame_time).collect();
    let end = frame_time(count - 1);
    let is_between = |time: &f64| {
        let ticks = (time - start) * fps;
        (start..=end + 1.0 / fps).contains(time) && (ticks - ticks.round()).abs() > AT_FRAME * fps
    };
    times.extend(constrained_times((scene, ties), performance, who).into_iter().filter(is_between));
    times.sort_by(f64::total_cmp);
    times
}

fn effector(target: &JointTarget) -> Effector {
    let rotation = |index: usize| target.rotations.get(index).copied();
    let positions = target.positions.iter().enumerate();
    Effector {
        joint: target.joint,
        first: target.samples.start,
        targets: positions
            .map(|(index, position)| Target { position: *position, rotation: rotation(index) })
            .collect(),
        holds: matches!(target.source, Source::Carry(_)),
    }
}

impl Body {
    /// Sample nearest to a scene time.
    pub fn nearest(&self, time: f64) -> usize {
        let after = self.times.partition_point(|known| *known < time).min(self.times.len() - 1);
        let before = after.saturating_sub(1);
        if time - self.times[before] < self.times[after] - time { before } else { after }
    }

    /// `pose`, which is the character's before this stage at a scene time, with what the stage did around then.
    pub fn corrected(&self, mut pose: Pose, time: f64) -> Pose {
        let nearest = self.nearest(time);
        if (self.times[nearest] - time).abs() < AT_FRAME {
            return self.poses[nearest].clone();
        }
        let after = self.times.partition_point(|known| *known < time).clamp(1, self.times.len() - 1);
        let before = after - 1;
        let share = ((time - self.times[before]) / (self.times[after] - self.times[before])).clamp(0.0, 1.0);
        let shift = |sample: usize| self.poses[sample].root - self.moved[sample].root;
        pose.root += shift(before).lerp(shift(after), share);
        for (joint, rotation) in pose.rotations.iter_mut().enumerate() {
            let turn = |sample: usize| {
                self.moved[sample].rotations[joint].inverse() * self.poses[sample].rotations[joint]
            };
            *rotation = (*rotation * slerp(turn(before), turn(after), share)).normalize();
        }
        pose
    }
}

/// Pose at a fractional frame of a character's track, where `body` tells what became of it.
fn pose_of(moved: &Moved<'_>, body: Option<&Body>, (who, frame): (CharacterId, f64)) -> Pose {
    let pose = moved.pose(who, frame);
    match body {
        Some(body) if body.times.len() > 1 => body.corrected(pose, moved.time(who, frame)),
        _ => pose,
    }
}

impl Performance for SoFar<'_> {
    fn time(&self, who: CharacterId, frame: f64) -> f64 {
        self.moved.time(who, frame)
    }

    fn frame(&self, who: CharacterId, seconds: f64) -> f64 {
        self.moved.frame(who, seconds)
    }

    fn pose(&self, who: CharacterId, frame: f64) -> Pose {
        pose_of(self.moved, self.body(who), (who, frame))
    }
}

impl Performance for Embodied<'_> {
    fn time(&self, who: CharacterId, frame: f64) -> f64 {
        self.moved.time(who, frame)
    }

    fn frame(&self, who: CharacterId, seconds: f64) -> f64 {
        self.moved.frame(who, seconds)
    }

    fn pose(&self, who: CharacterId, frame: f64) -> Pose {
        pose_of(&self.moved, self.body(who), (who, frame))
    }
}
