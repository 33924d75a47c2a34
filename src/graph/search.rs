//! Finds the pairs of frames of two clips that are more alike than their neighbours, tile by tile of the distance matrix.

use std::ops::Range;

use cotillion_solvers::DMatrix;
use rayon::prelude::*;

use super::contact::Feet;
use super::matrix::Factors;
use super::thinning::{Pair, Thinning};
use super::{GraphSettings, Maxima};
use crate::similarity::{Features, NEIGHBOURS};

/// Rows and columns of a tile: its distances stay in the processor's cache.
pub(super) const TILE: (usize, usize) = (128, 256);

/// A clip as the search sees it.
pub(super) struct Side {
    /// Its features.
    pub features: Features,
    /// The same, ready for products.
    pub factors: Factors,
    /// What its feet do.
    pub feet: Feet,
}

/// Distance matrix of two clips of one body, or of a clip with itself.
pub(super) struct Block<'a> {
    /// Clip of the rows.
    pub rows: &'a Side,
    /// Clip of the columns.
    pub columns: &'a Side,
    /// Both are the same clip: only columns after the rows count.
    pub is_diagonal: bool,
    /// Pairs count up to this D².
    pub largest_sq: f64,
    /// Which pairs are kept.
    pub settings: GraphSettings,
    /// Rows and columns of a tile; the pairs do not depend on it.
    pub tile: (usize, usize),
}

/// Steps from a pair to its six neighbours off its own diagonal.
const OFF_DIAGONAL: [(isize, isize); 6] = [(-1, 0), (1, 0), (0, -1), (0, 1), (-1, 1), (1, -1)];
/// Steps to all eight neighbours, the lexicographically smaller ones first.
const ALL: [(isize, isize); 8] = [(-1, -1), (-1, 0), (-1, 1), (0, -1), (0, 1), (1, -1), (1, 0), (1, 1)];

impl Block<'_> {
    /// Pairs that are kept, in no order. The matrix is seen a band of rows at a time and never held.
    pub(super) fn pairs(&self) -> Vec<Pair> {
        let rows = frames(self.rows);
        let mut strict = Vec::new();
        let mut thinning = Thinning::new(frames(self.columns));
        for start in (0..rows).step_by(self.tile.0) {
            let end = (start + self.tile.0).min(rows);
            let found = self.band(start..end);
            match self.settings.maxima {
                Maxima::Ridge => thinning.add_band(found, end, end == rows),
                Maxima::Strict8 => strict.extend(found),
            }
        }
        strict.append(&mut thinning.accepted);
        strict
    }

    /// Local maxima of similarity in some rows.
    fn band(&self, rows: Range<usize>) -> Vec<Pair> {
        let first = if self.is_diagonal { rows.start + NEIGHBOURS } else { 0 };
        let starts: Vec<usize> = (first..frames(self.columns)).step_by(self.tile.1).collect();
        let tiles = starts.into_par_iter().map(|start| {
            let columns = start..(start + self.tile.1).min(frames(self.columns));
            self.maxima(&rows, &columns)
        });
        tiles.collect::<Vec<_>>().concat()
    }

    /// Local maxima of similarity in one tile.
    fn maxima(&self, rows: &Range<usize>, columns: &Range<usize>) -> Vec<Pair> {
        let tile = Tile {
            block: self,
            rounding: self.rows.factors.rounding(&self.columns.factors),
            origin: (rows.start.saturating_sub(1), columns.start.saturating_sub(1)),
            nearly: self.rows.factors.distances_sq(
                with_edges(rows, frames(self.rows)),
                &self.columns.factors,
                with_edges(columns, frames(self.columns)),
            ),
        };
        let limit = self.largest_sq + tile.rounding;
        let mut found = Vec::new();
        for column in columns.clone() {
            let end = if self.is_diagonal {
                rows.end.min((column + 1).saturating_sub(NEIGHBOURS))
            } else {
                rows.end
            };
            let values = tile.nearly.column(column - tile.origin.1);
            for row in rows.start..end {
                if values[row - tile.origin.0] < limit {
                    found.extend(tile.maximum(row, column));
                }
            }
        }
        found
    }

    /// D² of a pair, the same bits whoever asks.
    fn distance_sq(&self, (row, column): (usize, usize)) -> f64 {
        self.rows.features.distance_sq(row, &self.columns.features, column)
    }
}

/// A part of the distance matrix with its neighbours on all sides.
struct Tile<'a> {
    block: &'a Block<'a>,
    /// D² to rounding.
    nearly: DMatrix<f64>,
    /// Row and column of the first entry.
    origin: (usize, usize),
    /// By how much an entry may be off.
    rounding: f64,
}

impl Tile<'_> {
    /// The pair, if it is kept. What rounding of the product leaves open, the sum of squares decides: the answer does not depend
    /// on tiles, threads or the processor.
    fn maximum(&self, row: usize, column: usize) -> Option<Pair> {
        let block = self.block;
        let steps: &[(isize, isize)] = match block.settings.maxima {
            Maxima::Ridge => &OFF_DIAGONAL,
            Maxima::Strict8 => &ALL,
        };
        let here = self.nearly[(row - self.origin.0, column - self.origin.1)];
        let at = |(down, right): (isize, isize)| {
            let place = row.checked_add_signed(down).zip(column.checked_add_signed(right));
            place.filter(|(row, column)| *row < frames(block.rows) && *column < frames(block.columns))
        };
        let near = |(row, column): (usize, usize)| self.nearly[(row - self.origin.0, column - self.origin.1)];
        if steps.iter().filter_map(|step| at(*step)).any(|place| near(place) < here - 2.0 * self.rounding) {
            return None;
        }
        let exact = block.distance_sq((row, column));
        let is_open = |place| near(place) <= here + 2.0 * self.rounding;
        let is_beaten = |step: &(isize, isize)| {
            at(*step).filter(|place| is_open(*place)).is_some_and(|place| {
                let other = block.distance_sq(place);
                // Of a plateau the strict rule keeps one: smaller pairs must be less alike.
                other < exact
                    || (other == exact && block.settings.maxima == Maxima::Strict8 && *step < (0, 0))
            })
        };
        let is_kept = exact < block.largest_sq
            && block.rows.feet.agree(row, &block.columns.feet, column, block.settings.contact_tolerance)
            && !steps.iter().any(is_beaten);
        is_kept.then(|| Pair { row, column, distance: exact.sqrt() })
    }
}

fn frames(side: &Side) -> usize {
    side.features.values.len() / side.features.width
}

/// The range and one more on each side, where there is one.
fn with_edges(range: &Range<usize>, count: usize) -> Range<usize> {
    range.start.saturating_sub(1)..(range.end + 1).min(count)
}
