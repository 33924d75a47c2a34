//! In flight angular momentum stays what it is and the centre of mass goes along a parabola, to the last digits.

#[path = "flight/fixture.rs"]
mod fixture;
#[path = "flight/properties.rs"]
mod properties;
#[path = "flight/recursion.rs"]
mod recursion;
