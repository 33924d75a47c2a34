//! Every character has one body: clips of other bodies on its track are performed by it.

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::clip::retarget::{RetargetReport, retarget};
use crate::clip::working::WorkingClip;
use crate::scene::clips::{self, Declared};
use crate::scene::moment::{Entry, Member};
use crate::scene::raw;
use crate::scene::report::{At, Report};
use crate::scene::suggest;

/// Legs that fall short by less are not worth a word, metres.
const NOTABLE_SHORTFALL: f64 = 0.005;

/// Clips of a scene, and those that other bodies perform; each pair of clip and body is made once.
pub struct Bodies<'a> {
    clips: &'a [Declared],
    performed: BTreeMap<(usize, usize), Option<Arc<WorkingClip>>>,
}

impl<'a> Bodies<'a> {
    /// Of these clips.
    pub const fn new(clips: &'a [Declared]) -> Self {
        Self { clips, performed: BTreeMap::new() }
    }

    /// Gives the clips on somebody's track one body: of the clip that `skeleton` names, else of the first. Joints that
    /// nothing corresponds to are warned of. Cost: linear in frames of the clips that change bodies.
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
            if let Ok(clip) = clips::find(&name.value, self.clips) {
                self.perform((clip, body), entry, name, report);
            }
        }
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

    /// Replaces the clip of `entry`, which is `clip`, by one that `body` performs, where their skeletons differ.
    fn perform(
        &mut self,
        (clip, body): (usize, usize),
        entry: &mut Entry,
        name: &At<String>,
        report: &mut Report,
    ) {
        let (Some(from), Some(onto)) = (&entry.clip, &self.clips[body].entry.clip) else {
            return;
        };
        if from.clip.skeleton.matches(&onto.clip.skeleton) {
            return;
        }
        if let Some(known) = self.performed.get(&(clip, body)) {
            entry.clip.clone_from(known);
            return;
        }
        let performer = &self.clips[body].entry.name;
        let performed = match retarget(&from.clip, &onto.clip) {
            Ok((made, joints)) => {
                if let Some(message) = lost(&entry.name, performer, &joints) {
                    let help = "name joints by `roles` in the clips' tables, or leave it if it is right";
                    report.warn(&name.place, message, help);
                }
                Some(Arc::new(WorkingClip::new(&from.name, Arc::new(made), from.first, from.last)))
            }
            Err(error) => {
                let message =
                    format!("\"{}\" cannot be performed by the body of \"{performer}\": {error}", entry.name);
                let help = "name joints by `roles` in the clips' tables, or use clips of like bodies";
                report.fault(&name.place, message, help);
                None
            }
        };
        entry.clip.clone_from(&performed);
        self.performed.insert((clip, body), performed);
    }
}

/// What is lost where `clip` is performed by the body of `performer`; `None` if nothing is.
fn lost(clip: &str, performer: &str, joints: &RetargetReport) -> Option<String> {
    let list = |names: &[String]| suggest::list(&names.iter().map(String::as_str).collect::<Vec<_>>());
    let mut parts = Vec::new();
    if !joints.unused.is_empty() {
        parts.push(format!("of the clip's joints it has none for {}", list(&joints.unused)));
    }
    if !joints.at_rest.is_empty() {
        parts.push(format!("its own {} stay at rest", list(&joints.at_rest)));
    }
    if joints.shortfall >= NOTABLE_SHORTFALL {
        parts.push(format!("its legs fall {:.3} m short", joints.shortfall));
    }
    let what = parts.join("; ");
    (!parts.is_empty()).then(|| format!("\"{clip}\" is performed by the body of \"{performer}\": {what}"))
}
