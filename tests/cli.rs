//! What the program promises at the command line: exit codes, places and remedies of errors, and whole results or none.

mod home;

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use home::{Home, cotillion, stderr, stdout, text};
use serde_json::Value;

const SOUND: &str = r#"
title = "Two meet"
[clips]
walk = { builtin = "walk", stop = 1 }
[[character]]
name = "ann"
track = ["walk"]
[[character]]
name = "bo"
track = ["walk"]
position = [3.0, 0.0]
facing = 180.0
[[pin]]
name = "ann arrives"
at = "ann:end"
position = [1.0, -4.0]
strength = "hard"
"#;

/// What is in a folder with a scene, by name.
fn names(home: &Home) -> Vec<String> {
    let mut names: Vec<String> = fs::read_dir(home.path(""))
        .expect("readable")
        .flatten()
        .map(|entry| entry.file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    names
}

/// Errors as one line: they are broken to the width of the terminal.
fn said(output: &Output) -> String {
    stderr(output).replace('│', " ").split_whitespace().collect::<Vec<_>>().join(" ")
}

#[test]
fn a_run_writes_motion_picture_and_report() {
    let home = Home::with(SOUND);
    let output = home.run(&["--png"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    for name in ["ann.bvh", "bo.bvh", "scene.glb", "scene.svg", "scene.png", "report.json"] {
        assert!(fs::metadata(home.path("result").join(name)).is_ok_and(|file| file.len() > 0), "{name}");
    }
    let report: Value =
        serde_json::from_slice(&fs::read(home.path("result/report.json")).expect("written")).expect("JSON");
    assert_eq!(report["scene"], "Two meet");
    assert_eq!(report["constraints"][0]["name"], "ann arrives");
    assert!(report["constraints"][0]["residual"].as_f64().is_some_and(|miss| miss < 1e-9));
    for key in ["load", "assemble", "factor", "solve", "discrete", "full_body", "physics", "export"] {
        assert!(report["timing_ms"][key].is_f64(), "{key}");
    }
    for key in ["shape", "scale", "time", "length", "duration", "turn", "total"] {
        assert!(report["energy"][key].is_f64(), "{key}");
    }
    let moment = &report["moments"][0];
    assert_eq!(moment["name"], "ann:end");
    assert!(moment["time"].is_f64());
    let names = fs::read_dir(home.path("result")).expect("readable").count();
    assert_eq!(names, 6, "no temporary file is left");
}

#[test]
fn quiet_says_nothing_and_json_prints_the_report() {
    let home = Home::with(SOUND);
    let quiet = home.run(&["--quiet"]);
    assert_eq!((stdout(&quiet), stderr(&quiet)), (String::new(), String::new()));
    let output = home.run(&["--json"]);
    let report: Value = serde_json::from_slice(&output.stdout).expect("JSON and nothing else");
    assert_eq!(report["characters"][1]["name"], "bo");
    assert_eq!(stderr(&output), "");
}

#[test]
fn contradicting_constraints_end_with_exit_code_1_and_leave_nothing() {
    let scene = format!(
        "{SOUND}\n[[pin]]\nname = \"ann stays\"\nat = \"ann:end\"\nposition = [1.3, -4.4]\nstrength = \"hard\"\n"
    );
    let home = Home::with(&scene);
    let output = home.run(&[]);
    assert_eq!(output.status.code(), Some(1));
    let said = said(&output);
    for part in ["\"ann arrives\" (line 13)", "\"ann stays\" (line 19)", "0.5", "help: "] {
        assert!(said.contains(part), "{part} in {said}");
    }
    assert_eq!(names(&home), ["scene.toml"]);
    let output = home.run(&["--json"]);
    let errors: Value = serde_json::from_slice(&output.stderr).expect("JSON and nothing else");
    assert_eq!(errors[0]["line"], 19);
    assert!(errors[0]["message"].as_str().is_some_and(|message| message.contains("ann stays")));
    assert!(errors[0]["help"].is_string());
}

#[test]
fn times_that_the_bounds_forbid_are_explained() {
    let scene = format!(
        "{SOUND}\n[[duration]]\nname = \"slow\"\nfrom = \"ann:start\"\nto = \"ann:end\"\nseconds = 60.0\nstrength = \"hard\"\n"
    );
    let home = Home::with(&scene);
    let output = home.run(&[]);
    assert_eq!(output.status.code(), Some(1));
    let said = said(&output);
    assert!(said.contains("\"slow\" (line 19)") && said.contains("s are missing"), "{said}");
    assert_eq!(names(&home), ["scene.toml"]);
}

#[test]
fn a_failed_run_leaves_an_earlier_result_as_it_is() {
    let home = Home::with(SOUND);
    assert_eq!(home.run(&[]).status.code(), Some(0));
    let before = fs::read(home.path("result/report.json")).expect("written");
    fs::write(home.path("scene.toml"), SOUND.replace("stop = 1", "speed = 99.0")).expect("a scene file");
    assert_eq!(home.run(&[]).status.code(), Some(2));
    assert_eq!(fs::read(home.path("result/report.json")).expect("still there"), before);
}

#[test]
fn a_result_that_cannot_be_written_ends_with_exit_code_2() {
    let home = Home::with(SOUND);
    fs::write(home.path("result"), "in the way").expect("a file");
    let output = home.run(&[]);
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("cannot be written"), "{}", stderr(&output));
    assert_eq!(names(&home), ["result", "scene.toml"]);
    assert_eq!(fs::read(home.path("result")).expect("still there"), b"in the way");
}

/// What is printed is lost on a full disk: nobody is told that all is well.
#[test]
#[cfg(target_os = "linux")]
fn a_result_that_cannot_be_printed_ends_with_exit_code_2() {
    for arguments in [&["relay", "-n", "12"][..], &["schema"], &["clips"]] {
        let full = fs::OpenOptions::new().write(true).open("/dev/full").expect("a device");
        let output = Command::new(env!("CARGO_BIN_EXE_cotillion"))
            .args(arguments)
            .stdout(full)
            .output()
            .expect("it runs");
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        assert!(said(&output).contains("standard output: error: cannot be written"), "{}", said(&output));
    }
}

#[test]
fn every_bad_scene_ends_with_exit_code_2_a_place_and_a_remedy() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/bad_scenes");
    let mut seen = 0;
    for entry in fs::read_dir(folder).expect("bad scenes are beside this file").flatten() {
        let path = entry.path();
        if path.extension().is_none_or(|extension| extension != "toml") {
            continue;
        }
        seen += 1;
        let checked = cotillion(&["check", "--json", text(&path)]);
        assert_eq!(checked.status.code(), Some(2), "{}", path.display());
        let faults: Value = serde_json::from_slice(&checked.stderr).expect("JSON and nothing else");
        for fault in faults.as_array().expect("an array") {
            assert!(fault["line"].as_u64().is_some_and(|line| line > 0), "{fault}");
            assert!(fault["column"].as_u64().is_some_and(|column| column > 0), "{fault}");
            assert!(fault["message"].is_string() && fault["help"].is_string(), "{fault}");
        }
        let home = tempfile::tempdir().expect("a temporary folder");
        let result = home.path().join("result");
        let output = cotillion(&["run", text(&path), "-o", text(&result)]);
        assert_eq!(output.status.code(), Some(2), "{}", path.display());
        assert!(!result.exists(), "{} left a result", path.display());
        assert!(stderr(&output).contains("help: "), "{}", stderr(&output));
    }
    assert!(seen >= 30, "{seen} kinds of bad scenes");
}

#[test]
fn check_reports_on_every_scene() {
    let (good, bad) = (Home::with(SOUND), Home::with("fps = 0\n"));
    let (good, bad) = (good.path("scene.toml"), bad.path("scene.toml"));
    let home = Home::with(SOUND);
    assert_eq!(cotillion(&["check", text(&home.path("scene.toml"))]).status.code(), Some(0));
    let output = cotillion(&["check", text(&good), text(&bad), text(Path::new("no such.toml"))]);
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("no such.toml"), "{}", stderr(&output));
}

#[test]
fn wrong_usage_ends_with_exit_code_2() {
    for arguments in
        [&["run"][..], &["walk"], &["run", "x.toml"], &["check"], &["inspect", "--fps", "0", "x.bvh"]]
    {
        assert_eq!(cotillion(arguments).status.code(), Some(2), "{arguments:?}");
    }
}

#[test]
fn inspect_prints_the_documented_keys() {
    let home = tempfile::tempdir().expect("a temporary folder");
    let file = home.path().join("walk.bvh");
    assert_eq!(cotillion(&["clips", "walk", "-o", text(&file)]).status.code(), Some(0));
    let output = cotillion(&["inspect", "--json", text(&file)]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let facts: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let keys = [
        "file",
        "joints",
        "frames",
        "fps",
        "unit_to_m",
        "up",
        "height",
        "root_path",
        "seconds",
        "contacts",
        "flights",
        "stationary",
        "warnings",
    ];
    for key in keys {
        assert!(!facts[0][key].is_null(), "{key}");
    }
    assert_eq!(facts[0]["joints"], 21);
    let missing = cotillion(&["inspect", "--json", text(&file), "no such.bvh"]);
    assert_eq!(missing.status.code(), Some(2));
    let errors: Value = serde_json::from_slice(&missing.stderr).expect("JSON");
    assert_eq!(errors[0]["file"], "no such.bvh");
}

#[test]
fn the_schema_is_json_and_knows_every_table() {
    let output = cotillion(&["schema"]);
    let schema: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    for table in [
        "clips",
        "character",
        "object",
        "pin",
        "relative",
        "carry",
        "end_effector",
        "time",
        "duration",
        "sync",
        "warp",
        "full_body",
    ] {
        assert!(schema["properties"][table].is_object(), "{table}");
    }
}

#[test]
fn a_hand_reaches_what_it_must_unless_the_full_body_is_off() {
    let reach = "[[end_effector]]\nname = \"lamp\"\nat = \"ann:end\"\njoint = \"left_hand\"\n\
                 target = { position = [1.2, 1.2, 4.1] }\n";
    let miss = |more: &str| {
        let home = Home::with(&format!("{SOUND}{reach}{more}"));
        assert_eq!(home.run(&[]).status.code(), Some(0));
        let report = fs::read_to_string(home.path("result").join("report.json")).expect("a report");
        let report: Value = serde_json::from_str(&report).expect("JSON");
        let constraints = report["constraints"].as_array().expect("constraints").clone();
        let lamp =
            constraints.into_iter().find(|constraint| constraint["name"] == "lamp").expect("the reach");
        lamp["residual"].as_f64().expect("metres")
    };
    assert!(miss("") < 1e-3, "{}", miss(""));
    assert!(miss("[full_body]\nenabled = false\n") > 0.1);
}

#[test]
fn what_is_out_of_reach_is_said_and_reported() {
    let far = SOUND.replace("position = [1.0, -4.0]", "position = [7.0, 0.0]");
    let pull = "[[pin]]\nat = \"ann:start\"\nposition = [0.0, 0.0]\nstrength = \"hard\"\n\
                [[end_effector]]\nname = \"lamp\"\nat = \"bo:end\"\njoint = \"left_hand\"\n\
                target = { position = [-1.0, 1.2, 0.0] }\n[[pin]]\nname = \"mark\"\nat = \"bo:end\"\n\
                position = [1.5, 0.0]\nstrength = \"hard\"\n";
    let home = Home::with(&format!("{far}{pull}"));
    let output = home.run(&[]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let said = stdout(&output);
    let parts = [
        "ann: LeftFoot is ",
        " m short of its place at ",
        " % of contacts hold",
        "bo: LeftHand is ",
        "lamp is off by ",
        "mark (hard) is off by ",
        ": its path holds, the body is pulled off it",
    ];
    for part in parts {
        assert!(said.contains(part), "{part} in {said}");
    }
    let report: Value =
        serde_json::from_slice(&fs::read(home.path("result/report.json")).expect("written")).expect("JSON");
    let body = &report["characters"][0]["full_body"];
    for key in ["root_shift", "root_drop", "contacts_held"] {
        assert!(body[key].is_f64(), "{key} in {body}");
    }
    for key in ["joint", "time", "degrees"] {
        assert!(!body["largest_change"][key].is_null(), "{key} in {body}");
    }
    for key in ["point", "from", "to", "captured", "result"] {
        assert!(!body["largest_drift"][key].is_null(), "{key} in {body}");
    }
    for key in ["joint", "time", "metres"] {
        assert!(!body["shortfalls"][0][key].is_null(), "{key} in {body}");
    }
}

#[test]
fn carries_that_overlap_end_the_run_and_are_named() {
    let carry = |name: &str, who: &str, from: &str| {
        format!(
            "[[carry]]\nname = \"{name}\"\nobject = \"box\"\nby = [\"{who}\"]\nduring = [\"{who}:{from}\", \"{who}:60\"]\n"
        )
    };
    let object = "[[object]]\nname = \"box\"\nsize = [0.3, 0.3, 0.3]\nposition = [0.5, 0.0]\n";
    let home = Home::with(&format!(
        "{SOUND}{object}{}{}",
        carry("ann's turn", "ann", "start"),
        carry("bo's turn", "bo", "30")
    ));
    let output = home.run(&[]);
    assert_eq!(output.status.code(), Some(1));
    for part in ["\"ann's turn\"", "\"bo's turn\"", "overlap by 1.000000 s", "[[sync]]"] {
        assert!(said(&output).contains(part), "{part} in {}", said(&output));
    }
}

#[test]
fn results_do_not_depend_on_the_number_of_threads() {
    let home = Home::with(SOUND);
    let mut results = Vec::new();
    for threads in ["1", "2"] {
        let (scene, result) = (home.path("scene.toml"), home.path(threads));
        let mut command = Command::new(env!("CARGO_BIN_EXE_cotillion"));
        command.args(["run", text(&scene), "-o", text(&result), "--quiet"]).env("RAYON_NUM_THREADS", threads);
        assert!(command.status().expect("the program starts").success());
        let read = |name: &str| fs::read(result.join(name)).expect("written");
        results.push(["ann.bvh", "bo.bvh", "scene.glb", "scene.svg"].map(read));
    }
    assert!(results[0] == results[1], "the same bytes");
}

#[test]
fn the_scene_of_the_readme_runs_and_holds() {
    let readme =
        fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("README.md")).expect("a README");
    let scene =
        readme.split("```toml\n").nth(1).and_then(|rest| rest.split("```").next()).expect("an example scene");
    let home = Home::with(scene);
    let output = home.run(&["--json"]);
    assert_eq!((output.status.code(), stderr(&output)), (Some(0), String::new()));
    let report: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    for constraint in report["constraints"].as_array().expect("an array") {
        let miss = constraint["residual"].as_f64().expect("a number");
        assert!(miss < if constraint["strength"] == "hard" { 1e-9 } else { 1e-3 }, "{constraint}");
    }
    let picture = fs::read(Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/meet.svg")).expect("its picture");
    let found = fs::read(home.path("result/scene.svg")).expect("written");
    assert!(picture == found, "docs/meet.svg is the picture of the README's scene; run it again");
    assert_eq!(report["moments"].as_array().map(Vec::len), Some(4));
    let ann = &report["characters"][0];
    let (rest, edited) = (ann["path_length"]["rest"].as_f64(), ann["path_length"]["edited"].as_f64());
    assert!(rest.zip(edited).is_some_and(|(rest, edited)| (rest - edited).abs() > 0.05), "the example edits");
    assert!(ann["time_step"]["min"].as_f64().is_some_and(|step| step < 0.95), "and warps time");
    let hit =
        report["moments"].as_array().and_then(|moments| moments.iter().find(|m| m["name"] == "ann/slap:hit"));
    assert!(hit.is_some_and(|hit| (hit["time"].as_f64().unwrap_or(0.0) - 5.0).abs() < 1e-9));
}
