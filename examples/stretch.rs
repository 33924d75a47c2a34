use cotillion::discrete::editor::DiscreteEditor;
use cotillion::discrete::settings::DiscreteSettings;
use cotillion::edit::Target;
use cotillion::graph::{GraphSettings, motion_graph};
use cotillion::index::ConstraintId;
use cotillion::scene::{ClipFolders, Mode, load_text};
use std::path::Path;
use std::sync::Arc;
fn main() {
    let args: Vec<String> = std::env::args().collect();
    let clip = &args[1];
    let time = args.get(3).is_some_and(|a| a == "time");
    let to: f64 = args[2].parse().unwrap();
    let mut text = format!("[clips]\nc = {clip}\n[[character]]\nname=\"a\"\ntrack=[\"c\"]\n");
    text += "[[pin]]\nat=\"a:start\"\nposition=[0,0]\nstrength=\"hard\"\n[[pin]]\nat=\"a:end\"\nposition=[1,0]\nstrength=\"hard\"\n[[time]]\nat=\"a:start\"\nseconds=0\nstrength=\"hard\"\n";
    if time {
        text += "[[time]]\nat=\"a:end\"\nseconds=1\nstrength=\"hard\"\n";
    }
    let folders = ClipFolders { mocap: std::env::var_os("COTILLION_MOCAP").map(Into::into) };
    let loaded = match load_text(&text, Path::new("scene.toml"), &folders) {
        Ok(l) => l,
        Err(e) => panic!("{e}"),
    };
    let scene = loaded.scene;
    let path = scene.characters[0].track.rest_path();
    let clips = vec![Arc::clone(&scene.characters[0].track.clips[0])];
    let t = std::time::Instant::now();
    let graph = Arc::new(motion_graph(&clips, &GraphSettings::default()));
    println!("graph {:?} pairs {}", t.elapsed(), graph.pairs().count());
    let n = path.len();
    let (p, q) = (path.positions[0], path.positions[n - 1]);
    let mut editor =
        DiscreteEditor::new(scene, (graph, &clips), DiscreteSettings::of(Mode::Production)).unwrap();
    editor.move_target(ConstraintId(0), Target::Position(p)).unwrap();
    let steps = ((to - 1.0).abs() / 0.05).round() as usize;
    for step in 0..=steps {
        let s = 1.0 + 0.05 * step as f64 * (to - 1.0).signum();
        let (sp, st) = if time { (1.0, s) } else { (s, 1.0) };
        editor.move_target(ConstraintId(1), Target::Position(p + sp * (q - p))).unwrap();
        if time {
            editor.move_target(ConstraintId(3), Target::Seconds(st * (n - 1) as f64 / 30.0)).unwrap();
        }
        let t = std::time::Instant::now();
        let changed = editor.update(cotillion::discrete::editor::Occasion::First).unwrap();
        let dt = t.elapsed();
        let e = editor.edit();
        let len = |p: &[cotillion::geometry::c64]| p.windows(2).map(|w| (w[1] - w[0]).norm()).sum::<f64>();
        let l = len(&e.characters[0].positions) / len(&e.characters[0].rest.positions);
        let en = editor.energy();
        println!(
            "x{s:.2} {} frames L'/L {l:.3} E {:.4} turn {:.4} {} {dt:?}",
            editor.scene().characters[0].track.frame_count(),
            en.total,
            en.turn,
            if changed { format!("{:?}", editor.log().last().unwrap()) } else { String::new() }
        );
    }
}
