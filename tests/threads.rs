//! An edit large enough for all threads has the same bits on one thread and on several, at the first solve and at a drag.

use std::fmt::Write;
use std::path::Path;

use cotillion::edit::{Edit, Editor, Target};
use cotillion::geometry::c64;
use cotillion::index::ConstraintId;
use cotillion::scene::{ClipFolders, Scene, load_text};

/// With 200 frames each, more than are left to one thread.
const WALKERS: usize = 120;

/// Walkers side by side, each tied to the one before in the middle, in one group; and as many pairs by themselves.
fn crowd() -> Scene {
    let mut text = "[clips]\nwalk = { builtin = \"walk\", seconds = 6.6334 }\n".to_owned();
    for own in 0..2 * WALKERS {
        let _ = write!(
            text,
            "[[character]]\nname = \"c{own}\"\ntrack = [\"walk\"]\nposition = [0.0, {}.0]\nfacing = 0.0\n\
             [[pin]]\nat = \"c{own}:start\"\nposition = [0.0, {own}.0]\n\
             [[pin]]\nat = \"c{own}:end\"\nposition = [9.0, {own}.5]\n",
            2 * own
        );
        if (1..WALKERS).contains(&own) || own % 2 == 1 {
            let before = own - 1;
            let _ = write!(
                text,
                "[[relative]]\nat = \"c{own}:90\"\nto = \"c{before}:100\"\noffset = [0.0, 1.0]\nfacing = 0.0\n\
                 strength = \"hard\"\n[[sync]]\nmoments = [\"c{own}:90\", \"c{before}:100\"]\nstrength = \"hard\"\n"
            );
        }
    }
    load_text(&text, Path::new("crowd.toml"), &ClipFolders::default()).expect("a sound scene").scene
}

/// All numbers of an edit.
fn bits(edit: &Edit) -> Vec<u64> {
    let mut bits = vec![edit.energy.total.to_bits()];
    for character in &edit.characters {
        bits.extend(character.positions.iter().flat_map(|p| [p.re.to_bits(), p.im.to_bits()]));
        bits.extend(character.times.iter().chain(&character.turns.along_path).map(|value| value.to_bits()));
    }
    bits
}

fn solved(scene: &Scene, threads: usize) -> [Vec<u64>; 2] {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
    pool.install(|| {
        let mut editor = Editor::new(scene.clone()).expect("a regular scene");
        let first = bits(editor.solve().expect("an answer"));
        editor
            .move_target(ConstraintId(1), Target::Position(c64::new(9.5, 1.0)))
            .expect("the end of the first track");
        [first, bits(editor.solve().expect("an answer"))]
    })
}

#[test]
fn a_crowd_is_the_same_on_any_number_of_threads() {
    let scene = crowd();
    let one = solved(&scene, 1);
    assert_ne!(one[0], one[1], "the drag moves somebody");
    for threads in [2, 3] {
        assert!(solved(&scene, threads) == one, "{threads} threads give other bits");
    }
}
