//! Generated clips as people ask for them: `walk`, `walk,speed=1.5,turn=20`.

use std::collections::BTreeMap;

use super::BuiltinError;

/// Name and parameters of `NAME,PARAMETER=VALUE,…`.
///
/// # Errors
/// [`BuiltinError::NotAParameter`] for what is no parameter with a finite number.
pub fn request(text: &str) -> Result<(String, BTreeMap<String, f64>), BuiltinError> {
    let mut words = text.split(',').map(str::trim);
    let name = words.next().unwrap_or_default().to_owned();
    let parameters = words.map(|word| {
        let value = word.split_once('=').and_then(|(name, value)| {
            let value = value.trim().parse::<f64>().ok().filter(|value| value.is_finite())?;
            Some((name.trim().to_owned(), value))
        });
        value.ok_or_else(|| BuiltinError::NotAParameter { found: word.to_owned() })
    });
    Ok((name, parameters.collect::<Result<_, _>>()?))
}
