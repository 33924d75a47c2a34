//! Commands of the program. Exit codes: 0 done, 1 no result (hard constraints cannot be satisfied, a benchmark failed), 2 wrong usage or bad input.

mod bench;
mod bvh_args;
mod cache;
mod capture;
mod check;
mod convert;
mod draw;
mod inspect;
mod interrupt;
mod merge;
mod output;
mod produce;
mod relay;
mod run;
mod summary;
mod touch_up;

use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Args, Parser, Subcommand, ValueEnum};
use cotillion::edit::Backend;
use cotillion::export::aside::sweep;
use cotillion::export::shards::Shard;

use bvh_args::BvhArgs;
use cache::CacheArgs;
use draw::DrawArgs;
use output::Output;

/// Edits the motion of many synchronized characters: paths bend, times stretch, and every constraint holds.
#[derive(Debug, Parser)]
#[command(name = "cotillion", version, about, max_term_width = 100)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Edit a scene and write its motion, a picture and a report.
    Run(RunArgs),
    /// Join what shards of one run have made (`run --shard`): check that nothing is missing or doubled, and write one result.
    Merge(MergeArgs),
    /// Read and validate scenes; solve nothing.
    Check(CheckArgs),
    /// Show the facts of clips: skeleton, rate, units, path, contacts, flights, stationary stretches, transitions; draw them.
    Inspect(InspectArgs),
    /// Write a clip as BVH: another rate, unit, rotation order, other joint names.
    Convert(ConvertArgs),
    /// Make a clip physically plausible: turn the body a little so that the ground can bear it, let it fly on a parabola.
    TouchUp(touch_up::TouchUpArgs),
    /// List the generated clips, or write one as BVH.
    Clips(ClipsArgs),
    /// Write the scene of a crowd that hands boxes on along a curve.
    ///
    /// Carriers stand along the curve; each takes a box from the one before, turns, carries it on and hands it to the next,
    /// exactly in space and time. Others get in their way. The scene is a text file like any other: edit it, drag it, run it.
    /// The same arguments give the same file.
    Relay(relay::RelayArgs),
    /// Print the JSON Schema of scene files.
    Schema(SchemaArgs),
    /// Measure how long edits take, by size, solver and number of threads.
    Bench(bench::BenchArgs),
    /// Remove what was left in a folder by a run that was interrupted.
    #[command(hide = true)]
    Sweep {
        /// The folder.
        folder: PathBuf,
    },
}

/// How results and errors are told.
#[derive(Clone, Copy, Debug, Args)]
struct Manner {
    /// Print machine-readable results on standard output and errors, as a JSON array, on standard error.
    #[arg(long)]
    json: bool,
    /// Print nothing but errors.
    #[arg(long, short)]
    quiet: bool,
}

#[derive(Debug, Args)]
struct RunArgs {
    /// Scene file.
    scene: PathBuf,
    /// Folder for the result; made if need be.
    #[arg(long, short, value_name = "DIR")]
    output: PathBuf,
    /// Also write the picture as PNG.
    #[arg(long)]
    png: bool,
    /// Also draw the scene from above in motion (scene_animated.svg).
    #[arg(long)]
    animate: bool,
    /// Also draw poses of every character side by side, from the side and from above.
    #[arg(long)]
    strip: bool,
    /// Also draw what the touch-up changed for everybody over time, before and after (scenes with [physics]).
    #[arg(long)]
    plots: bool,
    /// Make one of several shards of the files: the first of four is 1/4; `merge` joins them.
    #[arg(long, value_name = "I/N", value_parser = shard)]
    shard: Option<Shard>,
    /// Write a BVH file of every character also where there are more than 200.
    #[arg(long, help_heading = "BVH files")]
    bvh_files: bool,
    /// Width of the PNG, pixels.
    #[arg(long, value_name = "PIXELS", default_value_t = 1600, value_parser = clap::value_parser!(u32).range(100..=10_000))]
    png_width: u32,
    /// Solver: exact reduction to the constrained frames, or a sparse LU of all frames (slower; the reference).
    #[arg(long, value_enum, default_value_t)]
    backend: BackendChoice,
    #[command(flatten)]
    bvh: BvhArgs,
    #[command(flatten)]
    cache: CacheArgs,
    #[command(flatten)]
    manner: Manner,
}

#[derive(Debug, Args)]
struct MergeArgs {
    /// Folders of the shards, or one with all of them.
    #[arg(required = true, value_name = "DIR")]
    shards: Vec<PathBuf>,
    /// Folder for the result; made if need be.
    #[arg(long, short, value_name = "DIR")]
    output: PathBuf,
    #[command(flatten)]
    manner: Manner,
}

/// `I/N`, I from 1 to N.
fn shard(text: &str) -> Result<Shard, String> {
    let wrong = || format!("{text} is not I/N with I from 1 to N, as in 1/4");
    let (number, of) = text.split_once('/').ok_or_else(wrong)?;
    let [number, of] = [number, of].map(|part| part.parse::<usize>().ok());
    let (number, of) = number.zip(of).ok_or_else(wrong)?;
    if (1..=of).contains(&number) { Ok(Shard { number, of }) } else { Err(wrong()) }
}

/// See [`Backend`].
#[derive(Clone, Copy, Debug, Default, ValueEnum)]
enum BackendChoice {
    #[default]
    Reduced,
    Direct,
}

impl From<BackendChoice> for Backend {
    fn from(choice: BackendChoice) -> Self {
        match choice {
            BackendChoice::Reduced => Self::Reduced,
            BackendChoice::Direct => Self::Direct,
        }
    }
}

#[derive(Debug, Args)]
struct CheckArgs {
    /// Scene files.
    #[arg(required = true, value_name = "SCENE")]
    scenes: Vec<PathBuf>,
    #[command(flatten)]
    manner: Manner,
}

#[derive(Debug, Args)]
struct InspectArgs {
    /// Clip files (.bvh, .amc, DeepMimic .json or .txt), or `builtin:NAME,PARAMETER=VALUE,…`.
    #[arg(required = true, value_name = "CLIP")]
    clips: Vec<PathBuf>,
    #[command(flatten)]
    read: capture::ReadArgs,
    /// When a hand or foot bears, over what is found, as in left_hand=61..64, by role or joint; may be repeated.
    #[arg(long, value_name = "JOINT=FIRST..LAST")]
    contact: Vec<String>,
    #[command(flatten)]
    draw: DrawArgs,
    #[command(flatten)]
    cache: CacheArgs,
    #[command(flatten)]
    manner: Manner,
}

#[derive(Debug, Args)]
struct ConvertArgs {
    /// Clip file (.bvh, .amc, DeepMimic .json or .txt), or `builtin:NAME,PARAMETER=VALUE,…`.
    clip: PathBuf,
    /// BVH file to write.
    #[arg(long, short, value_name = "FILE")]
    output: PathBuf,
    #[command(flatten)]
    read: capture::ReadArgs,
    #[command(flatten)]
    bvh: BvhArgs,
    #[command(flatten)]
    manner: Manner,
}

#[derive(Debug, Args)]
struct ClipsArgs {
    /// Clip to write; left out, all are listed.
    name: Option<String>,
    /// BVH file to write.
    #[arg(long, short, value_name = "FILE", requires = "name")]
    output: Option<PathBuf>,
    /// Parameter of the clip, as NAME=VALUE; may be repeated.
    #[arg(long, short, value_name = "NAME=VALUE", requires = "name")]
    parameter: Vec<String>,
    #[command(flatten)]
    bvh: BvhArgs,
    #[command(flatten)]
    manner: Manner,
}

#[derive(Debug, Args)]
struct SchemaArgs {
    /// File to write; left out, the schema is printed.
    #[arg(long, short, value_name = "FILE")]
    output: Option<PathBuf>,
}

/// Why a command ended without its result; everything is said already.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Failure {
    /// The scene is sound but its hard constraints cannot be satisfied.
    Unsatisfiable,
    /// Wrong usage or bad input.
    BadInput,
    /// Given up on Ctrl-C: the handler of signals ends the program.
    Interrupted,
    /// Part of a benchmark could not be measured.
    CaseFailed,
}

/// Parses the arguments and runs the command.
pub(crate) fn main() -> ExitCode {
    let done = match Cli::parse().command {
        Command::Run(args) => run::run(&args),
        Command::Merge(args) => merge::merge(&args),
        Command::Check(args) => check::check(&args),
        Command::Inspect(args) => inspect::inspect(&args),
        Command::Convert(args) => convert::convert(&args),
        Command::TouchUp(args) => touch_up::command(&args),
        Command::Clips(args) => inspect::clips(&args),
        Command::Relay(args) => relay::relay(&args),
        Command::Schema(args) => schema(&args),
        Command::Bench(args) => bench::bench(&args),
        Command::Sweep { folder } => {
            sweep(&folder);
            Ok(())
        }
    };
    match done.and_then(|()| Output::all_printed()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(Failure::Unsatisfiable | Failure::CaseFailed) => ExitCode::from(1),
        Err(Failure::BadInput) => ExitCode::from(2),
        Err(Failure::Interrupted) => interrupt::end(),
    }
}

fn schema(args: &SchemaArgs) -> Result<(), Failure> {
    let output = Output::new(Manner { json: false, quiet: false });
    let text = format!("{:#}\n", cotillion::scene::schema());
    match &args.output {
        None => output.print(&text),
        Some(path) => output.write_file(path, text.as_bytes())?,
    }
    Ok(())
}
