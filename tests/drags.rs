//! However an editor got there, its result depends on the present targets alone: not on which groups were solved when, on
//! solves that failed in between, or on the number of threads.

use std::fmt::Write;
use std::path::Path;

use cotillion::edit::{Edit, Editor, Target};
use cotillion::geometry::c64;
use cotillion::index::ConstraintId;
use cotillion::scene::{ClipFolders, load_text};

/// So many that all threads take part, in the group of the tied and among the others.
const TIED: usize = 110;
const ALONE: usize = 110;

/// A chain of walkers tied to each other in place and time, and others by themselves.
fn editor() -> Editor {
    let mut text = "[clips]\nwalk = { builtin = \"walk\", seconds = 6.7 }\n".to_owned();
    for own in 0..TIED + ALONE {
        let _ = write!(
            text,
            "[[character]]\nname = \"c{own}\"\ntrack = [\"walk\"]\nposition = [0.0, {own}.0]\nfacing = 0.0\n\
             [[pin]]\nname = \"end {own}\"\nat = \"c{own}:end\"\nposition = [8.0, {own}.5]\nstrength = \"hard\"\n\
             [[time]]\nname = \"when {own}\"\nat = \"c{own}:end\"\nseconds = 7.0\n"
        );
        if (1..TIED).contains(&own) {
            let (own, to) = (format!("c{own}:100"), format!("c{}:100", own - 1));
            let _ = write!(
                text,
                "[[relative]]\nat = \"{own}\"\nto = \"{to}\"\noffset = [0.0, 1.0]\nstrength = \"hard\"\n\
                 [[sync]]\nmoments = [\"{own}\", \"{to}\"]\n"
            );
        }
    }
    // The same place a second time: dragged elsewhere, it contradicts the first.
    text += "[[pin]]\nname = \"again\"\nat = \"c200:end\"\nposition = [8.0, 200.5]\nstrength = \"hard\"\n";
    let scene =
        load_text(&text, Path::new("drags.toml"), &ClipFolders::default()).expect("a sound scene").scene;
    Editor::new(scene).expect("a regular scene")
}

fn target(editor: &mut Editor, name: &str, target: Target) {
    let place = editor.scene().constraints.iter().position(|constraint| constraint.name == name);
    let id = ConstraintId::from_usize(place.expect("the scene has this constraint"));
    editor.move_target(id, target).expect("the constraint has such a target");
}

fn place(x: f64, y: f64) -> Target {
    Target::Position(c64::new(x, y))
}

/// Panics with the first character that differs, not with all their frames.
fn assert_same(own: &Edit, other: &Edit) {
    let differs = own.characters.iter().zip(&other.characters).position(|(own, other)| own != other);
    assert_eq!(differs, None, "characters");
    assert_eq!((own.energy, &own.notes), (other.energy, &other.notes));
}

/// The targets all editors end with.
fn last_targets(editor: &mut Editor) {
    target(editor, "end 20", place(7.5, 21.0));
    target(editor, "end 150", place(8.5, 151.0));
    target(editor, "when 30", Target::Seconds(7.3));
    target(editor, "when 160", Target::Seconds(6.8));
}

fn at_once() -> Edit {
    let mut editor = editor();
    last_targets(&mut editor);
    editor.solve().expect("an answer").clone()
}

fn with_threads<T: Send>(count: usize, work: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new().num_threads(count).build().expect("threads").install(work)
}

#[test]
fn dragged_results_are_those_of_an_editor_that_was_never_anywhere_else() {
    let mut dragged = editor();
    dragged.solve().expect("an answer");
    for step in 0..3 {
        let x = 8.0 + 0.1 * f64::from(step);
        target(&mut dragged, "end 20", place(x, 20.0));
        dragged.solve().expect("an answer");
        target(&mut dragged, "end 150", place(x, 150.0));
        target(&mut dragged, "when 160", Target::Seconds(x));
        dragged.solve().expect("an answer");
        target(&mut dragged, "when 30", Target::Seconds(7.0 + 0.1 * f64::from(step)));
        dragged.solve().expect("an answer");
    }
    last_targets(&mut dragged);
    assert_same(dragged.solve().expect("an answer"), &at_once());
}

#[test]
fn a_failed_solve_keeps_no_group_from_catching_up() {
    let mut dragged = editor();
    let before = dragged.solve().expect("an answer").clone();
    last_targets(&mut dragged);
    target(&mut dragged, "again", place(5.0, 200.0));
    dragged.solve().expect_err("two places for one moment");
    assert_same(dragged.edit(), &before);
    target(&mut dragged, "again", place(8.0, 200.5));
    assert_same(dragged.solve().expect("an answer"), &at_once());
}

#[test]
fn one_thread_and_three_give_the_same_bytes() {
    assert_same(&with_threads(1, at_once), &with_threads(3, at_once));
}
