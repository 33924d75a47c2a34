//! Curves on the plan, by arc length.

use std::f64::consts::TAU;

use super::{Along, RelayError};
use crate::geometry::{c64, cis};

/// Turns of the spiral are so far apart, metres: room for a zigzag and for disturbers on both sides.
pub const TURNS_APART: f64 = 6.0;

/// The spiral starts so far from its middle, metres.
const FIRST_RADIUS: f64 = 5.0;

/// Smallest circle to stand on, metres.
pub const SMALLEST_RADIUS: f64 = 4.0;

/// Corners of bent curves are so far apart, as a share of the radius: chords are off by an eighty thousandth of it.
const STEP: f64 = 0.01;

/// Points joined by straight lines.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    points: Vec<c64>,
    /// Metres from the first point to each.
    lengths: Vec<f64>,
}

impl Curve {
    /// Through these points.
    ///
    /// # Errors
    /// [`RelayError::NoCurve`] where they are all one.
    pub fn through(mut points: Vec<c64>) -> Result<Self, RelayError> {
        points.dedup();
        let mut length = 0.0;
        let mut lengths = vec![0.0];
        for pair in points.windows(2) {
            length += (pair[1] - pair[0]).norm();
            lengths.push(length);
        }
        if points.len() < 2 || length <= 0.0 || !length.is_finite() {
            return Err(RelayError::NoCurve);
        }
        Ok(Self { points, lengths })
    }

    /// Metres from end to end.
    pub fn length(&self) -> f64 {
        self.lengths[self.lengths.len() - 1]
    }

    /// The point `s` metres from the first, straight on beyond the ends.
    pub fn at(&self, s: f64) -> c64 {
        let next = self.lengths.partition_point(|length| *length < s).clamp(1, self.lengths.len() - 1);
        let (from, to) = (self.lengths[next - 1], self.lengths[next]);
        let (a, b) = (self.points[next - 1], self.points[next]);
        a + (b - a) * ((s - from) / (to - from))
    }

    /// Direction about `s`, seen over `reach` metres before and behind; of length 1, along x where the curve is back by then.
    pub fn direction(&self, s: f64, reach: f64) -> c64 {
        let chord = self.at(s + reach) - self.at(s - reach);
        if chord.norm() > 1e-9 { chord / chord.norm() } else { c64::new(1.0, 0.0) }
    }
}

/// The curve for `carriers`, and how far apart their hand-overs are on it.
///
/// # Errors
/// [`RelayError`] where they do not fit it.
pub fn curve(along: &Along, carriers: usize, spacing: Option<f64>) -> Result<(Curve, f64), RelayError> {
    let asked = spacing.unwrap_or(super::SPACING);
    let sound = |spacing: f64| (super::SPACINGS.0..=super::SPACINGS.1).contains(&spacing);
    if !sound(asked) {
        return Err(RelayError::Spacing(asked));
    }
    let needed = asked * carriers as f64;
    let curve = match along {
        Along::Line => Curve::through(vec![c64::new(0.0, 0.0), c64::new(needed, 0.0)])?,
        Along::Circle => circle(needed, carriers)?,
        Along::Spiral => spiral(needed)?,
        Along::Drawing(points) => scaled(points, needed)?,
        Along::Points(points) => {
            let curve = Curve::through(points.clone())?;
            let length = curve.length();
            let own = length / carriers as f64;
            if spacing.is_none() {
                let error = RelayError::Stretched { length, carriers, spacing: own };
                return if sound(own) { Ok((curve, own)) } else { Err(error) };
            }
            // Room enough to rounding.
            if length < needed * (1.0 - 1e-9) {
                let fit = (2..carriers).rev().find(|fit| asked * *fit as f64 <= length).unwrap_or(0);
                return Err(RelayError::TooShort { length, carriers, spacing: asked, needed, fit });
            }
            curve
        }
    };
    Ok((curve, asked))
}

fn circle(length: f64, carriers: usize) -> Result<Curve, RelayError> {
    let radius = length / TAU;
    if radius < SMALLEST_RADIUS {
        return Err(RelayError::Tight { carriers, radius });
    }
    let corners = (TAU / STEP).ceil();
    let angles = (0_u32..).map(f64::from).take_while(|corner| *corner <= corners);
    Curve::through(angles.map(|corner| cis(TAU * corner / corners) * radius).collect())
}

/// An Archimedean spiral.
fn spiral(length: f64) -> Result<Curve, RelayError> {
    let growth = TURNS_APART / TAU;
    let (mut angle, mut gone) = (0.0, 0.0);
    let mut points = vec![c64::new(FIRST_RADIUS, 0.0)];
    while gone < length {
        let radius = FIRST_RADIUS + growth * angle;
        angle += STEP * radius / radius.hypot(growth);
        let next = cis(angle) * (FIRST_RADIUS + growth * angle);
        gone += (next - points[points.len() - 1]).norm();
        points.push(next);
    }
    Curve::through(points)
}

/// A drawing as long as needed, its first point where it was.
fn scaled(points: &[c64], length: f64) -> Result<Curve, RelayError> {
    let drawn = Curve::through(points.to_vec())?;
    let (first, scale) = (drawn.points[0], length / drawn.length());
    if !scale.is_finite() {
        return Err(RelayError::NoCurve);
    }
    Curve::through(points.iter().map(|point| (*point - first) * scale).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curves_go_by_arc_length() {
        let bent = Curve::through(vec![c64::new(0.0, 0.0), c64::new(3.0, 0.0), c64::new(3.0, 4.0)]);
        let bent = bent.expect("it has a length");
        assert_eq!(
            (bent.length(), bent.at(3.0), bent.at(5.0)),
            (7.0, c64::new(3.0, 0.0), c64::new(3.0, 2.0))
        );
        assert_eq!((bent.at(-1.0), bent.at(8.0)), (c64::new(-1.0, 0.0), c64::new(3.0, 5.0)));
        assert!((bent.direction(3.0, 1.0) - c64::new(0.5_f64.sqrt(), 0.5_f64.sqrt())).norm() < 1e-12);
    }

    #[test]
    fn circles_and_spirals_are_as_long_as_needed_and_round() {
        let (circle, spacing) = curve(&Along::Circle, 12, None).expect("twelve have room");
        // The corners cut four millionths of it.
        assert!((circle.length() - 12.0 * spacing).abs() < 1e-3);
        assert!((circle.at(0.0) - circle.at(circle.length())).norm() < 1e-9);
        let (spiral, spacing) = curve(&Along::Spiral, 40, None).expect("there is always room");
        assert!(spiral.length() >= 40.0 * spacing);
        let turn = |n: f64| FIRST_RADIUS + TURNS_APART * n;
        let along = (0..4000).map(|n| spiral.at(0.04 * f64::from(n)));
        let crossings: Vec<f64> = along
            .collect::<Vec<_>>()
            .windows(2)
            .filter(|pair| pair[0].im < 0.0 && pair[1].im >= 0.0)
            .map(|pair| pair[1].re)
            .collect();
        // The sampled crossing is up to 0.04 m of arc late, where the radius grows by 0.01 m.
        assert!((crossings[0] - turn(1.0)).abs() < 0.02, "{crossings:?}");
    }

    #[test]
    fn what_does_not_fit_says_how_much_would() {
        let line = |length: f64| Along::Points(vec![c64::new(0.0, 0.0), c64::new(0.0, length)]);
        assert_eq!(curve(&line(40.0), 10, None).map(|(_, spacing)| spacing), Ok(4.0));
        assert!(matches!(curve(&line(40.0), 10, Some(5.0)), Err(RelayError::TooShort { fit: 8, .. })));
        assert!(matches!(curve(&line(20.0), 10, None), Err(RelayError::Stretched { .. })));
        assert!(matches!(curve(&line(0.0), 10, None), Err(RelayError::NoCurve)));
        assert!(matches!(curve(&Along::Circle, 5, None), Err(RelayError::Tight { .. })));
        assert!(matches!(curve(&Along::Line, 5, Some(0.5)), Err(RelayError::Spacing(_))));
        let drawn = Along::Drawing(vec![c64::new(5.0, 5.0), c64::new(5.0, 7.0)]);
        let (drawn, _) = curve(&drawn, 10, Some(4.0)).expect("drawings grow");
        assert!((drawn.length() - 40.0).abs() < 1e-9 && drawn.at(0.0).norm() < 1e-12);
    }
}
