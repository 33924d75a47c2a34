//! What a character performs: runs of source frames, placed on the ground, and where every frame comes from.

mod seam;
mod splice;
mod string;

use std::sync::Arc;

use crate::clip::facing::pose_facing;
use crate::clip::working::WorkingClip;
use crate::constraint::Instant;
use crate::geometry::{RigidMotion, c64, slerp};
use crate::index::{FrameIndex, floor_index};
use crate::path::RestPath;
use crate::skeleton::Pose;

pub use seam::{Jump, SeamRule};
pub use splice::{Keep, Splice, Stretch};
pub use string::{Protected, SeamChoice};

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
    /// What the root has to make good at the seam before this run; nothing where the root was aligned.
    pub jump: Jump,
}

/// A character's motion before the edit: runs of source frames; nothing per frame is copied.
#[derive(Clone, Debug, PartialEq)]
pub struct Track {
    /// Clips of the `track` list, in order (the same clip may come twice).
    pub clips: Vec<Arc<WorkingClip>>,
    /// At least one, in playing order.
    pub runs: Vec<Run>,
    /// How runs are aligned.
    pub rule: SeamRule,
}

impl Track {
    /// Places the first run by `start`, each later run on the one before it.
    pub fn place(&mut self, (position, facing): (Option<c64>, Option<f64>)) {
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
        self.place_from(1);
    }

    /// Places run `first`, at least the second, and all after it on the ones before them.
    fn place_from(&mut self, first: usize) {
        for index in first..self.runs.len() {
            (self.runs[index].placement, self.runs[index].jump) = self.aligned(index);
        }
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
            Instant::Shown(frame) => (0.0..=end + self.overhang() + 1e-9).contains(&frame).then_some(frame),
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
        let mut positions = self.collect(|clip, frame, placement| placement.apply(clip.positions[frame]));
        let mut headings = Vec::with_capacity(positions.len());
        for run in &self.runs {
            let (own, angle) = (&self.clips[run.entry].headings, run.placement.angle());
            let frames = run.first.as_usize()..=run.last.as_usize();
            headings.extend(own[frames].iter().map(|heading| heading + angle));
        }
        crate::path::unwrap(&mut headings);
        self.make_good(&mut positions, &mut headings);
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
        pose_facing(skeleton, &self.pose(frame)).unwrap_or(known)
    }
}

impl Run {
    /// Number of working frames.
    pub fn frame_count(&self) -> usize {
        (self.last.0 - self.first.0 + 1) as usize
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
