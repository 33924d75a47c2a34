//! Pictures of clips: `cotillion inspect --picture`, `--strip` and `--graph`.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use clap::{Args, ValueEnum};
use cotillion::clip::working::WorkingClip;
use cotillion::export::files::file_names;
use cotillion::export::picture::{
    Company, PictureError, StripOptions, StripView, clip_svg, graph_svg, strip_svg, to_png,
};
use cotillion::graph::MotionGraph;
use rayon::prelude::*;

use super::Failure;
use super::capture::plain;
use super::output::{Output, PlainError};

/// What is drawn of clips.
#[derive(Clone, Debug, Args)]
pub(super) struct DrawArgs {
    /// Draw the path from above, foot heights and speed: an .svg or .png of one clip, else a folder for NAME.picture.png of each.
    #[arg(long, value_name = "FILE|DIR", help_heading = "Pictures")]
    picture: Option<PathBuf>,
    /// Draw poses side by side: an .svg or .png of one clip, else a folder for NAME.strip.png of each.
    #[arg(long, value_name = "FILE|DIR", help_heading = "Pictures")]
    strip: Option<PathBuf>,
    /// Draw the distances of all pairs of frames and the transitions: an .svg or .png of one clip, else a folder for NAME.graph.png of each.
    #[arg(long, value_name = "FILE|DIR", help_heading = "Pictures")]
    graph: Option<PathBuf>,
    /// Number of poses of a strip; those nearest to events show the events.
    #[arg(long, value_name = "N", default_value_t = 12, value_parser = clap::value_parser!(u16).range(1..=200), requires = "strip", help_heading = "Pictures")]
    poses: u16,
    /// Side from which a strip sees the body; from the side it looks to the right.
    #[arg(long, value_enum, default_value_t, requires = "strip", help_heading = "Pictures")]
    view: ViewChoice,
}

/// See [`StripView`].
#[derive(Clone, Copy, Debug, Default, ValueEnum)]
enum ViewChoice {
    #[default]
    Side,
    Front,
    Above,
    ThreeQuarter,
}

impl From<ViewChoice> for StripView {
    fn from(choice: ViewChoice) -> Self {
        match choice {
            ViewChoice::Side => Self::Side,
            ViewChoice::Front => Self::Front,
            ViewChoice::Above => Self::Above,
            ViewChoice::ThreeQuarter => Self::ThreeQuarter,
        }
    }
}

/// Width of a PNG over that of its SVG: sharp on dense screens.
const PNG_SCALE: f64 = 1.25;

/// A clip with its motion graph, if it is not too long for one.
pub(super) struct Drawable {
    pub(super) working: Arc<WorkingClip>,
    pub(super) graph: Option<MotionGraph>,
}

impl DrawArgs {
    /// Whether motion graphs are to be drawn.
    pub(super) fn asks_for_graph(&self) -> bool {
        self.graph.is_some()
    }
}

/// Draws what is asked for of all clips; nothing of none.
pub(super) fn draw(output: &Output, args: &DrawArgs, clips: &[Drawable]) -> Result<(), Failure> {
    if clips.is_empty() {
        return Ok(());
    }
    if let Some(path) = &args.picture {
        write(output, path, (clips, "picture"), |own| clip_svg(&own.working.clip))?;
    }
    if let Some(path) = &args.strip {
        let options = StripOptions { poses: usize::from(args.poses), view: args.view.into() };
        let alone = Company::default();
        write(output, path, (clips, "strip"), |own| strip_svg(&own.working.clip, &alone, &options))?;
    }
    if let Some(path) = &args.graph {
        write(output, path, (clips, "graph"), |own| {
            let graph = own.graph.as_ref().expect("who asks for graphs gets errors where there are none");
            graph_svg(&own.working, graph, 0)
        })?;
    }
    Ok(())
}

/// Writes one picture a clip, to the file `path` or into the folder `path`.
fn write(
    output: &Output,
    path: &Path,
    (clips, kind): (&[Drawable], &str),
    svg: impl Fn(&Drawable) -> String + Sync,
) -> Result<(), Failure> {
    let files = places(path, clips, kind).map_err(|error| output.fail(error))?;
    let drawn: Vec<Result<Vec<u8>, PictureError>> = clips
        .par_iter()
        .zip(&files)
        .map(|(clip, file)| {
            let svg = svg(clip);
            if is(file, "svg") { Ok(svg.into_bytes()) } else { to_png(&svg, png_width(&svg)) }
        })
        .collect();
    if let Some(folder) = files.first().filter(|file| *file != path).and_then(|file| file.parent()) {
        std::fs::create_dir_all(folder).map_err(|error| output.unwritable(folder, &error))?;
    }
    for (file, bytes) in files.iter().zip(drawn) {
        let name = file.display().to_string();
        let bytes = bytes.map_err(|error| output.fail(plain(&name, error.to_string(), None)))?;
        output.write_file(file, &bytes)?;
        output.say(&format!("{name}\n"));
    }
    Ok(())
}

/// The file of each clip.
fn places(path: &Path, clips: &[Drawable], kind: &str) -> Result<Vec<PathBuf>, PlainError> {
    if !is(path, "svg") && !is(path, "png") {
        if path.extension().is_some() && !path.is_dir() {
            let message = "pictures are written as .svg and .png".to_owned();
            let help = Some("end the name in one of these, or name a folder".to_owned());
            return Err(plain(&path.display().to_string(), message, help));
        }
        let names: Vec<&str> = clips.iter().map(|own| own.working.name.as_str()).collect();
        return Ok(file_names(&names).iter().map(|name| path.join(format!("{name}.{kind}.png"))).collect());
    }
    if clips.len() == 1 {
        return Ok(vec![path.to_owned()]);
    }
    let help = format!("name a folder: each clip gets its NAME.{kind}.png there");
    Err(plain(
        &path.display().to_string(),
        format!("one file does not hold {} clips", clips.len()),
        Some(help),
    ))
}

fn is(path: &Path, extension: &str) -> bool {
    path.extension().is_some_and(|own| own.eq_ignore_ascii_case(extension))
}

/// Pixels across a PNG of an SVG of ours.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "widths are a few thousand")]
fn png_width(svg: &str) -> u32 {
    let width = svg.split("width=\"").nth(1).and_then(|rest| rest.split('"').next());
    let width: f64 = width.and_then(|width| width.parse().ok()).unwrap_or(1000.0);
    (width * PNG_SCALE).round() as u32
}
