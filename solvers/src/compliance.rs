//! The compliance form: paths as chains of springs, reduced exactly to one unknown per constraint row and two per path.
//!
//! `min ½ Σ |δ_s|²/c_s + ½ Σ_soft w_r |C_r x − d_r|²` subject to `C_r x = d_r` for the hard rows, over paths x that
//! [`springs`](crate::springs) describes. With one multiplier λ a row and the similarity `y = (a, b)` of every path,
//!
//! ```text
//!     | CΓCᴴ + W⁻¹   CZ   0 | | λ |   | d |
//!     | (CZ)ᴴ        0    Y | | y | = | 0 |        W⁻¹ = diag(1/w), 0 for hard rows
//!     |  0           Yᴴ   0 | | ν |   | 0 |
//! ```
//!
//! Γ: covariances of points, from the moments of the springs between constrained points; Z: orthonormal similarities of
//! each path; Y: those combinations of them that no row sees, fixed at the least change of all points. Exact: nothing is
//! sampled or truncated. The entries between two paths come from the rows that tie them, so a relay stays block-tridiagonal.
//!
//! Solutions are refined against the springs themselves, not against the rounded matrix: in O(rows), as points under load
//! are known without visiting the springs in between.
//!
//! Paths with many rows are cut into pieces of a few rows each, held together by two hard rows at each cut.
//!
//! Cost: one pass over the springs to assemble, one to expand; all else by rows, linear where rows tie neighbours.
//!
//! Source: derived from the shape rows of Kim et al., *Synchronized Multi-Character Motion Editing*, SIGGRAPH 2009, eq. 3,
//! by the substitution in [`springs`](crate::springs); static condensation as in Przemieniecki, *Theory of Matrix Structural
//! Analysis* (1968), ch. 9.

use std::sync::{Arc, OnceLock};

use nalgebra::DMatrix;
use rayon::prelude::*;

use crate::c64;
use crate::error::KktError;
use crate::exchange::{Exchange, Parts, applied};
use crate::free::{Combination, free_combinations};
use crate::lu::{LuOrder, LuScratch};
use crate::path_loads::PathLoads;
use crate::pieces::{Piece, cut_into_pieces};
use crate::points::PointRow;
use crate::refine::RefinedLu;
use crate::sparse::Assembly;
use crate::springs::SpringPath;

/// Springs of several paths and the rows on their points.
#[derive(Clone, Debug, PartialEq)]
pub struct Compliance {
    pub(crate) paths: Vec<Arc<SpringPath>>,
    /// Rows given, then those of cuts.
    pub(crate) rows: Vec<PointRow<c64>>,
    /// How many rows were given.
    pub(crate) given: usize,
    /// Pieces of all paths, in order.
    pub(crate) loads: Vec<Arc<PathLoads>>,
    /// First piece of each path; one more entry closes the last.
    pub(crate) first_pieces: Vec<usize>,
    pub(crate) layout: Layout,
    pub(crate) free: Vec<Combination>,
    positions: Arc<Vec<(usize, usize)>>,
    pub(crate) scales: Vec<f64>,
    /// Power of two that the covariances are divided by in the system.
    pub(crate) unit: f64,
    data: Vec<c64>,
}

/// Where the blocks of the system begin.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Layout {
    /// First unknown of each piece's similarity; one more entry closes the last.
    pub(crate) similarities: Vec<usize>,
    /// First multiplier of a free motion.
    pub(crate) free: usize,
    /// All unknowns.
    pub(crate) size: usize,
}

/// Order of elimination, for all problems with the same pattern. Cheap to clone.
#[derive(Clone, Debug)]
pub struct ComplianceAnalysis(Arc<Plan>);

#[derive(Debug)]
struct Plan {
    positions: Arc<Vec<(usize, usize)>>,
    assembly: Assembly,
    order: LuOrder,
}

/// A factored problem.
#[derive(Clone, Debug)]
pub struct ComplianceFactor {
    plan: Arc<Plan>,
    lu: Arc<RefinedLu<c64>>,
    /// The inverse, once asked for, of small systems.
    inverse: Arc<OnceLock<Parts>>,
    /// Of one path exchanged since.
    pub(crate) exchange: Option<Arc<Exchange>>,
}

/// Systems of no more unknowns have their inverse written down for what-ifs, which solve by the hundred: products with it take
/// a third of the time of sparse substitutions.
const MOST_INVERTED: usize = 128;

/// Paths with more samples than this in all are worked on by all threads.
const WORTH_THREADS: usize = 20_000;

impl Compliance {
    /// Moments of the springs, then all entries of the system. `rows`: the hard ones independent of each other. Cost: linear
    /// in springs and, where rows tie neighbours, in rows.
    ///
    /// # Panics
    /// If a row names a path or point that does not exist.
    pub fn new(paths: Vec<SpringPath>, rows: Vec<PointRow<c64>>) -> Self {
        let given = rows.len();
        let (pieces, rows) = cut_into_pieces(&paths, rows);
        let samples: usize = paths.iter().map(SpringPath::len).sum();
        let build =
            |piece: &Piece| Arc::new(PathLoads::new(&paths[piece.path], piece.own.clone(), &piece.terms));
        let loads: Vec<Arc<PathLoads>> = if samples > WORTH_THREADS {
            pieces.par_iter().with_min_len(16).map(build).collect()
        } else {
            pieces.iter().map(build).collect()
        };
        let mut first_pieces: Vec<usize> =
            (0..paths.len()).map(|path| pieces.partition_point(|piece| piece.path < path)).collect();
        first_pieces.push(pieces.len());
        let mut problem = Self {
            paths: paths.into_iter().map(Arc::new).collect(),
            rows,
            given,
            loads,
            first_pieces,
            layout: Layout::default(),
            free: Vec::new(),
            positions: Arc::default(),
            scales: Vec::new(),
            unit: 1.0,
            data: Vec::new(),
        };
        problem.lay_out();
        problem.scale_rows();
        problem.fill();
        problem
    }

    /// Number of free motions, which are fixed as at rest.
    pub fn free_motions(&self) -> usize {
        self.free.len()
    }

    /// The same unknowns and scales for other paths, rows and pieces; without entries.
    pub(crate) fn like(
        &self,
        paths: Vec<Arc<SpringPath>>,
        rows: Vec<PointRow<c64>>,
        loads: Vec<Arc<PathLoads>>,
    ) -> Self {
        Self {
            paths,
            rows,
            loads,
            given: self.given,
            first_pieces: self.first_pieces.clone(),
            layout: self.layout.clone(),
            free: Vec::new(),
            positions: Arc::default(),
            scales: self.scales.clone(),
            unit: self.unit,
            data: Vec::new(),
        }
    }

    fn lay_out(&mut self) {
        let mut next = self.rows.len();
        self.layout.similarities.clear();
        for loads in &self.loads {
            self.layout.similarities.push(next);
            next += loads.motions();
        }
        self.layout.similarities.push(next);
        self.layout.free = next;
        let groups: Vec<usize> =
            self.layout.similarities.iter().map(|start| start - self.rows.len()).collect();
        self.free = free_combinations(&self.motions_seen(), &groups, self.rows.len());
        self.layout.size = next + self.free.len();
    }

    /// What each row sees of each similarity, rows normalised: by motion.
    fn motions_seen(&self) -> Vec<Combination> {
        let first = self.rows.len();
        let mut lengths = vec![0.0_f64; first];
        for (length, row) in lengths.iter_mut().zip(&self.rows) {
            *length = row.terms.iter().map(|(_, _, value)| value.norm_sqr()).sum::<f64>().sqrt();
        }
        let mut seen: Vec<Combination> = Vec::with_capacity(self.layout.free - first);
        for loads in &self.loads {
            let rows = loads.rows().count();
            seen.extend((0..loads.motions()).map(|_| Vec::with_capacity(rows)));
        }
        for (loads, start) in self.loads.iter().zip(&self.layout.similarities) {
            loads.visit_similarities(|row, motion, value| {
                if lengths[row] > 0.0 {
                    seen[start - first + motion].push((row, value / lengths[row]));
                }
            });
        }
        seen
    }

    /// Powers of two that bring rows and covariances to about 1.
    fn scale_rows(&mut self) {
        let count = self.rows.len();
        let mut own: Vec<f64> = self.rows.iter().map(|row| row.weight.map_or(0.0, f64::recip)).collect();
        let mut seen = vec![0.0_f64; count];
        for loads in &self.loads {
            loads.visit_variances(|row, variance| own[row] += variance);
            loads.visit_similarities(|row, _, value| seen[row] += value.norm_sqr());
        }
        let sizes = self.rows.iter().map(|row| row.terms.iter().map(|(_, _, c)| c.norm_sqr()).sum::<f64>());
        let unit = own.iter().zip(sizes).map(|(own, size)| own / size).fold(0.0, f64::max);
        self.unit = if unit > 0.0 && unit.is_finite() { unit.log2().round().exp2() } else { 1.0 };
        let scale = |(own, seen): (&f64, &f64)| {
            let size = (own / self.unit).max(*seen).sqrt();
            if size > 0.0 { size.log2().round().exp2().recip() } else { 1.0 }
        };
        self.scales = own.iter().zip(&seen).map(scale).collect();
    }

    fn fill(&mut self) {
        let (rows, scales, unit) = (&self.rows, &self.scales, self.unit);
        let entries = self.loads.iter().map(|loads| loads.entries()).sum::<usize>() + rows.len();
        let (mut positions, mut data) = (Vec::with_capacity(entries), Vec::with_capacity(entries));
        let mut put = |row: usize, column: usize, value: c64| {
            positions.push((row, column));
            data.push(value);
        };
        for (index, row) in rows.iter().enumerate() {
            let own = row.weight.map_or(0.0, f64::recip) * scales[index] * scales[index] / unit;
            put(index, index, c64::new(own, 0.0));
        }
        for (loads, start) in self.loads.iter().zip(&self.layout.similarities) {
            loads.visit_covariances(|row, column, value| {
                let value = value * (scales[row] * scales[column] / unit);
                put(row, column, value);
                if row != column {
                    put(column, row, value.conj());
                }
            });
            loads.visit_similarities(|row, motion, value| {
                let value = value * scales[row];
                put(row, start + motion, value);
                put(start + motion, row, value.conj());
            });
        }
        for (index, combination) in self.free.iter().enumerate() {
            let column = self.layout.free + index;
            for (motion, share) in combination {
                put(rows.len() + motion, column, *share);
                put(column, rows.len() + motion, share.conj());
            }
        }
        (self.positions, self.data) = (Arc::new(positions), data);
    }

    /// Plans the elimination from the pattern.
    ///
    /// # Errors
    /// [`KktError::NotFinite`] for coefficients, weights or points that are not; [`KktError::Singular`] if memory runs out.
    pub fn analyse(&self) -> Result<ComplianceAnalysis, KktError> {
        check(self)?;
        let assembly = Assembly::new(self.layout.size, &self.positions);
        let order = LuOrder::new(&assembly.pattern).map_err(|_| KktError::Singular)?;
        Ok(ComplianceAnalysis(Arc::new(Plan { positions: self.positions.clone(), assembly, order })))
    }
}

impl ComplianceAnalysis {
    /// Whether a problem has the pattern of the analysed one. Cost: linear in entries.
    pub fn fits(&self, problem: &Compliance) -> bool {
        problem.layout.size == self.0.assembly.pattern.size && problem.positions == self.0.positions
    }

    /// Factors a problem with the pattern of the analysed one.
    ///
    /// # Errors
    /// [`KktError::PatternChanged`]; [`KktError::NotFinite`]; [`KktError::Singular`] if hard rows depend on each other.
    pub fn factor(&self, problem: &Compliance) -> Result<ComplianceFactor, KktError> {
        let plan = &*self.0;
        check(problem)?;
        if !self.fits(problem) {
            return Err(KktError::PatternChanged { block: "C" });
        }
        let values = plan.assembly.values(&problem.data);
        let lu =
            RefinedLu::new(&plan.assembly.pattern, &plan.order, values).map_err(|_| KktError::Singular)?;
        Ok(ComplianceFactor {
            plan: self.0.clone(),
            lu: Arc::new(lu),
            inverse: Arc::default(),
            exchange: None,
        })
    }
}

impl ComplianceFactor {
    /// The same with one path exchanged.
    pub(crate) fn exchanged(&self, exchange: Exchange) -> Self {
        Self { exchange: Some(Arc::new(exchange)), ..self.clone() }
    }

    /// Memory for [`ComplianceFactor::substitute`].
    pub(crate) fn scratch(&self) -> LuScratch {
        self.lu.lu_scratch()
    }

    /// Replaces `b` by the solution of the scaled system, not refined.
    pub(crate) fn substitute(&self, b: &mut [c64], scratch: &mut LuScratch) {
        let Some(exchange) = &self.exchange else { return self.lu.substitute(b, scratch) };
        match self.inverse.get() {
            Some(inverse) => b.copy_from_slice(&applied(inverse, b)),
            None => self.lu.substitute(b, scratch),
        }
        exchange.correct(b);
    }

    /// Columns of the inverse of the scaled matrix, not refined.
    pub(crate) fn inverse_columns(&self, indices: &[usize]) -> Parts {
        let size = self.plan.assembly.pattern.size;
        if size > MOST_INVERTED {
            return self.substituted_columns(indices);
        }
        let all = || parts(&self.lu.inverse(&self.plan.assembly.pattern), size);
        self.inverse.get_or_init(all).each_ref().map(|part| part.select_columns(indices))
    }

    fn substituted_columns(&self, indices: &[usize]) -> Parts {
        let size = self.plan.assembly.pattern.size;
        let mut columns = vec![c64::default(); size * indices.len()];
        for (column, index) in indices.iter().enumerate() {
            columns[column * size + index] = c64::new(1.0, 0.0);
        }
        self.lu.substitute_columns(&mut columns, indices.len());
        parts(&columns, size)
    }
}

/// Columns of `size` entries, one after the other, as a matrix.
fn parts(columns: &[c64], size: usize) -> Parts {
    let count = columns.len() / size.max(1);
    let part = |of: fn(&c64) -> f64| DMatrix::from_iterator(size, count, columns.iter().map(of));
    [part(|value| value.re), part(|value| value.im)]
}

fn check(problem: &Compliance) -> Result<(), KktError> {
    let sound = |row: &PointRow<c64>| {
        let weight = row.weight.is_none_or(|weight| weight.is_finite() && weight > 0.0);
        weight && row.terms.iter().all(|(_, _, value)| value.is_finite())
    };
    if let Some(row) = problem.rows.iter().position(|row| !sound(row)) {
        return Err(KktError::NotFinite { block: "C", row });
    }
    match problem.loads.iter().position(|loads| !loads.is_finite()) {
        Some(row) => Err(KktError::NotFinite { block: "q", row }),
        None => Ok(()),
    }
}
