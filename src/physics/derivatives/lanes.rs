//! Numbers along time, one lane after another.

use glam::DVec3;

/// Samples of several numbers over the same frames: all frames of lane 0, then of lane 1 … Vectors are three lanes in a row.
#[derive(Clone, Debug, PartialEq)]
pub struct Lanes {
    /// Frames of each lane.
    pub frame_count: usize,
    /// `frame_count` numbers a lane.
    pub values: Vec<f64>,
}

impl Lanes {
    /// Zeros everywhere.
    pub fn zeros(lane_count: usize, frame_count: usize) -> Self {
        Self { frame_count, values: vec![0.0; lane_count * frame_count] }
    }

    /// Three lanes of one vector a frame.
    pub fn of_vectors(vectors: &[DVec3]) -> Self {
        let mut lanes = Self::zeros(3, vectors.len());
        let [x, y, z] = lanes.vector_mut(0);
        for (frame, vector) in vectors.iter().enumerate() {
            (x[frame], y[frame], z[frame]) = (vector.x, vector.y, vector.z);
        }
        lanes
    }

    /// Number of lanes; 0 without frames.
    pub fn lane_count(&self) -> usize {
        self.values.len().checked_div(self.frame_count).unwrap_or(0)
    }

    /// One lane along time.
    pub fn lane(&self, index: usize) -> &[f64] {
        &self.values[index * self.frame_count..(index + 1) * self.frame_count]
    }

    /// One lane along time.
    pub fn lane_mut(&mut self, index: usize) -> &mut [f64] {
        &mut self.values[index * self.frame_count..(index + 1) * self.frame_count]
    }

    /// The three lanes of vector `index` along time.
    pub fn vector_lanes(&self, index: usize) -> [&[f64]; 3] {
        [0, 1, 2].map(|axis| self.lane(3 * index + axis))
    }

    /// The three lanes of vector `index` along time.
    pub fn vector_mut(&mut self, index: usize) -> [&mut [f64]; 3] {
        let count = self.frame_count;
        let (x, rest) = self.values[3 * index * count..3 * (index + 1) * count].split_at_mut(count);
        let (y, z) = rest.split_at_mut(count);
        [x, y, z]
    }

    /// Vector `index` in one frame.
    pub fn vector(&self, index: usize, frame: usize) -> DVec3 {
        let at = 3 * index * self.frame_count + frame;
        DVec3::new(
            self.values[at],
            self.values[at + self.frame_count],
            self.values[at + 2 * self.frame_count],
        )
    }

    /// The vectors of the three lanes of vector `index`, one a frame.
    pub fn vectors(&self, index: usize) -> Vec<DVec3> {
        (0..self.frame_count).map(|frame| self.vector(index, frame)).collect()
    }
}
