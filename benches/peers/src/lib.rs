//! Times UMFPACK, KLU and Eigen on the very systems that cotillion solves, beside our own solvers.

pub mod configuration;
pub mod measure;
pub mod options;
pub mod ours;
pub mod peer;
pub mod problem;
pub mod race;
pub mod relay;
pub mod system;
pub mod table;
