//! Edits the motion of many synchronized characters at once: paths bend as rigidly as possible, times stretch smoothly,
//! and every constraint of the choreography holds.
//!
//! Nouns first, then the steps in the order of the flow; a module uses only modules above it.

pub mod index;
pub mod geometry;
pub mod skeleton;
pub mod clip;
pub mod similarity;
pub mod constraint;
pub mod path;
pub mod track;
pub mod scene;
pub mod edit;
pub mod resample;
pub mod metrics;
pub mod residual;
pub mod export;
