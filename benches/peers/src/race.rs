//! All solvers on one size: each configuration is tried, the best of each library on each system is measured.

use crate::configuration::{Configuration, configurations};
use crate::measure::{Case, LIBRARIES, Posed, Run, Statistic, run_ours, run_peer, summary};
use crate::ours::{ROUTES, Route};
use crate::peer::Library;
use crate::system::{FORMS, Form, NUMBERS, Numbers};
use std::time::Instant;

/// Runs that are shorter, seconds, are tried three times.
const SHORT: f64 = 0.1;

/// Errors that are as good as none, metres.
const NEGLIGIBLE: f64 = 1e-3;

/// Configurations that are less accurate than the best of their field by more than this are not preferred for speed.
const COMPARABLE: f64 = 100.0;

/// Configurations of each field that are measured, so that the noise of a single trial does not decide.
const FINALISTS: usize = 2;

/// How much is measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Effort {
    /// Rounds, each of which runs every solver once.
    pub repeats: usize,
    /// Seconds for trying the configurations of one library on one form and size; one is always tried. What takes longer
    /// by itself is not repeated.
    pub budget: f64,
    /// Measure all configurations that were tried, not the best alone.
    pub all: bool,
    /// What stands for several runs.
    pub statistic: Statistic,
}

/// Configurations of one library on one form in one kind of numbers, the best at the last size first.
#[derive(Clone, Debug, PartialEq)]
pub struct Field(Vec<Configuration>);

impl Field {
    /// Whose configurations they are.
    pub fn library(&self) -> Option<Library> {
        self.0.first().map(|configuration| configuration.library)
    }
}

/// Measured results of one solver on one size.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// Solver, numbers and form.
    pub name: String,
    /// Its configuration; empty for our own.
    pub configuration: String,
    /// The best of its name: see [`best_first`].
    pub best: bool,
    /// Medians, or least times; `None` if it failed.
    pub run: Option<Run>,
    /// Runs that they are of.
    pub repeats: usize,
}

/// A solver in the race, and its runs so far.
struct Entrant {
    kind: Kind,
    runs: Vec<Run>,
    repeated: bool,
}

enum Kind {
    Ours(Route),
    Peer(Configuration),
}

/// Everything that is tried of every library.
pub fn all_fields() -> Vec<Field> {
    let of_form =
        |library: Library, form: Form| NUMBERS.map(|numbers| Field(configurations(library, form, numbers)));
    let of_library = |library: &Library| FORMS.map(|form| of_form(*library, form));
    LIBRARIES.iter().flat_map(of_library).flatten().collect()
}

/// Indices of runs, the best first: by cold times drag, of those that are accurate to a millimetre, or to a hundred times
/// the error of the most accurate; then the other ones, then those that failed.
pub fn best_first(runs: &[Option<Run>]) -> Vec<usize> {
    let least = runs.iter().flatten().map(|run| run.error).fold(f64::INFINITY, f64::min);
    let limit = NEGLIGIBLE.max(COMPARABLE * least);
    let key = |k: usize| {
        runs[k].map_or((2, f64::INFINITY), |run| (u8::from(run.error > limit), run.cold * run.drag))
    };
    let mut order: Vec<_> = (0..runs.len()).collect();
    order.sort_by(|&a, &b| key(a).0.cmp(&key(b).0).then(key(a).1.total_cmp(&key(b).1)));
    order
}

/// Tries, then measures in rounds, so that a slow minute of the machine meets all alike. Our own come first.
pub fn race(case: &Case, fields: &mut [Field], effort: Effort) -> Vec<Row> {
    let mut entrants: Vec<_> = ROUTES.iter().map(|route| entrant(Kind::Ours(*route), None, effort)).collect();
    entrants.iter_mut().for_each(|ours| _ = ours.run(case)); // warm-up
    for field in fields {
        let kept = if effort.all { usize::MAX } else { FINALISTS };
        let tried = trials(&case.posed, field, effort.budget);
        let kept = tried.into_iter().take(kept);
        entrants.extend(kept.map(|(peer, run)| entrant(Kind::Peer(peer), run, effort)));
    }
    for _ in 0..effort.repeats {
        for entrant in entrants.iter_mut().filter(|entrant| entrant.repeated) {
            entrant.runs.extend(entrant.run(case));
        }
    }
    let mut rows: Vec<_> = entrants.iter().map(|entrant| entrant.row(effort.statistic)).collect();
    mark_best(&mut rows);
    rows
}

impl Entrant {
    fn run(&self, case: &Case) -> Option<Run> {
        match &self.kind {
            Kind::Ours(route) => run_ours(case, *route).ok(),
            Kind::Peer(configuration) => run_peer(&case.posed, configuration).ok(),
        }
    }

    fn row(&self, statistic: Statistic) -> Row {
        let (name, configuration) = match &self.kind {
            Kind::Ours(route) => (route.name().to_owned(), String::new()),
            Kind::Peer(c) => (
                format!("{}, {} {}", c.library.name(), numbers_name(c.numbers), form_name(c.form)),
                c.label.clone(),
            ),
        };
        let run = (!self.runs.is_empty()).then(|| summary(&self.runs, statistic));
        Row { name, configuration, best: false, run, repeats: self.runs.len() }
    }
}

/// An entrant. One that was too slow when tried keeps that run and is not run again; one that failed neither.
fn entrant(kind: Kind, tried: Option<Run>, effort: Effort) -> Entrant {
    let slow = tried.filter(|run| run.cold > effort.budget);
    let repeated = match kind {
        Kind::Ours(_) => true,
        Kind::Peer(_) => tried.is_some() && slow.is_none(),
    };
    Entrant { kind, runs: slow.into_iter().collect(), repeated }
}

/// Tries configurations of a field in turn until `budget` seconds are up, and sorts the field. Returns those tried, the best first.
pub fn trials(posed: &Posed, field: &mut Field, budget: f64) -> Vec<(Configuration, Option<Run>)> {
    let start = Instant::now();
    let mut tried = Vec::new();
    let mut rest = field.0.drain(..);
    for configuration in rest.by_ref() {
        let run = trial(posed, &configuration);
        tried.push((configuration, run));
        if start.elapsed().as_secs_f64() > budget {
            break;
        }
    }
    let untried: Vec<_> = rest.collect();
    let runs: Vec<_> = tried.iter().map(|(_, run)| *run).collect();
    let tried: Vec<_> = best_first(&runs).into_iter().map(|k| tried[k].clone()).collect();
    field.0 = tried.iter().map(|(configuration, _)| configuration.clone()).chain(untried).collect();
    tried
}

/// The quickest of three short runs, or of one that is not short.
fn trial(posed: &Posed, configuration: &Configuration) -> Option<Run> {
    let first = run_peer(posed, configuration).ok()?;
    let count = if first.cold < SHORT { 2 } else { 0 };
    let more = (0..count).filter_map(|_| run_peer(posed, configuration).ok());
    more.chain([first]).min_by(|a, b| a.cold.total_cmp(&b.cold))
}

fn mark_best(rows: &mut [Row]) {
    let names: Vec<_> = rows.iter().map(|row| row.name.clone()).collect();
    for k in 0..rows.len() {
        let group: Vec<_> = (0..rows.len()).filter(|&other| names[other] == names[k]).collect();
        let runs: Vec<_> = group.iter().map(|&other| rows[other].run).collect();
        rows[k].best = group[best_first(&runs)[0]] == k;
    }
}

fn numbers_name(numbers: Numbers) -> &'static str {
    match numbers {
        Numbers::Complex => "complex",
        Numbers::Real => "real",
    }
}

fn form_name(form: Form) -> &'static str {
    match form {
        Form::NormalEquations => "normal equations",
        Form::Hachtel => "Hachtel form",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(cold: f64, error: f64) -> Option<Run> {
        Some(Run { cold, phases: None, drag: cold, error })
    }

    #[test]
    fn speed_does_not_excuse_errors() {
        assert_eq!(best_first(&[None, run(1.0, 10.0), run(3.0, 1e-9), run(2.0, 1e-6)]), [3, 2, 1, 0]);
    }

    #[test]
    fn where_nobody_is_accurate_the_quickest_comparable_one_is_best() {
        assert_eq!(best_first(&[run(3.0, 0.1), run(2.0, 0.4), run(1.0, 1e3)]), [1, 0, 2]);
    }
}
