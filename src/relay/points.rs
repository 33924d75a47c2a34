//! Points of a curve from a table: two numbers a line, in quotes or without, separated by commas, semicolons, tabs or spaces; where
//! a heading names its columns, those called x and y.

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
    /// A heading that does not tell which column is which.
    #[error("expected columns named x and y, found {0}")]
    NotNamed(String),
    /// More or fewer cells than the heading has.
    #[error("expected {expected} cells as in the heading, found {found}")]
    NotAsNamed {
        /// In the heading.
        expected: usize,
        /// In this line.
        found: usize,
    },
    /// Fewer than two points.
    #[error("expected two points at least, found {0}")]
    TooFew(usize),
}

/// What to do about a fault.
pub const HELP: &str = "write a point a line: x and y of the plan in metres, as in 1.5, -2.0; # starts a comment; a first line may name columns, x and y among them";

/// Farthest from the origin that a point may be, metres.
const FARTHEST: f64 = 1e5;

/// Which cells of a line are x and y, and how many there are.
#[derive(Clone, Copy)]
struct Columns {
    x: usize,
    y: usize,
    count: Option<usize>,
}

/// Reads points. Empty lines and what follows `#` count for nothing; a first line without any number is a heading.
///
/// # Errors
/// [`PointsError`] at the first fault.
pub fn points(text: &str) -> Result<Vec<c64>, PointsError> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let mut points = Vec::new();
    let mut columns = None;
    for (number, line) in text.lines().enumerate() {
        let cells = cells(line.split('#').next().unwrap_or_default());
        if cells.is_empty() {
            continue;
        }
        let fault = |(column, fault)| PointsError { line: number + 1, column, fault };
        let heading = columns.is_none() && cells.iter().all(|(_, cell)| cell.parse::<f64>().is_err());
        if heading {
            columns = Some(named(&cells).map_err(fault)?);
            continue;
        }
        let known = *columns.get_or_insert(Columns { x: 0, y: 1, count: None });
        points.push(point(&cells, known).map_err(fault)?);
    }
    if points.len() < 2 {
        let fault = PointsFault::TooFew(points.len());
        return Err(PointsError { line: text.lines().count().max(1), column: 1, fault });
    }
    Ok(points)
}

/// Cells of a line, each with its column from 1, without their quotes; between two commas or semicolons there is one, if an empty one.
fn cells(line: &str) -> Vec<(usize, &str)> {
    let mut cells = Vec::new();
    let mut rest = line.trim_start();
    while !rest.is_empty() {
        let column = line[..line.len() - rest.len()].chars().count() + 1;
        let quoted = rest.strip_prefix('"').and_then(|inner| inner.split_once('"'));
        let cell = match quoted {
            Some((cell, after)) => {
                rest = after;
                cell.trim()
            }
            None => {
                let end = |c: char| matches!(c, ',' | ';') || c.is_whitespace();
                let (cell, after) = rest.split_at(rest.find(end).unwrap_or(rest.len()));
                rest = after;
                cell
            }
        };
        cells.push((column, cell));
        rest = rest.trim_start();
        rest = rest.strip_prefix([',', ';']).unwrap_or(rest).trim_start();
    }
    cells
}

/// Where a heading has x and y.
fn named(cells: &[(usize, &str)]) -> Result<Columns, (usize, PointsFault)> {
    let only = |name: &str| {
        let mut found = (0..cells.len()).filter(|index| cells[*index].1.eq_ignore_ascii_case(name));
        found.next().filter(|_| found.next().is_none())
    };
    match (only("x"), only("y")) {
        (Some(x), Some(y)) => Ok(Columns { x, y, count: Some(cells.len()) }),
        _ => {
            let names: Vec<&str> = cells.iter().map(|(_, name)| *name).collect();
            Err((1, PointsFault::NotNamed(names.join(", ").chars().take(60).collect())))
        }
    }
}

fn point(cells: &[(usize, &str)], columns: Columns) -> Result<c64, (usize, PointsFault)> {
    match columns.count {
        Some(expected) if cells.len() != expected => {
            return Err((1, PointsFault::NotAsNamed { expected, found: cells.len() }));
        }
        None if cells.len() != 2 => {
            let third = cells.get(2).map_or(1, |(column, _)| *column);
            return Err((third, PointsFault::NotTwo(cells.len())));
        }
        _ => {}
    }
    let number = |(column, cell): (usize, &str)| match cell.parse::<f64>() {
        Ok(value) if value.abs() <= FARTHEST => Ok(value),
        Ok(value) if value.is_finite() => Err((column, PointsFault::TooFar(value))),
        _ => Err((column, PointsFault::NoNumber(cell.chars().take(40).collect()))),
    };
    Ok(c64::new(number(cells[columns.x])?, number(cells[columns.y])?))
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
            "y,x\n-2,1\n4,3.5\n",
            "\"1\",\"-2\"\n\"3.5\", \"4\"\n",
            "\"Y\";\"name\";\"X\"\n-2;a b;1\n4;\"b, c\";3.5\n".replace("a b", "a").as_str(),
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
        assert_eq!(fault("1,,2\n3,4\n").fault, PointsFault::NotTwo(3));
        assert_eq!(fault("1;2\n3;\"4,5\"\n").fault, PointsFault::NoNumber("4,5".to_owned()));
        let named = PointsFault::NotNamed("north, east".to_owned());
        assert_eq!((fault("north,east\n1,2\n3,4").line, fault("north,east\n1,2\n3,4").fault), (1, named));
        assert_eq!(fault("x,y,z\n1,2\n").fault, PointsFault::NotAsNamed { expected: 3, found: 2 });
        assert_eq!(fault("").fault, PointsFault::TooFew(0));
    }

    proptest! {
        #[test]
        fn no_text_panics(text in "[0-9axy\",;#. \n\t\u{e9}-]{0,40}") {
            if let Ok(points) = points(&text) {
                prop_assert!(points.len() >= 2);
            }
        }
    }
}
