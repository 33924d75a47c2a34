//! Settings of an edit, and which of them the two modes choose.

use crate::scene::Mode;

/// How the body's facing follows a bent path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FacingMode {
    /// With the tangent, turned-over stretches interpolated: the published method.
    Tangent,
    /// With the tangent where somebody walks, with the rotation of the shape phase where they stand.
    TangentBlend,
}

/// What a relative constraint keeps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RelativeMode {
    /// Coordinates in units of the partner's tangent, in both phases: distances scale with the partner's stride.
    TangentScaled,
    /// The offset in metres.
    RigidOffset,
}

/// What a stationary stretch keeps in the scale phase.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RunMode {
    /// Its shape up to a rigid motion.
    Rigid,
    /// Its shape up to a similarity: the published method.
    Similar,
}

/// Which solver answers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Backend {
    /// Exact reduction to the constrained frames: the default.
    #[default]
    Reduced,
    /// Sparse LU of all frames: the reference.
    Direct,
    /// Sparse LU of all frames as published: normal equations, two real unknowns a frame, hard constraints and stationary
    /// stretches held with multipliers; times likewise. To compare with: it is off by more than rounding.
    Published,
}

/// Settings of the spatial phases.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpatialSettings {
    /// Speed v_κ below which frames bend no more easily than at that speed, m/s; 0 = no floor.
    pub stiffness_speed: f64,
    /// Largest stiffness κ, m².
    pub stiffness_cap: f64,
    /// How the body turns with the path.
    pub facing: FacingMode,
    /// What relative constraints keep.
    pub relative: RelativeMode,
    /// What stationary stretches keep.
    pub runs: RunMode,
    /// Shortest vector that serves as the frame of a direction, metres; shorter ones are widened.
    pub baseline: f64,
}

impl SpatialSettings {
    /// Settings of the published method.
    pub const PAPER: Self = Self {
        stiffness_speed: 0.0,
        stiffness_cap: 1e12,
        facing: FacingMode::Tangent,
        relative: RelativeMode::RigidOffset,
        runs: RunMode::Rigid,
        baseline: 0.05,
    };
    /// The default.
    pub const PRODUCTION: Self = Self {
        stiffness_speed: 0.6,
        stiffness_cap: 1e2,
        facing: FacingMode::TangentBlend,
        relative: RelativeMode::RigidOffset,
        runs: RunMode::Rigid,
        baseline: 0.05,
    };

    /// What `mode` chooses.
    pub fn of(mode: Mode) -> Self {
        match mode {
            Mode::Paper => Self::PAPER,
            Mode::Production => Self::PRODUCTION,
        }
    }
}
