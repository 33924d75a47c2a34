//! A scene of objects, and how it is read and solved.

use std::path::Path;

use cotillion::edit::{Edit, Editor};
use cotillion::scene::{ClipFolders, Loaded, Scene, load_text};

/// Ann carries a box to bob, who carries it on; a cart drives by.
pub(crate) const RELAY: &str = r#"
[clips]
pick_up = "builtin:pick_up"
carry = { builtin = "carry", take = 0, give = 0, width = 0.31, seconds = 5 }
hand_over = "builtin:hand_over"
walk = { builtin = "walk", start = 1, stop = 1, seconds = 5 }
take_over = "builtin:take_over"
put_down = "builtin:put_down"
idle = "builtin:idle"
[[character]]
name = "ann"
track = ["pick_up", "carry", "hand_over", "walk"]
[[character]]
name = "bob"
track = ["walk", "take_over", "carry", "put_down", "idle"]
position = [6.0, 4.0]
facing = -90.0
[[object]]
name = "box"
size = [0.3, 0.3, 0.35]
position = [0.6, 0.0]
[[object]]
name = "cart"
size = [1.0, 0.6, 0.6]
keys = [{ seconds = 2, position = [9, 9] }, { seconds = 12, position = [4, 9], facing = 90 }]
[[carry]]
name = "first"
object = "box"
by = ["ann"]
during = ["ann/pick_up:grasp", "ann/hand_over:release"]
[[carry]]
name = "second"
object = "box"
by = ["bob"]
during = ["bob/take_over:grasp", "bob/put_down:release"]
[[relative]]
name = "grasp"
at = "ann/pick_up:grasp"
to = "box"
offset = [-0.58, 0.0]
facing = 0.0
strength = "hard"
[[relative]]
name = "meet"
at = "bob/take_over:grasp"
to = "box"
offset = [0.58, 0.0]
facing = 180.0
strength = "hard"
[[pin]]
name = "there"
at = "ann/hand_over:release"
position = [3.2, 1.6]
facing = 60.0
[[pin]]
name = "mark"
at = "bob/put_down:release"
position = [5.5, 0.5]
strength = "hard"
[[time]]
name = "begin"
at = "ann:start"
seconds = 0.0
strength = "hard"
[[sync]]
name = "together"
moments = ["bob/take_over:grasp", "ann/hand_over:release"]
strength = "hard"
"#;

pub(crate) fn load(text: &str) -> Loaded {
    load_text(text, Path::new("objects.toml"), &ClipFolders::default()).expect("a sound scene")
}

pub(crate) fn solved(text: &str) -> (Scene, Edit) {
    let mut editor = Editor::new(load(text).scene).expect("a regular scene");
    let edit = editor.solve().expect("the constraints agree").clone();
    (editor.scene().clone(), edit)
}
