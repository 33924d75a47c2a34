//! The condensed time system gives what the full one gives: times, energies, reports.

use cotillion::constraint::Strength;
use cotillion::edit::settings::Backend;
use cotillion::edit::temporal::{TemporalComponent, TemporalError, TemporalSettings};
use cotillion::edit::time_row::{StepBounds, TimePoint, TimeRow};
use cotillion::index::ConstraintId;
use proptest::prelude::*;

/// Times agree to this, seconds: they stay below 100 s, and systems of some hundred rows lose four digits of 1e-16.
const SAME_TIME: f64 = 1e-9;
/// Energies agree to this share.
const SAME_ENERGY: f64 = 1e-8;
/// And energies below this are rounding: squares of residuals of 1e-8 s, which is what the least squares of differences of
/// times around 10 s, held to 1e-15 relative, may leave of a residual that should be 0.
const NO_ENERGY: f64 = 1e-14;

/// Frames of the tracks and rows on them.
#[derive(Clone, Debug)]
struct Scenario {
    counts: Vec<usize>,
    rows: Vec<TimeRow>,
}

/// A moment of one of the tracks: whole or between frames, now and then beyond the last.
fn moment(counts: Vec<usize>) -> impl Strategy<Value = TimePoint> {
    let beyond = prop_oneof![8 => Just(None), 1 => (0.05..0.95_f64).prop_map(Some)];
    (0..counts.len(), 0.0..1.0_f64, any::<bool>(), beyond).prop_map(move |(track, share, whole, beyond)| {
        let last = counts[track] as f64 - 1.0;
        let frame = if whole { (share * last).round() } else { share * last };
        TimePoint { track, frame: beyond.filter(|_| last > 0.0).map_or(frame, |beyond| last + beyond) }
    })
}

fn strength() -> impl Strategy<Value = Strength> {
    prop_oneof![Just(Strength::Hard), (0.01..100.0_f64).prop_map(Strength::Soft)]
}

fn scenario() -> impl Strategy<Value = Scenario> {
    prop::collection::vec(1..90_usize, 1..5).prop_flat_map(|counts| {
        let other = prop::option::of(moment(counts.clone()));
        let row = (moment(counts.clone()), other, strength(), -0.4..0.4_f64);
        prop::collection::vec(row, 0..9).prop_map(move |rows| Scenario {
            rows: rows.into_iter().zip(0..).map(|(row, id)| time_row(row, id)).collect(),
            counts: counts.clone(),
        })
    })
}

/// A row that misses the rest times by `change` seconds.
fn time_row(
    (at, minus, strength, change): (TimePoint, Option<TimePoint>, Strength, f64),
    id: u32,
) -> TimeRow {
    let seconds = (at.frame - minus.map_or(0.0, |minus| minus.frame)) / 30.0 + change;
    TimeRow { constraint: ConstraintId(id), strength, at, minus, seconds }
}

fn component(scenario: &Scenario, bounds: Option<StepBounds>, backend: Backend) -> TemporalComponent {
    let settings = TemporalSettings { bounds, backend, ..TemporalSettings::default() };
    TemporalComponent::new(scenario.counts.clone(), scenario.rows.clone(), settings)
}

fn same_energy(a: f64, b: f64, scale: f64) -> bool {
    (a - b).abs() <= SAME_ENERGY * scale + NO_ENERGY
}

/// Solves with both and compares whatever comes out.
fn compare(reduced: &mut TemporalComponent, direct: &mut TemporalComponent) -> Result<(), TestCaseError> {
    prop_assert_eq!(reduced.redundant(), direct.redundant());
    match (reduced.solve(), direct.solve()) {
        (Ok(()), Ok(())) => {
            let times = reduced.times.iter().flatten().zip(direct.times.iter().flatten());
            for (a, b) in times {
                prop_assert!((a - b).abs() < SAME_TIME, "{a} is not {b}");
            }
            prop_assert!(same_energy(reduced.energy.0, direct.energy.0, direct.energy.0));
            prop_assert!(same_energy(reduced.energy.1, direct.energy.1, direct.energy.1));
            prop_assert_eq!(reduced.active_steps, direct.active_steps);
            Ok(())
        }
        (Err(a), Err(b)) => same_error(&a, &b),
        (a, b) => Err(TestCaseError::fail(format!("reduced: {a:?}, direct: {b:?}"))),
    }
}

fn same_error(a: &TemporalError, b: &TemporalError) -> Result<(), TestCaseError> {
    use TemporalError::{Conflict, Infeasible};
    match (a, b) {
        (Conflict { constraints: a, miss: x }, Conflict { constraints: b, miss: y })
        | (Infeasible { constraints: a, deficit: x }, Infeasible { constraints: b, deficit: y }) => {
            prop_assert_eq!(a, b);
            prop_assert!((x - y).abs() < SAME_TIME);
        }
        _ => prop_assert_eq!(a, b),
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn condensed_and_full_system_agree(scenario in scenario(), drags in prop::collection::vec(-0.2..0.2_f64, 2)) {
        let mut reduced = component(&scenario, None, Backend::Reduced);
        let mut direct = component(&scenario, None, Backend::Direct);
        compare(&mut reduced, &mut direct)?;
        for drag in drags {
            for dragged in [&mut reduced, &mut direct] {
                dragged.rows.iter_mut().take(1).for_each(|row| row.seconds += drag);
            }
            compare(&mut reduced, &mut direct)?;
        }
    }

    #[test]
    fn with_bounds_they_agree_too(scenario in scenario(), min in 0.3..0.95_f64, max in 1.05..1.9_f64) {
        let bounds = Some(StepBounds { min, max });
        let mut reduced = component(&scenario, bounds, Backend::Reduced);
        let mut direct = component(&scenario, bounds, Backend::Direct);
        compare(&mut reduced, &mut direct)?;
    }
}

#[test]
fn at_rest_frames_are_where_they_were_to_the_last_bit() {
    let scenario = Scenario { counts: vec![70], rows: Vec::new() };
    let mut component = component(&scenario, None, Backend::Reduced);
    component.solve().expect("nothing is asked for");
    for (frame, time) in component.times[0].iter().enumerate() {
        assert_eq!(*time, frame as f64 * (1.0 / 30.0));
    }
    assert_eq!(component.energy, (0.0, 0.0));
}

#[test]
fn a_failed_solve_leaves_the_last_times() {
    let at = |frame: f64| TimePoint { track: 0, frame };
    let row = |id, frame, seconds| TimeRow {
        constraint: ConstraintId(id),
        strength: Strength::Hard,
        at: at(frame),
        minus: None,
        seconds,
    };
    let scenario = Scenario { counts: vec![60], rows: vec![row(0, 0.0, 0.0), row(1, 30.0, 1.2)] };
    for backend in [Backend::Reduced, Backend::Direct] {
        let mut component = component(&scenario, Some(StepBounds { min: 0.5, max: 1.5 }), backend);
        component.solve().expect("1.2 times as slow is allowed");
        let before = (component.times.clone(), component.energy);
        component.rows[1].seconds = 2.0;
        assert!(matches!(component.solve(), Err(TemporalError::Infeasible { .. })));
        assert_eq!((component.times.clone(), component.energy), before);
    }
}
