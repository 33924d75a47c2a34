//! x
use crate::clip::Clip;
/// x
pub fn clip_svg(_clip: &Clip) -> String {
    String::new()
}
