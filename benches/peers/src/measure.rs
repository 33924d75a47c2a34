//! One timed run of one solver, with its error.

use crate::configuration::Configuration;
use crate::ours::{Route, cold};
use crate::peer::{Failed, Library, Peer, cpu_seconds};
use crate::problem::{reference, shape_problem, split_targets};
use crate::system::{
    FORMS, Form, Layout, Matrix, NUMBERS, Numbers, assemble, layout, points_of, right_hand_side,
};
use cotillion_solvers::workload::Workload;
use cotillion_solvers::{KktError, LeastSquares, c64};
use std::hint::black_box;

/// Drag steps of a run.
pub const DRAG_STEPS: usize = 5;

/// A workload with all that solvers are given and compared with.
pub struct Case {
    /// The problem.
    pub workload: Workload,
    /// Targets of the workload, then of each drag step.
    targets: Vec<Vec<c64>>,
    /// As other libraries are given it.
    pub posed: Posed,
}

/// A problem as other libraries are given it, at rest and in each step of a drag.
pub struct Posed {
    /// Solutions of the first and the last step.
    reference: [Vec<c64>; 2],
    systems: Vec<System>,
}

struct System {
    form: Form,
    layout: Layout,
    matrices: [(Numbers, Matrix); 2],
    right_hand_sides: Vec<Vec<f64>>,
}

/// What stands for the times of several runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Statistic {
    /// The usual time on this machine as it is.
    Median,
    /// The time on a machine that does nothing else.
    Least,
}

/// What a run took, seconds, and how good it was.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Run {
    /// From nothing to the solution. For other libraries: the sum of `phases`.
    pub cold: f64,
    /// Analyse, factor, solve; not told apart for our own.
    pub phases: Option<[f64; 3]>,
    /// From other targets to another solution; median of some steps.
    pub drag: f64,
    /// Largest distance of any sample from the reference, metres; of the cold solution and the last drag step.
    pub error: f64,
}

impl Case {
    /// Assembles everything; not part of any time.
    ///
    /// # Errors
    /// Those of the solver of the reference.
    pub fn new(workload: Workload) -> Result<Self, KktError> {
        let mut targets = vec![workload.targets.clone()];
        targets.extend((0..DRAG_STEPS).map(|step| workload.dragged(step).0));
        let compared = [targets[0].clone(), targets[DRAG_STEPS].clone()];
        let solutions = reference(&workload, &compared)?;
        let [first, last] = <[_; 2]>::try_from(solutions).expect("one solution for each of two targets");
        let sides: Vec<_> = targets.iter().map(|targets| split_targets(&workload, targets)).collect();
        let posed = Posed::new(&shape_problem(&workload), &sides, [first, last]);
        Ok(Self { workload, targets, posed })
    }
}

impl Posed {
    /// Assembles everything; not part of any time. `sides`: m and h of each step; `reference`: solutions of the first and the last.
    pub fn new(
        problem: &LeastSquares<c64>,
        sides: &[(Vec<c64>, Vec<c64>)],
        reference: [Vec<c64>; 2],
    ) -> Self {
        Self { reference, systems: FORMS.map(|form| System::new(problem, form, sides)).into() }
    }

    fn error(&self, cold: &[c64], dragged: &[c64]) -> f64 {
        distance(cold, &self.reference[0]).max(distance(dragged, &self.reference[1]))
    }
}

impl System {
    fn new(problem: &LeastSquares<c64>, form: Form, sides: &[(Vec<c64>, Vec<c64>)]) -> Self {
        Self {
            form,
            layout: layout(problem, form),
            matrices: NUMBERS.map(|numbers| (numbers, assemble(problem, form, numbers))),
            right_hand_sides: sides.iter().map(|(m, h)| right_hand_side(problem, form, m, h)).collect(),
        }
    }
}

/// Runs another library once. Assembly, conversion and freeing are not part of its times.
///
/// # Errors
/// The status of the library.
pub fn run_peer(posed: &Posed, configuration: &Configuration) -> Result<Run, Failed> {
    let Configuration { library, form, numbers, options, .. } = configuration;
    let find = "a system for each form and kind of numbers";
    let system = posed.systems.iter().find(|system| system.form == *form).expect(find);
    let (_, matrix) = system.matrices.iter().find(|(kind, _)| kind == numbers).expect(find);
    let mut x = vec![0.0; 2 * system.layout.size];
    let mut peer = Peer::new(matrix, *library, *options)?;
    let phases = [
        timed(|| peer.analyse())?,
        timed(|| peer.factor())?,
        timed(|| peer.solve(&system.right_hand_sides[0], &mut x))?,
    ];
    let cold = points_of(system.layout, &x);
    let mut drags = Vec::new();
    for b in &system.right_hand_sides[1..] {
        drags.push(timed(|| peer.solve(b, &mut x))?);
    }
    let error = posed.error(&cold, &points_of(system.layout, &x));
    Ok(Run { cold: phases.iter().sum(), phases: Some(phases), drag: median(&mut drags), error })
}

/// Runs one of our own once: from rest paths to edited paths, assembly included.
///
/// # Errors
/// Those of the solver.
pub fn run_ours(case: &Case, route: Route) -> Result<Run, KktError> {
    let mut made = None;
    let seconds = timed(|| cold(route, &case.workload).map(|drag| made = Some(drag)))?;
    let mut drag = made.expect("cold succeeded");
    let paths = drag.paths.clone();
    let mut drags = Vec::new();
    for targets in &case.targets[1..] {
        drags.push(timed(|| drag.step(&case.workload, targets).map(|edited| _ = black_box(edited)))?);
    }
    let last = drag.step(&case.workload, &case.targets[DRAG_STEPS])?;
    let error = case.posed.error(&paths.concat(), &last.concat());
    Ok(Run { cold: seconds, phases: None, drag: median(&mut drags), error })
}

/// Middle one, or the mean of the two in the middle; sorts.
///
/// # Panics
/// If there is none.
pub fn median(numbers: &mut [f64]) -> f64 {
    numbers.sort_by(f64::total_cmp);
    let middle = numbers.len() / 2;
    if numbers.len() % 2 == 1 { numbers[middle] } else { 0.5 * (numbers[middle - 1] + numbers[middle]) }
}

/// Medians, or least times, of several runs; the largest error.
///
/// # Panics
/// If there is none.
pub fn summary(runs: &[Run], statistic: Statistic) -> Run {
    let of = |value: &dyn Fn(&Run) -> f64| {
        let mut times: Vec<_> = runs.iter().map(value).collect();
        let middle = median(&mut times);
        if statistic == Statistic::Median { middle } else { times[0] }
    };
    let phase = |k: usize| of(&|run| run.phases.map_or(0.0, |phases| phases[k]));
    Run {
        cold: of(&|run| run.cold),
        phases: runs[0].phases.map(|_| [phase(0), phase(1), phase(2)]),
        drag: of(&|run| run.drag),
        error: runs.iter().map(|run| run.error).fold(0.0, f64::max),
    }
}

/// Seconds that a step keeps a processor busy.
pub fn timed<E>(step: impl FnOnce() -> Result<(), E>) -> Result<f64, E> {
    let start = cpu_seconds();
    step()?;
    Ok(cpu_seconds() - start)
}

/// Largest distance of two samples; infinite if one is not a number.
fn distance(a: &[c64], b: &[c64]) -> f64 {
    let distances = a.iter().zip(b).map(|(a, b)| (a - b).norm());
    distances.fold(0.0, |largest, d| if d.is_nan() { f64::INFINITY } else { d.max(largest) })
}

/// Libraries in the order of the table.
pub const LIBRARIES: [Library; 4] = [Library::Umfpack, Library::Klu, Library::SparseLu, Library::Ldlt];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn median_is_the_middle() {
        assert_eq!(median(&mut [3.0, 1.0, 2.0]), 2.0);
        assert_eq!(median(&mut [4.0, 1.0, 2.0, 3.0]), 2.5);
    }

    #[test]
    fn summaries_are_of_each_time_apart() {
        let run = |cold, drag, error| Run { cold, phases: None, drag, error };
        let runs = [run(3.0, 0.1, 0.0), run(1.0, 0.3, 1e-3), run(2.0, 0.2, 0.0)];
        assert_eq!(summary(&runs, Statistic::Median), run(2.0, 0.2, 1e-3));
        assert_eq!(summary(&runs, Statistic::Least), run(1.0, 0.1, 1e-3));
    }

    #[test]
    fn distance_to_no_number_is_infinite() {
        let zero = c64::default();
        assert_eq!(distance(&[c64::new(f64::NAN, 0.0), zero], &[zero, zero]), f64::INFINITY);
        assert_eq!(distance(&[c64::new(3.0, 4.0), zero], &[zero, zero]), 5.0);
    }
}
