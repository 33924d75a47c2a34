//! People of relays keep apart: nobody stands, walks or lands in anybody else.

use std::path::Path;

use cotillion::edit::{Edit, Editor};
use cotillion::geometry::c64;
use cotillion::path;
use cotillion::relay::{self, Along, Disturbance, Relay};
use cotillion::scene::{ClipFolders, Scene, load_text};

/// From the middle of one body to that of another, at any one time, metres: shoulders are 0.4 m wide.
const APART: f64 = 0.5;
/// Seconds from one look to the next: who walks comes 0.13 m farther.
const LOOK: f64 = 0.1;

fn relay(along: Along, characters: usize, seed: u64) -> Relay {
    Relay {
        characters,
        disturbers: None,
        boxes: characters / 10,
        spacing: None,
        heights: (1.64, 1.86),
        phase: 0.3,
        disturbances: Disturbance::ALL.to_vec(),
        discrete: false,
        drag: None,
        seed,
        along,
    }
}

fn solved(asked: &Relay) -> (Scene, Edit) {
    let text = relay::relay(asked, "a test").expect("the relay fits");
    let loaded = load_text(&text, Path::new("relay.toml"), &ClipFolders::default()).expect("a sound scene");
    let mut editor = Editor::new(loaded.scene).expect("a regular scene");
    editor.solve().expect("the constraints agree");
    let outcome = cotillion::discrete::outcome::Outcome::plain(editor.into_parts());
    (outcome.scene, outcome.edit)
}

/// Every pair that is ever nearer than `APART`: how near, when, and who.
fn too_near((scene, edit): &(Scene, Edit)) -> (f64, Vec<(f64, f64, String)>) {
    let ends = edit.characters.iter().map(|own| (own.times[0], own.times[own.times.len() - 1]));
    let (from, to) = ends.fold((f64::MAX, f64::MIN), |(a, b), (from, to)| (a.min(from), b.max(to)));
    let count = scene.characters.len();
    let mut nearest = vec![(f64::MAX, 0.0); count * count];
    let mut time = from;
    while time <= to {
        let places: Vec<c64> = (0..count)
            .map(|who| {
                let own = &edit.characters[who];
                path::at(&own.positions, own.frame_at(&scene.characters[who].track, time))
            })
            .collect();
        for one in 0..count {
            for other in one + 1..count {
                let apart = (places[one] - places[other]).norm();
                if apart < nearest[one * count + other].0 {
                    nearest[one * count + other] = (apart, time);
                }
            }
        }
        time += LOOK;
    }
    let mut all: Vec<(f64, f64, String)> = Vec::new();
    for one in 0..count {
        for other in one + 1..count {
            let (apart, time) = nearest[one * count + other];
            all.push((apart, time, format!("{} and {}", scene.characters[one].name, scene.characters[other].name)));
        }
    }
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    let least = all[0].0;
    all.retain(|own| own.0 < APART);
    (least, all)
}

fn bend() -> Along {
    Along::Points([(0.0, 0.0), (60.0, 0.0), (60.0, 40.0), (20.0, 30.0)].map(|(x, y)| c64::new(x, y)).to_vec())
}

#[test]
fn measure() {
    for seed in 1..4 {
        for (name, along) in [("spiral", Along::Spiral), ("circle", Along::Circle), ("line", Along::Line), ("bend", bend())] {
            let (least, near) = too_near(&solved(&relay(along, 78, seed)));
            eprintln!("{name} seed {seed}: least {least:.3}, {} pairs nearer than {APART}", near.len());
            near.iter().take(12).for_each(|(apart, time, who)| eprintln!("    {apart:.3} m at {time:.1} s: {who}"));
        }
    }
}
