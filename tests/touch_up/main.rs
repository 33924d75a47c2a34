//! Captured walks and runs that are bent, tilted and blended become plausible, and stay what they are where nothing was edited.
//!
//! Looks in `$COTILLION_MOCAP`, else in `../shared/mocap` beside the checkout; where neither exists every test is ignored,
//! by name. With `$COTILLION_TABLE` set, every measure is printed.

mod bends;
#[path = "../captures/mod.rs"]
mod captures;
mod guard;
mod lean;
mod measure;
#[path = "../captures/performance.rs"]
mod performance;
mod performer;
mod slopes;
mod transition;
mod truths;
mod untouched;

use captures::{Run, mocap_folder};
use libtest_mimic::{Arguments, Trial};

/// A straight walk, and a jog of the same person.
const WALK: &str = "amc/cmu_16_15_walk_straight.amc";
const JOG: &str = "amc/cmu_16_35_jog_straight.amc";

fn main() {
    let arguments = Arguments::from_args();
    let folder = mocap_folder();
    let trial =
        |name: String, run: Run, file: &'static str| captures::trial(folder.as_deref(), name, run, file);
    let named: [(&str, Run); 16] = [
        ("a bent walk comes to a twentieth in nine steps with margin", bends::nine_steps_with_margin),
        ("a bent walk comes to a tenth in twelve steps without margin", bends::twelve_steps_without_margin),
        ("a bent walk leans as its curve asks when carried", bends::carried_lean),
        ("a bent walk leans half of that in twelve steps with margin", bends::hull_lean),
        ("a bent walk is as near with turns about both axes", bends::both_axes),
        ("a walk tilted uphill comes to an eighth in nine steps", slopes::nine_steps),
        ("a walk tilted uphill leans against the slope", slopes::lean),
        ("a walk that goes over into a jog comes to three tenths", transition::nine_steps),
        ("a walk that goes over into a jog leans half of what is missing", transition::lean),
        ("captured performers lean to the side that edits lean to", truths::leans),
        ("untouched captures come out as the same bytes when carried", untouched::same_bytes),
        ("untouched walks hardly change in one round", untouched::hardly_change),
        ("untouched turns and runs change little in one round", untouched::change_little),
        ("hops fall as they were captured", guard::hops_fall_as_captured),
        ("flights that would leave a jog worse are left", guard::flights_are_left),
        ("without the guard a jog and a turn would be worse by the judge", guard::is_needed),
    ];
    let mut trials: Vec<Trial> =
        named.into_iter().map(|(name, run)| trial(name.to_owned(), run, "")).collect();
    for file in guard::WALKED_OR_RUN {
        trials.push(trial(format!("{file} never ends worse by the judge"), guard::never_worse, file));
        let name = format!("{file} never ends worse by the judge when it flies");
        trials.push(trial(name, guard::never_worse_in_the_air, file));
    }
    libtest_mimic::run(&arguments, trials).exit();
}

/// Prints a measure where all are asked for.
#[expect(clippy::print_stderr, reason = "the table is asked for")]
fn tell(text: &str) {
    if std::env::var_os("COTILLION_TABLE").is_some() {
        eprintln!("{text}");
    }
}
