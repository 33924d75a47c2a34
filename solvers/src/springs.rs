//! A path as a chain of springs on its local similarity factors.
//!
//! A bent path is `x_j = a·q_j + b + Σ_{s<j} δ_s (q_j − q_s)`: similarity `(a, b)` of the rest points `q`, and increments δ of
//! the factor `ζ_j = (x_{j+1} − x_j)/(q_{j+1} − q_j)` at the interior points, with energy `½Σ|δ_s|²/c_s`; `c_s`, the
//! compliance of spring s, is 0 where the path is rigid. A row `x_i − (1−z)x_{i−1} − z·x_{i+1}`, `z = (q_i − q_{i−1})/(q_{i+1} −
//! q_{i−1})`, is `−δ_i/g`, `g = (q_{i+1} − q_{i−1})/((q_i − q_{i−1})(q_{i+1} − q_i))`, so that `c_i = |g|²` over the row's weight;
//! a second difference is `δ_i` on the points `q_j = j`, `c_i = 1` over the row's weight.
//!
//! Loads on points beyond a stretch of springs act on it by two numbers, and the stretch answers by three sums, its
//! [`Moments`]: whatever its length, its cost is constant.

use std::ops::Range;

use crate::c64;

/// Moments of the springs `a ≤ s < b` about the point b.
///
/// Along a path that goes on they grow, and nothing cancels. One that goes far and comes back loses as many digits as the square
/// of its reach is larger than that of its ends.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Moments {
    /// `Σ c_s`.
    pub zeroth: f64,
    /// `Σ c_s (q_b − q_s)`.
    pub first: c64,
    /// `Σ c_s |q_b − q_s|²`.
    pub second: f64,
    /// `q_b − q_a`.
    pub chord: c64,
}

impl Moments {
    /// Moments of these springs and then `next`'s: associative.
    pub fn then(self, next: Self) -> Self {
        Self {
            zeroth: self.zeroth + next.zeroth,
            first: self.first + self.zeroth * next.chord + next.first,
            second: self.second
                + 2.0 * (self.first * next.chord.conj()).re
                + self.zeroth * next.chord.norm_sqr()
                + next.second,
            chord: self.chord + next.chord,
        }
    }

    /// Moments after the similarity `q ↦ ρq + σ` of the points; `rho`: ρ.
    pub fn turned(self, rho: c64) -> Self {
        Self {
            zeroth: self.zeroth,
            first: rho * self.first,
            second: rho.norm_sqr() * self.second,
            chord: rho * self.chord,
        }
    }

    /// One spring of compliance `c` with the segment `step` after it.
    pub fn of_spring(compliance: f64, step: c64) -> Self {
        Self {
            zeroth: compliance,
            first: compliance * step,
            second: compliance * step.norm_sqr(),
            chord: step,
        }
    }

    /// `count` springs of compliance `c` on points 1 apart.
    fn even(count: usize, compliance: f64) -> Self {
        let m = count as f64;
        Self {
            zeroth: compliance * m,
            first: c64::new(compliance * m * (m + 1.0) / 2.0, 0.0),
            second: compliance * m * (m + 1.0) * (2.0 * m + 1.0) / 6.0,
            chord: c64::new(m, 0.0),
        }
    }

    /// What unit forces do: `Σ c_s f_s(own)·conj(f_s(other))`, `f_s = force·(…)` of [`Load::on`].
    pub(crate) fn work(&self, own: Load, other: Load) -> c64 {
        let (by_force, by_moment) = self.work_on(own);
        other.force * by_force + other.moment * by_moment
    }

    /// The same as factors of the other load's force and moment.
    pub(crate) fn work_on(&self, own: Load) -> (c64, c64) {
        let (a, b) = (own.force.conj(), own.moment.conj());
        (a * self.second + b * self.first.conj(), a * self.first + b * self.zeroth)
    }
}

/// What all points from b on do to the springs before b: `δ_s = c_s (force·conj(q_b − q_s) + moment)`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Load {
    /// `Σ_{j≥b} μ_j`.
    pub(crate) force: c64,
    /// `Σ_{j≥b} μ_j conj(q_j − q_b)`.
    pub(crate) moment: c64,
}

impl Load {
    /// This without `other`.
    pub(crate) fn less(self, other: Self) -> Self {
        Self { force: self.force - other.force, moment: self.moment - other.moment }
    }

    /// The same about the point before, `chord` = q_b − q_a, with a load μ on that point.
    pub(crate) fn carried(self, chord: c64, mu: c64) -> Self {
        Self { force: self.force + mu, moment: self.moment + self.force * chord.conj() }
    }
}

/// Covariance of a row with any row that touches no node before its last: linear in the load of that row at its first node.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Answer {
    /// Of a unit force, less what it takes to carry it from `origin`.
    pub(crate) force: c64,
    /// Of a unit moment.
    pub(crate) moment: c64,
    /// Chord from the first point to the row's first node.
    pub(crate) origin: c64,
}

impl Answer {
    /// `place`: chord from the first point to where `load` is.
    pub(crate) fn to(&self, place: c64, load: Load) -> c64 {
        load.force * (self.force + self.moment * (place - self.origin).conj()) + load.moment * self.moment
    }
}

/// Point and factor at a point of a bent path: `x_j`, and `ζ` of the segment before it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct State {
    /// `x_j`.
    pub(crate) point: c64,
    /// `ζ_{j−1}`.
    pub(crate) factor: c64,
}

impl State {
    /// The state at b from that at a, through springs with these moments under the load of all points from b on.
    pub(crate) fn through(self, moments: &Moments, load: Load) -> Self {
        let Load { force, moment } = load;
        Self {
            point: self.point + self.factor * moments.chord + force * moments.second + moment * moments.first,
            factor: self.factor + force * moments.first.conj() + moment * moments.zeroth,
        }
    }
}

/// What becomes of the points of a bent path, which are given in order. Closures are given every point by itself.
pub trait Drawing {
    /// Point `j`: `x_j`, and the factor `ζ_j` of the segment after it; at the last point, of the one before.
    fn point(&mut self, j: usize, x: c64, factor: c64);

    /// Points in `range`, the springs at which do not bend: all of them have one factor. `start`: `x` at the first, and that factor.
    fn stiff(&mut self, range: Range<usize>, start: (c64, c64), rest: &SpringPath) {
        let ((x, factor), first) = (start, rest.point(range.start));
        for j in range {
            self.point(j, x + factor * (rest.point(j) - first), factor);
        }
    }
}

impl<F: FnMut(usize, c64, c64)> Drawing for F {
    fn point(&mut self, j: usize, x: c64, factor: c64) {
        self(j, x, factor);
    }
}

/// A chain of springs at rest.
#[derive(Clone, Debug, PartialEq)]
pub enum SpringPath {
    /// Rest points and compliances, one each a point; the first and last compliance are 0.
    Listed {
        /// Rest points q.
        points: Vec<c64>,
        /// `c_s`, at least 0.
        compliances: Vec<f64>,
    },
    /// Points `q_j = j`.
    Even {
        /// Number of points.
        count: usize,
        /// First spring and compliance of stretches of equal springs, rising from spring 0; the springs at the first and
        /// last point have none, whatever stands here.
        stretches: Vec<(usize, f64)>,
    },
}

impl SpringPath {
    /// Shape rows of weight 1 on these points, no two neighbours of which coincide: `c_s = |g|²`. Cost: linear in points.
    pub fn of_shape(points: Vec<c64>) -> Self {
        let square = |pair: &[c64]| (pair[1] - pair[0]).norm_sqr();
        let inner = points.windows(3).map(|p| (p[2] - p[0]).norm_sqr() / (square(&p[..2]) * square(&p[1..])));
        let mut compliances = vec![0.0; points.len()];
        compliances.iter_mut().skip(1).zip(inner).for_each(|(own, c)| *own = c);
        Self::Listed { points, compliances }
    }

    /// Second differences of `count` points with weight 1.
    pub fn even(count: usize) -> Self {
        Self::Even { count, stretches: vec![(0, 1.0)] }
    }

    /// Number of points.
    pub fn len(&self) -> usize {
        match self {
            Self::Listed { points, .. } => points.len(),
            Self::Even { count, .. } => *count,
        }
    }

    /// No point at all.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Rest point `q_j`.
    pub fn point(&self, j: usize) -> c64 {
        match self {
            Self::Listed { points, .. } => points[j],
            Self::Even { .. } => c64::new(j as f64, 0.0),
        }
    }

    /// Centre of the rest points `range` and the root of their summed squared distances from it. Cost: linear in points,
    /// for even paths constant.
    pub(crate) fn spread(&self, range: Range<usize>) -> (c64, f64) {
        match self {
            Self::Listed { points, .. } => {
                let points = &points[range];
                let (first, n) = (points[0], points.len() as f64);
                // From the first point, so that one pass will do: sums of squares lose two bits at most.
                let (sum, squares) = points.iter().fold((c64::default(), 0.0), |(sum, squares), q| {
                    let arm = q - first;
                    (sum + arm, squares + arm.norm_sqr())
                });
                (first + sum / n, (squares - sum.norm_sqr() / n).max(0.0).sqrt())
            }
            Self::Even { .. } => {
                let n = range.len() as f64;
                (c64::new(range.start as f64 + (n - 1.0) / 2.0, 0.0), (n * (n * n - 1.0) / 12.0).sqrt())
            }
        }
    }

    /// Moments of the springs `from ≤ s < to`. Cost: linear in springs, for even paths in stretches.
    pub fn moments(&self, from: usize, to: usize) -> Moments {
        match self {
            Self::Listed { points, compliances } => {
                let mut sum = Moments::default();
                for (pair, compliance) in points[from..=to].windows(2).zip(&compliances[from..to]) {
                    let step = pair[1] - pair[0];
                    let zeroth = sum.zeroth + compliance;
                    let turn = sum.first * step.conj();
                    sum.first += zeroth * step;
                    sum.second += 2.0 * turn.re + zeroth * step.norm_sqr();
                    sum.zeroth = zeroth;
                }
                sum.chord = points[to] - points[from];
                sum
            }
            Self::Even { .. } => {
                let mut sum = Moments::default();
                self.visit_stretches(from..to, |springs, compliance| {
                    sum = sum.then(Moments::even(springs.len(), compliance));
                });
                sum
            }
        }
    }

    /// Draws the points `range` of the bent path. `state`: at the first of them. `load`: of all points from the end of the range
    /// on; points in between carry none.
    pub(crate) fn bend(&self, range: Range<usize>, state: State, load: Load, drawing: &mut impl Drawing) {
        let State { mut point, mut factor } = state;
        let Load { force, moment } = load;
        match self {
            Self::Listed { points, compliances } => {
                let last = range.end.min(points.len() - 1);
                let tip = points[last];
                let mut start = range.start;
                while start < last {
                    let rest = &compliances[start..last];
                    let stiff = rest.iter().position(|c| *c != 0.0).unwrap_or(rest.len());
                    if stiff > 0 {
                        drawing.stiff(start..start + stiff, (point, factor), self);
                        point += factor * (points[start + stiff] - points[start]);
                        start += stiff;
                    }
                    let pairs = points[start..=last].windows(2);
                    for (pair, compliance) in pairs.zip(&compliances[start..last]) {
                        if *compliance == 0.0 {
                            break;
                        }
                        factor += compliance * (force * (tip - pair[0]).conj() + moment);
                        drawing.point(start, point, factor);
                        point += factor * (pair[1] - pair[0]);
                        start += 1;
                    }
                }
                if range.end > last {
                    drawing.point(last, point, factor);
                }
            }
            Self::Even { .. } => {
                let end = range.end;
                self.visit_stretches(range, |springs, compliance| {
                    if compliance == 0.0 {
                        let count = springs.len() as f64;
                        drawing.stiff(springs, (point, factor), self);
                        point += factor * count;
                        return;
                    }
                    let change = compliance * force;
                    let mut increment = change * (end - springs.start) as f64 + compliance * moment;
                    for s in springs {
                        factor += increment;
                        increment -= change;
                        drawing.point(s, point, factor);
                        point += factor;
                    }
                });
            }
        }
    }

    /// Calls `visit` with the parts of `springs` that have one compliance.
    fn visit_stretches(&self, springs: Range<usize>, mut visit: impl FnMut(Range<usize>, f64)) {
        let Self::Even { count, stretches } = self else { return };
        let last = count - 1;
        let mut start = springs.start;
        while start < springs.end {
            let following = stretches.partition_point(|(first, _)| *first <= start);
            let compliance = following.checked_sub(1).map_or(0.0, |stretch| stretches[stretch].1);
            let next = stretches.get(following).map_or(usize::MAX, |(first, _)| *first);
            let (end, compliance) = match start {
                0 => (1, 0.0),
                s if s == last => (s + 1, 0.0),
                _ => (next.min(last), compliance),
            };
            let end = end.min(springs.end);
            visit(start..end, compliance);
            start = end;
        }
    }
}
