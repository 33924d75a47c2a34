//! Ctrl-C while files are being written: nothing half-written stays.

use std::path::Path;
use std::process::{Command, ExitCode, Stdio};
use std::time::Duration;

use cotillion::export::aside::sweep;
use cotillion::export::files::Staging;

/// What a shell expects of a program that Ctrl-C ended.
const INTERRUPTED: u8 = 130;

/// Gives up a result in the making when the program is interrupted or told to end, and ends it at once.
pub(crate) fn watch(staging: &Staging) {
    let (folder, pending) = staging.pending();
    // Without a handler the system ends the program, and what is aside stays for the next result there: no reason not to run.
    let _ = ctrlc::set_handler(move || {
        if let Some(left) = pending.give_up(&folder) {
            sweep_behind(&left);
        }
        std::process::exit(INTERRUPTED.into());
    });
}

/// Lets the handler end the program, which is about to: it is still giving up what was made.
pub(super) fn end() -> ExitCode {
    std::thread::sleep(Duration::from_secs(1));
    ExitCode::from(INTERRUPTED)
}

/// Has a process of its own sweep `folder`, which goes on when this one has ended: to remove thousands of files takes seconds.
fn sweep_behind(folder: &Path) {
    let begun = std::env::current_exe().and_then(|program| {
        let mut command = Command::new(program);
        command.arg("sweep").arg(folder).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
        on_its_own(&mut command);
        command.spawn()
    });
    if begun.is_err() {
        sweep(folder);
    }
}

/// Another Ctrl-C is not for it.
#[cfg(unix)]
fn on_its_own(command: &mut Command) {
    use std::os::unix::process::CommandExt;
    command.process_group(0);
}

#[cfg(not(unix))]
fn on_its_own(_: &mut Command) {}
