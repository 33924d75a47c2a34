//! How commands are told what BVH files shall look like.

use clap::{Args, ValueEnum};
use cotillion::export::bvh::{BvhOptions, JointNames};
use cotillion::skeleton::Axis;

use super::capture::{metres_of_unit, wrong_option};
use super::output::PlainError;

/// Rates that are written, frames per second: beyond them our own reader takes the file for a broken one, or memory ends.
const RATES: std::ops::RangeInclusive<f64> = 0.1..=10_000.0;

/// Units that are written, metres: with ten decimals a file is read back to 1e-7 m.
const UNITS: std::ops::RangeInclusive<f64> = 1e-6..=1e3;

/// What BVH files look like that a command writes.
#[derive(Clone, Debug, Args)]
pub(super) struct BvhArgs {
    /// Rate of BVH files, frames per second; left out: as it is.
    #[arg(long, value_name = "FPS", help_heading = "BVH files")]
    bvh_rate: Option<f64>,
    /// Unit of BVH files: m, cm, inch, or metres per file unit.
    #[arg(long, value_name = "UNIT", default_value = "m", help_heading = "BVH files")]
    bvh_unit: String,
    /// Rotation order of all joints; left out: of each as it is.
    #[arg(long, value_enum, value_name = "ORDER", ignore_case = true, help_heading = "BVH files")]
    bvh_order: Option<OrderChoice>,
    /// Names of joints: as they are, of the CMU database's BVH files, of Mixamo's characters.
    #[arg(long, value_enum, value_name = "NAMES", default_value_t, help_heading = "BVH files")]
    bvh_names: NamesChoice,
}

/// See [`BvhOptions::rotation_order`].
#[derive(Clone, Copy, Debug, ValueEnum)]
enum OrderChoice {
    Xyz,
    Xzy,
    Yxz,
    Yzx,
    Zxy,
    Zyx,
}

/// See [`JointNames`].
#[derive(Clone, Copy, Debug, Default, ValueEnum)]
enum NamesChoice {
    #[default]
    AsRead,
    Cmu,
    Mixamo,
}

impl From<OrderChoice> for [Axis; 3] {
    fn from(choice: OrderChoice) -> Self {
        use Axis::{X, Y, Z};
        match choice {
            OrderChoice::Xyz => [X, Y, Z],
            OrderChoice::Xzy => [X, Z, Y],
            OrderChoice::Yxz => [Y, X, Z],
            OrderChoice::Yzx => [Y, Z, X],
            OrderChoice::Zxy => [Z, X, Y],
            OrderChoice::Zyx => [Z, Y, X],
        }
    }
}

impl From<NamesChoice> for JointNames {
    fn from(choice: NamesChoice) -> Self {
        match choice {
            NamesChoice::AsRead => Self::AsRead,
            NamesChoice::Cmu => Self::Cmu,
            NamesChoice::Mixamo => Self::Mixamo,
        }
    }
}

impl BvhArgs {
    /// The options meant, or what is wrong with them.
    pub(super) fn options(&self) -> Result<BvhOptions, PlainError> {
        if let Some(fps) = self.bvh_rate.filter(|fps| !RATES.contains(fps)) {
            let expected = format!("a rate from {} to {} frames per second", RATES.start(), RATES.end());
            return Err(wrong_option("--bvh-rate", &fps.to_string(), &expected));
        }
        let unit_to_m = metres_of_unit("--bvh-unit", &self.bvh_unit)?;
        if !UNITS.contains(&unit_to_m) {
            let expected = format!("a unit from {} to {} m", UNITS.start(), UNITS.end());
            return Err(wrong_option("--bvh-unit", &self.bvh_unit, &expected));
        }
        Ok(BvhOptions {
            fps: self.bvh_rate,
            unit_to_m,
            rotation_order: self.bvh_order.map(Into::into),
            names: self.bvh_names.into(),
        })
    }
}
