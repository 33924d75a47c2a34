//! Reads a spanned TOML tree into typed tables. Every value is looked at, so that all faults come out at once.
//!
//! `table!` writes a table's type, its schema and its reader from one list of keys; the three cannot disagree.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::ops::Range;

use schemars::{JsonSchema, Schema, SchemaGenerator};
use toml::de::{DeTable, DeValue};

use crate::scene::report::{At, Place, Report};
use crate::scene::suggest;

/// A value of the tree and where it stands.
pub struct Node<'a> {
    /// The value.
    pub value: &'a DeValue<'a>,
    /// Where it stands.
    pub place: Place,
}

/// What can be read from a value of the tree.
pub trait Read: Sized {
    /// Reads `node`; `None` after reporting what is wrong with it.
    fn read(node: &Node<'_>, report: &mut Report) -> Option<Self>;
}

/// Value of a key of a table.
#[derive(Clone, Debug, Default)]
pub enum Field<T> {
    /// The key is not there.
    #[default]
    Absent,
    /// What is there is wrong, and reported.
    Spoiled,
    /// What is there.
    Given(At<T>),
}

impl<T> Field<T> {
    /// The value with its place, where it was read.
    pub fn given(&self) -> Option<&At<T>> {
        match self {
            Self::Given(value) => Some(value),
            Self::Absent | Self::Spoiled => None,
        }
    }

    /// The value, where it was read.
    pub fn value(&self) -> Option<&T> {
        self.given().map(|given| &given.value)
    }

    /// Whether the author left the key out.
    pub fn is_absent(&self) -> bool {
        matches!(self, Self::Absent)
    }
}

/// Writes the type of a table with its schema and its reader.
macro_rules! table {
    ($(#[$meta:meta])* $name:ident {
        required { $($(#[$required_meta:meta])* $required:ident: $required_type:ty,)* }
        optional { $($(#[$optional_meta:meta])* $optional:ident: $optional_type:ty,)* }
    }) => {
        $(#[$meta])*
        #[derive(Clone, Debug, schemars::JsonSchema)]
        #[schemars(deny_unknown_fields)]
        pub struct $name {
            $($(#[$required_meta])* pub $required: $crate::scene::tree::Field<$required_type>,)*
            $($(#[$optional_meta])* #[schemars(default)] pub $optional: $crate::scene::tree::Field<$optional_type>,)*
        }

        impl $crate::scene::tree::Read for $name {
            fn read(
                node: &$crate::scene::tree::Node<'_>,
                report: &mut $crate::scene::report::Report,
            ) -> Option<Self> {
                let mut keys = $crate::scene::tree::Keys::of(node, report)?;
                let table = Self {
                    $($required: keys.required(stringify!($required)),)*
                    $($optional: keys.optional(stringify!($optional)),)*
                };
                keys.finish();
                Some(table)
            }
        }
    };
}
pub(crate) use table;

/// Keys of a table, taken one by one.
pub struct Keys<'a, 'r> {
    table: &'a DeTable<'a>,
    place: Place,
    asked: Vec<&'static str>,
    report: &'r mut Report,
}

impl<'a, 'r> Keys<'a, 'r> {
    /// The keys of `node`; `None`, reported, if it is no table.
    pub fn of(node: &'a Node<'a>, report: &'r mut Report) -> Option<Self> {
        let DeValue::Table(table) = node.value else {
            wrong_type(node, "a table of keys and values", report);
            return None;
        };
        Some(Self { table, place: node.place.clone(), asked: Vec::new(), report })
    }

    /// Value of a key that may be left out.
    pub fn optional<T: Read>(&mut self, key: &'static str) -> Field<T> {
        self.asked.push(key);
        let Some(value) = self.table.get(key) else {
            return Field::Absent;
        };
        let place = child(&self.place, key, value.span());
        let node = Node { value: value.get_ref(), place };
        match T::read(&node, self.report) {
            Some(value) => Field::Given(At { value, place: node.place }),
            None => Field::Spoiled,
        }
    }

    /// Value of a key that must be there.
    pub fn required<T: Read>(&mut self, key: &'static str) -> Field<T> {
        match self.optional(key) {
            Field::Absent => {
                let message = format!("\"{key}\" is missing");
                self.report.fault(&self.place, message, format!("add {key} = …"));
                Field::Spoiled
            }
            field => field,
        }
    }

    /// Reports the keys nobody asked for.
    pub fn finish(mut self) {
        let unknown = self.rest();
        for (key, place) in unknown {
            let message = format!("unknown key \"{key}\"");
            let help = suggest::remedy(&key, "keys", &self.asked);
            self.report.fault(&place, message, help);
        }
    }

    /// Reads the keys nobody asked for, each as a `T`.
    pub fn remaining<T: Read>(mut self) -> BTreeMap<String, At<T>> {
        let rest = self.rest();
        let mut values = BTreeMap::new();
        for (key, place) in rest {
            let Some(value) = self.table.get(key.as_str()) else {
                continue;
            };
            let node = Node { value: value.get_ref(), place: Place { span: value.span(), ..place } };
            if let Some(value) = T::read(&node, self.report) {
                values.insert(key, At { value, place: node.place });
            }
        }
        values
    }

    /// Keys nobody asked for, with the places of the keys themselves.
    fn rest(&mut self) -> Vec<(String, Place)> {
        self.table
            .keys()
            .filter(|key| !self.asked.contains(&key.get_ref().as_ref()))
            .map(|key| {
                let name = key.get_ref().to_string();
                let place = child(&self.place, &name, key.span());
                (name, place)
            })
            .collect()
    }
}

/// Place of the key `key` of the table at `parent`.
fn child(parent: &Place, key: &str, span: Range<usize>) -> Place {
    let bare = !key.is_empty() && key.chars().all(|c| c.is_alphanumeric() || c == '_' || c == '-');
    let key: Cow<'_, str> = if bare { key.into() } else { format!("{key:?}").into() };
    let field = if parent.field.is_empty() { key.into_owned() } else { format!("{}.{key}", parent.field) };
    Place { span, field }
}

/// Reports that `node` is not what it should be.
pub fn wrong_type(node: &Node<'_>, expected: &str, report: &mut Report) {
    let found = match node.value {
        DeValue::String(_) => "a string",
        DeValue::Integer(_) | DeValue::Float(_) => "a number",
        DeValue::Boolean(_) => "true or false",
        DeValue::Datetime(_) => "a date or time",
        DeValue::Array(_) => "an array",
        DeValue::Table(_) => "a table",
    };
    let message = format!("expected {expected}, found {found}");
    report.fault(&node.place, message, format!("write {expected}"));
}

/// All elements of an array; `None` after reporting if any is wrong.
pub fn elements<T: Read>(node: &Node<'_>, expected: &str, report: &mut Report) -> Option<Vec<At<T>>> {
    let DeValue::Array(array) = node.value else {
        wrong_type(node, expected, report);
        return None;
    };
    let mut values = Vec::new();
    let mut sound = true;
    for (index, element) in array.iter().enumerate() {
        let place = Place { span: element.span(), field: format!("{}[{index}]", node.place.field) };
        let element = Node { value: element.get_ref(), place };
        match T::read(&element, report) {
            Some(value) => values.push(At { value, place: element.place }),
            None => sound = false,
        }
    }
    sound.then_some(values)
}

/// The schema of the value alone describes it with its place.
macro_rules! same_schema {
    ($($name:ident),*) => { $(
        impl<T: JsonSchema> JsonSchema for $name<T> {
            fn inline_schema() -> bool {
                T::inline_schema()
            }
            fn schema_name() -> Cow<'static, str> {
                T::schema_name()
            }
            fn schema_id() -> Cow<'static, str> {
                T::schema_id()
            }
            fn json_schema(generator: &mut SchemaGenerator) -> Schema {
                T::json_schema(generator)
            }
        }
    )* };
}
same_schema!(Field, At);
