//! What `[physics]` in a scene promises: who is not edited stays as they are, hands stay on boxes and on each other, shards make the
//! same, schedules are done as written, and the report says what was done.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use cotillion::edit::{Edit, Editor, Moved};
use cotillion::embody::{Embodied, closed_groups, embody, embody_some};
use cotillion::export::bvh::to_bvh;
use cotillion::export::physics_report::{PhysicsReport, physics_report};
use cotillion::export::touch_up_report::{JudgedReport, TouchUpPart};
use cotillion::index::CharacterId;
use cotillion::object_motion::object_motions;
use cotillion::plausible::{NotTouched, TouchUps, embody_plausibly, make_plausible};
use cotillion::reach::{REACHED, Stage, carry_residuals, effector_residuals};
use cotillion::resample::{Resampled, resample, resample_some};
use cotillion::scene::{ClipFolders, Scene, load, load_text};
use cotillion::ties::Ties;
use serde_json::Value;

/// Somebody walks as generated, from half a second on.
const UNEDITED: &str = "
[clips]
walk = { builtin = \"walk\", seconds = 4 }
[[character]]
name = \"ann\"
track = [\"walk\"]
";

/// The same, round a bend.
const BEND: &str = "
[[pin]]
at = \"ann:start\"
position = [0.0, 0.0]
facing = 0.0
[[pin]]
at = \"ann:end\"
position = [2.7, 2.9]
facing = 90.0
";

const PHYSICS: &str = "\n[physics]\ntouch_up = true\n";

/// Generated walks are no measure of balance: on as long as it helps.
const ON: &str = "tolerance = 0.0\n";

fn scene(text: &str) -> Scene {
    load_text(text, Path::new("plausible.toml"), &ClipFolders::default()).expect("a sound scene").scene
}

/// A scene of `scenes/`, with `[physics]`.
fn shipped(name: &str) -> Scene {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(name);
    let text = fs::read_to_string(&path).expect("the scene is there");
    load_text(&format!("{text}{PHYSICS}"), &path, &ClipFolders::default()).expect("sound").scene
}

fn solved(scene: Scene) -> (Scene, Edit) {
    let mut editor = Editor::new(scene).expect("a regular scene");
    editor.solve().expect("the constraints agree");
    editor.into_parts()
}

/// Everybody with physics, where the scene wants it.
struct Finished {
    resampled: Resampled,
    touch_ups: TouchUps,
}

impl Finished {
    fn of(text: &str) -> Self {
        let (scene, edit) = solved(scene(text));
        let mut resampled = resample(&scene, &edit).expect("a result of usual length");
        let (_, touch_ups) = embody_plausibly(&scene, &edit, &mut resampled);
        Self { resampled, touch_ups }
    }

    fn bvh(&self) -> Vec<String> {
        self.resampled.clips.iter().map(to_bvh).collect()
    }

    /// What is told of the first one.
    fn told(&self) -> TouchUpPart {
        let first = CharacterId(0);
        match physics_report(&self.touch_ups[&first], &self.resampled.clips[0]) {
            PhysicsReport::Touched(told) => told.done,
            PhysicsReport::NotTouched { not_touched } => panic!("{not_touched}"),
        }
    }
}

fn mean(judged: &JudgedReport) -> f64 {
    judged.d.expect("somebody stands").mean
}

#[test]
fn who_is_not_edited_comes_out_as_without_physics_byte_for_byte() {
    let later = "[[time]]\nat = \"ann:start\"\nseconds = 0.517\n";
    for text in [UNEDITED.to_owned(), format!("{UNEDITED}{later}"), format!("fps = 24\n{UNEDITED}")] {
        let [without, with] = [&text, &format!("{text}{PHYSICS}")].map(|text| Finished::of(text).bvh());
        assert!(without == with, "{text}");
    }
    let [without, with] = [BEND.to_owned(), format!("{BEND}{PHYSICS}{ON}")]
        .map(|rest| Finished::of(&format!("{UNEDITED}{rest}")).bvh());
    assert!(without != with, "who is edited is touched up");
}

/// Millimetres would be a foot that slides.
const STANDS: f64 = 1e-9;

#[test]
fn a_bent_walk_comes_nearer_to_what_the_ground_can_bear_and_its_feet_stay() {
    let told = Finished::of(&format!("{UNEDITED}{BEND}{PHYSICS}{ON}")).told();
    assert!(mean(&told.ground.after) < mean(&told.ground.before));
    let [after, result] = [&told.ground.after, &told.result].map(mean);
    assert!(
        (after - result).abs() < STANDS,
        "without hands to bring back nothing comes after: {after} {result}"
    );
    assert!(told.ground.plants.largest_error < STANDS);
    assert!(told.largest_change.is_some() && told.ground.kept > 0);
}

/// By how much hands miss what they carry, and ends what they reach, metres.
fn misses(scene: &Scene, embodied: &Embodied<'_>) -> f64 {
    let (objects, ties) = (object_motions(scene, &embodied.moved), Ties::of(scene));
    let stage = Stage { scene, performance: &embodied.moved, objects: &objects, ties: &ties };
    let carries = carry_residuals(&stage, embodied).into_iter();
    let ends = effector_residuals(&stage, embodied).into_iter().map(|miss| miss.metres);
    carries.chain(ends).fold(0.0, f64::max)
}

#[test]
fn hands_stay_on_boxes_and_on_those_they_reach() {
    for name in ["hand_over.toml", "stacking.toml", "adventure.toml"] {
        let undragged = Scene { drags: Vec::new(), discrete: None, ..shipped(name) };
        let (scene, edit) = solved(undragged);
        let mut resampled = resample(&scene, &edit).expect("a result of usual length");
        let mut plain = resampled.clone();
        embody(&scene, &edit, &mut plain);
        let (embodied, touch_ups) = embody_plausibly(&scene, &edit, &mut resampled);
        assert_eq!(touch_ups.len(), scene.characters.len());
        assert!(plain != resampled, "{name}: somebody is touched up");
        let miss = misses(&scene, &embodied);
        assert!(miss < REACHED, "{name}: {miss} m");
    }
}

#[test]
fn groups_made_one_by_one_are_what_all_are_at_once() {
    let (scene, edit) = solved(Scene { drags: Vec::new(), discrete: None, ..shipped("adventure.toml") });
    let mut all = resample(&scene, &edit).expect("a result of usual length");
    embody_plausibly(&scene, &edit, &mut all);
    let moved = Moved { scene: &scene, characters: &edit.characters };
    let (objects, ties) = (object_motions(&scene, &moved), Ties::of(&scene));
    let stage = Stage { scene: &scene, performance: &moved, objects: &objects, ties: &ties };
    let groups = closed_groups(&scene, &ties);
    assert!(groups.len() > 1);
    for group in groups {
        let mut own = resample_some(&scene, &edit, &group).expect("short");
        let mut embodied = embody_some(&stage, &mut own);
        make_plausible(&stage, &mut embodied, &mut own);
        for (who, clip) in group.iter().zip(&own.clips) {
            assert!(all.clip(*who) == Some(clip), "{}", scene.characters[who.as_usize()].name);
        }
    }
}

/// That of the name "level", written out.
const LEVEL: &str = "schedule = [
    { turns = [\"lower\"], keeps = [\"upper\"], share = 0.5, width = 40, largest_turn = 28.64788975654116 },
    { turns = [\"upper\"], share = 0.3, width = 20, largest_turn = 28.64788975654116 },
    { turns = [\"arms\"], share = 0.2, width = 10, largest_turn = 8.594366926962348 },
]\n";

#[test]
fn a_schedule_of_ones_own_is_done_as_it_is_written() {
    let done = |schedule: &str| Finished::of(&format!("{UNEDITED}{BEND}{PHYSICS}{ON}rounds = 1\n{schedule}"));
    let (own, level, uphill) = (done(LEVEL), done("schedule = \"level\"\n"), done("schedule = \"uphill\"\n"));
    assert!(own.bvh() == level.bvh() && own.bvh() != uphill.bvh());
    let legs = done("schedule = [{ turns = [\"lower\"], keeps = [\"upper\"], width = 40 }]\n").told();
    assert_eq!((own.told().ground.steps.len(), legs.ground.steps.len()), (3, 1));
}

#[test]
fn only_those_who_are_named_are_touched_up() {
    let other = "[[character]]\nname = \"bob\"\ntrack = [\"walk\"]\nposition = [0.0, -3.0]\n";
    let bend = BEND.replace("ann", "bob");
    let text = format!("{UNEDITED}{other}{BEND}{bend}");
    let plain = Finished::of(&text);
    let done = Finished::of(&format!("{text}{PHYSICS}{ON}characters = [\"bob\"]\n"));
    assert_eq!(done.touch_ups.keys().copied().collect::<Vec<_>>(), [CharacterId(1)]);
    assert!(done.resampled.clips[0] == plain.resampled.clips[0]);
    assert!(done.resampled.clips[1] != plain.resampled.clips[1]);
}

#[test]
fn a_walk_that_is_slowed_down_is_compared_with_how_it_was_walked() {
    let slower = "[[duration]]\nfrom = \"ann:start\"\nto = \"ann:end\"\nseconds = 4.6\nstrength = \"hard\"\n";
    let [own, slowed] = ["", slower]
        .map(|rest| Finished::of(&format!("{UNEDITED}{rest}{PHYSICS}")).told().ground.source.expect("known"));
    assert_eq!(mean(&own).to_bits(), mean(&slowed).to_bits());
}

/// What a filter at 30 frames a second tells otherwise than one at the rate of the clip, metres.
const OTHER_RATE: f64 = 1e-3;

#[test]
fn a_clip_made_of_others_is_compared_with_them() {
    let [level, climb] = ["walk", "climb"].map(|track| {
        let clips = "climb = { from = \"walk\", tilt = 8 }\n[[character]]";
        let text = UNEDITED.replacen("[[character]]", clips, 1);
        let text = text.replace("track = [\"walk\"]", &format!("track = [\"{track}\"]"));
        Finished::of(&format!("{text}{PHYSICS}{ON}schedule = \"uphill\"\n")).told()
    });
    let source = |told: &TouchUpPart| mean(told.ground.source.as_ref().expect("known"));
    assert!((source(&level) - source(&climb)).abs() < OTHER_RATE);
    let miss = |judged: &JudgedReport| judged.miss.expect("carried over");
    assert!(miss(&level.ground.before) < STANDS, "a level walk is where it was");
    assert!(miss(&climb.ground.after) < 0.5 * miss(&climb.ground.before), "a climb leans forward");
}

#[test]
fn the_published_mode_works_on_polygons_in_one_round() {
    let text = format!("mode = \"paper\"\n{UNEDITED}{BEND}{PHYSICS}");
    let told = Finished::of(&text).told();
    assert_eq!(told.ground.steps.len(), 3);
    assert!(told.ground.before.miss.is_none());
}

#[test]
fn bodies_are_touched_up_where_the_full_body_is_off() {
    let text = format!("{UNEDITED}{BEND}{PHYSICS}{ON}[full_body]\nenabled = false\n");
    let done = Finished::of(&text);
    let told = done.told();
    assert!(mean(&told.result) < mean(&told.ground.before));
    let plain = Finished::of(&text.replace("touch_up = true", "touch_up = false"));
    assert!(plain.resampled.clips[0] != done.resampled.clips[0] && plain.touch_ups.is_empty());
}

#[test]
fn who_has_no_frames_to_accelerate_in_is_left_as_they_are_and_told_of() {
    let short = UNEDITED.replace("seconds = 4 }", "seconds = 4, frames = [0, 3] }");
    let done = Finished::of(&format!("fps = 10\n{short}{PHYSICS}"));
    assert!(matches!(done.touch_ups[&CharacterId(0)], Err(NotTouched::TooShort { .. })));
}

fn cotillion(arguments: &[&str], folder: &Path) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_cotillion"));
    command.args(arguments).current_dir(folder).output().expect("the program starts")
}

#[test]
fn run_tells_draws_and_refuses_to_draw_nothing() {
    let home = tempfile::tempdir().expect("a temporary folder");
    let text = format!("{UNEDITED}{BEND}");
    fs::write(home.path().join("plain.toml"), &text).expect("a file");
    fs::write(home.path().join("touched.toml"), format!("{text}{PHYSICS}{ON}")).expect("a file");
    let done = cotillion(&["run", "touched.toml", "-o", "out", "--plots"], home.path());
    let said = String::from_utf8_lossy(&done.stdout).into_owned();
    assert!(done.status.success() && said.contains("zero moment point to polygon"), "{said}");
    let curves = fs::read_to_string(home.path().join("out/ann.curves.svg")).expect("curves");
    assert!(curves.starts_with("<svg") && !curves.contains("NaN"));
    let report = fs::read_to_string(home.path().join("out/report.json")).expect("a report");
    let report: Value = serde_json::from_str(&report).expect("JSON");
    assert!(report["timing_ms"]["physics"].as_f64().is_some_and(|ms| ms > 0.0));
    let told = &report["characters"][0]["physics"];
    for key in ["source", "before", "after"] {
        assert!(told["ground"][key]["d_6hz"]["mean"].is_number(), "{key}: {told}");
    }
    assert!(told["result"]["d"]["mean"].is_number() && told["largest_change"]["joint"].is_string());
    let refused = cotillion(&["run", "plain.toml", "-o", "none", "--plots"], home.path());
    let said = String::from_utf8_lossy(&refused.stderr).into_owned();
    assert!(refused.status.code() == Some(2) && said.contains("[physics]"), "{said}");
    assert!(!home.path().join("none").exists());
}

/// Hips are held to this, metres; facings to this, degrees.
const HELD: [f64; 2] = [1e-9, 1e-6];

/// Between frames too: 0.8 s is none of them.
#[test]
fn hard_constraints_hold_the_hips_of_who_leans() {
    let home = tempfile::tempdir().expect("a temporary folder");
    let hard = BEND.replace("[[pin]]", "[[pin]]\nstrength = \"hard\"");
    let middle = "[[pin]]\nat = \"ann:24\"\nposition = [1.0, 0.2]\nfacing = 20.0\nstrength = \"hard\"\n";
    let text = format!("fps = 24\n{UNEDITED}{hard}{middle}{PHYSICS}{ON}");
    fs::write(home.path().join("held.toml"), text).expect("a file");
    let done = cotillion(&["run", "held.toml", "-o", "out", "--json"], home.path());
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    let report: Value = serde_json::from_slice(&done.stdout).expect("JSON");
    let told = &report["characters"][0]["physics"];
    assert!(told["ground"]["root_shift"].as_f64().is_some_and(|shift| shift > 1e-3), "{told}");
    for constraint in report["constraints"].as_array().expect("a list") {
        let off = ["residual", "facing_residual"].map(|key| constraint[key].as_f64().expect("held"));
        assert!(off[0] < HELD[0] && off[1] < HELD[1], "{constraint}");
    }
    let [ground, result] = [&told["ground"]["after"], &told["result"]].map(|own| own["d"]["mean"].as_f64());
    let before = told["ground"]["before"]["d"]["mean"].as_f64();
    assert!(ground < before && result < before, "{before:?} {ground:?} {result:?}");
}

/// So many are written in parts.
const CROWD: usize = 204;

#[test]
fn shards_of_a_crowd_merge_into_one_run() {
    let home = tempfile::tempdir().expect("a temporary folder");
    let mut text = "[clips]\nwalk = { builtin = \"walk\", seconds = 1.2 }\n".to_owned();
    for who in 0..CROWD {
        let side = if who % 2 == 0 { 0.5 } else { -0.5 };
        write!(
            text,
            "[[character]]\nname = \"c{who}\"\ntrack = [\"walk\"]\nposition = [0.0, {who}.0]\nfacing = 0.0\n\
             [[pin]]\nat = \"c{who}:start\"\nposition = [0.0, {who}.0]\nfacing = 0.0\n\
             [[pin]]\nat = \"c{who}:end\"\nposition = [1.2, {}]\n",
            who as f64 + side
        )
        .expect("text");
    }
    fs::write(home.path().join("crowd.toml"), format!("{text}{PHYSICS}tolerance = 0.0\n")).expect("a file");
    let run = |arguments: &[&str]| {
        let all: Vec<&str> = ["run", "crowd.toml", "--bvh-files"].iter().chain(arguments).copied().collect();
        let done = cotillion(&all, home.path());
        assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
        String::from_utf8_lossy(&done.stdout).into_owned()
    };
    let said = run(&["-o", "whole"]);
    assert!(said.contains("204 characters touched up"), "{said}");
    run(&["-o", "one", "--shard", "1/2", "--quiet"]);
    run(&["-o", "two", "--shard", "2/2", "--quiet"]);
    let merged = cotillion(&["merge", "one", "two", "-o", "merged"], home.path());
    assert!(merged.status.success(), "{}", String::from_utf8_lossy(&merged.stderr));
    for entry in fs::read_dir(home.path().join("whole")).expect("a folder").flatten() {
        let (own, theirs) = (entry.path(), home.path().join("merged").join(entry.file_name()));
        let [own, theirs] = [own, theirs].map(|path| fs::read(path).expect("a file"));
        if entry.file_name() == "report.json" {
            let untimed = |bytes: &[u8]| {
                let mut report: Value = serde_json::from_slice(bytes).expect("JSON");
                report["timing_ms"] = Value::Null;
                report["files"] = Value::Null;
                report
            };
            assert!(untimed(&own) == untimed(&theirs));
        } else {
            assert!(own == theirs, "{}", entry.path().display());
        }
    }
}

#[test]
fn the_scenes_of_the_published_experiments_are_sound() {
    for name in ["walk_to_jog", "curved_walk", "uphill", "curved_jump"] {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("scenes/{name}.toml"));
        let loaded = load(&path, &ClipFolders::default()).expect("a sound scene");
        assert!(loaded.scene.physics.is_some() && loaded.warnings.is_empty());
    }
}
