//! What a flight falls like: a parabola fitted to the centre of mass, and what is doubtful where it is none.

use glam::DVec3;

use crate::clip::flight::fitted_gravity;
use crate::index::floor_index;
use crate::physics::GRAVITY;

/// Shorter flights claim nothing, seconds.
pub const SHORTEST_FLIGHT: f64 = 0.2;

/// A flight falls at this many m/s² …
pub const PLAUSIBLE_GRAVITY: std::ops::RangeInclusive<f64> = 8.3..=11.3;
/// … and no farther from its parabola than this, metres.
pub const PLAUSIBLE_RESIDUAL: f64 = 0.02;

/// Share of a doubtful flight left out at either end.
const BORDER: f64 = 0.1;

/// How a flight falls.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlightCheck {
    /// First frame in the air.
    pub first: usize,
    /// Last frame in the air.
    pub last: usize,
    /// Of the parabola nearest to the height of the centre of mass, m/s².
    pub gravity: f64,
    /// Farthest that height is from it, metres.
    pub residual: f64,
    /// Rate at which it would fall as bodies do, frames per second; `None` where it does not fall.
    pub mending_rate: Option<f64>,
    /// Factor of all lengths with which it would; `None` where it does not fall.
    pub mending_scale: Option<f64>,
}

impl FlightCheck {
    /// Whether labels, rate or scale are doubtful.
    pub fn is_doubtful(&self) -> bool {
        !PLAUSIBLE_GRAVITY.contains(&self.gravity) || self.residual > PLAUSIBLE_RESIDUAL
    }
}

impl std::fmt::Display for FlightCheck {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { first, last, gravity, residual, .. } = self;
        let millimetres = residual * 1e3;
        write!(
            f,
            "frames {first} to {last} fall at {gravity:.1} m/s², up to {millimetres:.0} mm off a parabola"
        )?;
        match (self.mending_rate, self.mending_scale) {
            _ if !self.is_doubtful() => Ok(()),
            (Some(rate), Some(scale)) => {
                let mended = "which would mend the fall";
                write!(
                    f,
                    ": labels, rate or scale doubtful ({rate:.1} fps or {scale:.3} times as large, {mended})"
                )
            }
            _ => f.write_str(": labels, rate or scale doubtful"),
        }
    }
}

/// How the frames `first` to `last` of `heights` (of the centre of mass, unfiltered, metres, all frames at `fps`) fall; `None` for a
/// flight shorter than [`SHORTEST_FLIGHT`].
///
/// A flight that is doubtful is fitted once more without a tenth at either end: at a wrong rate labels begin and end where feet push.
/// Rates and scales go by `fps·√(9.81/g)` and `9.81/g`.
pub fn check_flight(heights: &[f64], (first, last): (usize, usize), fps: f64) -> Option<FlightCheck> {
    let count = last + 1 - first;
    // Rounding is no shortage; three points have no residual.
    if (count as f64) < SHORTEST_FLIGHT * fps - 1e-6 || count < 4 {
        return None;
    }
    let fit = |from: usize, to: usize| {
        let heights = &heights[from..=to];
        let gravity = fitted_gravity(heights, 1.0 / fps);
        let falls = gravity > 0.0;
        FlightCheck {
            first,
            last,
            gravity,
            residual: residual(heights, gravity, 1.0 / fps),
            mending_rate: falls.then(|| fps * (GRAVITY / gravity).sqrt()),
            mending_scale: falls.then(|| GRAVITY / gravity),
        }
    };
    let whole = fit(first, last);
    let border = floor_index(BORDER * count as f64);
    let inner = fit(first + border, last - border);
    // What is right without its ends had only wrong labels, which are doubtful, too.
    Some(if whole.is_doubtful() && inner.is_doubtful() { inner } else { whole })
}

/// Largest distance of `heights` from the parabola nearest to them, whose `gravity` is known, metres.
fn residual(heights: &[f64], gravity: f64, step: f64) -> f64 {
    let middle = 0.5 * (heights.len() as f64 - 1.0);
    let time = |k: usize| (k as f64 - middle) * step;
    // What is left of the fall is a line, whose slope and mean are those of the data: times are symmetric.
    let risen: Vec<f64> =
        heights.iter().enumerate().map(|(k, height)| height + 0.5 * gravity * time(k).powi(2)).collect();
    let mean = risen.iter().sum::<f64>() / risen.len() as f64;
    let (mut product, mut norm_sq) = (0.0, 0.0);
    for (k, height) in risen.iter().enumerate() {
        product += time(k) * (height - mean);
        norm_sq += time(k).powi(2);
    }
    let slope = product / norm_sq;
    let off = |(k, height): (usize, &f64)| (height - mean - slope * time(k)).abs();
    risen.iter().enumerate().map(off).fold(0.0, f64::max)
}

/// Velocity with which something must be thrown to be `displacement` (metres) away after `seconds`: `d/T − g T/2`, m/s.
pub fn launch_velocity(displacement: DVec3, seconds: f64) -> DVec3 {
    displacement / seconds + DVec3::Y * (0.5 * GRAVITY * seconds)
}

/// Where something thrown with `velocity` (m/s) is after `seconds`, from where it was, metres.
pub fn thrown(velocity: DVec3, seconds: f64) -> DVec3 {
    velocity * seconds - DVec3::Y * (0.5 * GRAVITY * seconds * seconds)
}
