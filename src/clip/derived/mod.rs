//! Clips made of other clips: bent, tilted, blended. Nobody performed them; they are what edits are tried on.

mod arc;
mod blend;
mod slope;

pub use arc::{ArcError, bent};
pub use blend::{BlendError, Blended, Share, blended};
pub use slope::{SlopeError, tilted};
