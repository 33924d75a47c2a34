//! What the scenes on real capture say of their plots, measured on the finished bodies: order and touches of the
//! adventure, obstacles cleared, hands on the beam for two. Reported as skipped where there is no capture.

mod fingers;

use std::path::{Path, PathBuf};

use cotillion::discrete::outcome::Outcome;
use cotillion::edit::{Edit, Editor};
use cotillion::embody::{Embodied, embody};
use cotillion::export::report::{Report, RestEdited, report};
use cotillion::geometry::wrap;
use cotillion::index::{CharacterId, JointId, ObjectId};
use cotillion::object::ObjectPose;
use cotillion::object_motion::{ObjectMotion, Owner, Performance, object_motions, skeleton_of};
use cotillion::resample::resample;
use cotillion::scene::{ClipFolders, Scene, load};
use cotillion::skeleton::{JointFrame, JointRole, Skeleton};
use fingers::hand_points;
use glam::DVec3;
use libtest_mimic::{Arguments, Failed, Trial};

/// Hard times hold to this, seconds.
const SAME_TIME: f64 = 1e-9;
/// What the project promises of end effectors and of hands on what they carry, metres.
const TOUCH: f64 = 1e-3;
/// What it promises of objects that change hands, metres and radians.
const CONTINUOUS: f64 = 1e-9;
/// A hand this near to a box touches it, metres: half a finger.
const TOUCHING: f64 = 0.01;
/// Wrists bend no farther than this, degrees: 110 from the line of the forearm.
const WRIST: f64 = 110.0;
/// Wrists turn no faster than this on their way to what they hold and back, degrees from one output frame to the next: captured ones
/// turn by up to 8 here.
const EASED: f64 = 10.0;
/// Nobody's body comes down farther than this to reach with feet and hands, metres: strides stay strides.
const LUNGE: f64 = 0.1;
/// Half the thickness of a forearm, metres: bones keep so far from obstacles.
const FLESH: f64 = 0.04;
/// Bones of people who only pass keep so far apart, metres: twice the flesh, and some air.
const AIR: f64 = 0.12;
/// Rounding of mean speeds of feet, m/s.
const SPEED_ROUNDING: f64 = 1e-9;

type Check = fn(&Played<'_>) -> Result<(), Failed>;

const CHECKS: [(&str, &str, Check); 11] = [
    ("adventure", "comes to pass in the order of the plot", order),
    ("adventure", "touches are exact at their moments", touches),
    ("adventure", "dan is in the air above cid, who is on the floor", above),
    ("adventure", "obstacles are cleared where they stand", obstacles),
    ("adventure", "nobody runs through anybody", apart),
    ("adventure", "nothing is out of reach, and feet slide no more than captured", sound),
    ("carry", "four hands stay on the beam", hands),
    ("carry", "the beam never jumps and comes to lie on the far blocks", beam),
    ("carry", "carriers stay opposite the ends of the beam", opposite),
    ("carry", "both grasp together and both let go together", together),
    ("carry", "nothing is out of reach, and feet slide no more than captured", sound),
];

fn main() {
    let mut arguments = Arguments::from_args();
    arguments.test_threads = Some(1);
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let capture = capture_folder(root);
    let trials = CHECKS.map(|(scene, promise, check)| {
        let path = root.join(format!("scenes/capture/{scene}.toml"));
        let folders = ClipFolders { mocap: capture.clone() };
        Trial::test(format!("{scene}: {promise}"), move || play(&path, &folders, check))
            .with_ignored_flag(capture.is_none())
    });
    libtest_mimic::run(&arguments, trials.into()).exit();
}

/// Real capture: what `$COTILLION_MOCAP` says, else `../shared/mocap`.
fn capture_folder(root: &Path) -> Option<PathBuf> {
    let named = std::env::var_os("COTILLION_MOCAP").map(PathBuf::from);
    named.or_else(|| Some(root.join("../shared/mocap"))).filter(|folder| folder.is_dir())
}

/// A scene with everybody's finished body.
struct Played<'a> {
    scene: &'a Scene,
    bodies: Embodied<'a>,
    objects: Vec<ObjectMotion>,
    report: Report,
}

fn play(path: &Path, folders: &ClipFolders, check: Check) -> Result<(), Failed> {
    let scene = load(path, folders).map_err(|faults| faults.to_string())?.scene;
    let mut editor = Editor::new(scene.clone()).map_err(|error| error.to_string())?;
    let edit: &Edit = editor.solve().map_err(|error| error.to_string())?;
    let mut resampled = resample(&scene, edit).map_err(|error| error.to_string())?;
    let bodies = embody(&scene, edit, &mut resampled);
    let objects = object_motions(&scene, &bodies.moved);
    let report = report(&bodies, &Outcome::plain((scene.clone(), edit.clone())), &resampled);
    check(&Played { scene: &scene, bodies, objects, report })
}

fn ensure(holds: bool, otherwise: impl FnOnce() -> String) -> Result<(), Failed> {
    if holds { Ok(()) } else { Err(otherwise().into()) }
}

impl Played<'_> {
    fn who(&self, name: &str) -> CharacterId {
        let place = self.scene.characters.iter().position(|character| character.name == name);
        CharacterId::from_usize(place.expect("the scene has this character"))
    }

    fn object(&self, name: &str) -> ObjectId {
        let place = self.scene.objects.iter().position(|object| object.name == name);
        ObjectId::from_usize(place.expect("the scene has this object"))
    }

    fn time(&self, moment: &str) -> f64 {
        let told = self.report.moments.iter().find(|told| told.name == moment);
        told.expect("a constraint names this moment").time
    }

    fn joints(&self, who: CharacterId, time: f64) -> Vec<DVec3> {
        let pose = self.bodies.pose(who, self.bodies.frame(who, time));
        let frames = skeleton_of(self.scene, who).forward_kinematics(&pose);
        frames.into_iter().map(|frame| frame.position).collect()
    }

    fn role(&self, who: CharacterId, role: JointRole, time: f64) -> DVec3 {
        let joint = skeleton_of(self.scene, who).joint_of(role).expect("captured bodies have all roles");
        self.joints(who, time)[joint.as_usize()]
    }

    /// Points along all bones: their ends and middles.
    fn bones(&self, who: CharacterId, time: f64) -> Vec<DVec3> {
        let joints = self.joints(who, time);
        let all = skeleton_of(self.scene, who).joints.iter().enumerate();
        let middle = |(joint, parent): (usize, JointId)| joints[joint].midpoint(joints[parent.as_usize()]);
        let middles: Vec<DVec3> =
            all.filter_map(|(joint, known)| Some((joint, known.parent?))).map(middle).collect();
        joints.into_iter().chain(middles).collect()
    }

    /// Distance from a box to the nearest point of a hand: of its bones, from the wrist to all finger tips.
    fn hand_distance(
        &self,
        (who, hand): (CharacterId, JointRole),
        (object, size): (ObjectId, [f64; 3]),
        time: f64,
    ) -> f64 {
        let skeleton = skeleton_of(self.scene, who);
        let pose = self.bodies.pose(who, self.bodies.frame(who, time));
        let frames = skeleton.forward_kinematics(&pose);
        let wrist = skeleton.joint_of(hand).expect("captured bodies have all roles");
        let at = self.object_at(object, time);
        let bones = hand_bones(skeleton, &frames, wrist);
        let points = bones
            .iter()
            .flat_map(|[from, to]| (0..=STEPS).map(|k| from.lerp(*to, f64::from(k) / f64::from(STEPS))));
        points.map(|point| outside(size, at.local(point))).fold(f64::INFINITY, f64::min)
    }

    /// Angle of a hand, as far as it is one bone, from the line of its forearm, degrees.
    fn wrist_bend(&self, (who, hand): (CharacterId, JointRole), time: f64) -> f64 {
        let skeleton = skeleton_of(self.scene, who);
        let elbow = if hand == JointRole::LeftHand { JointRole::LeftElbow } else { JointRole::RightElbow };
        let [elbow, wrist] = [elbow, hand].map(|role| self.role(who, role, time));
        let joint = skeleton.joint_of(hand).expect("captured bodies have all roles");
        let next =
            skeleton.joints.iter().position(|one| one.parent == Some(joint)).expect("hands have bones");
        (wrist - elbow).angle_between(self.joints(who, time)[next] - wrist).to_degrees()
    }

    fn object_at(&self, object: ObjectId, time: f64) -> ObjectPose {
        self.objects[object.as_usize()].pose_at(self.scene, &self.bodies.moved, time)
    }

    /// Output frames while somebody is on stage, scene times.
    fn frames(&self, who: CharacterId) -> impl Iterator<Item = f64> {
        let frames = self.report.characters[who.as_usize()].frames_out;
        let (start, fps) = (self.report.start_time, self.report.fps);
        (0..frames).map(move |frame| start + frame as f64 / fps)
    }

    /// Output frames of a carry, and its first and last moment.
    fn carried(&self) -> Vec<f64> {
        let ends = ["sam/lift:grasp", "sam/lower:release"].map(|moment| self.time(moment));
        let between = self.frames(self.who("sam")).filter(|time| (ends[0]..=ends[1]).contains(time));
        between.chain(ends).collect()
    }
}

/// Points looked at along a bone of a hand.
const STEPS: u32 = 40;

/// Both ends of every bone of a hand in the world.
fn hand_bones(skeleton: &Skeleton, frames: &[JointFrame], wrist: JointId) -> Vec<[DVec3; 2]> {
    let mut own = vec![wrist];
    let mut bones = Vec::new();
    for (index, joint) in skeleton.joints.iter().enumerate() {
        let (id, frame) = (JointId::from_usize(index), frames[index]);
        if let Some(parent) = joint.parent.filter(|parent| own.contains(parent)) {
            own.push(id);
            bones.push([frames[parent.as_usize()].position, frame.position]);
        }
        if let Some(end) = joint.end_site.filter(|_| own.contains(&id)) {
            bones.push([frame.position, frame.position + frame.rotation * end]);
        }
    }
    bones
}

fn order(played: &Played<'_>) -> Result<(), Failed> {
    // Moments of one step are one moment; steps follow at these times, seconds.
    let steps: [(&[&str], f64); 7] = [
        (&["hal:past", "ivy:past"], 0.7),
        (&["ada:over"], 0.95),
        (&["dan:over", "cid:down"], 1.3),
        (&["ada:taps", "bea:tapped"], 2.3),
        (&["gus:taps", "cid:tapped"], 2.7),
        (&["cid:taps", "fay:tapped"], 3.2),
        (&["bea:under"], 3.7),
    ];
    for (moments, seconds) in steps {
        for moment in moments {
            let off = (played.time(moment) - seconds).abs();
            ensure(off < SAME_TIME, || format!("{moment} is {off:e} s off"))?;
        }
    }
    Ok(())
}

fn touches(played: &Played<'_>) -> Result<(), Failed> {
    let touches = [
        ("ada", "taps", "bea", "tapped", JointRole::RightShoulder),
        ("gus", "taps", "cid", "tapped", JointRole::RightShoulder),
        ("cid", "taps", "fay", "tapped", JointRole::LeftElbow),
    ];
    for (who, taps, whom, tapped, role) in touches {
        let (from, onto) = (played.who(who), played.who(whom));
        let fingers = skeleton_of(played.scene, from).joint_named("rfingers").ok_or("no fingers")?;
        let hand = played.joints(from, played.time(&format!("{who}:{taps}")))[fingers.as_usize()];
        let off = hand.distance(played.role(onto, role, played.time(&format!("{whom}:{tapped}"))));
        ensure(off < TOUCH, || format!("{who} misses {whom} by {off} m"))?;
    }
    // Nobody has to leave a place for that.
    let hard = played.report.constraints.iter().filter(|constraint| constraint.strength == "hard");
    let left =
        hard.filter(|constraint| constraint.unit == "m").find(|constraint| constraint.residual > TOUCH);
    ensure(left.is_none(), || format!("{left:?}"))
}

fn above(played: &Played<'_>) -> Result<(), Failed> {
    let [over, under] = [("dan", "dan:over"), ("cid", "cid:down")]
        .map(|(name, moment)| played.bones(played.who(name), played.time(moment)));
    let lowest = over.iter().map(|point| point.y).fold(f64::INFINITY, f64::min);
    let middle = over[0]; // the root
    let near = under.iter().filter(|point| (point.with_y(0.0) - middle.with_y(0.0)).length() < 0.4);
    let heights: Vec<f64> = near.map(|point| point.y).collect();
    let highest = heights.iter().copied().fold(0.0, f64::max);
    ensure(heights.len() > 5 && highest + 2.0 * FLESH < lowest, || {
        format!("{} points of cid up to {highest} m below dan at {lowest} m", heights.len())
    })
}

fn obstacles(played: &Played<'_>) -> Result<(), Failed> {
    for (object, thing) in played.scene.objects.iter().enumerate() {
        let id = ObjectId::from_usize(object);
        for index in 0..played.scene.characters.len() {
            let who = CharacterId::from_usize(index);
            for time in played.frames(who) {
                let pose = played.object_at(id, time);
                let nearest = |point: &DVec3| outside(thing.size, pose.local(*point));
                let bones = played.bones(who, time);
                let off = bones.iter().map(nearest).fold(f64::INFINITY, f64::min);
                let name = &played.scene.characters[index].name;
                ensure(off > FLESH, || format!("{name} is {off} m from {} at {time} s", thing.name))?;
            }
        }
    }
    for (who, object) in [("ada", "hurdle"), ("cid", "bench"), ("bea", "bar")] {
        let (who_id, id) = (played.who(who), played.object(object));
        let half = 0.5 * played.scene.objects[id.as_usize()].size[2];
        let ways: Vec<DVec3> = played
            .frames(who_id)
            .map(|time| played.object_at(id, time).local(played.role(who_id, JointRole::Pelvis, time)))
            .collect();
        let crossed = ways.windows(2).filter(|pair| pair[0].x < 0.0 && pair[1].x >= 0.0);
        let within: Vec<bool> = crossed.map(|pair| pair[1].z.abs() < half).collect();
        ensure(within == [true], || format!("{who} passes {object} {within:?}"))?;
    }
    Ok(())
}

/// Distance of a point, in a box's axes, from it.
fn outside([ahead, up, across]: [f64; 3], point: DVec3) -> f64 {
    let corner = DVec3::new(0.5 * ahead, up, 0.5 * across);
    point.distance(point.clamp(DVec3::new(-corner.x, 0.0, -corner.z), corner))
}

fn apart(played: &Played<'_>) -> Result<(), Failed> {
    let touching = [("ada", "bea"), ("cid", "gus"), ("cid", "fay")];
    let names: Vec<&str> = played.scene.characters.iter().map(|one| one.name.as_str()).collect();
    for (first, one) in names.iter().enumerate() {
        for other in &names[first + 1..] {
            if touching.contains(&(one, other)) {
                continue;
            }
            let ids = [one, other].map(|name| played.who(name));
            for time in played.frames(ids[0]) {
                let [own, others] = ids.map(|who| played.bones(who, time));
                let least =
                    |point: &DVec3| others.iter().map(|o| o.distance(*point)).fold(f64::INFINITY, f64::min);
                let off = own.iter().map(least).fold(f64::INFINITY, f64::min);
                ensure(off > AIR, || format!("{one} and {other} are {off} m apart at {time} s"))?;
            }
        }
    }
    Ok(())
}

fn sound(played: &Played<'_>) -> Result<(), Failed> {
    for (told, body) in played.report.characters.iter().zip(&played.bodies.bodies) {
        let (name, RestEdited { rest, edited }) = (&told.name, told.foot_slide);
        ensure(edited <= rest + SPEED_ROUNDING, || {
            format!("{name}'s feet slide {edited} m/s, captured {rest} m/s")
        })?;
        ensure(body.report.root_drop < LUNGE, || {
            format!("{name} comes down by {} m", body.report.root_drop)
        })?;
        ensure(body.report.shortfalls.is_empty(), || format!("{name}: {:?}", body.report.shortfalls))?;
    }
    let short = played.report.constraints.iter().find(|constraint| constraint.shortfall.is_some());
    ensure(short.is_none(), || format!("{short:?}"))
}

fn hands(played: &Played<'_>) -> Result<(), Failed> {
    let beam = played.object("beam");
    let size = played.scene.objects[beam.as_usize()].size;
    let times = played.carried();
    for name in ["sam", "nia"] {
        for hand in [JointRole::LeftHand, JointRole::RightHand] {
            let who = played.who(name);
            let on_beam = |time: f64| played.object_at(beam, time).local(played.role(who, hand, time));
            let held = on_beam(played.time("sam/lift:grasp"));
            for time in &times {
                let slip = on_beam(*time).distance(held);
                ensure(slip < TOUCH, || format!("{name}'s wrist slips by {slip} m at {time} s"))?;
                let off = played.hand_distance((who, hand), (beam, size), *time);
                ensure(off < TOUCHING, || format!("{name}'s hand is {off} m from the beam at {time} s"))?;
                let bend = played.wrist_bend((who, hand), *time);
                ensure(bend < WRIST, || format!("{name}'s wrist is bent by {bend} degrees at {time} s"))?;
            }
            let skeleton = skeleton_of(played.scene, who);
            let wrist = skeleton.joint_of(hand).ok_or("no hand")?;
            let tips = |time: f64| {
                let pose = played.bodies.pose(who, played.bodies.frame(who, time));
                let tips = hand_points(skeleton, &pose, wrist);
                tips.into_iter().map(|tip| played.object_at(beam, time).local(tip)).collect::<Vec<_>>()
            };
            let turn = |time: f64| {
                played.bodies.pose(who, played.bodies.frame(who, time)).rotations[wrist.as_usize()]
            };
            let all: Vec<f64> = played.frames(who).collect();
            let steps = all.windows(2).map(|pair| turn(pair[0]).angle_between(turn(pair[1])).to_degrees());
            let fastest = steps.fold(0.0, f64::max);
            ensure(fastest < EASED, || format!("{name}'s wrist turns by {fastest} degrees in a frame"))?;
            let held = tips(played.time("sam/lift:grasp"));
            ensure(held.len() > 4, || "wrists with fingers".to_owned())?;
            for time in &times {
                let slips = tips(*time).into_iter().zip(&held).map(|(tip, held)| tip.distance(*held));
                let slip = slips.fold(0.0, f64::max);
                ensure(slip < TOUCH, || format!("{name}'s hand slips by {slip} m at {time} s"))?;
            }
        }
    }
    Ok(())
}

fn beam(played: &Played<'_>) -> Result<(), Failed> {
    let beam = played.object("beam");
    let spans = &played.objects[beam.as_usize()].spans;
    let owners: Vec<bool> = spans.iter().map(|span| matches!(span.owner, Owner::Carried(_))).collect();
    ensure(owners == [false, true, false], || format!("carried once: {owners:?}"))?;
    for span in &spans[1..] {
        let [before, after] =
            [span.from.next_down(), span.from.next_up()].map(|time| played.object_at(beam, time));
        let jump = before.position.distance(after.position).max(wrap(before.facing - after.facing).abs());
        ensure(jump < CONTINUOUS, || format!("it jumps by {jump:e} at {} s", span.from))?;
    }
    let lies = played.object_at(beam, f64::MAX);
    for block in ["far block, left", "far block, right"] {
        let id = played.object(block);
        let [_, top, _] = played.scene.objects[id.as_usize()].size;
        let at = played.object_at(id, 0.0);
        let above = lies.local(at.apply(DVec3::new(0.0, top, 0.0)));
        // Blocks stand where millimetres say.
        let is_on = above.x.abs() < 0.005 && above.y.abs() < TOUCH && (above.z.abs() - 0.93).abs() < 0.005;
        ensure(is_on, || format!("{block} is at {above} of the beam"))?;
    }
    Ok(())
}

/// How far carriers may sway from the places at which they grasped, metres: what bodies do in a stride.
const SWAY: f64 = 0.12;

fn opposite(played: &Played<'_>) -> Result<(), Failed> {
    let beam = played.object("beam");
    for (name, side) in [("sam", -0.55), ("nia", 0.55)] {
        for time in played.carried() {
            let root = played.role(played.who(name), JointRole::Pelvis, time);
            let place = played.object_at(beam, time).local(root);
            let is_there = (place.z - side).abs() < SWAY && place.x < -FLESH;
            ensure(is_there, || format!("{name} is at {place} of the beam at {time} s"))?;
        }
    }
    Ok(())
}

fn together(played: &Played<'_>) -> Result<(), Failed> {
    for moment in ["lift:grasp", "lower:release"] {
        let [sam, nia] = ["sam", "nia"].map(|name| played.time(&format!("{name}/{moment}")));
        ensure((sam - nia).abs() < SAME_TIME, || format!("{moment}: {sam} s and {nia} s"))?;
    }
    Ok(())
}
