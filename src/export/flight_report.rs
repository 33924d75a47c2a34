//! What became of flights, for a report. Lengths in metres, angles in degrees; frames count from 0 at the first one of the result.

use serde::Serialize;

use crate::export::touch_up_report::DistanceReport;
use crate::physics::ballistics::FlightCheck;
use crate::physics::flight::report::{FlightFacts, FlightReport, LeftFlight};
use crate::physics::touch_up::TouchedUp;

/// A flight, as it came and as it is.
#[derive(Clone, Debug, Serialize)]
pub struct FlightPart {
    /// First frame in the air.
    pub first: usize,
    /// Last frame in the air.
    pub last: usize,
    /// Of the parabola nearest to the motion as it came, m/s²; `null` for a flight of less than 0.2 s, or one that an end of the clip cuts
    /// off.
    pub gravity: Option<f64>,
    /// Farthest from it.
    pub residual: Option<f64>,
    /// Whether labels, rate or scale are doubtful.
    pub doubtful: bool,
    /// Frames per second with which it would fall as bodies do.
    pub mending_rate: Option<f64>,
    /// Factor of all lengths with which it would.
    pub mending_scale: Option<f64>,
    /// Whether the flight pass leaves it as it came, since the clip would end worse at 6 Hz.
    pub left: bool,
    /// What the flight pass did; `null` where it did nothing.
    pub pass: Option<FlightPassPart>,
}

/// What was done in the air. Pairs: before and after.
#[derive(Clone, Debug, Serialize)]
pub struct FlightPassPart {
    /// Gravity of the result, m/s².
    pub gravity: f64,
    /// Angular momentum of the result about the centre of mass, kg m²/s.
    pub momentum: f64,
    /// Farthest of two successive frames from it, kg m²/s.
    pub momentum_errors: [f64; 2],
    /// Frame at which momentum breaks in the motion as it came, as that of no body in the air does; `null` where it does not.
    pub momentum_break: Option<usize>,
    /// Farthest of the centre of mass from its parabola.
    pub center_errors: [f64; 2],
    /// Largest turn of the body.
    pub largest_turn: f64,
    /// Newton steps on the momentum.
    pub newton_steps: usize,
    /// Distances in the half second on either side.
    pub beside: [Option<DistanceReport>; 2],
    /// The same at 6 Hz.
    pub beside_6hz: [Option<DistanceReport>; 2],
}

impl FlightPart {
    fn of((first, last): (usize, usize), check: Option<&FlightCheck>) -> Self {
        Self {
            first,
            last,
            gravity: check.map(|check| check.gravity),
            residual: check.map(|check| check.residual),
            doubtful: check.is_some_and(FlightCheck::is_doubtful),
            mending_rate: check.and_then(|check| check.mending_rate),
            mending_scale: check.and_then(|check| check.mending_scale),
            left: false,
            pass: None,
        }
    }

    fn of_facts(facts: &FlightFacts) -> Self {
        let pass = FlightPassPart {
            gravity: facts.gravity,
            momentum: facts.momentum.length(),
            momentum_errors: facts.momentum_errors,
            momentum_break: facts.momentum_break.map(|broken| broken.frame),
            center_errors: facts.center_errors,
            largest_turn: facts.largest_turn.to_degrees(),
            newton_steps: facts.newton_steps,
            beside: facts.beside.map(|own| own.map(Into::into)),
            beside_6hz: facts.beside_judged.map(|own| own.map(Into::into)),
        };
        Self { pass: Some(pass), ..Self::of((facts.first, facts.last), facts.check.as_ref()) }
    }

    fn of_left(flight: &LeftFlight) -> Self {
        Self { left: true, ..Self::of((flight.first, flight.last), flight.check.as_ref()) }
    }

    /// Of the flight pass, or, where there was none, of what `checks` say; in the order of time.
    pub fn all(touched: &TouchedUp, checks: &[FlightCheck]) -> Vec<Self> {
        let FlightReport { flights, left } = &touched.flight;
        if flights.is_empty() && left.is_empty() {
            return checks.iter().map(|check| Self::of((check.first, check.last), Some(check))).collect();
        }
        let mut all: Vec<Self> =
            flights.iter().map(Self::of_facts).chain(left.iter().map(Self::of_left)).collect();
        all.sort_by_key(|flight| flight.first);
        all
    }
}
