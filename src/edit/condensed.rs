//! The exact condensation of time warps to constrained frames.
//!
//! Between consecutive constrained frames a < b of a track the optimum is uniform, with bounds as without, and all n steps
//! are worth one spring `½((t_b − t_a) − n·h)²/n`, its bounds n times those of a step. Before the first and after the last
//! constrained frame steps stay as at rest.

use cotillion_solvers::{BoundedQp, DMatrix, DVector};

use crate::clip::working::WORKING_STEP;
use crate::edit::time_row::{StepBounds, TimeRow};
use crate::path::bracket;

/// A condensed problem: one unknown per constrained frame.
#[derive(Clone, Debug)]
pub struct Condensed<'a> {
    hard: &'a [TimeRow],
    soft: &'a [TimeRow],
    counts: &'a [usize],
    tails: &'a [f64],
    gauge: bool,
    /// Constrained frames of each track, rising.
    knots: Vec<Vec<usize>>,
    /// Unknown of each track's first knot.
    offsets: Vec<usize>,
}

impl<'a> Condensed<'a> {
    /// Finds the frames of `counts`-long tracks that rows touch; a track that none touches keeps its first. `gauge`: the
    /// very first frame stays at 0. `tails`: what rows hold beyond the last frame of each track, in steps. `hard`, `soft`:
    /// the rows.
    pub fn new(
        counts: &'a [usize],
        tails: &'a [f64],
        (hard, soft): (&'a [TimeRow], &'a [TimeRow]),
        gauge: bool,
    ) -> Self {
        let mut knots: Vec<Vec<usize>> = vec![Vec::new(); counts.len()];
        for point in hard.iter().chain(soft).flat_map(|row| std::iter::once(row.at).chain(row.minus)) {
            let (low, high, share) = bracket(point.frame, counts[point.track]);
            knots[point.track].extend((share != 1.0).then_some(low));
            knots[point.track].extend((share != 0.0).then_some(high));
        }
        for (track, own) in knots.iter_mut().enumerate() {
            if own.is_empty() || (gauge && track == 0) {
                own.push(0);
            }
            own.sort_unstable();
            own.dedup();
        }
        let mut offsets = Vec::with_capacity(knots.len());
        let mut next = 0;
        for own in &knots {
            offsets.push(next);
            next += own.len();
        }
        Self { hard, soft, counts, tails, gauge, knots, offsets }
    }

    /// The quadratic program: springs, soft rows, hard rows, two bounds a piece.
    pub fn problem(&self, bounds: StepBounds) -> BoundedQp {
        let size: usize = self.knots.iter().map(Vec::len).sum();
        let pieces = self.pieces();
        let mut springs = Springs { hessian: DMatrix::zeros(size, size), linear: DVector::zeros(size) };
        let mut inequalities = DMatrix::zeros(2 * pieces.len(), size);
        let mut lower_bounds = DVector::zeros(2 * pieces.len());
        for (index, Piece { from, to, steps, weight }) in pieces.into_iter().enumerate() {
            let rest = steps * WORKING_STEP;
            springs.add(&[(from, -1.0), (to, 1.0)], weight / steps, rest);
            for (row, sign, bound) in [(2 * index, 1.0, bounds.min), (2 * index + 1, -1.0, bounds.max)] {
                inequalities[(row, from)] = -sign;
                inequalities[(row, to)] = sign;
                lower_bounds[row] = sign * bound * rest;
            }
        }
        for row in self.soft {
            springs.add(&self.terms(row), row.weight(), row.seconds);
        }
        let (equalities, equality_targets) = self.equalities(size);
        let Springs { hessian, linear } = springs;
        BoundedQp { hessian, linear, equalities, equality_targets, inequalities, lower_bounds }
    }

    /// Times of all frames from those of the constrained ones.
    pub fn expand(&self, x: &[f64], times: &mut [Vec<f64>]) {
        for ((own, offset), times) in self.knots.iter().zip(&self.offsets).zip(times) {
            spread(own, &x[*offset..offset + own.len()], times);
        }
    }

    fn pieces(&self) -> Vec<Piece> {
        let mut pieces = Vec::new();
        for (track, (knots, offset)) in self.knots.iter().zip(&self.offsets).enumerate() {
            for (index, pair) in knots.windows(2).enumerate() {
                // Rows beyond the last frame touch the last two: the step between them is a piece of its own.
                let last = pair[1] + 1 == self.counts[track];
                pieces.push(Piece {
                    from: offset + index,
                    to: offset + index + 1,
                    steps: (pair[1] - pair[0]) as f64,
                    weight: if last { 1.0 + self.tails[track] } else { 1.0 },
                });
            }
        }
        pieces
    }

    fn equalities(&self, size: usize) -> (DMatrix<f64>, DVector<f64>) {
        let count = self.hard.len() + usize::from(self.gauge);
        let mut matrix = DMatrix::zeros(count, size);
        let mut targets = DVector::zeros(count);
        for (index, row) in self.hard.iter().enumerate() {
            for (column, value) in self.terms(row) {
                matrix[(index, column)] += value;
            }
            targets[index] = row.seconds;
        }
        if self.gauge {
            matrix[(count - 1, 0)] = 1.0;
        }
        (matrix, targets)
    }

    fn terms(&self, row: &TimeRow) -> Vec<(usize, f64)> {
        let column = |track: usize, frame: usize| {
            self.offsets[track] + self.knots[track].partition_point(|k| *k < frame)
        };
        row.terms(self.counts, column)
    }
}

/// The steps between two neighbouring constrained frames.
struct Piece {
    from: usize,
    to: usize,
    steps: f64,
    weight: f64,
}

/// A quadratic form under construction.
struct Springs {
    hessian: DMatrix<f64>,
    linear: DVector<f64>,
}

impl Springs {
    /// Adds `½·weight·(terms·x − target)²`.
    fn add(&mut self, terms: &[(usize, f64)], weight: f64, target: f64) {
        for (row, a) in terms {
            self.linear[*row] += weight * a * target;
            for (column, b) in terms {
                self.hessian[(*row, *column)] += weight * a * b;
            }
        }
    }
}

/// Times between knots are evenly spaced; before the first and after the last knot steps are those at rest.
fn spread(knots: &[usize], values: &[f64], times: &mut [f64]) {
    let (first, last) = (knots[0], knots[knots.len() - 1]);
    for (frame, time) in times.iter_mut().enumerate() {
        *time = if frame <= first {
            values[0] - (first - frame) as f64 * WORKING_STEP
        } else if frame >= last {
            values[values.len() - 1] + (frame - last) as f64 * WORKING_STEP
        } else {
            let after = knots.partition_point(|knot| *knot <= frame);
            let (a, b) = (knots[after - 1], knots[after]);
            let share = (frame - a) as f64 / (b - a) as f64;
            values[after - 1] + share * (values[after] - values[after - 1])
        };
    }
}
