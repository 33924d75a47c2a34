//! `cotillion inspect` and `cotillion clips`: facts of clips.

use std::path::Path;
use std::sync::Arc;

use cotillion::clip::Clip;
use cotillion::clip::builtin::{self, BuiltinError, BuiltinInfo};
use cotillion::clip::inspect::{ClipFacts, facts_text, inspect as facts_of};
use cotillion::clip::read::ReadOptions;
use cotillion::clip::working::WorkingClip;
use cotillion::graph::facts::transition_facts;
use cotillion::graph::{GraphSettings, motion_graph};
use rayon::prelude::*;
use serde_json::json;

use super::capture::{parameters, plain};
use super::convert::write_bvh;
use super::draw::draw;
use super::output::{Output, PlainError};
use super::{ClipsArgs, Failure, InspectArgs};

pub(crate) fn inspect(args: &InspectArgs) -> Result<(), Failure> {
    let output = Output::new(args.manner);
    let options = args.read.options().map_err(|error| output.fail(error))?;
    let read: Vec<Result<(Clip, ClipFacts), PlainError>> =
        args.clips.par_iter().map(|path| clip_and_facts(path, args, &options)).collect();
    let (mut clips, mut facts, mut errors) = (Vec::new(), Vec::new(), Vec::new());
    for clip in read {
        match clip {
            Ok((clip, own)) => {
                clips.push(clip);
                facts.push(own);
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

fn clip_and_facts(
    path: &Path,
    args: &InspectArgs,
    options: &ReadOptions,
) -> Result<(Clip, ClipFacts), PlainError> {
    let read = args.read.read(path, options)?;
    let mut facts = facts_of(&path.display().to_string(), &read);
    let (first, last) = read.clip.usable;
    let working = Arc::new(WorkingClip::new(&read.clip.name, Arc::new(read.clip.clone()), first, last));
    let graph = motion_graph(std::slice::from_ref(&working), &GraphSettings::default());
    facts.transitions = Some(transition_facts(&graph, 0, &working));
    Ok((read.clip, facts))
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
