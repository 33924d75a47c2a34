//! One flight.

use std::ops::Range;

use glam::{DQuat, DVec3};

use crate::clip::{Clip, MovingOffset};
use crate::geometry::{exp, log};
use crate::limb::minimal_rotation;
use crate::physics::body_model::BodyModel;
use crate::physics::derivatives::Kernel;
use crate::physics::derivatives::orientation::smooth_logs;
use crate::physics::flight::halves::Half;
use crate::physics::flight::momentum::pairs;
use crate::physics::flight::parabola::{Parabola, parabola};
use crate::physics::flight::turning::{Aim, Settled, aimed, end_preserving_momentum, mean_momentum, settled};
use crate::physics::flight::{FlightSettings, FlightStep, MomentumTarget};
use crate::physics::ground::displacement::replace;
use crate::physics::posed::{PosedClip, centers_of_mass, link_places};

/// Frames of a flight and of its borders on the ground.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Block {
    /// Last frame on the ground before, or the first of the clip.
    pub(super) first: usize,
    /// First frame on the ground after, or the last of the clip.
    pub(super) last: usize,
    /// Whether these are on the ground: not where a clip starts or ends in the air.
    pub(super) held: [bool; 2],
}

/// What a flight became.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Path {
    pub(super) parabola: Parabola,
    /// Its momentum.
    pub(super) aim: Aim,
    pub(super) newton_steps: usize,
    /// Largest turn of the body against the input, radians.
    pub(super) largest_turn: f64,
    /// Of the last frame, against the first: what neighbours are to fade out.
    pub(super) landing_turn: DQuat,
}

impl Block {
    /// The flight in the frames `first` to `last` of a clip.
    pub(super) fn of((first, last): (usize, usize), frame_count: usize) -> Self {
        let held = [first > 0, last + 1 < frame_count];
        Self { first: first - usize::from(held[0]), last: last + usize::from(held[1]), held }
    }

    /// Frames in the air.
    pub(super) fn airborne(&self) -> Range<usize> {
        self.first + usize::from(self.held[0])..self.last + 1 - usize::from(self.held[1])
    }

    fn frame_count(&self) -> usize {
        self.last + 1 - self.first
    }

    /// Its frames of `clip`, without annotations.
    pub(super) fn cut(&self, clip: &Clip) -> Clip {
        let joints = clip.skeleton.joints.len();
        let frames = self.first..self.last + 1;
        let moving = |moving: &MovingOffset| MovingOffset {
            joint: moving.joint,
            offsets: moving.offsets[frames.clone()].to_vec(),
        };
        Clip {
            name: String::new(),
            skeleton: clip.skeleton.clone(),
            fps: clip.fps,
            root_positions: clip.root_positions[frames.clone()].to_vec(),
            rotations: clip.rotations[frames.start * joints..frames.end * joints].to_vec(),
            moving_offsets: clip.moving_offsets.iter().map(moving).collect(),
            events: std::collections::BTreeMap::new(),
            contacts: Vec::new(),
            usable: clip.usable,
        }
    }

    /// Flies `own`, its frames ([`Self::cut`]), so that it falls by `gravity`, m/s².
    pub(super) fn fly(
        &self,
        own: &mut Clip,
        body: &BodyModel,
        gravity: f64,
        settings: &FlightSettings,
    ) -> Path {
        for step in &settings.steps {
            self.step(own, body, gravity, step);
        }
        let posed = PosedClip::of(own);
        let mut settled = self.settle(body, &posed, settings.target);
        let is_kept = settled.keeps_end();
        if is_kept {
            settled.ramp_off();
        }
        let largest_turn = settled.turns.iter().map(|turn| log(*turn).length()).fold(0.0, f64::max);
        let mut landing_turn = settled.turns.last().copied().unwrap_or(DQuat::IDENTITY);
        if self.held == [false, true] && !is_kept {
            // Landed without a turn: the start, of which nothing is known, is turned instead.
            let back = landing_turn.inverse();
            settled.turns.iter_mut().for_each(|turn| *turn = back * *turn);
            landing_turn = DQuat::IDENTITY;
        }
        let centers = centers_of_mass(body, &link_places(body, &posed));
        let parabola = parabola(&centers, posed.step(), gravity, self.held);
        for (frame, (center, turn)) in centers.iter().zip(&settled.turns).enumerate() {
            if !self.is_border(frame) || *turn != DQuat::IDENTITY {
                place(own, frame, (*center, parabola.at(frame as f64 * posed.step())), *turn);
            }
        }
        let Settled { aim, newton_steps, .. } = settled;
        Path { parabola, aim, newton_steps, largest_turn, landing_turn }
    }

    /// Whether `frame`, counted from its first, is on the ground.
    fn is_border(&self, frame: usize) -> bool {
        (frame == 0 && self.held[0]) || (frame + 1 == self.frame_count() && self.held[1])
    }

    fn settle(&self, body: &BodyModel, posed: &PosedClip, target: MomentumTarget) -> Settled {
        let pairs = pairs(body, posed, (0, posed.frame_count() - 1), None);
        let towards = |target: DVec3| {
            let aimed = aimed(&pairs, Aim { target, share: 1.0 });
            if aimed.is_exact() { aimed } else { settled(&pairs, 1.0) }
        };
        match target {
            MomentumTarget::Landing => settled(&pairs, 1.0),
            MomentumTarget::FirstOrder => towards(end_preserving_momentum(&pairs)),
            MomentumTarget::Mean => towards(mean_momentum(&pairs)),
        }
    }

    /// Turns a half a part of the way, first to the momentum, then to the parabola.
    fn step(&self, own: &mut Clip, body: &BodyModel, gravity: f64, step: &FlightStep) {
        let Some(half) = Half::of(&own.skeleton, body, step.half) else { return };
        let kernel = Kernel::gaussian(step.width, own.fps);
        let posed = PosedClip::of(own);
        let pairs = pairs(body, &posed, (0, posed.frame_count() - 1), Some(&half));
        let mut settled = settled(&pairs, step.share);
        settled.ramp_off();
        half.turn(own, &posed, 0, &self.held_still(smooth_logs(&settled.turns, &kernel)));
        let posed = PosedClip::of(own);
        let turns = self.swings(body, &posed, &half, (gravity, step.share));
        half.turn(own, &posed, 0, &self.held_still(smooth_logs(&turns, &kernel)));
    }

    /// Turns of a half towards where the centre of mass would be on the parabola. They meet the direction only: its distance from
    /// the pivot stays.
    fn swings(
        &self,
        body: &BodyModel,
        posed: &PosedClip,
        half: &Half,
        (gravity, share): (f64, f64),
    ) -> Vec<DQuat> {
        let places = link_places(body, posed);
        let centers = centers_of_mass(body, &places);
        let parabola = parabola(&centers, posed.step(), gravity, self.held);
        let own: Vec<(usize, f64)> = body
            .links
            .iter()
            .enumerate()
            .filter(|(_, link)| half.turns(link.joint))
            .map(|(index, link)| (index, link.mass))
            .collect();
        let mass: f64 = own.iter().map(|(_, mass)| mass).sum();
        let swing = |(frame, center): (usize, &DVec3)| {
            let pivot = posed.at(frame, half.border).position;
            let sum: DVec3 = own.iter().map(|(index, mass)| *mass * places.vector(*index, frame)).sum();
            let arm = sum / mass - pivot;
            let miss = parabola.at(frame as f64 * posed.step()) - *center;
            swung(arm, arm + miss * (body.mass / mass), share)
        };
        centers.iter().enumerate().map(swing).collect()
    }

    /// `turns` which on the ground are none, as they are but for rounding.
    fn held_still(&self, mut turns: Vec<DQuat>) -> Vec<DQuat> {
        for (frame, turn) in turns.iter_mut().enumerate().filter(|(frame, _)| self.is_border(*frame)) {
            debug_assert!(log(*turn).length() < 1e-6, "frame {frame} was turned");
            *turn = DQuat::IDENTITY;
        }
        turns
    }

    /// Writes `own`, its flown frames, into `clip`; `turns`: of the borders, of which the second has what the first has not.
    pub(super) fn put(&self, clip: &mut Clip, mut own: Clip, body: &BodyModel, turns: [DQuat; 2]) {
        let joints = clip.skeleton.joints.len();
        if turns[0] != DQuat::IDENTITY {
            for (frame, center) in centers(&own, body).into_iter().enumerate() {
                place(&mut own, frame, (center, center), turns[0]);
            }
        }
        clip.root_positions[self.first..=self.last].copy_from_slice(&own.root_positions);
        clip.rotations[self.first * joints..(self.last + 1) * joints].copy_from_slice(&own.rotations);
    }
}

/// A half's centre of mass nearer than this to its pivot tells no direction, metres …
const SHORTEST_ARM: f64 = 0.01;
/// … and one on the other side, by this cosine, no axis.
const OPPOSITE: f64 = -0.999;

/// `share` of the shortest turn from `from` to the direction of `to`.
fn swung(from: DVec3, to: DVec3, share: f64) -> DQuat {
    let is_told = from.length() > SHORTEST_ARM && to.length() > SHORTEST_ARM;
    if !is_told || from.normalize().dot(to.normalize()) < OPPOSITE {
        return DQuat::IDENTITY;
    }
    exp(share * log(minimal_rotation(from, to)))
}

/// Centres of mass in all frames of `clip`, metres.
pub(super) fn centers(clip: &Clip, body: &BodyModel) -> Vec<DVec3> {
    centers_of_mass(body, &link_places(body, &PosedClip::of(clip)))
}

/// Turns the body in one frame about its centre of mass, and moves that.
pub(super) fn place(clip: &mut Clip, frame: usize, (from, to): (DVec3, DVec3), turn: DQuat) {
    let root = clip.root_positions[frame];
    clip.root_positions[frame] = to + turn * (root - from);
    if turn != DQuat::IDENTITY {
        let local = &mut clip.rotations[frame * clip.skeleton.joints.len()];
        replace(local, turn * *local);
    }
}
