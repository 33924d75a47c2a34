//! What-ifs: the energy if one path were another, without solving again.
//!
//! A spliced path changes the entries of its own rows and of its similarity, nothing else. With `G` the inverse of the
//! factored matrix on these few unknowns, `Δ` the change of its entries and `δ` that of its targets, the small update of
//! Sherman, Morrison and Woodbury gives the new energy exactly,
//!
//! ```text
//!     E′ = E + ½ Re( 2 δᴴu + δᴴGδ − vᴴ Δ (I + GΔ)⁻¹ v ),    v = u + Gδ,
//! ```
//!
//! u: the present solution on the same unknowns. A candidate costs by the cube of the rows of its path and the logarithm of
//! its points, whatever the size of the rest: microseconds for the usual handful of rows, a fifth of a millisecond for forty. The other paths may be as free as they like: `G` exists wherever the whole is regular.
//!
//! Source: Hager, *Updating the inverse of a matrix*, SIAM Review 31 (1989).

use std::sync::Arc;

use nalgebra::{DMatrix, DVector};

use crate::bent::Bent;
use crate::c64;
use crate::compliance::{Compliance, ComplianceFactor};
use crate::error::KktError;
use crate::exchange::{Basis, Difference, Exchange, Parts};
use crate::path_loads::PathLoads;
use crate::splice::SplicedPath;

/// The update is refused if its equations are missed by more than this, relative to the largest unknown.
const ALLOWED_RESIDUAL: f64 = 1e-9;

/// How a bent path answers to changes of itself: made once per factorisation, for any number of candidates and targets.
#[derive(Clone, Debug)]
pub struct PathResponse {
    /// Rows given that touch the path, rising.
    pub rows: Vec<usize>,
    /// Unknowns of the system that the path has entries in: its rows, the rows of its cuts, its similarities.
    border: Vec<usize>,
    path: usize,
    /// Position in `border` of the first similarity; two at least, the last of them may be spare.
    similarities: usize,
    /// Columns of the whole inverse for the border.
    columns: Arc<Parts>,
    /// Inverse on the border.
    inverse: DMatrix<c64>,
    /// The same without spare unknowns.
    inverse_parts: Parts,
    /// Entries that the path has now.
    present: DMatrix<c64>,
}

/// Another path in place of one, with the rows on it.
#[derive(Clone, Debug)]
pub struct Change<'a> {
    /// The path.
    pub path: &'a SplicedPath<'a>,
    /// Terms on it, for each of [`PathResponse::rows`]: point, coefficient. Terms on other paths stay.
    pub terms: Vec<Vec<(usize, c64)>>,
    /// Targets of these rows.
    pub targets: Vec<c64>,
}

impl PathResponse {
    /// Responses of path `path`. Cost: one substitution for each of its rows and similarities.
    pub fn new(problem: &Compliance, factor: &ComplianceFactor, path: usize) -> Self {
        let pieces = problem.first_pieces[path]..problem.first_pieces[path + 1];
        let mut rows: Vec<usize> = Vec::new();
        problem.loads[pieces.clone()].iter().for_each(|loads| rows.extend(loads.rows()));
        rows.sort_unstable();
        rows.dedup();
        let mut border = rows.clone();
        rows.retain(|row| *row < problem.given);
        let similarities = border.len();
        let layout = &problem.layout.similarities;
        border.extend(layout[pieces.start]..layout[pieces.end]);
        let spare = (similarities + 2).saturating_sub(border.len());
        let size = border.len() + spare;
        let mut inverse = DMatrix::identity(size, size);
        let columns = factor.inverse_columns(&border);
        for column in 0..border.len() {
            for (row, other) in border.iter().enumerate() {
                let place = (*other, column);
                inverse[(row, column)] = c64::new(columns[0][place], columns[1][place]);
            }
        }
        let (columns, present) = (Arc::new(columns), DMatrix::zeros(size, size));
        let own = inverse.view((0, 0), (border.len(), border.len()));
        let inverse_parts = [own.map(|value| value.re), own.map(|value| value.im)];
        let mut response =
            Self { rows, border, path, similarities, columns, inverse, inverse_parts, present };
        for piece in pieces.clone() {
            let first = layout[piece] - layout[pieces.start];
            response.present += response.entries(problem, &problem.loads[piece], first);
        }
        for index in size - spare..size {
            response.present[(index, index)] = c64::new(1.0, 0.0);
        }
        response
    }

    /// Entries of a path on the border, scaled as the system is; `first`: its first similarity.
    fn entries(&self, problem: &Compliance, loads: &PathLoads, first: usize) -> DMatrix<c64> {
        let mut entries = DMatrix::zeros(self.inverse.nrows(), self.inverse.ncols());
        self.visit_entries(problem, (loads, first), |row, column, value| entries[(row, column)] += value);
        entries
    }

    /// Calls `visit` with the entries of a piece: row and column of the border, value.
    fn visit_entries(
        &self,
        problem: &Compliance,
        (loads, first): (&PathLoads, usize),
        mut visit: impl FnMut(usize, usize, c64),
    ) {
        let place = |row: usize| self.border[..self.similarities].partition_point(|known| *known < row);
        let rows: Vec<(usize, f64)> = loads.rows().map(|row| (place(row), problem.scales[row])).collect();
        let unit = problem.unit.recip();
        loads.visit_pairs(|own, other, value| {
            let ((row, scale), (column, other_scale)) = (rows[own], rows[other]);
            let value = value * (scale * other_scale * unit);
            visit(row, column, value);
            if row != column {
                visit(column, row, value.conj());
            }
        });
        loads.visit_similarities(|row, motion, value| {
            let (row, column) = (place(row), self.similarities + first + motion);
            let value = value * problem.scales[self.border[row]];
            visit(row, column, value);
            visit(column, row, value.conj());
        });
    }

    /// Factorisation of `changed`, which differs from the problem that this response is of in nothing but the path and the
    /// rows on it. `before`: one that may have been of the same path in another problem, with the same path to begin with;
    /// what it took from one to the other is taken over.
    ///
    /// # Errors
    /// [`KktError::Singular`] if the change leaves something free or makes rows depend on each other.
    pub fn factor(
        &self,
        (problem, factor): (&Compliance, &ComplianceFactor),
        changed: &Compliance,
        before: Option<&ComplianceFactor>,
    ) -> Result<ComplianceFactor, KktError> {
        let basis = self.basis(problem, changed);
        let known = before.and_then(|before| before.exchange.as_ref());
        let known = known.and_then(|known| known.difference.rescaled(&basis));
        let difference = known.unwrap_or_else(|| Difference::new(basis, self.difference(problem, changed)));
        let (columns, inverse) = (Arc::clone(&self.columns), &self.inverse_parts);
        let exchange = Exchange::new(self.border.clone(), columns, (inverse, difference));
        Ok(factor.exchanged(exchange.ok_or(KktError::Singular)?))
    }

    /// What the change of entries follows from.
    fn basis(&self, problem: &Compliance, changed: &Compliance) -> Basis {
        let both = [problem, changed];
        let pieces = |problem: &Compliance| {
            problem.loads[problem.first_pieces[self.path]..problem.first_pieces[self.path + 1]].to_vec()
        };
        let weights =
            |problem: &Compliance| self.rows.iter().map(|row| problem.rows[*row].weight).collect::<Vec<_>>();
        let scale = |index: &usize| problem.scales.get(*index).copied();
        let left = self.border.iter().map(|index| scale(index).unwrap_or(problem.unit)).collect();
        let right =
            self.border.iter().map(|index| scale(index).map_or(1.0, |own| own / problem.unit)).collect();
        Basis { pieces: both.map(pieces), weights: both.map(weights), scales: [left, right] }
    }

    /// The change of entries.
    fn difference(&self, problem: &Compliance, changed: &Compliance) -> Parts {
        let size = self.border.len();
        let present = self.present.view((0, 0), (size, size));
        let [mut re, mut im] = [present.map(|value| -value.re), present.map(|value| -value.im)];
        let slack = |problem: &Compliance, row: usize| {
            let weight = problem.rows[row].weight.map_or(0.0, f64::recip);
            weight * problem.scales[row] * problem.scales[row] / problem.unit
        };
        for (place, row) in self.rows.iter().enumerate() {
            re[(place, place)] += slack(changed, *row) - slack(problem, *row);
        }
        for piece in changed.first_pieces[self.path]..changed.first_pieces[self.path + 1] {
            let first = changed.layout.similarities[piece]
                - changed.layout.similarities[changed.first_pieces[self.path]];
            self.visit_entries(changed, (&changed.loads[piece], first), |row, column, value| {
                re[(row, column)] += value.re;
                im[(row, column)] += value.im;
            });
        }
        [re, im]
    }

    /// Energy of springs and soft rows if the path were `change`, and all else as `bent` was solved for `targets`.
    ///
    /// # Errors
    /// [`KktError::ShapeMismatch`] if terms or targets are not as many as rows; [`KktError::NotFinite`];
    /// [`KktError::Singular`] if the change leaves something free or makes rows depend on each other.
    ///
    /// # Panics
    /// If a term names a point that the path does not have.
    pub fn energy(
        &self,
        problem: &Compliance,
        (bent, targets): (&Bent, &[c64]),
        change: &Change,
    ) -> Result<f64, KktError> {
        let expected = self.rows.len();
        for actual in [change.terms.len(), change.targets.len()] {
            if actual != expected {
                return Err(KktError::ShapeMismatch { block: "change", side: "rows", expected, actual });
            }
        }
        let difference = self.changed_entries(problem, change)? - &self.present;
        let delta = self.changed_targets(problem, targets, change);
        let unknowns = bent.unknowns();
        let present = self.border.iter().map(|index| unknowns[*index].high);
        let present = DVector::from_iterator(
            self.inverse.nrows(),
            present.chain([c64::default(); 2]).take(self.inverse.nrows()),
        );
        let forced = &self.inverse * &delta;
        let moved = &present + &forced;
        let system =
            DMatrix::identity(self.inverse.nrows(), self.inverse.nrows()) + &self.inverse * &difference;
        let solved = system.clone().lu().solve(&moved).ok_or(KktError::Singular)?;
        let missed = (&system * &solved - &moved).norm();
        if missed.is_nan() || missed > ALLOWED_RESIDUAL * moved.norm() {
            return Err(KktError::Singular);
        }
        let gain =
            2.0 * delta.dotc(&present).re + delta.dotc(&forced).re - moved.dotc(&(difference * solved)).re;
        Ok(bent.spring_energy() + bent.soft_energy(problem) + 0.5 * gain / problem.unit)
    }

    /// Entries of the changed path. Unknowns that it has no use for, as it is not cut, stand by themselves.
    fn changed_entries(&self, problem: &Compliance, change: &Change) -> Result<DMatrix<c64>, KktError> {
        let of_row = |(row, terms): (&usize, &Vec<(usize, c64)>)| {
            terms.iter().map(|(point, value)| (*row, *point, *value)).collect::<Vec<_>>()
        };
        let terms: Vec<_> = self.rows.iter().zip(&change.terms).flat_map(of_row).collect();
        let loads = PathLoads::new(change.path, 0..change.path.len(), &terms);
        if !loads.is_finite() {
            return Err(KktError::NotFinite { block: "q", row: 0 });
        }
        let mut entries = self.entries(problem, &loads, 0);
        let used = self.similarities + loads.motions();
        for index in (self.rows.len()..self.similarities).chain(used..entries.nrows()) {
            entries[(index, index)] = c64::new(1.0, 0.0);
        }
        Ok(entries)
    }

    /// Change of the scaled targets.
    fn changed_targets(&self, problem: &Compliance, targets: &[c64], change: &Change) -> DVector<c64> {
        let mut delta = DVector::zeros(self.inverse.nrows());
        for (place, (row, target)) in self.rows.iter().zip(&change.targets).enumerate() {
            delta[place] = (target - targets[*row]) * problem.scales[*row];
        }
        delta
    }
}
