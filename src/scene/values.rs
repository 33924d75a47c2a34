//! Small values of scene files: numbers, names, and the choices between a word and a number.

use std::borrow::Cow;
use std::collections::BTreeMap;

use schemars::{JsonSchema, Schema, SchemaGenerator};
use toml::de::DeValue;

use crate::scene::report::{At, Place, Report};
use crate::scene::suggest;
use crate::scene::tree::{Field, Keys, Node, Read, elements, wrong_type};

/// No number of a scene file is larger than this; what is larger is a slip, and would overflow later.
pub const LARGEST_NUMBER: f64 = 1e9;

/// Two of a kind, in an array.
pub type Pair<T> = [At<T>; 2];

/// Three of a kind, in an array.
pub type Triple<T> = [At<T>; 3];

impl Read for String {
    fn read(node: &Node<'_>, report: &mut Report) -> Option<Self> {
        let DeValue::String(text) = node.value else {
            wrong_type(node, "a string in quotes", report);
            return None;
        };
        Some(text.to_string())
    }
}

impl Read for bool {
    fn read(node: &Node<'_>, report: &mut Report) -> Option<Self> {
        let value = node.value.as_bool();
        if value.is_none() {
            wrong_type(node, "true or false", report);
        }
        value
    }
}

impl Read for f64 {
    fn read(node: &Node<'_>, report: &mut Report) -> Option<Self> {
        let value = match node.value {
            DeValue::Integer(_) => whole_number(node.value),
            DeValue::Float(float) => float.as_str().parse().ok(),
            _ => {
                wrong_type(node, "a number", report);
                return None;
            }
        };
        match value {
            Some(value) if f64::abs(value) <= LARGEST_NUMBER => Some(value),
            Some(value) if !f64::is_finite(value) => {
                let message = "nan and inf are not allowed";
                report.fault(&node.place, message, "write a finite number");
                None
            }
            _ => {
                let help = format!("write a number between -{LARGEST_NUMBER:e} and {LARGEST_NUMBER:e}");
                report.fault(&node.place, "the number is too large", help);
                None
            }
        }
    }
}

/// Frame of a clip's file.
impl Read for u32 {
    fn read(node: &Node<'_>, report: &mut Report) -> Option<Self> {
        let value = match node.value {
            DeValue::Integer(whole) => Self::from_str_radix(whole.as_str(), whole.radix()).ok(),
            _ => None,
        };
        if value.is_none() {
            let message = "expected a frame number";
            let help = "write a whole number from 0 to 4294967295: frames of the file count from 0";
            report.fault(&node.place, message, help);
        }
        value
    }
}

#[expect(clippy::cast_precision_loss, reason = "the file's number as near as f64 can say it")]
fn whole_number(value: &DeValue<'_>) -> Option<f64> {
    let whole = value.as_integer()?;
    let value = i128::from_str_radix(whole.as_str(), whole.radix()).ok()?;
    Some(value as f64)
}

impl<T: Read> Read for Vec<At<T>> {
    fn read(node: &Node<'_>, report: &mut Report) -> Option<Self> {
        elements(node, "an array", report)
    }
}

impl<T: Read, const N: usize> Read for [At<T>; N] {
    fn read(node: &Node<'_>, report: &mut Report) -> Option<Self> {
        let expected = format!("an array of {N} values");
        let values = elements(node, &expected, report)?;
        let count = values.len();
        let array = values.try_into().ok();
        if array.is_none() {
            let message = format!("expected {N} values, found {count}");
            report.fault(&node.place, message, format!("write {expected}"));
        }
        array
    }
}

/// An array of tables, one `[[key]]` each.
#[derive(Clone, Debug, JsonSchema)]
#[schemars(transparent, inline)]
pub struct Tables<T>(pub Vec<At<T>>);

impl<T> Field<Tables<T>> {
    /// All tables of the kind.
    pub fn tables(&self) -> &[At<T>] {
        self.value().map_or(&[], |tables| &tables.0)
    }
}

impl<T: Read> Read for Tables<T> {
    fn read(node: &Node<'_>, report: &mut Report) -> Option<Self> {
        let key = &node.place.field;
        if node.value.is_table() {
            let message = format!("[{key}] is one table, but there may be many");
            report.fault(&node.place, message, format!("write [[{key}]] in double brackets"));
            let place = Place { field: format!("{key}[0]"), ..node.place.clone() };
            let node = Node { value: node.value, place };
            let value = T::read(&node, report)?;
            return Some(Self(vec![At { value, place: node.place }]));
        }
        elements(node, &format!("tables headed [[{key}]]"), report).map(Self)
    }
}

/// A table whose keys are names of the author's choice, in the order of the file.
#[derive(Clone, Debug)]
pub struct Named<T>(pub Vec<(String, At<T>)>);

impl<T: Read> Read for Named<T> {
    fn read(node: &Node<'_>, report: &mut Report) -> Option<Self> {
        let values = Keys::of(node, report)?.remaining();
        let mut values: Vec<_> = values.into_iter().collect();
        values.sort_by_key(|(_, value)| value.place.span.start);
        Some(Self(values))
    }
}

impl<T: JsonSchema> JsonSchema for Named<T> {
    fn inline_schema() -> bool {
        true
    }
    fn schema_name() -> Cow<'static, str> {
        BTreeMap::<String, T>::schema_name()
    }
    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        BTreeMap::<String, T>::json_schema(generator)
    }
}

/// One of a few words.
pub trait Word: Sized {
    /// All of them.
    const WORDS: &'static [&'static str];

    /// The choice that `word` stands for.
    fn from_word(word: &str) -> Option<Self>;
}

/// Writes a choice between words.
macro_rules! words {
    ($(#[$meta:meta])* $name:ident { $($(#[$variant_meta:meta])* $variant:ident = $word:literal,)+ }) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, JsonSchema)]
        pub enum $name {
            $($(#[$variant_meta])* #[schemars(rename = $word)] $variant,)+
        }

        impl Word for $name {
            const WORDS: &'static [&'static str] = &[$($word),+];

            fn from_word(word: &str) -> Option<Self> {
                match word {
                    $($word => Some(Self::$variant),)+
                    _ => None,
                }
            }
        }

        impl Read for $name {
            fn read(node: &Node<'_>, report: &mut Report) -> Option<Self> {
                let choice = node.value.as_str().and_then(Self::from_word);
                if choice.is_none() {
                    not_a_choice(node, Self::WORDS, "", report);
                }
                choice
            }
        }
    };
}

pub(crate) use words;

words! {
    /// Whose settings hold.
    Mode {
        /// The published method.
        Paper = "paper",
        /// What serves users best.
        Production = "production",
    }
}

words! {
    /// The axis of a clip's file that points up.
    Up {
        /// y is up.
        Y = "y",
        /// z is up.
        Z = "z",
    }
}

words! {
    /// Where a way turns.
    Turning {
        /// Counter-clockwise seen from above.
        Left = "left",
        /// Clockwise seen from above.
        Right = "right",
    }
}

words! {
    /// How planted feet hold.
    Plants {
        /// With the small drift of their capture.
        AsCaptured = "as-captured",
        /// Without any drift, as long as no joint turns far for it.
        Pinned = "pinned",
        /// Without any drift from the first frame of each contact to its last.
        Whole = "whole",
    }
}

words! {
    /// The quantity as it was before the edit.
    Rest {
        /// As before the edit.
        Rest = "rest",
    }
}

words! {
    /// The quantity is not held.
    Free {
        /// Not held.
        Free = "free",
    }
}

words! {
    /// The constraint holds exactly.
    Hard {
        /// Exactly.
        Hard = "hard",
    }
}

words! {
    /// A unit of length by name.
    UnitName {
        /// Metres.
        Metre = "m",
        /// Centimetres.
        Centimetre = "cm",
        /// Inches of 2.54 cm.
        Inch = "inch",
    }
}

/// Reports that `node` is none of `words`; `or` names what else it may be: ` or a number`.
pub fn not_a_choice(node: &Node<'_>, words: &[&str], or: &str, report: &mut Report) {
    let expected = suggest::list(words).replace(", ", " or ") + or;
    let Some(found) = node.value.as_str() else {
        wrong_type(node, &expected, report);
        return;
    };
    let message = format!("expected {expected}, found \"{found}\"");
    let meant = suggest::closest(found, words.iter().copied());
    let meant = meant.map_or(String::new(), |meant| format!("did you mean \"{meant}\"? "));
    report.fault(&node.place, message, format!("{meant}write {expected}"));
}

/// What may stand in the place of a word.
pub trait Alternative: Read {
    /// What people call it.
    const NOUN: &'static str;

    /// Whether `value` is meant to be one.
    fn is_meant(value: &DeValue<'_>) -> bool;
}

impl Alternative for f64 {
    const NOUN: &'static str = "a number";

    fn is_meant(value: &DeValue<'_>) -> bool {
        value.is_integer() || value.is_float()
    }
}

impl Alternative for Pair<f64> {
    const NOUN: &'static str = "an array of two numbers";

    fn is_meant(value: &DeValue<'_>) -> bool {
        value.is_array()
    }
}

impl Alternative for Triple<f64> {
    const NOUN: &'static str = "an array of three numbers";

    fn is_meant(value: &DeValue<'_>) -> bool {
        value.is_array()
    }
}

/// A word, or something else.
#[derive(Clone, Debug, JsonSchema)]
#[schemars(untagged, inline)]
pub enum WordOr<W, T> {
    /// The word.
    Word(W),
    /// Something else.
    Other(T),
}

impl<W: Word, T: Alternative> Read for WordOr<W, T> {
    fn read(node: &Node<'_>, report: &mut Report) -> Option<Self> {
        if T::is_meant(node.value) {
            return T::read(node, report).map(Self::Other);
        }
        let word = node.value.as_str().and_then(W::from_word);
        if word.is_none() {
            not_a_choice(node, W::WORDS, &format!(" or {}", T::NOUN), report);
        }
        word.map(Self::Word)
    }
}

/// How strongly a constraint holds: `"hard"`, or a weight.
pub type Strength = WordOr<Hard, f64>;
/// `"free"`, or metres ahead and to the left.
pub type Offset = WordOr<Free, Pair<f64>>;
/// `"rest"`, or degrees.
pub type RelativeFacing = WordOr<Rest, f64>;
/// `"rest"`, or degrees about three axes.
pub type Turn = WordOr<Rest, Triple<f64>>;
/// Unit of length: `"m"`, `"cm"`, `"inch"`, or metres per unit of the file.
pub type Unit = WordOr<UnitName, f64>;

/// A moment, or the two moments of an interval; or, without `:`, an object.
#[derive(Clone, Debug, JsonSchema)]
#[schemars(untagged, inline)]
pub enum OneOrPair {
    /// A moment or an object.
    One(String),
    /// An interval.
    Pair(Pair<String>),
}

impl Read for OneOrPair {
    fn read(node: &Node<'_>, report: &mut Report) -> Option<Self> {
        match node.value {
            DeValue::String(_) => String::read(node, report).map(Self::One),
            DeValue::Array(_) => Pair::read(node, report).map(Self::Pair),
            _ => {
                wrong_type(node, "a moment, a pair of moments, or an object", report);
                None
            }
        }
    }
}

words! {
    /// Type of a discrete change.
    ChangeKind {
        /// Frames are taken out.
        Delete = "delete",
        /// Frames are shown twice.
        Duplicate = "duplicate",
        /// Frames from elsewhere are put in.
        Insert = "insert",
        /// Frames give way to others.
        Replace = "replace",
    }
}

words! {
    /// How candidates for discrete changes are weighed.
    Evaluator {
        /// In rising order of a lower bound, until what is left cannot win.
        Exact = "exact",
        /// All of them, for the same choice.
        BruteForce = "brute-force",
        /// All of them on every 25th frame, as published.
        Subsampled = "subsampled",
    }
}
