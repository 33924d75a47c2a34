//! What a group of characters would cost if one of their paths were another.

use cotillion_solvers::PathResponse;

use super::SpatialComponent;
use crate::edit::bodies::leave_to_the_body;
use crate::edit::hold::Prepared;
use crate::edit::settings::FacingMode;
use crate::edit::what_if::{ChangedPath, shape_energy_if};
use crate::path::RestPath;

impl SpatialComponent {
    /// How the shape of path `path` answers to changes of itself; `None` where that cannot be said beforehand: stretches had
    /// to be released, motions are free, or all frames had to be solved.
    pub fn response(&self, path: usize) -> Option<PathResponse> {
        self.released.is_empty().then(|| self.shape.response(path)).flatten()
    }

    /// Shape energy with that of soft constraints if path `path` were that of `rests`, with the rows `held` on them; `None`
    /// where more would change than that. `response`: of this path and the present factorisation.
    pub fn shape_energy_if(
        &self,
        response: &PathResponse,
        path: usize,
        rests: &[&RestPath],
        mut held: Vec<Prepared>,
    ) -> Option<f64> {
        if self.settings.facing == FacingMode::TangentBlend {
            leave_to_the_body(&mut held, rests);
        }
        let alike = |(a, b): (&Prepared, &Prepared)| {
            let same = (a.row.constraint, a.body_only, a.partner_row)
                == (b.row.constraint, b.body_only, b.partner_row);
            same && a.ignores_rotations() && b.ignores_rotations()
        };
        if held.len() != self.held.len() || !held.iter().zip(&self.held).all(alike) {
            return None;
        }
        let changed = ChangedPath { path, rests, held: &held, translations: &self.translations };
        shape_energy_if(&self.shape, response, &changed, &self.settings)
    }
}
