//! What clips of locomotion promise.

use std::sync::LazyLock;

use proptest::prelude::*;

use super::super::mass::center_of_mass;
use super::*;

/// Clips of locomotion.
const LOCOMOTION: [&str; 7] = ["walk", "run", "side_step", "carry_side", "carry", "push", "duck_walk"];

/// Every corner of the ranges of all parameters but the length; who stops also starts, and who gives takes.
static CORNERS: LazyLock<Vec<Clip>> = LazyLock::new(|| {
    let corners = LOCOMOTION.iter().flat_map(|name| {
        let info = info(name);
        let bound = ["seconds", "stop", "give", "up"];
        let free: Vec<_> = info.parameters.iter().filter(|free| !bound.contains(&free.name)).collect();
        (0..1_u32 << free.len()).map(move |corner| {
            let ends = free.iter().enumerate().flat_map(|(bit, parameter)| {
                let (low, high) = parameter.range;
                let end = if corner >> bit & 1 == 1 { high } else { low };
                let also = [("start", "stop"), ("take", "give"), ("down", "up")].into_iter();
                let also = also.filter(|(leader, _)| *leader == parameter.name).map(|(_, other)| other);
                [parameter.name].into_iter().chain(also).map(move |name| (name, end))
            });
            made(name, &ends.chain([("seconds", 3.0)]).collect::<Vec<_>>())
        })
    });
    corners.collect()
});

/// Some of the corners, for the tests of all clips.
pub(super) fn variants() -> Vec<Clip> {
    CORNERS.iter().step_by(7).cloned().collect()
}

fn info(name: &str) -> &'static BuiltinInfo {
    names().find(|info| info.name == name).expect("a clip of locomotion")
}

/// Clips that go straight on from the first frame to the last.
pub(super) fn steady(name: &str, parameters: &[(&'static str, f64)]) -> Clip {
    let known = |name: &&str| info_has(info(name), "start");
    let ends = [("start", 0.0), ("stop", 0.0)].into_iter().filter(|_| known(&name));
    made(name, &ends.chain([("seconds", 4.0)]).chain(parameters.iter().copied()).collect::<Vec<_>>())
}

fn info_has(info: &BuiltinInfo, parameter: &str) -> bool {
    info.parameters.iter().any(|known| known.name == parameter)
}

/// What of a foot is on the ground.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Contact {
    heel: bool,
    toe: bool,
}

impl Contact {
    pub(super) fn any(self) -> bool {
        self.heel || self.toe
    }
}

/// Heel and toe joint of a foot in every frame; while a foot is flat its heel stands as its ankle does.
fn heel_and_toe(clip: &Clip, [foot, tip]: [JointRole; 2]) -> Vec<[DVec3; 2]> {
    let [foot, tip] = [foot, tip].map(|role| joint(clip, role));
    let heel = body::HEEL_OFFSET * scale(clip);
    let frames = (0..clip.frame_count()).map(|frame| world(clip, frame));
    frames.map(|at| [at[foot].position + at[foot].rotation * heel, at[tip].position]).collect()
}

fn scale(clip: &Clip) -> f64 {
    clip.skeleton.joints[0].offset.y / body::PELVIS_HEIGHT
}

/// Contacts of the left and of the right foot in every frame: a heel or a toe joint as low as in a flat foot. In the air
/// neither is, but for an instant.
pub(super) fn contacts(clip: &Clip) -> [Vec<Contact>; 2] {
    let sole = (body::ANKLE_HEIGHT + body::TOE_OFFSET.y) * scale(clip);
    let down = |at: DVec3, height: f64| (at.y - height).abs() < ROUNDING;
    FEET.map(|foot| {
        let points = heel_and_toe(clip, foot).into_iter();
        points.map(|[heel, toe]| Contact { heel: down(heel, 0.0), toe: down(toe, sole) }).collect()
    })
}

const FEET: [[JointRole; 2]; 2] =
    [[JointRole::LeftFoot, JointRole::LeftToe], [JointRole::RightFoot, JointRole::RightToe]];

/// Fastest that a planted foot slides, metres a second.
pub(super) fn slide(clip: &Clip) -> f64 {
    let mut fastest: f64 = 0.0;
    for (contacts, foot) in contacts(clip).iter().zip(FEET) {
        let points = heel_and_toe(clip, foot);
        for (contact, at) in contacts.windows(2).zip(points.windows(2)) {
            let slid = [0, 1].map(|point| at[0][point].distance(at[1][point]) * FPS);
            if contact[0].heel && contact[1].heel {
                fastest = fastest.max(slid[0]);
            }
            if contact[0].toe && contact[1].toe {
                fastest = fastest.max(slid[1]);
            }
        }
    }
    fastest
}

#[test]
fn planted_feet_do_not_slide() {
    for clip in CORNERS.iter() {
        assert!(slide(clip) < 1e-3, "{}: {} m/s", clip.name, slide(clip));
    }
}

#[test]
fn feet_are_on_the_ground_as_long_as_in_that_gait() {
    /// Share of the time: a frame of the shortest cycles, which have 18; stances begin and end between frames.
    const TO_THE_FRAME: f64 = 0.06;
    for (name, share) in
        [("walk", 0.61), ("carry", 0.61), ("push", 0.61), ("side_step", 0.62), ("carry_side", 0.62)]
    {
        for speed in [info(name).parameters[0].range.0, info(name).parameters[0].range.1] {
            let clip = steady(name, &[("speed", speed), ("seconds", 20.0)]);
            for contacts in contacts(&clip) {
                let down = contacts.iter().filter(|contact| contact.any()).count() as f64;
                let down = down / clip.frame_count() as f64;
                assert!((down - share).abs() < TO_THE_FRAME, "{name} at {speed}: {down}");
            }
        }
    }
}

#[test]
fn no_heel_sinks_into_the_ground() {
    for clip in CORNERS.iter() {
        for foot in FEET {
            let lowest = heel_and_toe(clip, foot).iter().map(|[heel, _]| heel.y).fold(1.0, f64::min);
            assert!(lowest > -1e-3, "{}: {lowest}", clip.name);
        }
    }
}

#[test]
fn who_walks_never_flies() {
    for clip in CORNERS.iter().filter(|clip| clip.name != "run") {
        let [left, right] = contacts(clip);
        for frame in 0..clip.frame_count() {
            assert!(left[frame].any() || right[frame].any(), "{} {frame}", clip.name);
        }
    }
}

/// A clip's smallest cycle, frames: joints turn as they did.
pub(super) fn cycle(clip: &Clip) -> usize {
    let inner = |frame: usize| clip.pose(SourceFrame::from_usize(frame)).rotations[1..].to_vec();
    let first = [inner(0), inner(1)];
    (10..clip.frame_count() - 1)
        .find(|frame| [0, 1].iter().all(|k| turn_between(&first[*k], &inner(frame + k)) < CLOSED))
        .expect("a cycle")
}

/// Rounding of an angle found by an arc cosine, radians.
const CLOSED: f64 = 1e-6;

#[test]
fn cycles_close_in_pose_and_speed() {
    for name in LOCOMOTION {
        for turn in [0.0, 20.0] {
            let info = info(name);
            let turns = info_has(info, "turn");
            let speed = info.parameters[0].default;
            let clip =
                if turns { steady(name, &[("turn", turn)]) } else { steady(name, &[("left", turn / 20.0)]) };
            let cycle = cycle(&clip);
            let seconds = cycle as f64 / FPS;
            let poses: Vec<_> =
                (0..clip.frame_count()).map(|k| clip.pose(SourceFrame::from_usize(k))).collect();
            let about = if turns { turn.to_radians() * seconds } else { 0.0 };
            let turned = DQuat::from_rotation_y(about);
            for k in 0..clip.frame_count() - cycle - 1 {
                let (now, next) = (&poses[k], &poses[k + 1]);
                let (later, beyond) = (&poses[k + cycle], &poses[k + cycle + 1]);
                assert!(turn_between(&now.rotations[1..], &later.rotations[1..]) < CLOSED);
                assert!(turn_between(&[turned * now.rotations[0]], &later.rotations[..1]) < CLOSED);
                let step = turned * (next.root - now.root);
                assert!(step.distance(beyond.root - later.root) < ROUNDING, "{name} {k}");
            }
            if about == 0.0 {
                let way = horizontal_distance(poses[0].root, poses[cycle].root);
                assert!((way - speed * seconds).abs() < ROUNDING, "{name}: {way} in {seconds} s");
            }
        }
    }
}

#[test]
fn who_is_small_and_fast_and_halts_at_once_has_human_ankles() {
    let clip = made("walk", &[("speed", 1.8), ("stature", 1.2), ("stop", 1.0), ("seconds", 0.5)]);
    for frame in 0..clip.frame_count() {
        let beyond = limits::beyond(&clip.pose(SourceFrame::from_usize(frame)));
        assert!(beyond.is_empty(), "{frame}: {beyond:?}");
    }
}

#[test]
fn who_neither_sets_off_nor_halts_ends_as_it_began() {
    let speeds = |name| {
        let (low, high) = info(name).parameters[0].range;
        [0.0, 0.3, 0.77, 1.0].map(|share| low + share * (high - low))
    };
    for (name, speed) in LOCOMOTION.iter().flat_map(|name| speeds(name).map(|speed| (name, speed))) {
        for seconds in [0.5, 4.0] {
            let clip = steady(name, &[("speed", speed), ("seconds", seconds)]);
            let [first, last] =
                [0, clip.frame_count() - 1].map(|frame| clip.pose(SourceFrame::from_usize(frame)));
            let gap = turn_between(&first.rotations, &last.rotations);
            assert!(gap < CLOSED, "{name} at {speed} m/s: {gap}");
            assert!((first.root.y - last.root.y).abs() < ROUNDING, "{name} at {speed} m/s");
        }
    }
}

#[test]
fn a_walk_of_the_default_speed_holds_three_cycles() {
    let clip = made("walk", &[]);
    assert_eq!((clip.frame_count(), cycle(&clip)), (103, 34));
}

#[test]
fn joints_stay_within_human_limits_in_every_corner() {
    for clip in CORNERS.iter() {
        for frame in 0..clip.frame_count() {
            let beyond = limits::beyond(&clip.pose(SourceFrame::from_usize(frame)));
            assert!(beyond.is_empty(), "{} {frame}: {beyond:?}", clip.name);
        }
    }
}

/// A jump of a joint's speed by 25 rad/s, or of the pelvis' by 1 m/s, between two frames would show as 750 rad/s² or 30 m/s².
/// The largest are knees of small bodies that keep up with adults.
#[test]
fn neither_joints_nor_the_pelvis_jump_in_speed() {
    for (name, joints, pelvis) in [
        ("walk", 600.0, 8.5),
        ("run", 760.0, 23.0),
        ("side_step", 450.0, 7.5),
        ("carry_side", 450.0, 7.5),
        ("carry", 600.0, 5.0),
        ("push", 280.0, 2.0),
        ("duck_walk", 280.0, 2.0),
    ] {
        for clip in CORNERS.iter().filter(|clip| clip.name == name) {
            let (fastest, root) = accelerations(clip);
            assert!(fastest < joints, "{name}: {fastest} rad/s²");
            assert!(root < pelvis, "{name}: {root} m/s²");
        }
    }
}

/// Largest change of a joint's angular velocity (rad/s²) and of the root's velocity (m/s²).
fn accelerations(clip: &Clip) -> (f64, f64) {
    let joints = clip.skeleton.joints.len();
    let pairs = clip.rotations.windows(joints + 1);
    let rates: Vec<DVec3> = pairs.map(|pair| log(pair[0].inverse() * pair[joints]) * FPS).collect();
    let angular = rates.windows(joints + 1).map(|pair| pair[0].distance(pair[joints]) * FPS);
    let places = clip.root_positions.windows(3);
    let linear = places.map(|p| (p[2] - 2.0 * p[1] + p[0]).length() * FPS * FPS);
    (angular.fold(0.0, f64::max), linear.fold(0.0, f64::max))
}

#[test]
fn the_centre_of_mass_is_over_the_foot_that_stands() {
    /// Metres between both, at least.
    const CLEAR: f64 = 0.008;
    for name in LOCOMOTION {
        let clip = steady(name, &[]);
        let body = Body::new(1.75);
        let [left, right] = contacts(&clip);
        // Only whole cycles have no drift of their own.
        let cycle = cycle(&clip);
        let way = (clip.root_positions[cycle].x - clip.root_positions[0].x) / cycle as f64;
        let mean = |standing: &[Contact], lifted: &[Contact]| {
            let frames = (0..2 * cycle).filter(|k| standing[*k].any() && !lifted[*k].any());
            let sides: Vec<f64> = frames
                .map(|k| center_of_mass(&body, &clip.pose(SourceFrame::from_usize(k))).x - way * k as f64)
                .collect();
            sides.iter().sum::<f64>() / sides.len() as f64
        };
        let (over_left, over_right) = (mean(&left, &right), mean(&right, &left));
        assert!(over_left > over_right + CLEAR, "{name}: {over_left} against {over_right}");
    }
}

#[test]
fn a_foot_that_leaves_a_stand_or_comes_to_one_has_no_weight_on_it() {
    for name in ["walk", "carry", "push", "side_step", "carry_side"] {
        let clip = made(name, &[("start", 1.0), ("stop", 1.0)]);
        let body = Body::new(1.75);
        let [left, right] = contacts(&clip);
        let ankles = [JointRole::LeftFoot, JointRole::RightFoot].map(|foot| trajectory(&clip, foot));
        let lifted = |frame: &usize| left[*frame].any() != right[*frame].any();
        let frames = || 0..clip.frame_count();
        for frame in [frames().find(lifted), frames().rev().find(lifted)].into_iter().flatten() {
            let center = center_of_mass(&body, &clip.pose(SourceFrame::from_usize(frame))).x;
            let middle = 0.5 * (ankles[0][frame].x + ankles[1][frame].x);
            assert!((center > middle) == left[frame].any(), "{name} {frame}: {center} of {middle}");
        }
    }
}

#[test]
fn arms_and_legs_take_turns() {
    for name in ["walk", "run"] {
        let clip = steady(name, &[]);
        for (hand, foot) in
            [(JointRole::LeftHand, JointRole::LeftFoot), (JointRole::RightHand, JointRole::RightFoot)]
        {
            let ahead = |role: JointRole| {
                let path = trajectory(&clip, role);
                let ahead: Vec<f64> =
                    path.iter().zip(&clip.root_positions).map(|(p, root)| p.z - root.z).collect();
                let mean = ahead.iter().sum::<f64>() / ahead.len() as f64;
                ahead.into_iter().map(move |z| z - mean).collect::<Vec<_>>()
            };
            let (hand, foot) = (ahead(hand), ahead(foot));
            let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
            let correlation = dot(&hand, &foot) / (dot(&hand, &hand) * dot(&foot, &foot)).sqrt();
            assert!(correlation < -0.5, "{name}: {correlation}");
        }
    }
}

#[test]
fn curves_turn_as_fast_as_asked_and_lean_inwards() {
    /// Radians: the pelvis' axis is tipped, and sweeps a cone when it turns.
    const TIPPED: f64 = 0.03;
    /// Metres of the head inside the pelvis: half of what balances a walk on this curve.
    const INWARDS: f64 = 0.03;
    for name in ["walk", "run"] {
        let clip = steady(name, &[("turn", 40.0)]);
        let cycle = cycle(&clip);
        let pelvis = |frame: usize| world(&clip, frame)[0].rotation * DVec3::X;
        let turned = pelvis(0).angle_between(pelvis(cycle));
        assert!((turned - 40_f64.to_radians() * cycle as f64 / FPS).abs() < TIPPED, "{name}: {turned}");
        let [head, hip] = [JointRole::Head, JointRole::LeftHip].map(|role| joint(&clip, role));
        let inwards = (0..cycle).map(|frame| {
            let frames = world(&clip, frame);
            let left = (frames[hip].position - frames[0].position).with_y(0.0).normalize();
            (frames[head].position - frames[0].position).dot(left)
        });
        let inwards = inwards.sum::<f64>() / cycle as f64;
        assert!(inwards > INWARDS, "{name}: {inwards}");
    }
}

#[test]
fn who_sets_off_and_halts_stands_at_both_ends() {
    for name in ["walk", "side_step", "carry", "push"] {
        let turn = if info_has(info(name), "turn") { vec![("turn", -20.0)] } else { vec![] };
        let clip = made(
            name,
            &[("start", 1.0), ("stop", 1.0), ("seconds", 8.0)].into_iter().chain(turn).collect::<Vec<_>>(),
        );
        let last = clip.frame_count() - 1;
        for pair in [[0, 1], [last - 1, last]] {
            let [a, b] = pair.map(|frame| clip.pose(SourceFrame::from_usize(frame)));
            assert!(a.root.distance(b.root) * FPS < ROUNDING, "{name}");
        }
        let [first, last] = [0, last].map(|frame| clip.pose(SourceFrame::from_usize(frame)).rotations);
        let stand = made("idle", &[]).pose(SourceFrame(0)).rotations;
        assert!(turn_between(&first, &stand) < CLOSED, "{name}");
        assert!(turn_between(&first[1..], &last[1..]) < CLOSED, "{name}");
    }
}

/// A value of every parameter of a clip, at one of its ends every other time, and seconds of which a test has few.
fn any_parameters(name: &'static str) -> impl Strategy<Value = Vec<(&'static str, f64)>> {
    let parameters = info(name).parameters.iter();
    let values: Vec<_> = parameters
        .map(|parameter| {
            let (low, high) = parameter.range;
            let high = if parameter.name == "seconds" { 4.0 } else { high };
            let end = prop_oneof![Just(low), Just(high)];
            let value =
                if parameter.is_switch() { end.boxed() } else { prop_oneof![low..=high, end].boxed() };
            value.prop_map(move |value| (parameter.name, value))
        })
        .collect();
    values
}

fn any_clip() -> impl Strategy<Value = (&'static str, Vec<(&'static str, f64)>)> {
    let clips: Vec<_> = LOCOMOTION
        .iter()
        .map(|name| any_parameters(name).prop_map(move |parameters| (*name, parameters)).boxed())
        .collect();
    proptest::strategy::Union::new(clips)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn any_parameters_give_sound_clips((name, parameters) in any_clip()) {
        let clip = made(name, &parameters);
        for frame in 0..clip.frame_count() {
            let pose = clip.pose(SourceFrame::from_usize(frame));
            prop_assert!(pose.root.is_finite() && pose.rotations.iter().all(|rotation| rotation.is_finite()));
            let beyond = limits::beyond(&pose);
            prop_assert!(beyond.is_empty(), "{} {}: {:?}", clip.name, frame, beyond);
        }
        prop_assert!(slide(&clip) < 1e-3);
        let [left, right] = contacts(&clip);
        let flight = left.iter().zip(&right).position(|(left, right)| !left.any() && !right.any());
        prop_assert!(flight.is_none() || clip.name == "run", "flies at {:?}", flight);
    }
}
