//! Points of a curve from a table: two numbers a line, separated by commas, semicolons, tabs or spaces.

use crate::geometry::c64;

/// Why a text is no list of points.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{fault}")]
pub struct PointsError {
    /// Line, from 1.
    pub line: usize,
    /// Column in characters, from 1.
    pub column: usize,
    /// What is wrong there.
    pub fault: PointsFault,
}

/// What is wrong with a point.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PointsFault {
    /// Something that is no finite number.
    #[error("\"{0}\" is no number")]
    NoNumber(String),
    /// Farther than a scene may reach.
    #[error("{0} metres is too far away")]
    TooFar(f64),
    /// One number or three.
    #[error("expected two numbers, found {0}")]
    NotTwo(usize),
    /// Fewer than two points.
    #[error("expected two points at least, found {0}")]
    TooFew(usize),
}

/// What to do about a fault.
pub const HELP: &str = "write a point a line: x and y of the plan in metres, as in 1.5, -2.0; # starts a comment, a first line may name columns";

/// Farthest from the origin that a point may be, metres.
const FARTHEST: f64 = 1e5;

/// Reads points. Empty lines and what follows `#` count for nothing; a first line without any number is a heading.
///
/// # Errors
/// [`PointsError`] at the first fault.
pub fn points(text: &str) -> Result<Vec<c64>, PointsError> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let mut points = Vec::new();
    let mut is_first = true;
    for (number, line) in text.lines().enumerate() {
        let content = line.split('#').next().unwrap_or_default();
        let cells = cells(content);
        if cells.is_empty() {
            continue;
        }
        let heading = is_first && cells.iter().all(|(_, cell)| cell.parse::<f64>().is_err());
        is_first = false;
        if !heading {
            points.push(point(&cells).map_err(|(column, fault)| PointsError {
                line: number + 1,
                column,
                fault,
            })?);
        }
    }
    if points.len() < 2 {
        let fault = PointsFault::TooFew(points.len());
        return Err(PointsError { line: text.lines().count().max(1), column: 1, fault });
    }
    Ok(points)
}

/// Cells of a line, each with its column from 1.
fn cells(line: &str) -> Vec<(usize, &str)> {
    let is_separator = |c: char| matches!(c, ',' | ';') || c.is_whitespace();
    let mut cells = Vec::new();
    let mut start = None;
    for (at, c) in line.char_indices().chain([(line.len(), ',')]) {
        match (start, is_separator(c)) {
            (None, false) => start = Some(at),
            (Some(from), true) => {
                cells.push((line[..from].chars().count() + 1, &line[from..at]));
                start = None;
            }
            _ => {}
        }
    }
    cells
}

fn point(cells: &[(usize, &str)]) -> Result<c64, (usize, PointsFault)> {
    let number = |(column, cell): &(usize, &str)| match cell.parse::<f64>() {
        Ok(value) if value.abs() <= FARTHEST => Ok(value),
        Ok(value) if value.is_finite() => Err((*column, PointsFault::TooFar(value))),
        _ => Err((*column, PointsFault::NoNumber((*cell).chars().take(40).collect()))),
    };
    let numbers: Vec<f64> = cells.iter().map(number).collect::<Result<_, _>>()?;
    match numbers[..] {
        [x, y] => Ok(c64::new(x, y)),
        _ => Err((cells.get(2).map_or(1, |(column, _)| *column), PointsFault::NotTwo(numbers.len()))),
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn tables_of_all_manners_are_read() {
        let expected = Ok(vec![c64::new(1.0, -2.0), c64::new(3.5, 4.0)]);
        for text in [
            "1,-2\n3.5,4",
            "x;y\n1;-2\r\n3.5;4\r\n",
            "# a line\n\n 1\t-2 # here\n3.5 4e0\n",
            "\u{feff}1 , -2\n3.5 , 4",
        ] {
            assert_eq!(points(text), expected, "{text:?}");
        }
    }

    #[test]
    fn faults_tell_line_and_column() {
        let fault = |text: &str| points(text).expect_err("it is at fault");
        assert_eq!(fault("1,2\n3,ö\n").to_string(), "\"ö\" is no number");
        assert_eq!((fault("1,2\n3,ö\n").line, fault("1,2\n3,ö\n").column), (2, 3));
        assert_eq!(fault("1,2\n3,4,5\n").fault, PointsFault::NotTwo(3));
        assert_eq!(fault("1,2\n3,4,5\n").column, 5);
        assert_eq!(fault("1,2\n3,nan\n").fault, PointsFault::NoNumber("nan".to_owned()));
        assert_eq!(fault("1,2\n3,1e9\n").fault, PointsFault::TooFar(1e9));
        assert_eq!(fault("x,y\n1,2").fault, PointsFault::TooFew(1));
        assert_eq!(fault("").fault, PointsFault::TooFew(0));
    }

    proptest! {
        #[test]
        fn no_text_panics(text in "[0-9a,;#. \n\t\u{e9}-]{0,40}") {
            if let Ok(points) = points(&text) {
                prop_assert!(points.len() >= 2);
            }
        }
    }
}
