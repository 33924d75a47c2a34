//! `cotillion merge`: shards in, one result out.

use std::fs;
use std::path::{Path, PathBuf};

use cotillion::export::files::{OutputFile, Staging};
use cotillion::export::shards::merged;
use serde_json::Value;

use super::output::{Output, PlainError};
use super::{Failure, MergeArgs, interrupt};

/// A report of a shard: where it lies, and what it says.
type Found = (PathBuf, Value);

pub(crate) fn merge(args: &MergeArgs) -> Result<(), Failure> {
    let output = Output::new(args.manner);
    let shards = found(args).map_err(|errors| {
        output.errors(&errors);
        Failure::BadInput
    })?;
    let named: Vec<(String, Value)> =
        shards.iter().map(|(path, value)| (path.display().to_string(), value.clone())).collect();
    let report = merged(&named).map_err(|error| {
        let help = "name the folders of all shards of one run, each once";
        output.fail(plain(&args.output, error.to_string(), help))
    })?;
    let staging =
        Staging::begin(&args.output).map_err(|error| output.unwritable(&error.path, &error.source))?;
    interrupt::watch(&staging);
    let bar = output.progress_of("files");
    bar.set_length(shards.iter().map(|(_, value)| files(value).len() as u64).sum());
    for (path, value) in &shards {
        let folder = path.parent().unwrap_or(Path::new("."));
        for name in files(value) {
            staging
                .copy(&folder.join(&name), &name)
                .map_err(|error| output.unwritable(&error.path, &error.source))?;
            bar.inc(1);
        }
    }
    bar.finish_and_clear();
    let text = format!("{}\n", serde_json::to_string_pretty(&report).unwrap_or_default());
    let last = OutputFile { name: "report.json".to_owned(), bytes: text.into_bytes() };
    let written = staging.add(&last).and_then(|()| staging.commit());
    written.map_err(|error| output.unwritable(&error.path, &error.source))?;
    let count = report["files"].as_array().map_or(0, Vec::len) + 1;
    output.say(&format!("{} shards, {count} files in {}\n", shards.len(), args.output.display()));
    output.print_json(&report);
    Ok(())
}

/// Names of the files of a shard; none that lead out of its folder.
fn files(shard: &Value) -> Vec<String> {
    let names = shard["report"]["files"].as_array().into_iter().flatten().filter_map(Value::as_str);
    let is_plain = |name: &&str| Path::new(name).file_name().is_some_and(|last| last == *name);
    names.filter(is_plain).map(str::to_owned).collect()
}

fn plain(path: &Path, message: String, help: &str) -> PlainError {
    let file = path.display().to_string();
    PlainError { file, line: 0, column: 0, message, help: Some(help.to_owned()) }
}

/// All reports of shards in the folders, or what is wrong with them.
fn found(args: &MergeArgs) -> Result<Vec<Found>, Vec<PlainError>> {
    let (mut shards, mut errors) = (Vec::new(), Vec::new());
    for folder in &args.shards {
        match reports_in(folder) {
            Ok(paths) if paths.is_empty() => {
                errors.push(plain(
                    folder,
                    "no report of a shard is in it".to_owned(),
                    "make it by run --shard I/N",
                ));
            }
            Ok(paths) => {
                for path in paths {
                    match read(&path) {
                        Ok(value) => shards.push((path, value)),
                        Err(message) => errors.push(plain(&path, message, "make the shard again")),
                    }
                }
            }
            Err(error) => {
                errors.push(plain(folder, format!("cannot be read: {error}"), "name the folder of a shard"));
            }
        }
    }
    if errors.is_empty() { Ok(shards) } else { Err(errors) }
}

fn reports_in(folder: &Path) -> std::io::Result<Vec<PathBuf>> {
    let mut paths = Vec::new();
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        let name = path.file_name().and_then(|name| name.to_str()).unwrap_or_default();
        if name.starts_with("shard-") && name.ends_with(".json") {
            paths.push(path);
        }
    }
    paths.sort();
    Ok(paths)
}

fn read(path: &Path) -> Result<Value, String> {
    let text = fs::read_to_string(path).map_err(|error| format!("cannot be read: {error}"))?;
    serde_json::from_str(&text).map_err(|error| format!("is no JSON: {error}"))
}
