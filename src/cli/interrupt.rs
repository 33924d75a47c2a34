//! Ctrl-C while files are being written: nothing half-written stays.

use cotillion::export::files::Staging;

/// What a shell expects of a program that Ctrl-C ended.
pub(super) const INTERRUPTED: u8 = 130;

/// Gives up a result in the making when the program is interrupted or told to end, and ends it at once.
pub(crate) fn watch(staging: &Staging) {
    let (folder, pending) = staging.pending();
    // Without a handler the system ends the program, and what is aside stays there: no reason not to run.
    let _ = ctrlc::set_handler(move || {
        pending.abandon(&folder);
        std::process::exit(INTERRUPTED.into());
    });
}
