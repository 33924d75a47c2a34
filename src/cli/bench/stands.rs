//! What stands add to the systems of back ends that have no form of their own for them: hard rows.

use cotillion_solvers::workload::Workload;
use cotillion_solvers::{PointRow, c64};

use super::measure::Part;

/// Hard rows that keep the stands, and their targets.
pub(super) struct StandRows {
    pub(super) rows: Vec<PointRow<c64>>,
    stands: Vec<(usize, usize, usize)>,
}

impl StandRows {
    pub(super) fn new(workload: &Workload, part: Part) -> Self {
        let rows = match part {
            Part::Shape => workload.shape_stand_rows(),
            Part::Scale => workload.scale_stand_rows(),
            Part::Time => Vec::new(),
        };
        Self { rows, stands: workload.stands.clone() }
    }

    /// Calls `push` with the target of each row. `steps`: of each path in the scale phase; in the shape phase none.
    pub(super) fn visit_targets(&self, steps: &[Vec<c64>], push: impl FnMut(c64)) {
        if steps.is_empty() {
            self.rows.iter().map(|_| c64::default()).for_each(push);
        } else {
            let of_stands = self.stands.iter().flat_map(|&(path, first, last)| &steps[path][first..last]);
            of_stands.copied().for_each(push);
        }
    }
}
