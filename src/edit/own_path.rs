//! A path by itself, with what both phases make of it whatever constraints say: what-ifs ask for it again and again.

use std::sync::{Arc, OnceLock};

use cotillion_solvers::SpringPath;

use crate::edit::columns::Freedom;
use crate::edit::direction::{Direction, run_chord};
use crate::edit::hold::Phase;
use crate::edit::settings::SpatialSettings;
use crate::edit::springs::spring_path;
use crate::path::{RestPath, RestSegments};

/// A rest path and what follows from it alone.
#[derive(Debug)]
pub struct OwnPath {
    /// The path.
    pub rest: Arc<RestPath>,
    /// Its length, metres.
    pub length: f64,
    /// Its segments.
    pub segments: Arc<RestSegments>,
    /// Longest chord of every stationary stretch.
    pub chords: Arc<Vec<Direction>>,
    /// Springs of the shape and of the scale phase with all stretches kept, once asked for.
    springs: [OnceLock<Option<Arc<SpringPath>>>; 2],
}

impl OwnPath {
    /// Cost: linear in frames.
    pub fn new(rest: RestPath) -> Self {
        let segments = rest.segments();
        Self {
            length: segments.along.last().copied().unwrap_or(0.0),
            segments: Arc::new(segments),
            chords: Arc::new(chords(&rest)),
            rest: Arc::new(rest),
            springs: [const { OnceLock::new() }; 2],
        }
    }

    /// See [`spring_path`]; the settings are always the same.
    pub fn springs(&self, phase: Phase, settings: &SpatialSettings) -> Option<Arc<SpringPath>> {
        let place = match phase {
            Phase::Shape => 0,
            Phase::Scale => 1,
        };
        let paths = std::slice::from_ref(&self.rest);
        let freedom = Freedom { paths, phase, runs: settings.runs, released: &[], samplings: &[] };
        self.springs[place].get_or_init(|| spring_path(freedom, 0, settings).map(Arc::new)).clone()
    }
}

/// Longest chord of every stationary stretch of a path.
pub fn chords(rest: &RestPath) -> Vec<Direction> {
    rest.rigid.iter().map(|run| run_chord(rest, *run)).collect()
}
