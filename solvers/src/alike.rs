//! How far a bent path is from another bend of the same springs, from loads and states at the constrained points alone.

use std::ops::Range;
use std::sync::Arc;

use crate::bent::Bent;
use crate::c64;
use crate::compliance::Compliance;
use crate::springs::{Load, Moments};

/// What is known of the factors ζ of the segments in a range of points, and of those of another bend of it.
#[derive(Clone, Copy, Debug)]
pub struct Likeness<'a> {
    /// ζ before the springs of the range bend it.
    pub factor: c64,
    /// `|ζ_j − ζ'_j|` is no more than this, ζ' being the factors of the other bend.
    pub apart: f64,
    /// What bends the springs of the range.
    springs: Option<(&'a Moments, Load)>,
}

impl Likeness<'_> {
    /// `|ζ_j − factor|` is no more than this.
    pub fn bend(&self) -> f64 {
        self.springs.map_or(0.0, |(moments, load)| turn(moments, load))
    }
}

impl Bent {
    /// Calls `visit` with all ranges of points of a path, in order, and how far the segments after them are from those of `other`, a
    /// solution of `its`; `false` where these are not the same springs with rows on the same points. Cost: by rows.
    ///
    /// The springs `a ≤ s < b` turn by `Σ c_s |f_s| ≤ √(Σ c_s · Σ c_s |f_s|²)`, `f_s = force·conj(q_b − q_s) + moment`; both sums
    /// come from moments.
    pub fn compare(
        &self,
        problem: &Compliance,
        (other, its): (&Self, &Compliance),
        path: usize,
        mut visit: impl FnMut(Range<usize>, Likeness),
    ) -> bool {
        if !Arc::ptr_eq(&problem.paths[path], &its.paths[path]) {
            return false;
        }
        let pieces = problem.first_pieces[path]..problem.first_pieces[path + 1];
        if pieces != (its.first_pieces[path]..its.first_pieces[path + 1]) {
            return false;
        }
        pieces.into_iter().all(|piece| {
            let same = problem.loads[piece].has_nodes_of(&its.loads[piece]);
            if same {
                self.compare_piece(problem, other, piece, &mut visit);
            }
            same
        })
    }

    fn compare_piece(
        &self,
        problem: &Compliance,
        other: &Self,
        piece: usize,
        visit: &mut impl FnMut(Range<usize>, Likeness),
    ) {
        let known = &problem.loads[piece];
        let (own, its) = (self.piece(piece), other.piece(piece));
        let (mut from, mut factors) = (known.first_known(), (own.origin.factor, its.origin.factor));
        for (node, end) in known.nodes.iter().enumerate() {
            let (load, moments) = (own.loads[node], &known.moments[node]);
            let likeness = Likeness {
                factor: factors.0,
                apart: distance(factors) + turn(moments, load.less(its.loads[node])),
                springs: Some((moments, load)),
            };
            if from >= known.own.start {
                visit(from..*end, likeness);
            }
            (from, factors) = (*end, (own.states[node].factor, its.states[node].factor));
        }
        visit(from..known.own.end, Likeness { factor: factors.0, apart: distance(factors), springs: None });
    }

    /// How much the energy falls at most if the targets of the first `rows` rows change as their values would if points of path p
    /// moved by no more than `by(p)`: energies are convex in targets, with the multipliers as slopes. Cost: by rows.
    pub fn work(&self, problem: &Compliance, rows: usize, by: impl Fn(usize) -> f64) -> f64 {
        let of_path = |path: usize| {
            let most = by(path);
            let pieces = problem.first_pieces[path]..problem.first_pieces[path + 1];
            let terms =
                problem.loads[pieces].iter().flat_map(|loads| loads.terms()).filter(|(row, _)| *row < rows);
            if most > 0.0 {
                most * terms
                    .map(|(row, value)| (self.multiplier(row).norm_sqr() * value.norm_sqr()).sqrt())
                    .sum::<f64>()
            } else {
                0.0
            }
        };
        (0..problem.paths.len()).map(of_path).sum()
    }
}

fn distance((a, b): (c64, c64)) -> f64 {
    (a - b).norm_sqr().sqrt()
}

/// How far springs under a load turn a path at most.
fn turn(moments: &Moments, load: Load) -> f64 {
    if moments.zeroth == 0.0 {
        return 0.0;
    }
    (moments.zeroth * moments.work(load, load).re.max(0.0)).sqrt()
}
