//! What-ifs in time: the solution if one stretch of one track had another number of steps, without solving again.
//!
//! A piece is a spring of compliance c with the length N at rest; to all the rest, which would leave it the length G, it is one
//! force on its two knots. Of a stretch put into the piece, the share s stays there. With D = G − N, primed after the change,
//!
//! ```text
//!     E′ = E − ½ rD²/c + ½ rD′²/(c′r + cs),        r = 1 − s,
//!     x′ = x + β·(answer of all knots to a stretch √c of the piece),    β√c = D − D′c/(c′r + cs).
//! ```
//!
//! Source: springs in series; the small update of Sherman and Morrison, Hager, *Updating the inverse of a matrix*, SIAM Review
//! 31 (1989), for one spring.

use crate::error::KktError;
use crate::kkt::{Factor, Workspace};
use crate::network::Network;

/// Below this, all the rest gives way to the piece.
const LOOSE: f64 = 1e-12;

/// How a network answers to a change of the number of steps of one piece.
#[derive(Clone, Debug, PartialEq)]
pub struct StepResponse {
    piece: usize,
    /// Share of a stretch put into the piece that stays there; 1 where the rest gives way altogether.
    share: f64,
    /// What all knots do as the piece is stretched by the root of its compliance.
    answer: Vec<f64>,
}

/// The solution with another number of steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Restepped {
    /// Energy of springs and soft rows.
    pub energy: f64,
    /// All times move by as many [answers](StepResponse::answer).
    pub moved: f64,
}

impl StepResponse {
    /// Response of `network.pieces[piece]`. Cost: one solve.
    ///
    /// # Errors
    /// Those of a solve.
    pub fn new(
        network: &Network,
        factor: &Factor<f64>,
        piece: usize,
        workspace: &mut Workspace<f64>,
    ) -> Result<Self, KktError> {
        let (mut m, h) = network.targets();
        m[piece] = 1.0;
        let mut answer = vec![0.0; network.problem.columns];
        factor.solve_into(&m, &h, &mut answer, workspace)?;
        let own = &network.pieces[piece];
        let compliance = own.steps as f64 / own.weight;
        let share = (answer[own.from + 1] - answer[own.from]) / compliance.sqrt();
        Ok(Self { piece, share: share.clamp(0.0, 1.0), answer })
    }

    /// By how much each knot moves as the piece is stretched by the root of its compliance.
    pub fn answer(&self) -> &[f64] {
        &self.answer
    }

    /// The solution if the piece had `steps` steps, at least 1, in place of its own; all times that rows hold stay. `x`: delays
    /// of the present solution, `energy`: its energy. Exact while no bound on steps is reached. Cost: constant.
    pub fn restepped(&self, network: &Network, (x, energy): (&[f64], f64), steps: usize) -> Restepped {
        let piece = &network.pieces[self.piece];
        let rest = 1.0 - self.share;
        let (present, changed) = (piece.steps as f64 / piece.weight, steps as f64 / piece.weight);
        let longer = (steps as f64 - piece.steps as f64) * network.step;
        if rest < LOOSE {
            // The piece has the length it likes.
            return Restepped { energy, moved: longer / present.sqrt() };
        }
        let stretch = (x[piece.from + 1] - x[piece.from]) / rest;
        let wanted = stretch - longer;
        let give = changed * rest + present * self.share;
        let worth = 0.5 * rest * (wanted * wanted / give - stretch * stretch / present);
        Restepped { energy: energy + worth, moved: (stretch - wanted * present / give) / present.sqrt() }
    }
}
