//! `cotillion merge`: shards in, one result out.

use std::fs;
use std::path::{Path, PathBuf};

use cotillion::export::files::{OutputFile, Staging, digest};
use cotillion::export::shards::{ToldFile, merged, shard_files};
use serde_json::Value;

use super::output::{Output, PlainError};
use super::{Failure, MergeArgs, interrupt};

/// Reports of shards: where each lies, and what it says.
type Found = (Vec<PathBuf>, Vec<(String, Value)>);

pub(crate) fn merge(args: &MergeArgs) -> Result<(), Failure> {
    let output = Output::new(args.manner);
    let refused = |errors: Vec<PlainError>| {
        output.errors(&errors);
        Failure::BadInput
    };
    let (paths, reports) = found(args).map_err(refused)?;
    let report = merged(&reports).map_err(|error| {
        let help = "name the folders of all shards of one run with the same options, each once";
        output.fail(plain(&args.output, error.to_string(), help))
    })?;
    let files: Vec<(PathBuf, String)> = paths
        .iter()
        .zip(reports)
        .flat_map(|(path, (_, value))| files(path, &value))
        .collect::<Result<_, _>>()
        .map_err(|error| output.fail(error))?;
    let staging =
        Staging::begin(&args.output).map_err(|error| output.unwritable(&error.path, &error.source))?;
    interrupt::watch(&staging);
    let bar = output.progress_of("files");
    bar.set_length(files.len() as u64);
    for (path, name) in &files {
        staging.copy(path, name).map_err(|error| output.unwritable(&error.path, &error.source))?;
        bar.inc(1);
    }
    bar.finish_and_clear();
    let text = format!("{}\n", serde_json::to_string_pretty(&report).unwrap_or_default());
    let last = OutputFile { name: "report.json".to_owned(), bytes: text.into_bytes() };
    let written = staging.add(&last).and_then(|()| staging.commit());
    written.map_err(|error| output.unwritable(&error.path, &error.source))?;
    let count = report["files"].as_array().map_or(0, Vec::len) + 1;
    output.say(&format!("{} shards, {count} files in {}\n", paths.len(), args.output.display()));
    output.print_json(&report);
    Ok(())
}

/// The files of the shard whose report is at `path`, as long as they are there byte for byte as it says; none that lead out of its
/// folder. Cost: one pass over them.
fn files(path: &Path, shard: &Value) -> Vec<Result<(PathBuf, String), PlainError>> {
    let folder = path.parent().unwrap_or(Path::new("."));
    let is_plain = |name: &str| Path::new(name).file_name().is_some_and(|last| last == name);
    let sound = |told: ToldFile| {
        let file = folder.join(&told.name);
        match fault(&file, &told) {
            None => Ok((file, told.name)),
            Some(fault) => Err(plain(path, format!("{} {fault}", told.name), "make this shard again")),
        }
    };
    shard_files(shard).into_iter().filter(|told| is_plain(&told.name)).map(sound).collect()
}

/// What is wrong with a file, if anything is.
fn fault(file: &Path, told: &ToldFile) -> Option<String> {
    let bytes = match fs::metadata(file) {
        Err(error) => return Some(format!("cannot be read: {error}")),
        Ok(facts) => facts.len(),
    };
    if bytes != told.bytes {
        return Some(format!("has {bytes} bytes in place of {}", told.bytes));
    }
    match digest(file) {
        Err(error) => Some(format!("cannot be read: {error}")),
        Ok(found) if found != told.digest => {
            Some("was changed: it has other bytes than were written".to_owned())
        }
        Ok(_) => None,
    }
}

fn plain(path: &Path, message: String, help: &str) -> PlainError {
    let file = path.display().to_string();
    PlainError { file, line: 0, column: 0, message, help: Some(help.to_owned()) }
}

/// All reports of shards in the folders, or what is wrong with them.
fn found(args: &MergeArgs) -> Result<Found, Vec<PlainError>> {
    let (mut places, mut shards, mut errors) = (Vec::new(), Vec::new(), Vec::new());
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
                        Ok(value) => {
                            shards.push((path.display().to_string(), value));
                            places.push(path);
                        }
                        Err(message) => errors.push(plain(&path, message, "make the shard again")),
                    }
                }
            }
            Err(error) => {
                errors.push(plain(folder, format!("cannot be read: {error}"), "name the folder of a shard"));
            }
        }
    }
    if errors.is_empty() { Ok((places, shards)) } else { Err(errors) }
}

/// Reports in a folder; where there are none, in the folders in it.
fn reports_in(folder: &Path) -> std::io::Result<Vec<PathBuf>> {
    let mut paths = reports_directly_in(folder)?;
    if paths.is_empty() {
        let inner: Vec<PathBuf> =
            fs::read_dir(folder)?.flatten().map(|entry| entry.path()).filter(|path| path.is_dir()).collect();
        for folder in inner {
            paths.extend(reports_directly_in(&folder)?);
        }
    }
    paths.sort();
    Ok(paths)
}

fn reports_directly_in(folder: &Path) -> std::io::Result<Vec<PathBuf>> {
    let mut paths = Vec::new();
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        let name = path.file_name().and_then(|name| name.to_str()).unwrap_or_default();
        if name.starts_with("shard-") && name.ends_with(".json") {
            paths.push(path);
        }
    }
    Ok(paths)
}

fn read(path: &Path) -> Result<Value, String> {
    let text = fs::read_to_string(path).map_err(|error| format!("cannot be read: {error}"))?;
    serde_json::from_str(&text).map_err(|error| format!("is no JSON: {error}"))
}
