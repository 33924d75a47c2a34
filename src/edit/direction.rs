//! Vectors between points of a path that stand for where a body looks. Source: Kim et al. 2009, §4.1.

use crate::geometry::c64;
use crate::path::{self, RestPath};

/// Standing chords shorter than this are widened, metres.
const SHORTEST_CHORD: f64 = 1e-3;

/// The vector that stands for a body's direction at an instant: `scale · (p_to − p_from)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Direction {
    /// Frame of its tail, a fraction where the instant is one.
    pub from: f64,
    /// Frame of its tip.
    pub to: f64,
    /// 1, or 2 at the ends of a path.
    pub scale: f64,
    /// Its value at rest, metres.
    pub rest: c64,
    /// Whether it is the chord of a stationary stretch.
    pub in_run: bool,
}

/// Finds the direction at the fractional frame `frame` of `rest`: the central tangent; where that is shorter than
/// `baseline`, the chord of the smallest wider window; inside a stationary stretch its longest chord. `None` where the
/// path has no extent there.
pub fn direction_at(rest: &RestPath, frame: f64, baseline: f64) -> Option<Direction> {
    if let Some(run) = rest.rigid_at(frame) {
        let chord = run_chord(rest, run);
        if chord.rest.norm() >= SHORTEST_CHORD.min(baseline) {
            return Some(chord);
        }
    }
    let last = (rest.len() - 1) as f64;
    if last < 1.0 {
        return None;
    }
    let end = last.max(frame);
    let central = match frame {
        f if f < 1.0 => (f, f + 1.0, 2.0),
        f if f > end - 1.0 => (f - 1.0, f, 2.0),
        f => (f - 1.0, f + 1.0, 1.0),
    };
    let make = |(from, to, scale): (f64, f64, f64)| Direction {
        from,
        to,
        scale,
        rest: scale * (path::at(&rest.positions, to) - path::at(&rest.positions, from)),
        in_run: false,
    };
    let tangent = make(central);
    if tangent.rest.norm() >= baseline && tangent.rest.norm() > 0.0 {
        return Some(tangent);
    }
    let mut reach = 1.0;
    while reach <= end {
        let wide = make(((frame - reach).max(0.0), (frame + reach).min(end), 1.0));
        if wide.rest.norm() >= baseline && wide.rest.norm() > 0.0 {
            return Some(wide);
        }
        reach += 1.0;
    }
    None
}

/// The longest chord from the first frame of a stationary stretch.
pub fn run_chord(rest: &RestPath, (first, last): (usize, usize)) -> Direction {
    let length = |k: usize| (rest.positions[k] - rest.positions[first]).norm();
    let mut tip = first;
    for k in first..=last {
        if length(k) > length(tip) {
            tip = k;
        }
    }
    Direction {
        from: first as f64,
        to: tip as f64,
        scale: 1.0,
        rest: rest.positions[tip] - rest.positions[first],
        in_run: true,
    }
}

impl Direction {
    /// Value on the path `points`.
    pub fn on(&self, points: &[c64]) -> c64 {
        self.scale * (path::at(points, self.to) - path::at(points, self.from))
    }

    /// Unit rotation from rest to the path `points`; none where it collapses.
    pub fn rotation(&self, points: &[c64]) -> c64 {
        let z = self.on(points) / self.rest;
        let size = z.norm_sqr().sqrt();
        if size < 1e-9 { c64::new(1.0, 0.0) } else { z / size }
    }
}
