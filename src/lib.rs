//! Edits the motion of many synchronized characters at once: paths bend as rigidly as possible, times stretch smoothly,
//! and every constraint of the choreography holds.
//!
//! ```
//! use std::path::Path;
//! use cotillion::edit::{Editor, Target};
//! use cotillion::geometry::c64;
//! use cotillion::index::ConstraintId;
//! use cotillion::scene::{ClipFolders, load_text};
//!
//! let text = r#"
//!     [clips]
//!     walk = "builtin:walk"
//!     [[character]]
//!     name = "ann"
//!     track = ["walk"]
//!     [[pin]]
//!     at = "ann:end"
//!     position = [2.0, -3.0]
//!     strength = "hard"
//! "#;
//! let loaded = load_text(text, Path::new("scene.toml"), &ClipFolders::default()).expect("a sound scene");
//! let mut editor = Editor::new(loaded.scene).expect("a regular scene");
//! editor.move_target(ConstraintId(0), Target::Position(c64::new(2.5, -3.0))).expect("the pin has a position");
//! let edit = editor.solve().expect("the constraints agree");
//! let last = edit.characters[0].positions.last().expect("a track has frames");
//! assert!((last - c64::new(2.5, -3.0)).norm() < 1e-9);
//! ```
//!
//! Nouns first, then the steps in the order of the flow; a module uses only modules above it.

pub mod index;
pub mod geometry;
pub mod skeleton;
pub mod limb;
pub mod clip;
pub mod similarity;
pub mod quadratic;
pub mod full_body;
pub mod physics;
pub mod constraint;
pub mod object;
pub mod effector;
pub mod path;
pub mod track;
pub mod scene;
pub mod touch;
pub mod object_motion;
pub mod ties;
pub mod edit;
pub mod graph;
pub mod discrete;
pub mod resample;
pub mod meeting;
pub mod reach;
pub mod fingers;
pub mod embody;
pub mod plausible;
pub mod metrics;
pub mod residual;
pub mod relay;
pub mod export;
pub mod graph_cache;

/// The examples of the README compile.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
pub struct Readme;
