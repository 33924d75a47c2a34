//! What solves report: residuals, or why there is no answer.

/// What a solution is worth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SolveReport {
    /// `½‖M x − m‖²`.
    pub energy: f64,
    /// Largest `|h − H x|` of a hard row, in the row's own unit.
    pub hard_residual: f64,
    /// Largest residual of the augmented system with scaled rows, relative to the largest scaled target or multiplier.
    pub relative_residual: f64,
    /// Size of the last correction relative to the largest unknown: about the error of `x`.
    pub last_correction: f64,
    /// Corrections made after the first solve.
    pub refinements: usize,
}

/// Minimiser, multipliers and report of one solve.
#[derive(Clone, Debug, PartialEq)]
pub struct Solution<T> {
    /// The minimiser.
    pub x: Vec<T>,
    /// `λ`, one per hard row: `Mᴴ(m − M x) = Hᴴλ`.
    pub multipliers: Vec<T>,
    /// Residuals.
    pub report: SolveReport,
}

/// Why there is no solution of `min ½‖M x − m‖²` subject to `H x = h`.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum KktError {
    /// A matrix or vector does not fit the others.
    #[error("{block} has {actual} {side}, expected {expected}")]
    ShapeMismatch {
        /// Letter of the block at fault: M, H, m, h or x.
        block: &'static str,
        /// What was counted: rows or columns.
        side: &'static str,
        /// How many there should be.
        expected: usize,
        /// How many there are.
        actual: usize,
    },
    /// A matrix is compressed by columns.
    #[error("{block} is compressed by columns, expected rows")]
    NotByRows {
        /// Letter of the block at fault: M or H.
        block: &'static str,
    },
    /// A coefficient or target is infinite or not a number.
    #[error("row {row} of {block} is not finite")]
    NotFinite {
        /// Letter of the block at fault: M, H, m or h.
        block: &'static str,
        /// Its row.
        row: usize,
    },
    /// The problem to factor has entries elsewhere than the one that was analysed.
    #[error("{block} has another pattern than when it was analysed")]
    PatternChanged {
        /// Letter of the block at fault: M or H.
        block: &'static str,
    },
    /// Some unknown is free, or hard rows depend on each other, to working precision.
    #[error("the system is singular: some unknown is free, or hard rows depend on each other")]
    Singular,
    /// The solution has infinite or undefined entries.
    #[error("the solution is not finite")]
    SolutionNotFinite,
    /// The solution misses the equations.
    #[error("the solution misses its equations by {relative:e} of the targets, allowed {allowed:e}")]
    Residual {
        /// Residual relative to the targets.
        relative: f64,
        /// Largest one that passes.
        allowed: f64,
    },
}

/// Why there is no minimiser.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum BoundsError {
    /// A block does not fit the others.
    #[error("{block} is {actual_rows} x {actual_columns}, expected {rows} x {columns}")]
    ShapeMismatch {
        /// Letter of the block.
        block: &'static str,
        /// Rows it should have.
        rows: usize,
        /// Columns it should have.
        columns: usize,
        /// Rows it has.
        actual_rows: usize,
        /// Columns it has.
        actual_columns: usize,
    },
    /// A number is infinite or undefined.
    #[error("row {row} of {block} is not finite")]
    NotFinite {
        /// Letter of the block.
        block: &'static str,
        /// Its row.
        row: usize,
    },
    /// `G` leaves some direction free that `A` does not hold, or rows of `A` depend on each other.
    #[error("the system is singular: some unknown is free, or equality rows depend on each other")]
    Singular,
    /// Rows contradict each other.
    #[error(
        "inequality {row} misses its bound by {violation} where inequalities {certificate:?} and equalities {equalities:?} hold"
    )]
    Infeasible {
        /// Row of `C` that cannot be met.
        row: usize,
        /// Other rows of `C` in its way.
        certificate: Vec<usize>,
        /// Rows of `A` in its way.
        equalities: Vec<usize>,
        /// What it misses while the others hold.
        violation: f64,
    },
    /// A sparse solve in between found no answer.
    #[error(transparent)]
    Solve(#[from] KktError),
    /// Rounding made the method go on without end.
    #[error("no minimiser after {limit} steps")]
    TooManyIterations {
        /// Steps allowed.
        limit: usize,
    },
}
