//! What `cotillion touch-up` is told.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use cotillion::export::touch_up_report::SettingsPart;
use cotillion::physics::body_model::{BodySettings, MassTable, REFERENCE_MASS};
use cotillion::physics::flight::FlightSettings;
use cotillion::physics::ground::schedule::{Step, five_five_two, level, uphill};
use cotillion::physics::ground::target::Target;
use cotillion::physics::ground::{GroundSettings, MARGIN};
use cotillion::physics::touch_up::TouchUpSettings;

use crate::cli::Manner;
use crate::cli::bvh_args::BvhArgs;
use crate::cli::capture::{ReadArgs, plain, wrong_option};
use crate::cli::output::PlainError;

/// See [`crate::cli::Command::TouchUp`].
#[derive(Debug, Args)]
pub(crate) struct TouchUpArgs {
    /// Clip file (.bvh, .amc, DeepMimic .json or .txt), or `builtin:NAME,PARAMETER=VALUE,…`.
    pub(super) clip: PathBuf,
    /// Folder for the result; made if need be.
    #[arg(long, short, value_name = "DIR")]
    pub(super) output: PathBuf,
    #[command(flatten)]
    pub(super) read: ReadArgs,
    #[command(flatten)]
    pub(super) edit: EditArgs,
    #[command(flatten)]
    pub(super) body: BodyArgs,
    #[command(flatten)]
    pub(super) work: WorkArgs,
    /// Also draw distances of the zero moment point, angular momentum and height of the centre of mass over time, before and after.
    #[arg(long, help_heading = "Pictures")]
    pub(super) plots: bool,
    /// Also draw poses side by side, before and after.
    #[arg(long, help_heading = "Pictures")]
    pub(super) strip: bool,
    #[command(flatten)]
    pub(super) bvh: BvhArgs,
    #[command(flatten)]
    pub(super) manner: Manner,
}

/// What is done to the clip first.
#[derive(Debug, Args)]
pub(super) struct EditArgs {
    /// Bend the clip's way onto an arc of this radius first, metres; to the left.
    #[arg(long, value_name = "METRES", allow_negative_numbers = true, help_heading = "Edits before")]
    pub(super) bend: Option<f64>,
    /// Bend to the right.
    #[arg(long, requires = "bend", help_heading = "Edits before")]
    right: bool,
    /// Tilt the clip as a whole first, degrees; uphill.
    #[arg(long, value_name = "DEGREES", allow_negative_numbers = true, help_heading = "Edits before")]
    pub(super) tilt: Option<f64>,
    /// Go over into this clip of the same body first, over one cycle of both gaits.
    #[arg(long, value_name = "CLIP", help_heading = "Edits before")]
    pub(super) blend: Option<PathBuf>,
}

/// What the body weighs.
#[derive(Debug, Args)]
pub(super) struct BodyArgs {
    /// Shares of its segments.
    #[arg(long, value_enum, default_value_t, value_name = "TABLE", help_heading = "Body")]
    pub(super) table: TableChoice,
    /// Mass of the body, kg; motions do not depend on it.
    #[arg(long, value_name = "KG", default_value_t = REFERENCE_MASS, allow_negative_numbers = true, help_heading = "Body")]
    mass: f64,
    /// Estimate the masses of segments from the clip itself, as it was before all edits: by its flights, else where it stands.
    #[arg(long, help_heading = "Body")]
    pub(super) masses: bool,
}

/// How the touch-up works.
#[derive(Debug, Args)]
pub(super) struct WorkArgs {
    /// Where zero moment points are to be: in the polygon of support, or where the source had them.
    #[arg(long, value_enum, default_value_t, value_name = "TARGET", help_heading = "Touch-up")]
    pub(super) target: TargetChoice,
    /// The clip before it was edited, frame by frame (`--bend`, `--tilt` and `--blend` know it).
    #[arg(long, value_name = "CLIP", conflicts_with_all = ["bend", "tilt", "blend"], help_heading = "Touch-up")]
    pub(super) source: Option<PathBuf>,
    /// Polygons are made smaller by this share of the stature [default: 0.0125].
    #[arg(long, value_name = "SHARE", allow_negative_numbers = true, help_heading = "Touch-up")]
    margin: Option<f64>,
    /// The schedule is gone through this often at most [default: 3; of `published`: 1].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(0..=1000), help_heading = "Touch-up")]
    rounds: Option<u16>,
    /// A mean distance that is good enough, metres.
    #[arg(
        long,
        value_name = "METRES",
        default_value_t = 0.0,
        allow_negative_numbers = true,
        help_heading = "Touch-up"
    )]
    tolerance: f64,
    /// What turns in which order.
    #[arg(long, value_enum, default_value_t, value_name = "SCHEDULE", help_heading = "Touch-up")]
    schedule: ScheduleChoice,
    /// Turn about both axes so that the point comes exactly to its place.
    #[arg(long, help_heading = "Touch-up")]
    two_axis: bool,
    /// Leave flights as they come from the ground.
    #[arg(long, help_heading = "Touch-up")]
    no_flight: bool,
}

/// See [`MassTable`].
#[derive(Clone, Copy, Debug, Default, ValueEnum)]
pub(super) enum TableChoice {
    /// Dempster's shares by Winter.
    #[default]
    Winter75,
    /// Xiao et al. as printed.
    Xiao2005,
}

/// See [`Target`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(super) enum TargetChoice {
    /// The polygon of support, made smaller by the margin.
    #[default]
    Hull,
    /// Where the source had it, seen from what bears.
    Carried,
}

/// See [`cotillion::physics::ground::schedule`].
#[derive(Clone, Copy, Debug, Default, ValueEnum)]
enum ScheduleChoice {
    /// Lower body, upper body, arms.
    #[default]
    Level,
    /// Upper body, lower body, arms.
    Uphill,
    /// Five of the lower body, five of the upper, two of the arms.
    Published,
}

impl TableChoice {
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Winter75 => "winter75",
            Self::Xiao2005 => "xiao2005",
        }
    }
}

impl EditArgs {
    /// Radius of the bend, to the left where positive.
    pub(super) fn radius(&self) -> Option<f64> {
        self.bend.map(|radius| if self.right { -radius } else { radius })
    }

    /// Radii that people turn on, metres, and slopes that they walk on, degrees.
    fn faults(&self) -> Vec<PlainError> {
        let bend = self.bend.filter(|radius| !(0.1..=1e5).contains(radius)).map(|radius| {
            wrong_option(
                "--bend",
                &radius.to_string(),
                "a radius from 0.1 to 100000 metres (--right bends to the right)",
            )
        });
        let tilt = self
            .tilt
            .filter(|degrees| !(-60.0..=60.0).contains(degrees))
            .map(|degrees| wrong_option("--tilt", &degrees.to_string(), "an angle from -60 to 60 degrees"));
        bend.into_iter().chain(tilt).collect()
    }

    /// Whether anything is done.
    pub(super) fn is_any(&self) -> bool {
        self.bend.is_some() || self.tilt.is_some() || self.blend.is_some()
    }
}

impl TouchUpArgs {
    /// What is wrong with the values of options, all of it.
    pub(super) fn faults(&self) -> Vec<PlainError> {
        let mut faults = self.edit.faults();
        faults.extend(self.body.fault());
        faults.extend(self.work.faults(self.edit.is_any()));
        faults.extend(self.read.options().err());
        faults.extend(self.bvh.options().err());
        faults
    }
}

impl BodyArgs {
    pub(super) fn settings(&self) -> BodySettings {
        let table = match self.table {
            TableChoice::Winter75 => MassTable::Winter75,
            TableChoice::Xiao2005 => MassTable::Xiao2005,
        };
        BodySettings { table, mass: self.mass }
    }

    fn fault(&self) -> Option<PlainError> {
        let is_mass = (1e-3..=1e6).contains(&self.mass);
        (!is_mass).then(|| wrong_option("--mass", &self.mass.to_string(), "a mass from 0.001 to 1000000 kg"))
    }
}

impl WorkArgs {
    fn faults(&self, knows_source: bool) -> Vec<PlainError> {
        let mut faults = Vec::new();
        if let Some(margin) = self.margin.filter(|margin| !(0.0..=0.1).contains(margin)) {
            let expected = "a share of the stature from 0 to 0.1";
            faults.push(wrong_option("--margin", &margin.to_string(), expected));
        }
        if !(0.0..=10.0).contains(&self.tolerance) {
            faults.push(wrong_option(
                "--tolerance",
                &self.tolerance.to_string(),
                "a distance from 0 to 10 metres",
            ));
        }
        let is_carried = self.target == TargetChoice::Carried;
        if is_carried && self.margin.is_some() {
            let message = "carried places have no margin".to_owned();
            let help = Some("leave it out, or choose --target hull".to_owned());
            faults.push(plain("--margin", message, help));
        }
        if is_carried && self.source.is_none() && !knows_source {
            let message = "the motion that was edited is not known, so nothing can be carried over from it";
            let help = "name it with --source CLIP, or edit here with --bend, --tilt or --blend";
            faults.push(plain("--target carried", message.to_owned(), Some(help.to_owned())));
        }
        faults
    }

    fn schedule(&self) -> (Vec<Step>, &'static str, u16) {
        match self.schedule {
            ScheduleChoice::Level => (level(), "level", 3),
            ScheduleChoice::Uphill => (uphill(), "uphill", 3),
            ScheduleChoice::Published => (five_five_two(), "published", 1),
        }
    }

    fn margin(&self) -> f64 {
        self.margin.unwrap_or(MARGIN)
    }

    pub(super) fn settings(&self) -> TouchUpSettings {
        let (schedule, _, rounds) = self.schedule();
        let target = match self.target {
            TargetChoice::Hull => Target::Hull { margin: self.margin() },
            TargetChoice::Carried => Target::Carried,
        };
        let ground = GroundSettings {
            schedule,
            rounds: usize::from(self.rounds.unwrap_or(rounds)),
            tolerance: self.tolerance,
            target,
            two_axis: self.two_axis,
            ..GroundSettings::default()
        };
        TouchUpSettings { ground, flight: (!self.no_flight).then(FlightSettings::default) }
    }

    /// The same for reports.
    pub(super) fn report(&self) -> SettingsPart {
        let (_, schedule, rounds) = self.schedule();
        let is_hull = self.target == TargetChoice::Hull;
        SettingsPart {
            target: if is_hull { "hull" } else { "carried" },
            margin: is_hull.then(|| self.margin()),
            schedule,
            rounds: usize::from(self.rounds.unwrap_or(rounds)),
            tolerance: self.tolerance,
            two_axis: self.two_axis,
            flight: !self.no_flight,
        }
    }
}
