//! What a report tells of feet, and of bodies that hands pull off their paths.

use std::path::Path;

use cotillion::discrete::outcome::Outcome;
use cotillion::edit::Editor;
use cotillion::embody::embody;
use cotillion::export::body_report::{DriftReport, FullBodyReport};
use cotillion::export::report::{Report, RestEdited, report};
use cotillion::resample::resample;
use cotillion::scene::{ClipFolders, load_text};

/// Rounding of a mean speed, m/s.
const ROUNDING: f64 = 1e-9;

/// Ann walks, 2.04 m before the edit, 1.3 times as far after it.
const STRETCHED: &str = "
fps = 50
[clips]
walk = { builtin = \"walk\", start = 1, stop = 1, seconds = 4 }
[[character]]
name = \"ann\"
track = [\"walk\"]
facing = 0.0
[[pin]]
at = \"ann:start\"
position = [0.0, 0.0]
strength = \"hard\"
[[pin]]
at = \"ann:end\"
position = [2.65, 0.0]
strength = \"hard\"
";
const OFF: &str = "[full_body]\nenabled = false\n";

fn told(text: &str) -> Report {
    let loaded = load_text(text, Path::new("report.toml"), &ClipFolders::default()).expect("a sound scene");
    let mut editor = Editor::new(loaded.scene).expect("a regular scene");
    let edit = editor.solve().expect("the constraints agree").clone();
    let mut resampled = resample(editor.scene(), &edit).expect("a result of usual length");
    let embodied = embody(editor.scene(), &edit, &mut resampled);
    report(&embodied, &Outcome::plain((editor.scene().clone(), edit.clone())), &resampled)
}

fn body(text: &str) -> FullBodyReport {
    told(text).characters[0].full_body.clone().expect("the full body is on")
}

fn slide(text: &str) -> RestEdited {
    told(text).characters[0].foot_slide
}

#[test]
fn feet_slide_in_an_unedited_scene_as_before_it() {
    let unedited = STRETCHED.split("[[pin]]").next().expect("a scene without its pins");
    for text in [unedited.to_owned(), format!("{unedited}{OFF}")] {
        let found = slide(&text);
        assert!((found.edited - found.rest).abs() < ROUNDING, "{found:?}");
    }
}

/// The clock shows other instants of the clips then, no other motion.
#[test]
fn feet_slide_as_before_the_edit_whenever_somebody_sets_off() {
    for seconds in [0.0, 0.01, 1.0 / 60.0, 0.02, 1.0 / 30.0, 0.05] {
        let text = format!(
            "fps = 30\n[clips]\naside = {{ builtin = \"side_step\", seconds = 5 }}\n[[character]]\nname = \"ann\"\n\
             track = [\"aside\"]\n[[time]]\nat = \"ann:start\"\nseconds = {seconds}\nstrength = \"hard\"\n"
        );
        let found = slide(&text);
        assert!((found.edited - found.rest).abs() < ROUNDING, "from {seconds} s: {found:?}");
        // Steps at the ends of contacts count only where instants are working frames; no step across an end ever does.
        assert!((0.002..0.01).contains(&found.rest), "from {seconds} s: {found:?}");
    }
}

#[test]
fn feet_of_a_stretched_walk_slide_only_where_the_full_body_is_off() {
    let (on, off) = (slide(STRETCHED), slide(&format!("{STRETCHED}{OFF}")));
    assert!(on.edited <= on.rest + ROUNDING, "{on:?}");
    assert!(off.edited > on.rest + 0.05, "{off:?}");
}

/// Somebody who has not begun yet stands still in the first pose: that is no slide of 0.
#[test]
fn feet_are_measured_while_somebody_moves_whenever_they_begin() {
    let late = "[[time]]\nat = \"ann:start\"\nseconds = 3.0\nstrength = \"hard\"\n";
    let moment =
        "[[end_effector]]\nat = \"ann:61\"\njoint = \"head\"\ntarget = { position = [0.0, 1.6, 0.0] }\n";
    let off = slide(&format!("{STRETCHED}{OFF}"));
    let found = slide(&format!("{STRETCHED}{late}{OFF}"));
    assert!((found.edited - off.edited).abs() < ROUNDING, "{found:?} or {off:?}");
    // A moment between two frames is a sample too, and the way of a foot bends there.
    let found = slide(&format!("{STRETCHED}{moment}{OFF}"));
    assert!(found.edited > off.edited && found.edited < off.edited + 0.01, "{found:?} or {off:?}");
}

#[test]
fn a_body_that_a_hand_pulls_off_its_pin_is_told_on_the_motion_and_not_on_the_path() {
    let pull = "[[pin]]\nname = \"mark\"\nat = \"ann:60\"\nposition = [1.3, 0.0]\nstrength = \"hard\"\n\
                [[end_effector]]\nat = \"ann:60\"\njoint = \"left_hand\"\ntarget = { position = [2.1, 1.3, 0.0] }\n";
    let mark = |text: &str| {
        let found = told(text).constraints.into_iter().find(|constraint| constraint.name == "mark");
        found.expect("it is held")
    };
    let pulled = mark(&format!("{STRETCHED}{pull}"));
    assert!(pulled.residual > 0.05, "{pulled:?}");
    assert!(pulled.path_residual.is_some_and(|metres| metres < ROUNDING), "{pulled:?}");
    assert!(mark(&format!("{STRETCHED}{pull}{OFF}")).residual < ROUNDING);
}

#[test]
fn a_body_tells_its_largest_turn_and_which_contacts_hold() {
    let unedited = STRETCHED.split("[[pin]]").next().expect("a scene without its pins");
    let still = body(unedited);
    assert!(still.largest_change.is_none(), "nothing changes nothing: {still:?}");
    assert_eq!((still.contacts_held, still.root_shift), (Some(1.0), 0.0));
    let pinned = body(&format!("{unedited}[full_body]\nplants = \"pinned\"\n"));
    let change = pinned.largest_change.expect("generated feet drift by millimetres");
    // What the project promises of feet held still.
    assert!(change.degrees > 0.01 && change.degrees < 5.0, "{change:?}");
    assert!((0.0..4.1).contains(&change.time), "{change:?}");
    let drift = pinned.largest_drift.expect("feet are planted");
    assert!(drift.result < drift.captured + ROUNDING && drift.from < drift.to, "{drift:?}");
    let whole = pinned.contact_drift.expect("feet bear");
    let excess = |drift: &DriftReport| drift.result - drift.captured;
    assert!(excess(&whole) >= excess(&drift) && whole.from < whole.to, "what rolls is told: {whole:?}");
    let whole = body(&format!("{unedited}[full_body]\nplants = \"whole\"\n"));
    assert_eq!(whole.contacts_held, Some(1.0));
    assert!(whole.contact_drift.as_ref().is_some_and(|drift| drift.result < 1e-3), "{whole:?}");
    assert!(whole.largest_change.is_some_and(|whole| whole.degrees > change.degrees));
    assert!(told(&format!("{unedited}{OFF}")).characters[0].full_body.is_none());
}

#[test]
fn plants_out_of_reach_are_told() {
    let near = body(STRETCHED);
    assert!(near.shortfalls.is_empty() && near.contacts_held == Some(1.0), "{near:?}");
    let far = body(&STRETCHED.replace("[2.65, 0.0]", "[6.5, 0.0]"));
    let worst = far.shortfalls.iter().map(|shortfall| shortfall.metres).fold(0.0, f64::max);
    assert!(worst > 0.05 && far.shortfalls[0].joint.contains("Foot"), "{:?}", far.shortfalls);
    let drift = far.largest_drift.expect("feet bear");
    assert!(drift.result > drift.captured + 0.05, "{drift:?}");
    assert!(far.contacts_held.is_some_and(|share| share < 0.9), "{:?}", far.contacts_held);
}
