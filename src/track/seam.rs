//! Seams: how a run is laid onto the one before it, and how the poses on both sides are blended.

use crate::clip::contacts::{ContactPoint, contact_point};
use crate::clip::working::{WORKING_STEP, WorkingClip};
use crate::geometry::{RigidMotion, c64, exp, log, plan_of, smoothstep, wrap, yaw};
use crate::index::floor_index;
use crate::skeleton::Pose;
use crate::track::Track;

/// Half-width of a seam's blend, frames.
const BLEND: f64 = 10.0;
/// Somebody whose root is slower than this stands, m/s.
const STANDING: f64 = 0.3;
/// Planted points that an alignment by the feet needs.
const FEWEST_POINTS: usize = 3;

/// How a run is laid onto the one before it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SeamRule {
    /// Root onto root, facing onto facing.
    Root,
    /// By the planted feet where somebody stands on both of them on both sides; else by the root.
    #[default]
    PlantedFeet,
}

/// What lies between the root at the last frame of a run and the frame before the next run, as placed: it is spread over
/// the frames around the seam.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Jump {
    /// Of the root on the ground, metres.
    pub shift: c64,
    /// Of the facing, radians.
    pub turn: f64,
}

impl Track {
    /// Rigid motion that lays the frame before run `index` onto the placed last frame of the run before it, and what the
    /// root then still misses.
    pub(super) fn aligned(&self, index: usize) -> (RigidMotion, Jump) {
        let (before, after) = (&self.runs[index - 1], &self.runs[index]);
        let (source, target) = (&self.clips[before.entry], &self.clips[after.entry]);
        let (last, first) = (before.last.as_usize(), after.first.as_usize());
        let (position, heading) = predecessor(target, first);
        let (place, facing) = (
            before.placement.apply(source.positions[last]),
            before.placement.angle() + source.headings[last],
        );
        let feet = match self.rule {
            SeamRule::PlantedFeet if first > 0 => standing_fit((source, last), (target, first - 1)),
            _ => None,
        };
        let Some(fit) = feet else {
            return (RigidMotion::carrying(position, place, facing - heading), Jump::default());
        };
        let placement = fit.then(&before.placement);
        let jump = Jump {
            shift: place - placement.apply(position),
            turn: wrap(facing - heading - placement.angle()),
        };
        (placement, jump)
    }

    /// Width of the blend at the seam before run `index`, frames on either side.
    fn blend_width(&self, index: usize) -> f64 {
        let shorter = self.runs[index - 1].frame_count().min(self.runs[index].frame_count()) as f64;
        BLEND.min(shorter / 2.0)
    }

    /// Spreads the jumps of the root over the frames around their seams. Cost: linear in seams and their blends.
    pub(super) fn make_good(&self, positions: &mut [c64], headings: &mut [f64]) {
        for (index, (run, start)) in self.placed_runs().enumerate().skip(1) {
            let Jump { shift, turn } = run.jump;
            if run.jump == Jump::default() {
                continue;
            }
            let width = self.blend_width(index);
            let mut add = |frame: usize, share: f64| {
                positions[frame] += share * shift;
                headings[frame] += share * turn;
            };
            let mut distance = 0;
            while f64::from(distance) < width {
                let share = 0.5 * (1.0 - smoothstep(f64::from(distance) / width));
                add(start - 1 - distance as usize, -share);
                if distance > 0 {
                    add(start + distance as usize - 1, share);
                }
                distance += 1;
            }
        }
    }

    /// Pose of a run's clip at a fractional working frame, where the run lies.
    fn placed(&self, index: usize, working: f64) -> Pose {
        let run = &self.runs[index];
        let mut pose = self.clips[run.entry].pose(working);
        pose.root = run.placement.apply_world(pose.root);
        pose.rotations[0] = yaw(run.placement.angle()) * pose.rotations[0];
        pose
    }

    /// Placed pose at a fractional track frame without the blends at seams; between two runs, that of the later one, whose
    /// frame before its first stands for the last of the earlier one.
    pub fn unblended(&self, frame: f64) -> Pose {
        let (index, start) = self.run_at(floor_index(frame).min(self.frame_count() - 1));
        let run = &self.runs[index];
        let past = frame - (start + run.frame_count() - 1) as f64;
        match self.runs.get(index + 1) {
            Some(next) if past > 0.0 => {
                self.placed(index + 1, (f64::from(next.first.0) - 1.0 + past).max(0.0))
            }
            _ => self.placed(index, f64::from(run.first.0) + frame - start as f64),
        }
    }

    /// The two poses that the seam before run `index`, at least the second, takes for one, as placed: the last of the run before
    /// it, and the one before its first (its first, where the clip has none before).
    pub fn matched(&self, index: usize) -> [Pose; 2] {
        let (before, after) = (&self.runs[index - 1], &self.runs[index]);
        [
            self.placed(index - 1, f64::from(before.last.0)),
            self.placed(index, f64::from(after.first.0.saturating_sub(1))),
        ]
    }

    /// Placed pose of one run, with its share of the blends at both ends.
    pub(super) fn run_pose(&self, index: usize, start: usize, frame: f64) -> Pose {
        let run = &self.runs[index];
        let working = f64::from(run.first.0) + frame - start as f64;
        let mut pose = self.placed(index, working);
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
        let width = self.blend_width(index);
        if distance >= width {
            return;
        }
        let fade = share * (1.0 - smoothstep(distance / width));
        let (before, after) = (&self.runs[index - 1], &self.runs[index]);
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
        if after.jump != Jump::default() {
            pose.root.x += fade * after.jump.shift.re;
            pose.root.z -= fade * after.jump.shift.im;
            pose.rotations[0] = yaw(fade * after.jump.turn) * pose.rotations[0];
        }
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

/// Rigid motion of the ground that lays frame `b` of a clip onto frame `a` of another by the points of the feet that are
/// planted in both, where somebody stands on both feet in both; `None` elsewhere. Least squares.
fn standing_fit((a, at): (&WorkingClip, usize), (b, from): (&WorkingClip, usize)) -> Option<RigidMotion> {
    let both = a.contacts[at].both_feet() && b.contacts[from].both_feet();
    if !both || speed(a, at) >= STANDING || speed(b, from) >= STANDING {
        return None;
    }
    let planted = |point: &ContactPoint| a.contacts[at].at(*point) && b.contacts[from].at(*point);
    let points: Vec<ContactPoint> = ContactPoint::FEET.into_iter().filter(planted).collect();
    if points.len() < FEWEST_POINTS {
        return None;
    }
    let (to, own) = (feet(a, at, &points)?, feet(b, from, &points)?);
    let count = points.len() as f64;
    let (middle, centre) = (to.iter().sum::<c64>() / count, own.iter().sum::<c64>() / count);
    let cross: c64 = to.iter().zip(&own).map(|(p, q)| (p - middle) * (q - centre).conj()).sum();
    (cross.norm() > f64::EPSILON).then(|| RigidMotion::carrying(centre, middle, cross.arg()))
}

/// Ground points of the feet in a working frame.
fn feet(clip: &WorkingClip, frame: usize, points: &[ContactPoint]) -> Option<Vec<c64>> {
    let skeleton = &clip.clip.skeleton;
    let frames = skeleton.forward_kinematics(&clip.pose(frame as f64));
    points.iter().map(|point| Some(plan_of(contact_point(skeleton, *point)?.place(&frames)))).collect()
}

/// Speed of the root on the ground, m/s.
fn speed(clip: &WorkingClip, frame: usize) -> f64 {
    let (before, after) = (frame.saturating_sub(1), (frame + 1).min(clip.frame_count() - 1));
    (clip.positions[after] - clip.positions[before]).norm()
        / (((after - before).max(1)) as f64 * WORKING_STEP)
}
