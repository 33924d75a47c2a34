//! What a run tells people: a few lines a character, and what does not hold.

use std::path::Path;

use cotillion::export::body_report::{FullBodyReport, ShortfallReport};
use cotillion::export::physics_report::{PhysicsReport, TouchedReport};
use cotillion::export::report::{CharacterReport, ConstraintReport, Report, RestEdited};
use cotillion::export::touch_up_report::JudgedReport;

/// Springs that give by less are not told of, in the unit of what they hold; nor are plants that drift by less, metres.
const TOLD: f64 = 0.01;
/// What must hold exactly is told of beyond this, in its unit.
const EXACT: f64 = 1e-3;

/// Where fewer contacts are held, it is told: feet that stand still give up a third where they land and roll off.
const FEW: f64 = 0.5;

/// Where there are more than 200 characters, so many of what does not hold are named, the worst first.
const NAMED: usize = 5;

/// A few lines for people. `many`: whether the scene is of more than 200 characters, however few of them a shard tells of.
pub(crate) fn summary(report: &Report, many: bool, folder: &Path) -> String {
    let files = format!("{} files in {}\n", report.files.len() + 1, folder.display());
    if many {
        return of_many(report) + &files;
    }
    let mut text = String::new();
    for character in &report.characters {
        text += &format!(
            "{:<12} path {:6.2} m → {:6.2} m   {:6.2} s of motion, {} frames from the scene's start   time steps ×{:.2}–{:.2}\n",
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
    text.extend(report.characters.iter().filter_map(touched));
    text.extend(report.constraints.iter().flat_map(missed).map(|(_, line)| line));
    for note in &report.notes {
        text += &format!("note: {note}\n");
    }
    text + &files
}

/// Counts and sums, and the worst of each kind by name.
fn of_many(report: &Report) -> String {
    let all = &report.characters;
    let sum = |metres: fn(&CharacterReport) -> f64| all.iter().map(metres).sum::<f64>();
    let frames: usize = all.iter().map(|own| own.frames_out).sum();
    let mut text = format!(
        "{} characters: paths {:.0} m → {:.0} m and {:.0} s of motion together, {frames} frames from the scene's start\n",
        all.len(),
        sum(|own| own.path_length.rest),
        sum(|own| own.path_length.edited),
        sum(|own| own.seconds),
    );
    text += &extremes(all);
    let changed = || all.iter().filter(|own| !own.discrete.is_empty());
    if changed().next().is_some() {
        let changes: usize = changed().map(|own| own.discrete.len()).sum();
        text += &format!("{} characters have {changes} discrete changes\n", changed().count());
    }
    text += &touched_many(all);
    let bodies = all.iter().filter_map(|own| Some((own, own.full_body.as_ref()?)));
    let short = bodies.flat_map(|(own, body)| {
        let lines = body_lines(own, body);
        let worst = body.shortfalls.iter().map(|short| short.metres).fold(0.0, f64::max);
        lines.lines().map(|line| (worst, format!("{line}\n"))).collect::<Vec<_>>()
    });
    text += &worst(short.collect(), "lines about bodies");
    text += &worst(report.constraints.iter().flat_map(missed).collect(), "lines about constraints");
    let notes = report.notes.iter().map(|note| (0.0, format!("note: {note}\n")));
    text + &worst(notes.collect(), "notes")
}

/// How many were touched up, and what became of their mean distances.
fn touched_many(all: &[CharacterReport]) -> String {
    let touched: Vec<&TouchedReport> = all.iter().filter_map(CharacterReport::touched).collect();
    let pairs =
        touched.iter().filter_map(|own| Some([own.done.ground.before.d?.mean, own.done.result.d?.mean]));
    let pairs: Vec<[f64; 2]> = pairs.collect();
    if pairs.is_empty() {
        return String::new();
    }
    let mean = |at: usize| 1e3 * pairs.iter().map(|pair| pair[at]).sum::<f64>() / pairs.len() as f64;
    format!(
        "{} characters touched up: zero moment points to polygons {:.1} mm → {:.1} mm in the mean\n",
        touched.len(),
        mean(0),
        mean(1)
    )
}

/// Whose path changes its length most, and whose time steps do.
fn extremes(all: &[CharacterReport]) -> String {
    let ratio = |own: &CharacterReport| own.path_length.edited / own.path_length.rest;
    let moves = |own: &&CharacterReport| own.path_length.rest > 1.0;
    let by = |a: &&CharacterReport, b: &&CharacterReport| ratio(a).total_cmp(&ratio(b));
    let mut text = String::new();
    if let (Some(least), Some(most)) =
        (all.iter().filter(moves).min_by(by), all.iter().filter(moves).max_by(by))
    {
        let [shortest, longest] = [least, most].map(|own| format!("×{:.2} ({})", ratio(own), own.name));
        text += &format!("lengths of paths {shortest} to {longest}\n");
    }
    let quickest = all.iter().min_by(|a, b| a.time_step.min.total_cmp(&b.time_step.min));
    let slowest = all.iter().max_by(|a, b| a.time_step.max.total_cmp(&b.time_step.max));
    if let (Some(quickest), Some(slowest)) = (quickest, slowest) {
        text += &format!(
            "time steps ×{:.2} ({}) to ×{:.2} ({})\n",
            quickest.time_step.min, quickest.name, slowest.time_step.max, slowest.name
        );
    }
    text
}

/// The worst of some lines, each with how bad it is, and how many more there are.
fn worst(mut lines: Vec<(f64, String)>, what: &str) -> String {
    lines.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut text: String = lines.iter().take(NAMED).map(|(_, line)| line.as_str()).collect();
    if lines.len() > NAMED {
        text += &format!("… and {} more {what}: see report.json\n", lines.len() - NAMED);
    }
    text
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

/// What the touch-up did to somebody, if it was to do something.
fn touched(character: &CharacterReport) -> Option<String> {
    let name = &character.name;
    let told = match character.physics.as_ref()? {
        PhysicsReport::NotTouched { not_touched } => {
            return Some(format!("{name} is not touched up: {not_touched}\n"));
        }
        PhysicsReport::Touched(told) => &told.done,
    };
    let mean = |judged: &JudgedReport| judged.d.map_or("–".to_owned(), |d| format!("{:.1}", d.mean * 1e3));
    let ground = &told.ground;
    let source = ground.source.as_ref().map_or("–".to_owned(), mean);
    let mut text = format!(
        "{name:<12} zero moment point to polygon {} mm → {} mm, before the edit {source} mm; {} of {} steps kept",
        mean(&ground.before),
        mean(&told.result),
        ground.kept,
        ground.steps.len(),
    );
    if let Some(change) = &told.largest_change {
        text +=
            &format!("; {} turns most, by {:.1}° at {:.2} s", change.joint, change.degrees, change.seconds);
    }
    let left = told.flights.iter().filter(|flight| flight.left).count();
    if left > 0 {
        text += &format!("; {left} flights stay as they came, since the motion would end worse at 6 Hz");
    }
    text += "\n";
    text.extend(told.doubts.iter().map(|doubt| format!("{name}: doubt: {doubt}\n")));
    Some(text)
}

/// What of a constraint does not hold on the result: by how much, a line each.
fn missed(constraint: &ConstraintReport) -> Vec<(f64, String)> {
    let hard = constraint.strength == "hard";
    let told = if hard || constraint.shortfall.is_some() { EXACT } else { TOLD };
    let how = match constraint.path_residual {
        Some(path) if hard && path < EXACT => ": its path holds, the body is pulled off it",
        _ => "",
    };
    let name = if hard { format!("{} (hard)", constraint.name) } else { constraint.name.clone() };
    let mut lines = Vec::new();
    if constraint.residual > told {
        let line = format!("{name} is off by {:.3} {}{how}\n", constraint.residual, constraint.unit);
        lines.push((constraint.residual, line));
    }
    let facing = constraint.facing_residual.filter(|off| hard && *off > EXACT && constraint.unit != "deg");
    lines.extend(facing.map(|off| (off.to_radians(), format!("{name} is turned off by {off:.3} deg\n"))));
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
