//! The ground pass does what mathematics says, and leaves alone what it must.

#[path = "ground/circle.rs"]
mod circle;
#[path = "ground/closed_form.rs"]
mod closed_form;
#[path = "ground/derived.rs"]
mod derived;
#[path = "ground/figure.rs"]
mod figure;
#[path = "ground/invariants.rs"]
mod invariants;
#[path = "ground/parts.rs"]
mod parts;
