//! Clips of a scene: where each comes from, what range of it is used, and its named frames. Each distinct source is
//! read once, in parallel.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use rayon::prelude::*;

use crate::clip::measure::doubtful_fall;
use crate::clip::note::ReadNote;
use crate::clip::read::{self, ReadOptions};
use crate::clip::working::{WORKING_STEP, WorkingClip};
use crate::clip::{Clip, builtin};
use crate::index::SourceFrame;
use crate::scene::annotations::annotations;
use crate::scene::derived::{fill, is_derived};
use crate::scene::moment::{Entry, SEPARATORS};
use crate::scene::raw;
use crate::scene::report::{At, Place, Report};
use crate::scene::sources::{Read, Source, Unreadable, read_source};
use crate::scene::suggest;
use crate::scene::tree::Field;
use crate::scene::values::{Named, Pair, Unit, UnitName, Up, WordOr};
use crate::skeleton::JointRole;

/// Where clips are looked for besides the folder of the scene file.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ClipFolders {
    /// Where `mocap:` files are; `None` if nobody has said.
    pub mocap: Option<PathBuf>,
}

impl ClipFolders {
    /// What `$COTILLION_MOCAP` says.
    pub fn from_environment() -> Self {
        let mocap = std::env::var_os("COTILLION_MOCAP").filter(|folder| !folder.is_empty());
        Self { mocap: mocap.map(PathBuf::from) }
    }
}

/// Where the clips of one scene file are looked for.
#[derive(Clone, Copy, Debug)]
pub struct Folders<'a> {
    /// Where the scene file is.
    pub scene: &'a Path,
    /// Where `mocap:` files are.
    pub mocap: Option<&'a Path>,
}

/// A clip of the `[clips]` table.
#[derive(Clone, Debug)]
pub struct Declared {
    /// Where it is declared.
    pub place: Place,
    /// What it is, as far as it is sound.
    pub entry: Entry,
}

/// Shortest clip: paths need three working frames to have a shape.
const FEWEST_WORKING_FRAMES: usize = 3;

/// Longest clip, seconds: a day. What is longer comes from a wrong rate.
const LONGEST_CLIP: f64 = 86_400.0;

/// Reads the clips that `scene` declares.
pub fn declared(scene: &raw::Scene, folders: Folders<'_>, report: &mut Report) -> Vec<Declared> {
    let Some(clips) = scene.clips.value() else { return Vec::new() };
    let sources: Vec<_> = clips
        .0
        .iter()
        .map(|(name, clip)| {
            check_name(&At { value: name.clone(), place: clip.place.clone() }, "clip", report);
            source_of(clip, folders, report)
        })
        .collect();
    let results = read_once(&sources);
    let mut entries = Vec::with_capacity(sources.len());
    for ((name, clip), source) in clips.0.iter().zip(&sources) {
        let read = source.as_ref().and_then(|(source, place)| match &results[&source.key()] {
            Ok(read) => Some(read),
            Err(Unreadable { message, help }) => {
                report.fault(place, message.clone(), help.clone());
                None
            }
        });
        entries.push((!is_derived(&clip.value)).then(|| entry(name, clip, read, report)));
    }
    fill(clips, entries, report)
}

/// Reports a name that moments could not hold.
pub fn check_name(name: &At<String>, what: &str, report: &mut Report) {
    let text = &name.value;
    let separator = text.chars().find(|c| SEPARATORS.contains(c) || c.is_control());
    if text.trim().is_empty() {
        let message = format!("a {what} needs a name");
        report.fault(&name.place, message, "write at least one letter or digit");
    } else if let Some(separator) = separator {
        let message = format!("a {what} cannot be called {text:?}: it holds {separator:?}");
        let help = "leave out '/', ':', '#' and control characters, which moments use or cannot show";
        report.fault(&name.place, message, help);
    }
}

/// Reads every distinct source once.
fn read_once(sources: &[Option<(Source, Place)>]) -> BTreeMap<String, Result<Read, Unreadable>> {
    let distinct: BTreeMap<String, &Source> =
        sources.iter().flatten().map(|(source, _)| (source.key(), source)).collect();
    distinct.into_par_iter().map(|(key, source)| (key, read_source(source))).collect()
}

/// Where `clip` comes from, and the place that says so.
fn source_of(clip: &At<raw::Clip>, folders: Folders<'_>, report: &mut Report) -> Option<(Source, Place)> {
    match &clip.value {
        raw::Clip::Spoiled | raw::Clip::Derived(_) | raw::Clip::Blended(_) => None,
        raw::Clip::Source(text) => match text.strip_prefix("builtin:") {
            Some(asked) => match builtin::request(asked) {
                Ok((name, parameters)) => Some((Source::Builtin { name, parameters }, clip.place.clone())),
                Err(error) => {
                    let help = "write \"builtin:NAME\", or \"builtin:NAME,PARAMETER=VALUE\"";
                    report.fault(&clip.place, error.to_string(), help);
                    None
                }
            },
            None => {
                let path = path_of(text, &clip.place, folders, report)?;
                let (skeleton, options) = (None, ReadOptions::default());
                Some((Source::File { path, skeleton, options }, clip.place.clone()))
            }
        },
        raw::Clip::File(file) => file_source(file, folders, report),
        raw::Clip::Builtin(builtin) => {
            let At { value: name, place } = builtin.builtin.given()?;
            let parameters = builtin.parameters.iter();
            let parameters = parameters.map(|(key, value)| (key.clone(), value.value));
            let (name, parameters) = (name.clone(), parameters.collect());
            Some((Source::Builtin { name, parameters }, place.clone()))
        }
    }
}

fn file_source(file: &raw::FileClip, folders: Folders<'_>, report: &mut Report) -> Option<(Source, Place)> {
    let options = options_of(file, report);
    let At { value, place } = file.file.given()?;
    if value.starts_with("builtin:") {
        let help = "write { builtin = \"NAME\" } for a generated clip";
        report.fault(place, "a generated clip is no file", help);
        return None;
    }
    let path = path_of(value, place, folders, report)?;
    let skeleton = match file.skeleton.given() {
        Some(At { value, place }) => Some(path_of(value, place, folders, report)?),
        None => None,
    };
    let options = options?;
    Some((Source::File { path, skeleton, options }, place.clone()))
}

/// Path of the file that `text` names, beside the scene file or below the `mocap:` folder.
fn path_of(text: &str, place: &Place, folders: Folders<'_>, report: &mut Report) -> Option<PathBuf> {
    match (text.strip_prefix("mocap:"), folders.mocap) {
        (None, _) => Some(folders.scene.join(text)),
        (Some(below), Some(mocap)) => Some(mocap.join(below)),
        (Some(_), None) => {
            let message = format!("\"{text}\" is below $COTILLION_MOCAP, which is not set");
            let help = "set COTILLION_MOCAP to the folder of your motion capture";
            report.fault(place, message, help);
            None
        }
    }
}

/// How to read a file; `None`, reported, if it cannot be read so.
fn options_of(file: &raw::FileClip, report: &mut Report) -> Option<ReadOptions> {
    let fps = within(&file.fps, 1000.0, "frames per second", report);
    let unit_to_m = match file.unit.given() {
        None => None,
        Some(At { value: WordOr::Word(name), .. }) => Some(match name {
            UnitName::Metre => 1.0,
            UnitName::Centimetre => 0.01,
            UnitName::Inch => 0.0254,
        }),
        Some(At { value: Unit::Other(metres), place }) => {
            let given = At { value: *metres, place: place.clone() };
            Some(within(&Field::Given(given), 1000.0, "metres per unit of the file", report)?)
        }
    };
    let up = file.up.value().map(|up| match up {
        Up::Y => read::Up::Y,
        Up::Z => read::Up::Z,
    });
    let roles = roles_of(&file.roles, report);
    let is_set = |field: &Field<bool>| field.value().copied().unwrap_or(false);
    let spoiled = fps.is_none() && !file.fps.is_absent();
    let repair = is_set(&file.repair);
    (!spoiled).then_some(ReadOptions { fps, unit_to_m, up, roles: roles?, repair })
}

/// Joints by role; `None`, reported, if a name is no role.
fn roles_of(given: &Field<Named<String>>, report: &mut Report) -> Option<BTreeMap<JointRole, String>> {
    let mut roles = BTreeMap::new();
    let mut sound = true;
    for (name, joint) in given.value().map_or(&[][..], |roles| &roles.0) {
        match JointRole::named(name) {
            Some(role) => drop(roles.insert(role, joint.value.clone())),
            None => {
                let names = JointRole::ALL.map(JointRole::name);
                let help = suggest::remedy(name, "roles", &names);
                report.fault(&joint.place, format!("no joint role \"{name}\""), help);
                sound = false;
            }
        }
    }
    sound.then_some(roles)
}

/// A number above 0 and at most `largest`; `None` where it is left out, or reported if it is not within.
pub fn within(field: &Field<f64>, largest: f64, what: &str, report: &mut Report) -> Option<f64> {
    let At { value, place } = field.given()?;
    if *value > 0.0 && *value <= largest {
        return Some(*value);
    }
    let message = format!("{value} is no number of {what}");
    let help = format!("write a number above 0 and at most {largest}");
    report.fault(place, message, help);
    None
}

/// What to do about a reader's note.
const NOTE_HELP: &str = "settle it in the clip's table, or leave it if it is right";

/// The clip as its tracks use it: range and named frames.
pub fn entry(name: &str, declared: &At<raw::Clip>, read: Option<&Read>, report: &mut Report) -> Entry {
    let (frames, events, contacts) = match &declared.value {
        raw::Clip::Source(_) | raw::Clip::Spoiled => (&Field::Absent, &Field::Absent, &Field::Absent),
        raw::Clip::File(file) => (&file.frames, &file.events, &file.contacts),
        raw::Clip::Builtin(builtin) => (&builtin.frames, &builtin.events, &builtin.contacts),
        raw::Clip::Derived(clip) => (&clip.frames, &clip.events, &clip.contacts),
        raw::Clip::Blended(clip) => (&clip.frames, &clip.events, &clip.contacts),
    };
    check_event_names(events, report);
    let Some(Read { clip, notes }) = read else {
        return Entry { name: name.to_owned(), clip: None, events: Arc::default() };
    };
    let range = range(clip, frames, &declared.place, report);
    let settled = matches!(frames, Field::Given(_));
    let is_open = |note: &&ReadNote| {
        let is_outside = range.is_some_and(|(first, last)| note.is_outside(first, last));
        !(is_outside || settled && note.is_settled_by_frames())
    };
    let notes: Vec<&ReadNote> = notes.iter().filter(is_open).collect();
    let strict = match &declared.value {
        raw::Clip::File(file) => file.strict.given().filter(|strict| strict.value),
        _ => None,
    };
    if let Some(At { place, .. }) = strict.filter(|_| !notes.iter().all(|note| note.is_repair())) {
        let all: Vec<String> = notes.iter().map(ToString::to_string).collect();
        report.fault(place, format!("clip \"{name}\", read strictly: {}", all.join("; ")), NOTE_HELP);
    } else {
        for note in notes {
            report.warn(&declared.place, format!("clip \"{name}\": {note}"), NOTE_HELP);
        }
    }
    let mut named = clip.events.clone();
    if let Some(events) = events.value() {
        named.extend(events.0.iter().map(|(event, frame)| (event.clone(), SourceFrame(frame.value))));
        check_events(events, range, report);
    }
    let working = range.map(|(first, last)| {
        let stated = annotations(contacts, clip, (first, last), report);
        let clip = if stated.is_empty() {
            Arc::clone(clip)
        } else {
            Arc::new(Clip { contacts: [clip.contacts.clone(), stated].concat(), ..Clip::clone(clip) })
        };
        WorkingClip::new(name, clip, first, last)
    });
    if let Some(note) = working.as_ref().and_then(doubtful_fall) {
        report.warn(&declared.place, format!("clip \"{name}\": {note}"), NOTE_HELP);
    }
    Entry { name: name.to_owned(), clip: working.map(Arc::new), events: Arc::new(named) }
}

/// First and last frame to use; `None`, reported, if the clip has no such range.
fn range(
    clip: &Clip,
    frames: &Field<Pair<u32>>,
    place: &Place,
    report: &mut Report,
) -> Option<(SourceFrame, SourceFrame)> {
    let (first, last, place) = match frames {
        Field::Spoiled => return None,
        Field::Absent => (clip.usable.0, clip.usable.1, place),
        Field::Given(At { value: [first, last], place }) => {
            (SourceFrame(first.value), SourceFrame(last.value), place)
        }
    };
    let count = clip.frame_count();
    if last.as_usize() >= count {
        let message = format!("the file has {count} frames: frame {} is not among them", last.0);
        report.fault(
            place,
            message,
            format!("frames count from 0: the last one is {}", count.saturating_sub(1)),
        );
        return None;
    }
    if first > last {
        let message = format!("the first frame, {}, comes after the last, {}", first.0, last.0);
        report.fault(place, message, format!("write frames = [{}, {}]", last.0, first.0));
        return None;
    }
    let seconds = f64::from(last.0 - first.0) / clip.fps;
    if seconds > LONGEST_CLIP {
        let message = format!("{seconds:.0} seconds at {} frames a second is more than a day", clip.fps);
        report.fault(place, message, "give the clip its right fps, or fewer frames");
        return None;
    }
    let shortest = WORKING_STEP * (FEWEST_WORKING_FRAMES as f64 - 1.0);
    if seconds < shortest * (1.0 - 1e-9) {
        let message = format!("{seconds:.3} seconds are too short to be edited");
        report.fault(place, message, format!("use a range of at least {shortest:.3} seconds"));
        return None;
    }
    Some((first, last))
}

fn check_event_names(events: &Field<Named<u32>>, report: &mut Report) {
    for (name, frame) in events.value().map_or(&[][..], |events| &events.0) {
        check_name(&At { value: name.clone(), place: frame.place.clone() }, "event", report);
        if name == "start" || name == "end" || name.parse::<u32>().is_ok() {
            let message = format!("an event cannot be called \"{name}\"");
            report.fault(
                &frame.place,
                message,
                "start, end and numbers already name frames: choose another name",
            );
        }
    }
}

fn check_events(events: &Named<u32>, range: Option<(SourceFrame, SourceFrame)>, report: &mut Report) {
    let Some((first, last)) = range else {
        return;
    };
    for (name, frame) in &events.0 {
        if !(first.0..=last.0).contains(&frame.value) {
            let message = format!("the event \"{name}\" is at frame {}, outside the clip", frame.value);
            let help = format!("the clip uses frames {} to {} of its file", first.0, last.0);
            report.fault(&frame.place, message, help);
        }
    }
}

/// Warns of clips that no track uses.
pub fn warn_of_unused(clips: &[Declared], used: &[bool], report: &mut Report) {
    for (clip, _) in clips.iter().zip(used).filter(|(_, used)| !**used) {
        let message = format!("no track uses clip \"{}\"", clip.entry.name);
        report.warn(&clip.place, message, "put it on a track, or remove it");
    }
}

/// Position of the clip called `name`, or what to do about its absence.
pub fn find(name: &str, clips: &[Declared]) -> Result<usize, String> {
    clips.iter().position(|clip| clip.entry.name == name).ok_or_else(|| {
        let names: Vec<_> = clips.iter().map(|clip| clip.entry.name.as_str()).collect();
        suggest::remedy(name, "clips", &names)
    })
}
