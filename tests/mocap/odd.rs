//! Odd and broken files: each gets its verdict.

use std::path::Path;

use cotillion::clip::inspect::{facts_text, inspect};
use cotillion::clip::read::{ReadClip, ReadOptions};
use libtest_mimic::Failed;

use super::facts::{Row, stated_facts};
use super::files::{ODD, SOURCE, Verdict};
use super::load;

pub(crate) fn verdict_agrees(folder: &Path, file: &str) -> Result<(), Failed> {
    let verdict = ODD.iter().find(|(name, _)| *name == file).ok_or("no verdict")?.1;
    match (load(folder, file, &ReadOptions::default()), verdict) {
        (Err(error), Verdict::Refused(says)) => refused(&error, says),
        (Err(error), _) => Err(error),
        (Ok(_), Verdict::Refused(_)) => Err("was read".into()),
        (Ok(read), verdict) => is_read(folder, file, &read, verdict),
    }
}

fn refused(error: &Failed, says: &str) -> Result<(), Failed> {
    let message = error.message().unwrap_or_default();
    let has_place = message.contains(": line ");
    if has_place && message.contains(says) { Ok(()) } else { Err(message.into()) }
}

fn is_read(folder: &Path, file: &str, read: &ReadClip, verdict: Verdict) -> Result<(), Failed> {
    let (frames, says) = match verdict {
        Verdict::Read(frames) => (frames, ""),
        Verdict::Noted(frames, says) => (frames, says),
        Verdict::LikeSource => return like_source(folder, read),
        Verdict::Refused(_) => return Err("was read".into()),
    };
    let notes: Vec<String> = read.notes.iter().map(ToString::to_string).collect();
    let mut faults = stated_facts(read, &Row::of(folder, file)?, file)?;
    if read.clip.frame_count() != frames {
        faults.push(format!("{} frames", read.clip.frame_count()));
    }
    if !says.is_empty() && !notes.iter().any(|note| note.contains(says)) {
        faults.push(format!("notes {notes:?}"));
    }
    drop(facts_text(&inspect(file, read)));
    if faults.is_empty() { Ok(()) } else { Err(faults.join("; ").into()) }
}

/// The same skeleton and motion as in the first four frames of the source.
fn like_source(folder: &Path, read: &ReadClip) -> Result<(), Failed> {
    /// Digits that exponents leave.
    const ROUNDING: f64 = 1e-6;
    let source = load(folder, SOURCE, &ReadOptions::default())?.clip;
    let clip = &read.clip;
    let joints = clip.skeleton.joints.len();
    let is_like = clip.frame_count() == 4
        && clip.skeleton.matches(&source.skeleton)
        && clip.root_positions.iter().zip(&source.root_positions).all(|(a, b)| a.distance(*b) < ROUNDING)
        && clip.rotations[..4 * joints]
            .iter()
            .zip(&source.rotations)
            .all(|(a, b)| a.dot(*b).abs() > 1.0 - ROUNDING * ROUNDING);
    if is_like { Ok(()) } else { Err("differs from its source".into()) }
}
