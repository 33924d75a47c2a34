//! Spliced paths: stretches of known paths, moved rigidly and set one after the other.
//!
//! Moments of springs do not change under rigid motions but for a rotation, and they compose: with a tree of moments for
//! each source, those of any stretch of any splice are known in O(log points), without touching the points.

use std::ops::Range;

use crate::c64;
use crate::springs::{Moments, SpringPath};

/// Moments of all dyadic stretches of a path.
#[derive(Clone, Debug, PartialEq)]
pub struct MomentTree {
    points: Vec<c64>,
    /// Level 0: spring s with the segment after it; each level above joins pairs of the one below.
    levels: Vec<Vec<Moments>>,
}

impl MomentTree {
    /// Cost: linear in points.
    pub fn new(path: &SpringPath) -> Self {
        let points: Vec<c64> = (0..path.len()).map(|j| path.point(j)).collect();
        let spring = |s: usize| path.moments(s, s + 1);
        let mut levels = vec![(0..points.len().saturating_sub(1)).map(spring).collect::<Vec<_>>()];
        while levels[levels.len() - 1].len() > 1 {
            let below = &levels[levels.len() - 1];
            levels.push(below.chunks_exact(2).map(|pair| pair[0].then(pair[1])).collect());
        }
        Self { points, levels }
    }

    /// Number of points.
    pub fn len(&self) -> usize {
        self.points.len()
    }

    /// No point at all.
    pub fn is_empty(&self) -> bool {
        self.points.is_empty()
    }

    /// Rest point j.
    pub fn point(&self, j: usize) -> c64 {
        self.points[j]
    }

    /// Moments of the springs `from ≤ s < to`. Cost: logarithmic.
    pub fn moments(&self, mut from: usize, mut to: usize) -> Moments {
        let (mut left, mut right) = (Moments::default(), Moments::default());
        let mut level = 0;
        while from < to {
            if from % 2 == 1 {
                left = left.then(self.levels[level][from]);
                from += 1;
            }
            if to % 2 == 1 {
                to -= 1;
                right = self.levels[level][to].then(right);
            }
            (from, to) = (from / 2, to / 2);
            level += 1;
        }
        left.then(right)
    }
}

/// A stretch of a known path, placed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Part {
    /// Which tree.
    pub source: usize,
    /// First and last of its points.
    pub points: (usize, usize),
    /// Unit rotation.
    pub turn: c64,
    /// Where its first point lies.
    pub start: c64,
    /// Compliance of the springs at its first and last point, whose neighbours a seam may have changed; of a lone point,
    /// the last counts. 0 at both ends of the path.
    pub compliances: (f64, f64),
}

impl Part {
    fn len(&self) -> usize {
        self.points.1 - self.points.0 + 1
    }
}

/// Parts one after the other.
#[derive(Clone, Debug)]
pub struct SplicedPath<'a> {
    trees: &'a [MomentTree],
    parts: Vec<Part>,
    /// First point of each part, and the number of points.
    starts: Vec<usize>,
}

impl<'a> SplicedPath<'a> {
    /// The path of `parts`, each at least one point of its tree.
    pub fn new(trees: &'a [MomentTree], parts: Vec<Part>) -> Self {
        let mut starts = vec![0];
        starts.extend(parts.iter().scan(0, |next, part| {
            *next += part.len();
            Some(*next)
        }));
        Self { trees, parts, starts }
    }

    /// Number of points.
    pub fn len(&self) -> usize {
        self.starts[self.parts.len()]
    }

    /// No point at all.
    pub fn is_empty(&self) -> bool {
        self.parts.is_empty()
    }

    fn part_of(&self, j: usize) -> usize {
        self.starts.partition_point(|start| *start <= j) - 1
    }

    /// Point j.
    pub fn point(&self, j: usize) -> c64 {
        let index = self.part_of(j);
        let part = &self.parts[index];
        let tree = &self.trees[part.source];
        let own = part.points.0 + j - self.starts[index];
        part.start + part.turn * (tree.point(own) - tree.point(part.points.0))
    }

    /// Moments of the springs `from ≤ s < to`. Cost: logarithmic, times parts.
    pub fn moments(&self, from: usize, to: usize) -> Moments {
        let mut sum = Moments::default();
        let mut start = from;
        while start < to {
            let index = self.part_of(start);
            let end = self.starts[index + 1].min(to);
            sum = sum.then(self.of_part(index, start - self.starts[index]..end - self.starts[index]));
            start = end;
        }
        sum
    }

    /// Moments of springs of one part, counted from its first point.
    fn of_part(&self, index: usize, springs: Range<usize>) -> Moments {
        let part = &self.parts[index];
        let (tree, first, last) = (&self.trees[part.source], part.points.0, part.len() - 1);
        let mut sum = Moments::default();
        let mut start = springs.start;
        if start == 0 && last > 0 {
            let step = part.turn * (tree.point(first + 1) - tree.point(first));
            sum = Moments::of_spring(part.compliances.0, step);
            start = 1;
        }
        let end = springs.end.min(last);
        if start < end {
            sum = sum.then(tree.moments(first + start, first + end).turned(part.turn));
        }
        if springs.end > last {
            let seam = self.starts[index + 1];
            sum = sum.then(Moments::of_spring(part.compliances.1, self.point(seam) - self.point(seam - 1)));
        }
        sum
    }

    /// The same path with its points and springs listed. Cost: linear in points.
    pub fn listed(&self) -> SpringPath {
        let count = self.len();
        let points = (0..count).map(|j| self.point(j)).collect();
        let compliance = |s: usize| if s + 1 < count { self.moments(s, s + 1).zeroth } else { 0.0 };
        SpringPath::Listed { points, compliances: (0..count).map(compliance).collect() }
    }
}
