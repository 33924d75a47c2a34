//! `cotillion inspect` and `cotillion clips`: facts of clips.

use std::path::Path;
use std::sync::Arc;

use cotillion::clip::Clip;
use cotillion::clip::builtin::{self, BuiltinError, BuiltinInfo};
use cotillion::clip::contacts::ContactPoint;
use cotillion::clip::contacts::annotated::{AnnotatedContact, overlap, point_named};
use cotillion::clip::inspect::{ClipFacts, facts_text, inspect as facts_of};
use cotillion::clip::read::ReadOptions;
use cotillion::clip::working::WorkingClip;
use cotillion::graph::GraphSettings;
use cotillion::graph::facts::transition_facts;
use cotillion::graph_cache::{CacheNote, cached_graph};
use cotillion::index::SourceFrame;
use rayon::prelude::*;
use serde_json::json;

use super::capture::{parameters, plain};
use super::convert::write_bvh;
use super::draw::{Drawable, draw};
use super::output::{Output, PlainError};
use super::{ClipsArgs, Failure, InspectArgs};

pub(crate) fn inspect(args: &InspectArgs) -> Result<(), Failure> {
    let output = Output::new(args.manner);
    let options = args.read.options().map_err(|error| output.fail(error))?;
    let cache = args.cache.folder();
    let read: Vec<Result<Inspected, PlainError>> =
        args.clips.par_iter().map(|path| inspected(path, args, (&options, cache.as_deref()))).collect();
    let (mut clips, mut facts, mut errors) = (Vec::new(), Vec::new(), Vec::new());
    for clip in read {
        match clip {
            Ok(Inspected { drawable, facts: own, notes }) => {
                clips.push(drawable);
                facts.push(own);
                notes.iter().for_each(|note| output.note(&note.to_string()));
            }
            Err(error) => errors.push(error),
        }
    }
    for own in &facts {
        output.say(&format!("{}\n", facts_text(own)));
    }
    output.print_json(&facts);
    draw(&output, &args.draw, &clips)?;
    if errors.is_empty() {
        return Ok(());
    }
    output.errors(&errors);
    Err(Failure::BadInput)
}

/// A clip with all that is told and drawn of it.
struct Inspected {
    drawable: Drawable,
    facts: ClipFacts,
    notes: Vec<CacheNote>,
}

fn inspected(
    path: &Path,
    args: &InspectArgs,
    (options, cache): (&ReadOptions, Option<&Path>),
) -> Result<Inspected, PlainError> {
    let mut read = args.read.read(path, options)?;
    read.clip.contacts.extend(stated_contacts(&args.contact, &read.clip)?);
    let mut facts = facts_of(&path.display().to_string(), &read);
    let (first, last) = read.clip.usable;
    let name = read.clip.name.clone();
    let working = Arc::new(WorkingClip::new(&name, Arc::new(read.clip), first, last));
    if working.frame_count() > MOST_FRAMES {
        if args.draw.asks_for_graph() {
            return Err(too_long(&facts.file, working.frame_count()));
        }
        return Ok(Inspected { drawable: Drawable { working, graph: None }, facts, notes: Vec::new() });
    }
    let (graph, notes) = cached_graph(std::slice::from_ref(&working), &GraphSettings::default(), cache);
    facts.transitions = Some(transition_facts(&graph, 0, &working));
    Ok(Inspected { drawable: Drawable { working, graph: Some(graph) }, facts, notes })
}

/// Longer clips are shown without transitions, whose cost is quadratic; working frames, eleven minutes.
const MOST_FRAMES: usize = 20_000;

fn too_long(file: &str, frames: usize) -> PlainError {
    let message = format!("{frames} working frames; the motion graph of up to {MOST_FRAMES} is drawn");
    plain(file, message, Some("choose a part with --frames FIRST..LAST".to_owned()))
}

/// Contacts given as JOINT=FIRST..LAST.
fn stated_contacts(given: &[String], clip: &Clip) -> Result<Vec<AnnotatedContact>, PlainError> {
    let (first, last) = clip.usable;
    let wrong = |message: String| {
        let roles = ContactPoint::ALL.map(|point| point.role().name()).join(", ");
        let help =
            format!("write JOINT=FIRST..LAST with frames {} to {} and one of {roles}", first.0, last.0);
        plain("--contact", message, Some(help))
    };
    let contact = |text: &String| {
        let form = || wrong(format!("\"{text}\" is not JOINT=FIRST..LAST"));
        let (joint, frames) = text.split_once('=').ok_or_else(form)?;
        let (from, to) = frames.split_once("..").ok_or_else(form)?;
        let frame = |text: &str| text.trim().parse().map(SourceFrame).map_err(|_| form());
        let (from, to) = (frame(from)?, frame(to)?);
        if from > to || from < first || to > last {
            return Err(wrong(format!("\"{text}\" is no range of frames of {}", clip.name)));
        }
        let point = point_named(&clip.skeleton, joint.trim()).map_err(|error| wrong(error.to_string()))?;
        Ok(AnnotatedContact { point, from, to })
    };
    let contacts: Vec<AnnotatedContact> = given.iter().map(contact).collect::<Result<_, _>>()?;
    match overlap(&contacts) {
        None => Ok(contacts),
        Some((a, b)) => Err(wrong(format!("\"{}\" and \"{}\" overlap", given[a], given[b]))),
    }
}

/// Lists generated clips, or writes one.
pub(crate) fn clips(args: &ClipsArgs) -> Result<(), Failure> {
    let output = Output::new(args.manner);
    let Some(name) = &args.name else {
        output.say(&builtin::names().map(described).collect::<String>());
        output.print_json(&builtin::names().map(described_json).collect::<Vec<_>>());
        return Ok(());
    };
    let fail = |error: PlainError| output.fail(error);
    let more = parameters(&args.parameter).map_err(fail)?;
    let asked = name.strip_prefix("builtin:").unwrap_or(name);
    let wrong = |error: BuiltinError| {
        fail(plain(name, error.to_string(), Some("`cotillion clips` lists clips and parameters".to_owned())))
    };
    let (name, mut parameters) = builtin::request(asked).map_err(wrong)?;
    parameters.extend(more);
    let generated = builtin::generate(&name, &parameters).map_err(wrong)?;
    match &args.output {
        Some(path) => write_bvh(&output, path, &generated, &args.bvh)?,
        None => {
            let info = builtin::names().find(|info| info.name == name);
            output.say(&info.map_or(String::new(), described));
            output.print_json(&info.map(described_json));
        }
    }
    Ok(())
}

fn described(info: &BuiltinInfo) -> String {
    let mut text = format!("builtin:{:<8} {}\n", info.name, info.description);
    for parameter in info.parameters {
        let (default, (low, high)) = (parameter.default, parameter.range);
        let values = if parameter.is_switch() {
            format!("; 0 or 1 (default {default})")
        } else {
            format!(" (default {default} {}, {low} to {high})", parameter.unit)
        };
        text += &format!("    {:<10} {}{values}\n", parameter.name, parameter.description);
    }
    if !info.events.is_empty() {
        text += &format!("    events: {}\n", info.events.join(", "));
    }
    text
}

fn described_json(info: &BuiltinInfo) -> serde_json::Value {
    let parameters: Vec<_> = info
        .parameters
        .iter()
        .map(|parameter| {
            json!({
                "name": parameter.name, "description": parameter.description, "unit": parameter.unit,
                "default": parameter.default, "range": [parameter.range.0, parameter.range.1],
            })
        })
        .collect();
    json!({ "name": info.name, "description": info.description, "parameters": parameters, "events": info.events })
}
