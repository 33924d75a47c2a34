//! A motion graph as bytes, and what tells whether stored bytes are of the same clips.
//!
//! ```text
//!     magic, version, key      what it is, how it is written, what it is of
//!     clips                    count; of each its frames and its body
//!     bodies                   count; of each its median distance (NaN for none) and the largest of similar frames
//!     pairs                    of each frame how many later ones are similar; then all of these; then their distances
//!     checksum                 SHA-256 of everything before it
//! ```
//! Numbers are little-endian, u64 or f64, frames u32.

use sha2::{Digest, Sha256};

use super::{FramePair, GraphClip, GraphSettings, Material, Maxima, MotionGraph, assemble};
use crate::index::GraphFrame;
use crate::similarity::Admissible;

const MAGIC: &[u8; 16] = b"cotillion graph\n";
/// Of the bytes, and of what the search does with the same material.
const VERSION: u64 = 1;
/// Bytes of a SHA-256.
const HASH: usize = 32;

/// What a graph is of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GraphKey(pub [u8; HASH]);

impl GraphKey {
    /// Hash of all that the search reads: features (which hold the motion of the joints that count), contacts, bodies and settings.
    /// Cost: linear in frames.
    pub fn new(material: &Material, settings: &GraphSettings) -> Self {
        let mut hash = Sha256::new();
        let mut add = |value: u64| hash.update(value.to_le_bytes());
        add(u64::from(settings.maxima == Maxima::Strict8));
        add(settings.largest_distance.map_or(u64::MAX, f64::to_bits));
        add(settings.contact_tolerance as u64);
        for body in &material.admissible {
            add(body.median.map_or(u64::MAX, f64::to_bits));
            add(body.largest.to_bits());
        }
        for (side, body) in material.sides.iter().zip(&material.bodies) {
            add(*body as u64);
            add(side.features.width as u64);
            add(side.feet.bear.len() as u64);
            side.features.values.iter().for_each(|value| add(value.to_bits()));
            side.feet.bear.iter().for_each(|[left, right]| add(u64::from(*left) + 2 * u64::from(*right)));
            add(u64::from(side.feet.apart.is_some()));
            let apart = side.feet.apart.iter().flat_map(|(apart, _)| apart);
            apart.for_each(|apart| add(apart.to_bits()));
        }
        Self(hash.finalize().into())
    }

    /// Hexadecimal digits.
    pub fn hex(&self) -> String {
        self.0.iter().map(|byte| format!("{byte:02x}")).collect()
    }
}

/// Why stored bytes are of no use.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum StoredError {
    /// They are something else.
    #[error("it is no motion graph")]
    NotAGraph,
    /// Another version wrote them.
    #[error("it was written by another version ({0})")]
    Version(u64),
    /// They are of other clips, or made with other settings.
    #[error("it is of other clips")]
    OtherClips,
    /// Some are lost or changed.
    #[error("it is damaged")]
    Damaged,
}

/// The bytes of `graph`, which is of what `key` tells.
pub fn encode(graph: &MotionGraph, key: &GraphKey) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(128 + 8 * graph.frame_count() + 6 * graph.similar.len());
    bytes.extend(MAGIC);
    bytes.extend(VERSION.to_le_bytes());
    bytes.extend(key.0);
    bytes.extend((graph.clips.len() as u64).to_le_bytes());
    for clip in &graph.clips {
        bytes.extend((clip.frames as u64).to_le_bytes());
        bytes.extend((clip.body as u64).to_le_bytes());
    }
    bytes.extend((graph.bodies.len() as u64).to_le_bytes());
    for body in &graph.bodies {
        bytes.extend(body.median.unwrap_or(f64::NAN).to_le_bytes());
        bytes.extend(body.largest.to_le_bytes());
    }
    for frame in 0..graph.frame_count() {
        let frame = GraphFrame::from_usize(frame);
        let later = graph.similar_to(frame).filter(|(like, _)| *like > frame).count();
        bytes.extend((later as u64).to_le_bytes());
    }
    graph.pairs().for_each(|(_, j, _)| bytes.extend(j.0.to_le_bytes()));
    graph.pairs().for_each(|(_, _, distance)| bytes.extend(distance.to_le_bytes()));
    let checksum: [u8; HASH] = Sha256::digest(&bytes).into();
    bytes.extend(checksum);
    bytes
}

/// The graph of what `key` tells, if `bytes` are that.
///
/// # Errors
/// [`StoredError`], whatever the bytes are.
pub fn decode(bytes: &[u8], key: &GraphKey) -> Result<MotionGraph, StoredError> {
    let rest = bytes.strip_prefix(MAGIC).ok_or(StoredError::NotAGraph)?;
    let mut reader = Reader(rest);
    let version = reader.number()?;
    if version != VERSION {
        return Err(StoredError::Version(version));
    }
    if reader.take::<HASH>()? != key.0 {
        return Err(StoredError::OtherClips);
    }
    let body = reader.0.len().checked_sub(HASH).ok_or(StoredError::Damaged)?;
    let (content, checksum) = bytes.split_at(bytes.len() - HASH);
    if Sha256::digest(content)[..] != *checksum {
        return Err(StoredError::Damaged);
    }
    Reader(&reader.0[..body]).graph()
}

/// Reads numbers off the front.
struct Reader<'a>(&'a [u8]);

impl Reader<'_> {
    fn take<const N: usize>(&mut self) -> Result<[u8; N], StoredError> {
        let (first, rest) = self.0.split_first_chunk().ok_or(StoredError::Damaged)?;
        self.0 = rest;
        Ok(*first)
    }

    fn number(&mut self) -> Result<u64, StoredError> {
        self.take().map(u64::from_le_bytes)
    }

    /// How many items of at least `bytes` bytes each follow.
    fn count(&mut self, bytes: usize) -> Result<usize, StoredError> {
        let count = usize::try_from(self.number()?).map_err(|_| StoredError::Damaged)?;
        if count > self.0.len() / bytes { Err(StoredError::Damaged) } else { Ok(count) }
    }

    fn real(&mut self) -> Result<f64, StoredError> {
        self.take().map(f64::from_le_bytes)
    }

    fn graph(mut self) -> Result<MotionGraph, StoredError> {
        let clips = self.clips()?;
        let bodies = self.bodies()?;
        let frames: usize = clips.iter().map(|clip| clip.frames).sum();
        if clips.iter().any(|clip| clip.body >= bodies.len()) || frames > self.0.len() / 8 {
            return Err(StoredError::Damaged);
        }
        let later: Vec<u64> = (0..frames).map(|_| self.number()).collect::<Result<_, _>>()?;
        let mut pairs = Vec::new();
        for (frame, later) in later.into_iter().enumerate() {
            let i = GraphFrame::from_usize(frame);
            let mut before = i;
            for _ in 0..later {
                let j = GraphFrame(u32::from_le_bytes(self.take()?));
                if j <= before || j.as_usize() >= frames {
                    return Err(StoredError::Damaged);
                }
                before = j;
                pairs.push(FramePair { i, j, distance: 0.0 });
            }
        }
        for pair in &mut pairs {
            pair.distance = self.real()?;
        }
        let is_sound = self.0.is_empty() && pairs.iter().all(|pair| pair.distance.is_finite());
        if is_sound { Ok(assemble(clips, bodies, &pairs)) } else { Err(StoredError::Damaged) }
    }

    fn clips(&mut self) -> Result<Vec<GraphClip>, StoredError> {
        let mut first = 0;
        (0..self.count(16)?)
            .map(|_| {
                let (frames, body) = (self.count(8)?, self.number()?);
                let body = usize::try_from(body).map_err(|_| StoredError::Damaged)?;
                let clip = GraphClip { first: GraphFrame::from_usize(first), frames, body };
                first += frames;
                if u32::try_from(first).is_err() { Err(StoredError::Damaged) } else { Ok(clip) }
            })
            .collect()
    }

    fn bodies(&mut self) -> Result<Vec<Admissible>, StoredError> {
        (0..self.count(16)?)
            .map(|_| {
                let (median, largest) = (self.real()?, self.real()?);
                Ok(Admissible { median: Some(median).filter(|median| !median.is_nan()), largest })
            })
            .collect()
    }
}
