//! Where a motion can go on to.

use petgraph::algo::kosaraju_scc;
use petgraph::graph::{DiGraph, NodeIndex};

use super::MotionGraph;
use crate::index::GraphFrame;

/// Frames of one clip with what may follow each within it: the next frame, and one past each similar frame, at distance D.
/// Nodes are in the order of the frames. Cost: linear in frames and pairs.
pub fn followers(graph: &MotionGraph, clip: usize) -> DiGraph<GraphFrame, f64> {
    let of = &graph.clips[clip];
    let first = of.first.as_usize();
    let frames = first..first + of.frames;
    let mut view = DiGraph::with_capacity(of.frames, of.frames);
    for frame in frames.clone() {
        view.add_node(GraphFrame::from_usize(frame));
    }
    for frame in frames.clone() {
        let next = (GraphFrame::from_usize(frame), 0.0);
        for (like, distance) in std::iter::once(next).chain(graph.similar_to(next.0)) {
            let shown = like.as_usize() + 1;
            if frames.contains(&like.as_usize()) && shown < frames.end {
                view.add_edge(NodeIndex::new(frame - first), NodeIndex::new(shown - first), distance);
            }
        }
    }
    view
}

/// Largest set of frames of a clip from each of which all others can be reached: what can be played without end. 0 if none can.
pub fn largest_loop(graph: &MotionGraph, clip: usize) -> usize {
    let components = kosaraju_scc(&followers(graph, clip));
    components.iter().map(Vec::len).filter(|frames| *frames > 1).max().unwrap_or(0)
}
