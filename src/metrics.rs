//! Measures of any clip, captured or edited.

pub use crate::clip::measure::{foot_slide, foot_slide_at, foot_slide_working, root_path, standing_height};
