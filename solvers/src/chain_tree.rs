//! Segment tree over the rows of a path: any stretch of rows is condensed in a logarithmic number of compositions.
//!
//! Leaves are pieces of one row, every other node composes its two children. A path spliced from stretches of paths
//! has the rows of these stretches, and new rows where they meet, centred on the two points beside each seam; see
//! [`splice`].

use crate::c64;
use crate::chain::{ChainPiece, ChainRow, check, compose, condense};
use crate::error::KktError;
use std::ops::Range;

/// Condensed pieces of one path.
#[derive(Clone, Debug, PartialEq)]
pub struct ChainTree {
    rows: usize,
    /// Node 1 is the root, `2k` and `2k + 1` are the children of node k, leaves fill the second half; empty pieces
    /// bring the leaves to a power of two.
    nodes: Vec<ChainPiece>,
}

/// Part of a spliced path, in rows.
#[derive(Clone, Debug, PartialEq)]
pub enum SplicePart<'a> {
    /// Rows that some path has already.
    Stretch {
        /// The path.
        tree: &'a ChainTree,
        /// Its rows.
        rows: Range<usize>,
    },
    /// A new row, at a seam.
    Row {
        /// Its coefficients.
        coefficients: ChainRow,
        /// Its target.
        target: c64,
    },
}

impl ChainTree {
    /// Condenses all stretches of a path whose lengths are powers of two, at multiples of their lengths. `targets`:
    /// one per row.
    ///
    /// # Errors
    /// [`KktError::Singular`] if one of these stretches leaves a point free; else as [`condense`](crate::condense).
    pub fn new(rows: &[ChainRow], targets: &[c64]) -> Result<Self, KktError> {
        check(rows, targets)?;
        let leaves = rows.len().next_power_of_two();
        let mut nodes = vec![ChainPiece::default(); 2 * leaves];
        for ((leaf, &row), &target) in nodes[leaves..].iter_mut().zip(rows).zip(targets) {
            *leaf = ChainPiece::of_row(row, target);
        }
        for k in (1..leaves).rev() {
            nodes[k] = compose(&nodes[2 * k], &nodes[2 * k + 1])?;
        }
        Ok(Self { rows: rows.len(), nodes })
    }

    /// Rows of the path, two fewer than its points.
    pub fn row_count(&self) -> usize {
        self.rows
    }

    /// The rows `a..d`, condensed to the pairs of points `(a, a+1)` and `(d, d+1)`.
    ///
    /// Cost: at most `2 log₂ n` compositions.
    ///
    /// # Errors
    /// [`KktError::Singular`] if the rows leave a point free.
    ///
    /// # Panics
    /// If the range ends before it begins or reaches past the last row.
    pub fn piece(&self, rows: Range<usize>) -> Result<ChainPiece, KktError> {
        assert!(rows.start <= rows.end && rows.end <= self.rows, "rows {rows:?} of {}", self.rows);
        let leaves = self.nodes.len() / 2;
        let (mut left, mut right) = (ChainPiece::default(), ChainPiece::default());
        let (mut first, mut end) = (leaves + rows.start, leaves + rows.end);
        while first < end {
            if first % 2 == 1 {
                left = compose(&left, &self.nodes[first])?;
                first += 1;
            }
            if end % 2 == 1 {
                end -= 1;
                right = compose(&self.nodes[end], &right)?;
            }
            (first, end) = (first / 2, end / 2);
        }
        compose(&left, &right)
    }

    /// Replaces one row.
    ///
    /// Cost: `log₂ n` compositions.
    ///
    /// # Errors
    /// As [`new`](Self::new); the tree is then as before.
    ///
    /// # Panics
    /// If there is no such row.
    pub fn replace_row(&mut self, row: usize, coefficients: ChainRow, target: c64) -> Result<(), KktError> {
        assert!(row < self.rows, "row {row} of {}", self.rows);
        check(&[coefficients], &[target])?;
        let mut node = self.nodes.len() / 2 + row;
        let mut changed = vec![(node, ChainPiece::of_row(coefficients, target))];
        let mut piece = changed[0].1;
        while node > 1 {
            let sibling = &self.nodes[node ^ 1];
            piece = if node.is_multiple_of(2) { compose(&piece, sibling) } else { compose(sibling, &piece) }?;
            node /= 2;
            changed.push((node, piece));
        }
        changed.into_iter().for_each(|(node, piece)| self.nodes[node] = piece);
        Ok(())
    }
}

/// Condenses a path put together from parts, in order.
///
/// Where stretches of n and n' points meet, the rows centred on the last point of the one and the first of the other
/// are new: they must be given as parts. The stretches' own rows are as they were, wherever they are moved and turned.
///
/// Cost: logarithmic in each stretch.
///
/// # Errors
/// [`KktError::Singular`] if the rows leave a point free; [`KktError::NotFinite`] for a new row, counted from itself.
///
/// # Panics
/// If a stretch reaches past the rows of its path.
pub fn splice(parts: &[SplicePart<'_>]) -> Result<ChainPiece, KktError> {
    parts.iter().try_fold(ChainPiece::default(), |spliced, part| {
        let piece = match part {
            SplicePart::Stretch { tree, rows } => tree.piece(rows.clone())?,
            &SplicePart::Row { coefficients, target } => condense(&[coefficients], &[target])?,
        };
        compose(&spliced, &piece)
    })
}
