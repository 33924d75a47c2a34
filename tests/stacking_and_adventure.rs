//! What the scenes of the stack and of the adventure say of themselves holds: boxes never jump and are never without owner or
//! resting place, hands stay on them, the stack is as high as its parts; touches are exact and in the order of the story.

mod performed;

use std::path::Path;
use std::sync::LazyLock;

use cotillion::constraint::{Constraint, ConstraintKind, Moment, Strength};
use cotillion::discrete::outcome::Outcome;
use cotillion::edit::{Edit, Moved};
use cotillion::effector::EffectorTarget;
use cotillion::embody::embody;
use cotillion::geometry::{c64, plan_of, wrap};
use cotillion::index::{CharacterId, JointId};
use cotillion::object::ObjectPose;
use cotillion::object_motion::{
    AtRest, ObjectMotion, Owner, Performance, moment_time, object_motions, skeleton_of,
};
use cotillion::reach::{REACHED, Stage, carry_residuals, effector_residuals};
use cotillion::resample::resample;
use cotillion::scene::{ClipFolders, Scene, load};
use cotillion::ties::Ties;
use glam::DVec3;

/// What the project promises of boxes where their owner changes, metres and radians.
const CONTINUOUS: f64 = 1e-9;
/// Simultaneous moments, seconds.
const SIMULTANEOUS: f64 = 1e-9;
/// Heights of boxes on each other: rounding of a few rigid motions of some metres.
const LEVEL: f64 = 1e-9;
/// Boxes of a stack have their middles over each other, metres: a stack by hand.
const OVER_EACH_OTHER: f64 = 0.02;
/// Two who carry stay opposite each other, metres.
const OPPOSITE: f64 = 0.02;

/// Joints of two who do not touch, metres: more than limbs are thick here.
const CLEAR: f64 = 0.08;
/// What who takes a box from a push leaves open: the pusher's hands leave it first, seconds.
const HANDS_CHANGE: f64 = 1e-6;

static STACKING: LazyLock<Outcome> = LazyLock::new(|| played("stacking.toml"));
static ADVENTURE: LazyLock<Outcome> = LazyLock::new(|| played("adventure.toml"));

/// A scene of ours, edited and dragged.
fn played(name: &str) -> Outcome {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(name);
    let scene = load(&path, &ClipFolders::default()).expect("a sound scene").scene;
    performed::performed(scene).expect("the constraints agree")
}

fn apart(a: ObjectPose, b: ObjectPose) -> f64 {
    a.position.distance(b.position).max(wrap(a.facing - b.facing).abs())
}

/// Name, time and miss of every synchronisation of two moments, in the order of the file.
fn syncs(scene: &Scene, edit: &Edit) -> Vec<(String, f64, f64)> {
    let moved = Moved { scene, characters: &edit.characters };
    let of = |constraint: &Constraint| match &constraint.kind {
        ConstraintKind::Sync { moments, offset } => {
            let times: Vec<f64> =
                moments.iter().map(|when| moment_time(scene, &moved, when.moments()[0])).collect();
            Some((constraint.name.clone(), times[0], (times[0] - times[1] - offset).abs()))
        }
        _ => None,
    };
    scene
        .constraints
        .iter()
        .filter(|constraint| constraint.strength == Strength::Hard)
        .filter_map(of)
        .collect()
}

/// Everything of the stack that comes to rest: its height when it does, and that of its top.
fn resting_place(scene: &Scene, motions: &[ObjectMotion], moved: &Moved<'_>, place: (usize, f64)) -> f64 {
    let (object, time) = place;
    let own = motions[object].pose_at(scene, moved, time);
    let below = (0..scene.objects.len()).filter(|other| *other != object).map(|other| {
        let pose = motions[other].pose_at(scene, moved, time);
        let [ahead, up, across] = scene.objects[other].size;
        let local = pose.local(own.position);
        let over = local.x.abs() < 0.5 * ahead && local.z.abs() < 0.5 * across;
        if over && local.y > 0.0 { pose.position.y + up } else { 0.0 }
    });
    own.position.y - below.fold(0.0, f64::max)
}

#[test]
fn boxes_never_jump_and_always_have_an_owner_or_a_resting_place() {
    let Outcome { scene, edit, .. } = &*STACKING;
    let moved = Moved { scene, characters: &edit.characters };
    let motions = object_motions(scene, &moved);
    for (object, motion) in motions.iter().enumerate() {
        let name = &scene.objects[object].name;
        assert_eq!(motion.spans[0].from, f64::NEG_INFINITY);
        assert_eq!(motion.spans.last().map(|span| span.to), Some(f64::INFINITY));
        assert!(motion.spans.windows(2).all(|pair| pair[0].to == pair[1].from), "{name}: no gap, no overlap");
        for span in &motion.spans[1..] {
            let at = |time| motion.pose_at(scene, &moved, time);
            let jump = apart(at(span.from.next_down()), at(span.from.next_up()));
            assert!(jump < CONTINUOUS, "{name} jumps by {jump:e} at {}", span.from);
        }
        let rests = motion.spans.iter().filter(|span| !matches!(span.owner, Owner::Carried(_)));
        for span in rests.filter(|span| span.to - span.from > HANDS_CHANGE) {
            let height = resting_place(scene, &motions, &moved, (object, span.from.max(0.0)));
            assert!(
                height.abs() < LEVEL,
                "{name} hangs {height:e} above what it rests on from {}",
                span.from
            );
        }
    }
}

#[test]
fn the_stack_is_as_high_as_its_parts_together() {
    let Outcome { scene, edit, .. } = &*STACKING;
    let moved = Moved { scene, characters: &edit.characters };
    let motions = object_motions(scene, &moved);
    let end = motions.iter().flat_map(|motion| motion.spans.last()).map(|span| span.from).fold(0.0, f64::max);
    let [pallet, first, second] = ["pallet", "box_1", "box_2"].map(|name| {
        let object = scene.objects.iter().position(|object| object.name == name).expect("it is there");
        (motions[object].pose_at(scene, &moved, end), scene.objects[object].size[1])
    });
    let top = second.0.position.y + second.1;
    assert!((top - (pallet.1 + first.1 + second.1)).abs() < LEVEL, "{top}");
    for (above, below) in [(second, first), (first, pallet)] {
        assert!((above.0.position.y - below.0.position.y - below.1).abs() < LEVEL);
        let aside = (above.0.plan() - below.0.plan()).norm();
        assert!(aside < OVER_EACH_OTHER, "{aside}");
    }
}

#[test]
fn hands_stay_on_what_they_push_lift_and_carry() {
    let Outcome { scene, edit, .. } = &*STACKING;
    let mut resampled = resample(scene, edit).expect("a result of usual length");
    let embodied = embody(scene, edit, &mut resampled);
    let objects = object_motions(scene, &embodied.moved);
    let ties = Ties::of(scene);
    let stage = Stage { scene, performance: &embodied.moved, objects: &objects, ties: &ties };
    for (carry, miss) in scene.carries.iter().zip(carry_residuals(&stage, &embodied)) {
        assert!(miss < REACHED, "{}: {miss}", carry.name);
    }
    for (name, _, miss) in syncs(scene, edit) {
        assert!(miss < SIMULTANEOUS, "{name}: {miss:e}");
    }
}

#[test]
fn who_carry_together_stay_opposite_each_other() {
    let Outcome { scene, edit, .. } = &*STACKING;
    let moved = Moved { scene, characters: &edit.characters };
    let rest = AtRest(scene);
    let carry = scene.carries.iter().find(|carry| carry.by.len() == 2).expect("two carry the pallet");
    let seen = |performance: &dyn Fn(usize, f64) -> c64, frame: f64| {
        performance(carry.by[1].as_usize(), frame) - performance(carry.by[0].as_usize(), frame)
    };
    let (from, to) = (scene.frame_of(&carry.during.0), scene.frame_of(&carry.during.1));
    for k in 0..=20 {
        let frame = from + (to - from) * f64::from(k) / 20.0;
        let root = |who: usize, frame: f64| plan_of(rest.pose(CharacterId::from_usize(who), frame).root);
        let time = moved.time(carry.by[0], frame);
        let edited = |who: usize, _: f64| {
            let who = CharacterId::from_usize(who);
            plan_of(moved.pose(who, moved.frame(who, time)).root)
        };
        let change = seen(&edited, frame).norm() - seen(&root, frame).norm();
        assert!(change.abs() < OPPOSITE, "{change} at frame {frame}");
    }
}

#[test]
fn touches_are_exact_and_in_the_order_of_the_story() {
    let Outcome { scene, edit, .. } = &*ADVENTURE;
    let mut resampled = resample(scene, edit).expect("a result of usual length");
    let embodied = embody(scene, edit, &mut resampled);
    let objects = object_motions(scene, &embodied.moved);
    let ties = Ties::of(scene);
    let stage = Stage { scene, performance: &embodied.moved, objects: &objects, ties: &ties };
    assert_eq!(scene.end_effectors.len(), 4);
    for (touch, miss) in scene.end_effectors.iter().zip(effector_residuals(&stage, &embodied)) {
        assert!(miss.metres < REACHED, "{}: {}", touch.name, miss.metres);
    }
    let joint = |moment: &Moment, joint: JointId| {
        let (who, time) = (moment.character, moment_time(scene, &embodied, moment));
        let pose = embodied.pose(who, embodied.frame(who, time));
        skeleton_of(scene, who).forward_kinematics(&pose)[joint.as_usize()].position
    };
    for touch in &scene.end_effectors {
        let EffectorTarget::Joint { joint: chest, point, when: Some(theirs), .. } = &touch.target else {
            panic!("{} is on somebody's back", touch.name);
        };
        let (hand, back) = (joint(touch.when.moments()[0], touch.joint), joint(theirs.moments()[0], *chest));
        assert!((hand.distance(back) - point.length()).abs() < REACHED, "{}", touch.name);
    }
    let syncs = syncs(scene, edit);
    let time = |story: &str| {
        let sync = syncs.iter().find(|(name, ..)| name == story).expect("the scene has this moment");
        assert!(sync.2 < SIMULTANEOUS, "{story}: {:e}", sync.2);
        sync.1
    };
    let story = [
        "push_2 shoves dodge_1",
        "dodge_1 dodges duck_1",
        "push_1 shoves dodge_2",
        "dodge_1 shoves shrink_1",
        "dodge_2 dodges duck_2",
        "shrink_1 jumps over duck_2",
        "dodge_2 shoves shrink_2",
    ];
    let times = story.map(time);
    assert!(times.is_sorted_by(|a, b| a < b), "{times:?}");
    assert_eq!(syncs.len(), story.len());
}

/// Soles of who jumps are above everything of the child as long as they are over it.
#[test]
fn who_jumps_clears_the_child() {
    let Outcome { scene, edit, .. } = &*ADVENTURE;
    let mut resampled = resample(scene, edit).expect("a result of usual length");
    let embodied = embody(scene, edit, &mut resampled);
    let who = |name: &str| {
        let found = scene.characters.iter().position(|character| character.name == name);
        CharacterId::from_usize(found.expect("the scene has this character"))
    };
    let places = |who: CharacterId, time: f64| -> Vec<DVec3> {
        let pose = embodied.pose(who, embodied.frame(who, time));
        let frames = skeleton_of(scene, who).forward_kinematics(&pose);
        frames.iter().map(|frame| frame.position).collect()
    };
    let (jumper, child) = (who("shrink_1"), who("duck_2"));
    let relation = scene.constraints.iter().find(|one| one.name == "shrink_1 over duck_2").expect("it jumps");
    let takeoff = moment_time(scene, &embodied, relation.kind.moments()[0]);
    for k in 0..=30 {
        let time = takeoff + f64::from(k) * 0.02;
        let low = places(child, time);
        let nearest = places(jumper, time)
            .iter()
            .flat_map(|own| low.iter().map(move |other| own.distance(*other)))
            .fold(f64::INFINITY, f64::min);
        assert!(nearest > CLEAR, "{nearest} at {time}");
    }
}

/// Whose tracks have more frames after the drags than before.
fn lengthened(outcome: &Outcome) -> Vec<&str> {
    let pairs = outcome.original.characters.iter().zip(&outcome.scene.characters);
    let longer = pairs.filter(|(before, after)| after.track.frame_count() > before.track.frame_count());
    longer.map(|(before, _)| before.name.as_str()).collect()
}

#[test]
fn steps_appear_where_somebody_is_dragged_away() {
    let stacking = lengthened(&STACKING);
    assert!(["pick_up_1", "carry_1"].iter().all(|name| stacking.contains(name)), "{stacking:?}");
    let adventure = lengthened(&ADVENTURE);
    assert!(["push_2", "shrink_2"].iter().all(|name| adventure.contains(name)), "{adventure:?}");
}
