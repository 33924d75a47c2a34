//! Discrete edits on the workloads of the paper's Table 1: what-ifs, the evaluators, and the published estimate.

#[allow(dead_code, reason = "shared with tests that need more of it")]
mod paths;
#[path = "../benches/discrete/workload.rs"]
mod workload;

use std::sync::Arc;

use cotillion::constraint::Evaluator;
use cotillion::discrete::editor::{DiscreteEditor, Occasion};
use cotillion::discrete::settings::DiscreteSettings;
use cotillion::scene::Mode;
use cotillion_solvers::workload::PUBLISHED_SCENES;
use workload::{Case, case};

/// Ê of what-ifs and of systems built anew, relative.
const WHAT_IF: f64 = 1e-8;

fn editor(case: &Case, evaluator: Evaluator) -> DiscreteEditor {
    let settings = DiscreteSettings { evaluator, ..DiscreteSettings::of_scene(&case.scene) };
    let given = (Arc::clone(&case.graph), case.clips.as_slice());
    DiscreteEditor::new(case.scene.clone(), given, settings).expect("the scene is sound")
}

fn drag(editor: &mut DiscreteEditor, case: &Case, (step, steps): (usize, usize)) -> bool {
    for (constraint, target) in case.dragged(step, steps) {
        editor.move_target(constraint, target).expect("the constraint has such a target");
    }
    editor.update(Occasion::Drag { drag: 0, step }).expect("there is a solution")
}

#[test]
fn what_ifs_are_good_to_eight_digits_and_know_every_candidate() {
    for published in &PUBLISHED_SCENES {
        let case = case(published, Mode::Paper);
        let mut editor = editor(&case, Evaluator::Exact);
        for step in 1..=4 {
            drag(&mut editor, &case, (step, 4));
            let all = editor.appraise();
            for own in all {
                let (Some(estimate), Some(energy)) = (own.estimate, own.energy) else {
                    panic!("{}: not known of {own:?}", case.name);
                };
                let off = (estimate - energy).abs();
                assert!(off <= WHAT_IF * energy, "{}: {estimate} for {energy}", case.name);
                assert!(own.bound <= energy, "{}: {own:?}", case.name);
            }
        }
    }
}

#[test]
fn the_published_estimate_leads_to_no_less_energy() {
    for published in &PUBLISHED_SCENES {
        let case = case(published, Mode::Paper);
        for step in 1..=2 {
            let after = |evaluator| {
                let mut editor = editor(&case, evaluator);
                drag(&mut editor, &case, (step, 2));
                editor.energy().total
            };
            let (own, other) = (after(Evaluator::Exact), after(Evaluator::Subsampled));
            assert!(own <= other * (1.0 + WHAT_IF), "{}: {own} and {other}", case.name);
            assert_eq!(own.to_bits(), after(Evaluator::BruteForce).to_bits(), "{}", case.name);
        }
    }
}
