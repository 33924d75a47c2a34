//! Values of a motion that are no finite numbers, filled in from the frames around them.

/// Longest run of frames that is filled in: what a body does in a longer one is anybody's guess.
pub(super) const LONGEST_GAP: usize = 3;

/// A value that is no finite number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Gap {
    /// Row of the motion, from 0.
    pub(super) row: usize,
    /// Column of the row.
    pub(super) column: usize,
    /// Where the word starts in the file, bytes.
    pub(super) start: usize,
}

/// Fills `gaps` of the rows `values`, `width` columns each, on straight lines between the frames around them (held at the
/// ends of the file); angles in degrees take the shorter way. Returns the rows that were mended, rising.
///
/// Cost: linear in the gaps, but for sorting them.
///
/// # Errors
/// The first gap of a run of more than [`LONGEST_GAP`] rows, or of a column without any number.
pub(super) fn fill_gaps(
    values: &mut [f64],
    width: usize,
    gaps: &[Gap],
    is_angle: impl Fn(usize) -> bool,
) -> Result<Vec<usize>, Gap> {
    let mut sorted = gaps.to_vec();
    sorted.sort_unstable_by_key(|gap| (gap.column, gap.row));
    let mut rest = &sorted[..];
    while let Some(first) = rest.first() {
        let is_next =
            |(index, gap): &(usize, &Gap)| gap.column == first.column && gap.row == first.row + index;
        let length = rest.iter().enumerate().take_while(is_next).count();
        if length > LONGEST_GAP {
            return Err(*first);
        }
        fill_run(values, width, *first, length, is_angle(first.column)).ok_or(*first)?;
        rest = &rest[length..];
    }
    let mut rows: Vec<usize> = gaps.iter().map(|gap| gap.row).collect();
    rows.sort_unstable();
    rows.dedup();
    Ok(rows)
}

/// Fills `length` rows of one column from `first` on; `None` where there is no number before or after.
fn fill_run(values: &mut [f64], width: usize, first: Gap, length: usize, is_angle: bool) -> Option<()> {
    let at = |row: usize| row * width + first.column;
    let before = first.row.checked_sub(1).map(|row| values[at(row)]);
    let after = values.get(at(first.row + length)).copied();
    let (from, to) = (before.or(after)?, after.or(before)?);
    let change = if is_angle { shorter_way(to - from) } else { to - from };
    for step in 0..length {
        let share = (step + 1) as f64 / (length + 1) as f64;
        values[at(first.row + step)] = from + share * change;
    }
    Some(())
}

/// The same turn by at most half a circle, degrees.
fn shorter_way(degrees: f64) -> f64 {
    degrees - 360.0 * (degrees / 360.0).round()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn gap(row: usize, column: usize) -> Gap {
        Gap { row, column, start: 0 }
    }

    #[test]
    fn gaps_lie_on_straight_lines_and_angles_take_the_shorter_way() {
        let nan = f64::NAN;
        let mut values = [1.0, 350.0, nan, nan, nan, nan, 4.0, 20.0];
        let mended =
            fill_gaps(&mut values, 2, &[gap(1, 0), gap(1, 1), gap(2, 0), gap(2, 1)], |column| column == 1);
        assert_eq!(mended, Ok(vec![1, 2]));
        assert_eq!(values, [1.0, 350.0, 2.0, 360.0, 3.0, 370.0, 4.0, 20.0]);
    }

    #[test]
    fn gaps_at_the_ends_hold_what_is_next_to_them() {
        let mut values = [f64::NAN, 2.0, f64::NAN];
        assert_eq!(fill_gaps(&mut values, 1, &[gap(0, 0), gap(2, 0)], |_| false), Ok(vec![0, 2]));
        assert_eq!(values, [2.0; 3]);
    }

    #[test]
    fn long_gaps_and_empty_columns_are_left() {
        let mut values = [1.0, f64::NAN, f64::NAN, f64::NAN, f64::NAN, 6.0];
        let gaps: Vec<Gap> = (1..5).map(|row| gap(row, 0)).collect();
        assert_eq!(fill_gaps(&mut values, 1, &gaps, |_| false), Err(gap(1, 0)));
        assert_eq!(fill_gaps(&mut [f64::NAN], 1, &[gap(0, 0)], |_| false), Err(gap(0, 0)));
    }
}
