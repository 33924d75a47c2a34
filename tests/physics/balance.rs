//! Zero moment points.

use std::collections::BTreeMap;
use std::sync::Arc;

use cotillion::clip::Clip;
use cotillion::clip::builtin::generate;
use cotillion::geometry::yaw;
use cotillion::index::{JointId, SourceFrame};
use cotillion::physics::ballistics::{check_flight, launch_velocity, thrown};
use cotillion::physics::body_model::{BodyModel, BodySettings, body_model};
use cotillion::physics::derivatives::{Filter, Kernel, Lanes, second_differences, smooth};
use cotillion::physics::posed::{PosedClip, centers_of_mass, link_places};
use cotillion::physics::stages::{Phase, StageSettings, Stages, stages};
use cotillion::physics::zmp::{
    Balance, ExternalForce, ForceSettings, balances, distance_summary, link_forces, reactions,
};
use cotillion::physics::{GRAVITY, on_plan};
use glam::{DQuat, DVec2, DVec3};
use proptest::prelude::*;

use crate::fixture::{forces_of, pose};

/// Stated to nine digits.
const STATED: f64 = 1e-8;
/// Rounding of sums over links and filters: forces of 1e3 N times metres, over as much.
const ROUNDING: f64 = 1e-9;

fn zmp_of(forces: &cotillion::physics::zmp::LinkForces, height: f64) -> DVec2 {
    reactions(forces)[0].zero_moment_point(height).expect("the ground pushes")
}

#[test]
fn six_moving_masses_have_the_stated_zero_moment_point() {
    let forces = pose(0);
    assert!((reactions(&forces)[0].force.y - 268.101_438_940).abs() < STATED);
    assert!(zmp_of(&forces, 0.0).distance(DVec2::new(-0.061_808_160, -0.057_626_059)) < STATED);
    assert!(zmp_of(&pose(1), 0.0).distance(DVec2::new(-0.011_928, 0.076_706)) < 1e-6);
}

#[test]
fn a_mass_that_accelerates_is_borne_behind_itself() {
    let forces = forces_of(&[(3.0, DVec3::Y, DVec3::X)]);
    let zmp = zmp_of(&forces, 0.0);
    assert!(zmp.distance(DVec2::new(-1.0 / GRAVITY, 0.0)) < ROUNDING);
    // To balance it must lean by this much into the acceleration.
    assert!((zmp.x.atan() + 0.101_585_905).abs() < STATED);
}

#[test]
fn on_a_curve_the_zero_moment_point_is_outside_by_the_stated_way() {
    let (speed, radius, height): (f64, f64, f64) = (1.5, 2.5, 0.95);
    let inwards = DVec3::X * (speed * speed / radius);
    let zmp = zmp_of(&forces_of(&[(75.0, DVec3::Y * height, inwards)]), 0.0);
    assert!((zmp.length() - 0.087_155_963).abs() < STATED);
    assert!(((zmp.length() / height).atan().to_degrees() - 5.241_820).abs() < 1e-6);
}

#[test]
fn a_throw_reaches_its_end_by_the_stated_velocity() {
    let velocity = launch_velocity(DVec3::new(0.6, 0.2, 1.1), 0.8);
    assert!(velocity.distance(DVec3::new(0.75, 4.174, 1.375)) < STATED);
    assert!(thrown(velocity, 0.4).distance(DVec3::new(0.3, 0.8848, 0.55)) < STATED);
    assert!(thrown(velocity, 0.8).distance(DVec3::new(0.6, 0.2, 1.1)) < STATED);
}

/// A body and what it does.
struct Act {
    clip: Clip,
    body: BodyModel,
    posed: PosedClip,
}

impl Act {
    fn of(clip: Clip) -> Self {
        let body = body_model(&clip.skeleton, &BodySettings::default()).expect("generated bodies are whole");
        let posed = PosedClip::of(&clip);
        Self { clip, body, posed }
    }

    fn generated(name: &str) -> Self {
        Self::of(generate(name, &BTreeMap::new()).expect("a generated clip"))
    }

    fn stages(&self) -> Stages {
        stages(&self.clip, &self.body, &self.posed, &StageSettings::default())
    }

    fn balances(&self, settings: &ForceSettings<'_>) -> Vec<Option<Balance>> {
        balances(&self.body, &self.posed, &self.stages(), &link_forces(&self.body, &self.posed, settings))
    }

    fn zmps(&self, settings: &ForceSettings<'_>) -> Vec<DVec2> {
        let forces = link_forces(&self.body, &self.posed, settings);
        reactions(&forces).iter().filter_map(|reaction| reaction.zero_moment_point(0.0)).collect()
    }
}

fn still(frame: u32) -> Act {
    let walk = generate("walk", &BTreeMap::new()).expect("a generated clip");
    let poses = vec![walk.pose(SourceFrame(frame)); 40];
    Act::of(Clip::from_poses("still", walk.skeleton.clone(), 120.0, &poses))
}

#[test]
fn posing_a_clip_is_forward_kinematics() {
    let act = Act::generated("walk");
    for frame in [0, 7, 31] {
        let expected = act.clip.skeleton.forward_kinematics(&act.clip.pose(SourceFrame(frame)));
        assert_eq!(act.posed.frame(frame as usize), &expected[..]);
    }
}

#[test]
fn who_stands_still_is_borne_below_the_centre_of_mass() {
    for inertia in [false, true] {
        for filter in [Filter::Gaussian, Filter::Butterworth] {
            let act = still(11);
            let center = centers_of_mass(&act.body, &link_places(&act.body, &act.posed))[0];
            for zmp in act.zmps(&ForceSettings { inertia, filter, external: &[] }) {
                assert!(zmp.distance(on_plan(center)) < ROUNDING, "{zmp} {center}");
            }
        }
    }
}

#[test]
fn a_weight_in_the_hand_bears_like_a_mass_that_is_part_of_the_body() {
    let act = still(5);
    let (mass, point) = (12.0, DVec3::new(0.4, 1.1, 0.9));
    let center = centers_of_mass(&act.body, &link_places(&act.body, &act.posed))[0];
    let together = (act.body.mass * center + mass * point) / (act.body.mass + mass);
    for link in [0, 9] {
        let load = ExternalForce { frame: 20, link, force: DVec3::NEG_Y * (mass * GRAVITY), point };
        let zmps = act.zmps(&ForceSettings { external: &[load], ..ForceSettings::default() });
        assert!(zmps[20].distance(on_plan(together)) < ROUNDING);
        assert!(zmps[19].distance(on_plan(center)) < ROUNDING);
    }
}

/// Newton and Euler from the leaves up: every joint hands on the force and the moment of what hangs on it.
fn root_wrench(act: &Act, accelerations: &Lanes, frame: usize) -> (DVec3, DVec3) {
    let joints = &act.clip.skeleton.joints;
    let mut wrenches = vec![(DVec3::ZERO, DVec3::ZERO); joints.len()];
    for (index, link) in act.body.links.iter().enumerate() {
        let at = act.posed.at(frame, link.joint);
        let force = link.mass * (accelerations.vector(index, frame) + DVec3::Y * GRAVITY);
        let own = &mut wrenches[link.joint.as_usize()];
        own.0 += force;
        own.1 += (at.rotation * link.com).cross(force);
    }
    for joint in (1..joints.len()).rev() {
        let parent = joints[joint].parent.expect("only the root has none");
        let arm =
            act.posed.at(frame, JointId::from_usize(joint)).position - act.posed.at(frame, parent).position;
        let (force, moment) = wrenches[joint];
        let above = &mut wrenches[parent.as_usize()];
        above.0 += force;
        above.1 += moment + arm.cross(force);
    }
    wrenches[0]
}

#[test]
fn the_wrench_at_the_root_gives_the_same_point() {
    let act = Act::generated("run");
    let accelerations = second_differences(
        &smooth(&link_places(&act.body, &act.posed), &Kernel::gaussian(5.0, act.clip.fps)),
        act.clip.fps,
    );
    let found = reactions(&link_forces(&act.body, &act.posed, &ForceSettings::default()));
    for height in [0.0, 0.3] {
        for (frame, reaction) in found.iter().enumerate().filter(|(_, own)| own.force.y > 100.0) {
            let (force, moment) = root_wrench(&act, &accelerations, frame);
            let root = act.clip.root_positions[frame] - DVec3::Y * height;
            let about = moment + root.cross(force);
            let expected = DVec2::new(about.z / force.y, -about.x / force.y);
            let zmp = reaction.zero_moment_point(height).expect("the ground pushes");
            assert!(zmp.distance(expected) < ROUNDING, "{frame}");
        }
    }
}

/// A rod that turns about its middle needs a moment `I dω/dt`, and nothing else.
#[test]
fn links_that_turn_faster_and_faster_move_the_point_by_their_inertia() {
    let act = still(0);
    let (rate, fps) = (3.0, 120.0_f64);
    let turn = |k: usize| DQuat::from_rotation_z(0.5 * rate * (k as f64 / fps).powi(2));
    let mut clip = act.clip.clone();
    let joints = clip.skeleton.joints.len();
    let pivot = centers_of_mass(&act.body, &link_places(&act.body, &act.posed))[0];
    for k in 0..clip.frame_count() {
        clip.rotations[k * joints] = turn(k) * clip.rotations[k * joints];
        clip.root_positions[k] = pivot + turn(k) * (clip.root_positions[k] - pivot);
    }
    let turning = Act::of(clip);
    let inertia: f64 = turning
        .body
        .links
        .iter()
        .map(|link| {
            let at = turning.posed.at(20, link.joint);
            let arm = at.position + at.rotation * link.com - pivot;
            let axis = at.rotation.inverse() * DVec3::Z;
            link.mass * (arm.x * arm.x + arm.y * arm.y) + axis.dot(link.inertia * axis)
        })
        .sum();
    let settings = ForceSettings { inertia: true, ..ForceSettings::default() };
    let found = reactions(&link_forces(&turning.body, &turning.posed, &settings))[20];
    let about_pivot = found.moment.z - pivot.cross(found.force).z;
    // The kernel rounds a circle of a few degrees.
    assert!((about_pivot / (inertia * rate) - 1.0).abs() < 2e-3, "{about_pivot} {}", inertia * rate);
}

#[test]
fn generated_walks_stand_nearly_everywhere() {
    let act = Act::generated("walk");
    let found = act.stages();
    // Tips roll faster than supports are for a few frames at the ends of the clip.
    let standing = found.phases.iter().filter(|phase| **phase == Phase::Ground).count();
    assert!(found.flight_runs().is_empty() && standing * 10 > found.phases.len() * 9, "{:?}", found.phases);
    let counted = act.balances(&ForceSettings::default()).iter().flatten().count();
    assert!(counted > 30, "{counted}");
}

#[test]
fn who_stands_about_is_borne_by_the_feet() {
    let act = Act::generated("idle");
    let summary = distance_summary(&act.balances(&ForceSettings::default())).expect("feet stand");
    assert!(summary.frames > 30 && summary.largest == 0.0, "{summary:?}");
}

#[test]
fn what_flies_is_no_ground_and_falls_as_bodies_do() {
    let act = Act::generated("jump");
    let found = act.stages();
    assert!(!found.flights.is_empty());
    for check in &found.flights {
        assert!(!check.is_doubtful(), "{check}");
    }
    let flying: Vec<usize> = found.flight_runs().into_iter().flat_map(|(first, last)| first..=last).collect();
    let balances = act.balances(&ForceSettings::default());
    assert!(flying.iter().all(|frame| balances[*frame].is_none()));
}

/// A fall at another rate tells that rate, and in another unit that unit.
#[test]
fn a_fall_out_of_scale_names_what_would_mend_it() {
    let heights: Vec<f64> = (0..40).map(|k| thrown(DVec3::Y * 2.0, f64::from(k) / 120.0).y).collect();
    let right = check_flight(&heights, (0, 39), 120.0).expect("long enough");
    assert!(!right.is_doubtful() && (right.gravity - GRAVITY).abs() < 1e-6 && right.residual < 1e-12);
    let slow = check_flight(&heights, (0, 39), 60.0).expect("long enough");
    assert!(slow.is_doubtful() && slow.mending_rate.is_some_and(|rate| (rate - 120.0).abs() < 1e-6));
    assert!(slow.to_string().contains("labels, rate or scale doubtful"));
    let inches: Vec<f64> = heights.iter().map(|height| height * 2.54).collect();
    let large = check_flight(&inches, (0, 39), 120.0).expect("long enough");
    assert!(
        large.is_doubtful() && large.mending_scale.is_some_and(|scale| (scale * 2.54 - 1.0).abs() < 1e-6)
    );
    assert_eq!(check_flight(&heights, (0, 21), 120.0), None);
}

/// `act` turned about the vertical and moved along the ground.
fn moved(act: &Act, angle: f64, shift: DVec3) -> Act {
    let mut clip = act.clip.clone();
    let joints = clip.skeleton.joints.len();
    for (frame, root) in clip.root_positions.iter_mut().enumerate() {
        *root = yaw(angle) * *root + shift;
        clip.rotations[frame * joints] = yaw(angle) * clip.rotations[frame * joints];
    }
    Act::of(clip)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(8))]

    #[test]
    fn where_somebody_walks_and_which_way_does_not_matter(angle in -3.0..3.0_f64, x in -5.0..5.0_f64, z in -5.0..5.0_f64) {
        let (here, shift) = (Act::generated("walk"), DVec3::new(x, 0.0, z));
        let there = moved(&here, angle, shift);
        prop_assert_eq!(&here.stages().phases, &there.stages().phases);
        let settings = ForceSettings { inertia: true, ..ForceSettings::default() };
        for (a, b) in here.balances(&settings).iter().zip(there.balances(&settings)) {
            prop_assert_eq!(a.is_some(), b.is_some());
            let (Some(a), Some(b)) = (a, b) else { continue };
            let expected = on_plan(yaw(angle) * DVec3::new(a.zmp.x, 0.0, a.zmp.y) + shift);
            prop_assert!(b.zmp.distance(expected) < 1e-8 && (a.distance - b.distance).abs() < 1e-8);
        }
    }

    #[test]
    fn a_heavier_body_is_borne_at_the_same_places(mass in 1.0..500.0_f64) {
        let act = Act::generated("walk");
        let heavy = Act {
            body: body_model(&act.clip.skeleton, &BodySettings { mass, ..BodySettings::default() }).expect("a body"),
            clip: act.clip.clone(),
            posed: act.posed.clone(),
        };
        for (a, b) in act.zmps(&ForceSettings::default()).iter().zip(heavy.zmps(&ForceSettings::default())) {
            prop_assert!(a.distance(b) < ROUNDING);
        }
    }
}

#[test]
fn clips_of_one_frame_have_no_balance_and_do_no_harm() {
    let walk = generate("walk", &BTreeMap::new()).expect("a generated clip");
    for count in 1..4 {
        let poses: Vec<_> = (0..count).map(|k| walk.pose(SourceFrame(k))).collect();
        let act = Act::of(Clip::from_poses("short", Arc::clone(&walk.skeleton), 30.0, &poses));
        assert!(
            act.balances(&ForceSettings { inertia: true, ..ForceSettings::default() })
                .iter()
                .all(Option::is_none)
        );
    }
}
