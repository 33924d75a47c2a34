//! Time warping gives the reference numbers, keeps its bounds, and explains what cannot be.

use cotillion::constraint::Strength;
use cotillion::edit::settings::Backend;
use cotillion::edit::temporal::{TemporalComponent, TemporalError, TemporalSettings};
use cotillion::edit::time_row::{StepBounds, TimePoint, TimeRow};
use cotillion::index::ConstraintId;
use cotillion_solvers::BoundMethod;
use proptest::prelude::*;

/// Seconds between working frames.
const H: f64 = 1.0 / 30.0;
/// Reference times and energies hold to this.
const EXACT: f64 = 1e-9;

fn point(track: usize, frame: f64) -> TimePoint {
    TimePoint { track, frame }
}

fn row(id: u32, at: TimePoint, minus: Option<TimePoint>, seconds: f64, strength: Strength) -> TimeRow {
    TimeRow { constraint: ConstraintId(id), strength, at, minus, seconds }
}

/// Two tracks of 60 and 80 frames that start, meet and end together.
fn meeting() -> Vec<TimeRow> {
    vec![
        row(0, point(0, 0.0), None, 0.0, Strength::Hard),
        row(1, point(1, 0.0), None, 0.0, Strength::Hard),
        row(2, point(0, 30.0), Some(point(1, 40.0)), 0.0, Strength::Hard),
        row(3, point(0, 59.0), Some(point(1, 79.0)), 0.0, Strength::Hard),
    ]
}

/// These settings for the condensed and for the full system.
fn both(settings: TemporalSettings) -> [TemporalSettings; 2] {
    [Backend::Reduced, Backend::Direct].map(|backend| TemporalSettings { backend, ..settings })
}

fn free() -> [TemporalSettings; 2] {
    both(TemporalSettings::default())
}

fn bounds(min: f64, max: f64) -> [TemporalSettings; 2] {
    both(TemporalSettings { bounds: Some(StepBounds { min, max }), ..TemporalSettings::default() })
}

fn build(counts: &[usize], rows: Vec<TimeRow>, settings: TemporalSettings) -> TemporalComponent {
    TemporalComponent::new(counts.to_vec(), rows, settings)
}

fn solved(counts: &[usize], rows: Vec<TimeRow>, settings: TemporalSettings) -> TemporalComponent {
    let mut component = build(counts, rows, settings);
    component.solve().expect("the reference problems have an answer");
    component
}

#[test]
fn without_constraints_time_runs_as_at_rest() {
    for settings in free() {
        let result = solved(&[50], Vec::new(), settings);
        for (i, t) in result.times[0].iter().enumerate() {
            assert!((t - i as f64 * H).abs() < 1e-12);
        }
        assert!(result.energy.0 < 1e-24);
    }
}

#[test]
fn case_t1_hard_synchronisation() {
    for settings in free() {
        let result = solved(&[60, 80], meeting(), settings);
        assert!((result.times[0][30] - 8.0 / 7.0).abs() < EXACT);
        assert!((result.times[0][59] - 2.251680672268908).abs() < EXACT);
        assert!((result.times[0][30] - result.times[1][40]).abs() < EXACT);
        assert!((result.energy.0 / 0.001610644257703081 - 1.0).abs() < EXACT);
    }
}

#[test]
fn case_t2_a_soft_end() {
    let mut rows = meeting();
    rows.push(row(4, point(0, 59.0), None, 4.0, Strength::Soft(1.0)));
    for settings in free() {
        let result = solved(&[60, 80], rows.clone(), settings);
        assert!(((result.energy.0 + result.energy.1) / 0.04555891177832813 - 1.0).abs() < EXACT);
        assert!((result.times[0][30] - 2.004712136772576).abs() < EXACT);
        assert!((result.times[0][59] - 3.949725125354907).abs() < EXACT);
    }
}

#[test]
fn case_t3_bounds_where_clamping_fails() {
    let mut rows = meeting();
    rows.push(row(4, point(0, 59.0), None, 4.0, Strength::Soft(1.0)));
    for settings in bounds(0.5, 1.5) {
        let result = solved(&[60, 80], rows.clone(), settings);
        assert!((result.times[0][30] - 1.5).abs() < EXACT);
        assert!((result.times[0][59] - 2.95).abs() < EXACT);
        assert!(((result.energy.0 + result.energy.1) / 0.560080128205128 - 1.0).abs() < EXACT);
        let first = &result.times[0];
        let at_bound = first.windows(2).filter(|pair| (pair[1] - pair[0] - 1.5 * H).abs() < 1e-9).count();
        assert_eq!(at_bound, 59);
        let paper = TemporalSettings { method: BoundMethod::PaperIteration, ..settings };
        assert!(
            build(&[60, 80], rows.clone(), paper).solve().is_err(),
            "the clamping loop has no answer here, and says so"
        );
    }
}

#[test]
fn a_uniform_stretch_costs_half_n_h_squared() {
    let rows = vec![
        row(0, point(0, 10.0), None, 0.0, Strength::Hard),
        row(1, point(0, 40.0), None, 30.0 * H * 1.3, Strength::Hard),
    ];
    for settings in free() {
        let result = solved(&[50], rows.clone(), settings);
        assert!((result.energy.0 / (0.5 * 30.0 * H * H * 0.09) - 1.0).abs() < EXACT);
        assert!((result.times[0][49] - 30.0 * H * 1.3 - 9.0 * H).abs() < EXACT);
    }
}

#[test]
fn a_duration_that_bounds_forbid_is_explained() {
    let rows = vec![row(7, point(0, 30.0), Some(point(0, 0.0)), 2.0, Strength::Hard)];
    for settings in bounds(0.5, 1.5) {
        let mut component = build(&[60], rows.clone(), settings);
        match component.solve() {
            Err(TemporalError::Infeasible { constraints, deficit }) => {
                assert_eq!(constraints, vec![ConstraintId(7)]);
                assert!((deficit - 0.5).abs() < EXACT);
            }
            other => panic!("expected an infeasible time, found {other:?}"),
        }
    }
}

#[test]
fn contradicting_times_name_both_constraints() {
    let mut rows = meeting();
    rows.push(row(4, point(0, 30.0), None, 1.2, Strength::Hard));
    rows.push(row(5, point(1, 40.0), None, 1.5, Strength::Hard));
    for settings in free() {
        let mut component = build(&[60, 80], rows.clone(), settings);
        match component.solve() {
            Err(TemporalError::Conflict { constraints, miss }) => {
                assert_eq!(constraints, vec![ConstraintId(2), ConstraintId(4), ConstraintId(5)]);
                assert!((miss - 0.3).abs() < EXACT);
            }
            other => panic!("expected a conflict, found {other:?}"),
        }
    }
}

#[test]
fn fractional_moments_are_held_between_frames() {
    let rows = vec![
        row(0, point(0, 0.0), None, 0.0, Strength::Hard),
        row(1, point(0, 20.25), None, 1.0, Strength::Hard),
    ];
    for settings in [free(), bounds(0.5, 2.0), bounds(0.5, 1.49)].concat() {
        let result = solved(&[40], rows.clone(), settings);
        let t = &result.times[0];
        assert!((0.75 * t[20] + 0.25 * t[21] - 1.0).abs() < EXACT);
    }
}

#[test]
fn a_track_that_ends_between_frames_is_stretched_evenly() {
    let rows = vec![
        row(0, point(0, 0.0), None, 0.0, Strength::Hard),
        row(1, point(0, 39.75), None, 39.75 * H * 1.2, Strength::Hard),
    ];
    for settings in [free(), bounds(0.5, 1.2)].concat() {
        let result = solved(&[40], rows.clone(), settings);
        for pair in result.times[0].windows(2) {
            assert!((pair[1] - pair[0] - 1.2 * H).abs() < EXACT);
        }
    }
    let mut rows = rows;
    rows.push(row(2, point(0, 20.0), None, 40.0 * H, Strength::Soft(100.0)));
    for settings in bounds(0.5, 1.3) {
        let result = solved(&[40], rows.clone(), settings);
        for (i, pair) in result.times[0].windows(2).enumerate() {
            let expected = if i < 20 { 1.3 } else { (39.75 * 1.2 - 20.0 * 1.3) / 19.75 };
            assert!((pair[1] - pair[0] - expected * H).abs() < EXACT);
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    /// All absolute times later by s: every frame later by s, at the same energy.
    #[test]
    fn shifting_all_times_shifts_the_result(shift in -5.0..5.0_f64, end in 1.0..3.0_f64) {
        let rows = |s: f64| vec![
            row(0, point(0, 0.0), None, s, Strength::Hard),
            row(1, point(0, 45.0), None, end + s, Strength::Soft(3.0)),
        ];
        for settings in bounds(0.5, 2.0) {
            let a = solved(&[60], rows(0.0), settings);
            let b = solved(&[60], rows(shift), settings);
            for (x, y) in a.times[0].iter().zip(&b.times[0]) {
                prop_assert!((x + shift - y).abs() < EXACT);
            }
            prop_assert!((a.energy.0 - b.energy.0).abs() < EXACT);
        }
    }

    /// Steps stay in their bounds, whatever soft targets ask for, and no feasible neighbour costs less.
    #[test]
    fn steps_stay_in_bounds_at_the_optimum(
        middle in 0.2..4.0_f64, end in 0.2..6.0_f64, w in 0.1..50.0_f64, nudge in -1.0..1.0_f64,
    ) {
        let rows = vec![
            row(0, point(0, 0.0), None, 0.0, Strength::Hard),
            row(1, point(0, 25.0), None, middle, Strength::Soft(w)),
            row(2, point(0, 59.0), None, end, Strength::Soft(2.0 * w)),
        ];
        for settings in bounds(0.5, 2.0) {
            let result = solved(&[60], rows.clone(), settings);
            for pair in result.times[0].windows(2) {
                let step = (pair[1] - pair[0]) / H;
                prop_assert!((0.5 - 1e-8..=2.0 + 1e-8).contains(&step));
            }
            let energy = |m: f64, e: f64| {
                0.5 * ((m - 25.0 * H).powi(2) / 25.0 + (e - m - 34.0 * H).powi(2) / 34.0
                    + w * (m - middle).powi(2) + 2.0 * w * (e - end).powi(2))
            };
            let (m, e) = (result.times[0][25], result.times[0][59]);
            let (m2, e2) = (m + 1e-3 * nudge, e + 1e-3 * (1.0 - nudge.abs()));
            let allowed = |a: f64, n: f64| (0.5 * n * H..=2.0 * n * H).contains(&a);
            if allowed(m2, 25.0) && allowed(e2 - m2, 34.0) {
                prop_assert!(energy(m2, e2) >= energy(m, e) - 1e-10);
            }
            prop_assert!((energy(m, e) - result.energy.0 - result.energy.1).abs() < 1e-9);
        }
    }
}
