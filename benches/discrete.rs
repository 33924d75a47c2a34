//! What one update of discrete editing costs on the workloads of the paper's Table 1: ours, and the paper's way beside it.
//!
//! All drag the same handles through the same steps; an update solves all three systems, scores every candidate and makes the
//! change that is worth it. Clips, similar frames and the editor's first systems are given. Ours: the exact evaluator.
//!
//! The paper's way, as its §4 and §5 tell it: three systems of all frames, then for every candidate three of every 25th frame
//! and those that matter, then three of all frames with the best one. Each is the normal equations of eq. 6 and 9 in real unknowns
//! (x and y of a frame, its time), hard constraints and stationary stretches as rows with multipliers, assembled, ordered
//! (COLAMD) and factored by sparse LU. Rows of kept frames are weighted by what they stand for, without which the estimates
//! would be dozens of times too large. The paper does not say whether factorisations are kept while only targets move, so there are two:
//! *anew*, every update begins with assembling and factoring; *kept*, the systems of all frames stay factored until a change is
//! made. Systems of candidates are factored for every update in both.
//!
//! What the paper's program may have done otherwise: here the splices of candidates, with their rest paths and rows, are found
//! once and kept from update to update, dependent hard rows are sought first, each factorisation is probed by two substitutions,
//! solutions are refined until they stay, and end effectors are not enforced.
//!
//! Times are of one thread: CPU milliseconds, which other work on the machine lengthens least. Of ours, which are short, the median of
//! seven drags counts.
//!
//! `cargo bench --bench discrete`; `-- exact` leaves the paper's way out, `-- kept` only its second variant; `-- chair relay`
//! runs these scenes alone.
#![expect(clippy::print_stdout, reason = "its table is what this program is for")]

#[path = "../tests/paths/mod.rs"]
#[allow(dead_code, reason = "shared with tests that need more of it")]
mod paths;
#[path = "discrete/workload.rs"]
mod workload;

use std::sync::Arc;

use cotillion::constraint::Evaluator;
use cotillion::discrete::editor::{DiscreteEditor, Occasion};
use cotillion::discrete::settings::DiscreteSettings;
use cotillion::edit::Backend;
use cotillion::scene::Mode;
use cotillion_solvers::workload::PUBLISHED_SCENES;
use workload::{Case, case};

/// Updates of one drag; the paper's times are averages of as many.
const UPDATES: usize = 40;

/// Drags of ours, of which the median counts; the paper's way takes seconds and is run once.
const RUNS: usize = 7;

/// What a drag came to.
struct Run {
    /// Candidates at first and at last.
    candidates: (usize, usize),
    changes: usize,
    /// Ê at last.
    energy: f64,
    /// Milliseconds that an update keeps a processor busy.
    cpu: f64,
}

/// Who edits.
#[derive(Clone, Copy, PartialEq)]
enum Way {
    Ours,
    /// The paper's, with factorisations kept while targets move or not.
    Published {
        keeps: bool,
    },
}

fn run(case: &Case, way: Way) -> Run {
    let (evaluator, backend) = match way {
        Way::Ours => (Evaluator::Exact, Backend::Reduced),
        Way::Published { .. } => (Evaluator::Subsampled, Backend::Published),
    };
    let settings = DiscreteSettings { evaluator, backend, ..DiscreteSettings::of_scene(&case.scene) };
    let given = (Arc::clone(&case.graph), case.clips.as_slice());
    let mut editor = DiscreteEditor::new(case.scene.clone(), given, settings).expect("the scene is sound");
    let first = editor.candidates();
    let before = cpu_ms();
    for step in 1..=UPDATES {
        for (constraint, target) in case.dragged(step, UPDATES) {
            editor.move_target(constraint, target).expect("the constraint has such a target");
        }
        if way == (Way::Published { keeps: false }) {
            editor.reassemble();
        }
        editor.update(Occasion::Drag { drag: 0, step }).expect("there is a solution");
    }
    let updates = UPDATES as f64;
    Run {
        cpu: (cpu_ms() - before) / updates,
        changes: editor.log().len(),
        energy: editor.energy().total,
        candidates: (first, editor.candidates()),
    }
}

/// The run of the median cost of several: one of ours is over before a machine has settled.
fn median_run(case: &Case, way: Way) -> Run {
    let mut runs: Vec<Run> = (0..RUNS).map(|_| run(case, way)).collect();
    runs.sort_by(|a, b| a.cpu.total_cmp(&b.cpu));
    runs.swap_remove(RUNS / 2)
}

/// Milliseconds that all threads of this process have run; 0 where the system does not tell.
fn cpu_ms() -> f64 {
    let of_task = |task: std::io::Result<std::fs::DirEntry>| {
        let text = std::fs::read_to_string(task.ok()?.path().join("schedstat")).ok()?;
        text.split(' ').next()?.parse::<f64>().ok()
    };
    let tasks = std::fs::read_dir("/proc/self/task").into_iter().flatten();
    tasks.filter_map(of_task).sum::<f64>() / 1e6
}

fn table(mode: Mode, ways: &[Way]) {
    println!(
        "\n{mode:?} mode; CPU ms of an update on one thread, average of {UPDATES}, and how many times ours"
    );
    println!(
        "{:10} {:>6} {:>10} {:>8} {:>8} {:>17} {:>17} {:>9} / {:>9}",
        "", "frames", "candidates", "changes", "ours", "factored anew", "factors kept", "Ê ours", "theirs"
    );
    let named = |name: &str| std::env::args().any(|own| own == name);
    let any = PUBLISHED_SCENES.iter().any(|published| named(published.name));
    for published in PUBLISHED_SCENES.iter().filter(|published| !any || named(published.name)) {
        let case = case(published, mode);
        let frames: usize = published.characters.iter().map(|counts| counts.samples).sum();
        let own = median_run(&case, Way::Ours);
        let others: Vec<Run> = ways.iter().map(|way| run(&case, *way)).collect();
        let shown = |other: &Run| format!("{:.1} ({:.1}×)", other.cpu, other.cpu / own.cpu);
        let shown: String = others.iter().map(|other| format!(" {:>17}", shown(other))).collect();
        let energy = others.first().map_or(String::new(), |other| format!("{:.5}", other.energy));
        println!(
            "{:10} {frames:>6} {:>10} {:>8} {:>8.2}{shown} {:>9.5} / {energy:>9}",
            case.name,
            format!("{} → {}", own.candidates.0, own.candidates.1),
            own.changes,
            own.cpu,
            own.energy,
        );
    }
}

fn main() {
    let asked = |word: &str| std::env::args().any(|own| own == word);
    let ways: &[Way] = match (asked("exact"), asked("kept")) {
        (true, _) => &[],
        (_, true) => &[Way::Published { keeps: true }],
        _ => &[Way::Published { keeps: false }, Way::Published { keeps: true }],
    };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("threads");
    for mode in [Mode::Paper, Mode::Production] {
        pool.install(|| table(mode, ways));
    }
}
