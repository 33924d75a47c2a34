//! Hands of those who carry something, as the edit moves their bodies: posed once a frame, at rest, then only moved along.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

use crate::edit::moved::Moved;
use crate::geometry::{cis, plan_of, world_of};
use crate::index::CharacterId;
use crate::object_motion::{BodyHands, Performance, hands_stay_apart};
use crate::path;
use crate::scene::Scene;
use crate::skeleton::Pose;

/// So many of each are remembered of a character.
const MOST: usize = 20_000;

/// Hands at rest that have been asked for, by character: they hold as long as tracks do.
#[derive(Clone, Debug, Default)]
pub struct HandsAtRest(Vec<Arc<HandsOfOne>>);

#[derive(Debug, Default)]
struct HandsOfOne {
    /// By bits of the frame.
    poses: Mutex<BTreeMap<u64, BodyHands>>,
    /// Whether hands tell a heading, by carry and bits of its first and last frame: of those in which nobody else carries.
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
        let known = &self.hands.0[scene.carries[carry].by[0].as_usize()].apart;
        remembered(known, (carry, frames.map(f64::to_bits)), || {
            hands_stay_apart(scene, &self.moved, carry, frames)
        })
    }
}

impl HandsAtRest {
    /// Of so many characters; nothing is known yet.
    pub fn new(characters: usize) -> Self {
        Self((0..characters).map(|_| Arc::default()).collect())
    }

    /// Takes over what others know, of the same tracks but that of `changed`.
    pub fn adopt(&mut self, others: &Self, changed: CharacterId) {
        self.0.clone_from(&others.0);
        self.0[changed.as_usize()] = Arc::default();
    }

    fn at(&self, scene: &Scene, who: CharacterId, frame: f64) -> BodyHands {
        remembered(&self.0[who.as_usize()].poses, frame.to_bits(), || {
            let track = &scene.characters[who.as_usize()].track;
            BodyHands::of(&track.clips[0].clip.skeleton, &track.pose(frame))
        })
    }
}

/// What is known of `key`, or is found now.
fn remembered<K: Ord, V: Copy>(known: &Mutex<BTreeMap<K, V>>, key: K, find: impl FnOnce() -> V) -> V {
    let locked = || known.lock().unwrap_or_else(PoisonError::into_inner);
    let own = locked().get(&key).copied();
    own.unwrap_or_else(|| {
        let found = find();
        let mut known = locked();
        if known.len() >= MOST {
            known.clear();
        }
        known.insert(key, found);
        found
    })
}
