//! Edits paths and times so that constraints hold.
//!
//! ```text
//!   scene ─► expand: rows at instants ─► columns, springs: reduced, direct ─► spatial (shape, then scale)
//!                                                                                    temporal
//!         Editor: factor once, drag many ◄── facing: where bodies look ◄─────────────┘
//! ```

pub mod settings;
pub mod direction;
pub mod hold;
pub mod reference;
pub mod bodies;
pub mod parallel;
pub mod turned;
pub mod sampling;
pub mod columns;
pub mod bound_rows;
pub mod clash;
pub mod energy;
pub mod springs;
pub mod own_path;
pub mod reduced;
pub mod gauge;
pub mod pairs;
pub mod direct;
pub mod phase;
pub mod facing;
pub mod moved;
pub mod canvas;
pub mod spatial;
pub mod what_if;
pub mod time_row;
pub mod temporal;
pub mod error;
pub mod note;
pub mod expand;
pub mod retarget;
pub mod carrying;
pub mod following;
pub mod groups;
pub mod mixing;
pub mod editor;

pub use crate::constraint::Target;
pub use editor::{Edit, Editor, Exchange, Timing, Variant, WhatIf};
pub use error::EditError;
pub use moved::{EditedCharacter, Moved};
pub use note::EditNote;
pub use settings::Backend;
pub use what_if::GroupResponse;
