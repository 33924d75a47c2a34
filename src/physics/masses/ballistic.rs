//! Masses by flights: the centre of mass moves along a line on the plan and falls along a parabola.

use nalgebra::{DMatrix, DVector};

use super::{MassError, places, qp, reweighed, segments_of};
use crate::physics::body_model::{BodyModel, Segment};
use crate::physics::posed::{PosedClip, link_places};

/// How masses are fitted to flights.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlightMassSettings {
    /// Weight of a squared change of one segment's mass, m²/kg²: for captures, whose errors are joint centres; 1e-5 for white noise.
    pub pull: f64,
    /// Farther from a parabola (root mean square, metres) than this a flight tells nothing, and the table's masses are kept.
    pub farthest: f64,
    /// Fewer frames in the air, of all flights together, are an error.
    pub fewest: usize,
}

impl Default for FlightMassSettings {
    fn default() -> Self {
        Self { pull: 1e-3, farthest: 0.01, fewest: 15 }
    }
}

/// Masses fitted to flights.
#[derive(Clone, Debug, PartialEq)]
pub struct FlightFit {
    /// The body with them.
    pub body: BodyModel,
    /// New mass over the table's, of each segment that the body has.
    pub factors: Vec<(Segment, f64)>,
    /// Of the segments' shares in what is off the trajectories, metres, falling.
    pub singular_values: Vec<f64>,
    /// Distance of the centre of mass from its trajectory before and after, root mean square, metres.
    pub residuals: [f64; 2],
    /// Whether the flights were near enough to parabolas to fit masses at all.
    pub is_fitted: bool,
}

impl FlightFit {
    /// Largest relative change of a segment; above 0.6 the pull is too weak.
    pub fn largest_change(&self) -> f64 {
        self.factors.iter().map(|(_, factor)| (factor - 1.0).abs()).fold(0.0, f64::max)
    }
}

/// Fits the masses of `body` to `flights` of one performer: poses, first and last frame in the air. Each has a trajectory of its own,
/// whose curvature is free.
///
/// ```text
///     min Σ_t | Σ_g x_g c_g(t) − trajectory(t) |² + pull Σ_g count_g (m_g (x_g − 1))²,   Σ_g M_g x_g = M,  x_g ≥ 0
/// ```
///
/// with `c_g` a group's share in the centre of mass, `M_g` its mass, `m_g` that of one of its segments. Trajectories are eliminated by
/// projecting every coordinate off its polynomials. Cost: linear in frames.
///
/// # Errors
/// [`MassError::TooShort`] with fewer frames in the air than asked for; [`MassError::Unsolved`] if the program is not solved.
///
/// Source: Majkowska and Faloutsos, *Flipping with Physics*, SCA 2007, section 4.1.
pub fn masses_from_flight(
    body: &BodyModel,
    flights: &[(&PosedClip, usize, usize)],
    settings: &FlightMassSettings,
) -> Result<FlightFit, MassError> {
    let frames: usize = flights.iter().map(|(_, first, last)| last + 1 - first).sum();
    if frames < settings.fewest {
        return Err(MassError::TooShort { frames, needed: settings.fewest });
    }
    let segments = segments_of(body);
    let blocks: Vec<DMatrix<f64>> =
        flights.iter().flat_map(|flight| shares_off_trajectory(body, &segments, flight)).collect();
    let mut gram = DMatrix::zeros(segments.len(), segments.len());
    for block in &blocks {
        gram += block.transpose() * block;
    }
    let residual = |factors: &[f64]| {
        let factors = DVector::from_column_slice(factors);
        let sum_sq: f64 = blocks.iter().map(|block| (block * &factors).norm_squared()).sum();
        (sum_sq / frames as f64).sqrt()
    };
    let ones = vec![1.0; segments.len()];
    let before = residual(&ones);
    let is_fitted = before <= settings.farthest;
    let factors = if is_fitted { fitted(body, &segments, &gram, settings.pull)? } else { ones };
    let mut singular_values: Vec<f64> =
        gram.symmetric_eigenvalues().iter().map(|value| value.max(0.0).sqrt()).collect();
    singular_values.sort_by(|a, b| b.total_cmp(a));
    Ok(FlightFit {
        body: reweighed(body, &segments, &factors),
        singular_values,
        residuals: [before, residual(&factors)],
        is_fitted,
        factors: segments.into_iter().zip(factors).collect(),
    })
}

fn fitted(
    body: &BodyModel,
    segments: &[Segment],
    gram: &DMatrix<f64>,
    pull: f64,
) -> Result<Vec<f64>, MassError> {
    let all = body.segment_masses();
    let mass =
        |segment: Segment| Segment::ALL.iter().position(|own| *own == segment).map_or(0.0, |at| all[at]);
    let masses: Vec<f64> = segments.iter().map(|segment| mass(*segment)).collect();
    // count (M/count)² = M²/count.
    let weights: Vec<f64> =
        segments.iter().zip(&masses).map(|(own, mass)| pull * mass * mass / own.count() as f64).collect();
    let rows: Vec<Vec<f64>> = gram.row_iter().map(|row| row.iter().copied().collect()).collect();
    qp::solve_dense(&rows, &weights, &masses)
}

/// For x, y and z: what each segment adds to the centre of mass in each frame, without the polynomial nearest to it; metres.
fn shares_off_trajectory(
    body: &BodyModel,
    segments: &[Segment],
    (posed, first, last): &(&PosedClip, usize, usize),
) -> [DMatrix<f64>; 3] {
    let lanes = link_places(body, posed);
    let places = places(body, segments);
    let count = last + 1 - first;
    [(0, 1), (1, 2), (2, 1)].map(|(coordinate, degree)| {
        let mut shares = DMatrix::zeros(count, segments.len());
        for (index, link) in body.links.iter().enumerate() {
            let lane = &lanes.lane(3 * index + coordinate)[*first..=*last];
            for (frame, place) in lane.iter().enumerate() {
                shares[(frame, places[index])] += link.mass / body.mass * place;
            }
        }
        off_polynomial(shares, degree)
    })
}

/// Every column less the polynomial of `degree` nearest to it.
fn off_polynomial(columns: DMatrix<f64>, degree: usize) -> DMatrix<f64> {
    let count = columns.nrows();
    let time = |frame: usize| 2.0 * frame as f64 / (count.max(2) - 1) as f64 - 1.0;
    let powers =
        DMatrix::from_fn(count, degree + 1, |frame, power| (0..power).map(|_| time(frame)).product());
    let basis = powers.qr().q();
    let along = basis.transpose() * &columns;
    columns - basis * along
}
