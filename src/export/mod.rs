//! Files out of results.

pub mod bvh;
pub mod gltf;
mod palette;
pub mod picture;
