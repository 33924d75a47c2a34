//! `cotillion bench`: what edits cost, by workload, back end and number of threads.

mod case;
mod chain;
mod compliance;
mod direct;
mod elsewhere;
mod measure;
mod names;
mod plot;
mod table;

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use cotillion::export::files::{OutputFile, write_all};

use super::output::{Output, PlainError};
use super::{Failure, Manner};
use case::{Case, Row, measure};
use elsewhere::{FAILED, measured_elsewhere, noted};
use names::{Backend, System, WorkloadName, name_of};
use plot::plot;
use table::table;

#[derive(Debug, Args)]
pub(super) struct BenchArgs {
    /// Workloads; left out, all.
    #[arg(long, value_name = "NAME", num_args = 1.., value_delimiter = ',', conflicts_with = "quick")]
    workload: Vec<WorkloadName>,
    /// Back ends; left out, all.
    #[arg(long, value_name = "NAME", num_args = 1.., value_delimiter = ',')]
    backend: Vec<Backend>,
    /// Systems to tell of; left out, all (on the terminal: shape and all). What is measured is the same.
    #[arg(long, value_name = "NAME", num_args = 1.., value_delimiter = ',')]
    system: Vec<System>,
    /// Numbers of threads, as in 1,2.
    #[arg(long, value_name = "N", value_delimiter = ',', default_value = "1,2", value_parser = threads)]
    threads: Vec<usize>,
    /// Repetitions of each measurement; left out, as many as fit into half a second, 5 at least.
    #[arg(long, value_name = "N", value_parser = repetitions)]
    repetitions: Option<usize>,
    /// Two small relay chains and one published scene only, five repetitions each unless a number is given.
    #[arg(long)]
    quick: bool,
    /// Leave out nothing for its size; takes minutes and gigabytes.
    #[arg(long)]
    all: bool,
    /// Folder for the measurements and their plot: bench.json, bench.svg; made if need be.
    #[arg(long, short, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Measure the one case named in this process and print its rows.
    #[arg(long, hide = true)]
    in_process: bool,
    #[command(flatten)]
    manner: Manner,
}

/// Repetitions of `--quick`.
const QUICK_REPETITIONS: usize = 5;

fn threads(text: &str) -> Result<usize, String> {
    in_range(text, 256)
}

fn repetitions(text: &str) -> Result<usize, String> {
    in_range(text, 1000)
}

fn in_range(text: &str, most: usize) -> Result<usize, String> {
    let wrong = || format!("give a whole number from 1 to {most}");
    text.trim().parse().ok().filter(|number| (1..=most).contains(number)).ok_or_else(wrong)
}

pub(super) fn bench(args: &BenchArgs) -> Result<(), Failure> {
    let output = Output::new(args.manner);
    let cases = cases(args);
    let repetitions = args.repetitions.or(args.quick.then_some(QUICK_REPETITIONS));
    if args.in_process {
        return cases.first().map_or(Ok(()), |case| here(&output, *case, args.repetitions));
    }
    let mut rows = Vec::new();
    let bar = output.progress(cases.len() as u64);
    for case in cases {
        bar.set_message(format!("{}, {}", name_of(case.workload), name_of(case.backend)));
        rows.extend(rows_of(case, repetitions, args.all));
        bar.inc(1);
    }
    bar.finish_and_clear();
    rows.retain(|row| or_all(&args.system).contains(&row.system));
    if let Some(folder) = &args.output {
        write(folder, &rows, &output)?;
    }
    output.say(&table(&rows, &shown_systems(args)));
    output.print_json(&rows);
    failures(&output, &rows)
}

fn rows_of(case: Case, repetitions: Option<usize>, all: bool) -> Vec<Row> {
    let (_, frames) = case.workload.sizes();
    let most = case.backend.most_frames();
    if frames > most && !all {
        return noted(case, &format!("skipped: {frames} frames are more than {most}; --all measures it"));
    }
    measured_elsewhere(case, repetitions)
}

/// Systems of the table: parts of an edit are told of where they are asked for.
fn shown_systems(args: &BenchArgs) -> Vec<System> {
    if args.system.is_empty() { vec![System::Shape, System::All] } else { args.system.clone() }
}

fn write(folder: &Path, rows: &[Row], output: &Output) -> Result<(), Failure> {
    let json = format!("{}\n", serde_json::to_string_pretty(rows).unwrap_or_default());
    let file = |name: &str, text: String| OutputFile { name: name.to_owned(), bytes: text.into_bytes() };
    let files = [file("bench.json", json), file("bench.svg", plot(rows))];
    write_all(folder, &files).map_err(|error| output.unwritable(&error.path, &error.source))
}

/// Tells of cases that gave no rows for another reason than their size.
fn failures(output: &Output, rows: &[Row]) -> Result<(), Failure> {
    let mut errors: Vec<PlainError> = Vec::new();
    for row in rows {
        let Some(reason) = row.note.as_ref().and_then(|note| note.strip_prefix(FAILED)) else { continue };
        let file = format!("{}, {}, threads {}", name_of(row.workload), name_of(row.backend), row.threads);
        if errors.last().is_none_or(|last| last.file != file) {
            errors.push(PlainError { file, line: 0, column: 0, message: reason.to_owned(), help: None });
        }
    }
    if errors.is_empty() {
        return Ok(());
    }
    output.errors(&errors);
    Err(Failure::CaseFailed)
}

fn cases(args: &BenchArgs) -> Vec<Case> {
    let chosen = |given: &[WorkloadName]| match (given, args.quick) {
        ([], true) => WorkloadName::QUICK.to_vec(),
        ([], false) => WorkloadName::value_variants().to_vec(),
        (given, _) => given.to_vec(),
    };
    let mut cases = Vec::new();
    for workload in chosen(&args.workload) {
        for &backend in or_all(&args.backend) {
            for &threads in &args.threads {
                let case = Case { workload, backend, threads };
                cases.extend((!cases.contains(&case)).then_some(case));
            }
        }
    }
    cases
}

fn or_all<T: ValueEnum>(given: &[T]) -> &[T] {
    if given.is_empty() { T::value_variants() } else { given }
}

/// Measures one case and prints its rows: the other end of [`measured_elsewhere`].
fn here(output: &Output, case: Case, repetitions: Option<usize>) -> Result<(), Failure> {
    match measure(case, repetitions) {
        Ok(rows) => {
            output.print(&serde_json::to_string(&rows).unwrap_or_default());
            Ok(())
        }
        Err(error) => {
            output.print_error(&error.to_string());
            Err(Failure::CaseFailed)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser;

    #[derive(Parser)]
    struct Line {
        #[command(flatten)]
        bench: BenchArgs,
    }

    #[test]
    fn quick_round_is_small_but_has_every_back_end() {
        let line = Line::try_parse_from(["bench", "--quick"]).expect("a valid line");
        let cases = cases(&line.bench);
        assert!(cases.iter().all(|case| case.workload.sizes().1 < 20_000));
        let with = |backend| cases.iter().filter(|case| case.backend == backend).count();
        assert!(
            Backend::value_variants().iter().all(|backend| with(*backend) == 2 * WorkloadName::QUICK.len())
        );
    }
}
