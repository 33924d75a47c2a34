//! Numbers under a motion editor: sparse least squares with hard equality rows, exact reductions of paths and tracks,
//! what-ifs, ranks, bounds, difference networks.
//!
//! # Which problem, which solver
//!
//! | problem | solver |
//! |---|---|
//! | `min ½‖M x − m‖²` s.t. `H x = h`, sparse, real or complex | [`analyse`], [`Analysis::factor`], [`Factor::solve_into`]: plan once per pattern, factor once per weights, solve for many targets. [`solve`] does all three |
//! | paths that keep their shape, with rows on their points | [`Compliance`]: paths as chains of springs, one unknown a row and two a path, whatever the number of points; [`Bent`] solves and expands. The main route |
//! | the same for any three-term rows | [`ChainSystem`]: chains condensed by reflections to the touched points; [`ChainTree`] for stretches and splices |
//! | how the energy changes if one path, or the steps of one track, were others | [`PathResponse`], [`StepResponse`]: exact, by small updates; [`SplicedPath`] for what the path would be |
//! | tracks of even steps with rows on their points | [`Network`]: condensed to the touched points, whatever the number of steps between; with bounds on steps, [`Network::solve_within`] |
//! | which rows of `H` repeat or contradict others | [`analyse_rank`], before factoring: dependent rows make the factorisation fail |
//! | `min ½xᵀGx − gᵀx` s.t. `A x = b`, `C x ≥ d`, dense, up to about a hundred unknowns | [`solve_bounded`] |
//! | is there any `x` with `x_to − x_from` in given intervals, and how far can each node move | [`node_bounds`] |
//!
//! Rows are assembled with [`RowMatrix`]. Soft rows carry the root of their weight. Complex problems ([`c64`]) are for rows
//! that are complex-linear: half the unknowns and a quarter of the entries of the stacked real system.
//!
//! Every solver either returns an answer whose residuals it has checked, or an error; none returns NaN. All are
//! deterministic: the same input gives the same bytes, whatever the number of threads.
//!
//! ```
//! use cotillion_solvers::{LeastSquares, RowMatrix, solve};
//!
//! // Three points as evenly spaced as possible, the first held at 0, the last drawn to 4.
//! let mut soft = RowMatrix::new(3);
//! soft.push_row(&[(0, -1.0), (1, 2.0), (2, -1.0)]);
//! soft.push_row(&[(2, 1.0)]);
//! let mut hard = RowMatrix::new(3);
//! hard.push_row(&[(0, 1.0)]);
//! let problem = LeastSquares { columns: 3, soft: soft.to_csr(), hard: hard.to_csr() };
//! let solution = solve(&problem, &[0.0, 4.0], &[0.0])?;
//! assert!((solution.x[1] - 2.0).abs() < 1e-12);
//! # Ok::<(), cotillion_solvers::KktError>(())
//! ```

pub use alike::Likeness;
pub use augmented::KktForm;
pub use bent::{Bent, Effort};
pub use bounds::{BoundMethod, solve_bounded};
pub use chain::{ChainPiece, ChainRow, compose, condense, shape_rows};
pub use chain_path::RowTargets;
pub use chain_system::{ChainSystem, ChainWorkspace};
pub use chain_tree::{ChainTree, SplicePart, splice};
pub use compliance::{Compliance, ComplianceAnalysis, ComplianceFactor};
pub use difference::{Difference, DifferenceError, NodeBounds, node_bounds};
pub use error::{BoundsError, KktError, Solution, SolveReport};
pub use free::{Combination, free_combinations};
pub use kkt::{Analysis, Factor, Workspace, analyse, solve};
pub use least_squares::LeastSquares;
pub use nalgebra::{DMatrix, DVector};
pub use network::{Knots, Network, NetworkEnergy, Piece, Track};
pub use network_bounds::StepRange;
pub use points::{PointRow, PointTerm};
pub use quadratic::{BoundedQp, BoundedSolution};
pub use rank::{Dependency, RankReport, analyse_rank};
pub use scalar::{Scalar, TwoPart};
pub use sparse::{RowMatrix, multiply};
pub use splice::{MomentTree, Part, SplicedPath};
pub use springs::{Drawing, Moments, SpringPath};
pub use sprs::CsMat;
pub use step_response::{Restepped, StepResponse};
pub use update::{Change, PathResponse};

mod alike;
mod augmented;
mod bent;
mod bounds;
mod chain;
mod chain_path;
mod chain_system;
mod chain_tree;
mod clamp;
mod compliance;
mod difference;
mod error;
mod exchange;
mod free;
mod kkt;
mod least_squares;
mod lu;
mod path_loads;
mod pieces;
mod network;
mod network_bounds;
mod points;
mod quadratic;
mod rank;
mod refine;
mod scalar;
mod sparse;
mod splice;
mod springs;
mod step_response;
mod stretch;
mod update;
pub mod workload;

/// Complex number of two `f64`.
#[allow(non_camel_case_types, reason = "written like f64, which it stands beside")]
pub type c64 = num_complex::Complex64;
