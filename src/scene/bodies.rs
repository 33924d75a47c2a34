//! Every character has one body: clips of other bodies on its track are performed by it.

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::clip::retarget::retarget;
use crate::clip::working::WorkingClip;
use crate::scene::Performed;
use crate::scene::clips::{self, Declared};
use crate::scene::moment::{Entry, Member};
use crate::scene::raw;
use crate::scene::report::{At, Report};
use crate::scene::suggest;
use crate::skeleton::Skeleton;

/// What to do about joints that correspond to none.
const ROLES_HELP: &str =
    "name joints by `roles` in the clips' tables where they were not understood, or leave it if it is right";

/// Legs that fall short by less are not worth a word, metres.
const NOTABLE_SHORTFALL: f64 = 0.005;

/// Clips of a scene, and those that other bodies perform; each pair of clip and body is made once.
pub struct Bodies<'a> {
    clips: &'a [Declared],
    made: BTreeMap<(usize, usize), Option<Made>>,
}

/// A clip on another body, and what became of its joints.
type Made = (Arc<WorkingClip>, Performed);

impl<'a> Bodies<'a> {
    /// Of these clips.
    pub const fn new(clips: &'a [Declared]) -> Self {
        Self { clips, made: BTreeMap::new() }
    }

    /// Gives the clips on somebody's track one body: of the clip that `skeleton` names, else of the first. Parts of
    /// the body that nothing corresponds to are warned of. Cost: linear in frames of the clips that change bodies.
    pub fn embody(
        &mut self,
        character: &raw::Character,
        member: &mut Member,
        used: &mut [bool],
        report: &mut Report,
    ) {
        let Some(body) = self.body(character, used, report) else {
            return;
        };
        let Some(track) = character.track.given() else {
            return;
        };
        for (entry, name) in member.track.iter_mut().zip(&track.value) {
            let Some(clip) = self.other(&name.value, entry, body) else {
                continue;
            };
            if !self.made.contains_key(&(clip, body)) {
                let made = self.make(entry, &self.clips[body].entry, name, report);
                self.made.insert((clip, body), made);
            }
            let made = self.made.get(&(clip, body)).and_then(Option::as_ref);
            entry.clip = made.map(|(clip, _)| Arc::clone(clip));
            let is_new = |made: &&Made| !member.performed.contains(&made.1);
            if let Some((_, performed)) = made.filter(is_new) {
                member.performed.push(performed.clone());
            }
        }
    }

    /// Position of the clip that `entry` shows, where it has another skeleton than `body`.
    fn other(&self, name: &str, entry: &Entry, body: usize) -> Option<usize> {
        let clip = clips::find(name, self.clips).ok()?;
        let (own, body) = (entry.clip.as_ref()?, self.clips[body].entry.clip.as_ref()?);
        (!own.clip.skeleton.matches(&body.clip.skeleton)).then_some(clip)
    }

    /// Position of the clip whose body the character has; `None`, reported, if there is none of that name.
    fn body(&self, character: &raw::Character, used: &mut [bool], report: &mut Report) -> Option<usize> {
        let Some(At { value: name, place }) = character.skeleton.given() else {
            let first = character.track.given()?.value.first()?;
            return clips::find(&first.value, self.clips).ok();
        };
        match clips::find(name, self.clips) {
            Ok(clip) => {
                used[clip] = true;
                Some(clip)
            }
            Err(help) => {
                report.fault(place, format!("no clip \"{name}\""), help);
                None
            }
        }
    }

    /// The clip of `entry` performed by the body of `body`; `None`, reported, if it cannot be.
    fn make(&self, entry: &Entry, body: &Entry, name: &At<String>, report: &mut Report) -> Option<Made> {
        let (from, onto) = (entry.clip.as_ref()?, body.clip.as_ref()?);
        let (clip, body) = (entry.name.clone(), body.name.clone());
        match retarget(&from.clip, &onto.clip) {
            Ok((made, joints)) => {
                let performed = Performed { clip, body, joints };
                if let Some(message) = lost(&performed, &onto.clip.skeleton) {
                    report.warn(&name.place, message, ROLES_HELP);
                }
                let working = WorkingClip::new(&from.name, Arc::new(made), from.first, from.last);
                Some((Arc::new(working), performed))
            }
            Err(error) => {
                let message = format!("\"{clip}\" cannot be performed by the body of \"{body}\": {error}");
                report.fault(&name.place, message, ROLES_HELP);
                None
            }
        }
    }
}

/// What is lost; `None` if nothing is. Fingers and helpers of the body that the clip does not move are no loss.
fn lost(Performed { clip, body, joints }: &Performed, skeleton: &Skeleton) -> Option<String> {
    let unused: Vec<&str> = joints.unused.iter().map(String::as_str).collect();
    let has_role = |name: &&str| {
        let joint = skeleton.joint_named(name);
        joint.is_some_and(|joint| skeleton.joints[joint.as_usize()].role.is_some())
    };
    let at_rest: Vec<&str> = joints.at_rest.iter().map(String::as_str).filter(has_role).collect();
    let mut parts = Vec::new();
    if !unused.is_empty() {
        parts.push(format!("it has no joints for {}", suggest::list(&unused)));
    }
    if !at_rest.is_empty() {
        parts.push(format!("its {} stay at rest", suggest::list(&at_rest)));
    }
    if joints.shortfall >= NOTABLE_SHORTFALL {
        parts.push(format!("its legs fall {:.3} m short", joints.shortfall));
    }
    let what = parts.join("; ");
    (!parts.is_empty()).then(|| format!("\"{clip}\" is performed by the body of \"{body}\": {what}"))
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;
    use crate::clip::builtin::generate;
    use crate::clip::retarget::RetargetReport;
    use crate::skeleton::{Joint, JointRole};

    #[test]
    fn fingers_that_a_clip_does_not_move_are_no_loss_but_hands_are() {
        let mut skeleton = (*generate("idle", &BTreeMap::new()).expect("it is generated").skeleton).clone();
        let hand = skeleton.joint_of(JointRole::LeftHand).expect("bodies have hands");
        let hand = skeleton.joints[hand.as_usize()].clone();
        skeleton.joints.push(Joint { name: "thumb".to_owned(), role: None, ..hand.clone() });
        let told = |at_rest: &[&str]| {
            let at_rest = at_rest.iter().map(ToString::to_string).collect();
            let joints = RetargetReport { at_rest, ..RetargetReport::default() };
            lost(&Performed { clip: "idle".to_owned(), body: "b".to_owned(), joints }, &skeleton)
        };
        assert_eq!(told(&["thumb"]), None);
        let message = told(&["thumb", &hand.name]).expect("a hand is lost");
        assert!(message.contains(&hand.name) && !message.contains("thumb"), "{message}");
    }
}
