//! Options of the command line.

use std::fmt;

/// What `--help` prints.
pub const HELP: &str = "\
Times UMFPACK, KLU and Eigen beside our own solvers on the same systems, on one thread.

  --characters 10,78,1000   sizes: paths of 200 samples each
  --relay 78                in place of these, whole drag updates of relays of so many, as `cotillion relay` writes them,
                            beside UMFPACK on their shape phase; with --all, beside every library
  --repeats N               rounds; by default 31 up to 200 characters, 7 above
  --budget SECONDS          for trying the configurations of one library on one form and size (10)
  --all                     measure all configurations, not only the best of each library and form
  --least                   least times in place of medians, for a busy machine
  --json                    print JSON in place of the table
";

/// Options with their defaults filled in.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// Sizes.
    pub characters: Vec<usize>,
    /// Relays, in place of sizes; empty: none.
    pub relays: Vec<usize>,
    /// Rounds; `None`: by size.
    pub repeats: Option<usize>,
    /// See [`Effort`](crate::race::Effort).
    pub budget: f64,
    /// See [`Effort`](crate::race::Effort).
    pub all: bool,
    /// Least times in place of medians.
    pub least: bool,
    /// JSON in place of the table.
    pub json: bool,
    /// Print [`HELP`] and nothing else.
    pub help: bool,
}

/// Why options could not be understood.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum OptionError {
    /// No such option.
    Unknown(String),
    /// An option's value is missing or not what it should be.
    Value {
        /// The option.
        option: &'static str,
        /// What it should be given.
        expected: &'static str,
    },
}

impl fmt::Display for OptionError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unknown(option) => write!(f, "no option \"{option}\" (see --help)"),
            Self::Value { option, expected } => write!(f, "{option} needs {expected}"),
        }
    }
}

/// Reads options.
///
/// # Errors
/// [`OptionError`] for the first that is not understood.
pub fn parse(mut words: impl Iterator<Item = String>) -> Result<Options, OptionError> {
    let mut options = Options {
        characters: vec![10, 78, 1000],
        relays: Vec::new(),
        repeats: None,
        budget: 10.0,
        all: false,
        json: false,
        least: false,
        help: false,
    };
    while let Some(word) = words.next() {
        match word.as_str() {
            "--characters" => options.characters = value(&mut words, "--characters", SIZES, sizes)?,
            "--relay" => options.relays = value(&mut words, "--relay", SIZES, sizes)?,
            "--repeats" => {
                options.repeats = Some(value(&mut words, "--repeats", "a number above 0", positive)?)
            }
            "--budget" => options.budget = value(&mut words, "--budget", "seconds", seconds)?,
            "--all" => options.all = true,
            "--least" => options.least = true,
            "--json" => options.json = true,
            "--help" => options.help = true,
            _ => return Err(OptionError::Unknown(word)),
        }
    }
    Ok(options)
}

const SIZES: &str = "numbers above 1, separated by commas";

fn value<T>(
    words: &mut impl Iterator<Item = String>,
    option: &'static str,
    expected: &'static str,
    read: impl Fn(&str) -> Option<T>,
) -> Result<T, OptionError> {
    words.next().and_then(|word| read(&word)).ok_or(OptionError::Value { option, expected })
}

fn sizes(text: &str) -> Option<Vec<usize>> {
    text.split(',').map(|number| number.parse().ok().filter(|&count: &usize| count > 1)).collect()
}

fn positive(text: &str) -> Option<usize> {
    text.parse().ok().filter(|&count: &usize| count > 0)
}

fn seconds(text: &str) -> Option<f64> {
    text.parse().ok().filter(|&seconds: &f64| seconds >= 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parsed(line: &str) -> Result<Options, OptionError> {
        parse(line.split_whitespace().map(str::to_owned))
    }

    #[test]
    fn options_are_read() {
        let options = parsed("--characters 78,1000 --all --budget 2.5").expect("sound options");
        assert_eq!((options.characters, options.all, options.budget), (vec![78, 1000], true, 2.5));
        assert_eq!((options.json, options.repeats), (false, None));
    }

    #[test]
    fn faulty_options_are_named() {
        assert_eq!(parsed("--al"), Err(OptionError::Unknown("--al".to_owned())));
        for faulty in ["--characters 10,x", "--characters 1", "--characters"] {
            assert_eq!(parsed(faulty), Err(OptionError::Value { option: "--characters", expected: SIZES }));
        }
        assert!(matches!(parsed("--repeats 0"), Err(OptionError::Value { option: "--repeats", .. })));
    }
}
