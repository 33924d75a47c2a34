//! Files out of results.

pub mod bvh;
pub mod gltf;
pub mod picture;
