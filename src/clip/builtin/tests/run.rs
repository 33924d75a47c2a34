//! What runs promise beside other locomotion.

use std::sync::LazyLock;

use super::super::mass::{GRAVITY, ballistic, center_of_mass};
use super::super::run::step_and_stance;
use super::walks::{contacts, cycle, steady};
use super::*;

/// A run, its body, and the seconds of its steps and stances.
struct Run {
    clip: Clip,
    body: Body,
    step: f64,
    stance: f64,
}

/// At the ends of the ranges of speed, turn and stature, and between.
static RUNS: LazyLock<Vec<Run>> = LazyLock::new(|| {
    let speeds = [2.5, 3.2, 4.5].into_iter();
    let curves = speeds.flat_map(|speed| [0.0, -45.0].map(|turn| (speed, turn)));
    let ends = curves.flat_map(|(speed, turn)| [1.2, 1.75, 2.2].map(|stature| (speed, turn, stature)));
    let runs = ends.map(|(speed, turn, stature)| {
        let clip = made("run", &[("speed", speed), ("turn", turn), ("stature", stature)]);
        let (step, stance) = step_and_stance(stature / 1.75, speed);
        Run { clip, body: Body::new(stature), step, stance }
    });
    runs.collect()
});

/// Frames of whole flights, first and last, by the gait's own clock.
fn flights(run: &Run) -> Vec<(usize, usize)> {
    let flying = |frame: &usize| {
        let since = (*frame as f64 / FPS).rem_euclid(run.step);
        since > run.stance && since < run.step - ROUNDING
    };
    let frames: Vec<usize> = (0..run.clip.frame_count()).filter(flying).collect();
    frames.chunk_by(|a, b| a + 1 == *b).map(|flight| (flight[0], flight[flight.len() - 1])).collect()
}

#[test]
fn flights_are_ballistic() {
    /// Metres; rounding of the centre of mass at tens of metres is 1e-14.
    const ON_THE_PARABOLA: f64 = 1e-9;
    for run in RUNS.iter() {
        let center = |frame: usize| center_of_mass(&run.body, &run.clip.pose(SourceFrame::from_usize(frame)));
        let flights = flights(run);
        assert!(flights.len() >= 4);
        assert!(flights.iter().map(|(first, last)| last - first).max() >= Some(2), "three frames in the air");
        for (first, last) in flights.into_iter().filter(|(first, last)| last > first) {
            let seconds = (last - first) as f64 / FPS;
            let start = center(first);
            let velocity = (center(last) - start) / seconds - DVec3::Y * (0.5 * GRAVITY * seconds);
            for frame in first..=last {
                let expected = ballistic(start, velocity, (frame - first) as f64 / FPS);
                assert!(center(frame).distance(expected) < ON_THE_PARABOLA, "{frame}");
            }
        }
    }
}

#[test]
fn feet_leave_the_ground_and_meet_it_when_flights_begin_and_end() {
    for run in RUNS.iter() {
        let [lefts, rights] = contacts(&run.clip);
        for (frame, feet) in lefts.into_iter().zip(rights).enumerate() {
            let since = (frame as f64 / FPS + ROUNDING).rem_euclid(2.0 * run.step);
            let left = since < run.stance;
            let right = (run.step..run.step + run.stance).contains(&since);
            assert_eq!((left, right), (feet.0.any(), feet.1.any()), "{frame}");
        }
    }
}

#[test]
fn runners_look_like_runners() {
    for speed in [2.5, 4.5] {
        let clip = steady("run", &[("speed", speed)]);
        let frames: Vec<_> = (0..cycle(&clip)).map(|frame| world(&clip, frame)).collect();
        let at = |role: JointRole| joint(&clip, role);
        let (heel, knee) = (at(JointRole::LeftFoot), at(JointRole::LeftKnee));
        let hip = at(JointRole::LeftHip);
        let highest = frames.iter().map(|f| f[heel].position.y).fold(0.0, f64::max);
        assert!(highest > 0.38, "the heel rises to {highest} m behind");
        let lifted = frames.iter().map(|f| f[hip].position.y - f[knee].position.y).fold(1.0, f64::min);
        assert!(lifted < 0.26, "the knee stays {lifted} m below the hip");
        let head = at(JointRole::Head);
        let (elbow, wrist) = (at(JointRole::RightElbow), at(JointRole::RightHand));
        let shoulder = at(JointRole::RightShoulder);
        for f in &frames {
            let trunk = f[head].position - f[0].position;
            let lean = trunk.z.atan2(trunk.y).to_degrees();
            assert!((4.0..16.0).contains(&lean), "leans by {lean}");
            let upper = f[elbow].position - f[shoulder].position;
            let bend = upper.angle_between(f[wrist].position - f[elbow].position).to_degrees();
            assert!((75.0..110.0).contains(&bend), "elbow bent by {bend}");
        }
    }
}
