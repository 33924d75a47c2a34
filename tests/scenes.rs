//! Every scene of `scenes/` runs with its drags, and what it says holds: hard constraints to 1e-9, synchronised moments to 1e-9 s,
//! finite poses, feet that slide no more than captured, who is touched up nearer to balance, hands on what they carry and
//! apart from each other where it is handed over, nobody who lunges, the same bytes twice, the same answer by both backends. Scenes on real
//! capture are reported as skipped where there is none.

mod agree;
mod performed;

use std::fs;
use std::path::{Path, PathBuf};

use cotillion::constraint::{ConstraintKind, Strength};
use cotillion::discrete::outcome::Outcome;
use cotillion::edit::Editor;
use cotillion::embody::Embodied;
use cotillion::export::bvh::BvhOptions;
use cotillion::export::physics_report::{PhysicsReport, physics_report};
use cotillion::export::report::{RestEdited, report};
use cotillion::export::scene::{ANIMATED, animation, scene_files};
use cotillion::export::touch_up_report::JudgedReport;
use cotillion::index::{CharacterId, JointId};
use cotillion::object::hand_overs;
use cotillion::object_motion::{Performance, moment_time, object_motions, skeleton_of};
use cotillion::plausible::{TouchUps, embody_plausibly};
use cotillion::reach::{REACHED, Stage, carry_residuals};
use cotillion::resample::{Resampled, resample};
use cotillion::residual::residuals;
use cotillion::scene::{ClipFolders, Loaded, Scene, load};
use cotillion::skeleton::JointRole;
use cotillion::ties::Ties;
use glam::DVec3;
use libtest_mimic::{Arguments, Failed, Trial};

/// Hard constraints hold to this, metres, radians, seconds.
const HARD: f64 = 1e-9;
/// Mean speeds of feet compare to this, m/s: soft constraints are solved to 1e-7 m.
const SLIDE: f64 = 1e-7;
/// The same of those who lean, m/s: legs give by a tenth of a millimetre where hips are held.
const LEANS: f64 = 1e-3;
/// Bones of hands that hold one thing keep so far apart, metres: a hand is three centimetres thick.
const HANDS_APART: f64 = 0.05;
/// So long before and after a hand-over, seconds.
const ABOUT: f64 = 0.3;
/// Points looked at along a bone of a hand.
const STEPS: u32 = 8;
/// Nobody comes down farther than this to reach with hands and feet, metres: strides stay strides.
const LUNGE: f64 = 0.1;

fn main() {
    let mut arguments = Arguments::from_args();
    arguments.test_threads = Some(1);
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let capture = capture_folder(root);
    let mut trials = Vec::new();
    for (folder, needs_capture) in [("scenes", false), ("scenes/capture", true)] {
        for path in scenes(&root.join(folder)) {
            let name = format!("{folder}/{}", path.file_name().unwrap_or_default().to_string_lossy());
            let folders = ClipFolders { mocap: capture.clone() };
            let skipped = needs_capture && capture.is_none();
            trials.push(Trial::test(name, move || holds(&path, &folders)).with_ignored_flag(skipped));
        }
    }
    assert!(trials.len() >= 3, "the scenes are found");
    libtest_mimic::run(&arguments, trials).exit();
}

/// Real capture: what `$COTILLION_MOCAP` says, else `../shared/mocap`.
fn capture_folder(root: &Path) -> Option<PathBuf> {
    let named = std::env::var_os("COTILLION_MOCAP").map(PathBuf::from);
    named.or_else(|| Some(root.join("../shared/mocap"))).filter(|folder| folder.is_dir())
}

fn scenes(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).expect("scenes are beside this file").flatten();
    let mut scenes: Vec<PathBuf> = entries
        .map(|entry| entry.path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "toml"))
        .collect();
    scenes.sort();
    scenes
}

fn holds(path: &Path, folders: &ClipFolders) -> Result<(), Failed> {
    let text = fs::read_to_string(path)?;
    if !text.starts_with("# ") || !text.contains("What must hold") {
        return Err("the first comment says what the scene shows and what must hold".into());
    }
    let Loaded { scene, warnings, .. } = load(path, folders).map_err(|faults| faults.to_string())?;
    if let Some(warning) = warnings.first() {
        return Err(format!("a scene of ours is free of warnings: {}", warning.message).into());
    }
    agree::both_backends(&scene)?;
    let files = edited(&scene)?;
    if files != edited(&scene)? {
        return Err("two runs give different bytes".into());
    }
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    shown(&format!("{stem}.svg"), "scene.svg", &files)?;
    shown(&format!("{stem}_animated.svg"), ANIMATED, &files)?;
    shown(&format!("{stem}_before.svg"), "before.svg", &files)
}

/// Compares a picture in `docs/`, where there is one, with one of the files of its scene.
fn shown(name: &str, file: &str, files: &[(String, Vec<u8>)]) -> Result<(), Failed> {
    let picture = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs").join(name);
    if !picture.is_file() {
        return Ok(());
    }
    let drawn = files.iter().find(|(name, _)| name == file).map(|(_, bytes)| bytes);
    if Some(&fs::read(&picture)?) != drawn {
        return Err(format!("{} is not what the scene gives; run it again", picture.display()).into());
    }
    Ok(())
}

/// Edits and drags `scene`, checks its hard constraints, returns its files.
fn edited(scene: &Scene) -> Result<Vec<(String, Vec<u8>)>, Failed> {
    let outcome = performed::performed(scene.clone()).map_err(|error| error.to_string())?;
    let Outcome { scene, edit, log, .. } = &outcome;
    if !scene.drags.is_empty() && scene.discrete.is_some() && log.is_empty() {
        return Err("no step comes or goes, whatever is dragged".into());
    }
    let mut hard = 0;
    for (constraint, residual) in scene.constraints.iter().zip(residuals(scene, edit)) {
        if constraint.strength != Strength::Hard {
            continue;
        }
        hard += 1;
        let spatial = [residual.position, residual.path_position, residual.facing];
        for miss in spatial.into_iter().flatten().chain(residual.seconds) {
            if miss.is_nan() || miss >= HARD {
                return Err(format!("{} misses by {miss:e}", constraint.name).into());
            }
        }
        let seen = residual.position.is_some() || residual.facing.is_some() || residual.seconds.is_some();
        if !seen {
            return Err(format!("{} was not measured", constraint.name).into());
        }
    }
    let syncs = scene.constraints.iter().filter(|c| matches!(c.kind, ConstraintKind::Sync { .. })).count();
    if hard == 0 || syncs == 0 {
        return Err("a scene of ours has hard constraints and synchronised moments".into());
    }
    let mut resampled = resample(scene, edit).map_err(|error| error.to_string())?;
    let (embodied, touch_ups) = embody_plausibly(scene, edit, &mut resampled);
    leans(scene, &touch_ups, &resampled)?;
    hands_hold(scene, &embodied)?;
    for told in report(&embodied, &outcome, &resampled).characters {
        let drop = told.full_body.as_ref().map_or(0.0, |body| body.root_drop);
        if drop > LUNGE {
            return Err(format!("{} comes down by {drop} m", told.name).into());
        }
        let RestEdited { rest, edited } = told.foot_slide;
        // What drifts as captured does so faster where time is pressed together.
        let allowed =
            rest / told.time_step.min.min(1.0) + if scene.physics.is_some() { LEANS } else { SLIDE };
        if edited > allowed {
            return Err(format!("{}'s feet slide {edited} m/s, captured {rest} m/s", told.name).into());
        }
    }
    for clip in &resampled.clips {
        let finite =
            clip.root_positions.iter().all(|p| p.is_finite()) && clip.rotations.iter().all(|q| q.is_finite());
        if !finite {
            return Err(format!("{} has poses that are not finite", clip.name).into());
        }
    }
    let mut undragged = Editor::new(outcome.original.clone()).map_err(|error| error.to_string())?;
    let rest = undragged.solve().map_err(|error| error.to_string())?;
    let before = (!scene.drags.is_empty()).then_some((&outcome.original, rest));
    Ok(scene_files((scene, edit), before, &resampled, &BvhOptions::default())
        .into_iter()
        .chain([animation((scene, edit))])
        .map(|file| (file.name, file.bytes))
        .collect())
}

/// The ground pass may be undone beside flights: there distances end at most this many times where they began …
const BESIDE_FLIGHTS: f64 = 3.0;
/// … elsewhere what brings hands back undoes no more than this share of it.
const UNDONE: f64 = 0.5;

/// Whoever is touched up ends nearer to what the ground can bear.
fn leans(scene: &Scene, touch_ups: &TouchUps, resampled: &Resampled) -> Result<(), Failed> {
    if scene.physics.is_some() && touch_ups.is_empty() {
        return Err("nobody is touched up".into());
    }
    for (who, touched) in touch_ups {
        let name = &scene.characters[who.as_usize()].name;
        let written = resampled.clip(*who).ok_or("who is touched up has a clip")?;
        let PhysicsReport::Touched(told) = physics_report(touched, written) else {
            return Err(format!("{name} is not touched up").into());
        };
        let mean = |own: &JudgedReport| own.d.map_or(f64::NAN, |d| d.mean);
        let [before, ground, result] =
            [&told.done.ground.before, &told.done.ground.after, &told.done.result].map(mean);
        let most = if told.done.flights.is_empty() {
            ground + UNDONE * (before - ground)
        } else {
            BESIDE_FLIGHTS * before
        };
        let is_better = ground < before && result <= most;
        if !is_better {
            return Err(format!("{name}: {before} m before, {ground} m on the ground, {result} m").into());
        }
    }
    Ok(())
}

/// Hands are where they hold what they carry, and touch it; those of who hands over and of who takes over do not touch.
fn hands_hold(scene: &Scene, embodied: &Embodied<'_>) -> Result<(), Failed> {
    let objects = object_motions(scene, &embodied.moved);
    let ties = Ties::of(scene);
    let stage = Stage { scene, performance: &embodied.moved, objects: &objects, ties: &ties };
    for (carry, miss) in scene.carries.iter().zip(carry_residuals(&stage, embodied)) {
        if miss > REACHED {
            return Err(format!("hands are {miss} m from where \"{}\" holds", carry.name).into());
        }
    }
    for (first, second) in hand_overs(&scene.carries) {
        let (first, second) = (&scene.carries[first], &scene.carries[second]);
        let [released, grasped] =
            [&first.during.1, &second.during.0].map(|moment| moment_time(scene, embodied, moment));
        let pairs = first.by.iter().flat_map(|giver| second.by.iter().map(move |taker| [*giver, *taker]));
        for pair in pairs.filter(|[giver, taker]| giver != taker && grasped - released < ABOUT) {
            let times = (-10..=10).map(|k| grasped + ABOUT * f64::from(k) / 10.0);
            let nearest = |time| nearest(pair.map(|who| hand_points((scene, embodied), who, time)));
            let off = times.map(nearest).fold(f64::INFINITY, f64::min);
            if off < HANDS_APART {
                return Err(format!("hands are {off} m apart where \"{}\" begins", second.name).into());
            }
        }
    }
    Ok(())
}

fn nearest([some, others]: [Vec<DVec3>; 2]) -> f64 {
    let to_others =
        |point: &DVec3| others.iter().map(|other| point.distance(*other)).fold(f64::INFINITY, f64::min);
    some.iter().map(to_others).fold(f64::INFINITY, f64::min)
}

/// Points along all bones of both hands of somebody.
fn hand_points((scene, embodied): (&Scene, &Embodied<'_>), who: CharacterId, time: f64) -> Vec<DVec3> {
    let skeleton = skeleton_of(scene, who);
    let frames = skeleton.forward_kinematics(&embodied.pose(who, embodied.frame(who, time)));
    let hands = [JointRole::LeftHand, JointRole::RightHand].map(|hand| skeleton.joint_of(hand));
    let mut of_hand = vec![false; frames.len()];
    let mut bones = Vec::new();
    for (index, joint) in skeleton.joints.iter().enumerate() {
        let (id, frame) = (JointId::from_usize(index), frames[index]);
        let parent = joint.parent.map(JointId::as_usize).filter(|parent| of_hand[*parent]);
        of_hand[index] = parent.is_some() || hands.contains(&Some(id));
        bones.extend(parent.map(|parent| [frames[parent].position, frame.position]));
        let end = joint.end_site.filter(|_| of_hand[index]);
        bones.extend(end.map(|end| [frame.position, frame.position + frame.rotation * end]));
    }
    let along = |[from, to]: &[DVec3; 2]| {
        let (from, to) = (*from, *to);
        (0..=STEPS).map(move |k| from.lerp(to, f64::from(k) / f64::from(STEPS)))
    };
    bones.iter().flat_map(along).collect()
}
