//! Things in random scenes: some stand, some drive by, some are carried and handed on; people are held relative to them.

use cotillion::constraint::{Constraint, ConstraintKind, Instant, Partner, Relation, When};
use cotillion::geometry::c64;
use cotillion::index::{CharacterId, ObjectId};
use cotillion::object::{Carry, Course, Object, ObjectKey, ObjectPose};
use cotillion::scene::Scene;

use crate::Random;
use crate::paths::{hard, moment};

/// Frames from which and to which each in turn has what is handed on.
const HELD: [(f64, f64); 3] = [(6.0, 24.0), (30.0, 44.0), (49.0, 60.0)];

/// Adds one to three things to `scene`.
pub(crate) fn add_things(random: &mut Random, scene: &mut Scene) {
    let count = scene.characters.len();
    for _ in 0..1 + random.below(3) {
        let object = ObjectId::from_usize(scene.objects.len());
        let start = c64::new(random.between(0.0, 3.0), random.between(-1.0, 1.0));
        let still = ObjectPose::on_ground(start, random.between(-3.0, 3.0));
        let kind = random.below(4);
        let course = match kind {
            0 => keys(random, still),
            _ => Course::Still(still),
        };
        let name = format!("thing {}", scene.objects.len());
        scene.objects.push(Object { name, size: [0.3, 0.3, 0.3], course });
        if kind > 1 {
            carries(random, (scene, count), object);
        }
        for _ in 0..1 + random.below(2) {
            let who = random.below(count);
            let relative = beside(random, who, object);
            scene.constraints.push(relative);
        }
    }
}

/// From there to somewhere near, in some seconds.
fn keys(random: &mut Random, from: ObjectPose) -> Course {
    let to = from.plan() + c64::new(random.between(-1.0, 1.0), random.between(-1.0, 1.0));
    let to = ObjectPose::on_ground(to, from.facing + random.between(-1.0, 1.0));
    let seconds = random.between(0.5, 2.5);
    Course::Keys(vec![ObjectKey { seconds: 0.3, pose: from }, ObjectKey { seconds: 0.3 + seconds, pose: to }])
}

/// One after the other has it, or two at once; hand-overs happen at one moment at times.
fn carries(random: &mut Random, (scene, count): (&mut Scene, usize), object: ObjectId) {
    let mut who = random.below(count);
    for (turn, (from, to)) in HELD.into_iter().take(1 + random.below(3)).enumerate() {
        let other = (who + 1) % count;
        let id = CharacterId::from_usize;
        let both = other != who && random.chance(0.2);
        let by = if both { vec![id(who), id(other)] } else { vec![id(who)] };
        let ends = [from, to].map(|working| moment(who, Instant::Frame { entry: 0, working }));
        let [first, last] = ends;
        if turn > 0 && random.chance(0.5) {
            let before = scene.carries[scene.carries.len() - 1].during.1.clone();
            let moments = vec![When::At(first.clone()), When::At(before)];
            let kind = ConstraintKind::Sync { moments, offset: 0.0 };
            scene.constraints.push(Constraint { strength: random.strength(), ..hard("handed over", kind) });
        }
        let name = format!("carry {}", scene.carries.len());
        scene.carries.push(Carry { name, line: 0, object, by, during: (first, last) });
        who = other;
    }
}

/// Somebody beside a thing: before it is carried, at the grasps, on the way, or after all.
fn beside(random: &mut Random, who: usize, object: ObjectId) -> Constraint {
    let frames = [0.0, 6.0, 15.0, 24.0, 30.0, 37.0, 44.0, 49.0, 55.0, 60.0, 64.0];
    let working = frames[random.below(frames.len())];
    let jitter = c64::new(random.between(-0.3, 0.3), random.between(-0.3, 0.3));
    let offset = match random.below(3) {
        0 => Relation::AsBefore,
        1 => Relation::Given(c64::new(-0.6, 0.0) + jitter),
        _ => Relation::Given(c64::new(0.0, 0.8) + jitter),
    };
    let facing = match random.below(3) {
        0 => Relation::AsBefore,
        1 => Relation::Given(random.between(-0.6, 0.6)),
        _ => Relation::Free,
    };
    let when = When::At(moment(who, Instant::Frame { entry: 0, working }));
    let kind = ConstraintKind::Relative { when, partner: Partner::Object(object), offset, facing };
    Constraint { strength: random.strength(), ..hard("beside a thing", kind) }
}
