//! Frames on the ground beside a flight: what its borders are turned by fades out there.
//!
//! A flight that keeps its landing leaves nothing to do. Feet that stand are brought back to where they were, in frames on the ground
//! alone: legs that move in the air would spoil its momentum.

use glam::DQuat;

use crate::clip::Clip;
use crate::geometry::{exp, log, smoothstep};
use crate::index::floor_index;
use crate::physics::body_model::BodyModel;
use crate::physics::flight::block::{Block, centers, place};
use crate::physics::flight::replant::Legs;
use crate::physics::stages::Stages;

/// The ground between the flights of a clip.
pub(super) struct Neighbours<'a> {
    /// As many as flights; with frames in which each fades out before and after.
    zones: Vec<[Zone; 2]>,
    legs: Legs<'a>,
}

/// Frames beside one border.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Zone {
    /// On the ground, next to the flight.
    pub(super) border: usize,
    /// First and last frame of the ground on this side of the flight, the border included.
    pub(super) ground: (usize, usize),
    /// Frames in which a turn fades out: none is left so far from the border.
    pub(super) length: usize,
}

impl<'a> Neighbours<'a> {
    /// Zones beside the flights `runs`, first and last frame of each, `fade` seconds long; where two overlap, half of the ground between.
    /// `clip`: what feet are brought back to.
    pub(super) fn of(clip: &'a Clip, stages: &Stages, runs: &[(usize, usize)], fade: f64) -> Self {
        let count = clip.frame_count();
        let longest = floor_index((fade * clip.fps).round());
        let zones = (0..runs.len()).map(|index| {
            let (first, last) = runs[index];
            let from = index.checked_sub(1).map(|before| runs[before].1 + 1);
            let to = runs.get(index + 1).map(|(next, _)| next - 1);
            let shared = |frames: usize| longest.min(frames / 2);
            let before = first.saturating_sub(1);
            let after = (last + 1).min(count - 1);
            [
                Zone {
                    border: before,
                    ground: (from.unwrap_or(0), before),
                    length: from.map_or(longest, |from| shared(before - from)),
                },
                Zone {
                    border: after,
                    ground: (after, to.unwrap_or(count - 1)),
                    length: to.map_or(longest, |to| shared(to - after)),
                },
            ]
        });
        Self { zones: zones.collect(), legs: Legs::of(clip, stages) }
    }

    /// Turns of the borders of flight `index`, of which the second is to be turned by `turn` more than the first: all of it, or half
    /// on either side where a leg that stands would not reach.
    pub(super) fn border_turns(
        &self,
        index: usize,
        clip: &Clip,
        body: &BodyModel,
        (block, turn): (&Block, DQuat),
    ) -> [DQuat; 2] {
        let all_after = [DQuat::IDENTITY, turn];
        if turn == DQuat::IDENTITY || block.held != [true, true] {
            return all_after;
        }
        let mut turned = clip.clone();
        let zone = self.zones[index][1];
        self.turn(zone, &mut turned, body, turn);
        if zone.frames().all(|frame| self.legs.reach(&turned, frame)) {
            return all_after;
        }
        let half = log(turn) * 0.5;
        [exp(-half), exp(half)]
    }

    /// Fades out `turns`, by which the borders of flight `index` were turned, in the frames beside it.
    pub(super) fn fade_out(
        &self,
        index: usize,
        clip: &mut Clip,
        body: &BodyModel,
        (block, turns): (&Block, [DQuat; 2]),
    ) {
        for (side, (zone, turn)) in self.zones[index].iter().zip(turns).enumerate() {
            if turn != DQuat::IDENTITY && block.held[side] {
                self.turn(*zone, clip, body, turn);
                self.legs.replant(clip, *zone);
            }
        }
    }

    /// Turns the frames of `zone`, but for the border, about their centres of mass by what is left of `turn` there.
    fn turn(&self, zone: Zone, clip: &mut Clip, body: &BodyModel, turn: DQuat) {
        let centers = centers(clip, body);
        let turn = log(turn);
        for frame in zone.frames() {
            let left = 1.0 - zone.distance(frame) as f64 / zone.length as f64;
            place(clip, frame, (centers[frame], centers[frame]), exp(turn * smoothstep(left)));
        }
    }
}

impl Zone {
    /// Frames that are turned, but for the border.
    pub(super) fn frames(&self) -> impl Iterator<Item = usize> {
        let zone = *self;
        (zone.ground.0..=zone.ground.1)
            .filter(move |frame| *frame != zone.border && zone.distance(*frame) < zone.length)
    }

    fn distance(&self, frame: usize) -> usize {
        frame.abs_diff(self.border)
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use glam::DVec3;

    use super::*;
    use crate::clip::builtin::generate;
    use crate::physics::body_model::{BodySettings, body_model};
    use crate::physics::posed::PosedClip;
    use crate::physics::stages::{StageSettings, stages};

    /// Frames of a walk that are taken for a flight.
    const AIR: (usize, usize) = (20, 24);

    /// Turns of the borders if the second is turned by `turn` more than the first.
    fn turns(turn: DQuat) -> [DQuat; 2] {
        let clip = generate("walk", &BTreeMap::new()).expect("a built-in clip");
        let body = body_model(&clip.skeleton, &BodySettings::default()).expect("a whole body");
        let stages = stages(&clip, &body, &PosedClip::of(&clip), &StageSettings::default());
        let block = Block::of(AIR, clip.frame_count());
        Neighbours::of(&clip, &stages, &[AIR], 0.5).border_turns(0, &clip, &body, (&block, turn))
    }

    #[test]
    fn a_turn_fades_out_after_the_landing_where_legs_reach() {
        let turn = exp(DVec3::Y * 0.001);
        assert_eq!(turns(turn), [DQuat::IDENTITY, turn]);
    }

    #[test]
    fn a_turn_beyond_the_reach_of_legs_is_shared_by_both_sides() {
        let turn = exp(DVec3::new(0.5, 0.0, 0.0));
        let [before, after] = turns(turn);
        assert!(log(before * after).length() < 1e-12, "{before} {after}");
        assert!(log(after * before.inverse() * turn.inverse()).length() < 1e-12);
    }

    #[test]
    fn zones_of_flights_near_each_other_meet_half_way() {
        let clip = generate("walk", &BTreeMap::new()).expect("a built-in clip");
        let body = body_model(&clip.skeleton, &BodySettings::default()).expect("a whole body");
        let stages = stages(&clip, &body, &PosedClip::of(&clip), &StageSettings::default());
        let runs = [(5, 9), (20, 24)];
        let zones = Neighbours::of(&clip, &stages, &runs, 10.0).zones;
        let frames: Vec<Vec<usize>> = [zones[0][1], zones[1][0]].map(|zone| zone.frames().collect()).to_vec();
        assert_eq!(frames, [vec![11, 12, 13], vec![16, 17, 18]]);
    }
}
