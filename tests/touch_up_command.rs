//! `cotillion touch-up` makes a bent walk lean, tells what it did, and refuses what it cannot do.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use cotillion::clip::Clip;
use cotillion::geometry::plan_of;
use cotillion::scene::{ClipFolders, load_text};
use serde_json::Value;

const WALK: &str = "builtin:walk,seconds=6";

fn touch_up(arguments: &[&str], folder: &Path) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_cotillion"));
    command.arg("touch-up").args(arguments).arg("-o").arg(folder);
    command.output().expect("the program starts")
}

/// The report of a touch-up that works.
fn report(arguments: &[&str], folder: &Path) -> Value {
    let done = touch_up(arguments, folder);
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    let text = fs::read_to_string(folder.join("report.json")).expect("a report");
    serde_json::from_str(&text).expect("JSON")
}

/// What a refused touch-up says as JSON: its messages.
fn refused(arguments: &[&str]) -> Vec<String> {
    let home = tempfile::tempdir().expect("a temporary folder");
    let folder = home.path().join("out");
    let all: Vec<&str> = arguments.iter().copied().chain(["--json"]).collect();
    let done = touch_up(&all, &folder);
    assert_eq!(done.status.code(), Some(2), "{}", String::from_utf8_lossy(&done.stdout));
    assert!(!folder.exists(), "a refused touch-up leaves nothing");
    let errors: Value = serde_json::from_slice(&done.stderr).expect("errors as JSON");
    let errors = errors.as_array().expect("an array").clone();
    errors.iter().map(|error| format!("{}: {}", error["file"], error["message"])).collect()
}

fn number(report: &Value, place: &str) -> f64 {
    report.pointer(place).and_then(Value::as_f64).unwrap_or_else(|| panic!("{place} in {report:#}"))
}

#[test]
fn a_bent_walk_is_borne_by_the_ground_and_the_report_says_how() {
    let home = tempfile::tempdir().expect("a temporary folder");
    let report = report(&[WALK, "--bend", "3", "--plots", "--strip"], home.path());
    // The prototype's bends come to a twentieth; generated walks start farther off.
    assert!(number(&report, "/ground/after/d/mean") < 0.125 * number(&report, "/ground/before/d/mean"));
    assert!(
        number(&report, "/ground/after/d_6hz/mean") < 0.125 * number(&report, "/ground/before/d_6hz/mean")
    );
    let steps = report["ground"]["steps"].as_array().expect("steps");
    assert_eq!(steps.len(), 9);
    let means: Vec<f64> = steps.iter().map(|step| number(step, "/d/mean")).collect();
    assert!(means.windows(2).all(|pair| pair[1] < pair[0]), "falls at every step: {means:?}");
    assert!(number(&report, "/ground/plants/largest_error") < 1e-4);
    assert!(number(&report, "/ground/source/d/mean") > 0.0, "the source is known");
    assert!(
        number(&report, "/largest_change/degrees") > 0.0 && report["largest_change"]["joint"].is_string()
    );
    assert!(number(&report, "/result/d/mean") > 0.0 && number(&report, "/ground/root_shift") > 0.0);
    for file in ["walk.bvh", "walk.curves.svg", "walk.before.svg", "walk.after.svg"] {
        assert!(home.path().join(file).is_file(), "{file}");
        assert!(report["files"].as_array().expect("files").contains(&Value::from(file)));
    }
    let text = fs::read_to_string(home.path().join("walk.bvh")).expect("a motion");
    assert!(text.contains(&format!("Frames: {}", number(&report, "/frames"))), "all frames are written");
}

#[test]
fn the_same_arguments_give_the_same_bytes() {
    let home = tempfile::tempdir().expect("a temporary folder");
    let folders = ["a", "b"].map(|name| home.path().join(name));
    for folder in &folders {
        report(&[WALK, "--bend", "3", "--target", "carried", "--plots", "--strip", "--masses"], folder);
    }
    for file in ["walk.bvh", "walk.curves.svg", "walk.before.svg", "walk.after.svg", "report.json"] {
        let [a, b] = folders.each_ref().map(|folder| fs::read(folder.join(file)).expect(file));
        assert!(a == b, "{file}");
    }
}

#[test]
fn an_unedited_clip_comes_out_as_it_went_in_when_carried() {
    let home = tempfile::tempdir().expect("a temporary folder");
    let report = report(&[WALK, "--target", "carried", "--source", WALK], home.path());
    assert_eq!(number(&report, "/ground/root_shift"), 0.0);
    assert!(report["largest_change"].is_null());
}

#[test]
fn masses_are_told_with_what_the_motion_says_of_them() {
    let home = tempfile::tempdir().expect("a temporary folder");
    let report = report(&["builtin:jump", "--masses", "--mass", "60", "--table", "xiao2005"], home.path());
    let singular = report["body"]["estimate"]["singular_values"].as_array().expect("singular values");
    assert!(singular.len() > 5, "{singular:?}");
    let masses = report["body"]["segments"].as_array().expect("segments").iter();
    let sum: f64 = masses.map(|segment| number(segment, "/mass")).sum();
    // Its thorax is printed too heavy: 76.423 kg for 75.
    assert!((sum / 60.0 - 76.423 / 75.0).abs() < 1e-3, "{sum}");
    assert!(!report["flights"].as_array().expect("flights").is_empty());
}

#[test]
fn a_run_is_no_worse_at_6_hz_and_flights_are_flown_or_left() {
    let home = tempfile::tempdir().expect("a temporary folder");
    for arguments in
        [&["builtin:run", "--bend", "4"][..], &["builtin:run", "--bend", "4", "--target", "carried"]]
    {
        let report = report(arguments, home.path());
        // Rounding of a mean distance.
        let most = number(&report, "/ground/before/d_6hz/mean") + 1e-9;
        assert!(number(&report, "/result/d_6hz/mean") <= most, "{report:#}");
        let flights = report["flights"].as_array().expect("flights");
        assert!(!flights.is_empty(), "a run flies");
        assert!(flights.iter().all(|flight| flight["left"] == flight["pass"].is_null()), "{flights:#?}");
    }
}

#[test]
fn all_bad_options_are_told_at_once() {
    let told = refused(&[WALK, "--bend", "-3", "--mass", "NaN", "--margin", "2", "--bvh-rate", "0"]);
    for option in ["--bend", "--mass", "--margin", "--bvh-rate"] {
        assert!(told.iter().any(|error| error.contains(option)), "{option} in {told:?}");
    }
    let told = refused(&[WALK, "--target", "carried"]);
    assert!(told[0].contains("not known"), "{told:?}");
    let told = refused(&[WALK, "--target", "carried", "--source", "builtin:run"]);
    assert!(told[0].contains("frames"), "{told:?}");
    let told = refused(&["builtin:idle", "--bend", "3"]);
    assert!(told[0].contains("no chord"), "{told:?}");
}

const ARM: &str = "HIERARCHY\nROOT shoulder\n{\nOFFSET 0 0 0\n\
    CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation\nJOINT elbow\n{\nOFFSET 0 0.3 0\n\
    CHANNELS 3 Zrotation Xrotation Yrotation\nEnd Site\n{\nOFFSET 0 0.3 0\n}\n}\n}\nMOTION\nFrames: 4\nFrame Time: 0.033333\n";

#[test]
fn bodies_without_legs_and_motions_that_are_no_numbers_are_refused() {
    let home = tempfile::tempdir().expect("a temporary folder");
    let path = home.path().join("arm.bvh");
    let frame = "0 1 0 0 0 0 0 0 0\n";
    fs::write(&path, format!("{ARM}{}", frame.repeat(4))).expect("a file");
    let told = refused(&[path.to_str().expect("a plain path"), "--unit", "m"]);
    assert!(told[0].contains("no left leg"), "{told:?}");
    fs::write(&path, format!("{ARM}{}{}", frame.repeat(3), "0 nan 0 0 0 0 0 0 0\n")).expect("a file");
    let told = refused(&[path.to_str().expect("a plain path"), "--unit", "m"]);
    assert!(told[0].to_lowercase().contains("nan"), "{told:?}");
}

#[test]
fn a_capture_is_not_overwritten_by_its_touch_up() {
    let home = tempfile::tempdir().expect("a temporary folder");
    report(&[WALK], home.path());
    let path = home.path().join("walk.bvh");
    let before = fs::read(&path).expect("a motion");
    let done = touch_up(&[path.to_str().expect("a plain path")], home.path());
    assert_eq!(done.status.code(), Some(2));
    assert!(fs::read(&path).expect("still there") == before);
}

#[test]
fn the_picture_of_the_docs_is_what_its_command_draws() {
    let home = tempfile::tempdir().expect("a temporary folder");
    report(&[WALK, "--bend", "3", "--plots"], home.path());
    let found = fs::read(home.path().join("walk.curves.svg")).expect("curves");
    let picture = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/touch_up.svg");
    assert!(fs::read(picture).expect("its picture") == found, "docs/touch_up.svg: run its command again");
}

#[test]
fn clips_of_a_scene_are_made_of_its_other_clips_in_any_order() {
    let text = r#"
        [clips]
        uphill = { from = "bent", tilt = 10 }
        bent = { from = "walk", bend = { radius = 3.0, to = "right" }, events = { half = 50 } }
        start = { blend = ["walk", "jog"] }
        walk = { builtin = "walk", seconds = 6 }
        jog = "builtin:run"
        [[character]]
        name = "ann"
        track = ["bent"]
        [[character]]
        name = "bob"
        track = ["uphill"]
        [[character]]
        name = "cleo"
        track = ["start"]
        [[time]]
        at = "bob:half"
        seconds = 2.0
    "#;
    let loaded = load_text(text, Path::new("scene.toml"), &ClipFolders::default());
    let loaded = loaded.unwrap_or_else(|faults| panic!("{faults:?}"));
    assert!(loaded.warnings.is_empty(), "{:?}", loaded.warnings);
    let [bent, uphill, start] = [0, 1, 2].map(|at| &loaded.scene.characters[at].track.clips[0]);
    let ends = |clip: &Clip| {
        let last = clip.usable.1.as_usize();
        (clip.root_positions[0], clip.root_positions[last])
    };
    let (from, to) = ends(&bent.clip);
    assert!(plan_of(to - from).im < -1.0, "a walk along x bends to the right");
    let (from, to) = ends(&uphill.clip);
    assert!(to.y - from.y > 0.5, "uphill");
    assert!(start.clip.frame_count() > 60 && start.clip.name == "start");
}
