//! What a touch-up tells people.

use std::path::Path;

use cotillion::export::flight_report::FlightPart;
use cotillion::export::touch_up_report::{DistanceReport, JudgedReport, TouchUpPart, TouchUpReport};

/// A few lines for people. `seconds`: what it took.
pub(super) fn summary(report: &TouchUpReport, folder: &Path, seconds: f64) -> String {
    let TouchUpPart { ground, flights, result, largest_change, doubts, .. } = &report.done;
    let mut text = format!("{}: {} frames at {} a second", report.clip, report.frames, report.fps);
    report.edits.iter().for_each(|edit| text += &format!(", {edit}"));
    text += "\nmean distance of the zero moment point from the polygon of support (at 6 Hz), largest:\n";
    let lines = [
        ("source", ground.source.as_ref()),
        ("before", Some(&ground.before)),
        ("ground", Some(&ground.after)),
        ("result", Some(result).filter(|_| report.settings.flight && !flights.is_empty())),
    ];
    let known = lines.into_iter().filter_map(|(name, judged)| Some((name, judged?)));
    text.extend(known.map(|(name, judged)| format!("  {name}  {}\n", distances(judged))));
    text += &format!("{} steps tried, {} kept", ground.steps.len(), ground.kept);
    if let Some(change) = largest_change {
        let (degrees, frame) = (change.degrees, change.frame);
        text += &format!("; {} turns most, by {degrees:.1}° at frame {frame}", change.joint);
    }
    let (shift, plants) = (ground.root_shift * 1e3, ground.plants.largest_error * 1e3);
    text += &format!("; root moves up to {shift:.0} mm, plants {plants:.2} mm\n");
    text.extend(flights.iter().map(flight_line));
    if let Some(estimate) = &report.body.estimate {
        let (by, change) = (estimate.by, 100.0 * estimate.largest_change);
        text += &format!("masses by {by}: no segment more than {change:.0} % off the table\n");
    }
    text.extend(report.notes.iter().map(|note| format!("note: {note}\n")));
    text.extend(doubts.iter().map(|doubt| format!("doubt: {doubt}\n")));
    text + &format!("{} files in {} after {seconds:.2} s\n", report.files.len() + 1, folder.display())
}

fn distances(judged: &JudgedReport) -> String {
    let mean =
        |own: Option<DistanceReport>| own.map_or("–".to_owned(), |own| format!("{:.1}", own.mean * 1e3));
    let largest = judged.d.map_or("–".to_owned(), |own| format!("{:.1}", own.max * 1e3));
    let missed =
        judged.miss.map_or(String::new(), |miss| format!("; {:.1} mm from the source's place", miss * 1e3));
    format!("{:>6} mm ({:>5}), {largest:>6} mm{missed}", mean(judged.d), mean(judged.d_6hz))
}

fn flight_line(flight: &FlightPart) -> String {
    let mut text = format!("flight, frames {} to {}", flight.first, flight.last);
    if let (Some(gravity), Some(residual)) = (flight.gravity, flight.residual) {
        text += &format!(": falls at {gravity:.1} m/s², {:.0} mm off a parabola", residual * 1e3);
    }
    if let Some(pass) = &flight.pass {
        text += &format!("; turned by up to {:.1}°", pass.largest_turn);
    }
    if flight.left {
        text += "; stays as it came, since the clip would end worse at 6 Hz";
    }
    text + "\n"
}
