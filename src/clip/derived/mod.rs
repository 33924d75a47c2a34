//! Clips made of other clips: bent, tilted, blended, cut. Nobody performed them; they are what edits are tried on.

mod arc;
mod blend;
mod part;
mod slope;

pub use arc::{ArcError, bent};
pub use blend::{BlendError, Blended, Share, blended};
pub use part::usable_part;
pub use slope::{SlopeError, tilted};
