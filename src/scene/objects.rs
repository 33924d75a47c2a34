//! Objects of a scene: where they are by themselves, and who carries them.

use crate::constraint::Moment;
use crate::geometry::world_of;
use crate::index::{CharacterId, ObjectId};
use crate::object::{Carry, Course, Object, ObjectKey, ObjectPose, hand_overs};
use crate::scene::checker::{Checked, Checker, FARTHEST, Head, order, plan_point, seconds_within};
use crate::scene::clips::check_name;
use crate::scene::moment::Member;
use crate::scene::report::{At, Report};
use crate::scene::suggest;
use crate::scene::tree::Field;
use crate::scene::values::{Tables, WordOr};
use crate::scene::{raw, things};
use crate::skeleton::{JointRole, Skeleton};

/// All objects that are sound.
pub fn objects(raw: &raw::Scene, report: &mut Report) -> Vec<Object> {
    raw.object.tables().iter().filter_map(|object| sound_object(object, report)).collect()
}

fn sound_object(object: &At<things::Object>, report: &mut Report) -> Option<Object> {
    let At { value: raw, place } = object;
    if let Some(name) = raw.name.given() {
        check_name(name, "object", report);
    }
    if raw.position.is_absent() && raw.keys.is_absent() {
        let help = "add position = [x, -z]: the middle of its base on the ground";
        report.fault(place, "the object has no \"position\"", help);
    }
    if let (Field::Given(_), Field::Given(keys)) = (&raw.position, &raw.keys) {
        let help = "keep \"position\" for a thing that stands, or \"keys\" for one that moves by itself";
        report.fault(&keys.place, "\"position\" and \"keys\" exclude each other", help);
    }
    for side in raw.size.value().into_iter().flatten() {
        if side.value <= 0.0 || side.value > FARTHEST {
            let message = format!("{} metres is no side of an object", side.value);
            report.fault(&side.place, message, format!("write a number above 0 and at most {FARTHEST}"));
        }
    }
    let facing = raw.facing.value().map_or(0.0, |degrees| degrees.to_radians());
    let height = height(&raw.height, 0.0, report);
    let course = match (raw.keys.given(), raw.position.given()) {
        (Some(keys), _) => sound_keys(keys, (height, facing), report).map(Course::Keys),
        (None, Some(position)) => {
            let position = world_of(plan_point(position, report), height);
            Some(Course::Still(ObjectPose { position, facing }))
        }
        (None, None) => None,
    };
    Some(Object {
        name: raw.name.value()?.clone(),
        size: raw.size.value()?.each_ref().map(|side| side.value),
        course: course?,
    })
}

/// A height within reason; `before`: what it is where it is left out.
fn height(given: &Field<f64>, before: f64, report: &mut Report) -> f64 {
    let Some(At { value, place }) = given.given() else {
        return before;
    };
    if value.abs() > FARTHEST {
        let message = format!("{value} metres is too far away");
        report.fault(place, message, format!("stay within {FARTHEST} metres"));
    }
    *value
}

/// Keys in the order of time; what a key leaves out is as before it, at first as `start` says: height, facing.
fn sound_keys(
    keys: &At<Tables<things::ObjectKey>>,
    start: (f64, f64),
    report: &mut Report,
) -> Option<Vec<ObjectKey>> {
    if keys.value.0.is_empty() {
        let help = "write at least { seconds = 0, position = [x, -z] }";
        report.fault(&keys.place, "the object has no key", help);
        return None;
    }
    let mut sound: Vec<ObjectKey> = Vec::new();
    let (mut up, mut facing) = start;
    for At { value: key, .. } in &keys.value.0 {
        let position = key.position.given().map(|position| plan_point(position, report));
        up = height(&key.height, up, report);
        facing = key.facing.value().map_or(facing, |degrees| degrees.to_radians());
        let seconds = seconds_within(&key.seconds, report);
        if let (Some(last), Some(At { value, place })) = (sound.last(), key.seconds.given())
            && *value <= last.seconds
        {
            let message = format!("{value} s does not come after {} s", last.seconds);
            report.fault(place, message, "write the keys in the order of time, each time once");
        }
        if let (Some(seconds), Some(position)) = (seconds, position) {
            sound.push(ObjectKey { seconds, pose: ObjectPose { position: world_of(position, up), facing } });
        }
    }
    (!sound.is_empty()).then_some(sound)
}

impl Checker<'_> {
    /// Checks one `[[carry]]`, the `index`-th.
    pub fn carry(&mut self, table: &At<things::Carry>, index: usize) {
        let carry = &table.value;
        let head = Head { keyword: "carry", index, place: &table.place, name: &carry.name };
        let (name, line) = self.called(&head);
        if let Some(At { value: WordOr::Other(_), place }) = carry.strength.given() {
            let message = "what is carried is between the hands, whatever the weight";
            self.report.warn(place, message, "leave \"strength\" out");
        }
        let object = carry.object.given().and_then(|name| self.carried_object(name));
        let by = carry.by.given().and_then(|by| self.carriers(by));
        let during = carry.during.given().and_then(|pair| {
            let during = self.interval(&pair.value, &pair.place)?;
            Some((during, &pair.place))
        });
        let (Some(object), Some(by), Some((during, place))) = (object, by, during) else {
            return;
        };
        if !by.contains(&during.0.character) {
            let who = &self.cast[during.0.character.as_usize()].name;
            let message = format!("\"{who}\" is not among those who carry");
            self.report.fault(place, message, "name moments of somebody in \"by\"");
        }
        self.checked.carries.push(Carry { name, line, object, by, during });
        self.checked.carry_places.push(place.clone());
    }

    fn carried_object(&mut self, name: &At<String>) -> Option<ObjectId> {
        let object = self.object(&name.value, &name.place)?;
        if self.keyed[object.as_usize()] {
            let message = format!("\"{}\" moves by its keys and cannot be carried", name.value);
            let help = "give the object a \"position\" in place of \"keys\"";
            self.report.fault(&name.place, message, help);
        }
        Some(object)
    }

    /// One or two different characters with hands.
    fn carriers(&mut self, by: &At<Vec<At<String>>>) -> Option<Vec<CharacterId>> {
        if by.value.is_empty() || by.value.len() > 2 {
            let message = format!("{} people cannot carry one object", by.value.len());
            self.report.fault(&by.place, message, "name one character or two");
        }
        let mut sound = (1..=2).contains(&by.value.len());
        let mut carriers: Vec<CharacterId> = Vec::new();
        for At { value: name, place } in &by.value {
            let Some(who) = self.character(name, place) else {
                sound = false;
                continue;
            };
            if carriers.contains(&who) {
                let help = "name each character once: they have two hands anyway";
                self.report.fault(place, format!("\"{name}\" carries twice"), help);
            }
            self.check_hands(who, name, place);
            carriers.push(who);
        }
        sound.then_some(carriers)
    }

    fn check_hands(&mut self, who: CharacterId, name: &str, place: &crate::scene::report::Place) {
        let hands = [JointRole::LeftHand, JointRole::RightHand];
        let Some(skeleton) = self.skeleton(who) else {
            return;
        };
        if let Some(hand) = hands.into_iter().find(|hand| skeleton.joint_of(*hand).is_none()) {
            let message = format!("\"{name}\" has no joint for {hand} and cannot carry");
            self.report.fault(place, message, no_hand(skeleton, hand));
        }
    }

    /// The character called `name`.
    pub fn character(&mut self, name: &str, place: &crate::scene::report::Place) -> Option<CharacterId> {
        if let Some(found) = self.cast_places.get(name) {
            return Some(CharacterId::from_usize(*found));
        }
        if self.cast.iter().all(|member| !member.name.is_empty()) {
            let names: Vec<_> = self.cast.iter().map(|member| member.name.as_str()).collect();
            let help = suggest::remedy(name, "characters", &names);
            self.report.fault(place, format!("no character \"{name}\""), help);
        }
        None
    }
}

/// What to do where a skeleton has no joint for a hand.
pub fn no_hand(skeleton: &Skeleton, hand: JointRole) -> String {
    let elbow = if hand == JointRole::LeftHand { JointRole::LeftElbow } else { JointRole::RightElbow };
    let elbow = skeleton.joint_of(elbow);
    let goes_on = |elbow| skeleton.joints.iter().any(|joint| joint.parent == Some(elbow));
    match elbow {
        Some(elbow) if !goes_on(elbow) => {
            let name = &skeleton.joints[elbow.as_usize()].name;
            format!("its arms end at \"{name}\": give the character a body with hands, skeleton = \"CLIP\"")
        }
        _ => format!("name it in the table of the clip: roles = {{ {hand} = \"JOINT\" }}"),
    }
}

/// Reports what is grasped again before it is released, as far as moments of one character tell.
pub fn check_order(checked: &Checked, cast: &[Member], report: &mut Report) {
    let place = |moment: &Moment| order(moment.instant, &cast[moment.character.as_usize()]);
    for (before, next) in hand_overs(&checked.carries) {
        let (release, grasp) = (&checked.carries[before].during.1, &checked.carries[next].during.0);
        if release.character == grasp.character && place(grasp) < place(release) {
            let message = format!("\"{}\" comes before \"{}\"", grasp.name, release.name);
            let help =
                "write the carries of an object in the order of time, each ending before the next begins";
            report.fault(&checked.carry_places[next], message, help);
        }
    }
}
