//! Edits paths and times so that constraints hold.
//!
//! ```text
//!   scene ─► expand: rows at instants ─► columns, assemble, gauge: sparse systems ─► spatial (shape, then scale)
//!                                                                                    temporal
//!         Editor: factor once, drag many ◄── facing: where bodies look ◄─────────────┘
//! ```

pub mod assemble;
pub mod columns;
pub mod editor;
pub mod energy;
pub mod error;
pub mod expand;
pub mod facing;
pub mod gauge;
pub mod hold;
pub mod settings;
pub mod spatial;
pub mod temporal;

pub use editor::{Edit, EditNote, EditedCharacter, Editor, Target};
pub use error::EditError;
