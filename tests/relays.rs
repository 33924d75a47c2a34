//! Relays: the same arguments give the same file, every curve gives a sound scene whose hand-overs are exact, what does not fit
//! says so, and groups mean what they would mean written out.

mod home;
mod performed;
#[path = "relays/written_out.rs"]
mod written_out;

use std::fs;
use std::path::Path;

use cotillion::constraint::{ConstraintKind, Target};
use cotillion::discrete::outcome::Outcome;
use cotillion::edit::Editor;
use cotillion::embody::embody;
use cotillion::export::report::{ConstraintReport, report};
use cotillion::geometry::c64;
use cotillion::path;
use cotillion::relay::{self, Along, Disturbance, Relay};
use cotillion::resample::resample;
use cotillion::scene::{ClipFolders, Loaded, Scene, load_text};
use home::{Home, cotillion, stderr, stdout, text};
use performed::performed;
use proptest::prelude::*;
use written_out::written_out;

/// Hands, boxes and people meet to this at the moment itself, metres.
const SPACE: f64 = 1e-3;
/// Moments that are one agree to this, seconds.
const TIME: f64 = 1e-9;

/// Frames of several strides at 30 a second: what ten metres take.
const STRIDES: i64 = 60;
/// The end's pin is soft, but nothing pulls against it, metres.
const REACHED: f64 = 0.05;

/// That of `scenes/relay_78.toml`.
fn spiral() -> Relay {
    Relay { characters: 78, boxes: 8, seed: 1, ..small() }
}

fn small() -> Relay {
    Relay { boxes: 2, seed: 4, along: Along::Spiral, ..Relay::of(12) }
}

fn written(relay: &Relay) -> String {
    relay::relay(relay, "a test").expect("the relay fits")
}

fn load(scene: &str) -> Loaded {
    load_text(scene, Path::new("relay.toml"), &ClipFolders::default()).expect("a sound scene")
}

#[test]
fn the_same_arguments_give_the_same_file_and_another_seed_another() {
    let small = small();
    assert_eq!(written(&small), written(&small));
    assert_ne!(written(&small), written(&Relay { seed: 5, ..small.clone() }));
    let arguments = ["relay", "-n", "24", "--boxes", "2", "--along", "circle"];
    let (once, again) = (cotillion(&arguments), cotillion(&arguments));
    assert!(once.status.success(), "{}", stderr(&once));
    assert_eq!(once.stdout, again.stdout);
}

#[test]
fn the_spiral_of_78_is_what_the_command_in_its_head_writes() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/relay_78.toml");
    let file = fs::read_to_string(path).expect("the scene is there");
    let command =
        file.lines().find_map(|line| line.strip_prefix("# Written by: cotillion ")).expect("its head says");
    let arguments: Vec<&str> = command.split(' ').collect();
    assert_eq!(stdout(&cotillion(&arguments)), file);
    assert_eq!(arguments[..5], ["relay", "--characters", "78", "--along", "spiral"]);
}

#[cfg(unix)]
#[test]
fn the_command_in_the_head_is_one_for_a_shell_whatever_the_file_is_called() {
    for name in ["a way; rm $HOME 'x' \"y\".csv", "#1 & 2.csv", "-x.csv", "plain.csv"] {
        let home = Home::with("");
        fs::write(home.path(name), "0,0\n30,0\n60,9\n").expect("room");
        let along = format!("--along={}", text(&home.path(name)));
        let written = stdout(&cotillion(&["relay", "-n", "12", &along]));
        let command = written.lines().find_map(|line| line.strip_prefix("# Written by: cotillion "));
        let script = format!("\"$COTILLION\" {}", command.expect("its head says"));
        let again = std::process::Command::new("sh")
            .args(["-c", &script])
            .env("COTILLION", env!("CARGO_BIN_EXE_cotillion"))
            .current_dir(home.path(name).parent().expect("a folder"))
            .output()
            .expect("a shell");
        assert_eq!(stdout(&again), written, "{name}: {}", stderr(&again));
    }
}

#[test]
fn neighbours_keep_what_chance_gave_them_when_others_come() {
    let (fewer, more) =
        (written(&small()), written(&Relay { characters: 16, disturbers: Some(4), ..small() }));
    let bodies = |scene: &str| {
        let scene = load(scene).scene;
        let carriers = scene.characters.into_iter().filter(|character| character.name.starts_with("carrier"));
        let mut all: Vec<(String, Option<String>)> = carriers
            .map(|carrier| (carrier.name, carrier.performed.into_iter().next().map(|clip| clip.body)))
            .collect();
        all.sort();
        all
    };
    let more = bodies(&more);
    assert!(bodies(&fewer).iter().all(|carrier| more.contains(carrier)));
}

#[test]
fn every_curve_gives_a_sound_scene_without_warnings() {
    let home = Home::with(&written(&small()));
    fs::write(home.path("bend.csv"), "x,y\n0,0\n24,0\n24,18\n").expect("room");
    let path = "<path d='M0 0 C9 9 20 -9 30 0 Q35 5 30 9 A9 9 0 0 0 9 9 L0 8'/>";
    let zig = "<polyline id='zig' points='0,0 9,3 18,0'/>";
    let svg = |inside: &str| format!("<svg xmlns='http://www.w3.org/2000/svg'>{inside}</svg>");
    fs::write(home.path("one.svg"), svg(path)).expect("room");
    fs::write(home.path("two.svg"), svg(&format!("{path}{zig}"))).expect("room");
    let (csv, svg) = (home.path("bend.csv"), home.path("one.svg"));
    let named = format!("{}#zig", text(&home.path("two.svg")));
    for along in ["line", "circle", "spiral", text(&csv), text(&svg), &named] {
        let scene = home.path("relay.toml");
        let output = cotillion(&["relay", "-n", "24", "--boxes", "2", "--along", along, "-o", text(&scene)]);
        assert!(output.status.success(), "{along}: {}", stderr(&output));
        let checked = cotillion(&["check", text(&scene)]);
        assert!(checked.status.success() && stderr(&checked).is_empty(), "{along}: {}", stderr(&checked));
    }
}

#[test]
fn there_is_a_box_for_every_ten_who_are_asked_for() {
    let home = Home::with("");
    for (characters, boxes) in [("2", "1 box,"), ("9", "1 box,"), ("78", "7 boxes"), ("1000", "100 boxes")] {
        let scene = home.path("relay.toml");
        let output = cotillion(&["relay", "-n", characters, "--along", "line", "-o", text(&scene)]);
        let told = String::from_utf8_lossy(&output.stdout).into_owned();
        assert!(output.status.success() && told.contains(boxes), "{characters}: {told} {}", stderr(&output));
    }
}

#[cfg(unix)]
#[test]
fn a_link_stays_and_what_is_no_file_is_not_replaced() {
    let home = Home::with("");
    let [link, target, folder] = ["link.toml", "target.toml", "folder.toml"].map(|name| home.path(name));
    fs::write(&target, "").expect("room");
    fs::create_dir(&folder).expect("room");
    std::os::unix::fs::symlink(&target, &link).expect("room");
    let output = cotillion(&["relay", "-n", "4", "-o", text(&link)]);
    assert!(output.status.success(), "{}", stderr(&output));
    assert!(fs::symlink_metadata(&link).expect("a link").is_symlink());
    assert!(fs::read_to_string(&target).expect("a scene").contains("title = "));
    let output = cotillion(&["relay", "-n", "4", "-o", text(&folder)]);
    assert!(!output.status.success() && stderr(&output).contains("is no file"), "{}", stderr(&output));
}

#[test]
fn what_does_not_fit_says_what_would_and_writes_nothing() {
    let home = Home::with("");
    fs::write(home.path("short.csv"), "0,0\n10,0\n").expect("room");
    fs::write(home.path("bad.csv"), "0,0\n1,zwei\n").expect("room");
    fs::write(home.path("bad.svg"), "<svg>\n<path d='M0 0 L'/></svg>").expect("room");
    fs::write(home.path("two.svg"), "<svg><path d='M0 0 9 9'/>\n<path d='M0 0 9 9'/></svg>").expect("room");
    let [short, bad, drawn, two, odd] =
        ["short.csv", "bad.csv", "bad.svg", "two.svg", "odd.png"].map(|name| home.path(name));
    let cases: [(&[&str], &str); 12] = [
        (&["-n", "1"], "2 to 100000 characters"),
        (&["-n", "12", "--boxes", "9"], "6 carriers hand on at least one box and at most 2"),
        (&["-n", "12", "--disturbers", "7"], "7 disturbers leave 5 carriers"),
        (&["-n", "12", "--spacing", "1"], "outside 3 to 60 m"),
        (&["-n", "12", "--heights", "tall"], "no range of heights"),
        (&["-n", "8", "--along", "circle"], "radius of 2.10 m"),
        (&["-n", "12", "--along", text(&short)], "are 1.667 m apart"),
        (&["-n", "12", "--along", text(&short), "--spacing", "4"], "need 24.00 m; it holds 2"),
        (&["-n", "12", "--along", text(&bad)], "bad.csv:2:3: error: \"zwei\" is no number"),
        (&["-n", "12", "--along", text(&drawn)], "bad.svg:2:1: error: the path cannot be read"),
        (&["-n", "12", "--along", text(&two)], "two.svg:2:1: error: this is the second curve"),
        (&["-n", "12", "--along", text(&odd)], "is no curve"),
    ];
    for (arguments, message) in cases {
        let scene = home.path("relay.toml");
        let output = cotillion(&[&["relay", "-o", text(&scene)], arguments].concat());
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        assert!(
            stderr(&output).contains(message) && stderr(&output).contains("help: "),
            "{}",
            stderr(&output)
        );
        assert!(!scene.exists(), "{arguments:?}");
    }
}

#[test]
fn every_hand_over_is_exact_in_space_and_time() {
    let Loaded { scene, warnings, .. } = load(&written(&small()));
    assert!(warnings.is_empty(), "{warnings:?}");
    let mut editor = Editor::new(scene).expect("a regular scene");
    editor.solve().expect("the constraints agree");
    assert_hand_overs_hold(&Outcome::plain(editor.into_parts()), (7, 5));
}

#[test]
fn bodies_of_all_heights_meet_exactly() {
    let Loaded { scene, .. } = load(&written(&Relay { heights: relay::HEIGHTS, ..spiral() }));
    let mut editor = Editor::new(scene).expect("a regular scene");
    editor.solve().expect("the constraints agree");
    assert_hand_overs_hold(&Outcome::plain(editor.into_parts()), (40 + 7, 39));
}

/// Hands are on boxes, takers stand before givers, and moments are one, on finished bodies. `carries`, `hand_overs`: how many
/// there are at least.
fn assert_hand_overs_hold(solved: &Outcome, (carries, hand_overs): (usize, usize)) {
    let mut motion = resample(&solved.scene, &solved.edit).expect("a short result");
    let bodies = embody(&solved.scene, &solved.edit, &mut motion);
    let told = report(&bodies, solved, &motion);
    let count = |wanted: &dyn Fn(&ConstraintReport) -> bool| {
        told.constraints.iter().filter(|one| wanted(one)).count()
    };
    assert!(count(&|one| one.kind == "carry") >= carries, "every box is carried");
    assert_eq!(count(&|one| one.name.starts_with("hand-over")), hand_overs);
    for one in &told.constraints {
        let held = ["before carrier", "behind carrier"].iter().any(|name| one.name.contains(name));
        let hard = one.kind == "carry" || one.kind == "end_effector" || held;
        let limit = if one.kind == "sync" || one.kind == "time" { TIME } else { SPACE };
        if hard || one.kind == "sync" {
            assert!(one.residual.abs() <= limit, "{}: {}", one.name, one.residual);
        }
    }
}

/// A scene dragged as its file says; its end after that.
fn dragged(scene: Scene) -> (Outcome, c64) {
    let outcome = performed(scene).expect("the drag ends");
    let end = outcome.scene.constraints.iter().find(|one| one.name == "the end").expect("the end is pinned");
    let moment = end.kind.moments()[0].clone();
    let who = moment.character.as_usize();
    let place = path::at(&outcome.edit.characters[who].positions, outcome.scene.frame_of(&moment));
    (outcome, place)
}

/// Working frames that came, and that went.
fn came_and_went(outcome: &Outcome) -> (i64, i64) {
    let sum = |came: bool| outcome.log.iter().map(|one| one.frames).filter(|own| (*own > 0) == came).sum();
    (sum(true), sum(false))
}

#[test]
fn the_end_of_the_spiral_of_78_dragged_by_ten_metres_adds_steps_and_keeps_every_hand_over() {
    let scene = load(&written(&Relay { discrete: true, drag: Some(10.0), ..spiral() })).scene;
    let Target::Position(to) = scene.drags[0].targets[0].1 else { panic!("a point") };
    let (outcome, end) = dragged(scene);
    let (came, _) = came_and_went(&outcome);
    assert!(came >= STRIDES, "{came} frames came");
    assert!((end - to).norm() < REACHED, "the end is {} m off", (end - to).norm());
    assert_hand_overs_hold(&outcome, (40 + 7, 39));
}

#[test]
fn an_edit_that_asks_for_nothing_changes_nothing() {
    /// Half a second of everybody's in all: beginnings and tracks fit each other to the frame.
    const ENERGY: f64 = 0.25;
    for along in [Along::Spiral, Along::Line, Along::Circle] {
        for seed in 1..=12 {
            let asked =
                Relay { characters: 40, boxes: 4, discrete: true, seed, along: along.clone(), ..small() };
            let (outcome, _) = dragged(load(&written(&asked)).scene);
            assert!(outcome.log.is_empty(), "{along:?}, seed {seed}: {:?}", outcome.log);
            let duration = outcome.edit.energy.duration;
            assert!(duration < ENERGY, "{along:?}, seed {seed}: {duration}");
        }
    }
}

#[test]
fn an_end_dragged_back_loses_steps_and_keeps_every_hand_over() {
    let asked = Relay {
        discrete: true,
        drag: Some(6.0),
        spacing: Some(12.0),
        boxes: 1,
        along: Along::Line,
        ..small()
    };
    let mut scene = load(&written(&asked)).scene;
    // Back, by as much as the file says on.
    let (id, Target::Position(on)) = scene.drags[0].targets[0] else { panic!("a point") };
    let ConstraintKind::Pin { position: Some(from), .. } = scene.constraints[id.as_usize()].kind else {
        panic!("a pin")
    };
    let back = from - (on - from);
    scene.drags[0].targets[0].1 = Target::Position(back);
    let (outcome, end) = dragged(scene);
    let (_, went) = came_and_went(&outcome);
    assert!(went <= -STRIDES, "{went} frames went");
    assert!((end - back).norm() < REACHED, "the end is {} m off", (end - back).norm());
    assert_hand_overs_hold(&outcome, (6, 5));
}

#[test]
fn groups_mean_what_they_would_mean_written_out() {
    let scene = written(&small());
    let long = written_out(&scene);
    assert!(!long.contains("[[group") && long.len() > scene.len());
    let (short, long) = (Home::with(&scene), Home::with(&long));
    for home in [&short, &long] {
        let output = home.run(&["--quiet"]);
        assert!(output.status.success(), "{}", stderr(&output));
    }
    let mut compared = 0;
    for entry in fs::read_dir(short.path("result")).expect("a result").flatten() {
        let name = entry.file_name().to_string_lossy().into_owned();
        // The report tells how long it took.
        if name != "report.json" {
            let bytes = |home: &Home| fs::read(home.path("result").join(&name)).expect("both have it");
            assert!(bytes(&short) == bytes(&long), "{name} differs");
            compared += 1;
        }
    }
    assert_eq!(compared, 12 + 2, "a motion each, the picture, the whole scene");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 16, ..ProptestConfig::default() })]

    /// Any arguments end in a sound scene without warnings, or in an error.
    #[test]
    fn any_arguments_give_a_sound_scene_or_an_error(
        (characters, boxes) in (0_usize..26, 0_usize..4),
        disturbers in prop::option::of(0_usize..14),
        spacing in prop::option::of(-1.0..9.0_f64),
        (short, tall) in (1.4..1.9_f64, 1.6..2.1_f64),
        phase in -0.2..1.2_f64,
        (seed, curve) in (any::<u64>(), 0_usize..5),
        how in prop::sample::subsequence(Disturbance::ALL.to_vec(), 0..=3),
        corners in prop::collection::vec((-30.0..30.0_f64, -30.0..30.0_f64), 0..5),
        (discrete, drag) in (any::<bool>(), prop::option::of(-1.0..20.0_f64)),
    ) {
        let points = corners.into_iter().map(|(x, y)| cotillion::geometry::c64::new(x, y)).collect();
        let along = match curve {
            0 => Along::Line,
            1 => Along::Circle,
            2 => Along::Spiral,
            3 => Along::Points(points),
            _ => Along::Drawing(points),
        };
        let asked = Relay {
            characters, disturbers, boxes, spacing, heights: (short, tall), phase, disturbances: how, discrete, drag,
            seed, along,
        };
        match relay::relay(&asked, "a test") {
            Ok(scene) => {
                let loaded = load_text(&scene, Path::new("relay.toml"), &ClipFolders::default());
                prop_assert!(loaded.is_ok(), "{}", loaded.expect_err("just seen"));
                let warnings = loaded.expect("just seen").warnings;
                prop_assert!(warnings.is_empty(), "{:?}", warnings);
            }
            Err(error) => prop_assert!(!error.to_string().is_empty() && !error.help().is_empty()),
        }
    }
}
