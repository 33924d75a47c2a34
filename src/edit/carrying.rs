//! Hands of those who carry something, as the edit moves their bodies: posed once a frame, at rest, then only moved along.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

use crate::edit::moved::Moved;
use crate::geometry::{c64, cis, plan_of, world_of};
use crate::index::{CharacterId, floor_index};
use crate::object_motion::{BodyHands, LEAST_WIDTH, Performance, hands_stay_apart};
use crate::path;
use crate::scene::Scene;
use crate::skeleton::Pose;

/// So many of each are remembered of a character.
const MOST: usize = 20_000;

/// Hands at rest that have been asked for.
#[derive(Debug, Default)]
pub struct HandsAtRest {
    /// Of each character: they hold as long as tracks do.
    bodies: Vec<Arc<HandsOfOne>>,
    /// Of those who carry together, by carry and bits of its first and last frame: they hold as long as times do.
    abreast: Mutex<BTreeMap<Spell, Arc<Vec<Abreast>>>>,
}

/// A carry, and bits of its first and last frame.
type Spell = (usize, [u64; 2]);

/// Two who carry something together at one instant: frame of each, and the middle of the hands seen from the path, at rest.
type Abreast = [(f64, c64); 2];

#[derive(Debug, Default)]
struct HandsOfOne {
    /// By bits of the frame.
    poses: Mutex<BTreeMap<u64, BodyHands>>,
    /// Whether hands tell a heading, by carry and bits of its first and last frame: of those in which nobody else carries.
    apart: Mutex<BTreeMap<Spell, bool>>,
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
        let key = (carry, frames.map(f64::to_bits));
        if let [first, second] = scene.carries[carry].by[..] {
            let both = [first, second];
            let abreast =
                remembered(&self.hands.abreast, key, || Arc::new(self.abreast(carry, both, frames)));
            return abreast.iter().all(|own| self.are_apart(both, own));
        }
        // One body keeps its hands apart wherever it goes.
        let known = &self.hands.bodies[scene.carries[carry].by[0].as_usize()].apart;
        remembered(known, key, || hands_stay_apart(scene, &self.moved, carry, frames))
    }
}

impl Carrying<'_> {
    /// Those who carry together, from one frame of the track of whoever says when to another.
    fn abreast(&self, carry: usize, both: [CharacterId; 2], [first, last]: [f64; 2]) -> Vec<Abreast> {
        let scene = self.moved.scene;
        let clock = scene.carries[carry].during.0.character;
        let frames = (0..=floor_index(last - first)).map(|k| first + k as f64).chain([last]);
        let own = |who: CharacterId, seconds: f64| {
            let frame = self.moved.frame(who, seconds);
            let rest = self.hands.at(scene, who, frame);
            let [left, right] = rest.hands.map(|(_, frame)| frame.position);
            let on_path = path::at(&self.moved.characters[who.as_usize()].rest.positions, frame);
            (frame, plan_of(left.midpoint(right)) - on_path)
        };
        frames.map(|frame| both.map(|who| own(who, self.moved.time(clock, frame)))).collect()
    }

    /// Whether the hands of two are far enough from each other, seen from above, to tell a heading.
    fn are_apart(&self, both: [CharacterId; 2], [first, second]: &Abreast) -> bool {
        let own = |who: CharacterId| &self.moved.characters[who.as_usize()];
        let [one, other] = both.map(own);
        let paths = [path::at(&one.positions, first.0), path::at(&other.positions, second.0)];
        if (paths[1] - paths[0]).norm() - first.1.norm() - second.1.norm() >= LEAST_WIDTH {
            return true;
        }
        let middles = [
            paths[0] + cis(one.turns.at(first.0)) * first.1,
            paths[1] + cis(other.turns.at(second.0)) * second.1,
        ];
        (middles[1] - middles[0]).norm() >= LEAST_WIDTH
    }
}

impl HandsAtRest {
    /// Of so many characters; nothing is known yet.
    pub fn new(characters: usize) -> Self {
        Self { bodies: (0..characters).map(|_| Arc::default()).collect(), abreast: Mutex::default() }
    }

    /// Forgets what holds for the times before.
    pub fn forget_times(&mut self) {
        self.abreast = Mutex::default();
    }

    /// Takes over what others know, of the same tracks but that of `changed`.
    pub fn adopt(&mut self, others: &Self, changed: CharacterId) {
        self.bodies.clone_from(&others.bodies);
        self.bodies[changed.as_usize()] = Arc::default();
    }

    fn at(&self, scene: &Scene, who: CharacterId, frame: f64) -> BodyHands {
        remembered(&self.bodies[who.as_usize()].poses, frame.to_bits(), || {
            let track = &scene.characters[who.as_usize()].track;
            BodyHands::of(&track.clips[0].clip.skeleton, &track.pose(frame))
        })
    }
}

/// What is known of `key`, or is found now.
fn remembered<K: Ord, V: Clone>(known: &Mutex<BTreeMap<K, V>>, key: K, find: impl FnOnce() -> V) -> V {
    let locked = || known.lock().unwrap_or_else(PoisonError::into_inner);
    let own = locked().get(&key).cloned();
    own.unwrap_or_else(|| {
        let found = find();
        let mut known = locked();
        if known.len() >= MOST {
            known.clear();
        }
        known.insert(key, found.clone());
        found
    })
}
