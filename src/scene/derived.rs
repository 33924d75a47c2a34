//! Clips of a scene that are made of its other clips, whatever their order in the file.

use std::sync::Arc;

use crate::clip::Clip;
use crate::clip::derived::{BlendError, bent, blended, tilted};
use crate::scene::clips::{Declared, entry, within};
use crate::scene::moment::Entry;
use crate::scene::raw;
use crate::scene::report::{At, Report};
use crate::scene::sources::Read;
use crate::scene::suggest;
use crate::scene::tree::Field;
use crate::scene::values::{Named, Turning};

/// Wider bends are straight, metres.
const WIDEST: f64 = 1e5;
/// Steeper slopes are climbed, not walked, degrees.
const STEEPEST: f64 = 60.0;

/// Names of the clips that `clip` is made of; none of a clip that is not derived.
pub fn parents(clip: &raw::Clip) -> Vec<&At<String>> {
    match clip {
        raw::Clip::Derived(derived) => derived.from.given().into_iter().collect(),
        raw::Clip::Blended(blend) => blend.blend.value().map_or(Vec::new(), |[from, to]| vec![from, to]),
        _ => Vec::new(),
    }
}

/// Whether `clip` is made of other clips.
pub fn is_derived(clip: &raw::Clip) -> bool {
    matches!(clip, raw::Clip::Derived(_) | raw::Clip::Blended(_))
}

/// Marks as used what other clips are made of.
pub fn mark_parents(scene: &raw::Scene, clips: &[Declared], used: &mut [bool]) {
    let parents =
        scene.clips.value().into_iter().flat_map(|clips| &clips.0).flat_map(|(_, clip)| parents(&clip.value));
    for parent in parents {
        if let Some(at) = clips.iter().position(|clip| clip.entry.name == parent.value) {
            used[at] = true;
        }
    }
}

/// Makes what is derived of `clips`: each as soon as all that it is made of is there. `known`: the others, `None` for those to make.
pub fn fill(clips: &Named<raw::Clip>, mut known: Vec<Option<Entry>>, report: &mut Report) -> Vec<Declared> {
    let clips = &clips.0;
    let links = links(clips, report);
    loop {
        let is_ready = |at: &usize| {
            let links = links[*at].iter().flatten();
            known[*at].is_none() && links.into_iter().all(|parent| known[*parent].is_some())
        };
        let Some(at) = (0..clips.len()).find(is_ready) else { break };
        let (name, clip) = &clips[at];
        let parents: Option<Vec<Arc<Clip>>> =
            links[at].iter().map(|parent| as_used(known[(*parent)?].as_ref()?)).collect();
        let made = parents.and_then(|parents| made(clip, &parents, report));
        let read =
            made.map(|made| Read { clip: Arc::new(Clip { name: name.clone(), ..made }), notes: Vec::new() });
        known[at] = Some(entry(name, clip, read.as_ref(), report));
    }
    tell_of_circles(clips, &links, &known, report);
    let declared = |((name, clip), entry): (&(String, At<raw::Clip>), Option<Entry>)| Declared {
        place: clip.place.clone(),
        entry: entry.unwrap_or_else(|| Entry { name: name.clone(), clip: None, events: Arc::default() }),
    };
    clips.iter().zip(known).map(declared).collect()
}

/// Positions of what each clip is made of; `None`, reported, where there is no such clip.
fn links(clips: &[(String, At<raw::Clip>)], report: &mut Report) -> Vec<Vec<Option<usize>>> {
    let names: Vec<&str> = clips.iter().map(|(name, _)| name.as_str()).collect();
    let mut link = |parent: &At<String>| {
        let found = names.iter().position(|name| *name == parent.value);
        if found.is_none() {
            let message = format!("no clip \"{}\"", parent.value);
            report.fault(&parent.place, message, suggest::remedy(&parent.value, "clips", &names));
        }
        found
    };
    clips.iter().map(|(_, clip)| parents(&clip.value).into_iter().map(&mut link).collect()).collect()
}

/// The clip as its table says: its frames, named ones and contacts.
fn as_used(entry: &Entry) -> Option<Arc<Clip>> {
    let working = entry.clip.as_ref()?;
    let events = entry.events.as_ref().clone();
    Some(Arc::new(Clip { usable: (working.first, working.last), events, ..Clip::clone(&working.clip) }))
}

/// `None`, reported, where the clips do not give it.
fn made(clip: &At<raw::Clip>, parents: &[Arc<Clip>], report: &mut Report) -> Option<Clip> {
    match (&clip.value, parents) {
        (raw::Clip::Derived(derived), [from]) => edited(derived, from, clip, report),
        (raw::Clip::Blended(blend), [from, to]) => {
            let place = &blend.blend.given()?.place;
            let blended = blended(from, to).map_err(|error| {
                let help = match error {
                    BlendError::OtherSkeleton { .. } => "blend clips of the same body",
                    BlendError::OtherRate { .. } => {
                        "give both the same fps, or convert one to the rate of the other"
                    }
                    _ => "blend two walks or runs that are long enough for a foot to strike the floor twice",
                };
                report.fault(place, error.to_string(), help);
            });
            blended.ok().map(|blended| blended.clip)
        }
        _ => None,
    }
}

/// `from`, bent, then tilted.
fn edited(
    derived: &raw::DerivedClip,
    from: &Clip,
    clip: &At<raw::Clip>,
    report: &mut Report,
) -> Option<Clip> {
    if derived.bend.is_absent() && derived.tilt.is_absent() {
        let help = "add bend = { radius = METRES, to = \"left\" } or tilt = DEGREES, or put the other clip on the track";
        report.fault(&clip.place, "this clip is the other one: nothing is done to it", help);
        return None;
    }
    if matches!(derived.bend, Field::Spoiled) || matches!(derived.tilt, Field::Spoiled) {
        return None;
    }
    let travel = "choose a clip that travels, or frames in which it does";
    let mut made = from.clone();
    if let Some(At { value: bend, place }) = derived.bend.given() {
        let radius = within(&bend.radius, WIDEST, "metres of a radius", report)?;
        let is_right = bend.to.value().is_some_and(|to| *to == Turning::Right);
        let laid = bent(&made, if is_right { -radius } else { radius });
        made = laid.map_err(|error| report.fault(place, error.to_string(), travel)).ok()?;
    }
    if let Some(At { value: degrees, place }) = derived.tilt.given() {
        if degrees.abs() > STEEPEST {
            let help = format!("write an angle from -{STEEPEST} to {STEEPEST} degrees; uphill is positive");
            report.fault(place, format!("nobody walks on a slope of {degrees} degrees"), help);
            return None;
        }
        let laid = tilted(&made, degrees.to_radians());
        made = laid.map_err(|error| report.fault(place, error.to_string(), travel)).ok()?;
    }
    Some(made)
}

/// Reports every circle once, at the first of its clips.
fn tell_of_circles(
    clips: &[(String, At<raw::Clip>)],
    links: &[Vec<Option<usize>>],
    known: &[Option<Entry>],
    report: &mut Report,
) {
    let mut seen = vec![false; clips.len()];
    for start in (0..clips.len()).filter(|at| known[*at].is_none()) {
        let mut way = Vec::new();
        let mut at = start;
        // What is not made lacks a parent that is not made either: the way never ends but on itself.
        while !seen[at] {
            seen[at] = true;
            way.push(at);
            match links[at].iter().flatten().find(|parent| known[**parent].is_none()) {
                Some(parent) => at = *parent,
                None => break,
            }
        }
        let Some(first) = way.iter().position(|own| *own == at) else { continue };
        if way.len() == first || !links[*way.last().unwrap_or(&at)].contains(&Some(at)) {
            continue;
        }
        let circle = &way[first..];
        let names: Vec<String> =
            circle.iter().chain([&at]).map(|own| format!("\"{}\"", clips[*own].0)).collect();
        let message = format!("a clip cannot be made of itself: {}", names.join(" from "));
        report.fault(&clips[at].1.place, message, "make one of them of a file or a generated clip");
    }
}
