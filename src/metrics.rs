//! Measures of any clip, captured or edited.

pub use crate::clip::measure::{foot_slide, root_path, standing_height};
