//! Times our reader of BVH files beside the crate `bvh_anim` and a bare parse of the numbers, on the same files in one run.
//!
//! `cotillion-readers --try FILE.bvh` says what `bvh_anim` makes of a file, for `scripts/odd_files.py`.
//! `cotillion-readers FILE.bvh… [--rounds N]` prints, for each file, megabytes a second by the median of the rounds and how
//! many times faster than `bvh_anim` each is. The readers take turns, so that a busy machine slows them alike. `bvh_anim`
//! gives channels as they stand in 32 bits; ours gives quaternions in 64 bits, examined for faults.

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

use cotillion::clip::read::{Capture, ReadOptions, read};

/// A reader: bytes in, a number that depends on all it read out.
type Reader = fn(&[u8]) -> Result<f64, String>;

const READERS: [(&str, Reader); 3] = [("cotillion", ours), ("bvh_anim", bvh_anim), ("floats only", floats)];

fn main() -> ExitCode {
    let mut files: Vec<PathBuf> = Vec::new();
    let mut rounds = 15;
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        if word == "--rounds" {
            rounds = words
                .next()
                .and_then(|count| count.parse().ok())
                .filter(|count| *count > 0)
                .unwrap_or(rounds);
        } else if word == "--try" {
            return attempt(&words.next().unwrap_or_default());
        } else {
            files.push(PathBuf::from(word));
        }
    }
    if files.is_empty() {
        eprintln!("name BVH files to read");
        return ExitCode::from(2);
    }
    println!(
        "{:<40} {:>8}  {:>12} {:>12} {:>12}",
        "MB/s (times bvh_anim)", "MB", READERS[0].0, READERS[1].0, READERS[2].0
    );
    let mut failed = false;
    for file in &files {
        match row(file, rounds) {
            Ok(row) => println!("{row}"),
            Err(error) => {
                eprintln!("{}: {error}", file.display());
                failed = true;
            }
        }
    }
    if failed { ExitCode::from(2) } else { ExitCode::SUCCESS }
}

/// What `bvh_anim` makes of one file: its joints and frames, or its error. It may crash.
fn attempt(file: &str) -> ExitCode {
    let bytes = match std::fs::read(file) {
        Ok(bytes) => bytes,
        Err(error) => {
            eprintln!("{file}: {error}");
            return ExitCode::from(2);
        }
    };
    match bvh_anim::from_bytes(&bytes[..]) {
        Ok(bvh) => {
            let is_finite = bvh.frames().all(|frame| frame.as_slice().iter().all(|value| value.is_finite()));
            println!(
                "{} joints, {} frames{}",
                bvh.joints().count(),
                bvh.frames().count(),
                if is_finite { "" } else { ", NaN or infinity" }
            );
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

/// Speeds of all readers on one file.
fn row(file: &Path, rounds: usize) -> Result<String, String> {
    let bytes = std::fs::read(file).map_err(|error| error.to_string())?;
    let megabytes = bytes.len() as f64 / 1e6;
    let mut seconds: [Vec<f64>; 3] = Default::default();
    for _ in 0..rounds {
        for (index, (_, reader)) in READERS.iter().enumerate() {
            let start = Instant::now();
            std::hint::black_box(reader(&bytes)?);
            seconds[index].push(start.elapsed().as_secs_f64());
        }
    }
    let speeds = seconds.map(|mut own| {
        own.sort_unstable_by(f64::total_cmp);
        megabytes / own[own.len() / 2]
    });
    let name = file.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
    let cells: Vec<String> =
        speeds.iter().map(|speed| format!("{speed:>6.0} ({:>4.1})", speed / speeds[1])).collect();
    Ok(format!("{name:<40} {megabytes:>8.2}  {}", cells.join(" ")))
}

fn ours(bytes: &[u8]) -> Result<f64, String> {
    let read =
        read(Capture::Bvh(bytes), "timed", &ReadOptions::default()).map_err(|error| error.to_string())?;
    Ok(read.clip.rotations.iter().map(|rotation| rotation.w).sum())
}

fn bvh_anim(bytes: &[u8]) -> Result<f64, String> {
    let bvh = bvh_anim::from_bytes(bytes).map_err(|error| error.to_string())?;
    Ok(bvh.frames().map(|frame| f64::from(frame.as_slice().iter().sum::<f32>())).sum())
}

/// What the standard library needs for the numbers of the motion alone.
fn floats(bytes: &[u8]) -> Result<f64, String> {
    let text = std::str::from_utf8(bytes).map_err(|error| error.to_string())?;
    let motion = text.split("Frame Time:").nth(1).ok_or("no motion")?;
    Ok(motion.split_ascii_whitespace().filter_map(|word| word.parse::<f64>().ok()).sum())
}
