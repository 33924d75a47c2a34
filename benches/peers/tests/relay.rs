//! The relay that is measured is the scene that is published, and every way to write its shape phase down has one solution.

use cotillion::relay::{Relay, relay};
use cotillion_peers::configuration::configurations;
use cotillion_peers::measure::run_peer;
use cotillion_peers::peer::Library;
use cotillion_peers::relay::{Dragged, FrameSystem, spiral};
use cotillion_peers::system::{FORMS, NUMBERS};

/// Metres. The squared condition number of a short chain costs half of the digits.
const TOLERANCE: f64 = 1e-4;

#[test]
fn the_relay_of_78_is_the_scene_of_that_name() {
    let file = include_str!("../../../scenes/relay_78.toml");
    let written = relay(&Relay { drag: None, ..spiral(78, false) }, "a test").expect("it fits");
    let without_head = |text: &str| -> Vec<String> {
        text.lines().filter(|line| !line.starts_with("# Written by")).map(str::to_owned).collect()
    };
    assert_eq!(without_head(&written), without_head(file));
}

#[test]
fn the_shape_phase_of_a_relay_is_solved_in_every_form() {
    let dragged = Dragged::new(12).expect("it fits");
    for system in [FrameSystem::Published, FrameSystem::Condensed] {
        let (posed, size) = dragged.posed(system).expect("it has a solution");
        assert!(size.unknowns > size.hard, "{size:?}");
        for (form, numbers) in FORMS.into_iter().flat_map(|form| NUMBERS.map(|numbers| (form, numbers))) {
            let configuration = &configurations(Library::Umfpack, form, numbers)[0];
            let run = run_peer(&posed, configuration).expect("a regular system");
            assert!(run.error < TOLERANCE, "{system:?}, {form:?}, {numbers:?}: {:e}", run.error);
        }
    }
}
