//! The touch-up: an edited motion made physically plausible.
//!
//! First the ground pass, for frames in which something bears, then the flight pass: what smooths must not come after a parabola. The judge
//! sees both: a flight that would leave the clip worse than it came stays as it is. No hidden state: the same input gives the same output, and an edit can be touched up again while it is dragged. Callers work on many
//! characters in parallel.

use crate::clip::Clip;
use crate::physics::body_model::BodyModel;
use crate::physics::derivatives::Filter;
use crate::physics::flight::report::{FlightFacts, FlightReport};
use crate::physics::flight::{FlightSettings, Flown, fly};
use crate::physics::ground::report::GroundReport;
use crate::physics::ground::target::Source;
use crate::physics::ground::{GroundError, GroundSettings, ground_pass};
use crate::physics::input::InputError;
use crate::physics::posed::PosedClip;
use crate::physics::stages::Stages;
use crate::physics::zmp::{DistanceSummary, ForceSettings, balances, distance_summary, link_forces};

/// How a touch-up works.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TouchUpSettings {
    /// On the ground.
    pub ground: GroundSettings,
    /// In the air; `None`: flights stay as they come from the ground pass.
    pub flight: Option<FlightSettings>,
}

/// A motion after its touch-up.
#[derive(Clone, Debug, PartialEq)]
pub struct TouchedUp {
    /// The motion.
    pub clip: Clip,
    /// What was done on the ground.
    pub ground: GroundReport,
    /// What was done in the air; of no flights where that pass is left out.
    pub flight: FlightReport,
}

/// Why there is no touch-up.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TouchUpError {
    /// None on the ground.
    #[error(transparent)]
    Ground(#[from] GroundError),
    /// None in the air.
    #[error(transparent)]
    Flight(#[from] InputError),
}

/// `clip` touched up. See [`ground_pass`] and [`fly`] for what the arguments are. The judge never sees zero moment points farther from
/// their polygons than in `clip` (where it is asked: [`GroundSettings::judged`]): flights stay as the ground pass leaves them, one by one,
/// where they would be, those that make no sound claim first. Cost: linear in frames times steps; a flight that is left costs a flight pass more.
///
/// # Errors
/// [`TouchUpError`] for what does not fit together.
pub fn touch_up(
    clip: &Clip,
    body: &BodyModel,
    stages: &Stages,
    source: Option<&Source>,
    settings: &TouchUpSettings,
) -> Result<TouchedUp, TouchUpError> {
    let (grounded, ground) = ground_pass(clip, body, stages, source, &settings.ground)?;
    let Some(in_flight) = &settings.flight else {
        return Ok(TouchedUp { clip: grounded, ground, flight: FlightReport::default() });
    };
    let judge = |clip: &Clip| judged(clip, body, stages, &settings.ground);
    let mut in_flight = in_flight.clone();
    let mut flown = fly(&grounded, body, stages, &in_flight)?;
    let mut suspects = suspects(&flown.report.flights).into_iter();
    let start = if suspects.len() > 0 { judge(clip) } else { 0.0 };
    while settings.ground.judged && suspects.len() > 0 && judge(&flown.clip) > start {
        let runs = stages.flight_runs();
        in_flight.left.extend(suspects.next().and_then(|first| runs.iter().position(|run| run.0 == first)));
        flown = fly(&grounded, body, stages, &in_flight)?;
    }
    let Flown { clip, report: flight } = flown;
    Ok(TouchedUp { clip, ground, flight })
}

/// Mean distance of zero moment points from polygons by derivatives that nothing optimises, metres.
fn judged(clip: &Clip, body: &BodyModel, stages: &Stages, settings: &GroundSettings) -> f64 {
    let GroundSettings { inertia, external, .. } = settings;
    let posed = PosedClip::of(clip);
    let judge = ForceSettings { filter: Filter::Butterworth, inertia: *inertia, external };
    let balances = balances(body, &posed, stages, &link_forces(body, &posed, &judge));
    distance_summary(&balances).map_or(0.0, |distance| distance.mean)
}

/// First frames of `flights`, in the order in which they are left where a clip ends worse: first what adds to the distances beside it and
/// makes no sound claim, then what adds to them, then all others; what adds most first.
fn suspects(flights: &[FlightFacts]) -> Vec<usize> {
    let sum = |own: Option<DistanceSummary>| own.map_or(0.0, |own| own.mean * own.frames as f64);
    let added = |facts: &FlightFacts| sum(facts.beside_judged[1]) - sum(facts.beside_judged[0]);
    let rank = |facts: &FlightFacts| match (added(facts) > 0.0, facts.is_sound()) {
        (true, false) => 0,
        (true, true) => 1,
        (false, _) => 2,
    };
    let mut order: Vec<&FlightFacts> = flights.iter().collect();
    order.sort_by(|a, b| rank(a).cmp(&rank(b)).then(added(b).total_cmp(&added(a))));
    order.into_iter().map(|facts| facts.first).collect()
}
