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

/// A character of a group, whose body and place its row gives; `track`: as in the file.
pub(super) fn character(name: &str, track: &str) -> String {
    format!(
        "\n[[group.character]]\nname = \"{name}\"\ntrack = {track}\nskeleton = \"{{body}}\"\n\
         position = \"{{position}}\"\nfacing = \"{{facing}}\"\n"
    )
}

/// That one of a group has a box, from moment to moment.
pub(super) fn carry((who, load): (&str, &str), (from, to): (&str, &str)) -> String {
    format!(
        "\n[[group.carry]]\nname = \"{who} has {load}\"\nobject = \"{load}\"\nby = [\"{who}\"]\n\
         during = [\"{who}/{from}\", \"{who}/{to}\"]\n"
    )
}

/// Where one of a group is, seen from another.
pub(super) struct Relative<'a> {
    pub(super) name: &'a str,
    pub(super) at: &'a str,
    pub(super) to: &'a str,
    /// As in the file, with a remark if need be.
    pub(super) offset: &'a str,
    pub(super) facing: Option<&'a str>,
    /// As in the file.
    pub(super) strength: &'a str,
}

/// See [`Relative`].
pub(super) fn relative(relative: &Relative) -> String {
    let Relative { name, at, to, offset, facing, strength } = relative;
    let facing = facing.map_or(String::new(), |facing| format!("facing = {facing}\n"));
    format!(
        "\n[[group.relative]]\nname = \"{name}\"\nat = \"{at}\"\nto = \"{to}\"\noffset = {offset}\n{facing}\
         strength = {strength}\n"
    )
}

/// That two moments of a group are one, or `offset` apart.
pub(super) fn sync(name: &str, [one, other]: [&str; 2], offset: Option<&str>) -> String {
    let offset = offset.map_or(String::new(), |offset| format!("offset = \"{offset}\"\n"));
    format!(
        "\n[[group.sync]]\nname = \"{name}\"\nmoments = [\"{one}\", \"{other}\"]\n{offset}strength = \"hard\"\n"
    )
}

/// What holds exactly.
pub(super) const HARD: &str = "\"hard\"";

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
