//! Hands reach what they must, and reports tell who has what and what is not reached.

mod relay;

use cotillion::constraint::When;
use cotillion::discrete::outcome::Outcome;
use cotillion::edit::Moved;
use cotillion::embody::embody;
use cotillion::export::bvh::BvhOptions;
use cotillion::export::report::report;
use cotillion::export::scene::scene_files;
use cotillion::geometry::c64;
use cotillion::index::CharacterId;
use cotillion::object_motion::{Owner, Performance, moment_time, object_motions};
use cotillion::reach::{
    JointTarget, Others, Source, Stage, carry_targets, constrained_times, effector_residuals,
    effector_targets,
};
use cotillion::resample::resample;
use cotillion::skeleton::JointRole;
use cotillion::ties::Ties;
use relay::{RELAY, load, solved};
use serde_json::Value;

/// Rounding of a few rigid motions of some metres.
const ROUNDING: f64 = 1e-12;
/// What the project promises of end effectors and of hands on what they carry, metres.
const TOUCH: f64 = 1e-3;
/// Hands are turned exactly, degrees; near 0 the angle of a rotation has half the digits.
const TURNED: f64 = 1e-5;

#[test]
fn hands_hold_the_box_where_they_grasped_it() {
    let (scene, edit) = solved(RELAY);
    let moved = Moved { scene: &scene, characters: &edit.characters };
    let objects = object_motions(&scene, &moved);
    let ties = Ties::of(&scene);
    let stage = Stage { scene: &scene, performance: &moved, objects: &objects, ties: &ties };
    let ann = CharacterId(0);
    let mut samples: Vec<f64> = (0..600).map(|k| f64::from(k) / 30.0).collect();
    samples.extend(constrained_times((&scene, &ties), &moved, ann));
    samples.sort_by(f64::total_cmp);
    let targets = carry_targets(&stage, ann, &samples);
    assert_eq!(targets.iter().map(|target| target.source).collect::<Vec<_>>(), [Source::Carry(0); 2]);
    let span = &objects[0].spans[1];
    for JointTarget { samples: range, positions, .. } in &targets {
        assert_eq!(
            (samples[range.start], samples[range.end - 1]),
            (span.from, span.to),
            "moments are samples"
        );
        let on_box = |k: usize| {
            let pose = objects[0].pose_at(&scene, &moved, samples[range.start + k]);
            pose.local(positions[k])
        };
        for k in 0..positions.len() {
            assert!(on_box(k).distance(on_box(0)) < ROUNDING);
        }
        assert!((on_box(0).z.abs() - 0.175).abs() < 1e-3, "on its sides: {}", on_box(0));
    }
}

/// On the bodies that are written, at every output frame and at the moments themselves, not on the targets alone.
#[test]
fn finished_hands_stay_on_the_box_where_they_grasped_it() {
    let (scene, edit) = solved(RELAY);
    let mut resampled = resample(&scene, &edit).expect("a result of usual length");
    let bodies = embody(&scene, &edit, &mut resampled);
    let objects = object_motions(&scene, &bodies.moved);
    let carried = objects[0].spans.iter().filter_map(|span| match &span.owner {
        Owner::Carried(hold) => Some((span, hold)),
        _ => None,
    });
    let mut seen = 0;
    for (span, hold) in carried {
        for grip in &hold.grips {
            let skeleton = &scene.characters[grip.character.as_usize()].track.clips[0].clip.skeleton;
            let body = &bodies.bodies[grip.character.as_usize()];
            let during = body.times.iter().zip(&body.poses);
            for (time, pose) in during.filter(|(time, _)| (span.from..=span.to).contains(*time)) {
                let hand = skeleton.forward_kinematics(pose)[grip.joint.as_usize()].position;
                let slip = objects[0].pose_at(&scene, &bodies.moved, *time).local(hand).distance(grip.point);
                assert!(slip < TOUCH, "by {slip} m at {time} s");
                seen += 1;
            }
        }
    }
    assert!(seen > 400, "four hands for seconds: {seen}");
}

#[test]
fn a_hand_far_from_the_box_reaches_for_its_surface() {
    let text = RELAY.replace("offset = [-0.58, 0.0]", "offset = [-1.6, 0.0]");
    let (scene, edit) = solved(&text);
    let moved = Moved { scene: &scene, characters: &edit.characters };
    let objects = object_motions(&scene, &moved);
    let Owner::Carried(hold) = &objects[0].spans[1].owner else { panic!("ann carries") };
    for grip in &hold.grips {
        assert!((grip.point.x - (-0.15)).abs() < 0.1 + ROUNDING, "a palm from its back: {}", grip.point);
    }
}

const SLAP: &str = r#"
[clips]
slap = "builtin:slap"
[[character]]
name = "ann"
track = ["slap"]
[[character]]
name = "bob"
track = ["slap"]
position = [1.2, -0.4]
facing = 180
[[object]]
name = "table"
size = [0.5, 0.8, 0.5]
position = [0.0, 0.6]
[[relative]]
at = "bob:hit"
to = "ann:hit"
[[sync]]
moments = ["ann:hit", "bob:hit"]
strength = "hard"
[[end_effector]]
at = "ann:hit"
joint = "right_hand"
orientation = "rest"
target = { character = "bob", joint = "right_hand", at = "bob:hit" }
[[end_effector]]
during = ["ann:start", "ann:end"]
joint = "left_hand"
orientation = [0, 90, 0]
target = { object = "table", point = [0.0, 0.8, 0.1] }
"#;

/// Hands meet with arms no straighter than this, share of their length.
const COMFORTABLE: f64 = 0.95;

fn nobody_corrected<'a>(moved: &'a Moved<'a>) -> Others<'a, Moved<'a>> {
    Others { performance: moved, corrected: &|_| false }
}

#[test]
fn hands_that_meet_do_so_where_both_arms_reach_or_come_as_near() {
    let (scene, edit) = solved(SLAP);
    let moved = Moved { scene: &scene, characters: &edit.characters };
    let objects = object_motions(&scene, &moved);
    let ties = Ties::of(&scene);
    let stage = Stage { scene: &scene, performance: &moved, objects: &objects, ties: &ties };
    let targets = [CharacterId(0), CharacterId(1)].map(|who| {
        let samples = constrained_times((&scene, &ties), &moved, who);
        effector_targets(&stage, &nobody_corrected(&moved), who, &samples)
    });
    assert_eq!((targets[0].len(), targets[1].len()), (2, 1));
    let (ann, bob) = (&targets[0][0], &targets[1][0]);
    assert!(ann.positions[0].distance(bob.positions[0]) < ROUNDING, "one place for both");
    let mut hands = scene.end_effectors[0].when.moments().into_iter().map(|hit| {
        let time = moment_time(&scene, &moved, hit);
        [CharacterId(0), CharacterId(1)].map(|who| {
            let skeleton = &scene.characters[who.as_usize()].track.clips[0].clip.skeleton;
            let pose = moved.pose(who, moved.frame(who, time));
            skeleton.forward_kinematics(&pose)[scene.end_effectors[0].joint.as_usize()].position
        })
    });
    let [own, theirs] = hands.next().expect("one moment");
    let beyond = [CharacterId(0), CharacterId(1)].map(|who| {
        let skeleton = &scene.characters[who.as_usize()].track.clips[0].clip.skeleton;
        let time = moment_time(&scene, &moved, scene.end_effectors[0].when.moments()[0]);
        let frames = skeleton.forward_kinematics(&moved.pose(who, moved.frame(who, time)));
        let arm = [JointRole::RightShoulder, JointRole::RightElbow, JointRole::RightHand].map(|role| {
            frames[skeleton.joint_of(role).expect("generated bodies have arms").as_usize()].position
        });
        let length = arm[0].distance(arm[1]) + arm[1].distance(arm[2]);
        ann.positions[0].distance(arm[0]) - COMFORTABLE * length
    });
    assert!(beyond[0] > 0.05, "they stand 1.2 m apart: {beyond:?}");
    assert!((beyond[0] - beyond[1]).abs() < ROUNDING, "both come as near: {beyond:?}");
    let missed = effector_residuals(&stage, &moved);
    assert!((missed[0].metres - own.distance(theirs)).abs() < ROUNDING);
    assert_eq!(ann.rotations.len(), 1);
    assert!(bob.rotations.is_empty());
}

#[test]
fn a_hand_on_a_table_stays_there_and_is_turned_as_asked() {
    let (scene, edit) = solved(SLAP);
    assert!(matches!(scene.end_effectors[1].when, When::During(..)));
    let moved = Moved { scene: &scene, characters: &edit.characters };
    let objects = object_motions(&scene, &moved);
    let ties = Ties::of(&scene);
    let stage = Stage { scene: &scene, performance: &moved, objects: &objects, ties: &ties };
    let samples: Vec<f64> = (0..60).map(|k| f64::from(k) / 30.0).collect();
    let targets = effector_targets(&stage, &nobody_corrected(&moved), CharacterId(0), &samples);
    let table = targets.iter().find(|target| target.source == Source::EndEffector(1)).expect("a target");
    assert!(table.samples.len() > 30 && table.positions.len() == table.samples.len());
    // Its right is +z of the world.
    assert!(table.positions.iter().all(|p| p.distance(glam::DVec3::new(0.0, 0.8, -0.5)) < ROUNDING));
    let turned = table.rotations[0] * glam::DVec3::X;
    assert!(turned.distance(glam::DVec3::NEG_Z) < ROUNDING, "a quarter turn about up: {turned}");
}

#[test]
fn reports_tell_who_has_what_and_what_is_not_reached() {
    let told = |text: &str| {
        let (scene, edit) = solved(text);
        let mut resampled = resample(&scene, &edit).expect("a result of usual length");
        let embodied = embody(&scene, &edit, &mut resampled);
        let files = scene_files((&scene, &edit), None, &resampled, &BvhOptions::default());
        let svg = files.iter().find(|file| file.name == "scene.svg").expect("a picture");
        let svg = String::from_utf8(svg.bytes.clone()).expect("text");
        let outcome = Outcome::plain((scene.clone(), edit.clone()));
        (serde_json::to_value(report(&embodied, &outcome, &resampled)).expect("JSON"), svg)
    };
    let (relay, svg) = told(RELAY);
    for meaning in ["way of an object", "grasped", "released"] {
        assert!(svg.contains(meaning), "{meaning}");
    }
    let objects = relay["objects"].as_array().expect("objects");
    let owners = objects[0]["owners"].as_array().expect("owners");
    let kinds: Vec<&str> = owners.iter().filter_map(|owner| owner["kind"].as_str()).collect();
    assert_eq!(kinds, ["itself", "carried", "carried", "left"]);
    assert_eq!(owners[1]["by"], serde_json::json!(["ann"]));
    assert!(owners.windows(2).all(|pair| pair[0]["to"] == pair[1]["from"]));
    assert_eq!(owners[0]["from"], relay["start_time"]);
    for name in ["first", "second"] {
        let all = relay["constraints"].as_array().expect("constraints");
        let carry = all.iter().find(|one| one["name"] == name).expect("carries are told");
        let off = carry["residual"].as_f64().expect("hands are measured");
        assert!(off < TOUCH && carry.get("shortfall").is_none(), "on the finished bodies: {carry}");
    }
    let path = objects[0]["path"].as_array().expect("a path");
    assert_eq!(path[path.len() - 1]["time"], owners[3]["to"]);
    let straight = c64::new(0.6, 0.0) - c64::new(5.5, 0.5);
    let length = objects[0]["path_length"].as_f64().expect("metres");
    assert!(length > straight.norm() - 1.0 && length < 3.0 * straight.norm(), "{length}");
    assert_eq!(objects[1]["owners"].as_array().map(Vec::len), Some(1), "the cart is by itself");

    let (slap, _) = told(SLAP);
    assert_eq!(slap["objects"][0]["path"].as_array().map(Vec::len), Some(1), "the table stands");
    let constraints = slap["constraints"].as_array().expect("constraints");
    let reach = &constraints[constraints.len() - 1];
    assert_eq!((&reach["kind"], &reach["unit"]), (&"end_effector".into(), &"m".into()));
    assert!(reach["residual"].as_f64() < Some(TOUCH) && reach.get("shortfall").is_none(), "{reach}");
    let turned = |reach: &Value| reach["orientation_residual"].as_f64().expect("how far it is turned off");
    let slap_hand = &constraints[constraints.len() - 2];
    assert!(turned(reach) < TURNED && turned(slap_hand) < TURNED, "{reach} {slap_hand}");
    let (off, _) = told(&format!("{SLAP}[full_body]\nenabled = false\n"));
    let constraints_off = off["constraints"].as_array().expect("constraints");
    let missed = &constraints_off[constraints_off.len() - 1];
    assert!(missed["shortfall"].as_f64() > Some(0.1), "nobody moves the hand: {missed}");
    assert_eq!(missed["shortfall"], missed["residual"]);
    assert!(turned(missed) > 30.0, "hands hang down, this one must lie across: {missed}");
    assert!(reach.get("strength").is_none());
    let names: Vec<&Value> = slap["moments"].as_array().into_iter().flatten().map(|m| &m["name"]).collect();
    assert!(names.contains(&&Value::from("ann:start")), "moments of reaches are told: {names:?}");
}

#[test]
fn reaches_and_hand_overs_that_nothing_ties_are_warned_of() {
    let warned = |text: &str| -> Vec<String> {
        load(text).warnings.into_iter().map(|warning| warning.message).collect()
    };
    assert_eq!(warned(RELAY), [""; 0]);
    assert_eq!(warned(SLAP), [""; 0]);
    let untied = RELAY.replace("[[sync]]\nname = \"together\"", "[[sync]]\nname = \"other\"").replace(
        "moments = [\"bob/take_over:grasp\", \"ann/hand_over:release\"]",
        "moments = [\"bob:start\", \"ann:start\"]",
    );
    let messages = warned(&untied);
    assert!(messages.iter().any(|message| message.contains("nothing ties the time")), "{messages:?}");
    let lonely = SLAP.replace("[[relative]]\nat = \"bob:hit\"\nto = \"ann:hit\"\n", "");
    let messages = warned(&lonely);
    assert_eq!(messages.len(), 2, "{messages:?}");
    assert!(messages.iter().all(|message| message.contains("nothing brings the body near")), "{messages:?}");
    let alone = SLAP.replace("[[sync]]\nmoments = [\"ann:hit\", \"bob:hit\"]\nstrength = \"hard\"\n", "");
    let messages = warned(&alone);
    assert!(messages.iter().any(|message| message.contains("happen together")), "{messages:?}");
}

#[test]
fn a_carrier_whom_nothing_brings_near_is_warned_of() {
    let scene = |position: &str, relative: &str| {
        let warned = load(&format!(
            "[clips]\npick_up = \"builtin:pick_up\"\n[[character]]\nname = \"ann\"\ntrack = [\"pick_up\"]
            [[object]]\nname = \"box\"\nsize = [0.3, 0.3, 0.3]\nposition = {position}
            [[carry]]\nobject = \"box\"\nby = [\"ann\"]\nduring = [\"ann:grasp\", \"ann:end\"]\n{relative}"
        ));
        warned.warnings.into_iter().map(|warning| warning.message).collect::<Vec<_>>()
    };
    let relative = "[[relative]]\nat = \"ann:grasp\"\nto = \"box\"\noffset = [-0.58, 0.0]\n";
    assert_eq!(scene("[0.6, 0.0]", ""), [""; 0], "she stands before it anyway");
    assert_eq!(scene("[9.0, 9.0]", relative), [""; 0]);
    let lonely = scene("[9.0, 9.0]", "");
    assert!(lonely.len() == 1 && lonely[0].contains("nothing brings \"ann\" near"), "{lonely:?}");
}
