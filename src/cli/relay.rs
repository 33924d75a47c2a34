//! `cotillion relay`: numbers in, a scene file out.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use cotillion::relay::{self, Along, Disturbance, Relay, drawing, points};
use serde::Serialize;

use super::output::{Output, PlainError};
use super::{Failure, Manner};

#[derive(Debug, Args)]
pub(crate) struct RelayArgs {
    /// Everybody: carriers and disturbers.
    #[arg(long, short = 'n', value_name = "N")]
    characters: usize,
    /// The curve: line, circle, spiral, FILE.csv or FILE.svg.
    ///
    /// A table has a point of the plan a line, in metres; the relay goes from its first to its last point. A drawing has one
    /// path (M, L, H, V, C, S, Q, T, A, Z), polyline or polygon, or the one named as in FILE.svg#ID; it is made as long as the
    /// carriers need.
    #[arg(long, value_name = "CURVE", default_value = "line")]
    along: String,
    /// Metres along the curve from one hand-over to the next; left out: 3.3, or what spreads the carriers over the points of a
    /// table.
    #[arg(long, value_name = "METRES", allow_negative_numbers = true)]
    spacing: Option<f64>,
    /// Boxes under way at the same time, each handed on to where the next one stood; left out: one for every ten characters.
    ///
    /// A box is some nine seconds with each carrier: fewer boxes make longer scenes.
    #[arg(long, value_name = "N")]
    boxes: Option<usize>,
    /// How many of the characters get in the way; left out: two of every four.
    #[arg(long, value_name = "N")]
    disturbers: Option<usize>,
    /// How they do: `aside` steps out of the carrier's way, `jump` takes a hurdle beside it, `pat` pats who waits on the back.
    #[arg(long, value_name = "HOW,…", value_enum, value_delimiter = ',', default_values_t = How::ALL)]
    disturbance: Vec<How>,
    /// Heights of bodies, metres, as in 1.64..1.86: five of them are spread over the crowd.
    #[arg(long, value_name = "FROM..TO", default_value = "1.64..1.86")]
    heights: String,
    /// Seconds by which boxes begin later than each other, and disturbers come early or late.
    #[arg(long, value_name = "SECONDS", default_value_t = 0.3, allow_negative_numbers = true)]
    phase: f64,
    /// Let steps come and go when the scene is dragged ([discrete]).
    #[arg(long)]
    discrete: bool,
    /// Drag the end on by so many metres, straight ahead of the last carrier ([[drag]]); best with --discrete.
    #[arg(long, value_name = "METRES", allow_negative_numbers = true)]
    drag: Option<f64>,
    /// Of all that is left to chance: who is how tall, who waits and who comes, who disturbs how.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Scene file to write; left out, it is printed.
    #[arg(long, short, value_name = "FILE")]
    output: Option<PathBuf>,
    #[command(flatten)]
    manner: Manner,
}

/// See [`Disturbance`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, ValueEnum)]
enum How {
    Aside,
    Jump,
    Pat,
}

impl How {
    const ALL: [Self; 3] = [Self::Aside, Self::Jump, Self::Pat];
}

impl From<How> for Disturbance {
    fn from(how: How) -> Self {
        match how {
            How::Aside => Self::Aside,
            How::Jump => Self::Jump,
            How::Pat => Self::Pat,
        }
    }
}

/// What was written.
#[derive(Debug, Serialize)]
struct Written {
    file: String,
    carriers: usize,
    boxes: usize,
    disturbers: usize,
}

pub(crate) fn relay(args: &RelayArgs) -> Result<(), Failure> {
    let output = Output::new(args.manner);
    let asked = asked(args).map_err(|error| output.fail(error))?;
    let scene = relay::relay_with_clashes(&asked, &command(args, &asked)).map_err(|error| {
        let help = Some(error.help().to_owned());
        output.fail(PlainError {
            file: "relay".to_owned(),
            line: 0,
            column: 0,
            message: error.to_string(),
            help,
        })
    })?;
    let (text, clashes) = scene;
    tell_clashes(&output, &clashes);
    match &args.output {
        None => output.print(&text),
        Some(path) => {
            output.write_file(path, text.as_bytes())?;
            let file = path.display().to_string();
            let (carriers, disturbers) = relay::counts(&asked).unwrap_or_default();
            output.say(&format!(
                "{file}: {carriers} carriers, {} box{}, {disturbers} disturbers\n",
                asked.boxes,
                if asked.boxes == 1 { "" } else { "es" }
            ));
            output.print_json(&Written { file, carriers, boxes: asked.boxes, disturbers });
        }
    }
    Ok(())
}

/// Tells who are in each other: the scene is sound all the same.
fn tell_clashes(output: &Output, clashes: &[String]) {
    /// So many are told.
    const TOLD: usize = 3;
    if clashes.is_empty() {
        return;
    }
    let more = clashes.len().saturating_sub(TOLD);
    let others = if more > 0 { format!("; {more} more") } else { String::new() };
    let told = clashes[..clashes.len() - more].join("; ");
    output.note(&format!(
        "{told}{others}; a wider curve that does not come back to where it was, another --spacing or fewer --disturbers leave more room"
    ));
}

fn asked(args: &RelayArgs) -> Result<Relay, PlainError> {
    let mut disturbances: Vec<Disturbance> =
        args.disturbance.iter().copied().map(Disturbance::from).collect();
    disturbances.sort_unstable();
    disturbances.dedup();
    let relay = Relay {
        characters: args.characters,
        disturbers: args.disturbers,
        boxes: args.boxes.unwrap_or(1),
        spacing: args.spacing,
        heights: heights(&args.heights)?,
        phase: args.phase,
        disturbances,
        discrete: args.discrete,
        drag: args.drag,
        seed: args.seed,
        along: along(&args.along)?,
    };
    let boxes = args.boxes.unwrap_or_else(|| relay.usual_boxes());
    Ok(Relay { boxes, ..relay })
}

fn heights(text: &str) -> Result<(f64, f64), PlainError> {
    let pair = text
        .split_once("..")
        .and_then(|(from, to)| Some((from.trim().parse().ok()?, to.trim().parse().ok()?)));
    pair.ok_or_else(|| {
        let message = format!("\"{text}\" is no range of heights");
        plain("--heights", (0, 0), message, "write two numbers of metres, as in 1.64..1.86")
    })
}

fn plain(file: &str, (line, column): (usize, usize), message: String, help: &str) -> PlainError {
    PlainError { file: file.to_owned(), line, column, message, help: Some(help.to_owned()) }
}

fn along(text: &str) -> Result<Along, PlainError> {
    match text {
        "line" => return Ok(Along::Line),
        "circle" => return Ok(Along::Circle),
        "spiral" => return Ok(Along::Spiral),
        _ => {}
    }
    let (path, id) = match text.rsplit_once('#') {
        Some((path, id)) if is_svg(path) => (path, Some(id)),
        _ => (text, None),
    };
    let ending = Path::new(path).extension().map(|ending| ending.to_string_lossy().to_lowercase());
    if !matches!(ending.as_deref(), Some("csv" | "txt" | "tsv" | "svg")) {
        let message = format!("\"{text}\" is no curve");
        return Err(plain(
            "--along",
            (0, 0),
            message,
            "write line, circle, spiral, or name a file that ends in .csv or .svg",
        ));
    }
    let content = std::fs::read_to_string(path).map_err(|error| {
        plain(path, (0, 0), format!("cannot be read: {error}"), "name a text file that can be read")
    })?;
    if is_svg(path) {
        let points = drawing::drawing(&content, id).map_err(|error| {
            plain(path, (error.line, error.column), error.to_string(), error.fault.help())
        })?;
        return Ok(Along::Drawing(points));
    }
    let points = points::points(&content)
        .map_err(|error| plain(path, (error.line, error.column), error.to_string(), points::HELP))?;
    Ok(Along::Points(points))
}

fn is_svg(path: &str) -> bool {
    Path::new(path).extension().is_some_and(|ending| ending.eq_ignore_ascii_case("svg"))
}

/// The command that writes the same file anywhere: all that matters, the curve by the name of its file alone.
fn command(args: &RelayArgs, asked: &Relay) -> String {
    let curve = Path::new(&args.along)
        .file_name()
        .map_or_else(String::new, |name| name.to_string_lossy().into_owned());
    let curve: String = curve.chars().filter(|c| !c.is_control()).collect();
    // A name that begins like an option is none.
    let curve = if curve.starts_with('-') { format!("./{curve}") } else { curve };
    let curve = shlex::try_quote(&curve).unwrap_or_default();
    let mut text = format!("cotillion relay --characters {} --along {curve}", asked.characters);
    if let Some(spacing) = asked.spacing {
        text += &format!(" --spacing {spacing}");
    }
    text += &format!(" --boxes {}", asked.boxes);
    if let Some(disturbers) = asked.disturbers {
        text += &format!(" --disturbers {disturbers}");
    }
    let all = Disturbance::ALL.len();
    if asked.disturbances.len() < all {
        let names: Vec<&str> = asked.disturbances.iter().map(|how| how.name()).collect();
        text += &format!(" --disturbance {}", names.join(","));
    }
    text += &format!(" --heights {}..{} --phase {}", asked.heights.0, asked.heights.1, asked.phase);
    if asked.discrete {
        text += " --discrete";
    }
    if let Some(metres) = asked.drag {
        text += &format!(" --drag {metres}");
    }
    text + &format!(" --seed {}", asked.seed)
}

#[cfg(test)]
mod tests {
    use clap::Parser;

    use super::*;

    #[derive(Parser)]
    struct Line {
        #[command(flatten)]
        args: RelayArgs,
    }

    #[test]
    fn what_nobody_asks_for_is_as_in_the_library() {
        for characters in [2, 9, 12, 78, 1000] {
            let line = Line::parse_from(["relay", "-n", &characters.to_string()]);
            let asked = asked(&line.args).unwrap_or_else(|error| panic!("{}", error.message));
            assert_eq!(asked, Relay::of(characters));
        }
    }
}
