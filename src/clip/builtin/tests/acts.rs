//! What clips of acts on the spot promise.

use std::sync::LazyLock;

use glam::DVec3;
use proptest::prelude::*;

use super::*;
use crate::clip::builtin::body::{HEAD, PELVIS_HEIGHT};
use crate::clip::builtin::mass::center_of_mass;

/// Acts with curves whose feet never move.
const STANDING: [&str; 8] =
    ["pick_up", "put_down", "hand_over", "take_over", "sit_down", "stand_up", "duck", "cower"];
/// Acts that begin, and acts that end, as an idle clip does.
const FROM_IDLE: [&str; 9] =
    ["pick_up", "take_over", "sit_down", "duck", "cower", "dodge", "jump", "jump_over", "back_flip"];
const TO_IDLE: [&str; 9] =
    ["put_down", "hand_over", "stand_up", "duck", "cower", "dodge", "jump", "jump_over", "back_flip"];
/// Acts with curves.
const ALL: [&str; 12] = [
    "cower",
    "pick_up",
    "put_down",
    "hand_over",
    "take_over",
    "sit_down",
    "stand_up",
    "duck",
    "dodge",
    "jump",
    "jump_over",
    "back_flip",
];

/// Acts and bodies at the ends of their ranges: all parameters smallest, all largest.
pub(super) fn variants() -> Vec<Clip> {
    let mut clips: Vec<Clip> =
        [1.2, 2.2].map(|stature| made("slap", &[("stature", stature), ("seconds", 2.4)])).into();
    for clips_of_act in ALL.map(corners) {
        clips.extend(clips_of_act.first().into_iter().chain(clips_of_act.last()).cloned());
    }
    clips
}

/// Clips of all acts at all combinations of smallest and largest values; made once, as many tests look at them.
static CORNERS: LazyLock<BTreeMap<&str, Vec<Clip>>> = LazyLock::new(|| {
    let clips = |name: &str| corner_values(name).iter().map(|values| made(name, values)).collect();
    ALL.into_iter().map(|name| (name, clips(name))).collect()
});

/// One clip for every combination of smallest and largest values.
pub(super) fn corners(name: &str) -> &'static [Clip] {
    &CORNERS[name]
}

/// The combinations, in the order of [`corners`].
pub(super) fn corner_values(name: &str) -> Vec<Vec<(&'static str, f64)>> {
    let info = names().find(|info| info.name == name).expect("an act");
    // Slow clips are the same poses, more of them.
    let ends =
        |p: &BuiltinParameter| if p.name == "seconds" { vec![p.range.0] } else { vec![p.range.0, p.range.1] };
    let mut combinations = vec![Vec::new()];
    for parameter in info.parameters {
        combinations = combinations
            .iter()
            .flat_map(|chosen: &Vec<(&'static str, f64)>| {
                ends(parameter)
                    .into_iter()
                    .map(|value| [chosen.as_slice(), &[(parameter.name, value)]].concat())
            })
            .collect();
    }
    combinations
}

#[test]
fn standing_clips_stand_and_end_as_they_began() {
    for clip in [made("idle", &[]), made("slap", &[]), made("idle", &[("seconds", 1.0)])] {
        for role in [JointRole::LeftFoot, JointRole::RightFoot, JointRole::LeftToe, JointRole::RightToe] {
            let path = trajectory(&clip, role);
            assert!(path.iter().all(|p| p.distance(path[0]) < ROUNDING));
        }
        let steps = clip.root_positions.windows(2);
        assert!(steps.map(|pair| pair[0].distance(pair[1]) * FPS).all(|speed| speed < 0.10));
        let last = clip.pose(SourceFrame::from_usize(clip.frame_count() - 1));
        assert!(turn_between(&clip.pose(SourceFrame(0)).rotations, &last.rotations) < 1e-6);
    }
    let (idle, slap) = (made("idle", &[]), made("slap", &[]));
    assert!(turn_between(&idle.pose(SourceFrame(0)).rotations, &slap.pose(SourceFrame(0)).rotations) < 1e-6);
}

#[test]
fn a_slap_hits_ahead_and_to_the_right_at_shoulder_height() {
    let clip = made("slap", &[]);
    let hit = clip.events["hit"].as_usize();
    let hand = joint(&clip, JointRole::RightHand);
    let frames = world(&clip, hit);
    let fingertips = end_site(&clip, &frames, hand).expect("the hand ends");
    let palm = frames[hand].position.lerp(fingertips, 0.5);
    assert!(palm.distance(DVec3::new(-0.2, 1.48, 0.5)) < 0.04, "{palm}");
    let reach: Vec<f64> = trajectory(&clip, JointRole::RightHand).iter().map(|p| p.z).collect();
    let farthest = reach.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    assert!(reach[hit] > farthest - 0.01, "{} of {farthest}", reach[hit]);
}

pub(super) fn scale(clip: &Clip) -> f64 {
    clip.skeleton.joints[0].offset.y / PELVIS_HEIGHT
}

fn last_pose(clip: &Clip) -> Pose {
    clip.pose(SourceFrame::from_usize(clip.frame_count() - 1))
}

#[test]
fn acts_begin_and_end_as_an_idle_clip_stands() {
    for name in ALL {
        for (clip, values) in corners(name).iter().zip(corner_values(name)) {
            let stature = values.into_iter().find(|(name, _)| *name == "stature").expect("a parameter");
            let idle = made("idle", &[stature]).pose(SourceFrame(0));
            let (first, last) = (clip.pose(SourceFrame(0)), last_pose(clip));
            if FROM_IDLE.contains(&name) {
                assert!(first.root.distance(idle.root) < ROUNDING, "{name} begins at {}", first.root);
                assert!(turn_between(&first.rotations, &idle.rotations) < 1e-6, "{name} begins");
            }
            if TO_IDLE.contains(&name) {
                let ahead = DVec3::Z * (last.root.z - idle.root.z);
                assert!(last.root.distance(idle.root + ahead) < ROUNDING, "{name} ends at {}", last.root);
                assert!(turn_between(&last.rotations, &idle.rotations) < 1e-6, "{name} ends");
            }
        }
    }
}

#[test]
fn acts_begin_and_end_at_rest() {
    /// Radians per second: a frame of a curve that has just begun.
    const SLOW: f64 = 0.35;
    for name in ALL {
        for clip in corners(name) {
            let n = clip.frame_count();
            for (a, b) in [(0, 1), (n - 2, n - 1)] {
                let [a, b] = [a, b].map(|frame| clip.pose(SourceFrame::from_usize(frame)));
                let turn = turn_between(&a.rotations, &b.rotations) * FPS;
                assert!(turn < SLOW, "{name} turns at {turn} rad/s");
            }
        }
    }
}

#[test]
fn feet_of_standing_acts_stay_where_they_are() {
    for clip in STANDING.into_iter().flat_map(corners) {
        for role in [JointRole::LeftFoot, JointRole::RightFoot, JointRole::LeftToe, JointRole::RightToe] {
            let path = trajectory(clip, role);
            let drift = path.iter().map(|p| p.distance(path[0])).fold(0.0, f64::max);
            assert!(drift < ROUNDING, "{role:?} of {} moves by {drift}", clip.name);
        }
    }
}

#[test]
fn the_centre_of_mass_stays_over_the_feet() {
    /// Half the width of a foot and the heel behind the ankle, metres at 1.75 m.
    const HALF_FOOT: f64 = 0.04;
    const HEEL: f64 = 0.05;
    for clip in STANDING.into_iter().flat_map(corners) {
        let body = Body::new(1.75 * scale(clip));
        for frame in bearing_frames(clip) {
            let pose = clip.pose(SourceFrame::from_usize(frame));
            let frames = world(clip, frame);
            let center = center_of_mass(&body, &pose);
            let ankle = frames[joint(clip, JointRole::LeftFoot)].position;
            let tip = end_site(clip, &frames, joint(clip, JointRole::LeftToe)).expect("toes end");
            let support = ankle.z - HEEL * body.scale..tip.z;
            assert!(support.contains(&center.z), "{} {frame}: {} of {support:?}", clip.name, center.z);
            assert!(center.x.abs() < ankle.x + HALF_FOOT * body.scale);
        }
    }
}

/// Frames in which the feet bear the whole weight.
fn bearing_frames(clip: &Clip) -> std::ops::Range<usize> {
    match (clip.name.as_str(), clip.events.get("seated")) {
        ("sit_down", Some(seated)) => 0..seated.as_usize() + 1,
        ("stand_up", Some(seated)) => seated.as_usize()..clip.frame_count(),
        _ => 0..clip.frame_count(),
    }
}

/// Middles of both palms in one frame.
fn palms(clip: &Clip, frame: usize) -> [DVec3; 2] {
    let frames = world(clip, frame);
    [JointRole::LeftHand, JointRole::RightHand].map(|role| {
        let hand = joint(clip, role);
        let tips = end_site(clip, &frames, hand).expect("hands end");
        frames[hand].position.lerp(tips, 0.5)
    })
}

#[test]
fn palms_are_on_the_sides_of_the_box_while_it_is_held() {
    /// Metres.
    const ON_IT: f64 = 1e-6;
    for (name, event, holds_after) in [
        ("pick_up", "grasp", true),
        ("put_down", "release", false),
        ("hand_over", "release", false),
        ("take_over", "grasp", true),
    ] {
        for (clip, values) in corners(name).iter().zip(corner_values(name)) {
            let values: BTreeMap<&str, f64> = values.into_iter().collect();
            let event = clip.events[event].as_usize();
            let held = if holds_after { event..clip.frame_count() } else { 0..event + 1 };
            for frame in held {
                let [left, right] = palms(clip, frame);
                assert!((left.x - values["width"] / 2.0).abs() < ON_IT, "{name} {frame}: {left}");
                assert!((left - right - DVec3::X * values["width"]).length() < ON_IT);
            }
            if let Some(height) = values.get("height").filter(|_| values["on"] == 0.0) {
                let grip = (height / 2.0_f64).max(0.1 * scale(clip));
                let expected = DVec3::new(values["width"] / 2.0, grip, 0.40 * scale(clip));
                assert!(palms(clip, event)[0].distance(expected) < ON_IT, "{name}");
            }
        }
    }
}

#[test]
fn a_box_goes_from_clip_to_clip_without_a_jump() {
    let box_of = |clip: &Clip, frame: usize| palms(clip, frame)[0];
    let [pick_up, put_down, hand_over, take_over] =
        ["pick_up", "put_down", "hand_over", "take_over"].map(|name| made(name, &[]));
    let last = |clip: &Clip| clip.frame_count() - 1;
    for (before, after) in [(&pick_up, &put_down), (&pick_up, &hand_over), (&take_over, &put_down)] {
        assert!(box_of(before, last(before)).distance(box_of(after, 0)) < ROUNDING);
        let (from, to) = (last_pose(before), after.pose(SourceFrame(0)));
        assert!(turn_between(&from.rotations, &to.rotations) < 1e-6);
    }
}

#[test]
fn a_box_is_put_as_high_as_what_it_is_put_on() {
    let wrist = |clip: &Clip, frame: usize| trajectory(clip, JointRole::LeftHand)[frame].y;
    for (on, height) in [(0.0, 0.3), (0.25, 0.5), (0.6, 0.5), (0.6, 0.15)] {
        let picked = made("pick_up", &[("height", height)]);
        let put = made("put_down", &[("height", height), ("on", on)]);
        let from = wrist(&picked, picked.events["grasp"].as_usize());
        let to = wrist(&put, put.events["release"].as_usize());
        assert!((to - from - on).abs() < ROUNDING, "{on}: {}", to - from);
    }
}

#[test]
fn arms_of_who_hands_over_are_almost_stretched_at_the_same_height_as_the_takers() {
    let (giver, taker) = (made("hand_over", &[]), made("take_over", &[]));
    let given = palms(&giver, giver.events["release"].as_usize())[0];
    let taken = palms(&taker, taker.events["grasp"].as_usize())[0];
    assert!(given.distance(taken) < ROUNDING);
    assert!(given.z > 0.5 && given.y > 1.1, "{given}");
}

#[test]
fn who_sits_bears_on_the_seat_and_stays_there() {
    for (clip, values) in corners("sit_down").iter().zip(corner_values("sit_down")) {
        let values: BTreeMap<&str, f64> = values.into_iter().collect();
        let pelvis = values["seat"] + 0.13 * scale(clip);
        let seated = clip.events["seated"].as_usize();
        for frame in seated..clip.frame_count() {
            let root = clip.root_positions[frame];
            assert!((root.y - pelvis).abs() < ROUNDING);
            assert!(root.distance(clip.root_positions[seated]) < ROUNDING);
        }
        assert!(clip.root_positions[seated - 1].y > pelvis);
        // Thighs lie on the seat, not on the floor behind it.
        let frames = world(clip, clip.frame_count() - 1);
        let [hip, knee] =
            [JointRole::LeftHip, JointRole::LeftKnee].map(|role| frames[joint(clip, role)].position);
        assert!(knee.z - hip.z > 0.2 * scale(clip));
    }
}

#[test]
fn standing_up_is_sitting_down_backwards() {
    let (down, up) = (made("sit_down", &[]), made("stand_up", &[]));
    let last = down.frame_count() - 1;
    assert_eq!(up.events["seated"].as_usize(), last - down.events["seated"].as_usize());
    assert_eq!(up.pose(SourceFrame(3)), down.pose(SourceFrame::from_usize(last - 3)));
}

#[test]
fn a_duck_lowers_the_head_as_far_as_asked() {
    for (clip, values) in corners("duck").iter().zip(corner_values("duck")) {
        let depth = values.iter().find(|(name, _)| *name == "depth").expect("a parameter").1;
        let top = |frame: usize| end_site(clip, &world(clip, frame), HEAD).expect("the head ends").y;
        let lowest = (0..clip.frame_count()).map(top).fold(f64::INFINITY, f64::min);
        assert!((top(0) - lowest - depth).abs() < 1e-6, "{depth}: {}", top(0) - lowest);
    }
}

#[test]
fn who_cowers_is_half_as_tall() {
    let clip = made("cower", &[]);
    let top = |frame: usize| {
        let frames = world(&clip, frame);
        let ends = (0..frames.len()).filter_map(|joint| end_site(&clip, &frames, joint));
        ends.chain(frames.iter().map(|joint| joint.position)).map(|place| place.y).fold(0.0, f64::max)
    };
    assert!(top(event_of(&clip, "low")) < 0.5 * top(0), "{}", top(event_of(&clip, "low")));
}

fn event_of(clip: &Clip, name: &str) -> usize {
    clip.events[name].as_usize()
}

#[test]
fn a_dodge_gets_the_head_out_of_the_way_and_one_foot_never_moves() {
    for (clip, values) in corners("dodge").iter().zip(corner_values("dodge")) {
        let values: BTreeMap<&str, f64> = values.into_iter().collect();
        let sign = if values["left"] > 0.5 { 1.0 } else { -1.0 };
        let standing = if sign > 0.0 { JointRole::RightFoot } else { JointRole::LeftFoot };
        let stepping = if sign > 0.0 { JointRole::LeftToe } else { JointRole::RightToe };
        let path = trajectory(clip, standing);
        assert!(path.iter().all(|p| p.distance(path[0]) < ROUNDING));
        let toe = trajectory(clip, stepping);
        let middle = clip.frame_count() / 2;
        let stepped = sign * (toe[middle].x - toe[0].x);
        assert!((stepped - values["distance"]).abs() < ROUNDING);
        let head = trajectory(clip, JointRole::Head);
        assert!(sign * (head[middle].x - head[0].x) > 0.75 * values["distance"]);
        let on_ground = toe.windows(2).filter(|pair| pair.iter().all(|p| p.y < toe[0].y + ROUNDING));
        assert!(on_ground.map(|pair| pair[0].distance(pair[1])).all(|slide| slide < 1e-3 / FPS));
    }
}

#[test]
fn the_weight_is_over_the_standing_foot_before_the_other_is_lifted() {
    let clip = made("dodge", &[]);
    let body = Body::new(1.75);
    let toe = trajectory(&clip, JointRole::LeftToe);
    let lifted = toe.iter().position(|p| p.y > toe[0].y + ROUNDING).expect("a step");
    let center = center_of_mass(&body, &clip.pose(SourceFrame::from_usize(lifted)));
    let ankle = trajectory(&clip, JointRole::RightFoot)[0];
    assert!((center.x - ankle.x).abs() < 0.04, "{center} over {ankle}");
}

#[test]
fn joints_stay_within_human_limits_at_all_corners() {
    for clip in ALL.into_iter().flat_map(corners) {
        for frame in 0..clip.frame_count() {
            let beyond = limits::beyond(&clip.pose(SourceFrame::from_usize(frame)));
            assert!(beyond.is_empty(), "{} {frame}: {beyond:?}", clip.name);
        }
    }
}

/// Radians per second, and per second squared, of any joint: what the fastest of people's joints do in jumps, and a third of it
/// in what is done standing.
const FASTEST: [(f64, f64); 2] = [(10.0, 130.0), (30.0, 800.0)];

#[test]
fn joints_neither_jump_nor_jerk() {
    for name in ALL {
        let (speed, acceleration) = FASTEST[usize::from(name.contains("jump") || name.contains("flip"))];
        for clip in corners(name) {
            let joints = clip.skeleton.joints.len();
            let rate = |k: usize| log(clip.rotations[k].inverse() * clip.rotations[k + joints]) * FPS;
            for k in 0..clip.rotations.len() - 2 * joints {
                let (before, after) = (rate(k), rate(k + joints));
                let place = || format!("{name} {}: {}", k / joints, clip.skeleton.joints[k % joints].name);
                assert!(before.length() < speed, "{} at {} rad/s", place(), before.length());
                let change = (after - before).length() * FPS;
                assert!(change < acceleration, "{} at {change} rad/s²", place());
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn acts_keep_their_promises_with_any_parameters(act in 0..ALL.len(), shares in prop::array::uniform5(0.0..=1.0_f64)) {
        let info = names().find(|info| info.name == ALL[act]).expect("an act");
        let values: Vec<_> = info
            .parameters
            .iter()
            .zip(shares)
            .map(|(p, share)| (p, if p.is_switch() { share.round() } else { share }))
            .map(|(p, share)| (p.name, p.range.0 + share * (p.range.1.min(12.0) - p.range.0)))
            .collect();
        let clip = made(info.name, &values);
        prop_assert!(clip.root_positions.iter().all(|root| root.is_finite()));
        prop_assert!(clip.rotations.iter().all(|turn| (turn.length() - 1.0).abs() < ROUNDING));
        for frame in 0..clip.frame_count() {
            let beyond = limits::beyond(&clip.pose(SourceFrame::from_usize(frame)));
            prop_assert!(beyond.is_empty(), "{} {frame}: {beyond:?} of {values:?}", info.name);
        }
    }
}
