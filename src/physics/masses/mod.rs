//! Masses fitted to motion that is known to be physical.
//!
//! Segments keep their places; left and right ones weigh the same. What is sought are factors of the table's masses with the same
//! sum.
//!
//! On the ground zero moment points must lie in the polygons. Feet are so large that this says little: every point that lies inside
//! already says nothing, and the fit is held by a pull to the table, the stronger the farther a motion is off: rows count in units of their
//! own noise. The default is a convex quadratic program; descent by conjugate
//! gradients, as published, ends at the same objective less surely. In flight the centre of mass must follow a parabola, which says
//! more, but sees errors of joint centres as well.

mod ballistic;
mod descent;
mod ground;
mod qp;

use crate::physics::body_model::{BodyModel, Segment};
pub use ballistic::{FlightFit, FlightMassSettings, masses_from_flight};
pub use descent::descend;
pub use ground::{GroundFrame, MassProblem};

/// How masses are sought on the ground.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MassMethod {
    /// Convex quadratic program.
    #[default]
    Quadratic,
    /// Projected Polak-Ribière conjugate gradients, as published.
    ConjugateGradients,
}

/// How masses are fitted on the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MassSettings {
    /// How they are sought.
    pub method: MassMethod,
    /// Weight of a squared relative change of one segment, m² for each frame: a hundredth of it moves half of the body into the abdomen.
    pub pull: f64,
    /// The same as a share of the mean squared distance of zero moment points from polygons, by the table's masses. The larger of both pulls:
    /// what labels and joint centres get wrong by centimetres must not be put right by masses.
    pub pull_of_noise: f64,
    /// No segment gets lighter than this share of its table's mass.
    pub least: f64,
    /// Nearer frames tell nothing new, seconds.
    pub spacing: f64,
}

impl Default for MassSettings {
    fn default() -> Self {
        Self {
            method: MassMethod::Quadratic,
            pull: 1.5e-5,
            pull_of_noise: 0.25,
            least: 0.2,
            spacing: 1.0 / 60.0,
        }
    }
}

/// Why masses could not be fitted.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the messages say it")]
pub enum MassError {
    #[error("no frame stands firmly enough on the ground to tell masses by")]
    NoGround,
    #[error("{frames} frames in the air are too few to tell masses by; {needed} would do")]
    TooShort { frames: usize, needed: usize },
    #[error("the quadratic program ended with {status}")]
    Unsolved { status: String },
}

/// Fitted masses.
#[derive(Clone, Debug, PartialEq)]
pub struct MassFit {
    /// The body with them.
    pub body: BodyModel,
    /// New mass over the table's, of each segment that the body has.
    pub factors: Vec<(Segment, f64)>,
    /// Of the rows that say that zero moment points are where they are nearest to their polygons, metres per kilogram, falling: what is
    /// small is not told by the motion.
    pub singular_values: Vec<f64>,
    /// Mean distance of zero moment points from their polygons with the table's masses and with the new ones, metres.
    pub distances: [f64; 2],
    /// Frames used.
    pub frames: usize,
}

impl MassFit {
    /// Largest relative change of a segment.
    pub fn largest_change(&self) -> f64 {
        self.factors.iter().map(|(_, factor)| (factor - 1.0).abs()).fold(0.0, f64::max)
    }
}

/// Fits the masses of `body` to clips of one performer on the ground. Frames count where the ground bears enough for full confidence.
/// Cost: linear in frames; hundreds of them take tens of milliseconds.
///
/// # Errors
/// [`MassError`] where no frame counts, or the program is not solved.
pub fn masses_from_ground(
    body: &BodyModel,
    clips: &[ground::Standing<'_>],
    settings: &MassSettings,
) -> Result<MassFit, MassError> {
    let segments = segments_of(body);
    let problem = MassProblem::of(body, &segments, clips, settings.spacing);
    if problem.frames.is_empty() {
        return Err(MassError::NoGround);
    }
    let table = vec![1.0; segments.len()];
    let noise = settings.pull_of_noise * problem.mean_square_distance(&table);
    let pull = settings.pull.max(noise) * problem.frames.len() as f64;
    let factors = match settings.method {
        MassMethod::Quadratic => problem.solve(pull, settings.least)?,
        MassMethod::ConjugateGradients => descend(&problem, pull, settings.least),
    };
    Ok(MassFit {
        body: reweighed(body, &segments, &factors),
        singular_values: problem.singular_values(),
        distances: [problem.mean_distance(&table), problem.mean_distance(&factors)],
        frames: problem.frames.len(),
        factors: segments.into_iter().zip(factors).collect(),
    })
}

pub use ground::Standing;

/// Segments that `body` has, in the order of [`Segment::ALL`].
fn segments_of(body: &BodyModel) -> Vec<Segment> {
    let has = |segment: &Segment| body.links.iter().any(|link| link.segment == *segment);
    Segment::ALL.into_iter().filter(has).collect()
}

/// Place of the segment of each link in `segments`.
fn places(body: &BodyModel, segments: &[Segment]) -> Vec<usize> {
    let place = |segment| segments.iter().position(|own| *own == segment).unwrap_or(0);
    body.links.iter().map(|link| place(link.segment)).collect()
}

fn reweighed(body: &BodyModel, segments: &[Segment], factors: &[f64]) -> BodyModel {
    let places = places(body, segments);
    let masses: Vec<f64> =
        body.links.iter().zip(places).map(|(link, place)| link.mass * factors[place]).collect();
    body.with_link_masses(&masses)
}
