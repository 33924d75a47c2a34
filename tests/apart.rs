//! People of relays keep apart: nobody stands, walks or lands in anybody else. Ways are as long as clips have them.

use std::path::Path;

use cotillion::edit::{Edit, Editor};
use cotillion::geometry::c64;
use cotillion::path;
use cotillion::relay::{self, Along, Disturbance, Relay};
use cotillion::scene::{ClipFolders, Scene, load_text};

/// From the middle of one body to that of another, at any one time, metres: shoulders are 0.4 m wide.
const APART: f64 = 0.5;
/// Of a way, as a share of it: nobody's stride is seen to change, but for one in ten at most.
const STRETCH: f64 = 0.05;
/// Nobody's by more: who follows one that starts a box gives way to both neighbours.
const MOST: f64 = 0.08;
/// Seconds from one look to the next: who walks comes 0.13 m farther.
const LOOK: f64 = 0.1;

fn relay(along: Along, characters: usize, seed: u64) -> Relay {
    Relay { boxes: characters / 10, seed, along, ..Relay::of(characters) }
}

fn solved(asked: &Relay) -> (Scene, Edit) {
    let text = relay::relay(asked, "a test").expect("the relay fits");
    let loaded = load_text(&text, Path::new("relay.toml"), &ClipFolders::default()).expect("a sound scene");
    let mut editor = Editor::new(loaded.scene).expect("a regular scene");
    editor.solve().expect("the constraints agree");
    let outcome = cotillion::discrete::outcome::Outcome::plain(editor.into_parts());
    (outcome.scene, outcome.edit)
}

/// The two who ever come nearest to each other: how near, metres, and when and who.
fn nearest((scene, edit): &(Scene, Edit)) -> (f64, String) {
    let ends = edit.characters.iter().map(|own| (own.times[0], own.times[own.times.len() - 1]));
    let (from, to) = ends.fold((f64::MAX, f64::MIN), |(a, b), (from, to)| (a.min(from), b.max(to)));
    let looks = (0..).map(|look| from + LOOK * f64::from(look)).take_while(|time| *time <= to);
    let mut least = (f64::MAX, String::new());
    for time in looks {
        let all = edit.characters.iter().zip(&scene.characters);
        let places: Vec<c64> =
            all.map(|(own, who)| path::at(&own.positions, own.frame_at(&who.track, time))).collect();
        for (one, place) in places.iter().enumerate() {
            for (other, beside) in places.iter().enumerate().skip(one + 1) {
                let apart = (place - beside).norm();
                if apart < least.0 {
                    let [one, other] = [one, other].map(|who| &scene.characters[who].name);
                    least = (apart, format!("{one} and {other} at {time:.1} s"));
                }
            }
        }
    }
    least
}

fn bend() -> Along {
    Along::Points([(0.0, 0.0), (60.0, 0.0), (60.0, 40.0), (20.0, 30.0)].map(|(x, y)| c64::new(x, y)).to_vec())
}

#[test]
fn nobody_is_in_anybody_on_any_curve() {
    let cases = [
        relay(Along::Spiral, 78, 1),
        Relay { boxes: 8, ..relay(Along::Spiral, 78, 1) },
        relay(Along::Circle, 78, 2),
        relay(Along::Line, 78, 1),
        relay(bend(), 78, 3),
        Relay { spacing: Some(3.0), heights: relay::HEIGHTS, ..relay(Along::Spiral, 78, 4) },
        Relay { boxes: 1, phase: 1.0, ..relay(Along::Line, 40, 5) },
        Relay { disturbances: vec![Disturbance::Jump], ..relay(Along::Spiral, 78, 6) },
    ];
    for asked in cases {
        let (apart, who) = nearest(&solved(&asked));
        assert!(apart > APART, "{apart:.3} m: {who}, of {asked:?}");
    }
}

/// Metres from the first to the last place of a path.
fn length(positions: &[c64]) -> f64 {
    positions.windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum()
}

#[test]
fn ways_are_hardly_stretched_before_any_drag() {
    for (along, spacing) in [(Along::Spiral, None), (Along::Line, None), (Along::Spiral, Some(3.0))] {
        let (scene, edit) = solved(&Relay { boxes: 8, spacing, ..relay(along, 78, 1) });
        let all = scene.characters.iter().zip(&edit.characters);
        let carriers = all.filter(|(character, _)| character.name.starts_with("carrier"));
        let stretches: Vec<f64> = carriers
            .map(|(character, own)| {
                let rest = length(&character.track.rest_path().positions);
                (length(&own.positions) / rest - 1.0).abs()
            })
            .collect();
        let most = stretches.iter().copied().fold(0.0, f64::max);
        let many = stretches.iter().filter(|own| **own > STRETCH).count();
        assert!(most < MOST && many <= stretches.len() / 10, "{many} by more than 5 %, {most:.3} at most");
    }
}
