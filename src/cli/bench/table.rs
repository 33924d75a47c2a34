//! Measurements as a table for people.

use std::fmt::Write as _;

use super::case::{PhaseTimes, Row};
use super::names::{Backend, Mode, System, WorkloadName, name_of};

/// One block for each workload, in it one line for each system, back end and number of threads.
pub(super) fn table(rows: &[Row], systems: &[System]) -> String {
    let mut text = String::new();
    let mut workloads: Vec<WorkloadName> = rows.iter().map(|row| row.workload).collect();
    workloads.dedup();
    for workload in workloads {
        let own: Vec<&Row> = rows.iter().filter(|row| row.workload == workload).collect();
        text += &heading(workload, own[0]);
        if own.iter().any(|row| row.ms.is_some()) {
            text += &HEADER.concat();
        }
        for system in systems {
            text += &block(&own, *system);
        }
        text += &left_out(&own);
        text.push('\n');
    }
    text + &notes(rows)
}

const HEADER: [&str; 2] = [
    "                         cold, ms                                                 drag, ms\n",
    "system  back end       t assemble analyse  factor   solve  expand    total  speed    solve  expand    total  speed    error     MB\n",
];

fn heading(workload: WorkloadName, row: &Row) -> String {
    let paper = workload.published().map_or(String::new(), |scene| {
        format!(
            "; the paper, 2009: {} ms for a full edit, {} ms for a discrete evaluation",
            scene.laplacian_ms, scene.discrete_ms
        )
    });
    let (name, frames) = (name_of(workload), grouped(row.frames));
    format!("{name}: {} characters, {frames} frames{paper}\n", grouped(row.characters))
}

fn block(rows: &[&Row], system: System) -> String {
    let of = |mode: Mode| rows.iter().copied().filter(move |row| (row.system, row.mode) == (system, mode));
    let mut label = name_of(system);
    let mut text = String::new();
    for (cold, drag) in of(Mode::Cold).zip(of(Mode::Drag)) {
        if let (Some(whole), Some(step)) = (cold.phases_ms, drag.phases_ms) {
            let _ = write!(text, "{label:<7} {:<14} {:>1} ", name_of(cold.backend), cold.threads);
            text += &numbers(rows, (cold, whole), (drag, step));
            text.push('\n');
            label.clear();
        }
    }
    text
}

/// Who was not measured, and why.
fn left_out(rows: &[&Row]) -> String {
    let mut lines: Vec<String> = Vec::new();
    for row in rows {
        let Some(note) = &row.note else { continue };
        let line = format!("        {:<14} {note}\n", name_of(row.backend));
        if !lines.contains(&line) {
            lines.push(line);
        }
    }
    lines.concat()
}

fn numbers(rows: &[&Row], (cold, whole): (&Row, PhaseTimes), (drag, step): (&Row, PhaseTimes)) -> String {
    let PhaseTimes { assemble, analyse, factor, solve, expand } = whole;
    let mut text = format!("{:>8}", milliseconds(assemble));
    for phase in [analyse, factor, solve, expand] {
        let _ = write!(text, " {:>7}", milliseconds(phase));
    }
    let _ = write!(text, " {:>8} {:>6}", milliseconds(cold.ms), speed(rows, cold));
    let _ = write!(text, "  {:>7} {:>7}", milliseconds(step.solve), milliseconds(step.expand));
    let _ = write!(text, " {:>8} {:>6}", milliseconds(drag.ms), speed(rows, drag));
    let error =
        cold.max_error.zip(drag.max_error).map_or("–".to_owned(), |(a, b)| format!("{:.0e}", a.max(b)));
    let memory = cold.peak_mb.map_or("–".to_owned(), |megabytes| format!("{megabytes:.0}"));
    text + &format!(" {error:>8} {memory:>6}")
}

/// How many times as fast as the yardstick with as many threads.
fn speed(rows: &[&Row], row: &Row) -> String {
    let kind = |row: &Row| (row.system, row.mode, row.threads);
    let yardstick = rows.iter().find(|other| other.backend == Backend::YARDSTICK && kind(other) == kind(row));
    match yardstick.and_then(|yardstick| yardstick.ms).zip(row.ms) {
        Some((theirs, own)) if own > 0.0 => format!("×{}", three_digits(theirs / own, 1)),
        _ => "–".to_owned(),
    }
}

fn milliseconds(time: Option<f64>) -> String {
    time.map_or("–".to_owned(), |ms| three_digits(ms, 4))
}

/// Three digits that count, but no more than `most` decimals.
fn three_digits(value: f64, most: usize) -> String {
    let decimals = [100.0, 10.0, 1.0, 0.1].iter().position(|limit| value >= *limit).unwrap_or(4);
    format!("{value:.*}", decimals.min(most))
}

/// A number with its thousands apart.
fn grouped(number: usize) -> String {
    let digits = number.to_string();
    let mut out = String::new();
    for (k, digit) in digits.chars().enumerate() {
        if k > 0 && (digits.len() - k).is_multiple_of(3) {
            out.push(' ');
        }
        out.push(digit);
    }
    out
}

fn notes(rows: &[Row]) -> String {
    let mut text = format!(
        "cold: from rest paths and rows to edited paths; drag: from new targets, all else reused. Medians. t: threads.\n\
         speed: against {} with as many threads. error: largest distance of a point to the reference, m (time: s; all: the\n\
         larger number). MB: most memory the process of the case ever held, with all three systems and both modes.\n",
        name_of(Backend::YARDSTICK)
    );
    if rows.iter().any(|row| row.workload.published().is_some()) {
        text += "The paper's times are of other hardware and of its own motions; the counts of frames and rows are the same.\n";
    }
    if cfg!(debug_assertions) {
        text += "This is a debug build: its times mean nothing. Build with --release.\n";
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_three_digits() {
        let shown = [1157.2, 123.4, 12.34, 1.234, 0.1234, 0.01234, 0.0004].map(|ms| three_digits(ms, 4));
        assert_eq!(shown, ["1157", "123", "12.3", "1.23", "0.123", "0.0123", "0.0004"]);
    }
}
