//! Paths with many rows, cut into pieces: dense blocks grow with the square of the rows of a piece, cuts only with their
//! number.

use std::ops::Range;

use crate::c64;
use crate::points::PointRow;
use crate::springs::SpringPath;

/// Paths whose rows touch more points than this are cut, …
const MOST_POINTS: usize = 48;
/// … into pieces of about so many. Measured on one long path: costs are flat from 8 to 24.
const PIECE_POINTS: usize = 16;

/// Points of one path that belong together, with the terms on them.
pub(crate) struct Piece {
    pub(crate) path: usize,
    pub(crate) own: Range<usize>,
    /// Row, point, coefficient; rows rise.
    pub(crate) terms: Vec<(usize, usize, c64)>,
}

/// Pieces of all paths, in order, and the rows with those that hold pieces together: both share the last point of the one
/// and the first of the next.
pub(crate) fn cut_into_pieces(
    paths: &[SpringPath],
    mut rows: Vec<PointRow<c64>>,
) -> (Vec<Piece>, Vec<PointRow<c64>>) {
    let by_path = terms_by_path(paths.len(), &rows);
    let mut pieces = Vec::with_capacity(paths.len());
    for (path, (rest, terms)) in paths.iter().zip(by_path).enumerate() {
        let (own, joints) = cut_path((path, rest), terms, rows.len());
        pieces.extend(own);
        rows.extend(joints);
    }
    (pieces, rows)
}

/// Pieces of one path, and the rows that hold them together, which will be numbered from `first_row`.
/// `terms`: row, point, coefficient; rows rise.
pub(crate) fn cut_path(
    (path, rest): (usize, &SpringPath),
    terms: Vec<(usize, usize, c64)>,
    first_row: usize,
) -> (Vec<Piece>, Vec<PointRow<c64>>) {
    let (mut own, mut start) = (Vec::new(), 0);
    for end in cuts(rest, &terms).into_iter().chain([rest.len()]) {
        own.push(Piece { path, own: start..end, terms: Vec::new() });
        start = end;
    }
    if let [only] = own.as_mut_slice() {
        only.terms = terms;
        return (own, Vec::new());
    }
    for term in terms {
        let piece = own.partition_point(|piece| piece.own.end <= term.1);
        own[piece].terms.push(term);
    }
    let (one, mut joints) = (c64::new(1.0, 0.0), Vec::new());
    for piece in 1..own.len() {
        let cut = own[piece].own.start;
        for point in [cut - 1, cut] {
            let row = first_row + joints.len();
            own[piece - 1].terms.push((row, point, one));
            own[piece].terms.push((row, point, -one));
            joints.push(PointRow::hard(vec![(path, point, one), (path, point, -one)]));
        }
    }
    (own, joints)
}

/// Terms of all rows by path: row, point, coefficient.
fn terms_by_path(paths: usize, rows: &[PointRow<c64>]) -> Vec<Vec<(usize, usize, c64)>> {
    let mut by_path = vec![Vec::new(); paths];
    for (index, row) in rows.iter().enumerate() {
        for (path, point, value) in &row.terms {
            by_path[*path].push((index, *point, *value));
        }
    }
    by_path
}

/// First points of the second and later pieces: in the longest segment between two touched points.
fn cuts(path: &SpringPath, terms: &[(usize, usize, c64)]) -> Vec<usize> {
    if terms.len() <= MOST_POINTS {
        return Vec::new();
    }
    let mut touched: Vec<usize> = terms.iter().map(|(_, point, _)| *point).collect();
    touched.sort_unstable();
    touched.dedup();
    if touched.len() <= MOST_POINTS {
        return Vec::new();
    }
    let length = |point: &usize| (path.point(*point) - path.point(point - 1)).norm_sqr();
    let between = |pair: [usize; 2]| {
        let longest = (pair[0] + 1..=pair[1]).max_by(|a, b| length(a).total_cmp(&length(b)));
        longest.filter(|point| length(point) > 0.0)
    };
    let points = touched.len().div_ceil(touched.len().div_ceil(PIECE_POINTS));
    let pairs = touched.chunks(points).zip(touched.chunks(points).skip(1));
    pairs.filter_map(|(one, next)| between([one[one.len() - 1], next[0]])).collect()
}
