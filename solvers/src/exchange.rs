//! One path of a factored problem exchanged for another: the factorisation stays, a small update makes good the difference.
//!
//! The other path changes the entries of its own rows and of its similarities, on a border P of a few unknowns. With `G` the
//! inverse on the border, `Δ = UVᴴ` the change of its entries, and x₀ the solution of the system as factored,
//!
//! ```text
//!     (K + PUVᴴPᴴ) x = b        x = x₀ − K⁻¹P U (I + VᴴGU)⁻¹ VᴴPᴴ x₀
//! ```
//!
//! A splice moves whole stretches rigidly, so that Δ has a handful of columns' rank, however many rows there are: crosses of
//! one row and one column at a time, each through the largest entry left, exhaust it.
//!
//! Solutions are refined against the springs of the exchanged path like any other, so that they are as good as those of a
//! factorisation of its own.
//!
//! Sources: Hager, *Updating the inverse of a matrix*, SIAM Review 31 (1989); Bebendorf, *Approximation of boundary element
//! matrices*, Numer. Math. 86 (2000).

use std::sync::Arc;

use nalgebra::{DMatrix, DVector, Dyn, LU};
use pulp::Arch;

use crate::c64;
use crate::compliance::Compliance;
use crate::path_loads::PathLoads;
use crate::pieces::cut_path;
use crate::points::PointRow;
use crate::springs::SpringPath;

/// Real and imaginary part: products of real numbers are several times as fast as those of complex ones. Sums over their columns
/// are [dispatched](Arch::dispatch) to the widest vectors there are; they are the same by any.
pub(crate) type Parts = [DMatrix<f64>; 2];

/// The update of a factorisation.
#[derive(Clone, Debug)]
pub(crate) struct Exchange {
    /// Unknowns that the path has entries in.
    border: Vec<usize>,
    /// K⁻¹P.
    columns: Arc<Parts>,
    /// Δ.
    pub(crate) difference: Difference,
    /// I + VᴴGU.
    system: LU<c64, Dyn, Dyn>,
}

/// What another path changes of the entries on the border, as `Δ = UVᴴ`.
#[derive(Clone, Debug)]
pub(crate) struct Difference {
    /// What it follows from.
    basis: Basis,
    /// U.
    left: Parts,
    /// Vᴴ.
    right: Parts,
}

/// All that the entries of two paths on one border follow from.
#[derive(Clone, Debug)]
pub(crate) struct Basis {
    /// Pieces of the path as it is and as it would be.
    pub(crate) pieces: [Vec<Arc<PathLoads>>; 2],
    /// Of each row given on it, the weights then.
    pub(crate) weights: [Vec<Option<f64>>; 2],
    /// Powers of two that rows and columns of Δ are multiplied by.
    pub(crate) scales: [Vec<f64>; 2],
}

impl Basis {
    /// Whether `other` leads to the same Δ but for its scales.
    fn agrees_with(&self, other: &Self) -> bool {
        let same = |(a, b): (&Arc<PathLoads>, &Arc<PathLoads>)| Arc::ptr_eq(a, b) || a == b;
        let pieces = self.pieces.iter().zip(&other.pieces);
        self.weights == other.weights
            && pieces.into_iter().all(|(a, b)| a.len() == b.len() && a.iter().zip(b).all(same))
    }
}

impl Difference {
    /// `entries`: Δ. Cost: its entries times its rank.
    pub(crate) fn new(basis: Basis, entries: Parts) -> Self {
        let (left, right) = crosses(entries);
        Self { basis, left, right }
    }

    /// That of `basis`, if it is the same but for scales. Cost: by the border and the rank.
    pub(crate) fn rescaled(&self, basis: &Basis) -> Option<Self> {
        if !self.basis.agrees_with(basis) {
            return None;
        }
        let ratios =
            |side: usize| basis.scales[side].iter().zip(&self.basis.scales[side]).map(|(new, old)| new / old);
        let mut left = self.left.clone();
        for part in &mut left {
            part.row_iter_mut().zip(ratios(0)).for_each(|(mut row, ratio)| row *= ratio);
        }
        let mut right = self.right.clone();
        for part in &mut right {
            part.column_iter_mut().zip(ratios(1)).for_each(|(mut column, ratio)| column *= ratio);
        }
        Some(Self { basis: basis.clone(), left, right })
    }
}

/// A system is singular if its largest pivot is as many times its smallest: something is free, but for rounding. Regular ones
/// stay below 1e11.
const MOST_SPREAD: f64 = 1e13;
/// What is left of a difference is rounding where it is smaller than this, relative to its largest entry: covariances have
/// about so many digits. Refinement makes good what is left out.
const EXHAUSTED: f64 = 1e-13;

impl Exchange {
    /// `inverse`: G. `None` where the system is singular to rounding. Cost: by the square of the border and the rank of the
    /// difference.
    pub(crate) fn new(
        border: Vec<usize>,
        columns: Arc<Parts>,
        (inverse, difference): (&Parts, Difference),
    ) -> Option<Self> {
        let rank = difference.right[0].nrows();
        let forced = product(inverse, &difference.left);
        let system = DMatrix::identity(rank, rank) + joined(&product(&difference.right, &forced));
        let system = system.lu();
        let pivots = (0..rank).map(|k| system.lu_internal()[(k, k)].norm());
        let (least, most) = pivots.fold((f64::INFINITY, 0.0_f64), |(a, b), own| (a.min(own), b.max(own)));
        let regular = rank == 0 || most < MOST_SPREAD * least; // which NaN is not
        regular.then_some(Self { border, columns, difference, system })
    }

    /// From the solution of the system as factored to that of the exchanged one.
    pub(crate) fn correct(&self, x: &mut [c64]) {
        let Difference { left, right, .. } = &self.difference;
        if right[0].nrows() == 0 {
            return;
        }
        let own: Vec<c64> = self.border.iter().map(|index| x[*index]).collect();
        let mut own = DVector::from_vec(applied(right, &own));
        // A pivot that is 0 would have been found when it was factored.
        self.system.solve_mut(&mut own);
        let moved = applied(&self.columns, &applied(left, own.as_slice()));
        x.iter_mut().zip(moved).for_each(|(x, moved)| *x -= moved);
    }
}

/// `A B`.
fn product([a_re, a_im]: &Parts, [b_re, b_im]: &Parts) -> Parts {
    let (mut re, mut im) = (a_re * b_re, a_re * b_im);
    re.gemm(-1.0, a_im, b_im, 1.0);
    im.gemm(1.0, a_im, b_re, 1.0);
    [re, im]
}

/// `A x`. Cost: one pass over A.
pub(crate) fn applied(parts: &Parts, x: &[c64]) -> Vec<c64> {
    let size = parts[0].nrows();
    let mut sums = vec![0.0; 2 * size];
    let (re, im) = sums.split_at_mut(size);
    Arch::new().dispatch(|| add_columns(parts, x.iter().copied(), (re, im)));
    re.iter().zip(&*im).map(|(re, im)| c64::new(*re, *im)).collect()
}

/// Adds `A x` to real and imaginary parts.
#[inline(always)]
fn add_columns([a_re, a_im]: &Parts, x: impl Iterator<Item = c64>, (re, im): (&mut [f64], &mut [f64])) {
    let size = re.len();
    let columns = a_re.as_slice().chunks_exact(size.max(1)).zip(a_im.as_slice().chunks_exact(size.max(1)));
    for ((column_re, column_im), x) in columns.zip(x) {
        let sums = re.iter_mut().zip(im.iter_mut());
        for ((re, im), (a, b)) in sums.zip(column_re.iter().zip(column_im)) {
            *re += a * x.re - b * x.im;
            *im += a * x.im + b * x.re;
        }
    }
}

fn joined([re, im]: &Parts) -> DMatrix<c64> {
    re.zip_map(im, c64::new)
}

/// A square matrix as `U` and `Vᴴ`, exact to rounding. Cost: its entries times its rank.
fn crosses(entries: Parts) -> (Parts, Parts) {
    let size = entries[0].nrows();
    let (left, right) = Arch::new().dispatch(|| found_crosses(entries));
    let rank = left[0].len() / size.max(1);
    (
        left.map(|part| DMatrix::from_vec(size, rank, part)),
        right.map(|part| DMatrix::from_row_slice(rank, size, &part)),
    )
}

/// Columns of `U` and rows of `Vᴴ`, one after the other.
#[inline(always)]
fn found_crosses(mut rest: Parts) -> ([Vec<f64>; 2], [Vec<f64>; 2]) {
    let size = rest[0].nrows();
    let mut largest: Vec<f64> = (0..size).map(|column| largest_sq(&rest, column)).collect();
    let (mut left, mut right) = ([Vec::new(), Vec::new()], [Vec::new(), Vec::new()]);
    let mut floor_sq = None;
    let mut rank = 0;
    while rank < size {
        let (most_sq, column) = first_largest(largest.iter().copied());
        let floor_sq = *floor_sq.get_or_insert(EXHAUSTED * EXHAUSTED * most_sq);
        // What is not a number is seen by the pivots.
        if most_sq <= floor_sq {
            break;
        }
        let squares = (0..size).map(|row| entry(&rest, row, column).norm_sqr());
        let row = first_largest(squares).1;
        let inverse = entry(&rest, row, column).inv();
        for (own, part) in left.iter_mut().zip(&rest) {
            own.extend_from_slice(&part.as_slice()[column * size..(column + 1) * size]);
        }
        let own = rank * size..(rank + 1) * size;
        for (j, largest) in largest.iter_mut().enumerate() {
            let share = entry(&rest, row, j) * inverse;
            if share != c64::default() {
                take_off(&mut rest, j, (&left[0][own.clone()], &left[1][own.clone()]), share);
                *largest = largest_sq(&rest, j);
            }
            right[0].push(share.re);
            right[1].push(share.im);
        }
        rank += 1;
    }
    (left, right)
}

fn entry([re, im]: &Parts, row: usize, column: usize) -> c64 {
    c64::new(re[(row, column)], im[(row, column)])
}

/// Squared modulus of the largest entry of a column.
#[inline(always)]
fn largest_sq([re, im]: &Parts, column: usize) -> f64 {
    let own = column * re.nrows()..(column + 1) * re.nrows();
    let (re, im) = (re.as_slice()[own.clone()].chunks(AT_ONCE), im.as_slice()[own].chunks(AT_ONCE));
    let larger = |most: f64, own: f64| if own > most { own } else { most };
    // Some at once: each comparison would wait for the one before.
    let mut most = [0.0; AT_ONCE];
    for (re, im) in re.zip(im) {
        let squares = re.iter().zip(im).map(|(re, im)| re * re + im * im);
        most.iter_mut().zip(squares).for_each(|(most, own)| *most = larger(*most, own));
    }
    most.into_iter().fold(0.0, larger)
}

/// So many entries of a column are compared at once.
const AT_ONCE: usize = 8;

/// The largest value and where it first stands.
fn first_largest(values: impl Iterator<Item = f64>) -> (f64, usize) {
    let larger =
        |most: (f64, usize), (place, own): (usize, f64)| if own > most.0 { (own, place) } else { most };
    values.enumerate().fold((0.0, 0), larger)
}

/// Takes `share` times another column off a column.
#[inline(always)]
fn take_off([re, im]: &mut Parts, column: usize, (own_re, own_im): (&[f64], &[f64]), share: c64) {
    let own = column * own_re.len()..(column + 1) * own_re.len();
    let left = re.as_mut_slice()[own.clone()].iter_mut().zip(&mut im.as_mut_slice()[own]);
    for ((re, im), (a, b)) in left.zip(own_re.iter().zip(own_im)) {
        *re -= a * share.re - b * share.im;
        *im -= a * share.im + b * share.re;
    }
}

impl Compliance {
    /// The problem with other springs for `path` and other terms and weights of the rows on it: `rows` are terms and weights
    /// of those given, all others as they are. It is solved with [`PathResponse::factor`](crate::PathResponse::factor), and cannot be factored by
    /// itself: it knows no terms. `None` where it has other unknowns, or motions are free. `before`: a problem that may have had
    /// the same springs and terms, whose moments are taken over. Cost: by the points and rows of the path.
    pub fn with_path<'a>(
        &self,
        path: usize,
        springs: Arc<SpringPath>,
        rows: impl Iterator<Item = (&'a [(usize, usize, c64)], Option<f64>)>,
        before: Option<&Self>,
    ) -> Option<Self> {
        let own = self.first_pieces[path]..self.first_pieces[path + 1];
        let first_joint = self.given + 2 * (own.start - path);
        let (mut terms, mut all) = (Vec::new(), Vec::with_capacity(self.rows.len()));
        for (index, (row, weight)) in rows.enumerate() {
            let own = row.iter().filter(|term| term.0 == path);
            terms.extend(own.map(|(_, point, value)| (index, *point, *value)));
            all.push(PointRow { terms: Vec::new(), weight });
        }
        if !self.free.is_empty() || all.len() != self.given {
            return None;
        }
        let joined = self.rows[self.given..].iter().map(|row| row.weight);
        all.extend(joined.map(|weight| PointRow { terms: Vec::new(), weight }));
        let (pieces, _) = cut_path((path, &springs), terms, first_joint);
        if pieces.len() != own.len() {
            return None;
        }
        let mut loads = self.loads.clone();
        let same_pieces = |before: &&Self| {
            before.first_pieces == self.first_pieces && Arc::ptr_eq(&before.paths[path], &springs)
        };
        let before = before.filter(same_pieces);
        for (piece, index) in pieces.iter().zip(own) {
            let same = |known: &&Arc<PathLoads>| known.is_of(&piece.own, &piece.terms);
            let known = before.and_then(|before| before.loads.get(index)).filter(same).cloned();
            let known =
                known.unwrap_or_else(|| Arc::new(PathLoads::new(&*springs, piece.own.clone(), &piece.terms)));
            let motions = self.layout.similarities[index + 1] - self.layout.similarities[index];
            if known.motions() != motions || !known.is_finite() {
                return None;
            }
            loads[index] = known;
        }
        let mut paths = self.paths.clone();
        paths[path] = springs;
        Some(self.like(paths, all, loads))
    }
}
