//! Reads scene files: syntax, then structure, then meaning; each only if the one before is right.

use std::fs;
use std::path::Path;

use toml::de::{DeTable, DeValue};

use crate::scene::Scene;
use crate::scene::check;
use crate::scene::clips::ClipFolders;
use crate::scene::diagnostic::{Diagnostic, SceneFaults};
use crate::scene::group;
use crate::scene::raw;
use crate::scene::report::{Lines, Place, Report};
use crate::scene::tree::{Node, Read};

/// A scene, and what its author should know about it.
#[derive(Clone, Debug, PartialEq)]
pub struct Loaded {
    /// The scene.
    pub scene: Scene,
    /// In the order of the file.
    pub warnings: Vec<Diagnostic>,
    /// What the file says.
    pub text: String,
}

/// Reads the scene file at `path` and all its clips.
///
/// # Errors
/// [`SceneFaults`] with everything that is wrong with the file.
pub fn load(path: &Path, folders: &ClipFolders) -> Result<Loaded, SceneFaults> {
    let is_file = fs::metadata(path).map(|kind| kind.is_file());
    let text = match is_file {
        Ok(false) => Err("it is not a file".to_owned()),
        Ok(true) => fs::read(path).map_err(|error| error.to_string()),
        Err(error) => Err(error.to_string()),
    };
    let mut report = Report::default();
    match text.map(String::from_utf8) {
        Ok(Ok(text)) => load_text(&text, path, folders),
        Ok(Err(error)) => {
            let at = error.utf8_error().valid_up_to();
            let text = String::from_utf8_lossy(error.as_bytes()).into_owned();
            let place = Place { span: at..at + 1, field: String::new() };
            report.fault(&place, "the file is not UTF-8 from here on", "save it as UTF-8 text");
            Err(faults(report, path, &text))
        }
        Err(reason) => {
            let message = format!("cannot read the scene file: {reason}");
            report.fault(&Place::default(), message, "name a scene file that can be read");
            Err(faults(report, path, ""))
        }
    }
}

/// Reads the scene that `text` describes; clip files are looked for beside `path`.
///
/// # Errors
/// [`SceneFaults`] with everything that is wrong with the text.
pub fn load_text(text: &str, path: &Path, folders: &ClipFolders) -> Result<Loaded, SceneFaults> {
    let mut report = Report::default();
    let (table, errors) = DeTable::parse_recoverable(text);
    // Later syntax errors are mostly echoes of the first.
    if let Some(error) = errors.first() {
        let span = error.span().unwrap_or(0..0);
        let message = format!("not TOML: {}", error.message());
        let help = "mend this first; everything else is checked once the file is TOML";
        report.fault(&Place { span, field: String::new() }, message, help);
        return Err(faults(report, path, text));
    }
    let mut table = table.into_inner();
    let groups = group::groups(&mut table, &mut report);
    let reckoned = group::reckoned(&groups);
    let table = DeValue::Table(group::expanded(table, &groups, &reckoned, &mut report));
    if report.has_faults() {
        return Err(faults(report, path, text));
    }
    let node = Node { value: &table, place: Place::default() };
    let raw = raw::Scene::read(&node, &mut report).expect("a document is a table");
    let scene = check::check(&raw, path, &Lines::of(text), folders, &mut report);
    debug_assert!(
        report.has_faults() || scene.characters.len() == raw.character.tables().len(),
        "whoever is left out of the scene has a fault"
    );
    if report.has_faults() {
        return Err(faults(report, path, text));
    }
    let (_, warnings) = report.finish(&path.display().to_string(), text);
    Ok(Loaded { scene, warnings, text: text.to_owned() })
}

fn faults(report: Report, path: &Path, text: &str) -> SceneFaults {
    let file = path.display().to_string();
    let (faults, _) = report.finish(&file, text);
    SceneFaults { faults, text: text.to_owned(), file }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::constraint::{ConstraintKind, Instant, Partner, Relation, Strength, When};
    use crate::geometry::c64;
    use crate::scene::diagnostic::Rendering;

    /// A sound scene on generated clips, with every kind of constraint.
    const SOUND: &str = r#"
[clips]
walk = { builtin = "walk", events = { wave = 12 } }
slap = "builtin:slap"

[[character]]
name = "ann"
track = ["walk", "slap"]
position = [-3.0, 1.0]
facing = 90

[[character]]
name = "bob"
track = ["walk", "slap", "walk"]

[[object]]
name = "box"
size = [0.4, 0.3, 0.3]
position = [0.0, 2.0]

[[sync]]
moments = ["ann/slap:hit", "bob/slap:hit"]

[[pin]]
name = "corner"
at = "ann:wave"
position = [1.0, -2.0]
facing = -90.0
strength = "hard"

[[relative]]
at = "bob/slap:hit"
to = "ann/slap:hit"
offset = [0.9, 0.1]
facing = "rest"
strength = 2.5

[[relative]]
during = ["bob/walk#2:5", "bob:end"]
to = "box"
offset = "free"
facing = 180

[[duration]]
from = "ann/slap:start"
to = "ann/slap:end"
seconds = 2.5

[warp]
min_step = 0.5
"#;

    fn load(text: &str) -> Result<Loaded, SceneFaults> {
        load_text(text, Path::new("meet.toml"), &ClipFolders::default())
    }

    /// Warnings of a sound scene but for seams, which are up to the generated clips.
    fn warnings(text: &str) -> Vec<String> {
        let loaded = load(text).expect("the scene is sound");
        let messages = loaded.warnings.into_iter().map(|warning| warning.message);
        messages.filter(|message| !message.contains("unlike poses")).collect()
    }

    #[test]
    fn a_sound_scene_comes_out_in_radians_and_plan_points() {
        let scene = load(SOUND).expect("the scene is sound").scene;
        assert_eq!((scene.title.as_str(), scene.fps), ("meet", 30.0));
        assert_eq!(scene.warp.min_step, Some(0.5));
        assert_eq!(scene.objects[0].course.pose_at(0.0).plan(), c64::new(0.0, 2.0));
        let names: Vec<_> = scene.constraints.iter().map(|constraint| constraint.name.as_str()).collect();
        assert_eq!(names, ["corner", "relative[0]", "relative[1]", "duration[0]", "sync[0]"]);
        assert_eq!(scene.constraints[0].line, 24);
        assert_eq!(scene.constraints[0].strength, Strength::Hard);
        let ConstraintKind::Pin { when: When::At(moment), position, facing } = &scene.constraints[0].kind
        else {
            panic!("pins come first");
        };
        assert_eq!(moment.name, "ann:wave");
        assert_eq!(*position, Some(c64::new(1.0, -2.0)));
        assert_eq!(*facing, Some((-90.0_f64).to_radians()));
        let Instant::Frame { entry: 0, working } = moment.instant else {
            panic!("\"wave\" is a frame of the first clip");
        };
        assert_eq!(working, scene.characters[0].track.clips[0].working_frame(12.0));
    }

    #[test]
    fn what_is_left_out_of_a_relative_is_as_before_or_free() {
        let scene = load(SOUND).expect("the scene is sound").scene;
        let ConstraintKind::Relative { offset, facing, .. } = &scene.constraints[1].kind else {
            panic!("relatives come second");
        };
        assert_eq!((*offset, *facing), (Relation::Given(c64::new(0.9, 0.1)), Relation::AsBefore));
        assert_eq!(scene.constraints[1].strength, Strength::Soft(2.5));
        let ConstraintKind::Relative { partner, offset, .. } = &scene.constraints[2].kind else {
            panic!("relatives come second");
        };
        assert_eq!((partner, *offset), (&Partner::Object(crate::index::ObjectId(0)), Relation::Free));
        assert_eq!(scene.constraints[2].strength, Strength::default());
    }

    #[test]
    fn a_sound_scene_needs_no_warning_and_an_untied_relative_does() {
        assert_eq!(warnings(SOUND), Vec::<String>::new());
        let untied = SOUND.replace("moments = [\"ann/slap:hit\"", "moments = [\"ann/slap:end\"");
        assert_eq!(
            warnings(&untied),
            ["nothing makes \"bob/slap:hit\" and \"ann/slap:hit\" happen together"]
        );
        let timed = untied
            + "[[time]]\nat = \"ann/slap:hit\"\nseconds = 5\n[[time]]\nat = \"bob/slap:hit\"\nseconds = 5\n";
        assert_eq!(warnings(&timed), Vec::<String>::new());
    }

    #[test]
    fn two_names_of_one_frame_are_one_moment() {
        let tied = SOUND.to_owned()
            + "[[sync]]\nmoments = [\"ann/walk:start\", \"bob:start\"]\n[[relative]]\nat = \"bob/walk#1:start\"\nto = \"ann:start\"\n";
        assert_eq!(warnings(&tied), Vec::<String>::new());
    }

    #[test]
    fn unused_clips_and_hard_intervals_are_warned_of() {
        let unused = SOUND.replace("[clips]", "[clips]\nidle = \"builtin:idle\"");
        assert_eq!(warnings(&unused), ["no track uses clip \"idle\""]);
        let hard = SOUND.replace("facing = 180", "facing = 180\nstrength = \"hard\"");
        assert!(warnings(&hard)[0].contains("hard constraint over an interval"));
    }

    #[test]
    fn a_rate_that_differs_gives_fractions_of_working_frames() {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/bad_scenes/scene.toml");
        let text = "[clips]\nsteps = { file = \"clips/steps.bvh\", fps = 45, unit = \"cm\", up = \"y\", frames = [3, 30] }\n\
            [[character]]\nname = \"ann\"\ntrack = [\"steps\"]\n[[time]]\nat = \"ann:4\"\nseconds = 1\n";
        let scene =
            load_text(text, Path::new(folder), &ClipFolders::default()).expect("the scene is sound").scene;
        let ConstraintKind::Time { at, .. } = &scene.constraints[0].kind else {
            panic!("there is one constraint");
        };
        let Instant::Frame { entry: 0, working } = at.instant else {
            panic!("it names a frame");
        };
        assert!((working - 2.0 / 3.0).abs() < 1e-9);
    }

    #[test]
    fn the_same_file_read_the_same_way_is_read_once() {
        let text = SOUND.replace(
            "slap = \"builtin:slap\"",
            "slap = \"builtin:slap\"\nagain = { builtin = \"slap\", frames = [0, 20] }",
        );
        let text = text.replace("track = [\"walk\", \"slap\"]", "track = [\"walk\", \"slap\", \"again\"]");
        let scene = load(&text).expect("the scene is sound").scene;
        let clips = &scene.characters[0].track.clips;
        assert!(std::sync::Arc::ptr_eq(&clips[1].clip, &clips[2].clip));
    }

    #[test]
    fn faults_serialize_with_place_field_and_remedy() {
        let faults = load("[clips]\nwalk = 5\n").expect_err("nobody performs").faults;
        let json = serde_json::to_value(&faults[1]).expect("a fault is plain data");
        assert_eq!(
            (&json["file"], &json["line"], &json["column"]),
            (&"meet.toml".into(), &2.into(), &8.into())
        );
        assert_eq!(json["field"], "clips.walk");
        assert!(json["message"].is_string() && json["help"].is_string());
        assert_eq!(json.as_object().map(serde_json::Map::len), Some(6));
    }

    #[test]
    fn a_scene_that_is_not_there_says_so() {
        let faults = super::load(Path::new("/nowhere/scene.toml"), &ClipFolders::default())
            .expect_err("it is not there");
        assert!(faults.to_string().starts_with("/nowhere/scene.toml:1:1: error: cannot read"));
    }

    #[test]
    fn deep_nesting_and_one_endless_line_end_in_faults() {
        let deep = format!("title = {}{}", "[".repeat(100_000), "]".repeat(100_000));
        let long = format!("[clips]\nwalk = {{ builtin = \"walk\", x = [{}] }}", "1, ".repeat(100_000));
        for text in [deep, long] {
            let faults = load(&text).expect_err("it is no scene");
            assert!(faults.render(Rendering::Graphical).len() < 10_000, "a long line is not shown");
        }
    }

    /// Pieces that turn a sound scene into an odd one.
    const PIECES: [&str; 16] = [
        "nan",
        "-1",
        "1e308",
        "[",
        "]",
        "\"",
        "#",
        ":",
        "/",
        "\n[[pin]]\n",
        "{ x = 1 }",
        "ann:start",
        "\u{fffd}ö",
        "=",
        "[[]]",
        "true",
    ];

    proptest! {
        #[test]
        fn no_spoiled_scene_panics(
            spoils in prop::collection::vec((0.0..1.0_f64, 0_usize..12, 0_usize..PIECES.len()), 1..4),
            whole in any::<bool>(),
        ) {
            let mut text = if whole { include_str!("example.toml").to_owned() } else { SOUND.to_owned() };
            for (share, length, piece) in spoils {
                let start = crate::index::floor_index(share * f64::from(u32::try_from(text.len()).expect("it is short")));
                let start = text.floor_char_boundary(start);
                let end = text.ceil_char_boundary((start + length).min(text.len()));
                text.replace_range(start..end, PIECES[piece]);
            }
            if let Err(faults) = load(&text) {
                prop_assert!(!faults.faults.is_empty());
                prop_assert!(!faults.render(Rendering::Graphical).is_empty());
                for fault in &faults.faults {
                    prop_assert!(fault.span.end <= text.len() && fault.line >= 1 && fault.column >= 1);
                }
            }
        }
    }
}
