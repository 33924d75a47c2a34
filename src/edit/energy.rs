//! Deformation energy of an edit in units that do not depend on the frame rate.
//!
//! `Ê = κ_s (E_shape + E_scale)/h³ + κ_t E_time/h + c_s Σ lengths + c_t Σ|ΔL_t| + c_ψ Σ|Δ_seam|`; the squared terms scale
//! with the third and first power of the step when a motion is sampled more finely. Source: Kim et al. 2009, eq. 10, with
//! residual energies in place of its eq. 5, which is a constant off and falls when residuals grow.

use serde::Serialize;

use crate::clip::working::WORKING_STEP;
use crate::geometry::c64;
use crate::scene::Mode;

/// Weight of changed lengths, 1/m.
const LENGTH: f64 = 0.5;
/// Weight of changed durations, 1/s.
const DURATION: f64 = 0.5;

/// Terms of Ê, without units.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Energy {
    /// Bending of paths, with the residuals of soft constraints.
    pub shape: f64,
    /// Stretching of paths, with the residuals of soft constraints.
    pub scale: f64,
    /// Uneven time steps, with the residuals of soft constraints.
    pub time: f64,
    /// Change of path lengths.
    pub length: f64,
    /// Change of durations.
    pub duration: f64,
    /// Turns at seams that discrete edits made.
    pub turn: f64,
    /// Sum of the above.
    pub total: f64,
}

/// What one character adds to the length and duration terms.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Extent {
    /// Ground length at rest and edited, metres.
    pub length: (f64, f64),
    /// Seconds from first to last frame at rest and edited.
    pub seconds: (f64, f64),
}

/// Length of a polyline, metres.
pub fn length(points: &[c64]) -> f64 {
    points.windows(2).map(|pair| (pair[1] - pair[0]).norm_sqr().sqrt()).sum()
}

impl Energy {
    /// Ê from the sums of `½‖Mx − m‖²` of all components (m² for shape and scale, s² for time).
    pub fn new(shape: f64, scale: f64, time: f64, extents: &[Extent], mode: Mode) -> Self {
        let cube = WORKING_STEP.powi(3);
        let (shape, scale, time) = (shape / cube, scale / cube, time / WORKING_STEP);
        let changed = |extent: &Extent| length_change(extent.length, mode);
        let length = LENGTH * extents.iter().map(changed).sum::<f64>();
        let duration =
            DURATION * extents.iter().map(|extent| (extent.seconds.1 - extent.seconds.0).abs()).sum::<f64>();
        Self {
            shape,
            scale,
            time,
            length,
            duration,
            turn: 0.0,
            total: shape + scale + time + length + duration,
        }
    }
}

impl Energy {
    /// With the turns at seams, already weighted.
    pub fn with_turns(self, turn: f64) -> Self {
        Self { turn, total: self.total - self.turn + turn, ..self }
    }
}

/// `|ΔL|` in paper mode; else `L′·|ln(L′/L)|`, for which half a cycle too long and half too short are not alike.
fn length_change((rest, edited): (f64, f64), mode: Mode) -> f64 {
    match mode {
        Mode::Production if rest > 0.0 && edited > 0.0 => edited * (edited / rest).ln().abs(),
        _ => (edited - rest).abs(),
    }
}

/// A lower bound of what the length of an edited path costs, with the residuals of soft places that shorten it, in Ê.
///
/// `straight`: length of the lines between its places, metres; residuals that shorten them by R cost at least `R²/2g`, g
/// being `give`. Costs are convex in lengths, so no more than `slope·R − R²/2g ≤ g·slope²/2` is saved.
pub fn least_length_cost((rest, straight): (f64, f64), give: f64, mode: Mode) -> f64 {
    if straight <= rest {
        return 0.0;
    }
    let slope = match mode {
        Mode::Production if rest > 0.0 => 1.0 + (straight / rest).ln(),
        _ => 1.0,
    };
    let saved = 0.5 * give * (LENGTH * slope).powi(2);
    (LENGTH * length_change((rest, straight), mode) - saved).max(0.0)
}
