//! What the scenes that carry things tell is what happens: hands stay on what they carry, things never jump and are never
//! without a place, who belongs together is together in space and time, and nobody is inside of a thing or of somebody.

mod performed;

use std::f64::consts::PI;
use std::path::Path;
use std::sync::LazyLock;

use cotillion::clip::facing::facing;
use cotillion::discrete::editor::LogEntry;
use cotillion::discrete::outcome::Outcome;
use cotillion::edit::{Edit, Moved};
use cotillion::embody::{Embodied, embody};
use cotillion::geometry::{plan_of, wrap};
use cotillion::index::CharacterId;
use cotillion::object_motion::{
    AtRest, ObjectMotion, Owner, Performance, Span, moment_time, object_motions, skeleton_of,
};
use cotillion::reach::constrained_times;
use cotillion::resample::resample;
use cotillion::scene::{ClipFolders, Scene, load};
use cotillion::skeleton::JointFrame;
use cotillion::ties::Ties;
use glam::DVec3;

/// What the project promises of hand-overs, metres and seconds.
const EXACT: f64 = 1e-9;
/// What touches is no farther apart, metres, and no farther turned, radians.
const TOUCH: f64 = 1e-3;
/// From the wrist to what the palm touches, metres.
const PALM: f64 = 0.1;

/// A scene of ours, edited and dragged.
struct Plot {
    scene: Scene,
    edit: Edit,
    log: Vec<LogEntry>,
    original: Scene,
}

static CHAIR: LazyLock<Plot> = LazyLock::new(|| Plot::of("chair.toml"));
static RELAY: LazyLock<Plot> = LazyLock::new(|| Plot::of("relay.toml"));

impl Plot {
    fn of(name: &str) -> Self {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(name);
        let loaded = load(&path, &ClipFolders::default()).expect("a sound scene");
        let Outcome { scene, edit, log, original, .. } =
            performed::performed(loaded.scene).expect("the constraints agree");
        Self { scene, edit, log, original }
    }

    fn moved(&self) -> Moved<'_> {
        Moved { scene: &self.scene, characters: &self.edit.characters }
    }

    fn embodied(&self) -> Embodied<'_> {
        let mut resampled = resample(&self.scene, &self.edit).expect("a result of usual length");
        embody(&self.scene, &self.edit, &mut resampled)
    }

    /// Scene time of a moment that the scene names, seconds.
    fn time(&self, name: &str) -> f64 {
        let moment = self.scene.moments().find(|moment| moment.name == name);
        moment_time(&self.scene, &self.moved(), moment.expect("the scene names this moment"))
    }

    fn who(&self, name: &str) -> CharacterId {
        let place = self.scene.characters.iter().position(|character| character.name == name);
        CharacterId::from_usize(place.expect("the scene has this character"))
    }

    fn everybody(&self) -> impl Iterator<Item = CharacterId> {
        (0..self.scene.characters.len()).map(CharacterId::from_usize)
    }

    fn object(&self, name: &str) -> ObjectMotion {
        let place = self.scene.objects.iter().position(|object| object.name == name);
        object_motions(&self.scene, &self.moved()).swap_remove(place.expect("the scene has this object"))
    }

    fn joints(&self, performance: &impl Performance, who: CharacterId, time: f64) -> Vec<JointFrame> {
        let pose = performance.pose(who, performance.frame(who, time));
        skeleton_of(&self.scene, who).forward_kinematics(&pose)
    }

    /// Ticks of the clock from one time to another, both included.
    fn ticks(&self, from: f64, to: f64) -> Vec<f64> {
        let fps = self.scene.fps;
        let first = (from * fps).ceil();
        let between = (0..).map(|k| (first + f64::from(k)) / fps).take_while(|time| *time < to);
        [from].into_iter().chain(between).chain([to]).collect()
    }

    /// Ticks of the whole scene.
    fn clock(&self) -> Vec<f64> {
        let ends = self.edit.characters.iter().map(|one| one.times[one.times.len() - 1]);
        self.ticks(0.0, ends.fold(0.0, f64::max))
    }
}

/// Spans of an object's motion in which somebody carries it.
fn carried(motion: &ObjectMotion) -> impl Iterator<Item = &Span> {
    motion.spans.iter().filter(|span| matches!(span.owner, Owner::Carried(_)))
}

/// Follows what happens to a thing: it always is somewhere, never jumps, and hands stay on it. Returns how many hold it in
/// each carry.
fn follow_through(plot: &Plot, name: &str) -> Vec<usize> {
    let (moved, embodied, motion) = (plot.moved(), plot.embodied(), plot.object(name));
    assert!(motion.spans.windows(2).all(|pair| pair[0].to == pair[1].from), "no gap, no overlap");
    for span in &motion.spans[1..] {
        let [before, after] = [span.from.next_down(), span.from.next_up()]
            .map(|time| motion.pose_at(&plot.scene, &moved, time));
        assert!(before.position.distance(after.position) < EXACT, "{name} jumps at {}", span.from);
        assert!(wrap(before.facing - after.facing).abs() < EXACT, "{name} turns at {}", span.from);
    }
    let holders = carried(&motion).map(|span| {
        let Owner::Carried(hold) = &span.owner else { panic!("carried") };
        let on_it = |time: f64| {
            let pose = motion.pose_at(&plot.scene, &moved, time);
            let hands = hold.grips.iter().map(|grip| {
                pose.local(plot.joints(&embodied, grip.character, time)[grip.joint.as_usize()].position)
            });
            hands.collect::<Vec<DVec3>>()
        };
        let [ahead, up, across] = plot.scene.objects[motion.object.as_usize()].size;
        let half = DVec3::new(ahead / 2.0, up, across / 2.0);
        let first = on_it(span.from);
        for hand in &first {
            let away = hand.distance(hand.clamp(DVec3::new(-half.x, 0.0, -half.z), half));
            assert!(away < PALM + TOUCH, "a hand {away} m from {name}");
        }
        let mut times = plot.ticks(span.from, span.to);
        let ties = Ties::of(&plot.scene);
        let moments = hold
            .grips
            .iter()
            .flat_map(|grip| constrained_times((&plot.scene, &ties), &moved, grip.character));
        times.extend(moments.filter(|time| (span.from..=span.to).contains(time)));
        for time in times {
            for (hand, at_first) in on_it(time).iter().zip(&first) {
                let slipped = hand.distance(*at_first);
                assert!(slipped < TOUCH, "a hand slips {slipped} m on {name} at {time}");
            }
        }
        hold.grips.len()
    });
    holders.collect()
}

/// Nobody's joint is inside of a thing, nobody is where somebody else is, and nobody spins.
fn keep_apart(plot: &Plot) {
    /// A joint this deep in a box is in it: wrists on its sides are at its surface, metres.
    const INSIDE: f64 = 0.02;
    /// Pelvis from pelvis, seen from above: two bodies side by side, metres.
    const BODY: f64 = 0.4;
    /// Faster than anybody turns on the spot, radians a second.
    const SPIN: f64 = 2.5;
    let (moved, embodied) = (plot.moved(), plot.embodied());
    let motions = object_motions(&plot.scene, &moved);
    let mut before: Vec<f64> = Vec::new();
    for time in plot.clock() {
        let bodies: Vec<_> = plot.everybody().map(|who| plot.joints(&embodied, who, time)).collect();
        for (who, body) in bodies.iter().enumerate() {
            let name = &plot.scene.characters[who].name;
            for (motion, object) in motions.iter().zip(&plot.scene.objects) {
                let pose = motion.pose_at(&plot.scene, &moved, time);
                let half = DVec3::new(object.size[0], object.size[1], object.size[2]) / 2.0;
                let deepest = body.iter().map(|joint| {
                    let inside = half - (pose.local(joint.position) - DVec3::Y * half.y).abs();
                    inside.min_element()
                });
                let deepest = deepest.fold(f64::NEG_INFINITY, f64::max);
                assert!(deepest < INSIDE, "{name} is {deepest} m in {} at {time}", object.name);
            }
            for (other, character) in bodies[..who].iter().zip(&plot.scene.characters) {
                let apart = (plan_of(body[0].position) - plan_of(other[0].position)).norm();
                assert!(apart > BODY, "{name} is {apart} m from {} at {time}", character.name);
            }
        }
        let headings: Vec<f64> = plot
            .everybody()
            .zip(&bodies)
            .map(|(who, body)| facing(skeleton_of(&plot.scene, who), body).expect("everybody is upright"))
            .collect();
        for (now, then) in headings.iter().zip(&before) {
            let rate = wrap(now - then).abs() * plot.scene.fps;
            assert!(rate < SPIN, "{rate} rad/s at {time}");
        }
        before = headings;
    }
}

/// Places of lea and rob in the axes of the chair that they carry, plan: ahead + i·left, metres.
fn beside_the_chair(plot: &Plot, performance: &impl Performance, time: f64) -> [DVec3; 2] {
    let index = plot.object("chair").object.as_usize();
    let motion = object_motions(&plot.scene, performance).swap_remove(index);
    let pose = motion.pose_at(&plot.scene, performance, time);
    ["lea", "rob"].map(|name| pose.local(plot.joints(performance, plot.who(name), time)[0].position))
}

#[test]
fn two_carry_a_chair_with_all_hands_and_it_stands_where_they_put_it() {
    let plot = &*CHAIR;
    assert_eq!(follow_through(plot, "chair"), [4], "both hands of both");
    keep_apart(plot);
    // The mat says where the carriers stand; they stand symmetrically, so the chair comes to stand in the middle.
    let [chair, mat] =
        ["chair", "mat"].map(|name| plot.object(name).pose_at(&plot.scene, &plot.moved(), 1e3));
    assert!(chair.position.distance(mat.position) < TOUCH, "{} or {}", chair.position, mat.position);
    assert!(wrap(chair.facing - mat.facing).abs() < TOUCH, "{} or {}", chair.facing, mat.facing);
}

#[test]
fn carriers_of_a_chair_stay_opposite() {
    /// What the project promises of their distance along the chair's axis, metres.
    const OPPOSITE: f64 = 0.02;
    /// How far one may be ahead of the other while the chair turns, metres: a fifth of the chair's depth.
    const ABREAST: f64 = 0.08;
    let plot = &*CHAIR;
    let [grasp, release] = ["lea/pick_up:grasp", "lea/put_down:release"].map(|name| plot.time(name));
    let lea = plot.who("lea");
    for time in plot.ticks(grasp, release) {
        let [left, right] = beside_the_chair(plot, &plot.moved(), time);
        let rest = AtRest(&plot.scene);
        let [left_before, right_before] =
            beside_the_chair(plot, &rest, rest.time(lea, plot.moved().frame(lea, time)));
        let changed = (left - right).z.abs() - (left_before - right_before).z.abs();
        assert!(changed.abs() < OPPOSITE, "{changed} m at {time}");
        assert!((left.z + right.z).abs() < OPPOSITE, "the chair is between them: {left}, {right}");
        assert!((left.x - right.x).abs() < ABREAST, "{left}, {right}");
    }
}

#[test]
fn the_sitter_meets_the_seat_after_both_have_let_go() {
    /// Pelvis over the seat, metres.
    const OVER: f64 = 0.13;
    /// Of the front edge of the seat, which is under the thighs, metres.
    const EDGE: f64 = 0.05;
    let plot = &*CHAIR;
    let order = ["lea:start", "lea/pick_up:grasp", "lea/put_down:release", "sam/sit_down:seated"];
    let times = order.map(|name| plot.time(name));
    assert!(times.windows(2).all(|pair| pair[0] < pair[1]), "{times:?}");
    for (lea, rob) in
        [("lea/pick_up:grasp", "rob/pick_up:grasp"), ("lea/put_down:release", "rob/put_down:release")]
    {
        assert!((plot.time(lea) - plot.time(rob)).abs() < EXACT, "{lea} and {rob}");
    }
    let (moved, embodied, chair) = (plot.moved(), plot.embodied(), plot.object("chair"));
    let size = plot.scene.objects[chair.object.as_usize()].size;
    for time in [times[3], times[3] + 0.5, times[3] + 1.0] {
        let pelvis = plot.joints(&embodied, plot.who("sam"), time)[0].position;
        let on_seat = chair.pose_at(&plot.scene, &moved, time).local(pelvis);
        assert!((on_seat.y - size[1] - OVER).abs() < TOUCH, "{on_seat}");
        let front = size[0] / 2.0 - on_seat.x;
        assert!((EDGE..size[0]).contains(&front) && on_seat.z.abs() < EDGE, "off the seat: {on_seat}");
    }
}

const CARRIERS: [&str; 6] = ["ann", "bob", "cleo", "dan", "eve", "finn"];

#[test]
fn a_box_goes_from_hand_to_hand_through_six_pairs() {
    let plot = &*RELAY;
    assert_eq!(follow_through(plot, "box"), [2; 6]);
    keep_apart(plot);
    let motion = plot.object("box");
    let owners: Vec<_> = carried(&motion).collect();
    assert_eq!(motion.spans.len(), 8, "it stands, six have it one after another, it stands");
    for (pair, names) in owners.windows(2).zip(CARRIERS.windows(2)) {
        let given = plot.time(&format!("{}/hand_over:release", names[0]));
        let taken = plot.time(&format!("{}/take_over:grasp", names[1]));
        assert!((given - taken).abs() < EXACT, "{names:?}");
        assert_eq!(pair[0].to, pair[1].from);
        assert!(
            (pair[0].to - given).abs() < EXACT,
            "{names:?}: times of moments that are held differ by rounding"
        );
    }
    let put = motion.pose_at(&plot.scene, &plot.moved(), 1e3);
    assert!(put.position.y.abs() < TOUCH, "on the floor: {}", put.position.y);
    assert!((plot.time("finn/put_down:release") - 52.0).abs() < EXACT, "where its drag ends");
}

#[test]
fn giver_and_taker_face_each_other_with_their_hands_apart_on_the_box() {
    /// Half a hand's breadth: their hands do not cover each other, metres.
    const HAND: f64 = 0.05;
    let plot = &*RELAY;
    let embodied = plot.embodied();
    for names in CARRIERS.windows(2) {
        let time = plot.time(&format!("{}/take_over:grasp", names[1]));
        let [giver, taker] = [names[0], names[1]].map(|name| {
            let who = plot.who(name);
            let joints = plot.joints(&embodied, who, time);
            let heading = facing(skeleton_of(&plot.scene, who), &joints).expect("upright");
            let hands = carried(&plot.object("box")).find_map(|span| match &span.owner {
                Owner::Carried(hold) if hold.grips[0].character == who => {
                    Some(hold.grips.iter().map(|grip| joints[grip.joint.as_usize()].position).collect())
                }
                _ => None,
            });
            let hands: Vec<DVec3> = hands.expect("they have it once");
            (heading, hands)
        });
        assert!(wrap(giver.0 - taker.0 - PI).abs() < TOUCH, "{names:?}");
        for hand in &giver.1 {
            let nearest = taker.1.iter().map(|other| hand.distance(*other)).fold(f64::INFINITY, f64::min);
            assert!(nearest > HAND, "{names:?}: {nearest}");
        }
    }
}

#[test]
fn who_gets_in_the_way_does_so_as_the_carrier_comes_by() {
    let plot = &*RELAY;
    let meetings = [
        ("gus/aside_left:60", "bob/carry:50"),
        ("ida/jump_over:takeoff", "cleo/carry:50"),
        ("hal/aside_right:60", "dan/carry:50"),
        ("joe/jump_over:takeoff", "eve/carry:50"),
    ];
    for (other, carrier) in meetings {
        let time = plot.time(other);
        assert!((time - plot.time(carrier)).abs() < EXACT, "{other} as {carrier}");
        let pelvis = [other, carrier].map(|moment| {
            let name = moment.split('/').next().expect("a name comes first");
            plan_of(plot.joints(&plot.moved(), plot.who(name), time)[0].position)
        });
        let apart = (pelvis[0] - pelvis[1]).norm();
        assert!((0.5..1.5).contains(&apart), "{other}: {apart} m");
    }
}

/// Working frames that came, less those that went, on a character's track.
fn came(plot: &Plot, name: &str) -> i64 {
    let who = plot.who(name);
    let logged: i64 = plot.log.iter().filter(|entry| entry.character == who).map(|entry| entry.frames).sum();
    let count = |scene: &Scene| scene.characters[who.as_usize()].track.frame_count();
    let told = count(&plot.original).checked_add_signed(isize::try_from(logged).expect("a few frames"));
    assert_eq!(told, Some(count(&plot.scene)), "{name}: the log tells all");
    logged
}

/// As in the paper, whose carriers had half as many frames more, and the sitter a sixth.
#[test]
fn who_carry_the_chair_farther_sidestep_more_and_the_sitter_waits_longer() {
    assert!(came(&CHAIR, "lea") >= 66 && came(&CHAIR, "rob") >= 66, "three sidesteps and more");
    assert!(came(&CHAIR, "sam") >= 90, "three seconds and more");
}

#[test]
fn carriers_take_more_steps_where_the_relay_is_dragged_away() {
    assert!(came(&RELAY, "cleo") > 0 && came(&RELAY, "finn") > 0);
    for name in ["ann", "gus", "ida", "hal", "joe"] {
        assert_eq!(came(&RELAY, name), 0, "{name} is not dragged");
    }
}

#[test]
fn who_walk_off_farther_after_a_high_five_take_more_steps() {
    /// Slaps, seconds.
    const EXACT_TIME: f64 = 1e-9;
    let plot = Plot::of("high_five.toml");
    assert!(came(&plot, "ann") > 0 && came(&plot, "cleo") > came(&plot, "ann"));
    let [ann, bob, cleo, dan] =
        ["ann", "bob", "cleo", "dan"].map(|name| plot.time(&format!("{name}/slap:hit")));
    assert!((ann - 7.0).abs() < EXACT_TIME && (ann - bob).abs() < EXACT_TIME);
    assert!((cleo - ann - 1.0).abs() < EXACT_TIME && (cleo - dan).abs() < EXACT_TIME);
}
