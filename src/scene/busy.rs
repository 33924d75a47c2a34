//! What hands and feet have to do, once tracks tell when: hands asked for twice at a time, by carries too, and bodies that nothing brings near
//! what they reach or grasp.

use std::collections::BTreeMap;

use crate::constraint::{Constraint, ConstraintKind, Moment, Partner, Relation, When};
use crate::effector::{EffectorTarget, EndEffector};
use crate::geometry::plan_of;
use crate::index::{CharacterId, JointId, ObjectId};
use crate::object::{Carry, Object};
use crate::scene::checker::Checked;
use crate::scene::moment::Member;
use crate::scene::report::Report;
use crate::skeleton::{JointRole, Skeleton};
use crate::track::Track;

/// A place held this near to what a hand reaches brings the body there, working frames: a second.
const NEAR: f64 = 30.0;

/// Who is as near as this to an object before the edit may be left there, metres on the ground: an arm and a step.
const WITHIN_A_STEP: f64 = 1.5;

/// Moments this near are one, working frames.
const SAME_MOMENT: f64 = 1e-6;

/// A character, and the first and the last frame of its track.
type Stretch = (CharacterId, f64, f64);

/// Who performs what.
pub struct Performers<'a> {
    /// The cast.
    pub cast: &'a [Member],
    /// Its tracks, as far as they could be strung.
    pub tracks: &'a [Option<Track>],
}

impl Performers<'_> {
    fn track(&self, who: CharacterId) -> Option<&Track> {
        self.tracks.get(who.as_usize())?.as_ref()
    }

    fn frame(&self, moment: &Moment) -> Option<f64> {
        self.track(moment.character)?.locate(moment.instant)
    }

    fn stretch(&self, when: &When) -> Option<Stretch> {
        let frames: Option<Vec<f64>> = when.moments().into_iter().map(|moment| self.frame(moment)).collect();
        frames.map(|frames| (when.character(), frames[0], frames[frames.len() - 1]))
    }

    fn skeleton(&self, who: CharacterId) -> Option<&Skeleton> {
        self.track(who).map(|track| &*track.clips[0].clip.skeleton)
    }

    /// Whether a carry goes on while something else is asked of who names its moments (true), or only begins or ends just
    /// then (false).
    fn meanwhile(&self, carry: &Carry, when: &When) -> Option<bool> {
        self.goes_on_at(carry, self.stretch(when)?)
    }

    fn goes_on_at(&self, carry: &Carry, (who, first, last): Stretch) -> Option<bool> {
        let (grasp, release) = (self.frame(&carry.during.0)?, self.frame(&carry.during.1)?);
        let meets = first <= release + SAME_MOMENT && last >= grasp - SAME_MOMENT;
        let within = first < release - SAME_MOMENT && last > grasp + SAME_MOMENT;
        (carry.during.0.character == who && meets).then_some(within)
    }

    fn name(&self, who: CharacterId) -> &str {
        &self.cast[who.as_usize()].name
    }
}

/// Reports end effectors on hands that carry meanwhile, as far as moments of one character tell.
pub fn check_hands(checked: &Checked, performers: &Performers<'_>, report: &mut Report) {
    let mut carries: BTreeMap<CharacterId, Vec<&Carry>> = BTreeMap::new();
    checked.carries.iter().for_each(|carry| carries.entry(carry.during.0.character).or_default().push(carry));
    for (effector, place) in checked.end_effectors.iter().zip(&checked.effector_places) {
        let hands = joints(effector, performers);
        let hands = hands.into_iter().filter(|(joint, when)| {
            let skeleton = performers.skeleton(when.character());
            is_of_hand(skeleton, *joint)
        });
        let own = |when: &When| carries.get(&when.character()).map_or(&[][..], Vec::as_slice);
        let pairs = hands.flat_map(|(_, when)| own(when).iter().map(move |carry| (*carry, when)));
        for (carry, when) in pairs {
            match performers.meanwhile(carry, when) {
                Some(true) => {
                    let message =
                        format!("{}, which \"{}\" has", asks(effector, carry, performers), carry.name);
                    report.fault(place, message, free(carry));
                }
                Some(false) => {
                    let asks = asks(effector, carry, performers);
                    let message = format!("{asks} just when \"{}\" grasps or lets go", carry.name);
                    report.warn(place, message, "leave some frames between the two");
                }
                None => {}
            }
        }
    }
}

/// Reports carries of two things that ask for the hands of one person at the same time, as far as moments of that person tell.
pub fn check_loads(checked: &Checked, performers: &Performers<'_>, report: &mut Report) {
    for (index, (carry, place)) in checked.carries.iter().zip(&checked.carry_places).enumerate() {
        let who = carry.during.0.character;
        let [first, last] = [&carry.during.0, &carry.during.1].map(|moment| performers.frame(moment));
        let (Some(first), Some(last)) = (first, last) else {
            continue;
        };
        for other in checked.carries[..index].iter().filter(|other| other.object != carry.object) {
            let asks = || {
                let (own, hands) = (&carry.name, performers.name(who));
                format!("\"{own}\" asks for the hands of \"{hands}\"")
            };
            match performers.goes_on_at(other, (who, first, last)) {
                Some(true) => {
                    report.fault(place, format!("{}, which \"{}\" has", asks(), other.name), free(other));
                }
                Some(false) => {
                    let message = format!("{} just when \"{}\" grasps or lets go", asks(), other.name);
                    report.warn(place, message, "leave some frames between the two");
                }
                None => {}
            }
        }
    }
}

fn asks(effector: &EndEffector, carry: &Carry, performers: &Performers<'_>) -> String {
    let name = performers.name(carry.during.0.character);
    format!("\"{}\" asks for a hand of \"{name}\"", effector.name)
}

fn free(carry: &Carry) -> String {
    let (grasp, release) = (&carry.during.0.name, &carry.during.1.name);
    format!(
        "move it before \"{grasp}\" or after \"{release}\", or end the carry before it and begin another after it"
    )
}

/// The joints that an end effector moves, and when: its own, and the hand that comes to meet it.
fn joints<'a>(effector: &'a EndEffector, performers: &Performers<'_>) -> Vec<(JointId, &'a When)> {
    let mut joints = vec![(effector.joint, &effector.when)];
    if let EffectorTarget::Joint { character, joint, point, when: Some(when) } = &effector.target {
        let own = is_of_hand(performers.skeleton(effector.when.character()), effector.joint);
        if own && point.length() == 0.0 && is_of_hand(performers.skeleton(*character), *joint) {
            joints.push((*joint, when));
        }
    }
    joints
}

/// Whether a joint is a hand or hangs on one.
fn is_of_hand(skeleton: Option<&Skeleton>, joint: JointId) -> bool {
    let Some(skeleton) = skeleton else {
        return false;
    };
    let above = std::iter::successors(Some(joint), |joint| skeleton.joints[joint.as_usize()].parent);
    let mut roles = above.filter_map(|joint| skeleton.joints[joint.as_usize()].role);
    roles.any(|role| matches!(role, JointRole::LeftHand | JointRole::RightHand))
}

/// Warns of joints that must reach something, and of people who grasp something, while nothing brings their bodies near.
pub fn warn_of_lonely(
    checked: &Checked,
    objects: &[Object],
    performers: &Performers<'_>,
    report: &mut Report,
) {
    let mut all: BTreeMap<CharacterId, Vec<Stretch>> = BTreeMap::new();
    for stretch in checked.constraints.iter().flat_map(placed).filter_map(|when| performers.stretch(when)) {
        all.entry(stretch.0).or_default().push(stretch);
    }
    let placed = |who: CharacterId| all.get(&who).map_or(&[][..], Vec::as_slice);
    for (effector, place) in checked.end_effectors.iter().zip(&checked.effector_places) {
        let Some(stretch) = performers.stretch(&effector.when) else {
            continue;
        };
        if !placed(stretch.0).iter().any(|known| is_near(known, stretch)) {
            let message = format!("nothing brings the body near what \"{}\" reaches", effector.name);
            report.warn(place, message, "add a [[pin]] or a [[relative]] at this moment");
        }
    }
    let mut before: BTreeMap<ObjectId, Vec<&Carry>> = BTreeMap::new();
    for (carry, place) in checked.carries.iter().zip(&checked.carry_places) {
        let before = before.entry(carry.object).or_default();
        for who in &carry.by {
            let is_there = brought(carry, *who, (placed(*who), before), performers)
                || stands_near(carry, *who, (objects, before), performers);
            if !is_there {
                let (who, carry) = (performers.name(*who), &carry.name);
                let message = format!("nothing brings \"{who}\" near what \"{carry}\" grasps");
                report.warn(place, message, "add a [[relative]] to the object at the moment of the grasp");
            }
        }
        before.push(carry);
    }
}

fn is_near(known: &Stretch, (who, first, last): Stretch) -> bool {
    known.0 == who && known.1 <= last + NEAR && known.2 >= first - NEAR
}

/// Whether something brings a carrier near when it grasps: a place held about then (at any time, for those whose moments the
/// carry does not name), or a carry of the same thing just before. `placed`: of the carrier; `before`: of the same object.
fn brought(
    carry: &Carry,
    who: CharacterId,
    (placed, before): (&[Stretch], &[&Carry]),
    performers: &Performers<'_>,
) -> bool {
    let grasp = &carry.during.0;
    if grasp.character != who {
        return !placed.is_empty();
    }
    let Some(frame) = performers.frame(grasp) else {
        return true;
    };
    let had = before.iter().any(|one| {
        let released = performers.frame(&one.during.1);
        let just_before = released.is_some_and(|released| (released - frame).abs() < NEAR);
        one.during.1.character == who && just_before
    });
    had || placed.iter().any(|known| is_near(known, (who, frame, frame)))
}

/// Whether a carrier stands near the object before the edit, when it grasps; true where that cannot be told. What was carried
/// `before` lies at the feet of who let it go.
fn stands_near(
    carry: &Carry,
    who: CharacterId,
    (objects, before): (&[Object], &[&Carry]),
    performers: &Performers<'_>,
) -> bool {
    let root = |who, frame| performers.track(who).map(|track| plan_of(track.pose(frame).root));
    let (Some(track), Some(object)) = (performers.track(who), objects.get(carry.object.as_usize())) else {
        return true;
    };
    let release = before.last().map(|one| &one.during.1);
    let left = release.and_then(|moment| root(moment.character, performers.frame(moment)?));
    let place = left.unwrap_or_else(|| object.course.pose_at(0.0).plan());
    let [ahead, _, across] = object.size;
    let near = WITHIN_A_STEP + 0.5 * ahead.hypot(across);
    // Of the other one of two carriers nobody tells when: as near as it ever comes.
    let frames = match performers.frame(&carry.during.0).filter(|_| carry.during.0.character == who) {
        Some(frame) => vec![frame],
        None => (0..track.frame_count()).map(|frame| frame as f64).collect(),
    };
    frames.into_iter().any(|frame| root(who, frame).is_some_and(|root| (root - place).norm() < near))
}

/// When a constraint holds a place: of whoever it is about, and of the partner.
fn placed(constraint: &Constraint) -> Vec<&When> {
    match &constraint.kind {
        ConstraintKind::Pin { when, position: Some(_), .. } => vec![when],
        ConstraintKind::Relative { when, partner, offset, .. } if *offset != Relation::Free => {
            match partner {
                Partner::Character(other) => vec![when, other],
                Partner::Object(_) => vec![when],
            }
        }
        _ => Vec::new(),
    }
}
