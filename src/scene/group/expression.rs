//! Placeholders of groups: `{n}`, `{n+1}`, `{2.5*i-1}` between braces in texts.

use std::fmt;

use toml::de::DeValue;

/// A name, perhaps times a number, perhaps plus or minus a number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Expression<'a> {
    /// A key of the group, or `i`.
    pub name: &'a str,
    factor: Option<Number>,
    addend: Option<Number>,
}

/// A number, whole as long as only whole ones meet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Number {
    /// Without point and exponent.
    Whole(i64),
    /// Any other.
    Real(f64),
}

/// Part of a text.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Part<'a> {
    /// Stays as it is.
    Plain(&'a str),
    /// Gives way to its value.
    Filled(Expression<'a>),
}

/// Why a text with braces cannot be filled in.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Unfillable {
    /// A brace without its partner.
    #[error("a brace has no partner")]
    LonelyBrace,
    /// What stands between braces is no placeholder.
    #[error("\"{{{0}}}\" is no placeholder")]
    NoPlaceholder(String),
    /// The group has no such column.
    #[error("no column \"{0}\"")]
    Unknown(String),
    /// A value that is no number is to be reckoned with.
    #[error("\"{0}\" is no number here, and cannot be reckoned with")]
    NoNumber(String),
    /// A list or a table would have to become part of a text.
    #[error("\"{0}\" is a list or table here, which cannot be part of a text")]
    NoText(String),
    /// The result of a sum or product is too large.
    #[error("the result of \"{0}\" is too large")]
    TooLarge(String),
}

impl Expression<'_> {
    /// Whether it is a name and nothing else.
    pub const fn is_plain(&self) -> bool {
        self.factor.is_none() && self.addend.is_none()
    }

    /// Its value where the name stands for `value`, a number.
    ///
    /// # Errors
    /// [`Unfillable::NoNumber`], [`Unfillable::TooLarge`].
    pub fn reckon(&self, value: &DeValue<'_>) -> Result<Number, Unfillable> {
        let number = Number::of(value).ok_or_else(|| Unfillable::NoNumber(self.name.to_owned()))?;
        self.of(number)
    }

    /// Its value where the name stands for `number`.
    ///
    /// # Errors
    /// [`Unfillable::TooLarge`].
    pub fn of(&self, number: Number) -> Result<Number, Unfillable> {
        let product = match self.factor {
            Some(factor) => number.combined(factor, i64::checked_mul, |a, b| a * b),
            None => Some(number),
        };
        let sum = product.and_then(|product| match self.addend {
            Some(addend) => product.combined(addend, i64::checked_add, |a, b| a + b),
            None => Some(product),
        });
        sum.ok_or_else(|| Unfillable::TooLarge(self.name.to_owned()))
    }

    /// Its value as part of a text.
    ///
    /// # Errors
    /// [`Unfillable`], where the value does not fit.
    pub fn text(&self, value: &DeValue<'_>) -> Result<String, Unfillable> {
        if !self.is_plain() {
            return self.reckon(value).map(|number| number.to_string());
        }
        match value {
            DeValue::String(text) => Ok(text.to_string()),
            DeValue::Boolean(is) => Ok(is.to_string()),
            DeValue::Datetime(when) => Ok(when.to_string()),
            DeValue::Array(_) | DeValue::Table(_) => Err(Unfillable::NoText(self.name.to_owned())),
            DeValue::Integer(_) | DeValue::Float(_) => self.reckon(value).map(|number| number.to_string()),
        }
    }
}

impl Number {
    fn of(value: &DeValue<'_>) -> Option<Self> {
        match value {
            DeValue::Integer(whole) => {
                i64::from_str_radix(whole.as_str(), whole.radix()).ok().map(Self::Whole)
            }
            DeValue::Float(real) => Self::parse(real.as_str()),
            _ => None,
        }
    }

    fn parse(text: &str) -> Option<Self> {
        let whole = text.parse().ok().map(Self::Whole);
        whole.or_else(|| text.parse().ok().filter(|real: &f64| real.is_finite()).map(Self::Real))
    }

    fn combined(
        self,
        other: Self,
        whole: impl Fn(i64, i64) -> Option<i64>,
        real: impl Fn(f64, f64) -> f64,
    ) -> Option<Self> {
        if let (Self::Whole(a), Self::Whole(b)) = (self, other) {
            return whole(a, b).map(Self::Whole);
        }
        Some(real(self.real(), other.real())).filter(|result| result.is_finite()).map(Self::Real)
    }

    #[expect(clippy::cast_precision_loss, reason = "as near as f64 can say it")]
    const fn real(self) -> f64 {
        match self {
            Self::Whole(whole) => whole as f64,
            Self::Real(real) => real,
        }
    }
}

/// As TOML writes it.
impl fmt::Display for Number {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Whole(whole) => whole.fmt(f),
            Self::Real(real) => write!(f, "{real:?}"),
        }
    }
}

/// Takes a text apart; `{{` and `}}` stand for braces.
///
/// # Errors
/// [`Unfillable::LonelyBrace`], [`Unfillable::NoPlaceholder`].
pub fn parts(text: &str) -> Result<Vec<Part<'_>>, Unfillable> {
    let mut parts = Vec::new();
    let mut rest = text;
    while let Some(at) = rest.find(['{', '}']) {
        let (before, from) = rest.split_at(at);
        if from.starts_with("{{") || from.starts_with("}}") {
            parts.push(Part::Plain(&rest[..=at]));
            rest = &from[2..];
            continue;
        }
        parts.push(Part::Plain(before));
        let inside = from.strip_prefix('{').ok_or(Unfillable::LonelyBrace)?;
        let (inside, after) = inside.split_once('}').ok_or(Unfillable::LonelyBrace)?;
        let expression = expression(inside).ok_or_else(|| Unfillable::NoPlaceholder(inside.to_owned()))?;
        parts.push(Part::Filled(expression));
        rest = after;
    }
    parts.push(Part::Plain(rest));
    parts.retain(|part| *part != Part::Plain(""));
    Ok(parts)
}

/// `name`, `name*2`, `2*name`, `name+1`, `2.5*name-1`; numbers without exponents.
fn expression(text: &str) -> Option<Expression<'_>> {
    let compact = text.trim();
    let sign = compact.char_indices().skip(1).find(|(_, sign)| matches!(sign, '+' | '-'));
    let (product, addend) = match sign {
        Some((at, sign)) => {
            let amount = compact[at + 1..].trim();
            let amount = if sign == '-' { format!("-{amount}") } else { amount.to_owned() };
            (&compact[..at], Some(decimal(&amount)?))
        }
        None => (compact, None),
    };
    let (name, factor) = match product.split_once('*') {
        Some((a, b)) if is_name(a.trim()) => (a, Some(decimal(b.trim())?)),
        Some((a, b)) => (b, Some(decimal(a.trim())?)),
        None => (product, None),
    };
    let name = name.trim();
    is_name(name).then_some(Expression { name, factor, addend })
}

fn decimal(text: &str) -> Option<Number> {
    let digits = text.strip_prefix('-').unwrap_or(text);
    let is_decimal = digits.chars().all(|c| c.is_ascii_digit() || c == '.');
    if is_decimal { Number::parse(text) } else { None }
}

/// Whether a text may be the name of a column: a letter, then letters, digits and `_`.
pub fn is_name(text: &str) -> bool {
    text.starts_with(|c: char| c.is_alphabetic()) && text.chars().all(|c| c.is_alphanumeric() || c == '_')
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn value(text: &str) -> DeValue<'_> {
        DeValue::parse(text).expect("the tests write TOML").into_inner()
    }

    fn filled(text: &str, with: &str) -> Result<String, Unfillable> {
        let all = parts(text)?.into_iter().map(|part| match part {
            Part::Plain(plain) => Ok(plain.to_owned()),
            Part::Filled(expression) => expression.text(&value(with)),
        });
        all.collect()
    }

    #[test]
    fn names_sums_and_products_are_filled_in() {
        assert_eq!(filled("carrier {n}:start", "7"), Ok("carrier 7:start".to_owned()));
        assert_eq!(filled("{n-1} to {n + 1}", "7"), Ok("6 to 8".to_owned()));
        assert_eq!(filled("{2*n}, {n*2.5-1}, {-1*n+10.5}", "4"), Ok("8, 9.0, 6.5".to_owned()));
        assert_eq!(filled("{size+1}", "0x10"), Ok("17".to_owned()));
        assert_eq!(filled("{who}/walk", "\"ann\""), Ok("ann/walk".to_owned()));
        assert_eq!(filled("{{{n}}}", "1"), Ok("{1}".to_owned()));
    }

    #[test]
    fn what_cannot_be_filled_in_says_why() {
        assert_eq!(filled("{n", "1"), Err(Unfillable::LonelyBrace));
        assert_eq!(filled("n}", "1"), Err(Unfillable::LonelyBrace));
        for odd in ["{}", "{1}", "{n+}", "{n n}", "{n++1}", "{n*m}", "{n+1+1}", "{n*nan}"] {
            assert!(matches!(filled(odd, "1"), Err(Unfillable::NoPlaceholder(_))), "{odd}");
        }
        assert_eq!(filled("{n+1}", "\"a\""), Err(Unfillable::NoNumber("n".to_owned())));
        assert_eq!(filled("x{n}", "[1]"), Err(Unfillable::NoText("n".to_owned())));
        assert_eq!(filled("{n*2}", "9223372036854775807"), Err(Unfillable::TooLarge("n".to_owned())));
        assert_eq!(filled("{n*10}", "1.7e308"), Err(Unfillable::TooLarge("n".to_owned())));
        assert!(filled("{n}", "nan").is_err());
    }

    proptest! {
        #[test]
        fn no_text_panics(text in "[{}n0-9eE+*. -]{0,12}", with in -5..5_i32) {
            let with = with.to_string();
            if let Ok(filled) = filled(&text, &with) {
                prop_assert!(filled.len() <= text.len() + 400);
            }
        }

        #[test]
        fn text_without_braces_stays(text in "[^{}]{0,20}") {
            prop_assert_eq!(filled(&text, "1"), Ok(text));
        }
    }
}
