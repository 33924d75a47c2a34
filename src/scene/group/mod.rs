//! Groups: tables written once and meant once for every row, so that crowds fit on a page.
//!
//! Groups are expanded before anything else is read: what they say counts as written out at the end of the file, group after
//! group, row after row. Places of faults are those of the template, or of the value in the row.

pub mod expression;
pub mod template;

use std::borrow::Cow;
use std::collections::BTreeMap;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use self::expression::{Expression, Number, Part, Unfillable, parts};
pub use self::template::{Groups, Template};
use self::template::{ROW, alone, template};
use crate::scene::report::{Place, Report};

/// Values that no file holds, as texts: of every row, by group and placeholder.
#[derive(Debug, Default)]
pub struct Reckoned(BTreeMap<(usize, String), Vec<String>>);

/// Takes the groups out of a document.
pub fn groups<'a>(document: &mut DeTable<'a>, report: &mut Report) -> Vec<Template<'a>> {
    let Some(groups) = document.remove("group") else {
        return Vec::new();
    };
    let place = Place { span: groups.span(), field: "group".to_owned() };
    let groups = match groups.into_inner() {
        DeValue::Array(groups) => groups,
        other => {
            let message = match other {
                DeValue::Table(_) => "[group] is one table, but there may be many",
                _ => "expected the tables of a group",
            };
            report.fault(&place, message, "write [[group]] in double brackets");
            return Vec::new();
        }
    };
    groups.into_iter().enumerate().filter_map(|(index, group)| template(group, index, report)).collect()
}

/// Values of the placeholders that stand alone and are more than the name of a column.
pub fn reckoned(groups: &[Template<'_>]) -> Reckoned {
    let mut values = BTreeMap::new();
    for (index, group) in groups.iter().enumerate() {
        for text in group.reckoned() {
            let Some(expression) = alone(&text) else {
                continue;
            };
            // What cannot be reckoned is reported where it is filled in.
            let all = (0..group.count).map(|row| filled(group, &expression, row).unwrap_or_default());
            let all = all.collect();
            values.insert((index, text), all);
        }
    }
    Reckoned(values)
}

/// The document with all its groups written out. Cost: linear in what is written out.
pub fn expanded<'a>(
    mut document: DeTable<'a>,
    groups: &[Template<'a>],
    reckoned: &'a Reckoned,
    report: &mut Report,
) -> DeTable<'a> {
    for (index, group) in groups.iter().enumerate() {
        for row in 0..group.count {
            let mut filling = Filling { group, index, row, reckoned, sound: true, report };
            let piece = filling.table(&group.tables, &group.place);
            // The other rows would say the same.
            if !filling.sound || !merged(&mut document, piece, &group.place, report) {
                break;
            }
        }
    }
    document
}

/// Text of a placeholder in a row.
fn filled(group: &Template<'_>, expression: &Expression<'_>, row: usize) -> Result<String, Unfillable> {
    if expression.name == ROW {
        let number = i64::try_from(row + 1).unwrap_or(i64::MAX);
        return expression.of(Number::Whole(number)).map(|number| number.to_string());
    }
    match group.value(expression.name, row) {
        Some(value) => expression.text(value.get_ref()),
        None => Err(Unfillable::Unknown(expression.name.to_owned())),
    }
}

/// Adds what a row says to the document: tables of a kind after those that are there, keys beside those that are there.
fn merged<'a>(document: &mut DeTable<'a>, piece: DeTable<'a>, group: &Place, report: &mut Report) -> bool {
    let mut sound = true;
    for (key, value) in piece {
        let place = Place { span: key.span(), field: format!("{}.{}", group.field, key.get_ref()) };
        let span = value.span();
        match (document.get_mut(key.get_ref().as_ref()).map(Spanned::get_mut), value.into_inner()) {
            (None, value @ (DeValue::Array(_) | DeValue::Table(_))) => {
                document.insert(key, Spanned::new(span, value));
            }
            (None, _) => {
                let help = "write it above the first table of the file";
                report.fault(&place, format!("\"{}\" is of the whole scene", key.get_ref()), help);
                sound = false;
            }
            (Some(DeValue::Array(known)), DeValue::Array(new)) => {
                new.into_iter().for_each(|new| known.push(new))
            }
            (Some(DeValue::Table(known)), DeValue::Table(new)) => sound &= beside(known, new, &place, report),
            (Some(known), _) if !matches!(known, DeValue::Array(_) | DeValue::Table(_)) => {
                let help = "it is once in a scene: leave it out of the group";
                report.fault(&place, format!("\"{}\" is of the whole scene", key.get_ref()), help);
                sound = false;
            }
            (Some(_), _) => {
                let message = format!("\"{}\" is there already, and something else", key.get_ref());
                report.fault(&place, message, "write both in the same way, or leave it out of the group");
                sound = false;
            }
        }
    }
    sound
}

/// Tables whose keys are settings, not names.
const ONCE: [&str; 4] = [".discrete", ".warp", ".physics", ".full_body"];

/// Adds the keys of `new` to a table: lists go on, all else must be new.
fn beside<'a>(known: &mut DeTable<'a>, new: DeTable<'a>, table: &Place, report: &mut Report) -> bool {
    let mut sound = true;
    for (key, value) in new {
        match (known.get_mut(key.get_ref().as_ref()).map(Spanned::get_mut), value.get_ref()) {
            (None, _) => drop(known.insert(key, value)),
            (Some(DeValue::Array(known)), DeValue::Array(new)) => {
                new.iter().for_each(|new| known.push(new.clone()));
            }
            (Some(_), _) => {
                let place = Place { span: key.span(), field: format!("{}.{}", table.field, key.get_ref()) };
                let help = match ONCE.iter().any(|once| table.field.ends_with(once)) {
                    true => "it is once in a scene: leave it out of the group",
                    false => "put a placeholder into the key, such as \"walk {n}\"",
                };
                report.fault(&place, format!("there already is \"{}\"", key.get_ref()), help);
                sound = false;
            }
        }
    }
    sound
}

/// Fills the templates of a group in for one row.
struct Filling<'a, 'r> {
    group: &'r Template<'a>,
    index: usize,
    row: usize,
    reckoned: &'a Reckoned,
    sound: bool,
    report: &'r mut Report,
}

impl<'a> Filling<'a, '_> {
    fn table(&mut self, table: &DeTable<'a>, place: &Place) -> DeTable<'a> {
        let mut copy = DeTable::new();
        for (key, value) in table {
            let below = Place { span: key.span(), field: format!("{}.{}", place.field, key.get_ref()) };
            let name = Spanned::new(key.span(), self.text(key.get_ref(), &below));
            let value = self.value(value, &below);
            copy.insert(name, value);
        }
        copy
    }

    fn value(&mut self, value: &Spanned<DeValue<'a>>, place: &Place) -> Spanned<DeValue<'a>> {
        let place = Place { span: value.span(), field: place.field.clone() };
        let copy = match value.get_ref() {
            DeValue::String(text) => return self.string(text, &place),
            DeValue::Array(array) => {
                let cells = array.iter().map(|cell| self.value(cell, &place));
                DeValue::Array(cells.collect::<Vec<_>>().into_iter().collect())
            }
            DeValue::Table(table) => DeValue::Table(self.table(table, &place)),
            other => other.clone(),
        };
        Spanned::new(value.span(), copy)
    }

    /// A text; where it is one placeholder, the value itself.
    fn string(&mut self, text: &Cow<'a, str>, place: &Place) -> Spanned<DeValue<'a>> {
        if let Some(expression) = alone(text) {
            if self.group.is_column(&expression)
                && let Some(value) = self.group.value(expression.name, self.row)
            {
                return value.clone();
            }
            let reckoned: &'a Reckoned = self.reckoned;
            let made = reckoned.0.get(&(self.index, text.to_string())).and_then(|all| all.get(self.row));
            if let Some(Ok(value)) = made.filter(|made| !made.is_empty()).map(|made| DeValue::parse(made)) {
                return Spanned::new(place.span.clone(), value.into_inner());
            }
        }
        Spanned::new(place.span.clone(), DeValue::String(self.text(text, place)))
    }

    fn text(&mut self, text: &Cow<'a, str>, place: &Place) -> Cow<'a, str> {
        if !text.contains(['{', '}']) {
            return text.clone();
        }
        let filled = parts(text).and_then(|parts| parts.into_iter().map(|part| self.part(part)).collect());
        match filled {
            Ok(text) => Cow::Owned(text),
            Err(unfillable) => {
                let help = match &unfillable {
                    Unfillable::Unknown(name) => self.group.remedy(name),
                    _ => "write {n}, {n+1}, {2*n-1} with a column n; {{ and }} for braces".to_owned(),
                };
                self.report.fault(place, unfillable.to_string(), help);
                self.sound = false;
                text.clone()
            }
        }
    }

    fn part(&self, part: Part<'_>) -> Result<String, Unfillable> {
        match part {
            Part::Plain(text) => Ok(text.to_owned()),
            Part::Filled(expression) => filled(self.group, &expression, self.row),
        }
    }
}
