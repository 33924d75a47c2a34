//! Networks of evenly stepping tracks, condensed to the points that rows touch.
//!
//! Track k has points `t_0, t_1, …` and a spring `t_{i+1} − t_i = step` between neighbours; [`PointRow`]s tie points of any
//! tracks. Between two neighbouring touched points, the *knots* a < b, steps are even at the optimum, and all n = b − a
//! springs are worth one,
//!
//! ```text
//!     min ½ Σ_{a ≤ i < b} (t_{i+1} − t_i − step)²  =  ½ ((t_b − t_a − n·step)/√n)²,
//! ```
//!
//! as springs in series (or resistors) are; before the first knot and after the last one steps are as at rest, at no
//! energy. So the size of the system is the number of rows, whatever the number of points. Unknowns are the *delays*
//! `t_i − i·step` of the knots: a network at rest is solved without rounding, and energies of small warps keep their
//! digits.
//!
//! A network is the problem, to be analysed, factored and solved like any other:
//!
//! ```
//! use cotillion_solvers::{KktForm, Knots, Network, PointRow, Track, analyse};
//!
//! // 101 points, 1 s apart at rest; the first stays at 0, the last is wanted at 120 s.
//! let rows = [PointRow::hard(vec![(0, 0, 1.0)]), PointRow::hard(vec![(0, 100, 1.0)])];
//! let network = Network::new(&[Track { points: 101, tail: 0.0 }], 1.0, &rows, Knots::Touched)?;
//! let factor = analyse(&network.problem, KktForm::Hachtel)?.factor(&network.problem)?;
//! let (mut m, mut h) = network.targets();
//! network.write_targets(&[0.0, 120.0], &mut m, &mut h);
//! let solution = factor.solve(&m, &h)?;
//! let mut times = [vec![0.0; 101]];
//! network.expand(&solution.x, &mut times);
//! assert!((times[0][50] - 60.0).abs() < 1e-12);
//! assert!((network.energy(&solution.x, &m).springs - 0.5 * 100.0 * 0.2 * 0.2).abs() < 1e-12);
//! # Ok::<(), cotillion_solvers::KktError>(())
//! ```
//!
//! Source of the rows: Kim, Hyun, Kim, Lee, *Synchronized Multi-Character Motion Editing*, SIGGRAPH 2009, §4.3.

use crate::augmented::{check_values, row_residuals};
use crate::error::KktError;
use crate::least_squares::LeastSquares;
use crate::points::PointRow;
use crate::rank::{Dependency, analyse_rank};
use crate::sparse::RowMatrix;

/// Sums of a row's coefficients on a track below this, relative to the row's largest, are rounding: it sees differences
/// of the track's times only.
const ROUNDING: f64 = 1e-12;

/// One sequence of points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Track {
    /// Number of points.
    pub points: usize,
    /// The last step weighs `1 + tail`, for a track that ends so many steps beyond its last point; not negative.
    pub tail: f64,
}

/// Which points are unknowns.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Knots<'a> {
    /// Those that rows touch, a track's first where none does, and both sides of a last step that weighs more.
    #[default]
    Touched,
    /// All: the full system, to compare with.
    All,
    /// Those touched and these: track, point.
    Besides(&'a [(usize, usize)]),
}

/// The springs between two neighbouring knots of a track.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Piece {
    /// Unknown of the earlier knot; that of the later one follows it.
    pub from: usize,
    /// Number of steps.
    pub steps: usize,
    /// Weight of each step.
    pub weight: f64,
}

/// `½‖M x − m‖²`, by kinds of rows.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct NetworkEnergy {
    /// Springs.
    pub springs: f64,
    /// Soft rows.
    pub rows: f64,
}

/// A condensed network.
#[derive(Clone, Debug)]
pub struct Network {
    /// Unknowns: delays of the knots, by track and point. Soft rows: pieces, then the soft rows given, in their order.
    /// Hard rows: the independent ones of those given, in their order, then one that keeps the first knot at rest for
    /// every motion of whole tracks that no row sees.
    pub problem: LeastSquares<f64>,
    /// The hard rows left out, each with the rows it follows from; numbered as given.
    pub dependent: Vec<Dependency<f64>>,
    /// Hard rows of the problem, numbered as given; gauge rows left out.
    pub kept: Vec<usize>,
    /// Pieces, in the order of their soft rows.
    pub pieces: Vec<Piece>,
    /// Seconds, or what times are measured in, between points at rest.
    pub step: f64,
    knots: KnotList,
    soft: Vec<SoftRow>,
    /// Value of each row at rest.
    rests: Vec<f64>,
}

/// A soft row as given, and the root of its weight.
#[derive(Clone, Copy, Debug)]
struct SoftRow {
    given: usize,
    root: f64,
}

impl Network {
    /// Condenses tracks of points `step` apart with rows on them.
    ///
    /// Cost: linear in points for [`Knots::All`]; else n log n in the terms of the rows, and linear in tracks. Ranks as
    /// [`analyse_rank`].
    ///
    /// # Errors
    /// [`KktError::NotFinite`] for a coefficient that is infinite or not a number, or a weight that is or is negative; its row
    /// is counted among the soft rows of the problem (`M`) or the hard rows given (`H`).
    ///
    /// # Panics
    /// If a row names a point that does not exist.
    pub fn new(tracks: &[Track], step: f64, rows: &[PointRow<f64>], knots: Knots) -> Result<Self, KktError> {
        for (track, point, _) in rows.iter().flat_map(|row| &row.terms) {
            let points = tracks[*track].points;
            assert!(*point < points, "point {point} of a track of {points}");
        }
        let list = KnotList::new(tracks, rows, knots);
        let pieces = list.pieces(tracks);
        let columns = list.points.len();
        let (hard, soft): (Vec<usize>, Vec<usize>) =
            (0..rows.len()).partition(|row| rows[*row].weight.is_none());
        let soft: Vec<SoftRow> = soft
            .into_iter()
            .map(|given| SoftRow { given, root: rows[given].weight.unwrap_or(1.0).sqrt() })
            .collect();
        let soft_matrix = soft_matrix(&list, &pieces, rows, &soft).to_csr();
        check_values("M", &soft_matrix)?;
        let HardRows { matrix, kept, dependent } = independent_rows(&list, rows, &hard)?;
        let hard_matrix = with_gauge(matrix, &list, tracks.len(), rows);
        let rest =
            |row: &PointRow<f64>| row.terms.iter().map(|(_, point, a)| a * (*point as f64 * step)).sum();
        Ok(Self {
            problem: LeastSquares { columns, soft: soft_matrix, hard: hard_matrix.to_csr() },
            dependent,
            kept,
            pieces,
            step,
            knots: list,
            soft,
            rests: rows.iter().map(rest).collect(),
        })
    }

    /// Targets `m`, `h` of a network at rest, as long as [`problem`](Self::problem) has rows: memory for
    /// [`write_targets`](Self::write_targets).
    pub fn targets(&self) -> (Vec<f64>, Vec<f64>) {
        (vec![0.0; self.problem.soft.rows()], vec![0.0; self.problem.hard.rows()])
    }

    /// Writes the right-hand sides of the problem. `targets`: one for each row given; `m`, `h`: from
    /// [`targets`](Self::targets).
    ///
    /// # Panics
    /// If a slice is too short.
    pub fn write_targets(&self, targets: &[f64], m: &mut [f64], h: &mut [f64]) {
        let delay = |given: usize| targets[given] - self.rests[given];
        for (m, SoftRow { given, root }) in m[self.pieces.len()..].iter_mut().zip(&self.soft) {
            *m = root * delay(*given);
        }
        for (h, given) in h.iter_mut().zip(&self.kept) {
            *h = delay(*given);
        }
    }

    /// Times of all points from the delays of the knots. `x`: one per unknown; `times`: one list per track, as long as it
    /// has points. Cost: linear in points.
    pub fn expand(&self, x: &[f64], times: &mut [Vec<f64>]) {
        for (track, times) in times.iter_mut().enumerate() {
            let unknowns = self.knots.starts[track]..self.knots.starts[track + 1];
            let (knots, delays) = (&self.knots.points[unknowns.clone()], &x[unknowns]);
            spread(knots, delays, self.step, times);
        }
    }

    /// Energies of a solution. `x`: delays of the knots, `m`: targets of the soft rows.
    pub fn energy(&self, x: &[f64], m: &[f64]) -> NetworkEnergy {
        let mut squares = row_residuals(&self.problem.soft, x, m).map(|r| r * r);
        let springs = 0.5 * squares.by_ref().take(self.pieces.len()).sum::<f64>();
        NetworkEnergy { springs, rows: 0.5 * squares.sum::<f64>() }
    }

    /// Track and point of an unknown.
    ///
    /// # Panics
    /// If there is no such unknown.
    pub fn place(&self, unknown: usize) -> (usize, usize) {
        (self.knots.starts.partition_point(|start| *start <= unknown) - 1, self.knots.points[unknown])
    }

    /// Points of a track that are unknowns, rising, and the unknown of the first.
    ///
    /// # Panics
    /// If there is no such track.
    pub fn knots(&self, track: usize) -> (usize, &[usize]) {
        let first = self.knots.starts[track];
        (first, &self.knots.points[first..self.knots.starts[track + 1]])
    }

    /// How much longer than at rest the steps of a piece are.
    pub fn lengthening(&self, piece: &Piece, x: &[f64]) -> f64 {
        (x[piece.from + 1] - x[piece.from]) / piece.steps as f64
    }
}

/// Points that are unknowns, by track.
#[derive(Clone, Debug)]
struct KnotList {
    /// Points of all tracks, each track's rising.
    points: Vec<usize>,
    /// Where each track's begin, and the end of the last.
    starts: Vec<usize>,
}

impl KnotList {
    fn new(tracks: &[Track], rows: &[PointRow<f64>], knots: Knots) -> Self {
        let mut touched: Vec<(usize, usize)> = match knots {
            Knots::Touched => needed(tracks, rows),
            Knots::All => tracks
                .iter()
                .enumerate()
                .flat_map(|(track, own)| (0..own.points).map(move |point| (track, point)))
                .collect(),
            Knots::Besides(others) => [needed(tracks, rows), others.to_vec()].concat(),
        };
        touched.sort_unstable();
        touched.dedup();
        let starts = (0..=tracks.len()).map(|track| touched.partition_point(|knot| knot.0 < track)).collect();
        Self { points: touched.into_iter().map(|(_, point)| point).collect(), starts }
    }

    /// Unknown of a knot.
    fn column(&self, track: usize, point: usize) -> usize {
        let start = self.starts[track];
        let place = self.points[start..self.starts[track + 1]].binary_search(&point);
        start + place.expect("every point that a row touches is a knot")
    }

    fn terms(&self, row: &PointRow<f64>, factor: f64) -> Vec<(usize, f64)> {
        row.terms.iter().map(|(track, point, a)| (self.column(*track, *point), factor * a)).collect()
    }

    fn pieces(&self, tracks: &[Track]) -> Vec<Piece> {
        let mut pieces = Vec::with_capacity(self.points.len());
        for (track, ends) in tracks.iter().zip(self.starts.windows(2)) {
            for from in ends[0]..ends[1].saturating_sub(1) {
                let (a, b) = (self.points[from], self.points[from + 1]);
                let weight = if b + 1 == track.points { 1.0 + track.tail } else { 1.0 };
                pieces.push(Piece { from, steps: b - a, weight });
            }
        }
        pieces
    }
}

/// Touched points, and those without which a track would have none, or a piece steps of two weights.
fn needed(tracks: &[Track], rows: &[PointRow<f64>]) -> Vec<(usize, usize)> {
    let mut knots = Vec::new();
    let mut is_touched = vec![false; tracks.len()];
    for (track, point, _) in rows.iter().flat_map(|row| &row.terms) {
        is_touched[*track] = true;
        knots.push((*track, *point));
    }
    for (track, own) in tracks.iter().enumerate() {
        knots.extend((!is_touched[track] && own.points > 0).then_some((track, 0)));
        if own.tail > 0.0 && own.points > 1 {
            knots.extend([(track, own.points - 2), (track, own.points - 1)]);
        }
    }
    knots
}

fn soft_matrix(
    list: &KnotList,
    pieces: &[Piece],
    rows: &[PointRow<f64>],
    soft: &[SoftRow],
) -> RowMatrix<f64> {
    let mut matrix = RowMatrix::new(list.points.len());
    for Piece { from, steps, weight } in pieces {
        let root = (weight / *steps as f64).sqrt();
        matrix.push_row(&[(*from, -root), (from + 1, root)]);
    }
    for SoftRow { given, root } in soft {
        matrix.push_row(&list.terms(&rows[*given], *root));
    }
    matrix
}

/// Rows of `H`, numbered as given, and how the hard rows left out depend on them.
struct HardRows {
    matrix: RowMatrix<f64>,
    kept: Vec<usize>,
    dependent: Vec<Dependency<f64>>,
}

fn independent_rows(list: &KnotList, rows: &[PointRow<f64>], hard: &[usize]) -> Result<HardRows, KktError> {
    let matrix = |chosen: &[usize]| {
        let mut matrix = RowMatrix::new(list.points.len());
        chosen.iter().for_each(|row| {
            matrix.push_row(&list.terms(&rows[*row], 1.0));
        });
        matrix
    };
    let all = matrix(hard).to_csr();
    check_values("H", &all)?;
    let rank = analyse_rank(&all);
    let as_given = |dependency: Dependency<f64>| Dependency {
        row: hard[dependency.row],
        combination: dependency.combination.into_iter().map(|(row, y)| (hard[row], y)).collect(),
    };
    let kept: Vec<usize> = rank.independent.into_iter().map(|row| hard[row]).collect();
    let dependent = rank.dependent.into_iter().map(as_given).collect();
    Ok(HardRows { matrix: matrix(&kept), kept, dependent })
}

/// Adds a row for every motion of whole tracks that no row sees: it keeps the first knot of the first track that takes
/// part where it is at rest. Such a row is no force, and so does not depend on the others.
fn with_gauge(
    mut hard: RowMatrix<f64>,
    list: &KnotList,
    track_count: usize,
    rows: &[PointRow<f64>],
) -> RowMatrix<f64> {
    let mut seen: Vec<Vec<(usize, f64)>> = vec![Vec::new(); track_count];
    for (index, row) in rows.iter().enumerate() {
        let least = ROUNDING * row.terms.iter().map(|(_, _, a)| a.abs()).fold(0.0, f64::max);
        let mut terms = row.terms.clone();
        terms.sort_unstable_by_key(|(track, _, _)| *track);
        for own in terms.chunk_by(|a, b| a.0 == b.0) {
            let sum: f64 = own.iter().map(|(_, _, a)| a).sum();
            if sum.abs() > least {
                seen[own[0].0].push((index, sum));
            }
        }
    }
    // Rank analysis finds the last of dependent rows; the first track is to stay, so it comes last.
    let mut by_track = RowMatrix::new(rows.len());
    seen.iter().rev().for_each(|own| {
        by_track.push_row(own);
    });
    for dependency in analyse_rank(&by_track.to_csr()).dependent.iter().rev() {
        let track = track_count - 1 - dependency.row;
        if list.starts[track] < list.starts[track + 1] {
            hard.push_row(&[(list.starts[track], 1.0)]);
        }
    }
    hard
}

/// Delays between knots are evenly spaced; before the first and after the last knot they stay the same.
fn spread(knots: &[usize], delays: &[f64], step: f64, times: &mut [f64]) {
    let (Some(&first), Some(&last)) = (knots.first(), knots.last()) else { return };
    let (before, after) = (delays[0], delays[delays.len() - 1]);
    let at = |point: usize, delay: f64| point as f64 * step + delay;
    (0..first).for_each(|point| times[point] = at(point, before));
    for (knots, delays) in knots.windows(2).zip(delays.windows(2)) {
        let slope = (delays[1] - delays[0]) / (knots[1] - knots[0]) as f64;
        for (n, time) in times[knots[0]..knots[1]].iter_mut().enumerate() {
            *time = at(knots[0] + n, delays[0] + n as f64 * slope);
        }
    }
    (last..times.len()).for_each(|point| times[point] = at(point, after));
}
