//! The problem that everybody solves: the shape phase of a workload, all samples of all paths as unknowns.

use cotillion_solvers::workload::Workload;
use cotillion_solvers::{KktError, KktForm, LeastSquares, RowMatrix, analyse, c64};

/// `min ½‖M x − m‖²` subject to `H x = h`; unknowns are the samples, path after path.
///
/// Soft rows: for each interior sample `p_i − (1 − z) p_{i−1} − z p_{i+1} = 0`, with
/// `z = (p_i − p_{i−1}) / (p_{i+1} − p_{i−1})` at rest; then the soft rows of the workload. Hard rows: its hard rows.
pub fn shape_problem(workload: &Workload) -> LeastSquares<c64> {
    let columns = workload.samples();
    let starts = path_starts(workload);
    let (mut soft, mut hard) = (RowMatrix::new(columns), RowMatrix::new(columns));
    let one = c64::new(1.0, 0.0);
    for (path, start) in workload.paths.iter().zip(&starts) {
        for i in 1..path.len() - 1 {
            let z = (path[i] - path[i - 1]) / (path[i + 1] - path[i - 1]);
            let at = start + i;
            soft.push_row(&[(at - 1, z - one), (at, one), (at + 1, -z)]);
        }
    }
    for row in &workload.rows {
        let root = row.weight.map_or(1.0, f64::sqrt);
        let terms: Vec<_> = row.terms.iter().map(|(path, i, a)| (starts[*path] + i, a * root)).collect();
        if row.weight.is_some() { &mut soft } else { &mut hard }.push_row(&terms);
    }
    LeastSquares { columns, soft: soft.to_csr(), hard: hard.to_csr() }
}

/// `m` and `h` of [`shape_problem`] for the given targets, one for each of the workload's rows.
pub fn split_targets(workload: &Workload, targets: &[c64]) -> (Vec<c64>, Vec<c64>) {
    let shape_rows = workload.paths.iter().map(|path| path.len() - 2).sum();
    let (mut m, mut h) = (vec![c64::default(); shape_rows], Vec::new());
    for (row, target) in workload.rows.iter().zip(targets) {
        match row.weight {
            Some(weight) => m.push(target * weight.sqrt()),
            None => h.push(*target),
        }
    }
    (m, h)
}

/// Solutions that all others are compared with: the Hachtel form, refined until corrections stop shrinking.
///
/// # Errors
/// Those of the solver.
pub fn reference(workload: &Workload, all_targets: &[Vec<c64>]) -> Result<Vec<Vec<c64>>, KktError> {
    let problem = shape_problem(workload);
    let factor = analyse(&problem, KktForm::Hachtel)?.factor(&problem)?;
    let solve = |targets: &Vec<c64>| {
        let (m, h) = split_targets(workload, targets);
        Ok(factor.solve(&m, &h)?.x)
    };
    all_targets.iter().map(solve).collect()
}

fn path_starts(workload: &Workload) -> Vec<usize> {
    let mut next = 0;
    let step = |path: &Vec<c64>| {
        let start = next;
        next += path.len();
        start
    };
    workload.paths.iter().map(step).collect()
}
