//! One path of a chain system: its kept points, the spans between them, its free ends.
//!
//! Points touched by other rows are kept, in pairs of neighbours. A touched point opens a pair with its successor (the
//! last point of the path: with its predecessor), unless it is kept already or its predecessor is, which then is its
//! partner: the stencil `i − 1, i, i + 1` is two pairs that share point i. A path that nothing touches keeps its first
//! pair, which its rows leave free.
//!
//! Before the first and after the last pair rows can be met exactly: they cost nothing, and their points follow from
//! the pair. If the outer coefficient of such a row vanishes, there are fewer rows than points after it.

use crate::c64;
use crate::chain::{ChainPiece, ChainRow, Reflection, Rule, TargetState, eliminate_points};
use crate::error::KktError;
use crate::scalar::Scalar;

/// Ends that reach farther, in steps of the pair they follow, are free to working precision.
const LONGEST_END: f64 = 1e13;

/// Whether three-term rows have targets.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum RowTargets {
    /// All are zero: nothing is kept for them, and a solve makes no pass over them.
    #[default]
    Zero,
    /// They are given with each solve.
    PerSolve,
}

/// A path condensed to its kept points.
#[derive(Clone, Debug)]
pub(crate) struct CondensedPath {
    /// Points of the path.
    pub(crate) point_count: usize,
    /// Kept points, rising.
    pub(crate) kept: Vec<usize>,
    /// Rows between consecutive pairs.
    pub(crate) spans: Vec<Span>,
    rules: Vec<Rule>,
    /// One for each of `rules`, if rows have targets.
    reflections: Vec<Reflection<2>>,
    head: End,
    tail: End,
}

/// Rows from one pair to the next.
#[derive(Clone, Debug)]
pub(crate) struct Span {
    /// First points of the two pairs; also the range of the rows.
    pairs: (usize, usize),
    /// Places of the four points in the list of kept points.
    pub(crate) corners: [usize; 4],
    /// Without targets.
    pub(crate) piece: ChainPiece,
}

/// Points outside the outermost pair, from it outwards.
#[derive(Clone, Debug, Default)]
struct End {
    /// `p = s p_near + w (p_near − p_far)`: `(s, w)`, where `p_far, p_near` are the pair's inner and outer point.
    rules: Vec<(c64, c64)>,
    /// `p = e₀ p'' + e₁ p' + e₂ t` from the two points before it and the target of their row, if rows have targets.
    steps: Vec<[c64; 3]>,
}

/// What changes with the targets of the rows of one path.
#[derive(Clone, Debug, Default)]
pub(crate) struct PathTargets {
    /// Constant of the rule of each point; empty where rows have no targets.
    constants: Vec<c64>,
    /// Targets of the two rows of each span.
    pub(crate) spans: Vec<[c64; 2]>,
}

impl CondensedPath {
    /// Condenses a path. `touched`: points to keep, rising. For [`RowTargets::PerSolve`], keeps what
    /// [`reduce`](Self::reduce) needs.
    ///
    /// # Errors
    /// [`KktError::Singular`] if the rows leave a point that is not kept free.
    pub(crate) fn new(
        rows: &[ChainRow],
        touched: &[usize],
        row_targets: RowTargets,
    ) -> Result<Self, KktError> {
        let point_count = rows.len() + 2;
        let pairs = pair_up(point_count, touched);
        let (first, last) = (pairs[0], pairs[pairs.len() - 1]);
        let head_rows = rows[..first].iter().rev().map(|&[before, at, after]| [after, at, before]);
        let head = End::new(head_rows, row_targets)?;
        let tail = End::new(rows[last..].iter().copied(), row_targets)?;
        let mut path = Self {
            point_count,
            kept: vec![first, first + 1],
            spans: Vec::with_capacity(pairs.len() - 1),
            rules: Vec::with_capacity(last - first),
            reflections: Vec::new(),
            head,
            tail,
        };
        pairs.windows(2).try_for_each(|pair| path.push_span(rows, (pair[0], pair[1]), row_targets))?;
        Ok(path)
    }

    fn push_span(
        &mut self,
        rows: &[ChainRow],
        (first, last): (usize, usize),
        row_targets: RowTargets,
    ) -> Result<(), KktError> {
        let piece = eliminate_points(&rows[first..last], |rule, reflection| {
            self.rules.push(rule);
            if row_targets == RowTargets::PerSolve {
                self.reflections.push(reflection);
            }
        })?;
        let near = self.kept.len() - 2;
        self.kept.extend((last..last + 2).skip(usize::from(last == first + 1)));
        let far = self.kept.len() - 2;
        self.spans.push(Span { pairs: (first, last), corners: [near, near + 1, far, far + 1], piece });
        Ok(())
    }

    /// Memory for [`reduce`](Self::reduce) and [`expand`](Self::expand).
    pub(crate) fn targets(&self, row_targets: RowTargets) -> PathTargets {
        let count = match row_targets {
            RowTargets::Zero => 0,
            RowTargets::PerSolve => self.point_count,
        };
        PathTargets {
            constants: vec![c64::default(); count],
            spans: vec![[c64::default(); 2]; self.spans.len()],
        }
    }

    /// Brings the targets of the path's rows through the reflections.
    pub(crate) fn reduce(&self, row_targets: &[c64], out: &mut PathTargets) {
        let mut reflections = self.reflections.as_slice();
        for (Span { pairs: (first, last), .. }, reduced) in self.spans.iter().zip(&mut out.spans) {
            let targets = &row_targets[*first..*last];
            let mut state = TargetState::new(targets);
            let later = targets.get(2..).unwrap_or_default();
            let (own, others) = reflections.split_at(later.len());
            let constants = &mut out.constants[*first + 2..][..later.len()];
            for ((reflection, &target), constant) in own.iter().zip(later).zip(constants) {
                *constant = state.take_up(reflection, target);
            }
            (*reduced, reflections) = (state.0, others);
        }
        let (before, after) = self.end_lengths();
        let (head, tail) = (row_targets[..before].iter().rev(), &row_targets[row_targets.len() - after..]);
        self.head.constants(head, out.constants[..before].iter_mut().rev());
        let tail_start = self.point_count - after;
        self.tail.constants(tail.iter(), out.constants[tail_start..].iter_mut());
    }

    /// Writes all points of the path from its kept ones.
    ///
    /// # Errors
    /// [`KktError::SolutionNotFinite`].
    pub(crate) fn expand(
        &self,
        kept: &[c64],
        targets: &PathTargets,
        points: &mut [c64],
    ) -> Result<(), KktError> {
        if targets.constants.is_empty() {
            self.expand_with(kept, |_| c64::default(), points);
        } else {
            self.expand_with(kept, |point| targets.constants[point], points);
        }
        if points.iter().all(|p| p.all_finite()) { Ok(()) } else { Err(KktError::SolutionNotFinite) }
    }

    fn expand_with(&self, kept: &[c64], constant: impl Fn(usize) -> c64, points: &mut [c64]) {
        self.kept.iter().zip(kept).for_each(|(&point, &p)| points[point] = p);
        let mut rules = self.rules.as_slice();
        for &Span { pairs: (first, last), corners: [a, b, d, e], .. } in &self.spans {
            let (own, others) = rules.split_at((last - first).saturating_sub(2));
            let origin = kept[a];
            let [step, mut y, mut w] = [b, d, e].map(|corner| kept[corner] - origin);
            for (k, m) in own.iter().enumerate().rev() {
                let point = first + 2 + k;
                let x = m[0] * origin + m[1] * step + constant(point) + m[3] * w + m[2] * y;
                points[point] = origin + x;
                (y, w) = (x, y);
            }
            rules = others;
        }
        let (before, after) = self.end_lengths();
        let last = kept.len() - 1;
        let head = points[..before].iter_mut().enumerate().rev();
        self.head.follow((kept[1], kept[0]), head, &constant);
        let tail = points.iter_mut().enumerate().skip(self.point_count - after);
        self.tail.follow((kept[last - 1], kept[last]), tail, &constant);
    }

    /// Points before the first and after the last pair.
    fn end_lengths(&self) -> (usize, usize) {
        (self.head.rules.len(), self.tail.rules.len())
    }
}

impl End {
    /// Follows rows outwards. `rows`: coefficients from the inner to the outer point.
    ///
    /// # Errors
    /// [`KktError::Singular`] if a point does not follow from its row.
    fn new(rows: impl Iterator<Item = ChainRow>, row_targets: RowTargets) -> Result<Self, KktError> {
        let mut end = Self::default();
        let one = c64::new(1.0, 0.0);
        let (mut far, mut near) = ((one, -one), (one, c64::default()));
        for [inner, at, outer] in rows {
            let inverse = outer.inv();
            let [e0, e1] = [-inner * inverse, -at * inverse];
            (far, near) = (near, (e0 * far.0 + e1 * near.0, e0 * far.1 + e1 * near.1));
            let reach = near.0.norm_sqr().max(near.1.norm_sqr());
            if !(near.0 + near.1).all_finite() || reach > LONGEST_END * LONGEST_END {
                return Err(KktError::Singular);
            }
            end.rules.push(near);
            if row_targets == RowTargets::PerSolve {
                end.steps.push([e0, e1, inverse]);
            }
        }
        Ok(end)
    }

    /// Writes the points of an end, given outwards with their places, from those of its pair.
    fn follow<'a>(
        &self,
        (far, near): (c64, c64),
        points: impl Iterator<Item = (usize, &'a mut c64)>,
        constant: impl Fn(usize) -> c64,
    ) {
        let step = near - far;
        for (&(s, w), (index, point)) in self.rules.iter().zip(points) {
            *point = s * near + w * step + constant(index);
        }
    }

    /// What the targets of its rows add to the points of an end.
    fn constants<'a>(
        &self,
        targets: impl Iterator<Item = &'a c64>,
        constants: impl Iterator<Item = &'a mut c64>,
    ) {
        let (mut far, mut near) = (c64::default(), c64::default());
        for ((&[e0, e1, e2], &target), constant) in self.steps.iter().zip(targets).zip(constants) {
            (far, near) = (near, e0 * far + e1 * near + e2 * target);
            *constant = near;
        }
    }
}

/// First points of the pairs that hold the touched points, rising.
fn pair_up(point_count: usize, touched: &[usize]) -> Vec<usize> {
    let mut pairs: Vec<usize> = Vec::new();
    for &point in touched {
        match pairs.last() {
            Some(&last) if point <= last + 1 => {}
            Some(&last) if point == last + 2 => pairs.push(last + 1),
            _ => pairs.push(point.min(point_count - 2)),
        }
    }
    if pairs.is_empty() {
        pairs.push(0);
    }
    pairs
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn touched_points_share_pairs_with_kept_neighbours() {
        assert_eq!(pair_up(10, &[]), vec![0]);
        assert_eq!(pair_up(10, &[3, 4, 5]), vec![3, 4]);
        assert_eq!(pair_up(10, &[3, 5]), vec![3, 4]);
        assert_eq!(pair_up(10, &[2, 5, 9]), vec![2, 5, 8]);
        assert_eq!(pair_up(10, &[0, 7, 9]), vec![0, 7, 8]);
        assert_eq!(pair_up(2, &[1]), vec![0]);
    }
}
