//! Displacements of a foot between its plants: from one to the next without a jump or a kink, nothing far from any.

use crate::full_body::plants::{Displacement, Plant};

/// Displacements known at the samples of plants, carried on into the samples between.
///
/// `displacements`: one a sample; those outside plants are overwritten. `fade`: seconds that a displacement takes to vanish.
/// In a gap shorter than two fades it goes straight to the next one instead. Cubic Hermite, with the slopes that the
/// displacement has where a plant ends, so that the foot leaves and meets the ground as fast as it moves there.
pub fn fill(times: &[f64], plants: &[Plant], fade: f64, displacements: &mut [Displacement]) {
    let Some(last) = times.len().checked_sub(1) else {
        return;
    };
    let mut before: Option<Knot> = None;
    let mut from = 0;
    for plant in plants {
        let after = Knot::at_start(times, displacements, plant);
        fill_gap(times, from..plant.first, [before, Some(after)], fade, displacements);
        before = Some(Knot::at_end(times, displacements, plant));
        from = plant.last + 1;
    }
    fill_gap(times, from..last + 1, [before, None], fade, displacements);
}

/// A displacement at a time, and how fast it changes.
#[derive(Clone, Copy, Debug)]
struct Knot {
    time: f64,
    value: Displacement,
    slope: Displacement,
}

/// Samples over which the slope at an end of a plant is taken.
const SLOPE_SAMPLES: usize = 3;

impl Knot {
    fn at_start(times: &[f64], displacements: &[Displacement], plant: &Plant) -> Self {
        let other = (plant.first + SLOPE_SAMPLES - 1).min(plant.last);
        Self::new(times, displacements, plant.first, other)
    }

    fn at_end(times: &[f64], displacements: &[Displacement], plant: &Plant) -> Self {
        let other = (plant.last + 1).saturating_sub(SLOPE_SAMPLES).max(plant.first);
        Self::new(times, displacements, plant.last, other)
    }

    fn new(times: &[f64], displacements: &[Displacement], at: usize, other: usize) -> Self {
        let (value, near) = (displacements[at], displacements[other]);
        let span = times[at] - times[other];
        let slope = if span == 0.0 {
            Displacement::default()
        } else {
            Displacement { shift: (value.shift - near.shift) / span, turn: (value.turn - near.turn) / span }
        };
        Self { time: times[at], value, slope }
    }

    const fn nothing(time: f64) -> Self {
        let none = Displacement { shift: glam::DVec3::ZERO, turn: glam::DVec3::ZERO };
        Self { time, value: none, slope: none }
    }
}

fn fill_gap(
    times: &[f64],
    gap: std::ops::Range<usize>,
    [before, after]: [Option<Knot>; 2],
    fade: f64,
    displacements: &mut [Displacement],
) {
    for at in gap {
        let time = times[at];
        displacements[at] = match [before, after] {
            [Some(before), Some(after)] if after.time - before.time < 2.0 * fade => {
                between(&before, &after, time)
            }
            [Some(before), _] if time < before.time + fade => {
                between(&before, &Knot::nothing(before.time + fade), time)
            }
            [_, Some(after)] if time > after.time - fade => {
                between(&Knot::nothing(after.time - fade), &after, time)
            }
            _ => Displacement::default(),
        };
    }
}

/// The cubic that has the values and slopes of both knots.
fn between(from: &Knot, to: &Knot, time: f64) -> Displacement {
    let span = to.time - from.time;
    let u = ((time - from.time) / span).clamp(0.0, 1.0);
    let (u2, u3) = (u * u, u * u * u);
    let (late, leaving, meeting) = (3.0 * u2 - 2.0 * u3, u3 - 2.0 * u2 + u, u3 - u2);
    let blend = |a, b, slope_a, slope_b| -> glam::DVec3 {
        a * (1.0 - late) + b * late + (slope_a * leaving + slope_b * meeting) * span
    };
    Displacement {
        shift: blend(from.value.shift, to.value.shift, from.slope.shift, to.slope.shift),
        turn: blend(from.value.turn, to.value.turn, from.slope.turn, to.slope.turn),
    }
}
