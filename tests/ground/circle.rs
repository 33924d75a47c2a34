//! The reference walk on a circle.

use cotillion::clip::Clip;
use cotillion::physics::ground::parts::Part;
use cotillion::physics::ground::report::GroundReport;
use cotillion::physics::ground::schedule::{Step, five_five_two, level};
use cotillion::physics::ground::target::Target;
use cotillion::physics::ground::{GroundSettings, ground_pass};
use cotillion::physics::posed::{PosedClip, centers_of_mass, link_places};

use crate::figure::{Figure, RADIUS, STATURE, frame_at, on_a_circle};

/// What is told of the reference is its gait and its masses, not the shape of its feet nor where its spine bends.
const QUALITATIVE: f64 = 0.15;

fn touched_up(figure: &Figure, schedule: Vec<Step>) -> (Clip, GroundReport) {
    let target = Target::Hull { margin: 0.0 };
    let settings = GroundSettings { schedule, rounds: 1, target, ..GroundSettings::default() };
    ground_pass(&figure.clip, &figure.body, &figure.stages, None, &settings).expect("a sound walk")
}

/// Mean distances before and after each step, tenths of a stature.
fn curve(schedule: Vec<Step>) -> Vec<f64> {
    let (_, report) = touched_up(&on_a_circle(), schedule);
    let all = std::iter::once(&report.before).chain(report.steps.iter().map(|step| &step.judged));
    all.map(|judged| judged.distance[0].expect("it stands").mean / (0.1 * STATURE)).collect()
}

/// Steps of the reference, whose arms turned as far as they were asked to.
fn with_free_arms(schedule: Vec<Step>) -> Vec<Step> {
    let free =
        |step: Step| if step.turned == [Part::Arms] { Step { largest_turn: 3.2, ..step } } else { step };
    schedule.into_iter().map(free).collect()
}

fn is_near(found: f64, stated: f64, tolerance: f64) -> bool {
    (found / stated - 1.0).abs() < tolerance
}

#[test]
fn the_walk_comes_nearer_at_every_step() {
    for schedule in [level(), five_five_two()] {
        for schedule in [with_free_arms(schedule.clone()), schedule] {
            let curve = curve(schedule);
            assert!(curve.windows(2).all(|pair| pair[1] < pair[0]), "{curve:?}");
        }
    }
}

#[test]
fn the_walk_starts_as_far_off_as_the_reference() {
    let (_, report) = touched_up(&on_a_circle(), level());
    let start = report.before.distance[0].expect("it stands");
    // Shares are stated to a hundredth.
    assert!((start.outside - 0.91).abs() < 0.01, "{start:?}");
}

#[test]
fn the_walk_comes_as_near_as_the_reference() {
    let three = curve(with_free_arms(level()));
    let twelve = curve(with_free_arms(five_five_two()));
    let of_three = three.into_iter().zip([0.557, 0.488, 0.309, 0.175]);
    let of_twelve = [twelve[5], twelve[10], twelve[12]].into_iter().zip([0.383, 0.099, 0.031]);
    for (found, stated) in of_three.chain(of_twelve) {
        assert!(is_near(found, stated, QUALITATIVE), "{found} {stated}");
    }
}

#[test]
fn the_body_comes_inwards_by_five_centimetres() {
    let figure = on_a_circle();
    let (clip, _) = touched_up(&figure, five_five_two());
    let out = |clip: &Clip| {
        let posed = PosedClip::of(clip);
        let centers = centers_of_mass(&figure.body, &link_places(&figure.body, &posed));
        // Away from the ends, towards which displacements fade.
        let inner = &centers[frame_at(1.0)..frame_at(2.7)];
        inner.iter().map(|center| center.with_y(0.0).length()).sum::<f64>() / inner.len() as f64
    };
    assert!((out(&figure.clip) - RADIUS).abs() < 0.05);
    let inwards = out(&figure.clip) - out(&clip);
    assert!(is_near(inwards, 0.05, QUALITATIVE), "{inwards} m");
}
