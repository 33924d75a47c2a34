//! Masses, derivatives, zero moment points and polygons are what mathematics says they are.

#[path = "physics/balance.rs"]
mod balance;
#[path = "physics/body.rs"]
mod body;
#[path = "physics/derivatives.rs"]
mod derivatives;
#[path = "physics/fitted.rs"]
mod fitted;
#[path = "physics/fixture.rs"]
mod fixture;
#[path = "physics/support.rs"]
mod support;
