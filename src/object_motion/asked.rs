//! Objects along time, worked out as far as somebody asks for them.

use std::borrow::Cow;
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::rc::Rc;

use super::possession::{Possession, Possessor, possession_before, possessions};
use super::{ObjectMotion, Performance, carry_times, motion_of};
use crate::index::ObjectId;
use crate::object::ObjectPose;
use crate::scene::Scene;

/// Carries of one object with their times, and who has it when.
type Known = (Vec<(usize, [f64; 2])>, Vec<Possession>);

/// Who has each object when, and where it is. Neither is known of an object before it is asked for, and how hands move only
/// where somebody has had it: that takes most of the work.
pub struct Objects<'a, P> {
    scene: &'a Scene,
    performance: &'a P,
    carries: &'a [Vec<usize>],
    /// Of each object asked for.
    known: RefCell<BTreeMap<ObjectId, Rc<Known>>>,
    motions: RefCell<BTreeMap<ObjectId, Rc<ObjectMotion>>>,
}

impl<'a, P: Performance> Objects<'a, P> {
    /// Of those in `scene`, as everybody moves. `carries`: of each object, by position, rising; empty where nobody has listed
    /// them.
    pub fn new(scene: &'a Scene, performance: &'a P, carries: &'a [Vec<usize>]) -> Self {
        Self { scene, performance, carries, known: RefCell::default(), motions: RefCell::default() }
    }

    /// The possession that holds just before a scene time. Cost: linear in carries when first asked.
    pub fn possession_before(&self, object: ObjectId, seconds: f64) -> Possession {
        *possession_before(&self.known(object).1, seconds)
    }

    /// When a carry begins, seconds; −∞ where it never has the object.
    pub fn grasped(&self, object: ObjectId, carry: usize) -> f64 {
        let known = self.known(object);
        let own = known.1.iter().find(|own| own.by == Possessor::Carried(carry));
        own.map_or(f64::NEG_INFINITY, |own| own.from)
    }

    /// Pose at a scene time: on its own course as long as nobody has had the object just before.
    pub fn pose_at(&self, object: ObjectId, seconds: f64) -> ObjectPose {
        match self.possession_before(object, seconds).by {
            Possessor::Itself => self.scene.objects[object.as_usize()].course.pose_at(seconds),
            _ => self.motion(object).pose_at(self.scene, self.performance, seconds),
        }
    }

    fn known(&self, object: ObjectId) -> Rc<Known> {
        if let Some(known) = self.known.borrow().get(&object) {
            return Rc::clone(known);
        }
        let listed = self.carries.get(object.as_usize());
        let carries = listed.map_or_else(|| Cow::Owned(self.scene.carries_of(object)), Cow::Borrowed);
        let times = carry_times(self.scene, self.performance, &carries);
        let possessions = possessions(&times);
        let known = Rc::new((times, possessions));
        self.known.borrow_mut().insert(object, Rc::clone(&known));
        known
    }

    fn motion(&self, object: ObjectId) -> Rc<ObjectMotion> {
        if let Some(motion) = self.motions.borrow().get(&object) {
            return Rc::clone(motion);
        }
        let known = self.known(object);
        let motion = Rc::new(motion_of((self.scene, self.performance), object, &known.0));
        self.motions.borrow_mut().insert(object, Rc::clone(&motion));
        motion
    }
}
