//! Collects every fault and warning of one file, then gives them their lines and columns.

use std::collections::BTreeMap;
use std::ops::Range;

use crate::scene::diagnostic::{Diagnostic, Severity};

/// Where something stands in a scene file.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Place {
    /// Bytes of the file.
    pub span: Range<usize>,
    /// The key, with everything above it: `character[1].track[0]`; empty for the file as a whole.
    pub field: String,
}

/// A value and where it stands.
#[derive(Clone, Debug)]
pub struct At<T> {
    /// What the file says.
    pub value: T,
    /// Where.
    pub place: Place,
}

/// Faults and warnings found so far.
#[derive(Debug, Default)]
pub struct Report {
    found: Vec<(Severity, Place, String, String)>,
}

impl Report {
    /// Notes what keeps the scene from being used, and the remedy.
    pub fn fault(&mut self, place: &Place, message: impl Into<String>, help: impl Into<String>) {
        let found = (Severity::Fault, place.clone(), message.into(), help.into());
        self.found.push(found);
    }

    /// Notes what the author should know, and what to do about it.
    pub fn warn(&mut self, place: &Place, message: impl Into<String>, help: impl Into<String>) {
        let found = (Severity::Warning, place.clone(), message.into(), help.into());
        self.found.push(found);
    }

    /// Whether anything keeps the scene from being used.
    pub fn has_faults(&self) -> bool {
        self.fault_count() > 0
    }

    /// How much keeps the scene from being used.
    pub fn fault_count(&self) -> usize {
        self.found.iter().filter(|(severity, ..)| *severity == Severity::Fault).count()
    }

    /// Faults and warnings of the file `file` that says `text`, each in the order of the file, none twice. Of one place, which
    /// stands for many in a group, only the first few are told.
    pub fn finish(mut self, file: &str, text: &str) -> (Vec<Diagnostic>, Vec<Diagnostic>) {
        self.found.sort_by_key(|(_, place, ..)| (place.span.start, place.span.end));
        few_of_each_place(&mut self.found);
        let lines = Lines::of(text);
        let mut all: Vec<_> = self
            .found
            .into_iter()
            .map(|(severity, place, message, help)| {
                let (line, column) = lines.position(place.span.start);
                Diagnostic {
                    file: file.to_owned(),
                    line,
                    column,
                    span: place.span,
                    field: Some(place.field).filter(|field| !field.is_empty()),
                    message,
                    help: Some(help),
                    severity,
                }
            })
            .collect();
        all.dedup();
        all.into_iter().partition(|diagnostic| diagnostic.severity == Severity::Fault)
    }
}

/// So many diagnostics of one place and kind are told in full.
const MOST_OF_A_PLACE: usize = 3;

/// Keeps the first few of each place and severity, and says in the last of them how many more there are.
fn few_of_each_place(found: &mut Vec<(Severity, Place, String, String)>) {
    let key = |(severity, place, ..): &(Severity, Place, String, String)| {
        (place.span.start, place.span.end, *severity == Severity::Fault)
    };
    let mut counts: BTreeMap<_, usize> = BTreeMap::new();
    found.dedup();
    found.iter().for_each(|one| *counts.entry(key(one)).or_default() += 1);
    let mut told: BTreeMap<_, usize> = BTreeMap::new();
    found.retain_mut(|one| {
        let count = counts[&key(one)];
        let told = told.entry(key(one)).or_default();
        *told += 1;
        if *told == MOST_OF_A_PLACE && count > MOST_OF_A_PLACE {
            one.3 += &format!("; {} more of the same place are not shown", count - MOST_OF_A_PLACE);
        }
        *told <= MOST_OF_A_PLACE
    });
}

/// Where the lines of a text begin.
pub struct Lines<'a> {
    text: &'a str,
    starts: Vec<usize>,
}

impl<'a> Lines<'a> {
    /// Cost: linear in the text.
    pub fn of(text: &'a str) -> Self {
        let after_breaks = text.match_indices('\n').map(|(at, _)| at + 1);
        Self { text, starts: std::iter::once(0).chain(after_breaks).collect() }
    }

    /// Line and column (in characters) of a byte, both from 1.
    pub fn position(&self, offset: usize) -> (usize, usize) {
        let offset = self.text.floor_char_boundary(offset);
        let line = self.starts.partition_point(|start| *start <= offset);
        let start = self.starts[line - 1];
        (line, self.text[start..offset].chars().count() + 1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_count_characters_and_lines_count_from_one() {
        let lines = Lines::of("a\nöb\n");
        assert_eq!(lines.position(0), (1, 1));
        assert_eq!(lines.position(4), (2, 2));
        assert_eq!(lines.position(5), (2, 3));
        assert_eq!(lines.position(600), (3, 1));
    }

    #[test]
    fn faults_come_in_the_order_of_the_file_whatever_the_order_of_finding() {
        let place = |start: usize| Place { span: start..start + 1, field: String::new() };
        let mut report = Report::default();
        report.fault(&place(4), "late", "b");
        report.warn(&place(2), "between", "c");
        report.fault(&place(0), "early", "a");
        let (faults, warnings) = report.finish("x.toml", "one\ntwo\n");
        assert_eq!(faults.iter().map(|f| f.line).collect::<Vec<_>>(), [1, 2]);
        assert_eq!((warnings[0].line, warnings[0].column), (1, 3));
    }
}
