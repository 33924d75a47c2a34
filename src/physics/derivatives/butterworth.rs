//! The second judge: a Butterworth filter of second order, run forwards and back.

use std::f64::consts::{PI, SQRT_2};

use super::Lanes;
use super::kernel::extend;
use crate::index::floor_index;

/// Ends are extended by so many periods of the cut-off: in each the filter forgets all but a hundredth.
const EXTENSION: f64 = 6.0;

/// `lanes` at `fps` without what is faster than `cutoff` Hz, without phase: the gain at the cut-off is 1/2. Ends are extended by
/// point reflection. A cut-off at or above half the rate changes nothing. Cost: linear.
///
/// Source: bilinear transform, Oppenheim and Schafer, *Discrete-Time Signal Processing*, 3rd ed., §7.2.
pub fn low_pass(lanes: &Lanes, cutoff: f64, fps: f64) -> Lanes {
    if cutoff >= 0.5 * fps {
        return lanes.clone();
    }
    let section = Section::low_pass(cutoff / fps);
    let more = floor_index(EXTENSION * fps / cutoff);
    let mut result = Lanes::zeros(lanes.lane_count(), lanes.frame_count);
    let mut extended = Vec::new();
    for index in 0..lanes.lane_count() {
        extend(lanes.lane(index), more, &mut extended);
        section.run(extended.iter_mut());
        section.run(extended.iter_mut().rev());
        let count = lanes.frame_count;
        result.lane_mut(index).copy_from_slice(&extended[more..more + count]);
    }
    result
}

/// `y_k = b (x_k + 2 x_{k−1} + x_{k−2}) − a_1 y_{k−1} − a_2 y_{k−2}`.
struct Section {
    b: f64,
    a: [f64; 2],
}

impl Section {
    /// `frequency`: of the cut-off, cycles a frame, below 1/2.
    fn low_pass(frequency: f64) -> Self {
        let warped = (PI * frequency).tan();
        let norm = 1.0 / (1.0 + SQRT_2 * warped + warped * warped);
        Self {
            b: warped * warped * norm,
            a: [2.0 * (warped * warped - 1.0) * norm, (1.0 - SQRT_2 * warped + warped * warped) * norm],
        }
    }

    /// Filters in place, as if the first value had been there always.
    fn run<'a>(&self, values: impl Iterator<Item = &'a mut f64>) {
        let mut state: Option<[f64; 4]> = None;
        for value in values {
            let x = *value;
            let [x_1, x_2, y_1, y_2] = state.unwrap_or([x; 4]);
            let y = self.b * (x + 2.0 * x_1 + x_2) - self.a[0] * y_1 - self.a[1] * y_2;
            state = Some([x, x_1, y, y_1]);
            *value = y;
        }
    }
}
