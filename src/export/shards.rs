//! A result made in shards: each is some parts of a scene after the same solve, with a report of its own; merged, they are what
//! one run makes.

use std::collections::{BTreeMap, BTreeSet};

use serde_json::{Map, Value};
use sha2::{Digest, Sha256};

use crate::export::files::hexadecimal;
use crate::export::parts::Part;
use crate::index::CharacterId;

/// One of several runs that share the work on a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    /// Which one, from 1.
    pub number: usize,
    /// Of how many.
    pub of: usize,
}

impl Shard {
    /// Those of `parts` that this shard makes, one after the other: shards differ by as little as parts allow in characters.
    pub fn of_parts<'a>(&self, parts: &'a [Part]) -> &'a [Part] {
        let all: usize = parts.iter().map(|part| part.members.len()).sum();
        let before = |index: usize| parts[..index].iter().map(|part| part.members.len()).sum::<usize>();
        // A part goes to the shard in which its first character is, of as many in a row.
        let shard_of = |index: usize| before(index) * self.of / all.max(1);
        let first = (0..parts.len()).find(|index| shard_of(*index) + 1 >= self.number).unwrap_or(parts.len());
        let last = (0..parts.len()).find(|index| shard_of(*index) + 1 > self.number).unwrap_or(parts.len());
        &parts[first..last.max(first)]
    }

    /// Name of its report.
    pub fn report_name(&self) -> String {
        format!("shard-{}-of-{}.json", self.number, self.of)
    }
}

/// Keys of a shard's report: which one, of how many, whose characters it tells of, of how many, what shapes its files, how many bytes
/// each of them has, and what digest, a digest of what all shards have in common, and a report of its characters.
const KEYS: [&str; 9] =
    ["shard", "of", "characters", "characters_in_all", "options", "bytes", "digests", "common", "report"];

/// Keys of a report that are the same in all shards and grow with the scene: only the first shard has them, the others a digest.
const COMMON: [&str; 3] = ["objects", "moments", "notes"];

/// The files of a shard.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ShardFiles {
    /// What was asked for that shapes them.
    pub options: String,
    /// Bytes of each, in the order of the report.
    pub bytes: Vec<u64>,
    /// [`crate::export::files::digest`] of each.
    pub digests: Vec<String>,
}

/// The report of a shard. `report`: of a scene, with its own characters alone, and `null` for constraints of which it knows nothing.
pub fn shard_report(
    shard: Shard,
    own: &BTreeSet<CharacterId>,
    in_all: usize,
    files: ShardFiles,
    mut report: Value,
) -> Value {
    let characters: Vec<u64> = own.iter().map(|who| who.0.into()).collect();
    let mut digest = Sha256::new();
    if let Some(report) = report.as_object_mut() {
        for key in COMMON {
            digest.update(report.get(key).map(ToString::to_string).unwrap_or_default());
            if shard.number > 1 {
                report.remove(key);
            }
        }
    }
    let common = hexadecimal(&digest.finalize());
    let values: [Value; 9] = [
        shard.number.into(),
        shard.of.into(),
        characters.into(),
        in_all.into(),
        files.options.into(),
        files.bytes.into(),
        files.digests.into(),
        common.into(),
        report,
    ];
    KEYS.into_iter().map(str::to_owned).zip(values).collect::<Map<String, Value>>().into()
}

/// A file of a shard as its report tells of it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ToldFile {
    /// Within the folder of the report.
    pub name: String,
    /// How many it has.
    pub bytes: u64,
    /// [`crate::export::files::digest`] of it.
    pub digest: String,
}

/// The files of a shard's report.
pub fn shard_files(shard: &Value) -> Vec<ToldFile> {
    let list = |value: &'_ Value| value.as_array().cloned().unwrap_or_default();
    let names = list(&shard["report"]["files"]);
    let (bytes, digests) = (list(&shard["bytes"]), list(&shard["digests"]));
    let file = |((name, bytes), digest): ((&Value, &Value), &Value)| {
        let (name, digest) = (name.as_str()?.to_owned(), digest.as_str()?.to_owned());
        Some(ToldFile { name, bytes: bytes.as_u64()?, digest })
    };
    names.iter().zip(&bytes).zip(&digests).filter_map(file).collect()
}

/// Why reports of shards cannot be merged.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum MergeError {
    /// A file is no report of a shard.
    #[error("{0} is no report of a shard")]
    NoShard(String),
    /// Two shards are not of the same run.
    #[error("{first} and {second} are not of the same scene, edit and number of shards: {key} differs")]
    #[expect(missing_docs, reason = "the message says it")]
    Different { first: String, second: String, key: String },
    /// Shards are there twice.
    #[error("shard {0} is there twice")]
    Twice(usize),
    /// Shards are not there.
    #[error("of {of} shards these are missing: {}", list(missing))]
    Missing {
        /// Which, from 1.
        missing: Vec<usize>,
        /// Of how many.
        of: usize,
    },
    /// A character is in no shard or in two.
    #[error("character {who} is in {times} shards")]
    #[expect(missing_docs, reason = "the message says it")]
    Character { who: usize, times: usize },
    /// A file is in two shards.
    #[error("file {0} is in two shards")]
    File(String),
}

fn list(numbers: &[usize]) -> String {
    numbers.iter().map(usize::to_string).collect::<Vec<_>>().join(", ")
}

/// A report of a shard that was read.
struct Read<'a> {
    name: &'a str,
    number: usize,
    of: usize,
    characters: Vec<usize>,
    in_all: usize,
    options: &'a str,
    common: &'a str,
    report: &'a Map<String, Value>,
}

/// The report of one run from those of all its shards. `reports`: with names for people.
///
/// # Errors
/// [`MergeError`] where one is missing, there twice, or of something else.
pub fn merged(reports: &[(String, Value)]) -> Result<Value, MergeError> {
    let mut shards = reports
        .iter()
        .map(|(name, value)| read(name, value).ok_or_else(|| MergeError::NoShard(name.clone())))
        .collect::<Result<Vec<_>, _>>()?;
    shards.sort_by_key(|shard| shard.number);
    complete(&shards)?;
    let first = shards.first().ok_or(MergeError::Missing { missing: vec![1], of: 1 })?;
    let mut whole = first.report.clone();
    for shard in &shards[1..] {
        if let Some(key) = differs(first, shard) {
            return Err(different(first, shard, key));
        }
        add(&mut whole, shard.report);
    }
    let mut files = BTreeSet::new();
    let twice = items(&whole, "files").filter_map(Value::as_str).find(|file| !files.insert(*file));
    if let Some(file) = twice {
        return Err(MergeError::File(file.to_owned()));
    }
    let characters = everybody(&shards, first.in_all)?;
    whole.insert("characters".to_owned(), characters.into());
    Ok(whole.into())
}

fn different(first: &Read, second: &Read, key: String) -> MergeError {
    MergeError::Different { first: first.name.to_owned(), second: second.name.to_owned(), key }
}

/// What shards tell of all characters, who must be in one each.
fn everybody(shards: &[Read], in_all: usize) -> Result<Vec<Value>, MergeError> {
    let mut told: BTreeMap<usize, Vec<&Value>> = (0..in_all).map(|who| (who, Vec::new())).collect();
    for shard in shards {
        let own = shard.characters.iter().zip(items(shard.report, "characters"));
        own.for_each(|(who, value)| told.entry(*who).or_default().push(value));
    }
    let once = |(who, told): (usize, Vec<&Value>)| match told[..] {
        [value] if who < in_all => Ok(value.clone()),
        _ => Err(MergeError::Character { who, times: told.len() }),
    };
    told.into_iter().map(once).collect()
}

fn read<'a>(name: &'a str, value: &'a Value) -> Option<Read<'a>> {
    let number = |value: &Value| usize::try_from(value.as_u64()?).ok();
    let [shard, of, characters, in_all, options, bytes, digests, common, report] =
        KEYS.map(|key| value.get(key));
    let report = report?.as_object()?;
    let files = items(report, "files").count();
    if bytes?.as_array()?.len() != files || digests?.as_array()?.len() != files {
        return None;
    }
    Some(Read {
        name,
        number: number(shard?)?,
        of: number(of?)?,
        characters: characters?.as_array()?.iter().map(number).collect::<Option<_>>()?,
        in_all: number(in_all?)?,
        options: options?.as_str()?,
        common: common?.as_str()?,
        report,
    })
}

/// Whether every shard is there, once.
fn complete(shards: &[Read]) -> Result<(), MergeError> {
    if let Some(pair) = shards.windows(2).find(|pair| pair[0].number == pair[1].number) {
        return Err(MergeError::Twice(pair[0].number));
    }
    let unlike = |pair: &&[Read]| (pair[0].of, pair[0].in_all) != (pair[1].of, pair[1].in_all);
    if let Some([first, second]) = shards.windows(2).find(unlike) {
        return Err(different(first, second, "the number of shards or characters".to_owned()));
    }
    let of = shards.first().map_or(1, |shard| shard.of);
    let missing: Vec<usize> =
        (1..=of).filter(|number| !shards.iter().any(|shard| shard.number == *number)).collect();
    if missing.is_empty() { Ok(()) } else { Err(MergeError::Missing { missing, of }) }
}

/// Keys that shards tell of by themselves.
const OWN: [&str; 4] = ["characters", "constraints", "files", "timing_ms"];

/// What two reports of one run would have in common and have not.
fn differs(first: &Read, other: &Read) -> Option<String> {
    if first.options != other.options {
        let told = |options: &str| {
            if options.trim().is_empty() { "nothing more".to_owned() } else { options.to_owned() }
        };
        return Some(format!("what was asked for ({} or {})", told(first.options), told(other.options)));
    }
    if first.common != other.common {
        return Some(COMMON.join(", "));
    }
    let (first, other) = (first.report, other.report);
    let keys = first.keys().filter(|key| !OWN.contains(&key.as_str()) && !COMMON.contains(&key.as_str()));
    let different = keys.into_iter().find(|key| first.get(*key) != other.get(*key)).cloned();
    let constraints = |report| items(report, "constraints").count();
    different.or_else(|| (constraints(first) != constraints(other)).then(|| "constraints".to_owned()))
}

/// Adds files, times and what constraints are missed by of another shard.
fn add(whole: &mut Map<String, Value>, other: &Map<String, Value>) {
    let theirs: Vec<Value> = items(other, "constraints").cloned().collect();
    if let Some(Value::Array(own)) = whole.get_mut("constraints") {
        own.iter_mut().zip(theirs).for_each(|(own, theirs)| worse(own, theirs));
    }
    let files: Vec<Value> = items(other, "files").cloned().collect();
    if let Some(Value::Array(own)) = whole.get_mut("files") {
        own.extend(files);
    }
    if let (Some(Value::Object(own)), Some(Value::Object(times))) =
        (whole.get_mut("timing_ms"), other.get("timing_ms"))
    {
        for (key, time) in times {
            let sum = own.get(key).and_then(Value::as_f64).unwrap_or(0.0) + time.as_f64().unwrap_or(0.0);
            own.insert(key.clone(), sum.into());
        }
    }
}

/// The shard that knows a constraint tells of it, the others `null`; of a carry by two, the one whose hands miss more.
fn worse(own: &mut Value, theirs: Value) {
    let missed = |value: &Value| value.get("residual").and_then(Value::as_f64).unwrap_or(f64::NEG_INFINITY);
    if missed(&theirs) > missed(own) {
        *own = theirs;
    }
}

fn items<'a>(report: &'a Map<String, Value>, key: &str) -> impl Iterator<Item = &'a Value> {
    report.get(key).and_then(Value::as_array).into_iter().flatten()
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use serde_json::json;

    use super::*;

    fn parts_of(sizes: &[usize]) -> Vec<Part> {
        let starts = sizes.iter().scan(0, |next, size| {
            *next += size;
            Some(*next - size)
        });
        let part = |(start, size): (usize, &usize)| Part {
            members: (start..start + size).map(CharacterId::from_usize).collect(),
            objects: Vec::new(),
            glb: start.to_string(),
        };
        starts.zip(sizes).map(part).collect()
    }

    proptest! {
        #[test]
        fn shards_have_all_parts_in_order_and_each_once(
            sizes in prop::collection::vec(1_usize..300, 1..30),
            of in 1_usize..40,
        ) {
            let parts = parts_of(&sizes);
            let made: Vec<Part> = (1..=of)
                .flat_map(|number| Shard { number, of }.of_parts(&parts).to_vec())
                .collect();
            prop_assert_eq!(made, parts);
        }
    }

    #[test]
    fn a_shard_has_its_share_to_one_part() {
        let parts = parts_of(&[100; 30]);
        for number in 1..=7 {
            let own = Shard { number, of: 7 }.of_parts(&parts).len();
            assert!((4..=5).contains(&own), "{own} parts of 30 in shard {number} of 7");
        }
    }

    /// A shard of a run of three characters.
    fn shard(number: usize, of: usize, characters: &[u32], missed: [Option<f64>; 2]) -> (String, Value) {
        let constraint = |missed: Option<f64>| missed.map(|missed| json!({"name": "a", "residual": missed}));
        let report = json!({
            "scene": "three",
            "characters": characters.iter().map(|who| json!({"name": who})).collect::<Vec<_>>(),
            "constraints": missed.map(constraint),
            "files": [format!("scene-{number}.glb")],
            "timing_ms": {"export": 1.5},
        });
        let own = characters.iter().map(|who| CharacterId(*who)).collect();
        let files = ShardFiles { options: String::new(), bytes: vec![1], digests: vec!["00".to_owned()] };
        (format!("shard {number}"), shard_report(Shard { number, of }, &own, 3, files, report))
    }

    #[test]
    fn merged_shards_tell_of_everybody_and_the_worst() {
        let shards = [shard(2, 2, &[1], [Some(0.2), Some(0.0)]), shard(1, 2, &[0, 2], [Some(0.1), None])];
        let whole = merged(&shards).expect("two shards of two");
        assert_eq!(whole["characters"], json!([{"name": 0}, {"name": 1}, {"name": 2}]));
        assert_eq!(whole["constraints"][0]["residual"], 0.2);
        assert_eq!(whole["constraints"][1]["residual"], 0.0);
        assert_eq!(whole["files"], json!(["scene-1.glb", "scene-2.glb"]));
        assert_eq!(whole["timing_ms"]["export"], 3.0);
    }

    #[test]
    fn shards_that_are_no_whole_are_refused() {
        let one = || shard(1, 2, &[0, 2], [None, None]);
        let refused = |shards: &[(String, Value)]| merged(shards).expect_err("no whole");
        assert_eq!(refused(&[]), MergeError::Missing { missing: vec![1], of: 1 });
        assert_eq!(refused(&[one()]), MergeError::Missing { missing: vec![2], of: 2 });
        assert_eq!(refused(&[one(), one()]), MergeError::Twice(1));
        assert_eq!(
            refused(&[one(), shard(2, 2, &[], [None, None])]),
            MergeError::Character { who: 1, times: 0 }
        );
        assert_eq!(
            refused(&[one(), shard(2, 2, &[1, 2], [None, None])]),
            MergeError::Character { who: 2, times: 2 }
        );
        let (name, mut other) = shard(2, 2, &[1], [None, None]);
        other["report"]["scene"] = "another".into();
        assert!(
            matches!(refused(&[one(), (name.clone(), other)]), MergeError::Different { key, .. } if key == "scene")
        );
        assert_eq!(refused(&[one(), (name.clone(), json!({"shard": 2}))]), MergeError::NoShard(name));
    }
}
