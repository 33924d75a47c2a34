//! What hands and feet reach in a scene: each table checked, its joints and moments found.

use glam::{DQuat, DVec3};

use crate::constraint::{Constraint, ConstraintKind, Moment, Partner, Relation, When};
use crate::effector::{EffectorTarget, EndEffector, Orientation};
use crate::index::{CharacterId, JointId};
use crate::scene::checker::{Checked, Checker, FARTHEST, Head};
use crate::scene::report::{At, Place, Report};
use crate::scene::suggest;
use crate::scene::things;
use crate::scene::tree::Field;
use crate::scene::values::{OneOrPair, Triple, Turn, WordOr};
use crate::skeleton::{JointRole, Skeleton};
use crate::track::Track;

/// A place held this near to what a hand reaches brings the body there, working frames: a second.
const NEAR: f64 = 30.0;

/// How to write a target.
const TARGETS: &str = "write { position = [x, y, z] }, { object = \"NAME\", point = [x, y, z] }, \
                       or { character = \"NAME\", joint = \"ROLE\", point = [x, y, z], at = \"MOMENT\" }";

impl Checker<'_> {
    /// Checks one `[[end_effector]]`, the `index`-th.
    pub fn end_effector(&mut self, table: &At<things::EndEffector>, index: usize) {
        let raw = &table.value;
        let head = Head { keyword: "end_effector", index, place: &table.place, name: &raw.name };
        let (name, line) = self.called(&head);
        let when = self.when(&table.place, &raw.at, &raw.during);
        let joint = when.as_ref().zip(raw.joint.given()).and_then(|(when, joint)| {
            let who = when.character();
            self.joint(who, joint)
        });
        let orientation = orientation(&raw.orientation);
        let target = raw.target.given().and_then(|target| self.target(target, when.as_ref()));
        let (Some(when), Some(joint), Some(target)) = (when, joint, target) else {
            return;
        };
        self.checked.end_effectors.push(EndEffector { name, line, when, joint, orientation, target });
        self.checked.effector_places.push(table.place.clone());
    }

    /// Skeleton of a character, where its first clip is sound.
    pub fn skeleton(&self, who: CharacterId) -> Option<&Skeleton> {
        let first = self.cast[who.as_usize()].track.first()?;
        first.clip.as_ref().map(|clip| &*clip.clip.skeleton)
    }

    /// The joint of a character that has a role or is called so in its file.
    fn joint(&mut self, who: CharacterId, joint: &At<String>) -> Option<JointId> {
        let skeleton = self.skeleton(who)?;
        let by_role = JointRole::named(&joint.value).and_then(|role| skeleton.joint_of(role));
        if let Some(found) = by_role.or_else(|| skeleton.joint_named(&joint.value)) {
            return Some(found);
        }
        let mut roles: Vec<&str> =
            skeleton.joints.iter().filter_map(|joint| joint.role.map(JointRole::name)).collect();
        roles.sort_unstable();
        let names = skeleton.joints.iter().map(|joint| joint.name.as_str());
        let meant = suggest::closest(&joint.value, roles.iter().copied().chain(names));
        let meant = meant.map_or(String::new(), |meant| format!("did you mean \"{meant}\"? "));
        let help = format!("{meant}roles: {}; or the name of a joint in its file", suggest::list(&roles));
        let message = format!("\"{}\" has no joint \"{}\"", self.cast[who.as_usize()].name, joint.value);
        self.report.fault(&joint.place, message, help);
        None
    }

    fn target(&mut self, target: &At<things::Target>, when: Option<&When>) -> Option<EffectorTarget> {
        let At { value: raw, place } = target;
        let kinds = [raw.position.is_absent(), raw.object.is_absent(), raw.character.is_absent()];
        let count = kinds.iter().filter(|absent| !**absent).count();
        if count != 1 {
            let message =
                if count == 0 { "the target names nothing" } else { "the target names several things" };
            self.report.fault(place, message, TARGETS);
            return None;
        }
        self.strays(raw);
        if !kinds[0] {
            return self.world_point(raw.position.given()?).map(EffectorTarget::World);
        }
        if !kinds[1] {
            let object = raw.object.given().and_then(|name| self.object(&name.value, &name.place));
            if raw.point.is_absent() {
                let help =
                    "add point = [x, y, z]: metres ahead, up and to the right of the middle of its base";
                self.report.fault(place, "the target says no point of the object", help);
            }
            let point = raw.point.given().and_then(|point| self.world_point(point));
            return Some(EffectorTarget::Object { object: object?, point: point? });
        }
        self.joint_target(target, when)
    }

    /// Reports keys that go with another kind of target.
    fn strays(&mut self, raw: &things::Target) {
        let mut stray = |place: Option<&Place>, key: &str, owner: &str, owned: bool| {
            if let (Some(place), false) = (place, owned) {
                let message = format!("\"{key}\" goes with {owner}");
                self.report.fault(place, message, TARGETS);
            }
        };
        let (object, character) = (!raw.object.is_absent(), !raw.character.is_absent());
        let both = "\"object\" and \"character\"";
        stray(raw.point.given().map(|at| &at.place), "point", both, object || character);
        stray(raw.joint.given().map(|at| &at.place), "joint", "\"character\"", character);
        stray(raw.at.given().map(|at| &at.place), "at", "\"character\"", character);
    }

    fn world_point(&mut self, point: &At<Triple<f64>>) -> Option<DVec3> {
        for value in point.value.iter().filter(|value| value.value.abs() > FARTHEST) {
            let message = format!("{} metres is too far away", value.value);
            self.report.fault(&value.place, message, format!("stay within {FARTHEST} metres"));
        }
        Some(DVec3::from_array(point.value.each_ref().map(|value| value.value)))
    }

    fn joint_target(&mut self, target: &At<things::Target>, when: Option<&When>) -> Option<EffectorTarget> {
        let At { value: raw, place } = target;
        if raw.joint.is_absent() {
            let help = "add joint = \"right_hand\", or whichever it is";
            self.report.fault(place, "the target says no joint of the character", help);
        }
        let name = raw.character.given()?;
        let character = self.character(&name.value, &name.place)?;
        let joint = raw.joint.given().and_then(|joint| self.joint(character, joint));
        let partner = match raw.at.given() {
            None => None,
            Some(at) => Some(self.partner_moment(at, when, character)?),
        };
        if when.is_some_and(|when| when.character() == character) {
            let message = format!("\"{0}\" cannot reach a joint of \"{0}\"", name.value);
            self.report.fault(&name.place, message, "name somebody else, a point of the world, or an object");
        }
        let point = raw.point.given().and_then(|point| self.world_point(point)).unwrap_or_default();
        Some(EffectorTarget::Joint { character, joint: joint?, point, when: partner })
    }

    /// The moment or interval of the character whose joint is reached.
    fn partner_moment(
        &mut self,
        at: &At<OneOrPair>,
        when: Option<&When>,
        whose: CharacterId,
    ) -> Option<When> {
        let found = match self.partner_when(at, when)? {
            Ok(found) => found,
            Err(name) => {
                let message = format!("\"{name}\" is no moment: it has no ':'");
                self.report.fault(&at.place, message, "write a moment such as \"ann:start\"");
                return None;
            }
        };
        if found.character() != whose {
            let (told, meant) = (found.character().as_usize(), whose.as_usize());
            let message =
                format!("this is of \"{}\", not of \"{}\"", self.cast[told].name, self.cast[meant].name);
            self.report.fault(&at.place, message, "name a moment of the character whose joint is reached");
        }
        Some(found)
    }
}

fn orientation(given: &Field<Turn>) -> Option<Orientation> {
    match given.value()? {
        WordOr::Word(_) => Some(Orientation::AsBefore),
        WordOr::Other(degrees) => {
            let [x, y, z] = degrees.each_ref().map(|angle| angle.value.to_radians());
            let turn = DQuat::from_rotation_z(z) * DQuat::from_rotation_y(y) * DQuat::from_rotation_x(x);
            Some(Orientation::Given(turn))
        }
    }
}

/// Warns of joints that must reach something while nothing brings their bodies near. `tracks`: of the cast.
pub fn warn_of_lonely(checked: &Checked, tracks: &[Option<Track>], report: &mut Report) {
    let frame = |moment: &Moment| tracks.get(moment.character.as_usize())?.as_ref()?.locate(moment.instant);
    let ends = |when: &When| {
        let frames: Option<Vec<f64>> = when.moments().into_iter().map(frame).collect();
        frames.map(|frames| (when.character(), frames[0], frames[frames.len() - 1]))
    };
    let placed: Vec<_> = checked.constraints.iter().flat_map(placed).filter_map(ends).collect();
    for (effector, place) in checked.end_effectors.iter().zip(&checked.effector_places) {
        let Some((who, first, last)) = ends(&effector.when) else {
            continue;
        };
        let near = |known: &(CharacterId, f64, f64)| {
            known.0 == who && known.1 <= last + NEAR && known.2 >= first - NEAR
        };
        if !placed.iter().any(near) {
            let message = format!("nothing brings the body near what \"{}\" reaches", effector.name);
            report.warn(place, message, "add a [[pin]] or a [[relative]] at this moment");
        }
    }
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
