//! The motion graph of real capture: enough transitions, in step, and where one would look for them; the table of
//! `docs/motion_graph.md`. Reported as skipped where there is no capture.
//!
//! `COTILLION_WRITE_DOCS=1` writes the table anew. A hundred thousand frames are tried with `--ignored` (a minute or two, in release).

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use cotillion::clip::file::read_file;
use cotillion::clip::inspect::TransitionFacts;
use cotillion::clip::read::ReadOptions;
use cotillion::clip::retarget::retarget;
use cotillion::clip::working::WorkingClip;
use cotillion::graph::facts::transition_facts;
use cotillion::graph::{GraphSettings, motion_graph};
use libtest_mimic::{Arguments, Failed, Trial};

/// Steady walks, and one round a spiral that begins with standing.
const STEADY: [&str; 4] = [
    "amc/cmu_16_15_walk_straight.amc",
    "bvh/cmu_12_01_walk.bvh",
    "amc/cmu_02_01_walk_straight.amc",
    "bvh/cmu_37_01_walk.bvh",
];
const SPIRAL: &str = "bvh/snu_spiral_walk_normal.bvh";
/// Stands, walks, stands.
const HALTING: &str = "bvh/snu_walk_straight_normal.bvh";

/// Least transitions a second; least share of whole cycles; least walking ones of [`HALTING`].
const PER_SECOND: f64 = 2.0;
const WHOLE_CYCLES: f64 = 0.98;
const WALKING: usize = 6;
/// Most by which the distance between the feet may differ at a transition, as a share of its range.
const FEET_APART: f64 = 0.25;
/// Frames of the large graph, and the most memory it may take, kB.
const LARGE: usize = 100_000;
const MOST_MEMORY: u64 = 4 << 20;

fn main() {
    let arguments = Arguments::from_args();
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let named = std::env::var_os("COTILLION_MOCAP").map(PathBuf::from);
    let folder = named.unwrap_or_else(|| root.join("../shared/mocap"));
    let (skipped, is_release) = (!folder.is_dir(), !cfg!(debug_assertions));
    let mut trials = Vec::new();
    let mut add = |name: &str, is_ignored: bool, test: fn(&Path) -> Result<(), Failed>| {
        let folder = folder.clone();
        trials.push(Trial::test(name, move || test(&folder)).with_ignored_flag(skipped || is_ignored));
    };
    add("steady_walks_can_go_on_from_anywhere_a_whole_cycle_on", false, steady_walks);
    add("who_stands_and_walks_can_do_more_of_either", false, halting);
    add("the_table_of_all_clips_is_what_they_give_and_feet_agree", false, table);
    add("a_hundred_thousand_frames_fit_into_4_gib", true, if is_release { large } else { needs_release });
    libtest_mimic::run(&arguments, trials).exit();
}

fn needs_release(_: &Path) -> Result<(), Failed> {
    Err("takes minutes without optimization: run it with --release".into())
}

/// The clip, without a rest pose at its start; `snu_*` are 30 frames a second whatever their header says.
fn read(folder: &Path, name: &str) -> Result<Arc<WorkingClip>, Failed> {
    let fps = name.contains("snu_").then_some(30.0);
    let options = ReadOptions { fps, ..ReadOptions::default() };
    let clip = read_file(&folder.join(name), None, &options)?.clip;
    let (first, last) = clip.usable;
    let stem = Path::new(name).file_stem().unwrap_or_default().to_string_lossy();
    Ok(Arc::new(WorkingClip::new(&stem, Arc::new(clip), first, last)))
}

fn facts(folder: &Path, name: &str) -> Result<TransitionFacts, Failed> {
    let clip = read(folder, name)?;
    let graph = motion_graph(std::slice::from_ref(&clip), &GraphSettings::default());
    Ok(transition_facts(&graph, 0, &clip))
}

fn check(holds: bool, name: &str, facts: &TransitionFacts) -> Result<(), Failed> {
    if holds { Ok(()) } else { Err(format!("{name}: {facts:?}").into()) }
}

fn steady_walks(folder: &Path) -> Result<(), Failed> {
    for name in STEADY.into_iter().chain([SPIRAL]) {
        let facts = facts(folder, name)?;
        check(facts.per_second >= PER_SECOND, name, &facts)?;
        check(facts.whole_cycles.is_some_and(|share| share >= WHOLE_CYCLES), name, &facts)?;
        check(facts.without == 0 || name == SPIRAL, name, &facts)?;
    }
    Ok(())
}

fn halting(folder: &Path) -> Result<(), Failed> {
    let facts = facts(folder, HALTING)?;
    check(facts.pairs - facts.idle >= WALKING && facts.idle > 0, HALTING, &facts)
}

/// All clips of the capture, by their paths within it.
fn names(folder: &Path) -> Result<Vec<String>, Failed> {
    let mut names = Vec::new();
    for (part, extension) in [("amc", "amc"), ("bvh", "bvh"), ("deepmimic", "txt")] {
        for entry in fs::read_dir(folder.join(part))? {
            let path = entry?.path();
            if path.extension().is_some_and(|own| own == extension) {
                names.push(format!("{part}/{}", path.file_name().unwrap_or_default().to_string_lossy()));
            }
        }
    }
    names.sort_unstable();
    Ok(names)
}

fn table(folder: &Path) -> Result<(), Failed> {
    let mut rows = String::from(HEAD);
    for name in names(folder)? {
        let facts = facts(folder, &name)?;
        check(facts.feet_apart.is_none_or(|apart| apart <= FEET_APART), &name, &facts)?;
        rows += &row(&name, &facts)?;
    }
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/motion_graph.md");
    let text = fs::read_to_string(&path)?;
    let (before, rest) = text.split_once(HEAD).ok_or("the docs have the table")?;
    let end = rest.lines().take_while(|line| line.starts_with('|')).map(|line| line.len() + 1).sum();
    let written = format!("{before}{rows}{}", &rest[end..]);
    if std::env::var_os("COTILLION_WRITE_DOCS").is_some() {
        fs::write(&path, &written)?;
    } else if written != text {
        return Err("docs/motion_graph.md has other numbers; see the head of this file".into());
    }
    Ok(())
}

const HEAD: &str = "\
| clip | frames | cycle | M | D_max | pairs | a second | idle | phase known | whole cycles | feet | turn | none near | loop |
|---|---|---|---|---|---|---|---|---|---|---|---|---|---|
";

fn row(name: &str, facts: &TransitionFacts) -> Result<String, Failed> {
    let number = |value: Option<f64>, decimals: usize| {
        value.map_or("–".to_owned(), |value| format!("{value:.decimals$}"))
    };
    let mut row = String::new();
    let stem = Path::new(name).file_stem().unwrap_or_default().to_string_lossy();
    let cycle = facts.cycle.map_or("–".to_owned(), |cycle| cycle.to_string());
    write!(row, "| {stem} | {} | {cycle} | {} ", facts.frames, number(facts.median_distance, 2))?;
    write!(row, "| {:.2} | {} | {:.1} ", facts.largest_distance, facts.pairs, facts.per_second)?;
    write!(row, "| {} | {} | {} ", facts.idle, facts.known_phase, number(facts.whole_cycles, 2))?;
    write!(row, "| {} | {}° ", number(facts.feet_apart, 2), number(facts.turn_deg, 1))?;
    writeln!(row, "| {} | {} |", facts.without, facts.looping)?;
    Ok(row.replace("–°", "–"))
}

/// All clips as often as it takes, performed by one body, so that all are compared with all.
fn large(folder: &Path) -> Result<(), Failed> {
    let body = read(folder, STEADY[0])?;
    let performed = |name: &String| -> Result<Arc<WorkingClip>, Failed> {
        let clip = Arc::new(retarget(&read(folder, name)?.clip, &body.clip)?.0);
        let (first, last) = clip.usable;
        Ok(Arc::new(WorkingClip::new(name, clip, first, last)))
    };
    let clips: Vec<Arc<WorkingClip>> = names(folder)?.iter().map(performed).collect::<Result<_, _>>()?;
    let once: usize = clips.iter().map(|clip| clip.frame_count()).sum();
    let all: Vec<Arc<WorkingClip>> = (0..LARGE.div_ceil(once)).flat_map(|_| clips.iter().cloned()).collect();
    let graph = motion_graph(&all, &GraphSettings::default());
    let status = fs::read_to_string("/proc/self/status")?;
    let peak = status.lines().find_map(|line| line.strip_prefix("VmHWM:")?.trim().strip_suffix(" kB"));
    let peak: u64 = peak.ok_or("the system tells the peak of memory")?.trim().parse()?;
    let told =
        format!("{} frames, {} pairs, {} MB", graph.frame_count(), graph.similar.len() / 2, peak / 1024);
    fs::write(Path::new(env!("CARGO_TARGET_TMPDIR")).join("large_graph.txt"), &told)?;
    let holds = graph.frame_count() >= LARGE && graph.bodies.len() == 1 && peak < MOST_MEMORY;
    if holds { Ok(()) } else { Err(told.into()) }
}
