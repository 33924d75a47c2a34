//! Motion graph: which frames of a set of clips are so alike that a motion may go on from one as if it were the other.
//!
//! Nodes are the working frames of all clips. An edge a → b other than to the next frame means *after showing a, show b*;
//! it exists where frames a and b − 1 are similar, so the graph is held as the similar pairs (i, j), each of which gives i → j+1
//! and j → i+1. Pairs are similar if their distance ([`crate::similarity`]) is a local minimum of the distance matrix below
//! min(0.4·M, 1), M the median over moving frames of the same body, the same feet bear, and
//! where there is a gait one is as far ahead of the other. Clips of different bodies are not compared.
//!
//! # Cost
//! The distance matrix of n frames of one body is a matrix product, `n²/2` entries of about 90 features, in tiles and in
//! parallel; it is never held. Memory is 2 kB a frame for features, and 40 bytes for each pair that is kept: of all captures tried,
//! walking and standing, at most n²/400. (A single pose held without any motion has n²/25.) 100 000 frames of one body take
//! 20 to 40 s of processor time and up to 1.2 GB; bench `graph`, and `docs/motion_graph.md`, have more.
//!
//! Source: Kim et al. 2009, §5.1, after Lee et al., *Interactive Control of Avatars Animated with Human Motion Data*, SIGGRAPH
//! 2002 (contact agreement, local maxima) and Lee & Lee, *Precomputing Avatar Behavior from Human Motion Data*, 2006 (features).
//! Kept are pairs along the ridges of similarity rather than strict local maxima, of which cyclic motion has too few at some
//! phases, and the threshold follows the clips rather than the user: ours.

mod contact;
pub mod facts;
mod matrix;
pub mod reach;
pub mod scene;
mod search;
pub mod stored;
#[cfg(test)]
mod tests;
mod thinning;

use std::sync::Arc;

use rayon::prelude::*;

use self::contact::Feet;
use self::matrix::Factors;
use self::search::{Block, Side, TILE};
use crate::clip::working::WorkingClip;
use crate::index::{FrameIndex, GraphFrame};
use crate::similarity::{Admissible, Features, admissible, features, mean_rotations};

/// Which pairs of similar frames are kept.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GraphSettings {
    /// Which local maxima of similarity.
    pub maxima: Maxima,
    /// Largest distance of similar frames; `None`: min(0.4·M, 1), M the median over moving frames of the same body.
    pub largest_distance: Option<f64>,
    /// Frames by which the contacts of similar frames may differ.
    pub contact_tolerance: usize,
}

impl Default for GraphSettings {
    fn default() -> Self {
        Self { maxima: Maxima::Ridge, largest_distance: None, contact_tolerance: 1 }
    }
}

/// Which local maxima of similarity are kept.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Maxima {
    /// At least as alike as the six neighbours off their own diagonal; of those within five frames along a
    /// diagonal and those next to it, the most alike.
    #[default]
    Ridge,
    /// At least as alike as all eight neighbours: the published rule.
    Strict8,
}

/// Similar frames of a set of clips.
#[derive(Clone, Debug, PartialEq)]
pub struct MotionGraph {
    /// In the order they were given.
    pub clips: Vec<GraphClip>,
    /// What counts as similar, one entry a body.
    pub bodies: Vec<Admissible>,
    /// Where each frame's part of `similar` starts, and the end of the last: one more than frames.
    pub starts: Vec<usize>,
    /// Frames similar to frame 0, to frame 1 …, each part in rising order; if j is among those of i, i is among those of j.
    pub similar: Vec<GraphFrame>,
    /// Distance D of each entry of `similar`.
    pub distances: Vec<f64>,
}

/// A clip of a motion graph.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GraphClip {
    /// Its first frame.
    pub first: GraphFrame,
    /// Number of working frames.
    pub frames: usize,
    /// Position of its body in [`MotionGraph::bodies`].
    pub body: usize,
}

impl MotionGraph {
    /// Number of frames of all clips.
    pub fn frame_count(&self) -> usize {
        self.starts.len() - 1
    }

    /// Number of the working frame `frame` of a clip, which must have it.
    pub fn frame(&self, clip: usize, frame: FrameIndex) -> GraphFrame {
        GraphFrame(self.clips[clip].first.0 + frame.0)
    }

    /// Clip and working frame of a frame. Cost: logarithmic in clips.
    pub fn place(&self, frame: GraphFrame) -> (usize, FrameIndex) {
        let clip = self.clips.partition_point(|clip| clip.first <= frame) - 1;
        (clip, FrameIndex(frame.0 - self.clips[clip].first.0))
    }

    /// Frames similar to `frame` with their distances, in rising order.
    pub fn similar_to(&self, frame: GraphFrame) -> impl ExactSizeIterator<Item = (GraphFrame, f64)> + '_ {
        let range = self.starts[frame.as_usize()]..self.starts[frame.as_usize() + 1];
        self.similar[range.clone()].iter().copied().zip(self.distances[range].iter().copied())
    }

    /// Every pair once, the smaller frame first, in rising order.
    pub fn pairs(&self) -> impl Iterator<Item = (GraphFrame, GraphFrame, f64)> + '_ {
        (0..self.frame_count()).map(GraphFrame::from_usize).flat_map(move |i| {
            self.similar_to(i).filter(move |(j, _)| *j > i).map(move |(j, distance)| (i, j, distance))
        })
    }
}

/// What a graph is made of: all that [`search`] reads.
pub struct Material {
    /// One entry a clip.
    sides: Vec<Side>,
    /// Body of each clip.
    bodies: Vec<usize>,
    admissible: Vec<Admissible>,
}

/// Motion graph of `clips`. Cost: quadratic in the frames of each body; see the module.
pub fn motion_graph(clips: &[Arc<WorkingClip>], settings: &GraphSettings) -> MotionGraph {
    search(&material(clips), settings)
}

/// Features, contacts and thresholds of `clips`. Cost: linear in frames times joints.
pub fn material(clips: &[Arc<WorkingClip>]) -> Material {
    let mut bodies: Vec<usize> = Vec::with_capacity(clips.len());
    let mut first_of: Vec<usize> = Vec::new();
    for clip in clips {
        let known = first_of.iter().position(|first| {
            let (a, b) = (&clips[*first].clip.skeleton, &clip.clip.skeleton);
            Arc::ptr_eq(a, b) || a == b
        });
        bodies.push(known.unwrap_or(first_of.len()));
        if known.is_none() {
            first_of.push(bodies.len() - 1);
        }
    }
    let of_body = |body: usize| (0..clips.len()).filter(|clip| bodies[*clip] == body).collect::<Vec<_>>();
    let members: Vec<Vec<usize>> = (0..first_of.len()).map(of_body).collect();
    let means: Vec<_> = members
        .par_iter()
        .map(|of| mean_rotations(&of.iter().map(|clip| &*clips[*clip]).collect::<Vec<_>>()))
        .collect();
    let all: Vec<Features> =
        clips.par_iter().zip(&bodies).map(|(clip, body)| features(clip, &means[*body])).collect();
    let admissible = members
        .par_iter()
        .map(|of| admissible(&of.iter().map(|clip| (&*clips[*clip], &all[*clip])).collect::<Vec<_>>()))
        .collect();
    let side = |(features, clip): (Features, &Arc<WorkingClip>)| Side {
        factors: Factors::new(&features),
        features,
        feet: Feet::of(clip),
    };
    Material { sides: all.into_par_iter().zip(clips).map(side).collect(), bodies, admissible }
}

/// Motion graph of what `material` is of. Cost: quadratic in the frames of each body.
pub fn search(material: &Material, settings: &GraphSettings) -> MotionGraph {
    let clips = graph_clips(material);
    let count = clips.len();
    let blocks: Vec<(usize, usize)> = (0..count)
        .flat_map(|a| (a..count).map(move |b| (a, b)))
        .filter(|(a, b)| clips[*a].body == clips[*b].body)
        .collect();
    let found: Vec<Vec<FramePair>> = blocks
        .into_par_iter()
        .map(|(a, b)| {
            let largest = settings.largest_distance.unwrap_or(material.admissible[clips[a].body].largest);
            let block = Block {
                rows: &material.sides[a],
                columns: &material.sides[b],
                is_diagonal: a == b,
                largest_sq: largest * largest,
                settings: *settings,
                tile: TILE,
            };
            block
                .pairs()
                .into_iter()
                .map(|pair| FramePair::of(&pair, clips[a].first, clips[b].first))
                .collect()
        })
        .collect();
    let mut pairs = found.concat();
    drop(found);
    pairs.par_sort_unstable_by_key(|pair| (pair.i, pair.j));
    assemble(clips, material.admissible.clone(), &pairs)
}

/// A kept pair; i before j.
#[derive(Clone, Copy)]
struct FramePair {
    i: GraphFrame,
    j: GraphFrame,
    distance: f64,
}

impl FramePair {
    fn of(pair: &thinning::Pair, rows: GraphFrame, columns: GraphFrame) -> Self {
        let frame = |first: GraphFrame, offset| GraphFrame::from_usize(first.as_usize() + offset);
        Self { i: frame(rows, pair.row), j: frame(columns, pair.column), distance: pair.distance }
    }
}

fn graph_clips(material: &Material) -> Vec<GraphClip> {
    let mut first = 0;
    let sides = material.sides.iter().zip(&material.bodies);
    sides
        .map(|(side, body)| {
            let frames = side.feet.bear.len();
            let clip = GraphClip { first: GraphFrame::from_usize(first), frames, body: *body };
            first += frames;
            clip
        })
        .collect()
}

/// Adjacency of `pairs`, sorted by both frames: filled in their order, every part is in rising order.
fn assemble(clips: Vec<GraphClip>, bodies: Vec<Admissible>, pairs: &[FramePair]) -> MotionGraph {
    let frames: usize = clips.iter().map(|clip| clip.frames).sum();
    let mut starts = vec![0; frames + 1];
    for pair in pairs {
        starts[pair.i.as_usize() + 1] += 1;
        starts[pair.j.as_usize() + 1] += 1;
    }
    for frame in 0..frames {
        starts[frame + 1] += starts[frame];
    }
    let mut next = starts.clone();
    let mut similar = vec![GraphFrame(0); 2 * pairs.len()];
    let mut distances = vec![0.0; 2 * pairs.len()];
    for FramePair { i, j, distance } in pairs {
        for (from, to) in [(i, j), (j, i)] {
            let place = &mut next[from.as_usize()];
            similar[*place] = *to;
            distances[*place] = *distance;
            *place += 1;
        }
    }
    MotionGraph { clips, bodies, starts, similar, distances }
}
