//! Filters and derivatives of what is sampled along time.
//!
//! Positions are filtered only to be differentiated, and never written back. All kernels are Gaussians whose widths are stated
//! for 30 frames a second; ends are extended by point reflection, as a held end would brake a moving body to rest.
//!
//! [`Filter::Gaussian`] is what the touch-up optimises; [`Filter::Butterworth`] judges it by derivatives that were not
//! optimised.

mod butterworth;
mod kernel;
mod lanes;
pub mod orientation;

pub use butterworth::low_pass;
pub use kernel::{Kernel, smooth, smooth_from_rest};
pub use lanes::Lanes;

/// Width of the kernel before derivatives, frames at 30 fps.
pub const DERIVATIVE_WIDTH: f64 = 5.0;

/// Cut-off of the second judge, Hz.
pub const JUDGE_CUTOFF: f64 = 6.0;

/// How positions are filtered before they are differentiated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Filter {
    /// Gaussian of width [`DERIVATIVE_WIDTH`].
    #[default]
    Gaussian,
    /// Second-order Butterworth at [`JUDGE_CUTOFF`], forwards and back.
    Butterworth,
}

impl Filter {
    /// `lanes` at `fps`, filtered. Cost: linear in frames times lanes (times taps for a Gaussian).
    pub fn apply(self, lanes: &Lanes, fps: f64) -> Lanes {
        match self {
            Self::Gaussian => smooth(lanes, &Kernel::gaussian(DERIVATIVE_WIDTH, fps)),
            Self::Butterworth => low_pass(lanes, JUDGE_CUTOFF, fps),
        }
    }

    /// Second derivative of the filtered `lanes`, per second squared.
    pub fn accelerations(self, lanes: &Lanes, fps: f64) -> Lanes {
        second_differences(&self.apply(lanes, fps), fps)
    }
}

/// `(s_{k+1} − 2 s_k + s_{k−1})·fps²` of each lane; the first and the last frame copy their neighbours. 0 of fewer than three
/// frames.
pub fn second_differences(lanes: &Lanes, fps: f64) -> Lanes {
    let count = lanes.frame_count;
    let mut result = Lanes::zeros(lanes.lane_count(), count);
    if count < 3 {
        return result;
    }
    let rate_sq = fps * fps;
    for index in 0..lanes.lane_count() {
        let (from, to) = (lanes.lane(index), result.lane_mut(index));
        for (acceleration, s) in to[1..count - 1].iter_mut().zip(from.windows(3)) {
            *acceleration = (s[2] - 2.0 * s[1] + s[0]) * rate_sq;
        }
        to[0] = to[1];
        to[count - 1] = to[count - 2];
    }
    result
}
