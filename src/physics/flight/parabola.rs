//! Where the centre of mass is in flight.

use glam::DVec3;

/// Path of what nothing bears.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parabola {
    /// Place at its start, metres.
    pub start: DVec3,
    /// Velocity there, m/s.
    pub velocity: DVec3,
    /// Downward, m/s².
    pub gravity: f64,
}

impl Parabola {
    /// Place `seconds` after the start: `c0 + v0 s + g s²/2`, metres.
    pub fn at(&self, seconds: f64) -> DVec3 {
        self.start + self.velocity * seconds - DVec3::Y * (0.5 * self.gravity * seconds * seconds)
    }
}

/// The parabola of `gravity` (m/s² downwards) for the places `centers`, `step` seconds apart. `held`: whether it meets the first and the
/// last of them, where a body leaves the ground and comes back; a clip that starts or ends in the air has no such place, and the
/// parabola is the one nearest to all of them, by least squares of what is free.
pub fn parabola(centers: &[DVec3], step: f64, gravity: f64, held: [bool; 2]) -> Parabola {
    let count = centers.len();
    let seconds = |index: usize| index as f64 * step;
    // Without the fall, what is left is a line.
    let line = |index: usize| centers[index] + DVec3::Y * (0.5 * gravity * seconds(index).powi(2));
    let Some(last) = count.checked_sub(1).filter(|last| *last > 0) else {
        let start = centers.first().copied().unwrap_or(DVec3::ZERO);
        return Parabola { start, velocity: DVec3::ZERO, gravity };
    };
    let (anchor, place) = match held {
        [true, _] => (0.0, line(0)),
        [false, true] => (seconds(last), line(last)),
        [false, false] => (0.5 * seconds(last), (0..count).map(line).sum::<DVec3>() / count as f64),
    };
    let velocity = if held == [true, true] {
        (line(last) - place) / seconds(last)
    } else {
        let arms = || (0..count).map(|index| seconds(index) - anchor);
        let product: DVec3 = arms().enumerate().map(|(index, arm)| arm * (line(index) - place)).sum();
        product / arms().map(|arm| arm * arm).sum::<f64>()
    };
    Parabola { start: place - velocity * anchor, velocity, gravity }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::GRAVITY;

    /// Rounding of a few operations on metres.
    const ROUNDING: f64 = 1e-12;

    #[test]
    fn a_throw_has_the_stated_velocity_and_height() {
        let ends = [DVec3::ZERO, DVec3::new(0.6, 0.2, 1.1)];
        let parabola = parabola(&ends, 0.8, GRAVITY, [true, true]);
        assert!(parabola.velocity.distance(DVec3::new(0.75, 4.174, 1.375)) < ROUNDING, "{parabola:?}");
        assert!(parabola.at(0.4).distance(DVec3::new(0.3, 0.8848, 0.55)) < ROUNDING);
        assert!(parabola.at(0.8).distance(DVec3::new(0.6, 0.2, 1.1)) < ROUNDING);
    }

    #[test]
    fn whatever_is_held_a_flight_is_its_own_parabola() {
        let own = Parabola {
            start: DVec3::new(0.3, 1.0, -0.2),
            velocity: DVec3::new(1.5, 3.0, 0.4),
            gravity: GRAVITY,
        };
        let centers: Vec<DVec3> = (0..40).map(|k| own.at(f64::from(k) / 60.0)).collect();
        for held in [[true, true], [true, false], [false, true], [false, false]] {
            let found = parabola(&centers, 1.0 / 60.0, GRAVITY, held);
            let off = found.start.distance(own.start) + found.velocity.distance(own.velocity);
            assert!(off < ROUNDING, "{held:?}: {found:?}");
        }
    }

    #[test]
    fn what_is_held_is_met_and_the_rest_is_nearest() {
        let wobble = |k: u32| DVec3::new(f64::from(k).sin(), (1.7 * f64::from(k)).cos(), 0.1) * 0.02;
        let centers: Vec<DVec3> = (0..30).map(|k| DVec3::X * (0.05 * f64::from(k)) + wobble(k)).collect();
        let off = |found: Parabola| -> f64 {
            let at = |(k, center): (usize, &DVec3)| found.at(k as f64 / 30.0).distance_squared(*center);
            centers.iter().enumerate().map(at).sum()
        };
        for held in [[true, false], [false, true]] {
            let found = parabola(&centers, 1.0 / 30.0, 0.0, held);
            let end = if held[0] { 0 } else { 29 };
            assert!(found.at(end as f64 / 30.0).distance(centers[end]) < ROUNDING);
            for nudge in [DVec3::X, DVec3::Y, -DVec3::Y] {
                let velocity = found.velocity + 1e-3 * nudge;
                let start = found.at(end as f64 / 30.0) - velocity * (end as f64 / 30.0);
                assert!(off(Parabola { start, velocity, gravity: 0.0 }) > off(found));
            }
        }
    }
}
