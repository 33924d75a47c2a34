//! Discrete edits: frames come and go where bending would stretch a stride or a stand.
//!
//! A motion graph proposes, the deformation energy decides, one small change at a time. Source: Kim et al. 2009, §5.

pub mod settings;
pub mod remap;
pub mod candidates;
pub mod undo;
pub mod choose;
pub mod tracks;
pub mod weighing;
pub mod outcome;
pub mod editor;
pub mod drags;
