//! Lengths of edited paths: all that what-ifs ask of these.

use super::SpatialComponent;
use crate::edit::facing::Body;
use crate::edit::parallel::for_each_path;
use crate::edit::phase::PhaseSolver;
use crate::edit::settings::RunMode;
use crate::edit::turned::TurnedPath;
use crate::geometry::c64;
use crate::path::RestSegments;

impl SpatialComponent {
    /// Lengths of the paths as the scale phase was last solved. Cost: linear in frames.
    pub(super) fn find_lengths(&mut self) {
        let (scale, segments) = (&self.scale, &self.segments);
        let rigid = self.released.is_empty() && self.settings.runs == RunMode::Rigid;
        let rests = &self.rests;
        let measure = |path: usize, turned: &mut TurnedPath, body: &mut Body| {
            let runs = if rigid { rests[path].rigid.as_slice() } else { &[] };
            body.length = length((scale, path), turned, (&segments[path], runs));
        };
        for_each_path(rests, &mut self.turned, &mut self.bodies, measure);
    }
}

/// Length of a path, metres; that of a stretch in `runs` is what it is at rest.
fn length(
    (scale, path): (&PhaseSolver, usize),
    turned: &TurnedPath,
    (rest, runs): (&RestSegments, &[(usize, usize)]),
) -> f64 {
    let (mut sum, mut before) = (0.0, c64::default());
    let mut runs = runs.iter().copied().filter(|(first, last)| first < last);
    let mut run = runs.next();
    scale.visit(path, |frame, deviation| {
        let point = turned.points[frame] + deviation;
        match run {
            _ if frame == 0 => {}
            Some((first, last)) if first < frame => {
                sum += rest.lengths[frame - 1];
                if frame == last {
                    run = runs.next();
                }
            }
            _ => sum += (point - before).norm_sqr().sqrt(),
        }
        before = point;
    });
    sum
}
