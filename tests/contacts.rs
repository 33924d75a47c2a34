//! Contacts that a scene states hold in its result.

use std::path::Path;

use cotillion::clip::contacts::ContactPoint;
use cotillion::edit::Editor;
use cotillion::embody::embody;
use cotillion::full_body::PlantedPoint;
use cotillion::resample::resample;
use cotillion::scene::{ClipFolders, load_text};

/// What the project promises of planted points, metres.
const DRIFT: f64 = 1e-3;

/// A walk is pulled aside.
const ASIDE: &str = r#"
[[pin]]
at = "ann:start"
position = [0.0, 0.0]
facing = 0.0
strength = "hard"
[[pin]]
at = "ann:end"
position = [2.2, 1.6]
facing = 80.0
strength = "hard"
"#;

/// `clip`: its table, `pins`: what holds it, `mode`: how feet and hands stand.
fn planted(clip: &str, pins: &str, mode: &str) -> Vec<PlantedPoint> {
    let text = format!(
        r#"
[clips]
clip = {{ {clip} }}
[[character]]
name = "ann"
track = ["clip"]
{pins}
[full_body]
plants = "{mode}"
"#
    );
    let loaded =
        load_text(&text, Path::new("contacts.toml"), &ClipFolders::default()).expect("a sound scene");
    let mut editor = Editor::new(loaded.scene).expect("a regular scene");
    editor.solve().expect("the constraints agree");
    let mut result = resample(editor.scene(), editor.edit()).expect("a short result");
    let embodied = embody(editor.scene(), editor.edit(), &mut result);
    let plants = embodied.bodies[0].report.plants.clone();
    let stated: Vec<(usize, usize)> =
        result.clips[0].contacts.iter().map(|own| (own.from.as_usize(), own.to.as_usize())).collect();
    let hands: Vec<(usize, usize)> =
        of(ContactPoint::LeftHand, &plants).iter().map(|hand| (hand.first, hand.last)).collect();
    assert_eq!(stated, hands, "the result says what its hands do");
    plants
}

fn of(point: ContactPoint, plants: &[PlantedPoint]) -> Vec<&PlantedPoint> {
    plants.iter().filter(|plant| plant.point == point).collect()
}

const WALK: &str = r#"builtin = "walk", seconds = 3"#;
const HAND: &str =
    r#"builtin = "walk", seconds = 3, contacts = [{ joint = "left_hand", from = 40, to = 44 }]"#;

const TOE: &str = r#"builtin = "walk", seconds = 3, contacts = [{ joint = "left_toe", from = 30, to = 33 }]"#;

#[test]
fn a_hand_bears_as_stated_with_the_drift_of_its_clip() {
    let plants = planted(HAND, ASIDE, "as-captured");
    let hands = of(ContactPoint::LeftHand, &plants);
    assert_eq!(hands.len(), 1, "{plants:?}");
    assert!(hands[0].captured_drift > 10.0 * DRIFT, "a hand swings");
    assert!((hands[0].drift - hands[0].captured_drift).abs() < DRIFT, "{hands:?}");
    assert!(of(ContactPoint::RightHand, &plants).is_empty());
    assert!(of(ContactPoint::LeftHand, &planted(WALK, ASIDE, "as-captured")).is_empty());
}

#[test]
fn a_pinned_hand_stands_still() {
    let idle = r#"builtin = "idle", seconds = 3, contacts = [{ joint = "left_hand", from = 20, to = 60 }]"#;
    let captured = planted(idle, "", "as-captured");
    assert!(of(ContactPoint::LeftHand, &captured)[0].drift > DRIFT, "it sways with the body: {captured:?}");
    let pinned = planted(idle, "", "pinned");
    let hands = of(ContactPoint::LeftHand, &pinned);
    assert!(!hands.is_empty() && hands.iter().all(|hand| hand.drift < DRIFT), "{pinned:?}");
}

#[test]
fn what_is_stated_of_a_foot_replaces_what_is_found() {
    let found = planted(WALK, ASIDE, "as-captured");
    let stated = planted(TOE, ASIDE, "as-captured");
    assert!(of(ContactPoint::LeftToe, &found).len() > 1);
    assert_eq!(of(ContactPoint::LeftToe, &stated).len(), 1);
    let others = |plants: &[PlantedPoint]| -> Vec<(usize, usize)> {
        of(ContactPoint::RightToe, plants).iter().map(|plant| (plant.first, plant.last)).collect()
    };
    assert_eq!(others(&found), others(&stated));
}
