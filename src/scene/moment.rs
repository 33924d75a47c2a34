//! Moment references, `ann/slap#2:hit`: their grammar, and the frames they name.

use std::collections::{BTreeMap, HashMap};
use std::sync::Arc;

use crate::clip::working::WorkingClip;
use crate::constraint::{Instant, Moment};
use crate::index::{CharacterId, SourceFrame};
use crate::scene::{Performed, suggest};

/// A moment reference taken apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MomentText<'a> {
    /// Whose.
    pub character: &'a str,
    /// Name of a clip of the track, where one is given.
    pub clip: Option<&'a str>,
    /// Which use of the clip on the track, from 1, where it is given.
    pub use_number: Option<usize>,
    /// An event, a frame number, `start` or `end`.
    pub what: &'a str,
}

/// Why a text is no moment reference.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum MomentSyntax {
    /// Nothing says which frame.
    #[error("a moment needs ':' and what happens then")]
    NoColon,
    /// A separator comes twice, or in the wrong place.
    #[error("a moment has one ':', before it at most one '/', and '#' only after the clip")]
    Separators,
    /// Nothing stands where a name should.
    #[error("a name in this moment is empty")]
    EmptyName,
    /// What follows `#` does not count uses.
    #[error("'#' must be followed by a number from 1: which use of the clip is meant")]
    UseNumber,
}

/// Takes a moment reference apart: `CHARACTER`, then optionally `/CLIP` and `#N`, then `:` and what happens.
///
/// # Errors
/// [`MomentSyntax`] says what is not in its place.
pub fn parse(text: &str) -> Result<MomentText<'_>, MomentSyntax> {
    let (whose, what) = text.split_once(':').ok_or(MomentSyntax::NoColon)?;
    let (character, clip) = match whose.split_once('/') {
        Some((character, clip)) => (character, Some(clip)),
        None => (whose, None),
    };
    let (clip, number) = match clip.and_then(|clip| clip.split_once('#')) {
        Some((name, number)) => (Some(name), Some(number)),
        None => (clip, None),
    };
    let names = [Some(character), clip, Some(what)];
    if names.into_iter().flatten().any(|name| name.contains(SEPARATORS)) {
        return Err(MomentSyntax::Separators);
    }
    if names.into_iter().flatten().any(str::is_empty) {
        return Err(MomentSyntax::EmptyName);
    }
    let use_number = match number.map(str::parse) {
        None => None,
        Some(Ok(number)) if number >= 1 => Some(number),
        Some(_) => return Err(MomentSyntax::UseNumber),
    };
    Ok(MomentText { character, clip, use_number, what })
}

/// Characters that no name may hold.
pub const SEPARATORS: [char; 3] = ['/', ':', '#'];

/// A clip on somebody's track, as far as it is sound.
#[derive(Clone, Debug)]
pub struct Entry {
    /// Name of the clip.
    pub name: String,
    /// `None` where a fault of the clip is already reported.
    pub clip: Option<Arc<WorkingClip>>,
    /// Named frames of the clip's file.
    pub events: Arc<BTreeMap<String, SourceFrame>>,
}

/// Somebody whom moments may name.
#[derive(Clone, Debug)]
pub struct Member {
    /// Who; empty where the name is at fault, which is already reported.
    pub name: String,
    /// Clips of the track, in order.
    pub track: Vec<Entry>,
    /// Whether every clip of the track is known by name; where not, that is already reported.
    pub track_is_known: bool,
    /// Clips of other bodies on the track, each once.
    pub performed: Vec<Performed>,
}

/// Why a moment names no frame.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Unresolved {
    /// Its author must change it.
    Wrong {
        /// What is wrong.
        message: String,
        /// What to do.
        help: String,
    },
    /// A fault elsewhere, already reported, is in the way.
    Spoiled,
}

/// The moment that `text` names among `cast`; `places`: where in it each name comes first.
///
/// # Errors
/// [`Unresolved`] if it names none, or more than one.
pub fn resolve(text: &str, (cast, places): (&[Member], &HashMap<&str, usize>)) -> Result<Moment, Unresolved> {
    let parsed = parse(text).map_err(|error| {
        let help = "write CHARACTER:WHAT or CHARACTER/CLIP:WHAT, such as \"ann:start\" or \"ann/slap#2:hit\"";
        wrong(format!("\"{text}\" is no moment: {error}"), help)
    })?;
    let position = places.get(parsed.character).copied().ok_or_else(|| {
        if cast.iter().any(|member| member.name.is_empty()) {
            return Unresolved::Spoiled;
        }
        let names: Vec<_> = cast.iter().map(|member| member.name.as_str()).collect();
        let help = suggest::remedy(parsed.character, "characters", &names);
        wrong(format!("no character \"{}\"", parsed.character), help)
    })?;
    let instant = instant(&parsed, &cast[position])?;
    let character = CharacterId::from_usize(position);
    Ok(Moment { character, instant, name: text.to_owned() })
}

fn wrong(message: impl Into<String>, help: impl Into<String>) -> Unresolved {
    Unresolved::Wrong { message: message.into(), help: help.into() }
}

fn instant(parsed: &MomentText<'_>, member: &Member) -> Result<Instant, Unresolved> {
    match (parsed.clip, parsed.what) {
        (None, "start") => Ok(Instant::TrackStart),
        (None, "end") => Ok(Instant::TrackEnd),
        (None, what) => anywhere(what, member),
        (Some(clip), what) => {
            let entry = entry_of(clip, parsed, member)?;
            match what {
                "start" => Ok(Instant::ClipStart(entry)),
                "end" => Ok(Instant::ClipEnd(entry)),
                _ => frame_in(what, entry, member),
            }
        }
    }
}

/// Position on the track of the clip that a moment names.
fn entry_of(clip: &str, parsed: &MomentText<'_>, member: &Member) -> Result<usize, Unresolved> {
    let uses = uses_of(clip, member);
    let count = uses.len();
    if count == 0 || !member.track_is_known {
        return Err(not_on_track(clip, member));
    }
    match parsed.use_number {
        None if count == 1 => Ok(uses[0]),
        Some(number) if number <= count => Ok(uses[number - 1]),
        Some(number) => {
            let message = format!("\"{}\" performs \"{clip}\" {count} times, not {number}", member.name);
            Err(wrong(message, format!("write #1 to #{count}, or none where it is used once")))
        }
        None => {
            let message = format!("\"{}\" performs \"{clip}\" {count} times", member.name);
            Err(wrong(message, format!("say which: {}", choices(parsed.what, &uses, member))))
        }
    }
}

fn uses_of(clip: &str, member: &Member) -> Vec<usize> {
    (0..member.track.len()).filter(|entry| member.track[*entry].name == clip).collect()
}

fn not_on_track(clip: &str, member: &Member) -> Unresolved {
    if !member.track_is_known {
        return Unresolved::Spoiled;
    }
    let mut names: Vec<_> = member.track.iter().map(|entry| entry.name.as_str()).collect();
    names.dedup();
    let help = suggest::remedy(clip, "clips of the track", &names);
    wrong(format!("\"{}\" performs no clip \"{clip}\"", member.name), help)
}

/// The one use of a clip on the track that has the event or frame `what`.
fn anywhere(what: &str, member: &Member) -> Result<Instant, Unresolved> {
    let mut found = Vec::new();
    for entry in 0..member.track.len() {
        match frame_in(what, entry, member) {
            Ok(instant) => found.push((entry, instant)),
            Err(Unresolved::Spoiled) => return Err(Unresolved::Spoiled),
            Err(Unresolved::Wrong { .. }) => {}
        }
    }
    match found.as_slice() {
        _ if !member.track_is_known => Err(Unresolved::Spoiled),
        [(_, instant)] => Ok(*instant),
        [] => Err(nowhere(what, member)),
        _ => {
            let entries: Vec<_> = found.iter().map(|(entry, _)| *entry).collect();
            let message = format!("\"{what}\" fits {} places of \"{}\"", entries.len(), member.name);
            Err(wrong(message, format!("say which: {}", choices(what, &entries, member))))
        }
    }
}

fn nowhere(what: &str, member: &Member) -> Unresolved {
    if let [only] = member.track.as_slice() {
        return frame_of(what, only).err().unwrap_or(Unresolved::Spoiled);
    }
    let mut known = vec!["start", "end"];
    known.extend(member.track.iter().flat_map(|entry| entry.events.keys().map(String::as_str)));
    known.sort_unstable();
    known.dedup();
    let help = suggest::remedy(what, "moments of the track", &known);
    let message = format!("no clip on the track of \"{}\" has the event or frame \"{what}\"", member.name);
    wrong(message, help)
}

/// How to write the moment `what` in each of the clips at `entries`.
fn choices(what: &str, entries: &[usize], member: &Member) -> String {
    let texts: Vec<_> = entries
        .iter()
        .map(|entry| {
            let clip = &member.track[*entry].name;
            let uses = uses_of(clip, member);
            let number = uses.iter().position(|used| used == entry).unwrap_or(0) + 1;
            let number = if uses.len() > 1 { format!("#{number}") } else { String::new() };
            format!("{}/{clip}{number}:{what}", member.name)
        })
        .collect();
    suggest::list(&texts.iter().map(String::as_str).collect::<Vec<_>>())
}

fn frame_in(what: &str, entry: usize, member: &Member) -> Result<Instant, Unresolved> {
    let working = frame_of(what, &member.track[entry])?;
    Ok(Instant::Frame { entry, working })
}

/// Working frame of the event or file frame `what` of a clip.
fn frame_of(what: &str, entry: &Entry) -> Result<f64, Unresolved> {
    let clip = entry.clip.as_ref().ok_or(Unresolved::Spoiled)?;
    let name = &entry.name;
    let (first, last) = (clip.first.0, clip.last.0);
    let (frame, whose) = match what.parse::<u32>() {
        Ok(frame) => (frame, format!("frame {frame}")),
        Err(_) => {
            let frame = entry.events.get(what).ok_or_else(|| no_event(what, entry))?;
            (frame.0, format!("the event \"{what}\", frame {},", frame.0))
        }
    };
    if !(first..=last).contains(&frame) {
        let message = format!("{whose} is outside the frames of clip \"{name}\", {first} to {last}");
        return Err(wrong(message, "name a frame inside, or widen \"frames\" of the clip"));
    }
    Ok(clip.working_frame(f64::from(frame)))
}

fn no_event(what: &str, entry: &Entry) -> Unresolved {
    if what.starts_with(|c: char| c.is_ascii_digit()) {
        let message = format!("\"{what}\" is no frame of clip \"{}\"", entry.name);
        return wrong(message, "frames are whole numbers, counted from 0 as in the file".to_owned());
    }
    let mut known = vec!["start", "end"];
    known.extend(entry.events.keys().map(String::as_str));
    let help = suggest::remedy(what, "events", &known);
    let message = format!("clip \"{}\" has no event \"{what}\"", entry.name);
    wrong(message, format!("{help}; or a frame number; or add events = {{ {what} = FRAME }} to the clip"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_are_taken_apart_and_names_may_hold_spaces() {
        let parsed = parse("ann lee/high five#2:left hand").expect("it is well formed");
        assert_eq!((parsed.character, parsed.clip), ("ann lee", Some("high five")));
        assert_eq!((parsed.use_number, parsed.what), (Some(2), "left hand"));
        assert_eq!(parse("ann:start").map(|parsed| parsed.clip), Ok(None));
    }

    #[test]
    fn what_is_no_moment_says_why() {
        assert_eq!(parse("ann"), Err(MomentSyntax::NoColon));
        assert_eq!(parse("ann:a:b"), Err(MomentSyntax::Separators));
        assert_eq!(parse("ann#2:a"), Err(MomentSyntax::Separators));
        assert_eq!(parse("ann/a/b:c"), Err(MomentSyntax::Separators));
        assert_eq!(parse("ann/:c"), Err(MomentSyntax::EmptyName));
        assert_eq!(parse(":c"), Err(MomentSyntax::EmptyName));
        assert_eq!(parse("ann:"), Err(MomentSyntax::EmptyName));
        assert_eq!(parse("ann/a#0:c"), Err(MomentSyntax::UseNumber));
        assert_eq!(parse("ann/a#x:c"), Err(MomentSyntax::UseNumber));
    }
}
