//! One case, measured in this process: a workload, a back end, a number of threads.

use cotillion_solvers::workload::Workload;
use cotillion_solvers::{KktError, c64};
use serde::{Deserialize, Serialize};

use super::chain::{Chain, Network};
use super::compliance::Springs;
use super::direct::{Direct, DirectTime};
use super::measure::{
    Edited, Lap, Part, Phase, Rig, Solver, Steps, Watch, cold, drag, least_ms, median_lap, passes, repeated,
};
use super::names::{Backend, Mode, System, WorkloadName};

/// What is measured in a process of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Case {
    pub(super) workload: WorkloadName,
    pub(super) backend: Backend,
    pub(super) threads: usize,
}

/// One measurement.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Row {
    pub(super) workload: WorkloadName,
    pub(super) characters: usize,
    pub(super) frames: usize,
    pub(super) backend: Backend,
    pub(super) system: System,
    pub(super) mode: Mode,
    pub(super) threads: usize,
    /// Median of the repetitions, milliseconds; none if nothing was measured.
    pub(super) ms: Option<f64>,
    /// Milliseconds of the fastest repetition: what a shared machine disturbed least.
    pub(super) least_ms: Option<f64>,
    /// Phases of the median repetition.
    pub(super) phases_ms: Option<PhaseTimes>,
    pub(super) repetitions: usize,
    /// Largest distance of a point to the reference, metres; for times, seconds; for all, the larger number. None
    /// without a reference.
    pub(super) max_error: Option<f64>,
    /// Most memory the process of this case ever held, megabytes (10⁶ bytes); none where the system does not tell.
    pub(super) peak_mb: Option<f64>,
    /// Why nothing was measured.
    pub(super) note: Option<String>,
}

/// Milliseconds of each phase; a drag has the last two.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct PhaseTimes {
    pub(super) assemble: Option<f64>,
    pub(super) analyse: Option<f64>,
    pub(super) factor: Option<f64>,
    pub(super) solve: Option<f64>,
    pub(super) expand: Option<f64>,
}

/// Systems and modes of every case, in the order of its rows.
pub(super) const KINDS: [(System, Mode); 8] = [
    (System::Shape, Mode::Cold),
    (System::Shape, Mode::Drag),
    (System::Scale, Mode::Cold),
    (System::Scale, Mode::Drag),
    (System::Time, Mode::Cold),
    (System::Time, Mode::Drag),
    (System::All, Mode::Cold),
    (System::All, Mode::Drag),
];

/// Most frames of a workload for which the reference is computed.
const MOST_FRAMES_OF_REFERENCE: usize = 500_000;

/// Why a case has no rows.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub(super) enum CaseError {
    /// The back end found no solution.
    #[error("{0}")]
    Backend(#[from] KktError),
    /// There is no reference to compare with.
    #[error("the reference cannot be computed: {0}")]
    Reference(KktError),
}

/// Measures all systems of a case. Memory is read before the reference is computed.
pub(super) fn measure(case: Case, repetitions: Option<usize>) -> Result<Vec<Row>, CaseError> {
    let workload = case.workload.build();
    let measured = match case.backend {
        Backend::DirectReal => timed::<Direct<f64>, DirectTime>(&workload, repetitions)?,
        Backend::DirectComplex => timed::<Direct<c64>, DirectTime>(&workload, repetitions)?,
        Backend::Chain => timed::<Chain, Network>(&workload, repetitions)?,
        Backend::Compliance => timed::<Springs, Network>(&workload, repetitions)?,
    };
    let peak_mb = peak_mb();
    let reference = match workload.samples() <= MOST_FRAMES_OF_REFERENCE {
        true => Some(reference(&workload).map_err(CaseError::Reference)?),
        false => None,
    };
    let row = |(system, mode): (System, Mode)| {
        let (laps, edited, own) = match mode {
            Mode::Cold => (&measured.cold, &measured.cold_edit, 0),
            Mode::Drag => (&measured.drag, &measured.drag_edit, 1),
        };
        let watch = median_lap(laps, system);
        let phase = |phase: Phase| passes(mode, phase).then(|| watch.0[phase as usize]);
        Row {
            ms: Some(watch.total()),
            least_ms: least_ms(laps, system),
            phases_ms: Some(PhaseTimes {
                assemble: phase(Phase::Assemble),
                analyse: phase(Phase::Analyse),
                factor: phase(Phase::Factor),
                solve: phase(Phase::Solve),
                expand: phase(Phase::Expand),
            }),
            repetitions: laps.len(),
            max_error: reference.as_ref().map(|reference| edited.distance(&reference[own], system)),
            peak_mb,
            ..unmeasured(case, (system, mode), (workload.paths.len(), workload.samples()))
        }
    };
    Ok(KINDS.into_iter().map(row).collect())
}

/// A row without numbers. `sizes`: characters and frames.
pub(super) fn unmeasured(
    Case { workload, backend, threads }: Case,
    (system, mode): (System, Mode),
    (characters, frames): (usize, usize),
) -> Row {
    Row {
        workload,
        characters,
        frames,
        backend,
        system,
        mode,
        threads,
        ms: None,
        least_ms: None,
        phases_ms: None,
        repetitions: 0,
        max_error: None,
        peak_mb: None,
        note: None,
    }
}

/// Times of both modes, and an edit of each.
struct Measured {
    cold: Vec<Lap>,
    drag: Vec<Lap>,
    cold_edit: Edited,
    /// The edit of the first drag step.
    drag_edit: Edited,
}

fn timed<S: Solver<Point = c64>, T: Solver<Point = f64>>(
    workload: &Workload,
    repetitions: Option<usize>,
) -> Result<Measured, KktError> {
    let mut cold_edit = Edited::room(workload);
    let mut rig = None;
    let cold = repeated(repetitions, |_| {
        // The last rig goes first: two at a time would be counted as memory.
        rig = None;
        let (own, laps) = cold::<S, T>(workload, &mut cold_edit)?;
        rig = Some(own);
        Ok(laps)
    })?;
    let mut rig = rig.expect("at least one repetition");
    let mut drag_edit = Edited::room(workload);
    let drag_laps = repeated(repetitions, |step| dragged(&mut rig, workload, step, &mut drag_edit))?;
    dragged(&mut rig, workload, 0, &mut drag_edit)?;
    Ok(Measured { cold, drag: drag_laps, cold_edit, drag_edit })
}

fn dragged<S: Solver<Point = c64>, T: Solver<Point = f64>>(
    rig: &mut Rig<S, T>,
    workload: &Workload,
    step: usize,
    edited: &mut Edited,
) -> Result<Lap, KktError> {
    let (targets, times) = workload.dragged(step);
    drag(rig, workload, (&targets, &times), edited)
}

/// The edit, and that of the first drag step, by the direct complex systems with residuals in twice the digits.
pub(super) fn reference(workload: &Workload) -> Result<[Edited; 2], KktError> {
    let watch = &mut Watch::default();
    let mut shape = Direct::<c64>::prepare(workload, Part::Shape, watch)?;
    let mut scale = Direct::<c64>::prepare(workload, Part::Scale, watch)?;
    let mut time = DirectTime::prepare(workload, Part::Time, watch)?;
    let mut refined = |(targets, times): (Vec<c64>, Vec<f64>)| {
        let mut edited = Edited::room(workload);
        shape.refined_into(None, &targets, &mut edited.shape)?;
        let steps = Steps { workload, shape: &edited.shape };
        scale.refined_into(Some(steps), &targets, &mut edited.scale)?;
        time.refined_into(&times, &mut edited.times)?;
        Ok(edited)
    };
    let at_first = refined((workload.targets.clone(), workload.time_targets.clone()))?;
    Ok([at_first, refined(workload.dragged(0))?])
}

/// Most memory this process ever held, from `/proc/self/status`.
fn peak_mb() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kibibytes: f64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kibibytes * 1024.0 / 1e6)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One unit in the last place of all rest positions moves the answer by 1e-12 (10 characters) and 2e-10 (78): sines
    /// and divisions rounded otherwise can be seen, a wrong reference cannot hide.
    const INPUT_ROUNDING: f64 = 1e-11;

    /// Samples of paths, given by both their numbers.
    type Expected = [((usize, usize), c64); 2];

    fn assert_shape(name: WorkloadName, expected: Expected) {
        let workload = name.build();
        let mut points = workload.paths.clone();
        let mut shape = Direct::<c64>::prepare(&workload, Part::Shape, &mut Watch::default())
            .expect("four pins hold the chain");
        shape.refined_into(None, &workload.targets, &mut points).expect("the same chain");
        for ((path, sample), value) in expected {
            let error = (points[path][sample] - value).norm();
            assert!(error < INPUT_ROUNDING, "{name:?}: sample {sample} of path {path} is off by {error:e}");
        }
    }

    #[test]
    fn reference_has_the_values_of_extended_precision() {
        let ten = [
            ((5, 100), c64::new(5.813_551_112_688_542, 2.769_720_488_645_895_7)),
            ((0, 5), c64::new(0.104_599_182_720_965_8, 0.082_369_634_562_799_6)),
        ];
        assert_shape(WorkloadName::RelayChain10, ten);
        let many = [
            ((39, 100), c64::new(58.998_429_613_471_06, 9.413_471_960_046_654)),
            ((0, 5), c64::new(0.092_148_887_768_899_7, 0.069_138_873_359_794_5)),
        ];
        assert_shape(WorkloadName::RelayChain78, many);
    }
}
