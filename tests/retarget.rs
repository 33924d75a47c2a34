//! Clips performed by other bodies look as they did: captures of every flavour, there and back.
//!
//! Looks in `$COTILLION_MOCAP`, else in `../shared/mocap` beside the checkout; where neither exists the tests on captures
//! are ignored, by name. With `$COTILLION_TABLE` set, every measure is printed.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use cotillion::clip::Clip;
use cotillion::clip::builtin::generate;
use cotillion::clip::contacts::{ContactPoint, Contacts, contact_point, percentile};
use cotillion::clip::file::read_file;
use cotillion::clip::measure::foot_slide;
use cotillion::clip::read::ReadOptions;
use cotillion::clip::retarget::{RetargetReport, retarget};
use cotillion::clip::working::{WORKING_STEP, WorkingClip};
use cotillion::edit::Editor;
use cotillion::embody::embody;
use cotillion::index::SourceFrame;
use cotillion::resample::resample;
use cotillion::scene::{ClipFolders, load_text};
use cotillion::skeleton::{Joint, JointFrame, JointRole, Pose};
use glam::DVec3;
use libtest_mimic::{Arguments, Failed, Trial};

/// The 31 joints of an Acclaim file: every other body takes its walk, and it takes theirs.
const HUB: &str = "amc/cmu_16_15_walk_straight.amc";
/// The generated body, and captured ones of 13, 43, 37 and 13 joints.
const OTHERS: [&str; 5] = [
    "builtin:walk",
    "bvh/snu_walk_straight_normal.bvh",
    "bvh/cmu_60_05_salsa_A.bvh",
    "bvh/mass_walk.bvh",
    "deepmimic/humanoid3d_walk.txt",
];

/// A body whose feet are one segment straight down from the ankle, and some of those that take its walk.
const DOWNWARD: &str = "bvh/cmu_37_01_walk.bvh";
const AHEAD: [&str; 4] = [HUB, OTHERS[1], OTHERS[2], OTHERS[4]];

/// Rounding of a bone's length, metres.
const BONES: f64 = 1e-9;
/// Knees are jerked so many times harder than in the clip.
const KNEES: f64 = 1.5;
/// Feet slide so many times the scaled clip's: toes of longer and shorter feet do when feet roll.
const SLIDE: f64 = 1.1;
/// Soles come as near to the ground as the clip's, metres.
const SOLES: f64 = 0.01;
/// The ground that is found under two clips of one body, metres: one lasts a single second, and few of its feet are flat.
const GROUND: f64 = 0.015;
/// Upper and lower arms point where the clip's do, radians: rounding.
const ARMS: f64 = 1e-6;
/// Limbs there and back, degrees: where flat feet are found on both bodies, ankles differ a little.
const LIMBS_BACK: f64 = 3.0;
/// Trunks there and back, degrees: a trunk of fewer joints bends elsewhere.
const TRUNK_BACK: f64 = 9.0;
/// A body of another stature is like in every joint, metres: legs are never wholly straight.
const STATURE: f64 = 2e-3;

fn main() {
    let has_captures = mocap().is_some();
    let mut trials = vec![
        Trial::test("a body of another stature does the same, larger or smaller", statures),
        Trial::test("clips of two statures make one track", || track("builtin:walk", "[0, 59]")),
        Trial::test("the motion of a rope is refused", rope),
        Trial::test("bodies without size or with legs of one bone come out finite", degenerate),
    ];
    let mut push = |name: String, run: Box<dyn FnOnce() -> Result<(), Failed> + Send>| {
        trials.push(Trial::test(name, run).with_ignored_flag(!has_captures));
    };
    for name in [HUB].into_iter().chain(OTHERS) {
        push(format!("{name} comes out of its own body bit for bit"), Box::new(move || same(name)));
    }
    for other in OTHERS {
        for (from, onto) in [(HUB, other), (other, HUB)] {
            push(format!("{from} performed by the body of {onto}"), Box::new(move || perform(from, onto)));
        }
    }
    for onto in AHEAD {
        let name = format!("feet straight down roll off on the toes of {onto}");
        push(name, Box::new(move || roll_off(onto)));
    }
    push("a generated walk and a capture make one track".to_owned(), Box::new(|| track(HUB, "[0, 300]")));
    libtest_mimic::run(&Arguments::from_args(), trials).exit();
}

fn mocap() -> Option<PathBuf> {
    let beside = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/mocap");
    let folder = std::env::var_os("COTILLION_MOCAP").map_or_else(beside, PathBuf::from);
    folder.is_dir().then_some(folder)
}

fn clip(name: &str) -> Result<Clip, Failed> {
    if let Some(builtin) = name.strip_prefix("builtin:") {
        return Ok(generate(builtin, &BTreeMap::new())?);
    }
    Ok(read_file(&mocap().ok_or("no captures found")?.join(name), None, &ReadOptions::default())?.clip)
}

fn same(name: &str) -> Result<(), Failed> {
    let own = clip(name)?;
    let (made, report) = retarget(&own, &clip(name)?)?;
    let is_same = made == own && report == RetargetReport { scale: 1.0, ..RetargetReport::default() };
    if is_same { Ok(()) } else { Err("it differs".into()) }
}

fn rope() -> Result<(), Failed> {
    let mut rope = generate("walk", &BTreeMap::new())?;
    let mut skeleton = (*rope.skeleton).clone();
    for (knot, joint) in skeleton.joints.iter_mut().enumerate() {
        joint.role = None;
        joint.name = format!("knot{knot}");
    }
    rope.skeleton = Arc::new(skeleton);
    match retarget(&rope, &generate("walk", &BTreeMap::new())?) {
        Err(_) => Ok(()),
        Ok(_) => Err("a body took it".into()),
    }
}

fn degenerate() -> Result<(), Failed> {
    let walk = generate("walk", &BTreeMap::new())?;
    let changed = |change: &dyn Fn(&mut Joint)| {
        let mut skeleton = (*walk.skeleton).clone();
        skeleton.joints.iter_mut().for_each(change);
        Clip { skeleton: Arc::new(skeleton), ..walk.clone() }
    };
    let is_knee = |joint: &Joint| matches!(joint.role, Some(R::LeftKnee | R::RightKnee));
    let odd = [
        changed(&|joint| joint.offset = DVec3::ZERO),
        changed(&|joint| joint.offset *= 1e9),
        changed(&|joint| joint.offset *= if is_knee(joint) { 0.0 } else { 1.0 }),
        changed(&|joint| joint.offset *= if is_knee(joint) { 1e9 } else { 1.0 }),
        changed(&|joint| joint.offset = DVec3::Y),
    ];
    for (from, onto) in odd.iter().flat_map(|odd| [(odd, &walk), (&walk, odd)]) {
        let (made, report) = retarget(from, onto)?;
        let joints = frames(&made).into_iter().flatten();
        if !report.shortfall.is_finite() || !joints.into_iter().all(|joint| joint.position.is_finite()) {
            return Err("a joint is nowhere".into());
        }
    }
    Ok(())
}

fn statures() -> Result<(), Failed> {
    let walk = |stature: f64| generate("walk", &BTreeMap::from([("stature".to_owned(), stature)]));
    let (tall, short) = (walk(1.9)?, walk(1.55)?);
    for (from, onto) in [(&tall, &short), (&short, &tall)] {
        let (made, report) = retarget(from, onto)?;
        let (own, other) = (frames(from), frames(&made));
        let apart = |(a, b): (&Vec<JointFrame>, &Vec<JointFrame>)| {
            a.iter().zip(b).map(|(a, b)| (a.position * report.scale).distance(b.position)).fold(0.0, f64::max)
        };
        let farthest = own.iter().zip(&other).map(apart).fold(0.0, f64::max);
        let has_all = report.at_rest.is_empty() && report.unused.is_empty();
        let keeps = made.events == from.events && made.usable == from.usable && made.fps == from.fps;
        if farthest > STATURE || !has_all || !keeps {
            return Err(format!("{farthest} m apart: {report:?}").into());
        }
    }
    Ok(())
}

/// A walk of somebody tall, then `second`, on one track: it loads, is solved and embodied.
fn track(second: &str, range: &str) -> Result<(), Failed> {
    let source = match second.strip_prefix("builtin:") {
        Some(name) => format!("{{ builtin = \"{name}\", frames = {range} }}"),
        None => format!("{{ file = \"mocap:{second}\", frames = {range} }}"),
    };
    for body in ["walk", "next"] {
        let text = format!(
            "[clips]\nwalk = {{ builtin = \"walk\", stature = 1.9 }}\nnext = {source}\n\
             [[character]]\nname = \"ann\"\ntrack = [\"walk\", \"next\", \"walk\"]\nskeleton = \"{body}\"\n\
             [[pin]]\nat = \"ann:end\"\nposition = [3, 1]\n"
        );
        let loaded = load_text(&text, Path::new("mixed.toml"), &ClipFolders { mocap: mocap() })
            .map_err(|faults| format!("{faults:?}"))?;
        let track = loaded.scene.characters[0].track.clone();
        let skeleton = &track.clips[0].clip.skeleton;
        if !track.clips.iter().all(|clip| skeleton.matches(&clip.clip.skeleton)) {
            return Err("the track has two bodies".into());
        }
        let scene = loaded.scene.clone();
        let mut editor = Editor::new(loaded.scene)?;
        let edit = editor.solve()?;
        let mut resampled = resample(&scene, edit)?;
        embody(&scene, edit, &mut resampled);
        let made = &resampled.clips[0];
        let joints = frames(made).into_iter().flatten();
        if !joints.into_iter().all(|joint| joint.position.is_finite()) || bone_change(made) > BONES {
            return Err("the motion is torn".into());
        }
    }
    Ok(())
}

fn perform(from: &str, onto: &str) -> Result<(), Failed> {
    let (own, other) = (clip(from)?, clip(onto)?);
    let (there, report) = retarget(&own, &other)?;
    let (back, _) = retarget(&there, &own)?;
    let contacts = working(&own).contacts;
    let slides = [&own, &there].map(|clip| slide(clip, &contacts));
    let slide_ratio = slides[1] / (slides[0] * report.scale);
    let depths = [&own, &there].map(|clip| depth(clip, &contacts));
    let sinks = depths[1] - depths[0] * report.scale;
    let ground = standing(&there, &contacts) - standing(&other, &working(&other).contacts);
    let (limbs, trunk) = (turn(&own, &back, &LIMBS), turn(&own, &back, &TRUNK));
    let arms = turn(&own, &there, &ARM_BONES).to_radians();
    let bones = bone_change(&there);
    let [own_knees, knees] = [&own, &there].map(knee_acceleration);
    let knees = knees / own_knees;
    let measures = format!(
        "slide {slide_ratio:.3}, soles {sinks:.4} m, ground {ground:.4} m, limbs back {limbs:.2}°, trunk back \
         {trunk:.2}°, arms {arms:.1e}, bones {bones:.1e} m, knees {knees:.3}, short of {:.4} m",
        report.shortfall
    );
    let is_good = slide_ratio <= SLIDE
        && sinks.abs() <= SOLES
        && ground.abs() <= GROUND
        && limbs <= LIMBS_BACK
        && trunk <= TRUNK_BACK
        && arms <= ARMS
        && bones <= BONES
        && knees <= KNEES
        && report.shortfall <= SOLES;
    if is_good { Ok(()) } else { Err(measures.into()) }
}

/// Points that come no more than so much higher than in the scaled clip are on the ground where its are, metres: the end of a
/// segment straight down is under the ankle and lands before a toe that is ahead.
const LANDED: f64 = 0.005;

/// Toes slide no more than the ends of the clip's feet do, once they are on the ground.
fn roll_off(onto: &str) -> Result<(), Failed> {
    let own = clip(DOWNWARD)?;
    let (there, report) = retarget(&own, &clip(onto)?)?;
    let contacts = working(&own).contacts;
    let lengths = ContactPoint::FEET.map(|point| {
        let [from, to] = [&own, &there].map(|clip| ways(clip, point));
        let floor = |ways: &[DVec3]| percentile(ways.iter().map(|place| place.y).collect(), 0.01);
        let [floor_from, floor_to] = [floor(&from), floor(&to)];
        let is_down = |frame: &usize| {
            let bears = contacts[*frame].at(point) && contacts[frame + 1].at(point);
            bears && to[*frame].y - floor_to < (from[*frame].y - floor_from) * report.scale + LANDED
        };
        let length = |ways: &[DVec3]| -> f64 {
            let steps = (0..ways.len() - 1).filter(is_down);
            steps.map(|frame| (ways[frame + 1] - ways[frame]).with_y(0.0).length()).sum()
        };
        [length(&from) * report.scale, length(&to)]
    });
    let [from, to] = [0, 1].map(|which| lengths.iter().map(|length| length[which]).sum::<f64>());
    if to <= from { Ok(()) } else { Err(format!("they slide {:.3} times as far", to / from).into()) }
}

/// Places of a point of the feet in each working frame.
fn ways(clip: &Clip, point: ContactPoint) -> Vec<DVec3> {
    let at = contact_point(&clip.skeleton, point).expect("walking bodies have feet");
    let working = working(clip);
    let poses = (0..working.frame_count()).map(|frame| working.pose(frame as f64));
    poses.map(|pose| at.place(&clip.skeleton.forward_kinematics(&pose))).collect()
}

fn working(clip: &Clip) -> WorkingClip {
    WorkingClip::new("", Arc::new(clip.clone()), clip.usable.0, clip.usable.1)
}

/// Mean slide of the feet where `contacts` say that they bear, m/s.
fn slide(clip: &Clip, contacts: &[Contacts]) -> f64 {
    let working = working(clip);
    let poses: Vec<Pose> = (0..working.frame_count()).map(|frame| working.pose(frame as f64)).collect();
    let sampled = Clip::from_poses("", Arc::clone(&clip.skeleton), 1.0 / WORKING_STEP, &poses);
    foot_slide(&sampled, contacts).unwrap_or(0.0)
}

/// Height of the lowest ankle or toe in each working frame, metres.
fn lowest(clip: &Clip) -> Vec<f64> {
    let points: Vec<_> =
        ContactPoint::FEET.iter().filter_map(|point| contact_point(&clip.skeleton, *point)).collect();
    let working = working(clip);
    let poses = (0..working.frame_count()).map(|frame| working.pose(frame as f64));
    let height = |pose: Pose| {
        let frames = clip.skeleton.forward_kinematics(&pose);
        points.iter().map(|point| point.place(&frames).y).fold(f64::INFINITY, f64::min)
    };
    poses.map(height).collect()
}

/// Height of the soles' lowest points above the world's ground while feet bear, metres: the lower quartile, as feet that
/// roll are higher.
fn standing(clip: &Clip, contacts: &[Contacts]) -> f64 {
    let heights = lowest(clip).into_iter().zip(contacts);
    percentile(heights.filter(|(_, contact)| contact.any()).map(|(height, _)| height).collect(), 0.25)
}

/// How far the soles ever sink below where they stand, metres.
fn depth(clip: &Clip, contacts: &[Contacts]) -> f64 {
    standing(clip, contacts) - lowest(clip).into_iter().fold(f64::INFINITY, f64::min)
}

use JointRole as R;
type Bone = (R, R);
const ARM_BONES: [Bone; 2] = [(R::LeftShoulder, R::LeftElbow), (R::RightShoulder, R::RightElbow)];
const LIMBS: [Bone; 8] = [
    (R::LeftHip, R::LeftKnee),
    (R::RightHip, R::RightKnee),
    (R::LeftKnee, R::LeftFoot),
    (R::RightKnee, R::RightFoot),
    (R::LeftShoulder, R::LeftElbow),
    (R::RightShoulder, R::RightElbow),
    (R::LeftFoot, R::LeftToe),
    (R::RightFoot, R::RightToe),
];
const TRUNK: [Bone; 2] = [(R::Pelvis, R::Chest), (R::Chest, R::LeftShoulder)];

/// Largest angle between bones of two clips of equally many frames, degrees; bones that either lacks are left out.
fn turn(a: &Clip, b: &Clip, bones: &[Bone]) -> f64 {
    let ends = |clip: &Clip, (from, to): Bone| {
        let at = |role| clip.skeleton.joint_of(role).map(|joint| joint.as_usize());
        Some([at(from)?, at(to)?])
    };
    let pairs: Vec<_> = bones.iter().filter_map(|bone| Some((ends(a, *bone)?, ends(b, *bone)?))).collect();
    let along = |frames: &[JointFrame], [from, to]: [usize; 2]| frames[to].position - frames[from].position;
    let worst = |(a, b): (&Vec<JointFrame>, &Vec<JointFrame>)| {
        let angles = pairs.iter().map(|(in_a, in_b)| along(a, *in_a).angle_between(along(b, *in_b)));
        angles.fold(0.0, f64::max)
    };
    frames(a).iter().zip(&frames(b)).map(worst).fold(0.0, f64::max).to_degrees()
}

/// Joint frames of the usable frames.
fn frames(clip: &Clip) -> Vec<Vec<JointFrame>> {
    let usable = clip.usable.0.0..=clip.usable.1.0;
    usable.map(|frame| clip.skeleton.forward_kinematics(&clip.pose(SourceFrame(frame)))).collect()
}

/// Largest difference of a bone from its length in the skeleton, metres.
fn bone_change(clip: &Clip) -> f64 {
    let change = |frames: &Vec<JointFrame>| {
        let joints = clip.skeleton.joints.iter().enumerate();
        let bones = joints.filter_map(|(joint, row)| {
            let parent = frames[row.parent?.as_usize()].position;
            Some((frames[joint].position.distance(parent) - row.offset.length()).abs())
        });
        bones.fold(0.0, f64::max)
    };
    frames(clip).iter().map(change).fold(0.0, f64::max)
}

/// Largest angular acceleration of a knee's bend, rad/s².
fn knee_acceleration(clip: &Clip) -> f64 {
    let at = |role| clip.skeleton.joint_of(role).map_or(0, |joint| joint.as_usize());
    let working = working(clip);
    let bends = |legs: [R; 3]| {
        let [hip, knee, foot] = legs.map(at);
        let poses = (0..working.frame_count()).map(|frame| working.pose(frame as f64));
        let bend = move |pose: Pose| {
            let frames = clip.skeleton.forward_kinematics(&pose);
            let place = |joint: usize| frames[joint].position;
            (place(knee) - place(hip)).angle_between(place(foot) - place(knee))
        };
        poses.map(bend).collect::<Vec<f64>>()
    };
    let legs = [[R::LeftHip, R::LeftKnee, R::LeftFoot], [R::RightHip, R::RightKnee, R::RightFoot]];
    let second = |three: &[f64]| (three[0] - 2.0 * three[1] + three[2]).abs() / (WORKING_STEP * WORKING_STEP);
    legs.into_iter().flat_map(|leg| bends(leg).windows(3).map(second).collect::<Vec<_>>()).fold(0.0, f64::max)
}
