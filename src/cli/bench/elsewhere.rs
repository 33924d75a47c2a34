//! Cases measured in processes of their own, so that memory and threads are those of one case.

use std::process::{Command, Stdio};

use super::case::{Case, KINDS, Row, unmeasured};
use super::names::name_of;

/// Rows of a case, by this program called again with `--in-process`; rows with a note if it could not be measured.
pub(super) fn measured_elsewhere(case: Case, repetitions: Option<usize>) -> Vec<Row> {
    rows_from(case, repetitions).unwrap_or_else(|trouble| noted(case, &trouble))
}

/// Rows of a case without numbers.
pub(super) fn noted(case: Case, note: &str) -> Vec<Row> {
    let sizes = case.workload.sizes();
    let row = |kind| Row { note: Some(note.to_owned()), ..unmeasured(case, kind, sizes) };
    KINDS.into_iter().map(row).collect()
}

/// What a failed case is noted with, before the reason.
pub(super) const FAILED: &str = "failed: ";

fn rows_from(case: Case, repetitions: Option<usize>) -> Result<Vec<Row>, String> {
    let program =
        std::env::current_exe().map_err(|error| format!("{FAILED}no path to this program: {error}"))?;
    let mut command = Command::new(program);
    command.args(["bench", "--in-process", "--workload", &name_of(case.workload)]);
    command.args(["--backend", &name_of(case.backend)]);
    if let Some(count) = repetitions {
        command.args(["--repetitions", &count.to_string()]);
    }
    // rayon reads it when its first thread starts.
    command.env("RAYON_NUM_THREADS", case.threads.to_string()).stdin(Stdio::null());
    command.args(["--threads", &case.threads.to_string()]);
    let done = command.output().map_err(|error| format!("{FAILED}no process: {error}"))?;
    if !done.status.success() {
        let said = String::from_utf8_lossy(&done.stderr);
        let said = said.trim();
        let said = if said.is_empty() { "nothing said" } else { said };
        return Err(format!("{FAILED}{said} ({})", done.status));
    }
    serde_json::from_slice(&done.stdout).map_err(|error| format!("{FAILED}its rows cannot be read: {error}"))
}
