//! Files that are spoilt at random end in a clip of finite numbers or in an error: no panic, no memory beyond what files pay for.
//!
//! 10 000 seeded mutations of small files in each format. Where captures are found (`$COTILLION_MOCAP`, else `../shared/mocap`
//! beside the checkout) the small ones among them are spoilt too.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};

use allocation_counter::measure;
use cotillion::clip::Clip;
use cotillion::clip::read::{Capture, ReadClip, ReadOptions, Up, read};
use cotillion::index::SourceFrame;

/// Mutations of each format.
const MUTATIONS: u64 = 10_000;

/// Larger captures are left alone: many small reads find more than few large ones.
const LARGEST: usize = 16_384;

/// Memory of one read at its peak, bytes, and what every byte of the file may add.
const MEMORY: u64 = 64 << 20;
const MEMORY_PER_BYTE: u64 = 8;

/// Rotations are products of a few unit quaternions.
const UNIT_ROUNDING: f64 = 1e-9;

const BVH: &str = include_str!("../fuzz/seeds/bvh/small.bvh");

const ASF: &str = include_str!("../fuzz/seeds/asf/small.asf");

const AMC: &str = include_str!("../fuzz/seeds/amc/small.amc");

const DEEPMIMIC: &str = include_str!("../fuzz/seeds/deepmimic/small.json");

/// Words that readers may trip over.
const EXTREME: [&[u8]; 26] = [
    b"1e999",
    b"nan",
    b"-1",
    b"4294967296",
    b"inf",
    b"-inf",
    b"1e308",
    b"-1e308",
    b"1e-320",
    b"99999999999",
    b"0",
    b"-0",
    b"4294967295",
    b"1e9",
    b"begin",
    b"end",
    b"{",
    b"}",
    b"[",
    b"]",
    b"(",
    b"\"",
    b":",
    b"#",
    b"\0",
    b"\xff\xfe",
];

/// Length of a word longer than any.
const LONG: usize = 10_000;

/// SplitMix64. Source: Steele, Lea, Flood, *Fast Splittable Pseudorandom Number Generators*, OOPSLA 2014.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mixed = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        mixed ^ (mixed >> 31)
    }

    /// Below `limit`; 0 where that is 0.
    fn below(&mut self, limit: usize) -> usize {
        let limit = u64::try_from(limit).expect("64 bits hold any size").max(1);
        usize::try_from(self.next() % limit).expect("smaller than a size")
    }

    fn byte(&mut self) -> u8 {
        self.next().to_le_bytes()[0]
    }
}

/// `text` with one to four things changed, mostly one or two: of many changes the first hides the others.
fn mutated(text: &[u8], seed: u64) -> Vec<u8> {
    let mut random = Random(seed);
    let mut text = text.to_vec();
    let most = 1 + random.below(4);
    for _ in 0..=random.below(most) {
        match random.below(3) {
            0 => change_bytes(&mut text, &mut random),
            1 => change_words(&mut text, &mut random),
            _ => change_number(&mut text, &mut random),
        }
    }
    text
}

fn change_bytes(text: &mut Vec<u8>, random: &mut Random) {
    let at = random.below(text.len());
    let end = (at + 1 + random.below(40)).min(text.len());
    match random.below(9) {
        0 | 1 if !text.is_empty() => text[at] ^= 1 << random.below(8),
        2 | 3 => text.insert(at, random.byte()),
        4 | 5 if !text.is_empty() => drop(text.remove(at)),
        6 | 7 => drop(text.drain(at..end)),
        _ => text.truncate(at),
    }
}

/// Puts another digit, a sign, a point or an exponent into a number: what comes out is mostly one as well.
fn change_number(text: &mut Vec<u8>, random: &mut Random) {
    let digits: Vec<usize> = (0..text.len()).filter(|&at| text[at].is_ascii_digit()).collect();
    if digits.is_empty() {
        return;
    }
    let at = digits[random.below(digits.len())];
    let put: &[u8] = match random.below(6) {
        0 => b"-",
        1 => b".",
        2 => b"1e8",
        3 => b"0",
        _ => &[b'0' + random.byte() % 10],
    };
    text.splice(at..at + 1, put.iter().copied());
}

/// Where words and marks are.
fn words(text: &[u8]) -> Vec<std::ops::Range<usize>> {
    let is_mark = |byte: u8| b"()[]{},:\"".contains(&byte);
    let mut words: Vec<std::ops::Range<usize>> = Vec::new();
    let mut goes_on = false;
    for (at, &byte) in text.iter().enumerate() {
        let is_letter = !byte.is_ascii_whitespace() && !is_mark(byte);
        match words.last_mut() {
            Some(word) if goes_on && is_letter => word.end = at + 1,
            _ if !byte.is_ascii_whitespace() => words.push(at..at + 1),
            _ => {}
        }
        goes_on = is_letter;
    }
    words
}

fn change_words(text: &mut Vec<u8>, random: &mut Random) {
    let words = words(text);
    if words.is_empty() {
        return;
    }
    let one = words[random.below(words.len())].clone();
    let other = text[words[random.below(words.len())].clone()].to_vec();
    let put = match random.below(5) {
        0 => other,
        1 => [&text[one.clone()], b" ", &other].concat(),
        2 => Vec::new(),
        3 if random.below(20) == 0 => vec![b"9x ("[random.below(4)]; LONG],
        _ => EXTREME[random.below(EXTREME.len())].to_vec(),
    };
    text.splice(one, put);
}

/// What is spoilt.
#[derive(Clone, Copy)]
enum Format {
    Bvh,
    Asf,
    Amc,
    DeepMimic,
}

/// A text to spoil, and the file it is read with, which stays sound.
struct Case {
    format: Format,
    name: String,
    text: Vec<u8>,
    partner: Vec<u8>,
}

impl Case {
    fn small(format: Format, text: &str, partner: &str) -> Self {
        Self { format, name: "small".to_owned(), text: text.into(), partner: partner.into() }
    }

    fn read(&self, text: &[u8], options: &ReadOptions) -> Option<ReadClip> {
        let capture = match self.format {
            Format::Bvh => Capture::Bvh(text),
            Format::Asf => Capture::Acclaim { skeleton: text, motion: &self.partner },
            Format::Amc => Capture::Acclaim { skeleton: &self.partner, motion: text },
            Format::DeepMimic => Capture::DeepMimic(text),
        };
        read(capture, "mutated", options).ok()
    }
}

/// Spoils every text in turn until all mutations are done.
fn survive(cases: &[Case]) {
    for case in cases {
        assert!(case.read(&case.text, &ReadOptions::default()).is_some(), "{} is sound", case.name);
    }
    // Readers may share the work out; only what this thread allocates is counted.
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
    let read = pool.install(|| {
        let case = |seed: u64| &cases[usize::try_from(seed).expect("few mutations") % cases.len()];
        (0..MUTATIONS).filter(|&seed| survive_one(case(seed), seed)).count()
    });
    let least = usize::try_from(MUTATIONS / 20).expect("few mutations");
    assert!(read > least, "hardly anything is read: {read}");
}

/// Whether a clip came out.
fn survive_one(case: &Case, seed: u64) -> bool {
    let text = mutated(&case.text, seed);
    let options = options(seed);
    let mut result = Ok(None);
    let memory = measure(|| result = catch_unwind(AssertUnwindSafe(|| case.read(&text, &options))));
    let what = format!("{}, seed {seed}", case.name);
    let Ok(clip) = result else {
        panic!("{what}: panics");
    };
    if let Some(read) = &clip {
        let is_sound = read.unit_to_m.is_finite() && read.header_fps.is_finite() && is_finite(&read.clip);
        assert!(is_sound, "{what}: numbers that are none");
    }
    let limit = MEMORY + MEMORY_PER_BYTE * u64::try_from(text.len()).expect("64 bits hold any size");
    assert!(memory.bytes_max <= limit, "{what}: {} bytes", memory.bytes_max);
    clip.is_some()
}

fn options(seed: u64) -> ReadOptions {
    match seed / 7 % 8 {
        0..3 => ReadOptions::default(),
        3..5 => ReadOptions { repair: true, ..ReadOptions::default() },
        _ => ReadOptions {
            fps: Some(60.0),
            unit_to_m: Some(0.01),
            up: Some(Up::Z),
            repair: true,
            ..ReadOptions::default()
        },
    }
}

/// Whether all numbers of the clip are finite, rotations are of length 1, and lists are as long as they should be.
fn is_finite(clip: &Clip) -> bool {
    let joints = &clip.skeleton.joints;
    let counts = clip.frame_count() > 0
        && clip.rotations.len() == clip.frame_count() * joints.len()
        && clip.usable.0 <= clip.usable.1
        && clip.usable.1.as_usize() < clip.frame_count();
    let ends = joints.iter().flat_map(|joint| [Some(joint.offset), joint.end_site]).flatten();
    let moving = clip.moving_offsets.iter().flat_map(|moving| moving.offsets.iter().copied());
    let places = clip.root_positions.iter().copied().chain(ends).chain(moving);
    let posed = clip.skeleton.forward_kinematics(&clip.pose(SourceFrame(0)));
    counts
        && clip.fps.is_finite()
        && clip.fps > 0.0
        && places.into_iter().all(|place| place.is_finite())
        && clip.rotations.iter().all(|turn| (turn.length() - 1.0).abs() < UNIT_ROUNDING)
        && posed.iter().all(|joint| joint.position.is_finite() && joint.rotation.is_finite())
}

fn mocap_folder() -> Option<PathBuf> {
    let beside = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/mocap");
    let set = std::env::var_os("COTILLION_MOCAP").map(PathBuf::from);
    [set, Some(beside)].into_iter().flatten().find(|folder| folder.is_dir())
}

/// Files of `folder` of the captures that are small enough and end in `ending`, sorted by name.
fn captures(folder: &str, ending: &str) -> Vec<(String, Vec<u8>)> {
    let Some(root) = mocap_folder() else {
        return Vec::new();
    };
    let entries = std::fs::read_dir(root.join(folder)).expect("the captures can be listed");
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.expect("an entry").path()).collect();
    paths.retain(|path| path.to_string_lossy().ends_with(ending));
    paths.sort();
    let read =
        |path: PathBuf| (path.display().to_string(), std::fs::read(&path).expect("a readable capture"));
    paths.into_iter().map(read).filter(|(_, text)| text.len() <= LARGEST).collect()
}

/// The first three frames of a capture of CMU's.
fn start_of_capture() -> Option<Vec<u8>> {
    let text = std::fs::read_to_string(mocap_folder()?.join("odd/cmu_09_10_glitch.amc"))
        .expect("a readable capture");
    let end = text.find("\n4\n").or_else(|| text.find("\n4\r\n")).expect("a fourth frame");
    Some(text.as_bytes()[..=end].to_vec())
}

#[test]
fn bvh_files_survive_mutation() {
    let odd = captures("odd", ".bvh").into_iter().map(|(name, text)| Case {
        format: Format::Bvh,
        name,
        text,
        partner: Vec::new(),
    });
    let is_sound = |case: &Case| case.read(&case.text, &ReadOptions::default()).is_some();
    let small = Case::small(Format::Bvh, BVH, "");
    survive(&std::iter::once(small).chain(odd.filter(is_sound)).collect::<Vec<_>>());
}

#[test]
fn asf_files_survive_mutation() {
    let mut cases = vec![Case::small(Format::Asf, ASF, AMC)];
    if let Some(partner) = start_of_capture() {
        let captures = captures("amc", ".asf").into_iter();
        cases.extend(captures.map(|(name, text)| Case {
            format: Format::Asf,
            name,
            text,
            partner: partner.clone(),
        }));
    }
    survive(&cases);
}

#[test]
fn amc_files_survive_mutation() {
    let mut cases = vec![Case::small(Format::Amc, AMC, ASF)];
    if let Some(text) = start_of_capture() {
        let captures = captures("amc", "cmu_09.asf").into_iter();
        cases.extend(captures.map(|(name, partner)| Case {
            format: Format::Amc,
            name,
            text: text.clone(),
            partner,
        }));
    }
    survive(&cases);
}

#[test]
fn deepmimic_files_survive_mutation() {
    let captures = captures("deepmimic", ".txt").into_iter();
    let captures =
        captures.map(|(name, text)| Case { format: Format::DeepMimic, name, text, partner: Vec::new() });
    let small = Case::small(Format::DeepMimic, DEEPMIMIC, "");
    survive(&std::iter::once(small).chain(captures).collect::<Vec<_>>());
}
