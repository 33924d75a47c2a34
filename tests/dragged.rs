//! What the program says of drags and of steps that come and go.

mod home;

use std::fs;

use home::{Home, cotillion, stderr, stdout, text};
use serde_json::Value;

/// Ann's end is pulled to twice the length of her way.
const PULLED: &str = r#"
title = "Pulled"
[clips]
walk = "builtin:walk"
[[character]]
name = "ann"
track = ["walk"]
[[pin]]
at = "ann:start"
position = [0.0, 0.0]
[[drag]]
handle = "ann:end"
to = [8.4, 0.0]
facing = 0.0
steps = 5
"#;

fn pulled(more: &str) -> (Value, String) {
    let home = Home::with(&format!("{PULLED}{more}"));
    let output = home.run(&["--no-cache"]);
    assert!(output.status.success(), "{}", stderr(&output));
    let report = fs::read_to_string(home.path("result/report.json")).expect("a report");
    (serde_json::from_str(&report).expect("JSON"), stdout(&output))
}

#[test]
fn a_drag_adds_steps_and_the_report_and_the_summary_say_so() {
    let (report, said) = pulled("[discrete]\n");
    let ann = &report["characters"][0];
    let changes = ann["discrete"].as_array().expect("a list");
    assert!(changes.len() >= 2, "{changes:?}");
    let mut came = 0;
    for change in changes {
        assert!(change["at"].as_str().is_some_and(|at| at.starts_with("ann/walk:")), "{change}");
        assert!(
            ["insert", "duplicate", "delete", "replace"].contains(&change["kind"].as_str().unwrap_or(""))
        );
        let settles = change["settling"] == true;
        assert_eq!((change["drag"].is_u64(), change["step"].is_u64()), (!settles, !settles), "{change}");
        came += change["frames"].as_i64().expect("a number of frames");
    }
    let frames = |which: &str| ann["track_frames"][which].as_f64().expect("a number");
    assert_eq!(frames("edited") - frames("rest"), came as f64);
    assert!(ann["stretch"]["length"].as_f64().is_some_and(|ratio| (0.75..1.25).contains(&ratio)), "{ann}");
    assert!(ann["stretch"]["time"].is_f64() && ann["seam_turns"].is_f64());
    assert!(ann["copies"].as_u64().is_some_and(|copies| copies >= 2));
    assert!(said.contains(&format!("{} discrete changes: +{came}", changes.len())), "{said}");
}

#[test]
fn a_drag_without_discrete_editing_stretches_what_is_there() {
    let (report, said) = pulled("");
    let ann = &report["characters"][0];
    assert_eq!(ann["discrete"].as_array().map(Vec::len), Some(0), "{ann}");
    assert_eq!(ann["frames_in"], ann["frames_out"]);
    let length = |which: &str| ann["path_length"][which].as_f64().expect("a length");
    assert!(length("edited") > 1.5 * length("rest"), "{ann}");
    assert!(!said.contains("discrete"), "{said}");
}

#[test]
fn reversible_drags_out_and_back_end_as_the_short_way_does() {
    const BACK: &str = "[[drag]]\nhandle = \"ann:end\"\nto = [5.5, 0.4]\nfacing = 0.0\nsteps = 3\n";
    const REVERSIBLE: &str = "[discrete]\nreversible = true\n";
    let motion = |scene: &str| {
        let home = Home::with(scene);
        let output = home.run(&["--no-cache"]);
        assert!(output.status.success(), "{}", stderr(&output));
        let report = fs::read_to_string(home.path("result/report.json")).expect("a report");
        let report: Value = serde_json::from_str(&report).expect("JSON");
        (fs::read(home.path("result/ann.bvh")).expect("a motion"), report)
    };
    let (there_and_back, report) = motion(&format!("{PULLED}{BACK}{REVERSIBLE}"));
    let way = "to = [8.4, 0.0]\nfacing = 0.0\nsteps = 5";
    let short = PULLED.replace(way, "to = [5.5, 0.4]\nfacing = 0.0\nsteps = 1");
    assert!(there_and_back == motion(&format!("{short}{REVERSIBLE}")).0, "the same bytes");
    let ann = &report["characters"][0];
    let changes = ann["discrete"].as_array().expect("a list");
    assert!(changes.iter().any(|change| change["undo"] == true), "{changes:?}");
    let sum: i64 = changes.iter().filter_map(|change| change["frames"].as_i64()).sum();
    let frames = |which: &str| ann["track_frames"][which].as_f64().expect("a number");
    assert_eq!(frames("edited") - frames("rest"), sum as f64);
}

#[test]
fn check_says_what_drags_move() {
    let home = Home::with(PULLED);
    let output = cotillion(&["check", text(&home.path("scene.toml"))]);
    assert!(output.status.success(), "{}", stderr(&output));
    let said = stdout(&output);
    let line = "ann:end drags the position of drag[0].position and the facing of drag[0].facing in 5 steps";
    assert!(said.contains(line) && !said.contains("whatever way"), "{said}");
    let home = Home::with(&format!("{PULLED}[discrete]\nreversible = true\n"));
    let said = stdout(&cotillion(&["check", text(&home.path("scene.toml"))]));
    assert!(said.contains("by where the handles are, whatever way they took"), "{said}");
}

#[test]
fn a_scene_without_drags_settles_too_unless_told_otherwise() {
    let (drags, _) = PULLED.split_once("[[drag]]").expect("a drag");
    let still = format!("{drags}[[pin]]\nat = \"ann:end\"\nposition = [8.4, 0.0]\n");
    let changes = |more: &str| {
        let home = Home::with(&format!("{still}{more}"));
        let output = home.run(&["--no-cache"]);
        assert!(output.status.success(), "{}", stderr(&output));
        assert!(!home.path("result/before.svg").exists(), "nothing was dragged");
        let report = fs::read_to_string(home.path("result/report.json")).expect("a report");
        let report: Value = serde_json::from_str(&report).expect("JSON");
        report["characters"][0]["discrete"].as_array().cloned().expect("a list")
    };
    let settled = changes("[discrete]\n");
    assert!(settled.len() >= 2 && settled[0]["settling"] == false, "{settled:?}");
    for change in &settled[1..] {
        assert!(
            change["settling"] == true && change["drag"].is_null() && change["step"].is_null(),
            "{change}"
        );
    }
    assert_eq!(changes("[discrete]\nsettle = false\n"), settled[..1]);
    assert!(changes("").is_empty());
}

#[test]
fn who_is_pulled_and_has_no_steps_to_add_is_told_how_far_the_path_is_stretched() {
    let (report, _) = pulled("[discrete]\nkinds = [\"delete\"]\nregions = [[[90.0, 90.0], [91.0, 91.0]]]\n");
    let ann = &report["characters"][0];
    assert_eq!(ann["discrete"].as_array().map(Vec::len), Some(0), "{ann}");
    let ratio = ann["stretch"]["length"].as_f64().expect("a ratio");
    assert!(ratio > 1.5, "{ann}");
    let note =
        format!("nothing in the motion graph fits the track of ann: its path is stretched {ratio:.2} times");
    assert!(report["notes"].as_array().expect("a list").contains(&Value::from(note)), "{}", report["notes"]);
}

#[test]
fn what_was_dragged_is_drawn_as_it_was_before_at_the_same_scale() {
    let home = Home::with(PULLED);
    let output = home.run(&["--no-cache", "--png"]);
    assert!(output.status.success(), "{}", stderr(&output));
    let read = |name: &str| fs::read_to_string(home.path(&format!("result/{name}"))).expect("a picture");
    let (before, after) = (read("before.svg"), read("scene.svg"));
    assert!(after.contains("dragged here") && !before.contains("dragged here"));
    // Lines of the grid, and marks of the time axis.
    let lines = |picture: &str| -> Vec<String> {
        let grid = ["#e6e9ed", "#e1e5e9"];
        picture.lines().filter(|line| grid.iter().any(|pen| line.contains(pen))).map(str::to_owned).collect()
    };
    assert!(!lines(&before).is_empty() && lines(&before) == lines(&after));
    assert!(home.path("result/before.png").is_file());
}
