//! Edits paths and times so that constraints hold.
//!
//! ```text
//!   scene ─► expand: rows at instants ─► columns, assemble, gauge: sparse systems ─► spatial (shape, then scale)
//!                                                                                    temporal
//!         Editor: factor once, drag many ◄── facing: where bodies look ◄─────────────┘
//! ```

pub mod settings;
pub mod hold;
pub mod reference;
pub mod bodies;
pub mod columns;
pub mod clash;
pub mod gauge;
pub mod assemble;
pub mod phase;
pub mod spatial;
pub mod facing;
pub mod time_row;
pub mod temporal;
pub mod energy;
pub mod error;
pub mod note;
pub mod expand;
pub mod groups;
pub mod editor;

pub use editor::{Edit, EditedCharacter, Editor, Target};
pub use error::EditError;
pub use note::EditNote;
