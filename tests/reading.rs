//! What the program promises about captures that are not as they should be: refused with a place, mended on request,
//! refused strictly, read as told.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use cotillion::clip::read::{Capture, ReadOptions, read};
use serde_json::Value;

/// A folder with a generated walk as BVH in it, changed by `spoil`.
struct Home {
    folder: tempfile::TempDir,
}

impl Home {
    fn with(spoil: impl Fn(String) -> String) -> Self {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let home = Self { folder };
        let path = home.walk();
        let written = cotillion(&["clips", "walk", "-o", text(&path)]);
        assert!(written.status.success());
        let bvh = fs::read_to_string(&path).expect("what was written");
        fs::write(&path, spoil(bvh)).expect("a temporary file");
        home
    }

    fn walk(&self) -> PathBuf {
        self.folder.path().join("walk.bvh")
    }

    /// `inspect` of the walk with more arguments.
    fn inspect(&self, arguments: &[&str]) -> Output {
        let path = self.walk();
        cotillion(&[&["inspect", "--json", text(&path)], arguments].concat())
    }

    /// `check` of a scene that plays the walk with these keys in its table.
    fn check(&self, keys: &str) -> Output {
        let path = self.folder.path().join("scene.toml");
        let scene = format!(
            "[clips]\nwalk = {{ file = \"walk.bvh\", {keys} }}\n[[character]]\nname = \"ann\"\ntrack = [\"walk\"]\n"
        );
        fs::write(&path, scene).expect("a temporary file");
        cotillion(&["check", "--json", text(&path)])
    }
}

fn text(path: &Path) -> &str {
    path.to_str().expect("temporary folders have plain names")
}

fn cotillion(arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_cotillion"));
    command.args(arguments).env_remove("COTILLION_MOCAP").env("NO_COLOR", "1");
    command.env("XDG_CACHE_HOME", env!("CARGO_TARGET_TMPDIR"));
    command.output().expect("the program starts")
}

fn refusal(output: &Output) -> Value {
    assert_eq!(output.status.code(), Some(2), "{}", String::from_utf8_lossy(&output.stdout));
    let errors: Vec<Value> = serde_json::from_slice(&output.stderr).expect("errors as JSON");
    errors.into_iter().next().expect("an error")
}

fn facts(output: &Output) -> Value {
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let clips: Vec<Value> = serde_json::from_slice(&output.stdout).expect("facts as JSON");
    clips.into_iter().next().expect("a clip")
}

fn warnings(facts: &Value) -> String {
    facts["warnings"].to_string()
}

/// The text with row `row` of the motion replaced.
fn with_row(bvh: &str, row: usize, by: &str) -> String {
    let start = bvh.lines().position(|line| line.starts_with("Frame Time")).expect("a motion") + 1;
    let lines = bvh.lines().enumerate().map(|(index, line)| if index == start + row { by } else { line });
    lines.collect::<Vec<_>>().join("\n")
}

/// The text with the first number of row `row` of the motion replaced.
fn with_first_number(bvh: &str, row: usize, by: &str) -> String {
    let start = bvh.lines().position(|line| line.starts_with("Frame Time")).expect("a motion") + 1;
    let lines = bvh.lines().enumerate().map(|(index, line)| {
        if index == start + row {
            format!("{by} {}", line.split_once(' ').expect("many numbers").1)
        } else {
            line.to_owned()
        }
    });
    lines.collect::<Vec<_>>().join("\n")
}

#[test]
fn a_value_that_is_no_number_is_refused_by_its_place_and_mended_on_request() {
    let home = Home::with(|bvh| with_first_number(&bvh, 10, "nan"));
    let error = refusal(&home.inspect(&[]));
    assert!(error["message"].as_str().expect("a message").contains("`nan` is not a finite number"));
    assert_eq!(error["column"], 1);
    let mended = facts(&home.inspect(&["--repair"]));
    assert!(warnings(&mended).contains("were filled in: frame 10"), "{mended}");
    assert!(home.check("repair = true").status.success());
    refusal(&home.check("repair = false"));
}

#[test]
fn a_frame_that_departs_is_noted_and_mended_on_request() {
    let home = Home::with(|bvh| with_first_number(&bvh, 30, "3.5"));
    assert!(warnings(&facts(&home.inspect(&[]))).contains("comes back: frame 30"));
    let mended = facts(&home.inspect(&["--repair"]));
    assert!(warnings(&mended).contains("were filled in: frame 30"));
    let sound = facts(&Home::with(|bvh| bvh).inspect(&[]));
    let path = |facts: &Value| facts["root_path"].as_f64().expect("a length");
    assert!((path(&mended) - path(&sound)).abs() < 1e-3);
}

#[test]
fn strictly_a_guess_is_refused_until_it_is_settled() {
    let home = Home::with(|bvh| bvh);
    let error = refusal(&home.inspect(&["--strict"]));
    assert!(error["message"].as_str().expect("a message").contains("unit guessed"), "{error}");
    assert_eq!(facts(&home.inspect(&["--strict", "--unit", "m"]))["warnings"], serde_json::json!([]));
    refusal(&home.check("strict = true"));
    assert!(home.check("strict = true, unit = \"m\"").status.success());
}

#[test]
fn a_role_goes_to_the_joint_that_is_named() {
    let home = Home::with(|bvh| bvh.replace("LeftHand", "Paw"));
    let hand = |facts: &Value| {
        let roles = facts["roles"].as_array().expect("roles").clone();
        roles.into_iter().find(|role| role["role"] == "left_hand").map(|role| role["joint"].clone())
    };
    assert_eq!(hand(&facts(&home.inspect(&[]))), None);
    assert_eq!(hand(&facts(&home.inspect(&["--role", "left_hand=Paw"]))), Some("Paw".into()));
    let error = refusal(&home.inspect(&["--role", "left_hand=Claw"]));
    assert!(error["message"].as_str().expect("a message").contains("`Claw`, which the file does not have"));
    assert!(home.check("roles = { left_hand = \"Paw\" }").status.success());
    let error = refusal(&home.check("roles = { left_paw = \"Paw\" }"));
    assert!(error["message"].as_str().expect("a message").contains("no joint role \"left_paw\""));
}

#[test]
fn files_go_by_their_endings_and_say_what_they_lack() {
    let home = Home::with(|bvh| bvh);
    let named = |name: &str| {
        let path = home.folder.path().join(name);
        fs::copy(home.walk(), &path).expect("a copy");
        refusal(&cotillion(&["inspect", "--json", text(&path)]))["message"].as_str().expect("text").to_owned()
    };
    assert!(named("walk.fbx").contains("its name ends in none of .bvh, .amc, .json and .txt"));
    assert!(named("walk.asf").contains("is a skeleton without motion"));
    fs::remove_file(home.folder.path().join("walk.asf")).expect("the copy");
    assert!(named("walk.amc").contains("needs a skeleton"));
    let walk = home.walk();
    let error = refusal(&home.inspect(&["--skeleton", text(&walk)]));
    assert!(error["message"].as_str().expect("text").contains("brings its own skeleton"));
}

#[test]
fn frames_that_are_named_settle_what_they_leave_out() {
    let rest = |bvh: String| {
        let width = bvh.lines().last().expect("rows").split_whitespace().count();
        let zeros = vec!["0"; width].join(" ");
        with_row(&bvh, 0, &zeros)
    };
    let home = Home::with(rest);
    assert!(warnings(&facts(&home.inspect(&["--unit", "m"]))).contains("frame 0 is a rest pose"));
    refusal(&home.inspect(&["--unit", "m", "--strict"]));
    let settled = facts(&home.inspect(&["--unit", "m", "--strict", "--frames", "1..60"]));
    assert_eq!(settled["usable"], serde_json::json!({ "from": 1, "to": 60 }));
    refusal(&home.inspect(&["--frames", "60..1"]));
    refusal(&home.inspect(&["--frames", "1..9999"]));
    assert!(home.check("strict = true, unit = \"m\", frames = [1, 60]").status.success());
}

#[test]
fn generated_clips_are_asked_for_alike_everywhere() {
    let home = Home::with(|bvh| bvh);
    let scene = home.folder.path().join("asked.toml");
    let text_of =
        "[clips]\nrun = \"builtin:run,speed=3,turn=10\"\n[[character]]\nname = \"ann\"\ntrack = [\"run\"]\n";
    fs::write(&scene, text_of).expect("a temporary file");
    assert!(cotillion(&["check", text(&scene)]).status.success());
    facts(&cotillion(&["inspect", "--json", "builtin:run,speed=3,turn=10"]));
    let file = home.folder.path().join("run.bvh");
    assert!(cotillion(&["clips", "builtin:run,speed=3", "-o", text(&file)]).status.success());
    let error = refusal(&cotillion(&["inspect", "--json", "builtin:run,speed=nan"]));
    assert!(error["message"].as_str().expect("a message").contains("\"speed=nan\" is not PARAMETER=VALUE"));
}

#[test]
fn nothing_is_written_over_a_capture_or_under_a_wrong_name() {
    let home = Home::with(|bvh| bvh);
    let walk = home.walk();
    let before = fs::read(&walk).expect("the walk");
    refusal(&cotillion(&["convert", "--json", text(&walk), "-o", text(&walk)]));
    assert_eq!(fs::read(&walk).expect("the walk"), before);
    let wrong = home.folder.path().join("walk.txt");
    refusal(&cotillion(&["convert", "--json", text(&walk), "-o", text(&wrong)]));
    let picture = home.folder.path().join("walk.jpg");
    refusal(&cotillion(&["inspect", "--json", text(&walk), "--strip", text(&picture)]));
    assert!(!wrong.exists() && !picture.exists());
}

/// Bytes that reading an announcement may take, whatever it announces.
const MOST_FOR_AN_ANNOUNCEMENT: u64 = 32 << 20;

#[test]
fn announced_frames_cost_nothing() {
    for frames in ["99999999999", "4000000000"] {
        let text = format!(
            "HIERARCHY\nROOT a\n{{\nOFFSET 0 0 0\nCHANNELS 3 Xrotation Yrotation Zrotation\n}}\nMOTION\nFrames: {frames}\n\
             Frame Time: 0.01\n1 2 3\n"
        );
        let mut is_refused = false;
        let used = allocation_counter::measure(|| {
            is_refused = read(Capture::Bvh(text.as_bytes()), "huge", &ReadOptions::default()).is_err();
        });
        assert!(is_refused && used.bytes_max < MOST_FOR_AN_ANNOUNCEMENT, "{} bytes", used.bytes_max);
    }
}

#[test]
fn a_hundred_thousand_nested_joints_are_refused_by_a_stated_limit() {
    let mut text = "HIERARCHY\nROOT a\n{\nOFFSET 0 0 0\n".to_owned();
    for _ in 0..100_000 {
        text += "JOINT a\n{\nOFFSET 0 1 0\n";
    }
    let error = read(Capture::Bvh(text.as_bytes()), "deep", &ReadOptions::default()).expect_err("too deep");
    assert!(error.to_string().contains("more than 65536 joints"), "{error}");
}
