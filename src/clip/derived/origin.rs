//! What a derived clip was before it was edited.

use std::sync::Arc;

use crate::clip::Clip;
use crate::clip::derived::Blended;
use crate::clip::working::WorkingClip;

/// What a derived clip shows, frame by frame, as it was before it was bent and tilted.
#[derive(Clone, Debug, PartialEq)]
pub struct Origin {
    /// The same frames as the derived clip.
    pub clip: Arc<WorkingClip>,
    /// Where that is itself a blend: how it was made, and of which two clips.
    pub blend: Option<Arc<(Blended, [Clip; 2])>>,
}
