//! To come.
#![allow(missing_docs)]
use crate::geometry::c64;
pub struct Picture<'a> {
    pub title: &'a str,
    pub actors: Vec<Actor<'a>>,
    pub objects: Vec<PictureObject<'a>>,
    pub handles: Vec<Handle>,
    pub ties: Vec<Tie>,
}
pub struct PictureObject<'a> {
    pub name: &'a str,
    pub size: [f64; 3],
    pub position: c64,
    pub facing: f64,
}
pub struct Actor<'a> {
    pub name: &'a str,
    pub rest: &'a [c64],
    pub edited: &'a [c64],
    pub headings: &'a [f64],
    pub times: &'a [f64],
    pub clips: Vec<(String, usize, usize)>,
    pub stationary: Vec<(usize, usize)>,
}
pub struct Handle {
    pub actor: usize,
    pub frame: f64,
    pub target: Option<c64>,
    pub facing: Option<f64>,
    pub hard: bool,
    pub name: String,
    pub partner: Option<(usize, f64)>,
}
pub struct Tie {
    pub points: Vec<(usize, f64)>,
    pub name: String,
    pub pinned: bool,
}
pub fn to_svg(_: &Picture) -> String {
    String::new()
}
pub fn to_png(_: &str, _: u32) -> Result<Vec<u8>, std::fmt::Error> {
    Err(std::fmt::Error)
}
