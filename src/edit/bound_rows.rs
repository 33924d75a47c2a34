//! Left sides of the held rows that bind in a phase, one after the other: what-ifs make them by the hundred.

use cotillion_solvers::PointRow;

use crate::constraint::Strength;
use crate::edit::columns::Freedom;
use crate::edit::hold::{Hold, Prepared, Term};
use crate::edit::settings::{RunMode, SpatialSettings};
use crate::geometry::c64;

/// Rows by position; where one names a held row, it is by position in the list of these.
#[derive(Clone, Debug, Default)]
pub struct BoundRows {
    /// Which held rows.
    pub held: Vec<usize>,
    /// Weight of each; `None`: hard.
    weights: Vec<Option<f64>>,
    /// Where the terms of each end.
    ends: Vec<usize>,
    terms: Vec<Term>,
}

impl BoundRows {
    /// Those of `held` that bind in the phase of `freedom`. Cost: linear in rows.
    pub fn new(freedom: Freedom, held: &[Prepared], settings: &SpatialSettings) -> Self {
        let counts: Vec<usize> = freedom.paths.iter().map(|path| path.len()).collect();
        let rigid = settings.runs == RunMode::Rigid;
        let mut rows = Self::with_room(held.len());
        for (place, prepared) in held.iter().enumerate() {
            if prepared.binds(freedom.phase, rigid) {
                prepared.add_terms((freedom.phase, settings.relative), &counts, &mut rows.terms);
                rows.push(place, weight_of(prepared));
            }
        }
        rows
    }

    /// The same rows of `held` in place of `before`, of which these are, with path `path` exchanged for that of `freedom`; `None` where
    /// more changes than terms and weights on that path. Cost: linear in rows; those that stay are copied.
    pub fn with_path(
        &self,
        (path, freedom): (usize, Freedom),
        (held, before): (&[Prepared], &[Prepared]),
        settings: &SpatialSettings,
    ) -> Option<Self> {
        let counts: Vec<usize> = freedom.paths.iter().map(|path| path.len()).collect();
        let rigid = settings.runs == RunMode::Rigid;
        let mut rows = Self::with_room(self.len());
        for (place, prepared) in held.iter().enumerate() {
            let row = rows.len();
            let was_bound = self.held.get(row) == Some(&place);
            if was_bound && stays(path, prepared, before.get(place)?) {
                rows.terms.extend_from_slice(self.terms(row));
                rows.push(place, self.weight(row));
                continue;
            }
            let binds = prepared.binds(freedom.phase, rigid);
            if binds != was_bound {
                return None;
            }
            if binds {
                prepared.add_terms((freedom.phase, settings.relative), &counts, &mut rows.terms);
                rows.push(place, weight_of(prepared));
                let (new, old) = ((rows.terms(row), rows.weight(row)), (self.terms(row), self.weight(row)));
                if !differ_on(path, new, old) {
                    return None;
                }
            }
        }
        (rows.len() == self.len()).then_some(rows)
    }

    fn with_room(count: usize) -> Self {
        Self {
            held: Vec::with_capacity(count),
            weights: Vec::with_capacity(count),
            ends: Vec::with_capacity(count),
            terms: Vec::with_capacity(TERMS * count),
        }
    }

    /// Ends a row whose terms were put down.
    fn push(&mut self, place: usize, weight: Option<f64>) {
        self.held.push(place);
        self.weights.push(weight);
        self.ends.push(self.terms.len());
    }

    /// How many.
    pub fn len(&self) -> usize {
        self.held.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.held.is_empty()
    }

    /// Terms of a row.
    pub fn terms(&self, row: usize) -> &[Term] {
        &self.terms[row.checked_sub(1).map_or(0, |before| self.ends[before])..self.ends[row]]
    }

    /// Weight of a row; `None`: hard.
    pub fn weight(&self, row: usize) -> Option<f64> {
        self.weights[row]
    }

    /// Terms and weight of each row.
    pub fn iter(&self) -> impl Iterator<Item = (&[Term], Option<f64>)> {
        (0..self.len()).map(|row| (self.terms(row), self.weights[row]))
    }

    /// A row by itself.
    pub fn point_row(&self, row: usize) -> PointRow<c64> {
        PointRow { terms: self.terms(row).to_vec(), weight: self.weights[row] }
    }
}

/// Whether a row has the terms and the weight of the one before it: it says the same of the same instants of other paths than
/// `path`, but for the points where somebody is to be.
fn stays(path: usize, now: &Prepared, before: &Prepared) -> bool {
    let (places, hold) = (now.row.hold.places(), now.row.hold);
    let at_a_point = matches!(hold, Hold::Position { .. } | Hold::Beside { .. });
    let same_kind = std::mem::discriminant(&hold) == std::mem::discriminant(&before.row.hold);
    (hold == before.row.hold || at_a_point && same_kind && places == before.row.hold.places())
        && places.iter().flatten().all(|place| place.path != path)
        && (now.at, now.to) == (before.at, before.to)
        && (now.body_only, now.partner_row) == (before.body_only, before.partner_row)
        && (now.row.constraint, now.row.strength) == (before.row.constraint, before.row.strength)
}

/// Terms that a row has about.
const TERMS: usize = 4;

/// Coefficients and weights are the same if they differ by no more than this, relative to the larger.
const SAME: f64 = 1e-12;

/// Terms and weight.
type Row<'a> = (&'a [Term], Option<f64>);

/// Whether two rows are the same but for their terms on path `path` and their weight if they have any there.
fn differ_on(path: usize, (new, weight): Row<'_>, (old, old_weight): Row<'_>) -> bool {
    let touches = |terms: &[Term]| terms.iter().any(|term| term.0 == path);
    let equally_strong = match (weight, old_weight) {
        (Some(_), Some(_)) if touches(new) && touches(old) => true,
        (new, old) => new == old,
    };
    let same = |a: &Term, b: &Term| {
        (a.0, a.1) == (b.0, b.1) && (a.2 - b.2).norm_sqr() <= SAME * SAME * b.2.norm_sqr()
    };
    let mut elsewhere = [new, old].map(|terms| terms.iter().filter(|term| term.0 != path));
    let [new, old] = &mut elsewhere;
    equally_strong
        && new.all(|term| old.next().is_some_and(|known| same(term, known)))
        && old.next().is_none()
}

/// Weight of a held row in metres; `None`: hard.
pub fn weight_of(prepared: &Prepared) -> Option<f64> {
    match prepared.row.strength {
        Strength::Hard => None,
        Strength::Soft(weight) => Some(weight * prepared.soft_scale().powi(2)),
    }
}
