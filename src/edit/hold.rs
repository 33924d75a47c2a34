//! Spatial constraints at single instants, as exact complex rows. Source: Kim et al. 2009, eqs. 1, 2 and 4.

use std::borrow::Borrow;

use crate::constraint::Strength;
use crate::edit::direction::{Direction, direction_at};
use crate::edit::settings::RelativeMode;
use crate::geometry::{c64, cis};
use crate::index::ConstraintId;
use crate::path::{RestPath, bracket};

/// One instant of one character.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Path, by position in the list of rest paths.
    pub path: usize,
    /// Frame, a fraction where rates differ.
    pub frame: f64,
    /// Facing of the body there at rest, radians.
    pub heading: f64,
    /// Root of the sampled rest pose minus the path's polyline there, metres; 0 at whole frames.
    pub detail: c64,
}

/// What must hold at an instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Hold {
    /// Somebody is at a ground point.
    Position {
        /// Who and when.
        at: Place,
        /// Metres.
        target: c64,
    },
    /// Somebody's body looks along a heading.
    Facing {
        /// Who and when.
        at: Place,
        /// Radians.
        heading: f64,
    },
    /// Somebody is at an offset from somebody else.
    Offset {
        /// Who and when.
        at: Place,
        /// From whom, and when there.
        to: Place,
        /// Ahead + i·left of the partner's body facing, metres.
        offset: c64,
    },
    /// Somebody is beside what somebody else has carried from one instant to another:
    /// `p_at − p_to + p_from = target`.
    Beside {
        /// Who and when.
        at: Place,
        /// The carrier at that time, or at the release; on the path itself, whatever the pose.
        to: Place,
        /// The carrier at the grasp, likewise.
        from: Place,
        /// Metres.
        target: c64,
    },
    /// Somebody faces at an angle to somebody else's facing.
    RelativeFacing {
        /// Who and when.
        at: Place,
        /// Whose facing counts, and when.
        to: Place,
        /// Own facing minus the partner's, radians.
        angle: f64,
    },
}

/// A hold of a constraint, with the strength of this one row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeldRow {
    /// Which constraint of the scene.
    pub constraint: ConstraintId,
    /// Hard, or the weight of this row.
    pub strength: Strength,
    /// What.
    pub hold: Hold,
}

/// The two edits of a path, in order: its shape up to similarity, then its size.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// Phase 1, eq. 3.
    Shape,
    /// Phase 2, eq. 7.
    Scale,
}

/// A coefficient of a row: path, frame, factor.
pub type Term = (usize, usize, c64);

/// A held row with the directions of its places, found once per rest path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prepared {
    /// The row.
    pub row: HeldRow,
    /// Direction at the instant held.
    pub at: Option<Direction>,
    /// Direction at the partner's instant.
    pub to: Option<Direction>,
    /// A facing that does not turn the path: another one turns its stationary stretch already.
    pub body_only: bool,
    /// Row, by position in the list, that is left to the partner's body at that very moment and says how it faces.
    pub partner_row: Option<usize>,
}

impl Hold {
    /// The instant held.
    pub fn at(&self) -> Place {
        match self {
            Self::Position { at, .. }
            | Self::Facing { at, .. }
            | Self::Offset { at, .. }
            | Self::Beside { at, .. }
            | Self::RelativeFacing { at, .. } => *at,
        }
    }

    /// The instant of a partner whose body tells a direction.
    pub fn to(&self) -> Option<Place> {
        match self {
            Self::Position { .. } | Self::Facing { .. } | Self::Beside { .. } => None,
            Self::Offset { to, .. } | Self::RelativeFacing { to, .. } => Some(*to),
        }
    }

    /// All instants that it names.
    pub fn places(&self) -> [Option<Place>; 3] {
        match self {
            Self::Beside { at, to, from, .. } => [Some(*at), Some(*to), Some(*from)],
            _ => [Some(self.at()), self.to(), None],
        }
    }

    /// The path of the partner, where there is one.
    pub fn partner(&self) -> Option<usize> {
        match self {
            Self::Beside { to, .. } => Some(to.path),
            _ => self.to().map(|to| to.path),
        }
    }

    /// Whether a ground point is held.
    pub fn is_position(&self) -> bool {
        matches!(self, Self::Position { .. })
    }

    /// Whether a direction is held rather than a position.
    pub fn is_direction(&self) -> bool {
        matches!(self, Self::Facing { .. } | Self::RelativeFacing { .. })
    }
}

/// Appends `factor` times the vector of a direction on a path.
fn add_direction(
    terms: &mut Vec<Term>,
    (direction, path): (Direction, usize),
    counts: &[usize],
    factor: c64,
) {
    add_point(terms, path, direction.to, counts[path], factor * direction.scale);
    add_point(terms, path, direction.from, counts[path], -factor * direction.scale);
}

/// Appends `factor` times the point at a fractional frame.
fn add_point(terms: &mut Vec<Term>, path: usize, frame: f64, count: usize, factor: c64) {
    let (low, high, share) = bracket(frame, count);
    if share != 1.0 {
        terms.push((path, low, factor * (1.0 - share)));
    }
    if share != 0.0 {
        terms.push((path, high, factor * share));
    }
}

/// Unit rotations of a row's two places in the shape phase, or of bodies that have no direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rotations {
    /// At the instant held.
    pub at: c64,
    /// At the partner's instant.
    pub to: c64,
}

impl Rotations {
    /// Both as at rest.
    pub const NONE: Self = Self { at: c64::new(1.0, 0.0), to: c64::new(1.0, 0.0) };
}

impl Prepared {
    /// Finds the directions of `row`.
    pub fn new(row: HeldRow, rests: &[impl Borrow<RestPath>], baseline: f64) -> Self {
        let find = |place: Place| direction_at(rests[place.path].borrow(), place.frame, baseline);
        let (at, to) = (find(row.hold.at()), row.hold.to().and_then(find));
        Self { row, at, to, body_only: false, partner_row: None }
    }

    /// The same row with other numbers for its paths.
    pub fn renumbered(mut self, number: impl Fn(usize) -> usize) -> Self {
        match &mut self.row.hold {
            Hold::Position { at, .. } | Hold::Facing { at, .. } => at.path = number(at.path),
            Hold::Offset { at, to, .. } | Hold::RelativeFacing { at, to, .. } => {
                at.path = number(at.path);
                to.path = number(to.path);
            }
            Hold::Beside { at, to, from, .. } => {
                for place in [at, to, from] {
                    place.path = number(place.path);
                }
            }
        }
        self
    }

    /// Whether the row binds anything in `phase`. A body without extent has no direction, and the direction of a
    /// stationary stretch is decided in the shape phase.
    pub fn binds(&self, phase: Phase, runs_are_rigid: bool) -> bool {
        match (self.row.hold.is_direction(), self.at) {
            (false, _) => true,
            (true, None) => false,
            (true, Some(_)) if self.body_only => false,
            (true, Some(direction)) => !(phase == Phase::Scale && runs_are_rigid && direction.in_run),
        }
    }

    /// Whether coefficients of the partner's direction appear in the row (else its rotation appears in the target).
    fn follows_partner(&self, phase: Phase, mode: RelativeMode) -> bool {
        self.partner_row.is_none() && (phase == Phase::Shape || mode == RelativeMode::TangentScaled)
    }

    /// Left side of the row; `counts`: frames of each path.
    pub fn terms(&self, phase: Phase, mode: RelativeMode, counts: &[usize]) -> Vec<Term> {
        let mut terms = Vec::with_capacity(8);
        self.add_terms((phase, mode), counts, &mut terms);
        terms
    }

    /// Appends these terms.
    pub fn add_terms(&self, (phase, mode): (Phase, RelativeMode), counts: &[usize], terms: &mut Vec<Term>) {
        let one = c64::new(1.0, 0.0);
        let follows = self.follows_partner(phase, mode);
        let mut point = |place: Place, direction: Option<Direction>, factor: c64| {
            add_point(terms, place.path, place.frame, counts[place.path], factor);
            if let (true, Some(direction)) = (follows && place.detail != c64::default(), direction) {
                let share = factor * place.detail / direction.rest;
                add_direction(terms, (direction, place.path), counts, share);
            }
        };
        match self.row.hold {
            Hold::Position { at, .. } => point(at, self.at, one),
            Hold::Beside { at, to, from, .. } => {
                point(at, self.at, one);
                add_point(terms, to.path, to.frame, counts[to.path], -one);
                add_point(terms, from.path, from.frame, counts[from.path], one);
            }
            Hold::Facing { at, .. } => {
                if let Some(direction) = self.at {
                    add_direction(terms, (direction, at.path), counts, one);
                }
            }
            Hold::Offset { at, to, offset } => {
                point(at, self.at, one);
                point(to, self.to, -one);
                if let (true, Some(partner)) = (follows, self.to) {
                    let share = -offset * cis(to.heading) / partner.rest;
                    add_direction(terms, (partner, to.path), counts, share);
                }
            }
            Hold::RelativeFacing { at, to, angle } => {
                if let Some(own) = self.at {
                    add_direction(terms, (own, at.path), counts, one);
                    if let (true, Some(partner)) = (follows, self.to) {
                        let share = -own.rest / partner.rest * cis(to.heading + angle - at.heading);
                        add_direction(terms, (partner, to.path), counts, share);
                    }
                }
            }
        }
    }

    /// Right side of the row, given the rotations of its places.
    pub fn target(&self, phase: Phase, mode: RelativeMode, rotations: Rotations) -> c64 {
        let follows = self.follows_partner(phase, mode);
        let detail = |place: Place, direction: Option<Direction>, rotation: c64| {
            if follows && direction.is_some() { c64::default() } else { rotation * place.detail }
        };
        match self.row.hold {
            Hold::Position { at, target } | Hold::Beside { at, target, .. } => {
                target - detail(at, self.at, rotations.at)
            }
            Hold::Facing { at, heading } => {
                self.at.map_or(c64::default(), |own| own.rest * cis(heading - at.heading))
            }
            Hold::Offset { at, to, offset } => {
                let own = if follows && self.to.is_some() {
                    c64::default()
                } else {
                    offset * cis(to.heading) * rotations.to
                };
                own - detail(at, self.at, rotations.at) + detail(to, self.to, rotations.to)
            }
            Hold::RelativeFacing { at, to, angle } => match self.at {
                Some(own) if !(follows && self.to.is_some()) => {
                    own.rest * cis(to.heading + angle - at.heading) * rotations.to
                }
                _ => c64::default(),
            },
        }
    }

    /// Whether its target in the shape phase is the same whatever the rotations of its places.
    pub fn ignores_rotations(&self) -> bool {
        let fixed = |place: Place, direction: Option<Direction>| {
            place.detail == c64::default() || (self.partner_row.is_none() && direction.is_some())
        };
        let follows = self.partner_row.is_none() && self.to.is_some();
        match self.row.hold {
            Hold::Position { at, .. } | Hold::Beside { at, .. } => fixed(at, self.at),
            Hold::Facing { .. } => true,
            Hold::Offset { at, to, .. } => follows && fixed(at, self.at) && fixed(to, self.to),
            Hold::RelativeFacing { .. } => follows && self.at.is_some(),
        }
    }

    /// What a soft row is divided by, so that its weight counts metres or radians: 1, or the length of its own direction.
    pub fn soft_scale(&self) -> f64 {
        match (self.row.hold.is_direction(), self.at) {
            (true, Some(direction)) => 1.0 / direction.rest.norm(),
            _ => 1.0,
        }
    }
}
