//! Files out of results.

pub mod aside;
pub mod body_report;
pub mod bvh;
pub mod changes;
pub mod files;
pub mod flight_report;
pub mod gltf;
pub mod masses_report;
mod palette;
pub mod parts;
pub mod physics_report;
pub mod picture;
pub mod report;
pub mod scene;
pub mod shards;
pub mod strips;
pub mod touch_up_report;
