//! `cotillion inspect` and `cotillion clips`: facts of clips.

use std::collections::BTreeMap;
use std::path::Path;

use cotillion::clip::builtin::{self, BuiltinInfo};
use cotillion::clip::bvh::{self, ReadClip, ReadOptions, Up};
use cotillion::clip::inspect::{ClipFacts, facts_text, inspect as facts_of};
use cotillion::export::bvh::to_bvh;
use rayon::prelude::*;
use serde_json::json;

use super::output::{Output, PlainError};
use super::{ClipsArgs, Failure, InspectArgs};

pub(crate) fn inspect(args: &InspectArgs) -> Result<(), Failure> {
    let output = Output::new(args.manner);
    let options = options(args).map_err(|error| {
        output.errors(&[error]);
        Failure::BadInput
    })?;
    let read: Vec<Result<ClipFacts, PlainError>> =
        args.clips.par_iter().map(|path| facts(path, &options)).collect();
    let (mut facts, mut errors) = (Vec::new(), Vec::new());
    for clip in read {
        match clip {
            Ok(own) => facts.push(own),
            Err(error) => errors.push(error),
        }
    }
    for own in &facts {
        output.say(&format!("{}\n", facts_text(own)));
    }
    output.print_json(&facts);
    if errors.is_empty() {
        return Ok(());
    }
    output.errors(&errors);
    Err(Failure::BadInput)
}

fn options(args: &InspectArgs) -> Result<ReadOptions, PlainError> {
    let positive = |value: f64| value.is_finite() && value > 0.0;
    if let Some(fps) = args.fps.filter(|fps| !positive(*fps)) {
        return Err(wrong_option("--fps", &fps.to_string(), "a positive number of frames per second"));
    }
    let unit = |name: &str| match name {
        "m" => Some(1.0),
        "cm" => Some(0.01),
        "inch" => Some(0.0254),
        number => number.parse().ok().filter(|value| positive(*value)),
    };
    let unit_to_m = match &args.unit {
        None => None,
        Some(name) => Some(
            unit(name).ok_or_else(|| wrong_option("--unit", name, "m, cm, inch, or metres per file unit"))?,
        ),
    };
    let up = match args.up.as_deref() {
        None => None,
        Some("y" | "Y") => Some(Up::Y),
        Some("z" | "Z") => Some(Up::Z),
        Some(other) => return Err(wrong_option("--up", other, "y or z")),
    };
    Ok(ReadOptions { fps: args.fps, unit_to_m, up })
}

fn wrong_option(option: &str, value: &str, expected: &str) -> PlainError {
    plain(option, format!("\"{value}\" is not {expected}"), Some(format!("give {expected}")))
}

fn plain(file: &str, message: String, help: Option<String>) -> PlainError {
    PlainError { file: file.to_owned(), line: 0, column: 0, message, help }
}

fn facts(path: &Path, options: &ReadOptions) -> Result<ClipFacts, PlainError> {
    let file = path.display().to_string();
    if let Some(name) = file.strip_prefix("builtin:") {
        let clip = builtin::generate(name, &BTreeMap::new()).map_err(|error| {
            plain(&file, error.to_string(), Some("`cotillion clips` lists them".to_owned()))
        })?;
        let header_fps = clip.fps;
        return Ok(facts_of(
            &file,
            &ReadClip { clip, unit_to_m: 1.0, up: Up::Y, header_fps, notes: Vec::new() },
        ));
    }
    let bytes = std::fs::read(path).map_err(|error| {
        plain(&file, format!("cannot be read: {error}"), Some("name a BVH file that can be read".to_owned()))
    })?;
    let name = path.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
    let read = bvh::read(&bytes, &name, options).map_err(|error| {
        let position = error.position();
        PlainError {
            file: file.clone(),
            line: position.line,
            column: position.column,
            message: error.without_position(),
            help: Some("mend the file, or name another one".to_owned()),
        }
    })?;
    Ok(facts_of(&file, &read))
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
    let parameters = parameters(&args.parameter).map_err(fail)?;
    let generated = builtin::generate(name, &parameters).map_err(|error| {
        fail(plain(name, error.to_string(), Some("`cotillion clips` lists clips and parameters".to_owned())))
    })?;
    match &args.output {
        Some(path) => {
            output.write_file(path, to_bvh(&generated).as_bytes())?;
            output.say(&format!(
                "{}: {} frames at {} fps\n",
                path.display(),
                generated.frame_count(),
                generated.fps
            ));
        }
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
