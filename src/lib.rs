//! Edits the motion of many synchronized characters at once: paths bend as rigidly as possible, times stretch smoothly,
//! and every constraint of the choreography holds.
//!
//! Nouns first, then the steps in the order of the flow; a module uses only modules above it.

pub mod clip;
pub mod constraint;
pub mod edit;
pub mod export;
pub mod geometry;
pub mod index;
pub mod metrics;
pub mod path;
pub mod resample;
pub mod residual;
pub mod scene;
pub mod similarity;
pub mod skeleton;
pub mod time_track;
pub mod track;
