//! What a character performs: runs of source frames, placed on the ground, and where every frame comes from.

use std::sync::Arc;

use crate::clip::facing::facing;
use crate::clip::working::WorkingClip;
use crate::constraint::Instant;
use crate::geometry::{RigidMotion, c64, exp, log, slerp, smoothstep, yaw};
use crate::index::{FrameIndex, floor_index};
use crate::path::RestPath;
use crate::similarity::{admissible, features, mean_rotations};
use crate::skeleton::Pose;

/// Frames of one clip that a track shows one after another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Run {
    /// Position of the clip in [`Track::clips`], which is its position in the character's `track` list.
    pub entry: usize,
    /// First working frame of the clip.
    pub first: FrameIndex,
    /// Last working frame of the clip, included; not before `first`.
    pub last: FrameIndex,
    /// Where the clip's ground plan lies in the scene.
    pub placement: RigidMotion,
}

/// A character's motion before the edit: runs of source frames; nothing per frame is copied.
#[derive(Clone, Debug, PartialEq)]
pub struct Track {
    /// Clips of the `track` list, in order (the same clip may come twice).
    pub clips: Vec<Arc<WorkingClip>>,
    /// At least one, in playing order.
    pub runs: Vec<Run>,
}

/// A frame that must not be dropped when clips are strung, and what names it.
#[derive(Clone, Debug, PartialEq)]
pub struct Protected {
    /// Position in the `track` list.
    pub entry: usize,
    /// Working frame of that clip, a fraction.
    pub working: f64,
    /// Name of the moment.
    pub moment: String,
}

/// What stringing did at one seam.
#[derive(Clone, Debug, PartialEq)]
pub struct SeamChoice {
    /// Position in the `track` list of the clip before the seam.
    pub entry: usize,
    /// Distance of the two matched frames, as in [`crate::similarity`].
    pub distance: f64,
    /// Largest distance at which frames count as similar.
    pub admissible: f64,
    /// Moments whose frames narrowed the search: they may not be dropped.
    pub held_by: Vec<String>,
}

/// Half-width of a seam's blend, frames.
const BLEND: f64 = 10.0;
/// Clips are joined in the last and the first second of their ranges, frames.
const SEAM_WINDOW: usize = 30;

impl Track {
    /// Strings `clips` one after another at well-matching frames, aligned by the root.
    ///
    /// Clip A is shown up to its frame e, then B from b: of the last second of A and the first of B (at most half of each)
    /// the pair whose frames e and b−1 are most alike; of equals, the one that drops the fewest frames.
    /// `protected`: frames that must stay, with one on either side. `start`: where the first frame's root goes and how its
    /// body faces there; what is left out stays as in the clip.
    pub fn string(
        clips: Vec<Arc<WorkingClip>>,
        protected: &[Protected],
        start: (Option<c64>, Option<f64>),
    ) -> (Self, Vec<SeamChoice>) {
        let mut firsts = vec![0; clips.len()];
        let mut lasts: Vec<usize> = clips.iter().map(|clip| clip.frame_count() - 1).collect();
        let mut seams = Vec::new();
        for entry in 0..clips.len().saturating_sub(1) {
            let seam = best_seam(&clips, entry, firsts[entry], protected);
            lasts[entry] = seam.last;
            firsts[entry + 1] = seam.first;
            seams.push(seam.choice);
        }
        let runs = (0..clips.len())
            .map(|entry| Run {
                entry,
                first: FrameIndex::from_usize(firsts[entry]),
                last: FrameIndex::from_usize(lasts[entry]),
                placement: RigidMotion::IDENTITY,
            })
            .collect();
        let mut track = Self { clips, runs };
        track.place(start);
        (track, seams)
    }

    /// Places the first run by `start`, each later run on the one before it.
    fn place(&mut self, (position, facing): (Option<c64>, Option<f64>)) {
        let clip = &self.clips[self.runs[0].entry];
        let first = self.runs[0].first.as_usize();
        let (from, heading) = (clip.positions[first], clip.headings[first]);
        self.runs[0].placement = match (position, facing) {
            (None, None) => RigidMotion::IDENTITY,
            _ => RigidMotion::carrying(
                from,
                position.unwrap_or(from),
                facing.map_or(0.0, |facing| facing - heading),
            ),
        };
        for index in 1..self.runs.len() {
            self.runs[index].placement = self.aligned(index);
        }
    }

    /// Rigid motion that lays the frame before run `index` onto the placed last frame of the run before it.
    fn aligned(&self, index: usize) -> RigidMotion {
        let (before, after) = (&self.runs[index - 1], &self.runs[index]);
        let source = &self.clips[before.entry];
        let last = before.last.as_usize();
        let target = &self.clips[after.entry];
        let (position, heading) = predecessor(target, after.first.as_usize());
        let turn = before.placement.angle() + source.headings[last] - heading;
        RigidMotion::carrying(position, before.placement.apply(source.positions[last]), turn)
    }

    /// Number of working frames.
    pub fn frame_count(&self) -> usize {
        self.runs.iter().map(Run::frame_count).sum()
    }

    /// What lies between the last working frame and the last frame of the file, working frames below 1.
    pub fn overhang(&self) -> f64 {
        let run = &self.runs[self.runs.len() - 1];
        let clip = &self.clips[run.entry];
        if run.last.as_usize() + 1 == clip.frame_count() { clip.overhang } else { 0.0 }
    }

    /// Track frame, a fraction where rates differ, of `instant`; `None` if the track does not show it. File frames past
    /// the last working frame of a clip that others follow are shown within the seam.
    pub fn locate(&self, instant: Instant) -> Option<f64> {
        let end = self.frame_count() as f64 - 1.0;
        let runs_of = |entry: usize| self.placed_runs().filter(move |(run, _)| run.entry == entry);
        let last_of = |run: &Run, start: usize| (start + run.frame_count() - 1) as f64;
        match instant {
            Instant::TrackStart => Some(0.0),
            Instant::TrackEnd => Some(end + self.overhang()),
            Instant::ClipStart(entry) => runs_of(entry).next().map(|(_, start)| start as f64),
            Instant::ClipEnd(entry) => runs_of(entry).last().map(|(run, start)| {
                let last = last_of(run, start);
                if last == end { end + self.overhang() } else { last }
            }),
            Instant::Frame { entry, working } => runs_of(entry).find_map(|(run, start)| {
                let offset = working - f64::from(run.first.0);
                let clip = &self.clips[run.entry];
                let whole = run.last.as_usize() + 1 == clip.frame_count();
                let reach = last_of(run, start) - start as f64 + if whole { clip.overhang } else { 0.0 };
                (-1e-9..=reach + 1e-9).contains(&offset).then(|| start as f64 + offset.clamp(0.0, reach))
            }),
        }
    }

    /// Runs with the track frame each starts at.
    pub fn placed_runs(&self) -> impl Iterator<Item = (&Run, usize)> {
        self.runs.iter().scan(0, |next, run| {
            let start = *next;
            *next += run.frame_count();
            Some((run, start))
        })
    }

    /// Position of the run that shows track frame `frame`, and the frame it starts at.
    fn run_at(&self, frame: usize) -> (usize, usize) {
        let mut start = 0;
        for (index, run) in self.runs.iter().enumerate() {
            if frame < start + run.frame_count() {
                return (index, start);
            }
            start += run.frame_count();
        }
        let last = self.runs.len() - 1;
        (last, start - self.runs[last].frame_count())
    }

    /// A value of each working frame, looked up in the clips.
    pub fn collect<T>(&self, value: impl Fn(&WorkingClip, usize, &RigidMotion) -> T) -> Vec<T> {
        let mut values = Vec::with_capacity(self.frame_count());
        for run in &self.runs {
            let clip = &self.clips[run.entry];
            values
                .extend((run.first.as_usize()..=run.last.as_usize()).map(|f| value(clip, f, &run.placement)));
        }
        values
    }

    /// Path of the track before the edit: placed positions, facings, stationary stretches.
    pub fn rest_path(&self) -> RestPath {
        let positions = self.collect(|clip, frame, placement| placement.apply(clip.positions[frame]));
        let mut headings = self.collect(|clip, frame, placement| clip.headings[frame] + placement.angle());
        crate::path::unwrap(&mut headings);
        let still = self.collect(|clip, frame, _| clip.stationary[frame]);
        RestPath { positions, headings, rigid: stretches(&still) }
    }

    /// Placed rest pose at a fractional track frame, sampled from the source at its own rate, blended at seams.
    pub fn pose(&self, frame: f64) -> Pose {
        let count = self.frame_count();
        let low = floor_index(frame).min(count - 1);
        let (index, start) = self.run_at(low);
        let run = &self.runs[index];
        let last = start + run.frame_count() - 1;
        if frame <= last as f64 || index + 1 == self.runs.len() {
            return self.run_pose(index, start, frame);
        }
        let before = self.run_pose(index, start, last as f64);
        let after = self.run_pose(index + 1, last + 1, (last + 1) as f64);
        interpolate(&before, &after, frame - last as f64)
    }

    /// Facing of the body in the placed rest pose at a fractional track frame, radians; where the pose does not show it,
    /// that of the clip.
    pub fn heading(&self, frame: f64) -> f64 {
        let (index, start) = self.run_at(floor_index(frame).min(self.frame_count() - 1));
        let run = &self.runs[index];
        let clip = &self.clips[run.entry];
        let working = f64::from(run.first.0) + frame - start as f64;
        let known = clip.facing(working.min(f64::from(run.last.0) + clip.overhang)) + run.placement.angle();
        let skeleton = &clip.clip.skeleton;
        facing(skeleton, &skeleton.forward_kinematics(&self.pose(frame))).unwrap_or(known)
    }

    /// Placed pose of one run, with its share of the blends at both ends.
    fn run_pose(&self, index: usize, start: usize, frame: f64) -> Pose {
        let run = &self.runs[index];
        let clip = &self.clips[run.entry];
        let working = f64::from(run.first.0) + frame - start as f64;
        let mut pose = clip.pose(working);
        pose.root = run.placement.apply_world(pose.root);
        pose.rotations[0] = yaw(run.placement.angle()) * pose.rotations[0];
        if index > 0 {
            let gone = working - (f64::from(run.first.0) - 1.0);
            self.blend(index, gone, 0.5, &mut pose);
        }
        if index + 1 < self.runs.len() {
            let left = f64::from(run.last.0) - working;
            self.blend(index + 1, left, -0.5, &mut pose);
        }
        pose
    }

    /// Adds `share` of the jump at the seam before run `index`, faded over `distance` frames from it, to a pose.
    fn blend(&self, index: usize, distance: f64, share: f64, pose: &mut Pose) {
        let (before, after) = (&self.runs[index - 1], &self.runs[index]);
        let shorter = before.frame_count().min(after.frame_count()) as f64;
        let width = BLEND.min(shorter / 2.0);
        if distance >= width {
            return;
        }
        let fade = share * (1.0 - smoothstep(distance / width));
        let (target, source) = (&self.clips[before.entry], &self.clips[after.entry]);
        let shown = target.pose(f64::from(before.last.0));
        let left = source.pose(f64::from(after.first.0.saturating_sub(1)));
        pose.root.y += fade * (shown.root.y - left.root.y);
        let (first, b) = (before.last.as_usize(), after.first.as_usize().saturating_sub(1));
        for (joint, rotation) in pose.rotations.iter_mut().enumerate() {
            let (from, to) = match joint {
                0 => (
                    yaw(-source.headings[b]) * left.rotations[0],
                    yaw(-target.headings[first]) * shown.rotations[0],
                ),
                _ => (left.rotations[joint], shown.rotations[joint]),
            };
            *rotation = (*rotation * exp(log(from.inverse() * to) * fade)).normalize();
        }
    }
}

impl Run {
    /// Number of working frames.
    pub fn frame_count(&self) -> usize {
        (self.last.0 - self.first.0 + 1) as usize
    }
}

/// Position and heading of the frame before `first`: extrapolated before a clip's first frame.
fn predecessor(clip: &WorkingClip, first: usize) -> (c64, f64) {
    match first {
        0 if clip.frame_count() > 1 => (2.0 * clip.positions[0] - clip.positions[1], clip.headings[0]),
        0 => (clip.positions[0], clip.headings[0]),
        _ => (clip.positions[first - 1], clip.headings[first - 1]),
    }
}

/// Maximal runs of true; ones nearer than three frames are joined.
fn stretches(flags: &[bool]) -> Vec<(usize, usize)> {
    let mut runs: Vec<(usize, usize)> = Vec::new();
    for (frame, _) in flags.iter().enumerate().filter(|(_, flag)| **flag) {
        match runs.last_mut() {
            Some((_, last)) if frame - *last <= 3 => *last = frame,
            _ => runs.push((frame, frame)),
        }
    }
    runs.retain(|(first, last)| last > first);
    runs
}

/// Two placed poses, mixed.
fn interpolate(a: &Pose, b: &Pose, s: f64) -> Pose {
    Pose {
        root: a.root.lerp(b.root, s),
        rotations: a.rotations.iter().zip(&b.rotations).map(|(from, to)| slerp(*from, *to, s)).collect(),
        offsets: if s < 0.5 { a.offsets.clone() } else { b.offsets.clone() },
    }
}

struct Seam {
    last: usize,
    first: usize,
    choice: SeamChoice,
}

/// The best pair of frames to join entries `entry` and `entry + 1`; the first of them starts at frame `start`.
fn best_seam(clips: &[Arc<WorkingClip>], entry: usize, start: usize, protected: &[Protected]) -> Seam {
    let (a, b) = (&clips[entry], &clips[entry + 1]);
    let range = |clip: &WorkingClip| (clip.frame_count() / 2).min(SEAM_WINDOW);
    let frames_of = |entry: usize| protected.iter().filter(move |frame| frame.entry == entry);
    let keep_from = frames_of(entry).map(|frame| floor_index(frame.working.ceil()) + 1).max().unwrap_or(0);
    let keep_to = frames_of(entry + 1).map(|frame| floor_index(frame.working).saturating_sub(1)).min();
    let a_last = a.frame_count() - 1;
    let earliest = (a.frame_count() - 1 - range(a)).max(keep_from.min(a_last)).max(start);
    let latest = range(b).min(keep_to.unwrap_or(usize::MAX));
    let mean = mean_rotations(&[a, b]);
    let (features_a, features_b) = (features(a, &mean), features(b, &mean));
    let mut best: Option<(bool, f64, usize, usize, usize)> = None;
    for last in earliest..=a_last {
        for first in 0..=latest {
            let matched = first.saturating_sub(1);
            let apart = a.contacts[last] != b.contacts[matched];
            let distance = features_a.distance(last, &features_b, matched);
            let dropped = a_last - last + first;
            let key = (apart, distance, dropped, last, first);
            let better = best.is_none_or(|known| {
                key.0.cmp(&known.0).then(key.1.total_cmp(&known.1)).then(key.2.cmp(&known.2)).is_lt()
            });
            if better {
                best = Some(key);
            }
        }
    }
    let (_, distance, _, last, first) =
        best.expect("the last frame of one clip and the first of the next may always meet");
    let largest = |clip, features| admissible(&[(clip, features)]).largest;
    let admissible = largest(a, &features_a).max(largest(b, &features_b));
    let free = |entry: usize| protected.iter().filter(move |frame| frame.entry == entry);
    let window = (a.frame_count() - 1 - range(a), range(b));
    let mut held_by: Vec<String> = free(entry)
        .filter(|frame| floor_index(frame.working.ceil()) + 1 > window.0)
        .chain(free(entry + 1).filter(|frame| floor_index(frame.working) <= window.1))
        .map(|frame| frame.moment.clone())
        .collect();
    held_by.sort_unstable();
    held_by.dedup();
    Seam { last, first, choice: SeamChoice { entry, distance, admissible, held_by } }
}
