//! What a run tells people: a few lines a character, and what does not hold.

use std::path::Path;

use cotillion::export::body_report::{FullBodyReport, ShortfallReport};
use cotillion::export::report::{CharacterReport, ConstraintReport, Report, RestEdited};

/// Springs that give by less are not told of, in the unit of what they hold; nor are plants that drift by less, metres.
const TOLD: f64 = 0.01;
/// What must hold exactly is told of beyond this, in its unit.
const EXACT: f64 = 1e-3;

/// Where fewer contacts are held, it is told: feet that stand still give up a third where they land and roll off.
const FEW: f64 = 0.5;

/// A few lines for people.
pub(crate) fn summary(report: &Report, folder: &Path) -> String {
    let mut text = String::new();
    for character in &report.characters {
        text += &format!(
            "{:<12} path {:6.2} m → {:6.2} m   {:6.2} s in {} frames   time steps ×{:.2}–{:.2}\n",
            character.name,
            character.path_length.rest,
            character.path_length.edited,
            character.seconds,
            character.frames_out,
            character.time_step.min,
            character.time_step.max,
        );
    }
    text.extend(report.characters.iter().filter_map(changed));
    for character in &report.characters {
        if let Some(body) = &character.full_body {
            text += &body_lines(character, body);
        }
    }
    text.extend(report.constraints.iter().flat_map(missed));
    for note in &report.notes {
        text += &format!("note: {note}\n");
    }
    text + &format!("{} files in {}\n", report.files.len() + 1, folder.display())
}

/// What discrete changes did to a character's track, if there were any.
fn changed(character: &CharacterReport) -> Option<String> {
    let changes = character.changes.filter(|_| !character.discrete.is_empty())?;
    let frames = |came: bool| -> i64 {
        let of_sign = character.discrete.iter().filter(|change| (change.frames > 0) == came);
        of_sign.map(|change| change.frames).sum()
    };
    let RestEdited { rest, edited } = changes.track_frames;
    Some(format!(
        "{:<12} {} discrete changes: {:+} and {:+} working frames, {rest} → {edited}   path stretched ×{:.2}, time ×{:.2}\n",
        character.name,
        character.discrete.len(),
        frames(true),
        frames(false),
        changes.stretch.length,
        changes.stretch.time,
    ))
}

/// What of a constraint does not hold on the result, a line each.
fn missed(constraint: &ConstraintReport) -> Vec<String> {
    let hard = constraint.strength == "hard";
    let told = if hard || constraint.shortfall.is_some() { EXACT } else { TOLD };
    let how = match constraint.path_residual {
        Some(path) if hard && path < EXACT => ": its path holds, the body is pulled off it",
        _ => "",
    };
    let name = if hard { format!("{} (hard)", constraint.name) } else { constraint.name.clone() };
    let mut lines = Vec::new();
    if constraint.residual > told {
        lines.push(format!("{name} is off by {:.3} {}{how}\n", constraint.residual, constraint.unit));
    }
    let facing = constraint.facing_residual.filter(|off| hard && *off > EXACT && constraint.unit != "deg");
    lines.extend(facing.map(|off| format!("{name} is turned off by {off:.3} deg\n")));
    lines
}

/// Joints out of reach, each with its worst moment, and plants that do not hold.
fn body_lines(character: &CharacterReport, body: &FullBodyReport) -> String {
    let mut worst: Vec<(&ShortfallReport, usize)> = Vec::new();
    for shortfall in &body.shortfalls {
        match worst.iter_mut().find(|(known, _)| known.joint == shortfall.joint) {
            Some((known, times)) => {
                *times += 1;
                if shortfall.metres > known.metres {
                    *known = shortfall;
                }
            }
            None => worst.push((shortfall, 1)),
        }
    }
    let mut text = String::new();
    for (ShortfallReport { joint, time, metres }, times) in worst {
        let more = if times > 1 { format!(", the most of {times} times") } else { String::new() };
        text += &format!(
            "{}: {joint} is {metres:.3} m short of its place at {time:.2} s{more}\n",
            character.name
        );
    }
    let slid = body.largest_drift.as_ref().filter(|drift| drift.result > drift.captured + TOLD);
    if let (Some(drift), Some(held)) = (slid, body.contacts_held) {
        text += &format!(
            "{}: {:.0} % of contacts hold; {} drifts by {:.3} m from {:.2} s to {:.2} s, {:.3} m as captured\n",
            character.name,
            100.0 * held,
            drift.point,
            drift.result,
            drift.from,
            drift.to,
            drift.captured,
        );
    } else if let Some(held) = body.contacts_held.filter(|held| *held < FEW) {
        text += &format!(
            "{}: {:.0} % of contacts are held; what is not slides or rolls as captured\n",
            character.name,
            100.0 * held,
        );
    }
    text
}
