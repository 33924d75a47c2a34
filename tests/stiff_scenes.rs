//! Scenes whose rows are so stiff, many or alike that the reduced system loses digits are solved all the same, as by all
//! frames.

use std::fmt::Write;
use std::path::Path;

use cotillion::scene::{ClipFolders, load_text};

mod agree;

fn same_by_both(text: &str) {
    let loaded = load_text(text, Path::new("stiff.toml"), &ClipFolders::default()).expect("a sound scene");
    agree::both_backends(&loaded.scene).expect("the same answer");
}

#[test]
fn a_stiff_offset_beside_a_hard_one_has_an_answer() {
    same_by_both(
        "[clips]\nwalk = { builtin = \"walk\", seconds = 2 }\nstroll = { builtin = \"walk\", start = 1, stop = 1, seconds = 4 }\n\
         slap = \"builtin:slap\"\nidle = \"builtin:idle\"\n\
         [[character]]\nname = \"a\"\ntrack = [\"idle\", \"stroll\", \"slap\", \"slap\"]\n\
         [[character]]\nname = \"b\"\ntrack = [\"walk\", \"stroll\"]\n\
         [[relative]]\nat = \"a/slap#1:2\"\nto = \"b:start\"\noffset = [1.6442265308967752, 1.9839191083422367]\n\
         strength = \"hard\"\n[[relative]]\nat = \"a:end\"\nto = \"b:start\"\nstrength = 100000.0\n",
    );
}

#[test]
fn a_facing_held_stiffly_all_along_has_an_answer() {
    same_by_both(
        "mode = \"paper\"\n[clips]\nstroll = { builtin = \"walk\", start = 1, stop = 1, seconds = 4 }\n\
         [[character]]\nname = \"a\"\ntrack = [\"stroll\", \"stroll\"]\n\
         [[pin]]\nduring = [\"a:start\", \"a:end\"]\nfacing = 88.1\nstrength = 1e9\n",
    );
}

#[test]
fn hundreds_of_pins_on_one_frame_only_move_a_path() {
    for pins in [2, 60, 600] {
        let mut text = "[clips]\nwalk = { builtin = \"walk\", seconds = 20 }\n[[character]]\nname = \"a\"\ntrack = [\"walk\"]\n".to_owned();
        for own in 0..pins {
            let _ = write!(
                text,
                "[[pin]]\nat = \"a:50\"\nposition = [{:?}, 0.0]\nstrength = {}.0\n",
                0.04 * f64::from(own),
                own + 1
            );
        }
        same_by_both(&text);
    }
}

#[test]
fn rows_that_cannot_be_factored_name_the_contradiction() {
    same_by_both(
        "mode = \"paper\"\n[clips]\nwalk = { builtin = \"walk\", seconds = 4 }\nstroll = { builtin = \"walk\", start = 1, stop = 1, seconds = 4 }\n\
         slap = \"builtin:slap\"\nidle = \"builtin:idle\"\n\
         [[character]]\nname = \"a\"\ntrack = [\"slap\", \"idle\", \"stroll\", \"walk\"]\n\
         [[character]]\nname = \"b\"\ntrack = [\"walk\", \"stroll\", \"slap\"]\n\
         [[relative]]\nat = \"a:start\"\nto = \"b/slap#1:start\"\nstrength = \"hard\"\n\
         [[relative]]\nat = \"a:start\"\nto = \"b/stroll#1:end\"\nstrength = 1e9\n\
         [[pin]]\nduring = [\"a:start\", \"a:end\"]\nfacing = 149.68068769491788\nstrength = \"hard\"\n",
    );
}

#[test]
fn who_stands_perfectly_still_before_a_jump_does_not_turn_freely_there() {
    same_by_both(
        "[clips]\nwalk = { builtin = \"walk\", start = 1, stop = 1, seconds = 2.5 }\njump = \"builtin:jump_over\"\n\
         [[character]]\nname = \"a\"\ntrack = [\"walk\", \"jump\", \"walk\"]\nposition = [8.7, 2.0]\nfacing = -130\n\
         [[pin]]\nat = \"a/jump:takeoff\"\nposition = [7.4, 0.6]\nfacing = -130\nstrength = \"hard\"\n\
         [[pin]]\nat = \"a:start\"\nposition = [9.0, 2.0]\n",
    );
}

/// Idle frames that sway on, after a halt whose last frames are all at one point: the stretch that stays ends there.
#[test]
fn who_stands_in_one_point_and_then_sways_has_one_path() {
    let track = "[clips]\nwalk = { builtin = \"walk\", stop = 1 }\nstill = { builtin = \"idle\", frames = [40, 42] }\n\
                 [[character]]\nname = \"a\"\ntrack = [\"walk\", \"still\"]\n";
    same_by_both(track);
    let pins =
        ["start", "60", "end"].map(|when| format!("[[pin]]\nat = \"a:{when}\"\nposition = [1.0, 2.0]\n"));
    same_by_both(&format!("{track}{}", pins.concat()));
    same_by_both(&format!("{track}{}[[pin]]\nat = \"a:end\"\nfacing = 70.0\nstrength = \"hard\"\n", pins[0]));
}
