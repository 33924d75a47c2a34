//! Hands of those who carry something, as the edit moves their bodies: posed once a frame, at rest, then only moved along.

use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};

use crate::edit::moved::Moved;
use crate::geometry::{cis, plan_of, world_of};
use crate::index::CharacterId;
use crate::object_motion::{BodyHands, Performance, hands_stay_apart};
use crate::path;
use crate::scene::Scene;
use crate::skeleton::Pose;

/// So many of each are remembered.
const MOST: usize = 20_000;

/// Hands at rest that have been asked for. They hold as long as tracks do.
#[derive(Debug, Default)]
pub struct HandsAtRest {
    /// By character and bits of the frame.
    poses: Mutex<BTreeMap<(CharacterId, u64), BodyHands>>,
    /// Whether hands tell a heading, by carry and bits of its first and last frame: of those who carry alone.
    apart: Mutex<BTreeMap<(usize, [u64; 2]), bool>>,
}

/// Everybody as the edit moves them; hands at no cost that grows with joints where they were asked for before.
#[derive(Clone, Copy)]
pub struct Carrying<'a> {
    /// How everybody moves.
    pub moved: Moved<'a>,
    /// Of these tracks.
    pub hands: &'a HandsAtRest,
}

impl Performance for Carrying<'_> {
    fn time(&self, who: CharacterId, frame: f64) -> f64 {
        self.moved.time(who, frame)
    }

    fn frame(&self, who: CharacterId, seconds: f64) -> f64 {
        self.moved.frame(who, seconds)
    }

    fn pose(&self, who: CharacterId, frame: f64) -> Pose {
        self.moved.pose(who, frame)
    }

    fn hands(&self, scene: &Scene, who: CharacterId, frame: f64) -> BodyHands {
        let own = &self.moved.characters[who.as_usize()];
        let rest = self.hands.at(scene, who, frame);
        let turn = own.turns.at(frame);
        let detail = plan_of(rest.root) - path::at(&own.rest.positions, frame);
        let place = path::at(&own.positions, frame) + cis(turn) * detail;
        rest.moved(world_of(place, rest.root.y), turn)
    }

    fn tells_heading(&self, scene: &Scene, carry: usize, frames: [f64; 2]) -> bool {
        if scene.carries[carry].by.len() > 1 {
            return hands_stay_apart(scene, self, carry, frames);
        }
        // One body keeps its hands apart wherever it goes.
        let key = (carry, frames.map(f64::to_bits));
        let known = self.hands.apart.lock().unwrap_or_else(PoisonError::into_inner).get(&key).copied();
        known.unwrap_or_else(|| {
            let found = hands_stay_apart(scene, &self.moved, carry, frames);
            let mut apart = self.hands.apart.lock().unwrap_or_else(PoisonError::into_inner);
            if apart.len() >= MOST {
                apart.clear();
            }
            apart.insert(key, found);
            found
        })
    }
}

impl HandsAtRest {
    fn at(&self, scene: &Scene, who: CharacterId, frame: f64) -> BodyHands {
        let key = (who, frame.to_bits());
        let known = self.poses.lock().unwrap_or_else(PoisonError::into_inner).get(&key).copied();
        known.unwrap_or_else(|| {
            let track = &scene.characters[who.as_usize()].track;
            let found = BodyHands::of(&track.clips[0].clip.skeleton, &track.pose(frame));
            let mut poses = self.poses.lock().unwrap_or_else(PoisonError::into_inner);
            if poses.len() >= MOST {
                poses.clear();
            }
            poses.insert(key, found);
            found
        })
    }
}
