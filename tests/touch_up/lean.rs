//! How far bodies lean.

use crate::performer::Edited;
use cotillion::clip::Clip;

impl Edited {
    pub(crate) fn lean(&self, _after: &Clip, _before: &Clip) -> Option<f64> { None }
}
