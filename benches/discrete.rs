//! What one update of discrete editing costs on the workloads of the paper's Table 1: ours, and the paper's way beside it.
//!
//! Both drag the same handles through the same steps; an update solves all three systems, scores every candidate and makes the
//! change that is worth it. Clips, similar frames and the editor's first systems are given. Ours: the exact evaluator.
//! The paper's way: every candidate on every 25th frame and those that matter, with the rows weighted, then the best one on all
//! frames; each of these systems of all its frames is assembled, planned and factored by sparse LU anew, as its structure
//! changes. In its favour: complex unknowns instead of pairs of real ones, stationary stretches eliminated instead of held
//! by rows, and times by our reduction.
//!
//! `cargo bench --bench discrete`; `-- exact` leaves the paper's way out.
#![expect(clippy::print_stdout, reason = "its table is what this program is for")]

#[path = "../tests/paths/mod.rs"]
#[allow(dead_code, reason = "shared with tests that need more of it")]
mod paths;
#[path = "discrete/workload.rs"]
mod workload;

use std::sync::Arc;
use std::time::Instant;

use cotillion::constraint::Evaluator;
use cotillion::discrete::editor::{DiscreteEditor, Occasion};
use cotillion::discrete::settings::DiscreteSettings;
use cotillion::edit::Backend;
use cotillion::scene::Mode;
use cotillion_solvers::workload::PUBLISHED_SCENES;
use workload::{Case, case};

/// Updates of one drag; the paper's times are averages of as many.
const UPDATES: usize = 40;

/// What a drag came to.
struct Run {
    /// Candidates at first and at last.
    candidates: (usize, usize),
    changes: usize,
    /// Ê at last.
    energy: f64,
    /// Milliseconds of an update: passed, and spent by all threads (which other work on the machine does not lengthen as
    /// much).
    wall: f64,
    cpu: f64,
}

fn run(case: &Case, evaluator: Evaluator, backend: Backend) -> Run {
    let settings = DiscreteSettings { evaluator, backend, ..DiscreteSettings::of_scene(&case.scene) };
    let given = (Arc::clone(&case.graph), case.clips.as_slice());
    let mut editor = DiscreteEditor::new(case.scene.clone(), given, settings).expect("the scene is sound");
    let first = editor.candidates();
    let (start, before) = (Instant::now(), cpu_ms());
    for step in 1..=UPDATES {
        for (constraint, target) in case.dragged(step, UPDATES) {
            editor.move_target(constraint, target).expect("the constraint has such a target");
        }
        editor.update(Occasion::Drag { drag: 0, step }).expect("there is a solution");
    }
    if std::env::args().any(|word| word == "count") {
        let all = editor.appraise();
        println!(
            "{} of {} without estimate; {:?}",
            all.iter().filter(|a| a.estimate.is_none()).count(),
            all.len(),
            editor.energy()
        );
    }
    let updates = UPDATES as f64;
    Run {
        wall: start.elapsed().as_secs_f64() * 1e3 / updates,
        cpu: (cpu_ms() - before) / updates,
        changes: editor.log().len(),
        energy: editor.energy().total,
        candidates: (first, editor.candidates()),
    }
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

fn table(threads: usize, mode: Mode, with_paper: bool) {
    println!("\n{mode:?} mode, {threads} threads; ms of an update, average of {UPDATES}: passed (CPU)");
    println!(
        "{:10} {:>6} {:>10} {:>8} {:>18} {:>18} {:>7} {:>20}",
        "", "frames", "candidates", "changes", "ours", "paper's way", "ratio", "Ê ours / paper's"
    );
    for published in &PUBLISHED_SCENES {
        let case = case(published, mode);
        let frames: usize = published.characters.iter().map(|counts| counts.samples).sum();
        let own = run(&case, Evaluator::Exact, Backend::Reduced);
        let other = with_paper.then(|| run(&case, Evaluator::Subsampled, Backend::Direct));
        let shown = |run: &Run| format!("{:.2} ({:.2})", run.wall, run.cpu);
        let paper = other.as_ref().map_or(String::new(), shown);
        let ratio = other.as_ref().map_or(String::new(), |other| format!("{:.1}", other.cpu / own.cpu));
        let energy = other.as_ref().map_or(String::new(), |other| format!("{:.5}", other.energy));
        println!(
            "{:10} {frames:>6} {:>10} {:>8} {:>18} {paper:>18} {ratio:>7} {:>9.5} / {energy}",
            case.name,
            format!("{} → {}", own.candidates.0, own.candidates.1),
            own.changes,
            shown(&own),
            own.energy,
        );
    }
}

fn main() {
    let with_paper = std::env::args().all(|word| word != "exact");
    for threads in [1, 2] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        for mode in [Mode::Paper, Mode::Production] {
            pool.install(|| table(threads, mode, with_paper));
        }
    }
}
