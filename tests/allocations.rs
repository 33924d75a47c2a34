//! A drag step allocates nothing per frame: on tracks ten times as long it asks for memory as often, and for as much.

use std::fmt::Write;
use std::path::Path;

use allocation_counter::measure;
use cotillion::edit::{EditNote, Editor, Target};
use cotillion::geometry::c64;
use cotillion::index::ConstraintId;
use cotillion::scene::{ClipFolders, Scene, load_text};

/// So many that the longer tracks are worth more than one thread.
const CHARACTERS: usize = 12;
/// Frames of the tracks compared.
const SHORT_AND_LONG: [usize; 2] = [200, 2_000];
/// Steps that warm the storage: results and what is being solved for change places, so that it takes two.
const WARMING: usize = 2;
/// Steps counted after these.
const STEPS: usize = 6;
/// A step allocates no more often than this: lists of three paths and their rows.
const MOST: u64 = 20;

/// Scenes of which all is the same but the length of tracks, and where the first character is held.
struct Case {
    text: fn(mode: &str, frames: usize) -> String,
    start: c64,
    middle: c64,
    /// How far these are dragged, metres.
    reach: f64,
}

/// Walkers who stand at both ends of their tracks, and some who stand all the time, tied in place and time by threes.
fn tied(mode: &str, frames: usize) -> String {
    let seconds = (frames - 1) as f64 / 30.0;
    let mut text = format!(
        "mode = \"{mode}\"\n[clips]\nidle = {{ builtin = \"idle\", seconds = {seconds:?} }}\n\
         walk = {{ builtin = \"walk\", start = 1, stop = 1, seconds = {seconds:?} }}\n"
    );
    for own in 0..CHARACTERS {
        // Where the walkers are at frame 100.
        let (clip, x, y) = if own % 4 == 3 { ("idle", 2.6, 2 * own) } else { ("walk", 0.0, 2 * own) };
        let _ = write!(
            text,
            "[[character]]\nname = \"c{own}\"\ntrack = [\"{clip}\"]\nposition = [{x:?}, {y}.0]\nfacing = 0.0\n\
             [[pin]]\nname = \"start {own}\"\nat = \"c{own}:start\"\nposition = [{x:?}, {y}.1]\nfacing = 0.1\n\
             [[time]]\nname = \"when {own}\"\nat = \"c{own}:150\"\nseconds = 5.1\n"
        );
        if clip == "walk" {
            let _ = write!(
                text,
                "[[pin]]\nname = \"middle {own}\"\nat = \"c{own}:120\"\nposition = [3.4, {y}.2]\n"
            );
        }
        if own % 3 > 0 {
            let (own, to) = (format!("c{own}:100"), format!("c{}:100", own - 1));
            let _ = write!(
                text,
                "[[relative]]\nat = \"{own}\"\nto = \"{to}\"\noffset = [0.0, 2.0]\nfacing = 0.0\nstrength = \"hard\"\n\
                 [[sync]]\nmoments = [\"{own}\", \"{to}\"]\nstrength = \"hard\"\n"
            );
        }
    }
    text
}

const TIED: Case = Case { text: tied, start: c64::new(0.0, 0.1), middle: c64::new(3.4, 0.1), reach: 0.1 };

/// Somebody who stands, and is pulled apart by hard constraints.
fn torn(mode: &str, frames: usize) -> String {
    let seconds = (frames - 1) as f64 / 30.0;
    let hard = "strength = \"hard\"";
    format!(
        "mode = \"{mode}\"\n[clips]\nidle = {{ builtin = \"idle\", seconds = {seconds:?} }}\n\
         [[character]]\nname = \"c\"\ntrack = [\"idle\"]\n\
         [[pin]]\nname = \"start 0\"\nat = \"c:20\"\nposition = [0.1, 0.1]\n{hard}\n\
         [[pin]]\nname = \"middle 0\"\nat = \"c:120\"\nposition = [0.1, 0.1]\n{hard}\n\
         [[time]]\nname = \"when 0\"\nat = \"c:150\"\nseconds = 5.1\n"
    )
}

const TORN: Case =
    Case { text: torn, start: c64::new(0.1, 0.1), middle: c64::new(0.115, 0.105), reach: 0.001 };

fn scene(text: &str) -> Scene {
    load_text(text, Path::new("allocations.toml"), &ClipFolders::default()).expect("a sound scene").scene
}

/// Drags two places and a time of the first character.
fn drag(editor: &mut Editor, case: &Case, handles: [ConstraintId; 3], step: usize) {
    let angle = 0.3 * step as f64;
    let targets = [
        Target::Position(case.start + case.reach * angle.cos()),
        Target::Position(case.middle + case.reach * angle.sin()),
        Target::Seconds(5.1 + 0.02 * angle.sin()),
    ];
    for (constraint, target) in handles.into_iter().zip(targets) {
        editor.move_target(constraint, target).expect("the constraint has such a target");
    }
    editor.solve().expect("the scene has an answer");
}

/// How often each step asks for memory and for how many bytes, once storage is warm, and the notes of the last.
fn counted(case: &Case, mode: &str, frames: usize) -> (Vec<(u64, u64)>, Vec<EditNote>) {
    let mut editor = Editor::new(scene(&(case.text)(mode, frames))).expect("a regular scene");
    assert!(editor.edit().characters.iter().all(|character| !character.rest.rigid.is_empty()));
    let handles = ["start 0", "middle 0", "when 0"].map(|name| {
        let place = editor.scene().constraints.iter().position(|constraint| constraint.name == name);
        ConstraintId::from_usize(place.expect("the scene has this constraint"))
    });
    (0..WARMING).for_each(|step| drag(&mut editor, case, handles, step));
    let steps = (WARMING..WARMING + STEPS).map(|step| {
        let step = measure(|| drag(&mut editor, case, handles, step));
        (step.count_total, step.bytes_total)
    });
    (steps.collect(), editor.edit().notes.clone())
}

/// One thread, whose allocations are counted; [`measure`] sees no others.
fn alone<T: Send>(work: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread").install(work)
}

/// Counts of both lengths, which are the same, and notes.
fn same_for_both_lengths(case: &Case) -> (Vec<u64>, Vec<EditNote>) {
    let (mut counts, mut all_notes) = (Vec::new(), Vec::new());
    for mode in ["production", "paper"] {
        let [(short, _), (long, notes)] = SHORT_AND_LONG.map(|frames| alone(|| counted(case, mode, frames)));
        assert_eq!(short, long, "{mode}: {notes:?}");
        counts.extend(short.into_iter().map(|(count, _)| count));
        all_notes.extend(notes);
    }
    (counts, all_notes)
}

#[test]
fn drag_steps_allocate_as_much_on_tracks_ten_times_as_long() {
    let (counts, _) = same_for_both_lengths(&TIED);
    assert!(counts.iter().all(|count| *count <= MOST), "{counts:?}");
}

#[test]
fn drag_steps_of_a_stretch_that_is_pulled_apart_allocate_as_much_on_one_ten_times_as_long() {
    let (_, notes) = same_for_both_lengths(&TORN);
    let released = notes.iter().filter(|note| matches!(note, EditNote::Released { .. }));
    assert_eq!(released.count(), 2, "{notes:?}");
}
