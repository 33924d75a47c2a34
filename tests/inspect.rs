//! What `cotillion inspect`, `cotillion convert` and their pictures promise.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};
use std::sync::Arc;

use cotillion::clip::Clip;
use cotillion::clip::builtin::generate;
use cotillion::clip::read::{Capture, ReadOptions, Up, read};
use cotillion::clip::working::WorkingClip;
use cotillion::export::picture::{
    Company, StripOptions, StripThing, StripTie, StripView, clip_svg, graph_svg, strip_svg, to_png,
};
use cotillion::graph::facts::transition_facts;
use cotillion::graph::{GraphSettings, motion_graph};
use cotillion::object::ObjectPose;
use serde_json::Value;

fn cotillion(arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_cotillion"));
    command.args(arguments).env_remove("COTILLION_MOCAP").env("NO_COLOR", "1");
    command.env("XDG_CACHE_HOME", env!("CARGO_TARGET_TMPDIR"));
    command.output().expect("the program starts")
}

fn said(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

fn text(path: &Path) -> &str {
    path.to_str().expect("temporary paths are UTF-8")
}

fn names_in(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).expect("readable").flatten();
    let mut names: Vec<String> =
        entries.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

/// Bodies of which little or nothing is known: one joint, a chain without names, one frame, no extent at all, far too much.
const ODD: [&str; 5] = [
    "HIERARCHY\nROOT a\n{\nOFFSET 0 0 0\nCHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation\n\
     End Site\n{\nOFFSET 0 1 0\n}\n}\nMOTION\nFrames: 3\nFrame Time: 0.0333333\n\
     0 0 0 0 0 0\n1 0 0 9 9 9\n2 0 0 0 0 0\n",
    "HIERARCHY\nROOT a\n{\nOFFSET 0 0 0\nCHANNELS 3 Zrotation Xrotation Yrotation\nJOINT b\n{\nOFFSET 0 0 0\n\
     CHANNELS 3 Zrotation Xrotation Yrotation\nEnd Site\n{\nOFFSET 0 0 0\n}\n}\n}\nMOTION\nFrames: 2\n\
     Frame Time: 0.0333333\n0 0 0 0 0 0\n0 0 0 90 0 0\n",
    "HIERARCHY\nROOT Hips\n{\nOFFSET 0 0 0\nCHANNELS 3 Xposition Yposition Zposition\nEnd Site\n{\nOFFSET 0 1 0\n}\n}\n\
     MOTION\nFrames: 1\nFrame Time: 0.0333333\n1e5 -3 7\n",
    "HIERARCHY\nROOT Hips\n{\nOFFSET 0 0 0\nCHANNELS 3 Xposition Yposition Zposition\nJOINT LeftUpLeg\n{\nOFFSET 0 0 0\n\
     CHANNELS 1 Xrotation\nEnd Site\n{\nOFFSET 0 0 0\n}\n}\nJOINT RightUpLeg\n{\nOFFSET 0 0 0\nCHANNELS 1 Xrotation\n\
     End Site\n{\nOFFSET 0 0 0\n}\n}\n}\nMOTION\nFrames: 2\nFrame Time: 0.01\n0 0 0 0 0\n0 9 0 9 9\n",
    "HIERARCHY\nROOT Hips\n{\nOFFSET 0 0 0\nCHANNELS 3 Xposition Yposition Zposition\nJOINT LeftUpLeg\n{\nOFFSET 1e8 0 0\n\
     CHANNELS 1 Xrotation\nJOINT LeftFoot\n{\nOFFSET 0 -9e8 0\nCHANNELS 1 Xrotation\nEnd Site\n{\nOFFSET 0 0 0\n}\n}\n}\n}\n\
     MOTION\nFrames: 3\nFrame Time: 0.01\n0 0 0 0 0\n1e9 9 0 9 9\n0 -1e9 0 0 0\n",
];

const VIEWS: [StripView; 4] = [StripView::Side, StripView::Front, StripView::Above, StripView::ThreeQuarter];

fn assert_sound(svg: &str) {
    assert!(!svg.contains("NaN") && !svg.contains("inf\""), "numbers are finite");
    assert!(to_png(svg, 300).is_ok_and(|bytes| !bytes.is_empty()), "it is a picture");
}

#[test]
fn every_clip_has_pictures_however_odd_it_is() {
    for (index, text) in ODD.iter().enumerate() {
        let options = ReadOptions { unit_to_m: Some(1.0), up: Some(Up::Y), ..ReadOptions::default() };
        let clip = read(Capture::Bvh(text.as_bytes()), "odd", &options)
            .unwrap_or_else(|error| panic!("{index}: {error}"))
            .clip;
        assert_sound(&clip_svg(&clip));
        let (first, last) = clip.usable;
        let working = Arc::new(WorkingClip::new("odd", Arc::new(clip.clone()), first, last));
        let graph = motion_graph(std::slice::from_ref(&working), &GraphSettings::default());
        assert_sound(&graph_svg(&working, &graph, 0));
        assert!(transition_facts(&graph, 0, &working).per_second.is_finite());
        for view in VIEWS {
            assert_sound(&strip_svg(&clip, &Company::default(), &StripOptions { poses: 5, view }));
        }
    }
}

#[test]
fn equal_clips_have_equal_pictures() {
    let walk = || generate("walk", &BTreeMap::new()).expect("a generated clip");
    assert_eq!(clip_svg(&walk()), clip_svg(&walk()));
    for view in VIEWS {
        let options = StripOptions { poses: 7, view };
        let svg = strip_svg(&walk(), &Company::default(), &options);
        assert_eq!(svg, strip_svg(&walk(), &Company::default(), &options));
        assert_eq!(svg.matches("<title>frame ").count(), 7);
    }
}

#[test]
fn a_strip_names_the_events_it_shows() {
    let slap = generate("slap", &BTreeMap::new()).expect("a generated clip");
    let svg = strip_svg(&slap, &Company::default(), &StripOptions::default());
    assert!(svg.contains(">hit</text>"));
    assert!(svg.contains(&format!(">{}</text>", slap.events["hit"].0)));
    assert!(clip_svg(&slap).contains(">hit</text>"));
}

#[test]
fn one_clip_goes_to_a_file_and_several_to_a_folder() {
    let home = tempfile::tempdir().expect("a temporary folder");
    let (svg, png) = (home.path().join("walk.svg"), home.path().join("walk.png"));
    let output = cotillion(&[
        "inspect",
        "builtin:walk,speed=1.5",
        "--picture",
        text(&svg),
        "--strip",
        text(&png),
        "--view",
        "front",
    ]);
    assert_eq!(output.status.code(), Some(0), "{}", said(&output.stderr));
    assert!(fs::read_to_string(&svg).is_ok_and(|svg| svg.starts_with("<svg")));
    assert!(fs::read(&png).is_ok_and(|png| png.starts_with(b"\x89PNG")));
    let folder = home.path().join("pictures/all");
    let output = cotillion(&[
        "inspect",
        "builtin:walk",
        "builtin:idle",
        "builtin:walk,speed=1",
        "--strip",
        text(&folder),
        "-q",
    ]);
    assert_eq!(
        (output.status.code(), said(&output.stdout)),
        (Some(0), String::new()),
        "{}",
        said(&output.stderr)
    );
    assert_eq!(names_in(&folder), ["idle.strip.png", "walk-2.strip.png", "walk.strip.png"]);
    let output = cotillion(&["inspect", "builtin:walk", "builtin:idle", "--strip", text(&png)]);
    assert_eq!(output.status.code(), Some(2));
    assert!(said(&output.stderr).contains("help: name a folder"), "{}", said(&output.stderr));
}

#[test]
fn pictures_leave_the_json_alone() {
    let home = tempfile::tempdir().expect("a temporary folder");
    let file = home.path().join("slap.svg");
    let output = cotillion(&["inspect", "builtin:slap", "--json", "--picture", text(&file)]);
    let facts: Value = serde_json::from_slice(&output.stdout).expect("JSON and nothing else");
    assert_eq!(facts[0]["events"][0]["name"], "hit");
    assert_eq!(facts[0]["feet"][1]["foot"], "right");
    assert!(facts[0]["displacement"].is_f64() && facts[0]["turn_deg"].is_f64());
    assert_eq!(facts[0]["missing_roles"].as_array().map(Vec::len), Some(0));
    assert!(file.exists());
}

#[test]
fn transitions_are_told_drawn_and_kept_unless_forbidden() {
    let home = tempfile::tempdir().expect("a temporary folder");
    let (file, cache) = (home.path().join("walk.svg"), home.path().join("cache"));
    let inspect = |more: &[&str]| {
        let output = cotillion(&[&["inspect", "builtin:walk,seconds=8"], more].concat());
        assert_eq!(output.status.code(), Some(0), "{}", said(&output.stderr));
        output
    };
    let output = inspect(&["--json", "--no-cache", "--graph", text(&file)]);
    let facts: Value = serde_json::from_slice(&output.stdout).expect("JSON and nothing else");
    let transitions = &facts[0]["transitions"];
    assert!(transitions["per_second"].as_f64().is_some_and(|count| count > 2.0), "{transitions}");
    assert_eq!((transitions["whole_cycles"].as_f64(), transitions["without"].as_u64()), (Some(1.0), Some(0)));
    assert!(fs::read_to_string(&file).is_ok_and(|svg| svg.contains("pairs, 0.3 to 2 s")));
    let first = inspect(&["--cache", text(&cache)]);
    assert!(said(&first.stdout).contains("\n  transitions "), "{}", said(&first.stdout));
    let [name] = &names_in(&cache)[..] else { panic!("one graph is kept") };
    fs::write(cache.join(name), "spoiled").expect("a file");
    let second = inspect(&["--cache", text(&cache)]);
    assert_eq!(first.stdout, second.stdout);
    let (noted, silent) = (said(&second.stderr), said(&inspect(&["--cache", text(&cache)]).stderr));
    assert!(
        noted.starts_with("note: ") && noted.contains("discarded") && silent.is_empty(),
        "{noted} {silent}"
    );
}

#[test]
fn a_stated_contact_is_told_and_drawn() {
    let home = tempfile::tempdir().expect("a temporary folder");
    let (picture, strip) = (home.path().join("p.svg"), home.path().join("s.svg"));
    let arguments =
        ["inspect", "builtin:idle", "--contact", "left_hand=6..9", "--contact", "RightHand=20..30"];
    let told = cotillion(&arguments);
    assert!(said(&told.stdout).contains("left hand   bears, as stated: 6–9"), "{}", said(&told.stdout));
    let drawing = ["--json", "--picture", text(&picture), "--strip", text(&strip)];
    let output = cotillion(&[&arguments[..], &drawing].concat());
    let facts: Value = serde_json::from_slice(&output.stdout).expect("JSON and nothing else");
    let contacts = facts[0]["contacts"].as_array().expect("a list");
    let of_hand = |name: &str| contacts.iter().filter(|contact| contact["joint"] == name).collect::<Vec<_>>();
    assert_eq!((&of_hand("LeftHand")[0]["from"], &of_hand("LeftHand")[0]["to"]), (&6.into(), &9.into()));
    assert_eq!((&of_hand("RightHand")[0]["from"], &of_hand("RightHand")[0]["to"]), (&20.into(), &30.into()));
    assert!(contacts.iter().all(|contact| contact["ground"].is_null()), "idle stands on the floor");
    let rings = |svg: String| svg.matches("<title>hand</title>").count();
    assert_eq!(rings(fs::read_to_string(&picture).expect("written")), 2);
    // Without a hand that bears, the strip has fewer dots.
    let plain = home.path().join("plain.svg");
    assert_eq!(cotillion(&["inspect", "builtin:idle", "-q", "--strip", text(&plain)]).status.code(), Some(0));
    let dots = |path: &Path| fs::read_to_string(path).expect("written").matches("<circle").count();
    assert!(dots(&strip) > dots(&plain));
}

#[test]
fn a_wrong_contact_ends_with_exit_code_2() {
    for wrong in
        ["left_hand", "left_hand=6", "left_hand=9..6", "left_hand=6..9999", "left_knee=6..9", "fist=6..9"]
    {
        let output = cotillion(&["inspect", "builtin:idle", "--contact", wrong]);
        assert_eq!(output.status.code(), Some(2), "{wrong}");
        assert!(said(&output.stderr).contains("--contact"), "{}", said(&output.stderr));
    }
    let twice = ["inspect", "builtin:idle", "--contact", "left_hand=6..9", "--contact", "left_hand=9..12"];
    assert!(said(&cotillion(&twice).stderr).contains("overlap"));
}

#[test]
fn wrong_options_end_with_exit_code_2_and_write_nothing() {
    let home = tempfile::tempdir().expect("a temporary folder");
    let file = home.path().join("x.bvh");
    let wrong = [
        &["--bvh-unit", "ell"][..],
        &["--bvh-unit", "1e9"],
        &["--bvh-rate", "0"],
        &["--bvh-rate", "nan"],
        &["--bvh-order", "xxy"],
        &["--bvh-names", "ours"],
    ];
    for options in wrong {
        let mut arguments = vec!["convert", "builtin:idle", "-o", text(&file)];
        arguments.extend(options);
        let output = cotillion(&arguments);
        assert_eq!(output.status.code(), Some(2), "{options:?}");
        assert!(!output.stderr.is_empty() && !file.exists(), "{options:?}");
    }
    for options in [&["--poses", "0"][..], &["--view", "front"]] {
        let mut arguments = vec!["inspect", "builtin:idle"];
        arguments.extend(options);
        assert_eq!(cotillion(&arguments).status.code(), Some(2), "{options:?}");
    }
}

#[test]
fn a_clip_is_converted_to_the_rate_unit_order_and_names_asked_for() {
    let home = tempfile::tempdir().expect("a temporary folder");
    let (first, second) = (home.path().join("a.bvh"), home.path().join("b.bvh"));
    let options =
        ["--bvh-unit", "cm", "--bvh-rate", "60", "--bvh-order", "YXZ", "--bvh-names", "mixamo", "--quiet"];
    let convert = |from: &str, to: &Path, more: &[&str]| {
        let mut arguments = vec!["convert", from, "-o", text(to)];
        arguments.extend(more);
        let output = cotillion(&arguments);
        assert_eq!(output.status.code(), Some(0), "{}", said(&output.stderr));
    };
    convert("builtin:walk,speed=1.4", &first, &options);
    let written = fs::read_to_string(&first).expect("written");
    assert!(written.contains("ROOT mixamorig:Hips") && written.contains("Frame Time: 0.01666"));
    assert!(
        written.contains("CHANNELS 3 Yrotation Xrotation Zrotation")
            && !written.contains("Zrotation Xrotation")
    );
    // Back again, it is the generated clip to the rounding of the first file.
    convert(
        text(&first),
        &second,
        &["--unit", "cm", "--bvh-order", "zxy", "--bvh-names", "cmu", "--bvh-rate", "30"],
    );
    let height = |file: &str| {
        let facts = cotillion(&["inspect", "--json", "--unit", "m", file]);
        let facts: Value = serde_json::from_slice(&facts.stdout).expect("JSON");
        [facts[0]["root_path"].as_f64(), facts[0]["height"].as_f64()].map(|number| number.expect("a number"))
    };
    for (a, b) in height(text(&second)).into_iter().zip(height("builtin:walk,speed=1.4")) {
        assert!((a - b).abs() < 1e-6, "{a} {b}");
    }
}

#[test]
fn a_run_writes_bvh_files_as_asked() {
    let home = tempfile::tempdir().expect("a temporary folder");
    let (scene, result) = (home.path().join("scene.toml"), home.path().join("result"));
    let of_one = "[clips]\nidle = \"builtin:idle\"\n[[character]]\nname = \"ann\"\ntrack = [\"idle\"]\n";
    fs::write(&scene, of_one).expect("a scene file");
    let output = cotillion(&[
        "run",
        text(&scene),
        "-o",
        text(&result),
        "-q",
        "--bvh-names",
        "mixamo",
        "--bvh-unit",
        "cm",
    ]);
    assert_eq!(output.status.code(), Some(0), "{}", said(&output.stderr));
    let written = fs::read_to_string(result.join("ann.bvh")).expect("written");
    assert!(
        written.contains("JOINT mixamorig:LeftUpLeg\n") && written.contains("OFFSET 9.0"),
        "{written:.2000}"
    );
    let refused = home.path().join("refused");
    let output = cotillion(&["run", text(&scene), "-o", text(&refused), "--bvh-unit", "-1"]);
    assert_eq!((output.status.code(), refused.exists()), (Some(2), false));
}

#[test]
fn boxes_and_partners_are_drawn_with_who_is_near_them() {
    let clip = generate("walk", &BTreeMap::new()).expect("a generated clip");
    let poses = |svg: &str| svg.matches("<title>frame").count();
    let parts = |svg: &str| svg.matches("<linearGradient").count();
    let with = |ahead: f64, partners: &[&Clip]| {
        let at = clip.root_positions[0].with_y(0.0) + glam::DVec3::new(0.0, 0.0, ahead);
        let poses = vec![ObjectPose { position: at, facing: 0.0 }];
        let thing = StripThing { size: [0.3; 3], poses, carriers: Vec::new() };
        strip_svg(
            &clip,
            &Company { things: &[thing], partners, ..Company::default() },
            &StripOptions::default(),
        )
    };
    let alone = strip_svg(&clip, &Company::default(), &StripOptions::default());
    assert_eq!(with(1000.0, &[]), alone);
    let near = with(0.5, &[]);
    assert_sound(&near);
    let more = parts(&near) - parts(&alone);
    assert!(
        more > 0 && more.is_multiple_of(6) && more < 6 * poses(&alone),
        "six faces where it is near: {more}"
    );
    let accompanied = with(1000.0, &[&clip]);
    assert_sound(&accompanied);
    assert_eq!(parts(&accompanied), 2 * parts(&alone));
}

/// Two metres off is too far to be drawn beside every pose, but not where something ties the two.
#[test]
fn partners_who_are_tied_to_a_body_are_drawn_at_that_time() {
    let clip = generate("walk", &BTreeMap::new()).expect("a generated clip");
    let mut away = clip.clone();
    away.root_positions.iter_mut().for_each(|root| root.z += 2.0);
    let parts = |ties: &[StripTie]| {
        let company = Company { partners: &[&clip, &away], own: Some(0), ties, ..Company::default() };
        let svg = strip_svg(&clip, &company, &StripOptions::default());
        svg.matches("<linearGradient").count()
    };
    let alone = parts(&[]);
    assert_eq!(alone, parts(&[StripTie { partner: 0, first: clip.usable.0, last: clip.usable.1 }]));
    let (first, last) = clip.usable;
    assert_eq!(parts(&[StripTie { partner: 1, first, last }]), 2 * alone);
    let once = parts(&[StripTie { partner: 1, first, last: first }]);
    assert!(alone < once && once < alone + alone / 6, "at one of twelve poses: {alone} and {once}");
}

/// A box half a metre ahead whose carrier stands two metres off: nobody sees a box in the air.
#[test]
fn who_carries_a_box_is_drawn_with_it() {
    let clip = generate("idle", &BTreeMap::new()).expect("a generated clip");
    let mut away = clip.clone();
    away.root_positions.iter_mut().for_each(|root| root.z += 2.0);
    let (first, last) = clip.usable;
    let with = |carriers: Vec<StripTie>| {
        let at = clip.root_positions[0].with_y(1.0) + glam::DVec3::new(0.0, 0.0, 0.5);
        let poses = vec![ObjectPose { position: at, facing: 0.0 }];
        let things = [StripThing { size: [0.3; 3], poses, carriers }];
        let partners = [&clip, &away];
        let company = Company { things: &things, partners: &partners, own: Some(0), ties: &[] };
        strip_svg(&clip, &company, &StripOptions::default()).matches("<linearGradient").count()
    };
    let bodies = strip_svg(&clip, &Company::default(), &StripOptions::default());
    let bodies = bodies.matches("<linearGradient").count();
    assert_eq!(with(vec![StripTie { partner: 1, first, last }]), with(Vec::new()) + bodies);
}
