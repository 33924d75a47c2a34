//! Numbers, names and groups as text.

use std::fmt::Write;

use crate::geometry::{c64, wrap};

/// A group: its columns, a row each, and the tables below.
pub(super) struct Group {
    pub(super) keys: &'static [&'static str],
    pub(super) rows: Vec<Vec<String>>,
    pub(super) tables: String,
}

/// The text of a group, its columns aligned.
pub(super) fn group(group: &Group) -> String {
    let widths: Vec<usize> = (0..group.keys.len())
        .map(|column| group.rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0))
        .collect();
    let keys: Vec<String> = group.keys.iter().map(|key| format!("\"{key}\"")).collect();
    let mut text = format!("\n[[group]]\nkeys = [{}]\nrows = [\n", keys.join(", "));
    for row in &group.rows {
        let cells: Vec<String> =
            row.iter().zip(&widths).map(|(cell, width)| format!("{cell:>width$}", width = *width)).collect();
        let _ = writeln!(text, "    [{}],", cells.join(", "));
    }
    text + "]\n" + &group.tables
}

/// Name of a body.
pub(super) fn body(stature: f64) -> String {
    format!("body {:.0}", 100.0 * stature)
}

pub(super) fn quoted(text: &str) -> String {
    format!("\"{text}\"")
}

/// A key, in quotes where TOML asks for them.
pub(super) fn key(name: &str) -> String {
    if name.contains(' ') { quoted(name) } else { name.to_owned() }
}

/// To the millimetre: what is finer differs from machine to machine.
pub(super) fn point(position: c64) -> String {
    format!("[{}, {}]", metres(position.re), metres(position.im))
}

fn metres(value: f64) -> String {
    let text = format!("{value:.3}");
    if text == "-0.000" { "0.000".to_owned() } else { text }
}

/// To the tenth of a degree.
pub(super) fn degrees(angle: f64) -> String {
    let text = format!("{:.1}", wrap(angle).to_degrees());
    match text.as_str() {
        "-0.0" => "0.0".to_owned(),
        "-180.0" => "180.0".to_owned(),
        _ => text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_one_zero() {
        assert_eq!((metres(-0.0001), metres(-0.0006)), ("0.000".to_owned(), "-0.001".to_owned()));
        let turned = [-0.0001, std::f64::consts::PI, -std::f64::consts::PI].map(degrees);
        assert_eq!(turned, ["0.0", "180.0", "180.0"]);
    }
}
