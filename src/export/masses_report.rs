//! The body that a touch-up reckoned with, for a report.

use serde::Serialize;

use crate::physics::body_model::{BodyModel, Segment};
use crate::physics::masses::{FlightFit, MassFit};

/// Mass of a segment, left and right together.
#[derive(Clone, Debug, Serialize)]
pub struct SegmentPart {
    /// Its name.
    pub segment: &'static str,
    /// kg.
    pub mass: f64,
    /// Over the table's, where masses are estimated.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub factor: Option<f64>,
}

/// Where estimated masses come from.
#[derive(Clone, Debug, Serialize)]
pub struct EstimatePart {
    /// `flight` or `ground`.
    pub by: &'static str,
    /// What the motion says of the masses, falling: what is small is not told by it. Metres of the centre of mass by flight, metres per
    /// kilogram of zero moment points on the ground.
    pub singular_values: Vec<f64>,
    /// What is off, with the table's masses and with the new ones, metres: the centre of mass from its trajectory, zero moment
    /// points from polygons.
    pub off: [f64; 2],
    /// Largest relative change of a segment.
    pub largest_change: f64,
    #[serde(skip)]
    factors: Vec<(Segment, f64)>,
}

impl From<&FlightFit> for EstimatePart {
    fn from(fit: &FlightFit) -> Self {
        Self {
            by: "flight",
            singular_values: fit.singular_values.clone(),
            off: fit.residuals,
            largest_change: fit.largest_change(),
            factors: fit.factors.clone(),
        }
    }
}

impl From<&MassFit> for EstimatePart {
    fn from(fit: &MassFit) -> Self {
        Self {
            by: "ground",
            singular_values: fit.singular_values.clone(),
            off: fit.distances,
            largest_change: fit.largest_change(),
            factors: fit.factors.clone(),
        }
    }
}

/// Estimated masses beyond these factors of the table's are doubtful.
const FAR_FACTORS: std::ops::RangeInclusive<f64> = 0.5..=2.0;

impl EstimatePart {
    /// What to think about before the masses are used: segments of more than twice, or less than half of what the table gives them.
    pub fn doubts(&self) -> Vec<String> {
        let far = self.factors.iter().filter(|(_, factor)| !FAR_FACTORS.contains(factor));
        let told = |(segment, factor): &(Segment, f64)| {
            format!("masses by {}: {} has {factor:.2} times the mass of the table", self.by, segment.name())
        };
        far.map(told).collect()
    }
}

/// The body that was reckoned with.
#[derive(Clone, Debug, Serialize)]
pub struct BodyPart {
    /// `winter75` or `xiao2005`.
    pub table: &'static str,
    /// kg.
    pub mass: f64,
    /// By the length of the legs.
    pub stature: f64,
    /// Those that the body has.
    pub segments: Vec<SegmentPart>,
    /// Where masses are estimated.
    pub estimate: Option<EstimatePart>,
}

impl BodyPart {
    /// Of `body`, whose masses are from `table` or the `estimate`.
    pub fn of(body: &BodyModel, table: &'static str, estimate: Option<EstimatePart>) -> Self {
        let factor = |segment: Segment| {
            let factors = &estimate.as_ref()?.factors;
            factors.iter().find(|(own, _)| *own == segment).map(|(_, factor)| *factor)
        };
        let part = |(segment, mass): (Segment, f64)| SegmentPart {
            segment: segment.name(),
            mass,
            factor: factor(segment),
        };
        let segments = Segment::ALL.into_iter().zip(body.segment_masses()).filter(|(_, mass)| *mass > 0.0);
        Self {
            table,
            mass: body.mass,
            stature: body.stature,
            segments: segments.map(part).collect(),
            estimate,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn masses_below_half_and_above_twice_the_table_are_doubtful() {
        let factors = vec![
            (Segment::Thigh, 0.49),
            (Segment::Shank, 0.5),
            (Segment::Foot, 2.0),
            (Segment::Abdomen, 2.04),
        ];
        let body = BodyModel { links: Vec::new(), mass: 75.0, stature: 1.75 };
        let fit = MassFit { body, factors, singular_values: Vec::new(), distances: [0.0; 2], frames: 1 };
        let doubts = EstimatePart::from(&fit).doubts();
        let [below, above] = &doubts[..] else { panic!("{doubts:?}") };
        assert!(
            below.contains("thigh has 0.49 times") && above.contains("abdomen has 2.04 times"),
            "{doubts:?}"
        );
    }
}
