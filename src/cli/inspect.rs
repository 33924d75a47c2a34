//! `cotillion inspect` and `cotillion clips`: facts of clips.

use std::collections::BTreeMap;
use std::path::Path;

use cotillion::clip::Clip;
use cotillion::clip::builtin::{self, BuiltinInfo};
use cotillion::clip::bvh::{self, ReadClip, ReadOptions, Up};
use cotillion::clip::inspect::{ClipFacts, facts_text, inspect as facts_of};
use rayon::prelude::*;
use serde_json::json;

use super::convert::write_bvh;
use super::draw::draw;
use super::output::{Output, PlainError};
use super::{ClipsArgs, Failure, InspectArgs, ReadArgs};

pub(crate) fn inspect(args: &InspectArgs) -> Result<(), Failure> {
    let output = Output::new(args.manner);
    let options = read_options(&args.read).map_err(|error| {
        output.errors(&[error]);
        Failure::BadInput
    })?;
    let read: Vec<Result<(ReadClip, ClipFacts), PlainError>> = args
        .clips
        .par_iter()
        .map(|path| {
            let read = read_clip(path, &options)?;
            let facts = facts_of(&path.display().to_string(), &read);
            Ok((read, facts))
        })
        .collect();
    let (mut clips, mut facts, mut errors) = (Vec::new(), Vec::new(), Vec::new());
    for clip in read {
        match clip {
            Ok((read, own)) => {
                clips.push(read.clip);
                facts.push(own);
            }
            Err(error) => errors.push(error),
        }
    }
    for own in &facts {
        output.say(&format!("{}\n", facts_text(own)));
    }
    output.print_json(&facts);
    draw(&output, &args.draw, &clips.iter().collect::<Vec<_>>())?;
    if errors.is_empty() {
        return Ok(());
    }
    output.errors(&errors);
    Err(Failure::BadInput)
}

/// What the reader is told by the options of a command.
pub(super) fn read_options(args: &ReadArgs) -> Result<ReadOptions, PlainError> {
    if let Some(fps) = args.fps.filter(|fps| !is_positive(*fps)) {
        return Err(wrong_option("--fps", &fps.to_string(), "a positive number of frames per second"));
    }
    let unit_to_m = args.unit.as_ref().map(|name| unit("--unit", name)).transpose()?;
    let up = match args.up.as_deref() {
        None => None,
        Some("y" | "Y") => Some(Up::Y),
        Some("z" | "Z") => Some(Up::Z),
        Some(other) => return Err(wrong_option("--up", other, "y or z")),
    };
    Ok(ReadOptions { fps: args.fps, unit_to_m, up })
}

/// Metres a unit that `option` names.
pub(super) fn unit(option: &str, name: &str) -> Result<f64, PlainError> {
    let metres = match name {
        "m" => Some(1.0),
        "cm" => Some(0.01),
        "inch" => Some(0.0254),
        number => number.parse().ok().filter(|value| is_positive(*value)),
    };
    metres.ok_or_else(|| wrong_option(option, name, "m, cm, inch, or metres per file unit"))
}

fn is_positive(value: f64) -> bool {
    value.is_finite() && value > 0.0
}

pub(super) fn wrong_option(option: &str, value: &str, expected: &str) -> PlainError {
    plain(option, format!("\"{value}\" is not {expected}"), Some(format!("give {expected}")))
}

pub(super) fn plain(file: &str, message: String, help: Option<String>) -> PlainError {
    PlainError { file: file.to_owned(), line: 0, column: 0, message, help }
}

/// Reads any clip: a file, or `builtin:NAME,PARAMETER=VALUE,…`.
pub(super) fn read_clip(path: &Path, options: &ReadOptions) -> Result<ReadClip, PlainError> {
    let file = path.display().to_string();
    if let Some(generated) = file.strip_prefix("builtin:") {
        let mut parts = generated.split(',');
        let name = parts.next().unwrap_or_default();
        let given: Vec<String> = parts.map(str::to_owned).collect();
        let clip = generate(name, &given, &file)?;
        let header_fps = clip.fps;
        return Ok(ReadClip { clip, unit_to_m: 1.0, up: Up::Y, header_fps, notes: Vec::new() });
    }
    let bytes = std::fs::read(path).map_err(|error| {
        plain(&file, format!("cannot be read: {error}"), Some("name a BVH file that can be read".to_owned()))
    })?;
    let name = path.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
    bvh::read(&bytes, &name, options).map_err(|error| {
        let position = error.position();
        PlainError {
            file: file.clone(),
            line: position.line,
            column: position.column,
            message: error.without_position(),
            help: Some("mend the file, or name another one".to_owned()),
        }
    })
}

/// The generated clip `name` with parameters as `NAME=VALUE`; errors are told as of `file`.
fn generate(name: &str, given: &[String], file: &str) -> Result<Clip, PlainError> {
    let help = "`cotillion clips` lists clips and parameters";
    builtin::generate(name, &parameters(given)?)
        .map_err(|error| plain(file, error.to_string(), Some(help.to_owned())))
}

/// Lists generated clips, or writes one.
pub(crate) fn clips(args: &ClipsArgs) -> Result<(), Failure> {
    let output = Output::new(args.manner);
    let Some(name) = &args.name else {
        output.say(&builtin::names().map(described).collect::<String>());
        output.print_json(&builtin::names().map(described_json).collect::<Vec<_>>());
        return Ok(());
    };
    let fail = |error: PlainError| {
        output.errors(&[error]);
        Failure::BadInput
    };
    let generated = generate(name, &args.parameter, name).map_err(fail)?;
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

fn parameters(given: &[String]) -> Result<BTreeMap<String, f64>, PlainError> {
    let wrong = |text: &str| wrong_option("--parameter", text, "NAME=VALUE with a finite number");
    given
        .iter()
        .map(|text| {
            let (name, value) = text.split_once('=').ok_or_else(|| wrong(text))?;
            let value: f64 = value.trim().parse().map_err(|_| wrong(text))?;
            if value.is_finite() { Ok((name.trim().to_owned(), value)) } else { Err(wrong(text)) }
        })
        .collect()
}

fn described(info: &BuiltinInfo) -> String {
    let mut text = format!("builtin:{:<8} {}\n", info.name, info.description);
    for parameter in info.parameters {
        let (low, high) = parameter.range;
        text += &format!(
            "    {:<10} {} (default {} {}, {low} to {high})\n",
            parameter.name, parameter.description, parameter.default, parameter.unit
        );
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
