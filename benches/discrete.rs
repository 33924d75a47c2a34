//! What one update of discrete editing costs on the workloads of the paper's Table 1.

#[path = "../tests/paths/mod.rs"]
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

const UPDATES: usize = 40;

fn run(case: &Case, evaluator: Evaluator, backend: Backend) {
    let settings = DiscreteSettings { evaluator, backend, ..DiscreteSettings::of_scene(&case.scene) };
    let mut editor = DiscreteEditor::new(case.scene.clone(), (Arc::clone(&case.graph), &case.clips), settings).expect("sound");
    let n = editor.appraise().len();
    let start = Instant::now();
    for step in 1..=UPDATES {
        for (id, target) in case.dragged(step, UPDATES) { editor.move_target(id, target).expect("target"); }
        editor.update(Occasion::Drag { drag: 0, step }).expect("solved");
    }
    let ms = start.elapsed().as_secs_f64() * 1e3 / UPDATES as f64;
    println!("{:10} {evaluator:?} candidates {n} -> {}: {ms:.2} ms an update, changes {}, energy {:.6}", case.name, editor.appraise().len(), editor.log().len(), editor.energy().total);
}

fn main() {
    for mode in [Mode::Paper, Mode::Production] {
        for published in &PUBLISHED_SCENES {
            let case = case(published, mode);
            run(&case, Evaluator::Exact, Backend::Reduced);
            run(&case, Evaluator::Subsampled, Backend::Direct);
        }
    }
}
