//! Memory that what-ifs of a group draw on.

use std::sync::{Arc, Mutex, PoisonError};

use cotillion_solvers::Bent;

use crate::edit::facing::Body;
use crate::edit::turned::TurnedPath;
use crate::geometry::c64;
use crate::path::RestPath;

/// What the solve of a group draws on.
#[derive(Default)]
pub struct Canvas {
    /// Solutions of the shape and of the scale phase.
    pub bent: [Option<Bent>; 2],
    /// Paths after the shape phase.
    pub shaped: Vec<Vec<c64>>,
    /// Rest segments turned as in the shape phase.
    pub turned: Vec<TurnedPath>,
    /// Paths after the scale phase, of those that springs do not tell.
    pub edited: Vec<Vec<c64>>,
    /// Bodies on these.
    pub bodies: Vec<Body>,
}

/// As many canvases as were needed at once, for all what-ifs of a group.
#[derive(Clone, Default)]
pub struct Canvases(Arc<Mutex<Vec<Canvas>>>);

impl Canvases {
    /// One with room for these paths.
    pub fn take(&self, rests: &[Arc<RestPath>]) -> Canvas {
        let known = self.0.lock().unwrap_or_else(PoisonError::into_inner).pop();
        let mut canvas = known.unwrap_or_default();
        canvas.fit(rests);
        canvas
    }

    /// Takes it back.
    pub fn give_back(&self, canvas: Canvas) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).push(canvas);
    }
}

impl Canvas {
    fn fit(&mut self, rests: &[Arc<RestPath>]) {
        self.shaped.resize_with(rests.len(), Vec::new);
        self.turned.resize_with(rests.len(), TurnedPath::default);
        self.edited.resize_with(rests.len(), Vec::new);
        self.bodies.resize_with(rests.len(), Body::default);
        for (path, rest) in rests.iter().enumerate() {
            for points in [&mut self.shaped[path], &mut self.turned[path].points] {
                points.resize(rest.len(), c64::default());
            }
        }
    }
}
