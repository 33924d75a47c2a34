//! The direct back ends: every frame an unknown, one augmented matrix, sparse LU. Also the reference all are compared with.

use std::ops::Range;

use cotillion_solvers::workload::{STEP, Workload};
use cotillion_solvers::{
    CsMat, Factor, KktError, KktForm, LeastSquares, PointRow, RowMatrix, Scalar, TwoPart, Workspace, analyse,
    c64,
};

use super::measure::{Part, Phase, Solver, Steps, Watch};

/// How complex rows and targets are written in numbers of this type.
pub(super) trait Coefficient: Scalar {
    /// Numbers to a point.
    const PER_POINT: usize;
    /// Appends the complex row as one row or two.
    fn push_row(rows: &mut RowMatrix<Self>, terms: &[(usize, c64)]);
    /// Appends the numbers of a complex target.
    fn push_target(targets: &mut Vec<Self>, target: c64);
    /// The point that [`PER_POINT`](Self::PER_POINT) numbers stand for.
    fn point(numbers: &[Self]) -> c64;
}

impl Coefficient for c64 {
    const PER_POINT: usize = 1;

    fn push_row(rows: &mut RowMatrix<Self>, terms: &[(usize, c64)]) {
        rows.push_row(terms);
    }

    fn push_target(targets: &mut Vec<Self>, target: c64) {
        targets.push(target);
    }

    fn point(numbers: &[Self]) -> c64 {
        numbers[0]
    }
}

/// Real and imaginary part, one after the other.
impl Coefficient for f64 {
    const PER_POINT: usize = 2;

    fn push_row(rows: &mut RowMatrix<Self>, terms: &[(usize, c64)]) {
        let real: Vec<_> = terms.iter().flat_map(|(j, a)| [(2 * j, a.re), (2 * j + 1, -a.im)]).collect();
        let imaginary: Vec<_> = terms.iter().flat_map(|(j, a)| [(2 * j, a.im), (2 * j + 1, a.re)]).collect();
        rows.push_row(&real);
        rows.push_row(&imaginary);
    }

    fn push_target(targets: &mut Vec<Self>, target: c64) {
        targets.extend([target.re, target.im]);
    }

    fn point(numbers: &[Self]) -> c64 {
        c64::new(numbers[0], numbers[1])
    }
}

/// Shape or scale system over all frames.
pub(super) struct Direct<T> {
    full: Full<T>,
    /// Samples of each path that have a soft row.
    bending: Vec<Vec<Range<usize>>>,
    /// Root of the weight of each row of the workload; none if it is hard.
    weights: Vec<Option<f64>>,
    /// Hard rows of the stands, which go before those of the workload.
    stand_rows: usize,
    /// Steps of one path.
    steps: Vec<c64>,
}

/// Time system over all frames.
pub(super) struct DirectTime {
    full: Full<f64>,
    lengths: Vec<usize>,
    weights: Vec<Option<f64>>,
}

impl<T: Coefficient> Solver for Direct<T> {
    type Point = c64;

    fn prepare(workload: &Workload, part: Part, watch: &mut Watch) -> Result<Self, KktError> {
        let (problem, bending, stands) = watch.lap(Phase::Assemble, || {
            let bending: Vec<_> = (0..workload.paths.len()).map(|path| workload.bending(path)).collect();
            let stands = part.stand_rows(workload);
            (spatial_problem::<T>(workload, &bending, (&stands, part)), bending, stands)
        });
        let (weights, stand_rows) = (roots(&workload.rows), stands.len());
        Ok(Self { full: Full::new(problem, watch)?, bending, weights, stand_rows, steps: Vec::new() })
    }

    fn solve_into(
        &mut self,
        steps: Option<Steps<'_>>,
        targets: &[c64],
        points: &mut [Vec<c64>],
        watch: &mut Watch,
    ) -> Result<(), KktError> {
        watch.lap(Phase::Solve, || {
            self.fill(steps, targets);
            self.full.solve()
        })?;
        watch.lap(Phase::Expand, || self.read(points));
        Ok(())
    }
}

impl<T: Coefficient> Direct<T> {
    /// [`Solver::solve_into`] with residuals in twice the digits, untimed.
    pub(super) fn refined_into(
        &mut self,
        steps: Option<Steps<'_>>,
        targets: &[c64],
        points: &mut [Vec<c64>],
    ) -> Result<(), KktError> {
        self.fill(steps, targets);
        self.full.solve()?;
        self.full.refine()?;
        self.read(points);
        Ok(())
    }

    fn fill(&mut self, steps: Option<Steps<'_>>, targets: &[c64]) {
        match steps {
            Some(steps) => self.fill_steps(steps),
            None => self.fill_zeros(),
        }
        let Full { m, h, .. } = &mut self.full;
        for (target, root) in targets.iter().zip(&self.weights) {
            match root {
                Some(root) => T::push_target(m, target * root),
                None => T::push_target(h, *target),
            }
        }
    }

    /// Targets of the soft rows within the paths, and of the stands.
    fn fill_steps(&mut self, steps: Steps<'_>) {
        let Full { m, h, .. } = &mut self.full;
        m.clear();
        h.clear();
        for (path, bending) in self.bending.iter().enumerate() {
            self.steps.resize(steps.workload.paths[path].len() - 1, c64::default());
            steps.write(path, &mut self.steps);
            for i in bending.iter().flat_map(Range::clone) {
                T::push_target(m, self.steps[i] - self.steps[i - 1]);
            }
            for (_, first, last) in steps.workload.stands_of(path) {
                self.steps[*first..*last].iter().for_each(|step| T::push_target(h, *step));
            }
        }
    }

    fn fill_zeros(&mut self) {
        let Full { m, h, .. } = &mut self.full;
        m.clear();
        h.clear();
        let bending: usize = self.bending.iter().flatten().map(Range::len).sum();
        m.resize(bending * T::PER_POINT, T::default());
        h.resize(self.stand_rows * T::PER_POINT, T::default());
    }

    fn read(&self, points: &mut [Vec<c64>]) {
        let mut numbers = self.full.x.chunks_exact(T::PER_POINT);
        for point in points.iter_mut().flatten() {
            *point = numbers.next().map_or(*point, T::point);
        }
    }
}

impl Solver for DirectTime {
    type Point = f64;

    fn prepare(workload: &Workload, _: Part, watch: &mut Watch) -> Result<Self, KktError> {
        let problem = watch.lap(Phase::Assemble, || time_problem(workload));
        let weights = roots(&workload.time_rows);
        Ok(Self { full: Full::new(problem, watch)?, lengths: lengths(workload), weights })
    }

    fn solve_into(
        &mut self,
        _: Option<Steps<'_>>,
        targets: &[f64],
        times: &mut [Vec<f64>],
        watch: &mut Watch,
    ) -> Result<(), KktError> {
        watch.lap(Phase::Solve, || {
            self.fill(targets);
            self.full.solve()
        })?;
        watch.lap(Phase::Expand, || self.read(times));
        Ok(())
    }
}

impl DirectTime {
    /// [`Solver::solve_into`] with residuals in twice the digits, untimed.
    pub(super) fn refined_into(&mut self, targets: &[f64], times: &mut [Vec<f64>]) -> Result<(), KktError> {
        self.fill(targets);
        self.full.solve()?;
        self.full.refine()?;
        self.read(times);
        Ok(())
    }

    fn fill(&mut self, targets: &[f64]) {
        let Full { m, h, .. } = &mut self.full;
        m.clear();
        h.clear();
        m.resize(self.lengths.iter().map(|length| length - 1).sum(), STEP);
        for (target, root) in targets.iter().zip(&self.weights) {
            match root {
                Some(root) => m.push(target * root),
                None => h.push(*target),
            }
        }
    }

    fn read(&self, times: &mut [Vec<f64>]) {
        times.iter_mut().flatten().zip(&self.full.x).for_each(|(time, x)| *time = *x);
    }
}

fn lengths(workload: &Workload) -> Vec<usize> {
    workload.paths.iter().map(Vec::len).collect()
}

fn roots<T>(rows: &[PointRow<T>]) -> Vec<Option<f64>> {
    rows.iter().map(|row| row.weight.map(f64::sqrt)).collect()
}

/// First unknown of each path.
fn starts(workload: &Workload) -> Vec<usize> {
    let sum = |next: &mut usize, path: &Vec<c64>| {
        *next += path.len();
        Some(*next - path.len())
    };
    workload.paths.iter().scan(0, sum).collect()
}

fn spatial_problem<T: Coefficient>(
    workload: &Workload,
    bending: &[Vec<Range<usize>>],
    (stands, part): (&[PointRow<c64>], Part),
) -> LeastSquares<T> {
    let starts = starts(workload);
    let columns = workload.samples() * T::PER_POINT;
    let (mut soft, mut hard) = (RowMatrix::new(columns), RowMatrix::new(columns));
    for ((path, &start), bending) in workload.paths.iter().zip(&starts).zip(bending) {
        for i in bending.iter().flat_map(Range::clone) {
            let [before, own, after] = path_row(path, i, part);
            let at = start + i;
            T::push_row(&mut soft, &[(at - 1, before), (at, own), (at + 1, after)]);
        }
    }
    for row in stands.iter().chain(&workload.rows) {
        let terms = weighted_terms(row, &starts);
        T::push_row(if row.weight.is_some() { &mut soft } else { &mut hard }, &terms);
    }
    LeastSquares { columns, soft: soft.to_csr(), hard: hard.to_csr() }
}

/// Terms on unknowns, times the root of the weight.
fn weighted_terms<T: Scalar>(row: &PointRow<T>, starts: &[usize]) -> Vec<(usize, T)> {
    let root = row.weight.map_or(1.0, f64::sqrt);
    row.terms.iter().map(|&(path, i, a)| (starts[path] + i, a.scale(root))).collect()
}

/// Coefficients of samples i − 1, i, i + 1: the shape row `(z − 1, 1, −z)`, or the second difference.
fn path_row(rest: &[c64], i: usize, part: Part) -> [c64; 3] {
    let one = c64::new(1.0, 0.0);
    if part == Part::Shape {
        let z = (rest[i] - rest[i - 1]) / (rest[i + 1] - rest[i - 1]);
        [z - one, one, -z]
    } else {
        [one, one * -2.0, one]
    }
}

fn time_problem(workload: &Workload) -> LeastSquares<f64> {
    let starts = starts(workload);
    let columns = workload.samples();
    let (mut soft, mut hard) = (RowMatrix::new(columns), RowMatrix::new(columns));
    for (path, &start) in workload.paths.iter().zip(&starts) {
        for i in start..start + path.len() - 1 {
            soft.push_row(&[(i, -1.0), (i + 1, 1.0)]);
        }
    }
    for row in &workload.time_rows {
        let terms = weighted_terms(row, &starts);
        if row.weight.is_some() {
            soft.push_row(&terms)
        } else {
            hard.push_row(&terms)
        };
    }
    LeastSquares { columns, soft: soft.to_csr(), hard: hard.to_csr() }
}

/// A least-squares problem with its factor, its targets `m`, `h` and its last solution.
struct Full<T> {
    problem: LeastSquares<T>,
    factor: Factor<T>,
    workspace: Workspace<T>,
    m: Vec<T>,
    h: Vec<T>,
    x: Vec<T>,
}

/// Corrections of the reference at most. Each gains three digits or more, so after two all digits of `f64` are there.
const MOST_CORRECTIONS: usize = 2;

impl<T: Scalar> Full<T> {
    fn new(problem: LeastSquares<T>, watch: &mut Watch) -> Result<Self, KktError> {
        let analysis = watch.lap(Phase::Analyse, || analyse(&problem, KktForm::Hachtel))?;
        let (factor, workspace) = watch.lap(Phase::Factor, || {
            let factor = analysis.factor(&problem)?;
            let workspace = factor.workspace();
            Ok((factor, workspace))
        })?;
        let x = vec![T::default(); problem.columns];
        Ok(Self { problem, factor, workspace, m: Vec::new(), h: Vec::new(), x })
    }

    fn solve(&mut self) -> Result<(), KktError> {
        self.factor.solve_into(&self.m, &self.h, &mut self.x, &mut self.workspace).map(|_| ())
    }

    /// Corrects the last solution: what is left of the targets, summed to twice the digits, is solved for until
    /// corrections no longer halve.
    fn refine(&mut self) -> Result<(), KktError> {
        let mut correction = vec![T::default(); self.x.len()];
        let mut last = f64::INFINITY;
        for _ in 0..MOST_CORRECTIONS {
            let m = compensated_residual(&self.problem.soft, &self.x, &self.m);
            let h = compensated_residual(&self.problem.hard, &self.x, &self.h);
            self.factor.solve_into(&m, &h, &mut correction, &mut self.workspace)?;
            let size = correction.iter().map(|d| d.modulus()).fold(0.0, f64::max);
            if size > 0.5 * last {
                break;
            }
            self.x.iter_mut().zip(&correction).for_each(|(x, &d)| *x += d);
            last = size;
        }
        Ok(())
    }
}

/// `b − A x`, products summed to about 32 digits and rounded once.
fn compensated_residual<T: Scalar>(a: &CsMat<T>, x: &[T], b: &[T]) -> Vec<T> {
    let rows = a.outer_iterator().zip(b);
    rows.map(|(row, &b_i)| {
        let mut sum = TwoPart { high: b_i, low: T::default() };
        row.iter().for_each(|(j, &a_ij)| T::add_product(&mut sum, -a_ij, x[j]));
        sum.high
    })
    .collect()
}
