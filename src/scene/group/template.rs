//! What one `[[group]]` says: its rows, and the tables that are meant for each of them.

use std::borrow::Cow;
use std::collections::BTreeSet;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::expression::{Expression, Part, is_name, parts};
use crate::scene::report::{At, Place, Report};
use crate::scene::suggest;
use crate::scene::tree::{Node, Read, elements, wrong_type};

/// More rows are a slip.
const MOST_ROWS: usize = 1_000_000;

/// More values than this, over all rows of a group, do not fit a computer comfortably.
const MOST_VALUES: usize = 5_000_000;

/// Number of the row, from 1, in every group.
pub const ROW: &str = "i";

/// A group, its rows apart from what is written once.
#[derive(Debug)]
pub struct Template<'a> {
    /// Tables for every row.
    pub tables: DeTable<'a>,
    /// Names of the columns.
    pub keys: Vec<String>,
    /// Values by column, a row each; all as long as `keys`.
    pub rows: Vec<Vec<Spanned<DeValue<'a>>>>,
    /// Number of rows; more than there are in `rows` only where there are no columns.
    pub count: usize,
    /// Of the group.
    pub place: Place,
}

/// Takes `[[group]]` number `index` apart; `None` after reporting what is wrong with it.
pub fn template<'a>(group: Spanned<DeValue<'a>>, index: usize, report: &mut Report) -> Option<Template<'a>> {
    let place = Place { span: group.span(), field: format!("group[{index}]") };
    let DeValue::Table(mut tables) = group.into_inner() else {
        report.fault(&place, "a group is a table headed [[group]]", "write [[group]] on a line of its own");
        return None;
    };
    let keys = names(tables.remove("keys"), &place, report);
    let count = count(tables.remove("count"), &place, report);
    let rows = rows(tables.remove("rows"), keys.as_ref().map(Option::as_deref), &place, report);
    let (keys, count, rows) = (keys?, count?, rows?);
    let count = match (count, rows.is_empty()) {
        (Some(_), false) => {
            report.fault(&place, "\"count\" and \"rows\" exclude each other", "keep one of them");
            return None;
        }
        (None, true) => {
            let help = "add count = 10, or keys = [\"n\"] and rows = [[1], [2]]";
            report.fault(&place, "nothing says how often the group is repeated", help);
            return None;
        }
        (Some(count), true) => count,
        (None, false) => rows.len(),
    };
    let template = Template { tables, keys: keys.unwrap_or_default(), rows, count, place };
    template.is_sound(report).then_some(template)
}

impl<'a> Template<'a> {
    /// Value of column `name` in row `row`, from 0.
    pub fn value(&self, name: &str, row: usize) -> Option<&Spanned<DeValue<'a>>> {
        let column = self.keys.iter().position(|key| key == name)?;
        self.rows.get(row)?.get(column)
    }

    /// Whether `name` is a column or the number of the row.
    pub fn knows(&self, name: &str) -> bool {
        name == ROW || self.keys.iter().any(|key| key == name)
    }

    /// What to do about a name that is not known.
    pub fn remedy(&self, name: &str) -> String {
        let known: Vec<&str> = self.keys.iter().map(String::as_str).chain([ROW]).collect();
        suggest::remedy(name, "columns", &known)
    }

    /// Texts of the tables that are one placeholder and more than the name of a column: their values have to be made.
    pub fn reckoned(&self) -> BTreeSet<String> {
        let mut found = BTreeSet::new();
        texts(&self.tables, &mut |text| {
            if let Some(expression) = alone(text)
                && !self.is_column(&expression)
            {
                found.insert(text.to_owned());
            }
        });
        found
    }

    /// Whether a placeholder is a column as it is.
    pub fn is_column(&self, expression: &Expression<'_>) -> bool {
        expression.is_plain() && self.keys.iter().any(|key| key == expression.name)
    }

    fn is_sound(&self, report: &mut Report) -> bool {
        if self.tables.is_empty() {
            report.fault(
                &self.place,
                "the group has no tables",
                "add [[group.character]] or other tables below it",
            );
            return false;
        }
        if self.tables.contains_key("group") {
            report.fault(&self.place, "groups hold no groups", "write the rows out, or make two groups");
            return false;
        }
        let mut values = self.tables.len();
        texts(&self.tables, &mut |_| values += 1);
        if self.count > MOST_ROWS || self.count.saturating_mul(values) > MOST_VALUES {
            let message = format!("{} rows are too many", self.count);
            report.fault(&self.place, message, format!("stay within {MOST_ROWS} rows, {MOST_VALUES} values"));
            return false;
        }
        true
    }
}

/// The placeholder that a text consists of, if it is one and nothing else.
pub fn alone(text: &str) -> Option<Expression<'_>> {
    match parts(text).ok()?[..] {
        [Part::Filled(expression)] => Some(expression),
        _ => None,
    }
}

/// Calls `see` with every text in a table, and with an empty one for every other value.
fn texts(table: &DeTable<'_>, see: &mut dyn FnMut(&str)) {
    table.iter().for_each(|(_, value)| texts_of(value.get_ref(), see));
}

fn texts_of(value: &DeValue<'_>, see: &mut dyn FnMut(&str)) {
    match value {
        DeValue::String(text) => see(text),
        DeValue::Array(array) => array.iter().for_each(|value| texts_of(value.get_ref(), see)),
        DeValue::Table(table) => texts(table, see),
        _ => see(""),
    }
}

type Value<'a> = Option<Spanned<DeValue<'a>>>;

/// Outer `None`: reported.
fn count(given: Value<'_>, group: &Place, report: &mut Report) -> Option<Option<usize>> {
    let Some(given) = given else {
        return Some(None);
    };
    let place = Place { span: given.span(), field: format!("{}.count", group.field) };
    let whole = given.get_ref().as_integer();
    let count = whole.and_then(|whole| usize::from_str_radix(whole.as_str(), whole.radix()).ok());
    if count.is_none_or(|count| count == 0) {
        report.fault(&place, "expected how often the group is repeated", "write a whole number from 1");
        return None;
    }
    Some(count)
}

/// Names of columns.
fn names(given: Value<'_>, group: &Place, report: &mut Report) -> Option<Option<Vec<String>>> {
    let Some(given) = given else {
        return Some(None);
    };
    let place = Place { span: given.span(), field: format!("{}.keys", group.field) };
    let node = Node { value: given.get_ref(), place };
    let names: Vec<At<String>> = elements(&node, "an array of names", report)?;
    let (mut seen, mut sound) = (Vec::new(), true);
    for At { value: name, place } in names {
        if !is_name(&name) || name == ROW {
            let help = "write a letter, then letters, digits and '_'; i is the number of the row already";
            report.fault(&place, format!("a column cannot be called {name:?}"), help);
            sound = false;
        } else if seen.contains(&name) {
            report.fault(&place, format!("there are two columns \"{name}\""), "name each column once");
            sound = false;
        }
        seen.push(name);
    }
    sound.then_some(Some(seen))
}

/// Rows as long as `keys`; of any length where these are at fault (`None`).
fn rows<'a>(
    given: Value<'a>,
    keys: Option<Option<&[String]>>,
    group: &Place,
    report: &mut Report,
) -> Option<Vec<Vec<Spanned<DeValue<'a>>>>> {
    let Some(given) = given else {
        if keys.flatten().is_some() {
            report.fault(group, "\"keys\" name columns, but there are no \"rows\"", "add rows = [[…], …]");
            return None;
        }
        return Some(Vec::new());
    };
    let place = Place { span: given.span(), field: format!("{}.rows", group.field) };
    let node = Node { value: given.get_ref(), place: place.clone() };
    if keys == Some(None) {
        report.fault(group, "\"rows\" have no \"keys\"", "add keys = [\"n\", …]: a name for every column");
        return None;
    }
    let columns = keys.flatten().map(<[String]>::len);
    if !node.value.is_array() {
        wrong_type(&node, "an array of rows", report);
        return None;
    }
    let DeValue::Array(array) = given.into_inner() else {
        return None;
    };
    let count = array.len();
    if count == 0 {
        report.fault(&place, "there is no row", "add at least one");
        return None;
    }
    let mut rows = Vec::with_capacity(count);
    for (number, row) in array.into_iter().enumerate() {
        let place = Place { span: row.span(), field: format!("{}[{number}]", place.field) };
        rows.extend(cells(row, columns, &place, report));
    }
    (rows.len() == count).then_some(rows)
}

fn cells<'a>(
    row: Spanned<DeValue<'a>>,
    columns: Option<usize>,
    place: &Place,
    report: &mut Report,
) -> Option<Vec<Spanned<DeValue<'a>>>> {
    let many = columns.map_or(String::new(), |columns| format!("{columns} "));
    let expected = format!("a row of {many}values, one for each of \"keys\"");
    match row.into_inner() {
        DeValue::Array(cells) if columns.is_none_or(|columns| cells.len() == columns) => {
            Some(cells.into_iter().collect())
        }
        DeValue::Array(cells) => {
            let message = format!("expected {expected}, found {}", cells.len());
            report.fault(place, message, format!("write {expected}"));
            None
        }
        _ => {
            report.fault(place, format!("expected {expected}"), format!("write {expected} in brackets"));
            None
        }
    }
}

/// A group as the schema shows it; readers see it expanded.
#[derive(Clone, Debug, Default)]
pub struct Groups;

impl Read for Groups {
    fn read(_: &Node<'_>, _: &mut Report) -> Option<Self> {
        Some(Self)
    }
}

impl JsonSchema for Groups {
    fn inline_schema() -> bool {
        true
    }
    fn schema_name() -> Cow<'static, str> {
        "Groups".into()
    }
    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({
            "type": "array",
            "items": {
                "type": "object",
                "properties": {
                    "count": {
                        "description": "How often the tables are repeated; {i} is the number of the repetition, from 1.",
                        "type": "integer",
                        "minimum": 1
                    },
                    "keys": {
                        "description": "Names of the columns of \"rows\".",
                        "type": "array",
                        "items": { "type": "string" }
                    },
                    "rows": {
                        "description": "The tables are repeated once for every row; \"{n}\" is its value in column n.",
                        "type": "array",
                        "items": { "type": "array" }
                    }
                },
                "additionalProperties": {
                    "description": "Tables as in the rest of the scene, with placeholders in texts and keys.",
                    "anyOf": [{ "type": "array" }, { "type": "object" }]
                }
            }
        })
    }
}
