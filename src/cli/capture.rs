//! Clips named on the command line: files with what is known better about them, and generated ones.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use clap::Args;
use cotillion::clip::builtin;
use cotillion::clip::file::{FileError, read_file};
use cotillion::clip::read::{ReadClip, ReadOptions, Up};
use cotillion::index::SourceFrame;
use cotillion::skeleton::JointRole;

use super::output::PlainError;

/// How the files named beside it are read.
#[derive(Debug, Args)]
pub(crate) struct ReadArgs {
    /// Skeleton (ASF) of an .amc; left out, the .asf beside it whose name its own starts with.
    #[arg(long, value_name = "FILE.asf")]
    skeleton: Option<PathBuf>,
    /// Frames per second, where the file is silent or wrong.
    #[arg(long, allow_negative_numbers = true)]
    fps: Option<f64>,
    /// Unit of length: m, cm, inch, or metres per file unit.
    #[arg(long, allow_negative_numbers = true)]
    unit: Option<String>,
    /// Axis that points up: y or z.
    #[arg(long)]
    up: Option<String>,
    /// Joint of a role, over what its name tells, as in left_hand=LeftWrist; may be repeated.
    #[arg(long, value_name = "ROLE=JOINT")]
    role: Vec<String>,
    /// First and last frame to use, as in 12..116; left out, all but a rest pose at frame 0 and what is frozen at the ends.
    #[arg(long, value_name = "FIRST..LAST")]
    frames: Option<String>,
    /// Refuse what would only be warned of.
    #[arg(long)]
    strict: bool,
    /// Fill in single frames that are no numbers or cannot be motion, and say which.
    #[arg(long)]
    repair: bool,
}

impl ReadArgs {
    /// What is known better than the files.
    pub(crate) fn options(&self) -> Result<ReadOptions, PlainError> {
        if let Some(fps) = self.fps.filter(|fps| !is_positive(*fps) || *fps > FASTEST) {
            let expected = format!("a number of frames per second above 0 and at most {FASTEST}");
            return Err(wrong_option("--fps", &fps.to_string(), &expected));
        }
        let up = match self.up.as_deref() {
            None => None,
            Some("y" | "Y") => Some(Up::Y),
            Some("z" | "Z") => Some(Up::Z),
            Some(other) => return Err(wrong_option("--up", other, "y or z")),
        };
        let unit_to_m = self.unit.as_deref().map(|name| metres_of_unit("--unit", name)).transpose()?;
        Ok(ReadOptions { fps: self.fps, unit_to_m, up, roles: self.roles()?, repair: self.repair })
    }

    fn roles(&self) -> Result<BTreeMap<JointRole, String>, PlainError> {
        let wrong = |text: &str| {
            let names = JointRole::ALL.map(JointRole::name).join(", ");
            let help = Some(format!("the roles are {names}"));
            plain("--role", format!("\"{text}\" is not ROLE=JOINT with the name of a role"), help)
        };
        let pair = |text: &String| {
            let (role, joint) = text.split_once('=').ok_or_else(|| wrong(text))?;
            Ok((JointRole::named(role.trim()).ok_or_else(|| wrong(text))?, joint.trim().to_owned()))
        };
        self.role.iter().map(pair).collect()
    }

    /// Reads the file `path`, or generates `builtin:NAME` or `builtin:NAME,PARAMETER=VALUE,…`.
    pub(crate) fn read(&self, path: &Path, options: &ReadOptions) -> Result<ReadClip, PlainError> {
        match path.to_str().and_then(|text| text.strip_prefix("builtin:")) {
            Some(asked) => generated(asked),
            None => self.read_file(path, options),
        }
    }

    fn read_file(&self, path: &Path, options: &ReadOptions) -> Result<ReadClip, PlainError> {
        let mut read =
            read_file(path, self.skeleton.as_deref(), options).map_err(|error| plain_of(&error))?;
        if let Some([first, last]) = self.frames(read.clip.frame_count())? {
            read.use_frames(first, last);
        }
        if !self.strict {
            return Ok(read);
        }
        read.strictly().map_err(|error| plain_of(&FileError::Read { path: path.to_owned(), error }))
    }

    /// First and last frame to use, of `count`.
    fn frames(&self, count: usize) -> Result<Option<[SourceFrame; 2]>, PlainError> {
        let Some(text) = &self.frames else {
            return Ok(None);
        };
        let number = |text: &str| text.trim().parse::<u32>().ok();
        let pair = text.split_once("..").and_then(|(first, last)| Some([number(first)?, number(last)?]));
        match pair {
            Some([first, last]) if first <= last && (last as usize) < count => {
                Ok(Some([first, last].map(SourceFrame)))
            }
            _ => {
                let expected = format!("FIRST..LAST with two of the frames 0 to {}", count.saturating_sub(1));
                Err(wrong_option("--frames", text, &expected))
            }
        }
    }
}

/// More frames per second than any camera takes of people.
const FASTEST: f64 = 1000.0;

fn is_positive(value: f64) -> bool {
    value.is_finite() && value > 0.0
}

/// Metres of a unit that `option` gives by its name, or as a number.
pub(crate) fn metres_of_unit(option: &str, name: &str) -> Result<f64, PlainError> {
    let metres = match name {
        "m" => Some(1.0),
        "cm" => Some(0.01),
        "inch" => Some(0.0254),
        number => number.parse().ok().filter(|value| is_positive(*value)),
    };
    metres.ok_or_else(|| wrong_option(option, name, "m, cm, inch, or metres per file unit"))
}

fn generated(asked: &str) -> Result<ReadClip, PlainError> {
    let clip = builtin::request(asked).and_then(|(name, parameters)| builtin::generate(&name, &parameters));
    let clip = clip.map_err(|error| {
        let help = Some("`cotillion clips` lists clips and parameters".to_owned());
        plain(&format!("builtin:{asked}"), error.to_string(), help)
    })?;
    let header_fps = clip.fps;
    Ok(ReadClip { clip, unit_to_m: 1.0, up: Up::Y, header_fps, notes: Vec::new() })
}

/// Parameters of a generated clip, each given as NAME=VALUE.
pub(crate) fn parameters(given: &[String]) -> Result<BTreeMap<String, f64>, PlainError> {
    let wrong = |text: &str| wrong_option("--parameter", text, "NAME=VALUE with a finite number");
    given
        .iter()
        .map(|text| {
            let (name, value) = text.split_once('=').ok_or_else(|| wrong(text))?;
            let value: f64 = value.trim().parse().map_err(|_| wrong(text))?;
            if value.is_finite() { Ok((name.trim().to_owned(), value)) } else { Err(wrong(text)) }
        })
        .collect()
}

pub(crate) fn wrong_option(option: &str, value: &str, expected: &str) -> PlainError {
    plain(option, format!("\"{value}\" is not {expected}"), Some(format!("give {expected}")))
}

pub(crate) fn plain(file: &str, message: String, help: Option<String>) -> PlainError {
    PlainError { file: file.to_owned(), line: 0, column: 0, message, help }
}

/// The error as the command line tells it, with the place in the file if there is one.
fn plain_of(error: &FileError) -> PlainError {
    let file = error.path().display().to_string();
    let help = match error {
        // What is wrong with the text says what to do about it.
        FileError::Read { error, .. } if error.position().is_some() => None,
        _ => Some(error.help().to_owned()),
    };
    match error {
        FileError::Read { error, .. } => {
            let (line, column) = error.position().map_or((0, 0), |at| (at.line, at.column));
            PlainError { file, line, column, message: error.without_position(), help }
        }
        other => plain(&file, other.to_string(), help),
    }
}
