//! What clips of jumps promise.

use std::f64::consts::TAU;

use glam::DVec3;

use super::acts::{corner_values, corners, scale};
use super::*;
use crate::clip::builtin::mass::{GRAVITY, center_of_mass};
use crate::clip::builtin::momentum::Segments;

const JUMPS: [&str; 3] = ["jump", "jump_over", "back_flip"];

/// Centres of mass of all frames, metres.
fn centers(clip: &Clip) -> Vec<DVec3> {
    let body = Body::new(1.75 * scale(clip));
    (0..clip.frame_count())
        .map(|frame| center_of_mass(&body, &clip.pose(SourceFrame::from_usize(frame))))
        .collect()
}

fn flight(clip: &Clip) -> (usize, usize) {
    (clip.events["takeoff"].as_usize(), clip.events["landing"].as_usize())
}

#[test]
fn flights_are_ballistic() {
    /// Metres.
    const ON_PARABOLA: f64 = 1e-9;
    for clip in JUMPS.into_iter().flat_map(corners) {
        let (centers, (takeoff, landing)) = (centers(clip), flight(clip));
        assert!(landing - takeoff >= 8, "{} of {} frames", clip.name, landing - takeoff);
        for k in takeoff + 1..landing {
            let second = centers[k - 1] - 2.0 * centers[k] + centers[k + 1];
            let missed = second - DVec3::Y * (GRAVITY / (FPS * FPS));
            assert!(missed.length() < ON_PARABOLA, "{} {k}: {missed}", clip.name);
        }
    }
}

#[test]
fn the_centre_of_mass_leaves_and_lands_without_a_jump_in_speed() {
    /// m/s²: with gravity five to six times the weight, which legs bear where somebody small lands from high.
    /// Most have half of it.
    const HARDEST: f64 = 52.0;
    for clip in JUMPS.into_iter().flat_map(corners) {
        let centers = centers(clip);
        for k in 1..centers.len() - 1 {
            let acceleration = (centers[k - 1] - 2.0 * centers[k] + centers[k + 1]) * (FPS * FPS);
            assert!(acceleration.length() < HARDEST, "{} {k}: {acceleration}", clip.name);
        }
    }
}

#[test]
fn feet_stand_until_the_takeoff_and_from_the_landing_on() {
    for clip in JUMPS.into_iter().flat_map(corners) {
        let (takeoff, landing) = flight(clip);
        for role in [JointRole::LeftToe, JointRole::RightToe] {
            let toe = trajectory(clip, role);
            let last = toe[clip.frame_count() - 1];
            assert!(toe[..=takeoff].iter().all(|p| p.distance(toe[0]) < ROUNDING), "{}", clip.name);
            assert!(toe[landing..].iter().all(|p| p.distance(last) < ROUNDING), "{}", clip.name);
            assert!((toe[0].y - last.y).abs() < ROUNDING);
            assert!(toe[takeoff + 1..landing].iter().all(|p| p.y > toe[0].y), "{} grazes", clip.name);
        }
        for role in [JointRole::LeftFoot, JointRole::RightFoot] {
            let ankle = trajectory(clip, role);
            let last = ankle[clip.frame_count() - 1];
            assert!(ankle[landing..].iter().all(|p| p.distance(last) < ROUNDING));
        }
    }
}

#[test]
fn a_jump_is_as_far_as_asked_and_about_as_high() {
    for (clip, values) in corners("jump").iter().zip(corner_values("jump")) {
        let values: BTreeMap<&str, f64> = values.into_iter().collect();
        let toe = trajectory(clip, JointRole::LeftToe);
        assert!((toe[clip.frame_count() - 1].z - toe[0].z - values["distance"]).abs() < ROUNDING);
        let (centers, (takeoff, _)) = (centers(clip), flight(clip));
        let up = (centers[takeoff + 1].y - centers[takeoff].y) * FPS - 0.5 * GRAVITY / FPS;
        let rise = up * up / (-2.0 * GRAVITY);
        // Half a frame more or less in the air.
        let slack = (2.0 * -GRAVITY * values["height"]).sqrt() * 0.5 / FPS;
        assert!((rise - values["height"]).abs() < slack, "{rise} of {}", values["height"]);
    }
}

#[test]
fn soles_clear_the_obstacle_that_is_jumped_over() {
    let between = [0.15, 0.2, 0.25, 0.3, 0.35].map(|height| vec![("height", height)]);
    for values in corner_values("jump_over").into_iter().chain(between) {
        let clip = made("jump_over", &values);
        let height = values.iter().find(|(name, _)| *name == "height").expect("a parameter").1;
        let toe = trajectory(&clip, JointRole::LeftToe);
        let distance = toe[clip.frame_count() - 1].z - toe[0].z;
        let obstacle = 0.5 * distance + 0.07 * scale(&clip);
        let (takeoff, landing) = flight(&clip);
        for frame in takeoff..=landing {
            let soles = soles(&clip, frame);
            let over = soles.iter().any(|p| p.z < obstacle) && soles.iter().any(|p| p.z > obstacle);
            let lowest = soles.iter().map(|p| p.y).fold(f64::INFINITY, f64::min);
            assert!(!over || lowest > height, "{frame}: {lowest} over {height}");
        }
        assert!(soles(&clip, takeoff).iter().all(|p| p.z < obstacle));
        assert!(soles(&clip, landing).iter().all(|p| p.z > obstacle));
    }
}

/// Heel and tip of the left sole.
fn soles(clip: &Clip, frame: usize) -> [DVec3; 2] {
    let frames = world(clip, frame);
    let at = |role, offset: DVec3| {
        let frame = frames[joint(clip, role)];
        frame.position + frame.rotation * (offset * scale(clip))
    };
    [
        at(JointRole::LeftFoot, DVec3::new(0.0, -0.08, -0.05)),
        at(JointRole::LeftToe, DVec3::new(0.0, -0.02, 0.07)),
    ]
}

#[test]
fn a_back_flip_turns_over_once() {
    for clip in corners("back_flip") {
        let (takeoff, landing) = flight(clip);
        let pelvis = |frame: usize| clip.pose(SourceFrame::from_usize(frame)).rotations[0];
        let turns = (takeoff..landing).map(|k| log(pelvis(k + 1) * pelvis(k).inverse()));
        let turned: DVec3 = turns.sum();
        let lean = log(pelvis(landing)).x - log(pelvis(takeoff)).x;
        assert!((turned.x - (lean - TAU)).abs() < 1e-6, "{}", turned.x.to_degrees());
        assert!(turned.y.abs() < 1e-9 && turned.z.abs() < 1e-9);
    }
}

#[test]
fn flights_keep_their_angular_momentum() {
    /// Of the momentum's largest share, between frames: what is left by central differences of turns of half a radian a frame.
    const BETWEEN_FRAMES: f64 = 0.04;
    for clip in corners("back_flip") {
        let body = Body::new(1.75 * scale(clip));
        let (takeoff, landing) = flight(clip);
        let parts = |frame: usize| Segments::of(&body, &clip.pose(SourceFrame::from_usize(frame)));
        let momenta: Vec<f64> =
            (takeoff..landing).map(|k| parts(k).angular_step(&parts(k + 1)) * FPS).collect();
        let mean = momenta.iter().sum::<f64>() / momenta.len() as f64;
        assert!(mean < 0.0);
        for momentum in &momenta {
            assert!((momentum / mean - 1.0).abs() < BETWEEN_FRAMES, "{momentum} of {mean}");
        }
    }
}

#[test]
fn who_jumps_forward_goes_forward_all_the_way() {
    for clip in [made("jump", &[]), made("jump", &[("distance", 0.9)]), made("jump_over", &[])] {
        let [takeoff, landing] = ["takeoff", "landing"].map(|event| clip.events[event].as_usize());
        for frame in takeoff..landing {
            let step = clip.root_positions[frame + 1].z - clip.root_positions[frame].z;
            assert!(step > 0.0, "{} {frame}: {} m/s", clip.name, step * FPS);
        }
    }
}
