//! One piece of a path of the compliance form: the points that rows touch, the moments of the springs between them, and
//! what each pair of rows shares. Mathematics: [`compliance`](crate::compliance), [`springs`](crate::springs).
//!
//! A piece owns a range of points. Where another piece goes before, it also knows the last point of that, where one follows
//! the first of that: rows of the problem keep both pieces together there. A spring belongs to the piece that owns its point.

use std::ops::Range;

use crate::c64;
use crate::scalar::TwoPart;
use crate::splice::SplicedPath;
use crate::springs::{Answer, Load, Moments, SpringPath, State};

/// A chain of springs, as far as the compliance form sees it.
pub(crate) trait Chain {
    /// Rest point `q_j`.
    fn point(&self, j: usize) -> c64;
    /// Moments of the springs `from ≤ s < to`.
    fn moments(&self, from: usize, to: usize) -> Moments;
    /// Some centre of the rest points `range`, and how far they reach from it.
    fn spread(&self, range: Range<usize>) -> (c64, f64);
}

impl Chain for SpringPath {
    fn point(&self, j: usize) -> c64 {
        Self::point(self, j)
    }

    fn moments(&self, from: usize, to: usize) -> Moments {
        Self::moments(self, from, to)
    }

    fn spread(&self, range: Range<usize>) -> (c64, f64) {
        Self::spread(self, range)
    }
}

impl Chain for SplicedPath<'_> {
    fn point(&self, j: usize) -> c64 {
        Self::point(self, j)
    }

    fn moments(&self, from: usize, to: usize) -> Moments {
        Self::moments(self, from, to)
    }

    /// About the first point, by the ends and the middle: what a path is measured by does not matter to its energy.
    fn spread(&self, range: Range<usize>) -> (c64, f64) {
        let centre = self.point(range.start);
        let reach = |j: usize| (self.point(j) - centre).norm();
        let farthest = reach(range.end - 1).max(reach((range.start + range.end) / 2));
        (centre, farthest * (range.len() as f64).sqrt())
    }
}

/// Rest points closer together than this, relative to their distance from the origin, have no extent.
const COINCIDENT: f64 = 1e-9;

/// A piece of a path with the rows on it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct PathLoads {
    /// Points that belong to this piece.
    pub(crate) own: Range<usize>,
    /// Terms as they were given: row, point, coefficient.
    given: Vec<(usize, usize, c64)>,
    /// Points that rows touch, rising.
    pub(crate) nodes: Vec<usize>,
    /// Moments of the piece's springs from the node before, or from its first point, up to each node.
    pub(crate) moments: Vec<Moments>,
    rows: Vec<RowTerms>,
    /// Node (by position in `nodes`) and coefficient; of one row, nodes rise.
    terms: Vec<(usize, c64)>,
    first: c64,
    centre: c64,
    /// Root of the summed squared distances of its points from the centre; where they are one point, of those it knows; 0
    /// without extent.
    radius: f64,
    /// Covariances of each row with itself and all rows after it.
    covariances: Vec<c64>,
    /// Row, motion (0: shift, 1: about the centre), what the row sees of it.
    seen: Vec<(usize, usize, c64)>,
    finite: bool,
}

/// Terms of one row on one path.
#[derive(Clone, Debug, PartialEq)]
struct RowTerms {
    row: usize,
    terms: Range<usize>,
    /// Nodes of the first and last term.
    nodes: (usize, usize),
}

impl PathLoads {
    /// `own`: points of the piece; those before and after it are not its own, but rows may name the nearest of them.
    /// `terms`: row, point, coefficient; rows rise.
    pub(crate) fn new(path: &impl Chain, own: Range<usize>, terms: &[(usize, usize, c64)]) -> Self {
        let mut nodes: Vec<usize> = terms.iter().map(|(_, point, _)| *point).collect();
        nodes.sort_unstable();
        nodes.dedup();
        let first = own.start.min(nodes.first().copied().unwrap_or(own.start));
        let starts = std::iter::once(first).chain(nodes.iter().copied());
        let moments = starts.zip(&nodes).map(|(from, to)| own_moments(path, &own, from, *to)).collect();
        let known = first..own.end.max(nodes.last().map_or(0, |last| last + 1));
        let (centre, radius) = extent(path, &own, known);
        let mut loads = Self {
            own,
            given: terms.to_vec(),
            nodes,
            moments,
            rows: Vec::new(),
            terms: Vec::new(),
            first: path.point(first),
            centre,
            radius,
            covariances: Vec::new(),
            seen: Vec::new(),
            finite: false,
        };
        loads.take_terms(terms);
        loads.find_covariances();
        loads.finite = loads.has_numbers_only();
        loads
    }

    /// Whether it was made of these points and terms, of whichever path.
    pub(crate) fn is_of(&self, own: &Range<usize>, terms: &[(usize, usize, c64)]) -> bool {
        self.own == *own && self.given == terms
    }

    /// Whether rows touch the same points of the same piece.
    pub(crate) fn has_nodes_of(&self, other: &Self) -> bool {
        self.own == other.own && self.nodes == other.nodes
    }

    /// Row and coefficient of each term.
    pub(crate) fn terms(&self) -> impl Iterator<Item = (usize, c64)> + '_ {
        self.given.iter().map(|(row, _, value)| (*row, *value))
    }

    fn take_terms(&mut self, given: &[(usize, usize, c64)]) {
        for of_row in given.chunk_by(|a, b| a.0 == b.0) {
            let start = self.terms.len();
            for (_, point, value) in of_row {
                let node = self.nodes.partition_point(|known| known < point);
                match self.terms[start..].iter_mut().find(|(known, _)| *known == node) {
                    Some((_, sum)) => *sum += value,
                    None => self.terms.push((node, *value)),
                }
            }
            let own = &mut self.terms[start..];
            own.sort_unstable_by_key(|(node, _)| *node);
            let nodes = (own[0].0, own[own.len() - 1].0);
            self.rows.push(RowTerms { row: of_row[0].0, terms: start..self.terms.len(), nodes });
        }
    }

    /// Covariances of all pairs of rows, and what rows see of the similarities.
    fn find_covariances(&mut self) {
        let mut prefix = Vec::with_capacity(self.nodes.len());
        let mut sum = Moments::default();
        for moments in &self.moments {
            sum = sum.then(*moments);
            prefix.push(sum);
        }
        let mut loads = Vec::with_capacity(2 * self.terms.len());
        let mut starts = Vec::with_capacity(self.rows.len() + 1);
        for row in &self.rows {
            starts.push(loads.len());
            self.push_unit_loads(row, &mut loads);
        }
        starts.push(loads.len());
        let of_row = |index: usize| &loads[starts[index]..starts[index + 1]];
        self.covariances.reserve_exact(self.rows.len() * (self.rows.len() + 1) / 2);
        self.seen.reserve_exact(2 * self.rows.len());
        let rows = self.rows.iter().enumerate();
        let answers: Vec<Answer> = rows.map(|(k, row)| self.answer(&prefix, (row, of_row(k)))).collect();
        for (index, row) in self.rows.iter().enumerate() {
            for (other_index, other) in self.rows.iter().enumerate().skip(index) {
                let to = |at: &RowTerms| prefix[at.nodes.0].chord;
                let value = if other.nodes.0 >= row.nodes.1 {
                    answers[index].to(to(other), of_row(other_index)[0])
                } else if row.nodes.0 >= other.nodes.1 {
                    answers[other_index].to(to(row), of_row(index)[0]).conj()
                } else {
                    self.covariance(&prefix, (row, of_row(index)), (other, of_row(other_index)))
                };
                self.covariances.push(value);
            }
            let base = of_row(index)[0];
            let (force, moment) = (base.force.conj(), base.moment.conj());
            self.seen.push((row.row, 0, force / (self.own.len() as f64).sqrt()));
            if self.radius > 0.0 {
                let arm = self.first + prefix[row.nodes.0].chord - self.centre;
                self.seen.push((row.row, 1, (moment + force * arm) / self.radius));
            }
        }
    }

    /// Appends the load of a unit multiplier of `row` about each node from its first to its last.
    fn push_unit_loads(&self, row: &RowTerms, loads: &mut Vec<Load>) {
        let (first, last) = row.nodes;
        let start = loads.len();
        loads.resize(start + last - first + 1, Load::default());
        let mut terms = self.terms[row.terms.clone()].iter().rev().peekable();
        let mut load = Load::default();
        for node in (first..=last).rev() {
            let mu = terms.next_if(|(known, _)| *known == node).map_or(c64::default(), |(_, c)| c.conj());
            let chord = self.moments.get(node + 1).map_or(c64::default(), |after| after.chord);
            load = load.carried(chord, mu);
            loads[start + node - first] = load;
        }
    }

    /// What rows beyond the last node of a row share with it.
    fn answer(&self, prefix: &[Moments], (row, loads): (&RowTerms, &[Load])) -> Answer {
        let first = row.nodes.0;
        let mut answer = Answer { origin: prefix[first].chord, ..Answer::default() };
        for (node, load) in (first..).zip(loads) {
            let moments = if node == first { &prefix[node] } else { &self.moments[node] };
            let (by_force, by_moment) = moments.work_on(*load);
            answer.force += by_force - by_moment * (prefix[node].chord - answer.origin).conj();
            answer.moment += by_moment;
        }
        answer
    }

    /// `Σ c_s F_s(own)·conj(F_s(other))` over all springs: between nodes one by one as far as they differ, the rest at once.
    fn covariance(&self, prefix: &[Moments], own: (&RowTerms, &[Load]), other: (&RowTerms, &[Load])) -> c64 {
        let at = |(row, loads): (&RowTerms, &[Load]), node: usize| {
            let first = row.nodes.0;
            if node >= first {
                return loads[node - first];
            }
            loads[0].carried(prefix[first].chord - prefix[node].chord, c64::default())
        };
        let low = own.0.nodes.0.min(other.0.nodes.0);
        let high = own.0.nodes.1.min(other.0.nodes.1);
        let between = (low + 1..=high).map(|node| self.moments[node].work(at(own, node), at(other, node)));
        prefix[low].work(at(own, low), at(other, low)) + between.sum::<c64>()
    }

    /// True if no entry is infinite or not a number.
    pub(crate) fn is_finite(&self) -> bool {
        self.finite
    }

    fn has_numbers_only(&self) -> bool {
        self.centre.is_finite()
            && self.radius.is_finite()
            && self.covariances.iter().all(|value| value.is_finite())
            && self.seen.iter().all(|(_, _, value)| value.is_finite())
    }

    /// Entries of the system that the piece has, mirrored ones counted.
    pub(crate) fn entries(&self) -> usize {
        2 * (self.covariances.len() + self.seen.len())
    }

    /// Rows on the piece.
    pub(crate) fn rows(&self) -> impl Iterator<Item = usize> + '_ {
        self.rows.iter().map(|row| row.row)
    }

    /// Similarities the path has: 2, or 1 without extent.
    pub(crate) fn motions(&self) -> usize {
        if self.radius > 0.0 { 2 } else { 1 }
    }

    /// Entries of the covariance matrix: row, row not before it, value.
    pub(crate) fn visit_covariances(&self, mut visit: impl FnMut(usize, usize, c64)) {
        self.visit_pairs(|own, other, value| visit(self.rows[own].row, self.rows[other].row, value));
    }

    /// The same by places of the rows among those on the piece.
    pub(crate) fn visit_pairs(&self, mut visit: impl FnMut(usize, usize, c64)) {
        let (count, mut rest) = (self.rows.len(), self.covariances.as_slice());
        for own in 0..count {
            let (values, after) = rest.split_at(count - own);
            (own..count).zip(values).for_each(|(other, value)| visit(own, other, *value));
            rest = after;
        }
    }

    /// Diagonal entries of the covariance matrix.
    pub(crate) fn visit_variances(&self, mut visit: impl FnMut(usize, f64)) {
        let mut place = 0;
        for (own, row) in self.rows.iter().enumerate() {
            visit(row.row, self.covariances[place].re);
            place += self.rows.len() - own;
        }
    }

    /// What rows see of the orthonormal similarities: row, motion, value.
    pub(crate) fn visit_similarities(&self, mut visit: impl FnMut(usize, usize, c64)) {
        self.seen.iter().for_each(|(row, motion, value)| visit(*row, *motion, *value));
    }

    /// Loads about all nodes under the multipliers `lambda` of all rows.
    pub(crate) fn loads_under(&self, lambda: &[TwoPart<c64>], loads: &mut [Load]) {
        loads.fill(Load::default());
        for row in &self.rows {
            for (node, value) in &self.terms[row.terms.clone()] {
                loads[*node].force += value.conj() * lambda[row.row].high;
            }
        }
        let mut load = Load::default();
        for node in (0..loads.len()).rev() {
            let chord = self.moments.get(node + 1).map_or(c64::default(), |after| after.chord);
            load = load.carried(chord, loads[node].force);
            loads[node] = load;
        }
    }

    /// The same, summed to about 32 digits. `mu`: memory, as long as `loads`.
    pub(crate) fn compensated_loads_under(
        &self,
        lambda: &[TwoPart<c64>],
        mu: &mut [TwoPart<c64>],
        loads: &mut [Load],
    ) {
        mu.fill(TwoPart::default());
        for row in &self.rows {
            for (node, value) in &self.terms[row.terms.clone()] {
                mu[*node].add_scaled(lambda[row.row], value.conj());
            }
        }
        let (mut force, mut moment) = (TwoPart::<c64>::default(), TwoPart::<c64>::default());
        for node in (0..loads.len()).rev() {
            let chord = self.moments.get(node + 1).map_or(c64::default(), |after| after.chord);
            moment.add_scaled(force, chord.conj());
            force.add_scaled(mu[node], c64::new(1.0, 0.0));
            loads[node] = Load { force: force.high, moment: moment.high };
        }
    }

    /// First point the piece knows.
    pub(crate) fn first_known(&self) -> usize {
        self.own.start.min(self.nodes.first().copied().unwrap_or(self.own.start))
    }

    /// State of the first point the piece knows under the shares `y` of the similarities, and of all nodes under `loads`.
    /// `see` is told each node's point before and after.
    pub(crate) fn states_under(
        &self,
        y: &[c64; 2],
        loads: &[Load],
        states: &mut [State],
        see: &mut impl FnMut(c64, c64),
    ) -> State {
        let turn = if self.radius > 0.0 { y[1] / self.radius } else { c64::default() };
        let shift = y[0] / (self.own.len() as f64).sqrt();
        let start = State { point: shift + turn * (self.first - self.centre), factor: turn };
        let mut state = start;
        for ((moments, load), own) in self.moments.iter().zip(loads).zip(states) {
            state = state.through(moments, *load);
            see(own.point, state.point);
            *own = state;
        }
        start
    }

    /// Adds what the rows see of the points at the nodes.
    pub(crate) fn add_rows(&self, states: &[State], values: &mut [c64]) {
        for row in &self.rows {
            for (node, value) in &self.terms[row.terms.clone()] {
                values[row.row] += value * states[*node].point;
            }
        }
    }

    /// `½ Σ |δ_s|²/c_s` under these loads.
    pub(crate) fn energy(&self, loads: &[Load]) -> f64 {
        0.5 * self.moments.iter().zip(loads).map(|(moments, load)| moments.work(*load, *load).re).sum::<f64>()
    }

    /// Components of the bent path `points` along the similarities.
    pub(crate) fn components(&self, sum: c64, turned: c64) -> [c64; 2] {
        let turn = if self.radius > 0.0 { turned / self.radius } else { c64::default() };
        [sum / (self.own.len() as f64).sqrt(), turn]
    }

    /// Centre of the rest points.
    pub(crate) fn centre(&self) -> c64 {
        self.centre
    }
}

/// Moments of the springs `from ≤ s < to` that the piece owns.
fn own_moments(path: &impl Chain, own: &Range<usize>, from: usize, to: usize) -> Moments {
    if from >= own.start || from == to {
        return path.moments(from, to);
    }
    let step = path.point(from + 1) - path.point(from);
    Moments::of_spring(0.0, step).then(own_moments(path, own, from + 1, to))
}

/// Centre of a piece's own points, and what its turns are measured by: see [`PathLoads::radius`].
fn extent(path: &impl Chain, own: &Range<usize>, known: Range<usize>) -> (c64, f64) {
    let (centre, spread) = path.spread(own.clone());
    let floor = COINCIDENT * (1.0 + centre.norm()) * (own.len() as f64).sqrt();
    if spread > floor {
        return (centre, spread);
    }
    let beyond = known.map(|j| (path.point(j) - centre).norm_sqr()).sum::<f64>().sqrt();
    (centre, if beyond > floor { beyond } else { 0.0 })
}
