//! Of many pairs of frames along the ridges of similarity, a few that are spaced evenly.

use crate::index::floor_index;

/// A pair of frames that is more alike than its neighbours.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Pair {
    /// Row of the distance matrix.
    pub row: usize,
    /// Column of the distance matrix.
    pub column: usize,
    /// D of the two.
    pub distance: f64,
}

/// Accepted pairs on one diagonal, or on adjacent ones, are farther apart than this, frames.
const WITHIN: isize = 5;
/// Rows by which two pairs that exclude each other differ at most.
const REACH: usize = 5;
/// Distances are compared in steps of this: what lies below is what rounding leaves of equal poses.
const EQUAL: f64 = 1e-9;

/// Accepts pairs from the most alike on, each unless an accepted one lies within five frames along its own diagonal of the
/// matrix or an adjacent one (a motion of period T keeps one pair in six frames on every diagonal j − i = mT); ties go to the smaller row, then column. Takes rows in bands and keeps only those that are not
/// settled yet: the result is the same as with all at once.
pub(super) struct Thinning {
    columns: usize,
    /// First row of `states`.
    base: usize,
    /// Of every pair since row `base`.
    states: Vec<State>,
    /// Pairs that wait for later rows, or for a better pair that does.
    waiting: Vec<Pair>,
    /// Accepted so far, in no order of rows.
    pub accepted: Vec<Pair>,
}

#[derive(Clone, Copy, PartialEq)]
enum State {
    Free,
    Waiting,
    Accepted,
}

impl Thinning {
    /// For a matrix of so many columns.
    pub(super) fn new(columns: usize) -> Self {
        Self { columns, base: 0, states: Vec::new(), waiting: Vec::new(), accepted: Vec::new() }
    }

    /// Adds all pairs of the rows up to `end`, and settles what they settle: everything, if `end` is the last.
    pub(super) fn add_band(&mut self, pairs: Vec<Pair>, end: usize, is_last: bool) {
        let earliest = self.waiting.iter().chain(&pairs).map(|pair| pair.row).min().unwrap_or(end);
        self.keep_rows(earliest.min(end).saturating_sub(REACH), end);
        let mut open = std::mem::take(&mut self.waiting);
        for pair in &open {
            self.states[(pair.row - self.base) * self.columns + pair.column] = State::Free;
        }
        open.extend(pairs);
        open.sort_unstable_by_key(key);
        for pair in open {
            let known = is_last || pair.row + REACH < end;
            let state = match self.strongest_neighbour(&pair) {
                State::Accepted => continue,
                State::Free if known => State::Accepted,
                _ => State::Waiting,
            };
            self.states[(pair.row - self.base) * self.columns + pair.column] = state;
            let settled = state == State::Accepted;
            if settled { &mut self.accepted } else { &mut self.waiting }.push(pair);
        }
    }

    /// Keeps states from row `base` on, or from where they start, and makes room up to row `end`.
    fn keep_rows(&mut self, base: usize, end: usize) {
        let base = base.max(self.base);
        let gone = ((base - self.base) * self.columns).min(self.states.len());
        self.states.drain(..gone);
        self.base = base;
        self.states.resize((end - base) * self.columns, State::Free);
    }

    /// Whether pairs that exclude `pair` are accepted already, or wait.
    fn strongest_neighbour(&self, pair: &Pair) -> State {
        let mut found = State::Free;
        for (down, right) in excluded() {
            let place =
                (pair.row - self.base).checked_add_signed(down).zip(pair.column.checked_add_signed(right));
            let Some((row, column)) = place.filter(|(_, column)| *column < self.columns) else { continue };
            match self.states.get(row * self.columns + column) {
                Some(State::Accepted) => return State::Accepted,
                Some(State::Waiting) => found = State::Waiting,
                _ => {}
            }
        }
        found
    }
}

/// Rows and columns from a pair to those that it excludes.
fn excluded() -> impl Iterator<Item = (isize, isize)> {
    let along = |down: isize| (down - 1..=down + 1).map(move |right| (down, right));
    // Halfway between rows and columns, so that a matrix and its transpose keep the same pairs.
    let is_near = |(down, right): &(isize, isize)| (down + right).abs() <= 2 * WITHIN;
    (-WITHIN..=WITHIN).flat_map(along).filter(is_near).filter(|step| *step != (0, 0))
}

/// Order in which pairs are visited.
fn key(pair: &Pair) -> (usize, usize, usize) {
    (floor_index((pair.distance / EQUAL).round()), pair.row, pair.column)
}
