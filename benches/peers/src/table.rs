//! Results as a table, and as JSON.

use crate::measure::Run;
use crate::race::Row;
use std::fmt::{self, Write};

/// Results of one size.
#[derive(Clone, Debug, PartialEq)]
pub struct Size {
    /// Paths of the chain.
    pub characters: usize,
    /// Samples of all paths.
    pub samples: usize,
    /// Our own first.
    pub rows: Vec<Row>,
}

/// Widths of the columns of solvers and of sizes.
const NAME_WIDTH: usize = 40;
const CELL_WIDTH: usize = 22;

/// One table: a row for each solver, our own first, a column for each size; cold and drag times with their ratio to our
/// first, then errors.
///
/// # Errors
/// None: writing to a string does not fail.
pub fn table(sizes: &[Size]) -> Result<String, fmt::Error> {
    let mut out = String::new();
    section(&mut out, sizes, "cold, ms (times ours)", |run, ours| timed_cell(run.cold, ours.cold))?;
    section(&mut out, sizes, "drag, ms (times ours)", |run, ours| timed_cell(run.drag, ours.drag))?;
    section(&mut out, sizes, "largest error, m", |run, _| format!("{:.0e}", run.error))?;
    Ok(out)
}

/// What each library was given, and which sizes were run but once.
///
/// # Errors
/// As [`table`].
pub fn notes(sizes: &[Size]) -> Result<String, fmt::Error> {
    let mut out = String::new();
    for name in names(sizes) {
        for size in sizes {
            let Some(row) = best(size, name).filter(|row| !row.configuration.is_empty()) else { continue };
            let once = if row.repeats == 1 { " (run once)" } else { "" };
            writeln!(out, "{name:NAME_WIDTH$} {:>5}: {}{once}", size.characters, row.configuration)?;
        }
    }
    Ok(out)
}

/// Every configuration, its phases apart.
///
/// # Errors
/// As [`table`].
pub fn details(sizes: &[Size]) -> Result<String, fmt::Error> {
    let mut out = String::new();
    for size in sizes {
        let heads = ["cold", "analyse", "factor", "solve", "drag"].map(|head| format!("{head:>10}")).concat();
        writeln!(
            out,
            "{} characters, {} samples; ms\n{:90}{heads}{:>9}",
            size.characters, size.samples, "", "error"
        )?;
        for row in &size.rows {
            let name =
                [row.name.as_str(), row.configuration.as_str()].join(if row.best { " * " } else { "   " });
            match &row.run {
                Some(run) => writeln!(out, "{name:90}{}{:>9.0e}", phase_cells(run), run.error)?,
                None => writeln!(out, "{name:90}{:>10}", "failed")?,
            }
        }
        out.push('\n');
    }
    Ok(out)
}

/// All results, times in seconds.
///
/// # Errors
/// As [`table`].
pub fn json(sizes: &[Size], about: &str) -> Result<String, fmt::Error> {
    let mut out = format!("{{\"about\": {about:?}, \"sizes\": [");
    for (k, size) in sizes.iter().enumerate() {
        let comma = if k > 0 { "," } else { "" };
        let Size { characters, samples, rows } = size;
        write!(out, "{comma}\n  {{\"characters\": {characters}, \"samples\": {samples}, \"rows\": [")?;
        let rows: Vec<_> = rows.iter().map(json_row).collect();
        write!(out, "\n    {}\n  ]}}", rows.join(",\n    "))?;
    }
    out.push_str("\n]}\n");
    Ok(out)
}

fn section(
    out: &mut String,
    sizes: &[Size],
    title: &str,
    cell: impl Fn(&Run, &Run) -> String,
) -> Result<(), fmt::Error> {
    write!(out, "{title:NAME_WIDTH$}")?;
    for size in sizes {
        write!(out, "{:>CELL_WIDTH$}", format!("{} characters", size.characters))?;
    }
    out.push('\n');
    for name in names(sizes) {
        write!(out, "  {name:0$}", NAME_WIDTH - 2)?;
        for size in sizes {
            let runs = (best(size, name).and_then(|row| row.run), size.rows[0].run);
            let text =
                if let (Some(run), Some(ours)) = runs { cell(&run, &ours) } else { "failed".to_owned() };
            write!(out, "{text:>CELL_WIDTH$}")?;
        }
        out.push('\n');
    }
    out.push('\n');
    Ok(())
}

fn names(sizes: &[Size]) -> impl Iterator<Item = &str> {
    sizes.iter().take(1).flat_map(|size| &size.rows).filter(|row| row.best).map(|row| row.name.as_str())
}

fn best<'a>(size: &'a Size, name: &str) -> Option<&'a Row> {
    size.rows.iter().find(|row| row.best && row.name == name)
}

fn timed_cell(seconds: f64, ours: f64) -> String {
    format!("{} {:>9}", milliseconds(seconds), format!("({}x)", short(seconds / ours)))
}

fn phase_cells(run: &Run) -> String {
    let phases = run.phases.map_or([None; 3], |phases| phases.map(Some));
    let times = [Some(run.cold), phases[0], phases[1], phases[2], Some(run.drag)];
    times.map(|time| format!("{:>10}", time.map_or("-".to_owned(), milliseconds))).concat()
}

fn milliseconds(seconds: f64) -> String {
    short(1e3 * seconds)
}

/// Three digits, as far as they stand behind the point.
fn short(number: f64) -> String {
    let digits = if number < 1.0 {
        3
    } else if number < 10.0 {
        2
    } else {
        usize::from(number < 100.0)
    };
    format!("{number:.digits$}")
}

/// Debug form of a plain string is JSON; infinity is not, and becomes null.
fn json_row(row: &Row) -> String {
    let Row { name, configuration, best, repeats, run } = row;
    let head = format!(
        "{{\"name\": {name:?}, \"configuration\": {configuration:?}, \"best\": {best}, \"runs\": {repeats}"
    );
    let Some(run) = run else { return head + ", \"failed\": true}" };
    let phases = run.phases.map_or(String::new(), |[analyse, factor, solve]| {
        format!(", \"analyse\": {analyse:e}, \"factor\": {factor:e}, \"solve\": {solve:e}")
    });
    let error = if run.error.is_finite() { format!("{:e}", run.error) } else { "null".to_owned() };
    format!("{head}, \"cold\": {:e}{phases}, \"drag\": {:e}, \"error\": {error}}}", run.cold, run.drag)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn two_rows() -> Vec<Size> {
        let ours = Run { cold: 1e-3, phases: None, drag: 2e-4, error: 0.0 };
        let theirs = Run { cold: 3e-3, phases: Some([1e-3; 3]), drag: 1e-3, error: f64::INFINITY };
        let row = |name: &str, configuration: &str, run| Row {
            name: name.to_owned(),
            configuration: configuration.to_owned(),
            best: true,
            run: Some(run),
            repeats: 1,
        };
        let rows = vec![row("ours", "", ours), row("KLU", "real, AMD", theirs)];
        vec![Size { characters: 2, samples: 400, rows }]
    }

    #[test]
    fn table_has_ratios_to_ours() {
        let text = table(&two_rows()).expect("strings take everything");
        let line = text.lines().find(|line| line.contains("KLU")).expect("a row for each solver");
        assert!(line.ends_with("3.00   (3.00x)"), "{line}");
        assert!(text.contains("1.00   (5.00x)"), "{text}");
    }

    #[test]
    fn json_has_no_infinity() {
        let text = json(&two_rows(), "a machine").expect("strings take everything");
        assert!(text.contains("\"analyse\": 1e-3") && text.contains("\"error\": null"), "{text}");
        assert!(!text.contains("inf"), "{text}");
    }

    #[test]
    fn single_runs_are_noted() {
        let text = notes(&two_rows()).expect("strings take everything");
        assert!(text.contains("2: real, AMD (run once)") && !text.contains("ours"), "{text}");
    }
}
