//! Edits paths and times so that constraints hold.
