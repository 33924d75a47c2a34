//! What may be changed, and when a change is worth it.

use std::ops::RangeInclusive;

use crate::constraint::{ChangeKind, Evaluator};
use crate::edit::Backend;
use crate::scene::{Mode, Scene};

/// Settings of discrete editing.
#[derive(Clone, Debug, PartialEq)]
pub struct DiscreteSettings {
    /// Types that may happen.
    pub kinds: Vec<ChangeKind>,
    /// Fewest frames that come or go (0.3 s).
    pub shortest: usize,
    /// … where somebody stands (0.8 s in production).
    pub shortest_idle: usize,
    /// Most frames that come or go (2 s).
    pub longest: usize,
    /// A replacement changes the number of frames by at least so many (in a stand, by as many as may come or go there); 0: by
    /// any number.
    pub least_exchange: usize,
    /// No run is left shorter than this, frames: it would have no room to blend. Between two seams, than twice as many.
    pub shortest_run: usize,
    /// At most so many candidates of a track are tried.
    pub most_candidates: usize,
    /// Relative gain that a change must bring.
    pub least_gain: f64,
    /// Gain in Ê that a change must bring.
    pub least_drop: f64,
    /// Candidates this near to the best in Ê count as equal: the one that repeats frames least is taken. In production a frame
    /// and a half of a walk: cycles that differ by a frame are equally good, and the shorter one would always be repeated.
    pub near_tie: f64,
    /// Weight of turns at seams, 1/rad.
    pub turn_weight: f64,
    /// How candidates are weighed.
    pub evaluator: Evaluator,
    /// Which solver solves all frames.
    pub backend: Backend,
    /// Whether changes can be taken back exactly, whatever the motion graph says.
    pub undo: bool,
    /// Whether every update searches from the motion at rest on, so that the way there does not matter.
    pub reversible: bool,
}

impl DiscreteSettings {
    /// Those of a mode.
    pub fn of(mode: Mode) -> Self {
        let production = Self {
            kinds: ChangeKind::ALL.to_vec(),
            shortest: 9,
            shortest_idle: 24,
            longest: 60,
            least_exchange: 9,
            shortest_run: 8,
            most_candidates: 64,
            least_gain: 0.02,
            least_drop: 0.005,
            near_tie: 0.03,
            turn_weight: 0.05,
            evaluator: Evaluator::default(),
            backend: Backend::default(),
            undo: true,
            reversible: false,
        };
        match mode {
            Mode::Production => production,
            Mode::Paper => Self {
                shortest_idle: 9,
                least_exchange: 0,
                shortest_run: 0,
                most_candidates: usize::MAX,
                least_gain: 0.0,
                least_drop: 0.0,
                near_tie: 0.0,
                turn_weight: 0.0,
                undo: false,
                ..production
            },
        }
    }

    /// Those of a scene: of its mode, as far as it does not say otherwise; without discrete editing no type is allowed.
    pub fn of_scene(scene: &Scene) -> Self {
        let mut settings = Self::of(scene.mode);
        match &scene.discrete {
            Some(discrete) => {
                settings.kinds.clone_from(&discrete.kinds);
                settings.evaluator = discrete.evaluator;
                settings.reversible = discrete.reversible;
            }
            None => settings.kinds.clear(),
        }
        settings
    }

    /// Whether changes of this type may happen.
    pub fn allows(&self, kind: ChangeKind) -> bool {
        self.kinds.contains(&kind)
    }

    /// By how many frames a replacement changes the number of frames at least; `idle`: all that go are stationary.
    pub fn least_exchange(&self, idle: bool) -> usize {
        if idle && self.least_exchange > 0 { self.shortest_idle } else { self.least_exchange }
    }

    /// How many frames may come or go; `idle`: all of them stationary.
    pub fn lengths(&self, idle: bool) -> RangeInclusive<usize> {
        (if idle { self.shortest_idle } else { self.shortest })..=self.longest
    }
}
