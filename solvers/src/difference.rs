//! Differences between intervals: which values are possible at all (a simple temporal network).
//!
//! Nodes are instants, say, and each constraint says that the step from one to another lies in an interval. Each side
//! of an interval is an edge of a graph, a path of edges bounds the step along it, and a cycle of negative length is a
//! contradiction.
//!
//! Source: Dechter, Meiri, Pearl, *Temporal constraint networks*, Artificial Intelligence 49 (1991).

use std::collections::VecDeque;

/// Every bound is relaxed by this much of the largest one, so that rounding contradicts nothing.
const RELATIVE_TOLERANCE: f64 = 1e-10;

/// `lower ≤ x_to − x_from ≤ upper`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Difference {
    /// Node at the start of the step.
    pub from: usize,
    /// Node at its end.
    pub to: usize,
    /// Least step; −∞ for none.
    pub lower: f64,
    /// Greatest step; ∞ for none.
    pub upper: f64,
    /// Name of the caller's choice for messages; several differences may share one.
    pub id: usize,
}

/// Possible values of `x_node − x_origin`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NodeBounds {
    /// Least; −∞ if nothing bounds it.
    pub lower: f64,
    /// Greatest; ∞ if nothing bounds it.
    pub upper: f64,
}

/// Why no values satisfy a set of differences.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DifferenceError {
    /// Constraints around a cycle contradict each other.
    #[error("constraints {ids:?} contradict each other by {deficit}")]
    Contradiction {
        /// Ids around the cycle; neighbours of one id are named once.
        ids: Vec<usize>,
        /// By how much the bounds along the cycle must be relaxed in all.
        deficit: f64,
    },
    /// A node does not exist.
    #[error("constraint {id} names node {node} of {node_count}")]
    NodeOutOfRange {
        /// Id of the constraint.
        id: usize,
        /// The node it names.
        node: usize,
        /// How many there are.
        node_count: usize,
    },
    /// A bound is not a number.
    #[error("a bound of constraint {id} is not a number")]
    NotANumber {
        /// Id of the constraint.
        id: usize,
    },
}

/// Bounds of every node relative to an origin, by shortest paths. They are wider than exact by 1e-10 of the largest
/// finite bound per constraint on the way, so they never exclude a value that equalities demand.
///
/// Cost: about linear in the constraints where a queue settles quickly (chains), at worst nodes × constraints.
///
/// # Errors
/// [`DifferenceError::Contradiction`] if nothing satisfies all differences, also far from the origin.
///
/// # Panics
/// If `origin` is not smaller than `node_count`.
pub fn node_bounds(
    node_count: usize,
    origin: usize,
    differences: &[Difference],
) -> Result<Vec<NodeBounds>, DifferenceError> {
    assert!(origin < node_count, "origin {origin} of {node_count} nodes");
    check(node_count, differences)?;
    let graph = Graph::new(node_count, differences);
    graph.shortest(&vec![0.0; node_count])?; // from everywhere at once: finds contradictions that the origin cannot see
    let mut start = vec![f64::INFINITY; node_count];
    start[origin] = 0.0;
    let upper = graph.shortest(&start)?;
    let lower = graph.reversed().shortest(&start)?;
    Ok(upper
        .into_iter()
        .zip(lower)
        .map(|(upper, to_origin)| NodeBounds { lower: -to_origin, upper })
        .collect())
}

fn check(node_count: usize, differences: &[Difference]) -> Result<(), DifferenceError> {
    for &Difference { from, to, lower, upper, id } in differences {
        if let Some(node) = [from, to].into_iter().find(|&node| node >= node_count) {
            return Err(DifferenceError::NodeOutOfRange { id, node, node_count });
        }
        if lower.is_nan() || upper.is_nan() || lower == f64::INFINITY || upper == f64::NEG_INFINITY {
            return Err(DifferenceError::NotANumber { id });
        }
    }
    Ok(())
}

/// `x_to − x_from ≤ weight`.
#[derive(Clone, Copy)]
struct Edge {
    from: usize,
    to: usize,
    weight: f64,
    id: usize,
}

struct Graph {
    edges: Vec<Edge>,
    leaving: Vec<Vec<usize>>,
    tolerance: f64,
}

impl Graph {
    fn new(node_count: usize, differences: &[Difference]) -> Self {
        let sides = differences.iter().flat_map(|&Difference { from, to, lower, upper, id }| {
            [Edge { from, to, weight: upper, id }, Edge { from: to, to: from, weight: -lower, id }]
        });
        Self::of_edges(node_count, sides.filter(|edge| edge.weight.is_finite()).collect())
    }

    fn of_edges(node_count: usize, edges: Vec<Edge>) -> Self {
        let mut leaving = vec![Vec::new(); node_count];
        edges.iter().enumerate().for_each(|(index, edge)| leaving[edge.from].push(index));
        let largest = edges.iter().map(|edge| edge.weight.abs()).fold(0.0, f64::max);
        Self { edges, leaving, tolerance: RELATIVE_TOLERANCE * largest }
    }

    fn reversed(&self) -> Self {
        let turn = |edge: &Edge| Edge { from: edge.to, to: edge.from, ..*edge };
        Self::of_edges(self.leaving.len(), self.edges.iter().map(turn).collect())
    }

    /// Bellman–Ford with a queue. Whenever as many improvements were made as there are nodes, the tree of predecessors is
    /// searched for a cycle, which is negative.
    fn shortest(&self, start: &[f64]) -> Result<Vec<f64>, DifferenceError> {
        let node_count = start.len();
        let mut distance = start.to_vec();
        let mut reached_by: Vec<Option<usize>> = vec![None; node_count];
        let mut waiting: VecDeque<usize> = (0..node_count).filter(|&node| start[node].is_finite()).collect();
        let mut queued: Vec<bool> = start.iter().map(|d| d.is_finite()).collect();
        let mut improvements = 0;
        while let Some(node) = waiting.pop_front() {
            queued[node] = false;
            for &index in &self.leaving[node] {
                let edge = self.edges[index];
                let through = distance[node] + edge.weight + self.tolerance;
                if through >= distance[edge.to] {
                    continue;
                }
                distance[edge.to] = through;
                reached_by[edge.to] = Some(index);
                improvements += 1;
                if improvements % node_count == 0 {
                    self.find_cycle(&reached_by)?;
                }
                if !std::mem::replace(&mut queued[edge.to], true) {
                    waiting.push_back(edge.to);
                }
            }
        }
        Ok(distance)
    }

    /// Follows predecessors from every node; a walk that meets itself has found a negative cycle.
    fn find_cycle(&self, reached_by: &[Option<usize>]) -> Result<(), DifferenceError> {
        let mut seen_from: Vec<Option<usize>> = vec![None; reached_by.len()];
        for start in 0..reached_by.len() {
            let mut node = start;
            while seen_from[node].is_none() {
                seen_from[node] = Some(start);
                let Some(index) = reached_by[node] else { break };
                node = self.edges[index].from;
            }
            if seen_from[node] == Some(start) && reached_by[node].is_some() {
                return Err(self.contradiction(reached_by, node));
            }
        }
        Ok(())
    }

    fn contradiction(&self, reached_by: &[Option<usize>], on_cycle: usize) -> DifferenceError {
        let mut cycle = Vec::new();
        let mut node = on_cycle;
        while let Some(index) = reached_by[node] {
            cycle.push(self.edges[index]);
            node = self.edges[index].from;
            if node == on_cycle {
                break;
            }
        }
        cycle.reverse();
        let deficit = -cycle.iter().map(|edge| edge.weight).sum::<f64>();
        let mut ids: Vec<usize> = cycle.iter().map(|edge| edge.id).collect();
        ids.dedup();
        if ids.len() > 1 && ids.first() == ids.last() {
            ids.pop();
        }
        DifferenceError::Contradiction { ids, deficit }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// At most 31 constraints on the way, each relaxed by 1e-10 of at most 2.
    const RELAXED: f64 = 1e-8;

    /// A track of 31 instants: every gap in [.01, .05] (ids 0 to 29).
    fn track() -> Vec<Difference> {
        (0..30).map(|i| Difference { from: i, to: i + 1, lower: 0.01, upper: 0.05, id: i }).collect()
    }

    #[test]
    fn duration_too_long_for_its_gaps_names_them_all() {
        let mut differences = track();
        differences.push(Difference { from: 0, to: 30, lower: 2.0, upper: 2.0, id: 99 });
        let Err(DifferenceError::Contradiction { mut ids, deficit }) = node_bounds(31, 0, &differences)
        else {
            panic!("30 gaps of at most .05 s do not make 2 s")
        };
        ids.sort_unstable();
        assert_eq!(ids, (0..30).chain([99]).collect::<Vec<_>>());
        assert!((deficit - 0.5).abs() < 1e-12);
    }

    #[test]
    fn possible_durations_leave_admissible_intervals() {
        let mut differences = track();
        differences.push(Difference { from: 0, to: 30, lower: 1.5, upper: 1.5, id: 99 });
        let bounds = node_bounds(31, 0, &differences).expect("exactly the longest gaps");
        assert!((bounds[10].lower - 0.5).abs() < RELAXED && (bounds[10].upper - 0.5).abs() < RELAXED);
        let bounds = node_bounds(31, 0, &track()).expect("nothing contradicts");
        assert!((bounds[10].lower - 0.1).abs() < RELAXED && (bounds[10].upper - 0.5).abs() < RELAXED);
    }

    #[test]
    fn contradictions_out_of_reach_are_found() {
        let step = |from, to, lower, id| Difference { from, to, lower, upper: f64::INFINITY, id };
        let differences = [step(1, 2, 1.0, 7), step(2, 1, -0.75, 8)];
        let expected = DifferenceError::Contradiction { ids: vec![7, 8], deficit: 0.25 };
        let Err(DifferenceError::Contradiction { mut ids, deficit }) = node_bounds(4, 0, &differences) else {
            panic!("expected {expected:?}")
        };
        ids.sort_unstable();
        assert_eq!(DifferenceError::Contradiction { ids, deficit }, expected);
        assert_eq!(
            node_bounds(4, 0, &[]).expect("free")[3],
            NodeBounds { lower: f64::NEG_INFINITY, upper: f64::INFINITY }
        );
    }

    #[test]
    fn empty_intervals_and_bad_input_are_refused() {
        let difference = Difference { from: 0, to: 1, lower: 1.0, upper: 0.5, id: 3 };
        assert_eq!(
            node_bounds(2, 0, &[difference]),
            Err(DifferenceError::Contradiction { ids: vec![3], deficit: 0.5 })
        );
        let spoilt = Difference { lower: f64::NAN, ..difference };
        assert_eq!(node_bounds(2, 0, &[spoilt]), Err(DifferenceError::NotANumber { id: 3 }));
        let spoilt = Difference { to: 2, ..difference };
        assert_eq!(
            node_bounds(2, 0, &[spoilt]),
            Err(DifferenceError::NodeOutOfRange { id: 3, node: 2, node_count: 2 })
        );
    }

    proptest! {
        /// Differences taken from given values never contradict each other, and the bounds hold these values.
        #[test]
        fn values_lie_between_their_bounds(
            values in prop::collection::vec(-10.0..10.0_f64, 2..20),
            pairs in prop::collection::vec((0..20_usize, 0..20_usize, 0.0..1.0_f64, 0.0..1.0_f64), 0..60),
        ) {
            let differences: Vec<_> = pairs.iter().enumerate().map(|(id, &(from, to, below, above))| {
                let (from, to) = (from % values.len(), to % values.len());
                let step = values[to] - values[from];
                Difference { from, to, lower: step - below, upper: step + above, id }
            }).collect();
            let bounds = node_bounds(values.len(), 0, &differences).expect("the values are a solution");
            for (value, NodeBounds { lower, upper }) in values.iter().zip(bounds) {
                prop_assert!((lower..=upper).contains(&(value - values[0])));
            }
        }
    }
}
