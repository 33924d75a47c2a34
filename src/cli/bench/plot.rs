//! Measurements as a chart of time against frames.

use clap::ValueEnum;
use cotillion::export::picture::{Chart, Series, chart_svg};

use super::case::Row;
use super::names::{Backend, Mode, System, name_of};

/// SVG of one system with the fewest threads measured: whole edits if they were told of.
pub(super) fn plot(rows: &[Row]) -> String {
    let system = [System::All, System::Shape, System::Scale, System::Time]
        .into_iter()
        .find(|system| rows.iter().any(|row| row.system == *system))
        .unwrap_or(System::All);
    let threads = rows.iter().map(|row| row.threads).min().unwrap_or(1);
    let shown: Vec<&Row> = rows.iter().filter(|row| row.system == system && row.threads == threads).collect();
    let subject = match system {
        System::All => "an edit: shape, scale and time".to_owned(),
        part => format!("the {} system", name_of(part)),
    };
    chart_svg(&Chart {
        title: format!("Cost of {subject}"),
        subtitle: format!("{threads} {}, medians", if threads == 1 { "thread" } else { "threads" }),
        x_label: "frames of all characters".to_owned(),
        y_label: "milliseconds".to_owned(),
        series: series(&shown, system),
        remarks: remarks(&shown, system),
    })
}

fn series(rows: &[&Row], system: System) -> Vec<Series> {
    let mut all = Vec::new();
    for (colour, backend) in Backend::value_variants().iter().enumerate() {
        for mode in [Mode::Cold, Mode::Drag] {
            let own: Vec<&Row> =
                rows.iter().copied().filter(|row| (row.backend, row.mode) == (*backend, mode)).collect();
            let points = |chained: bool| -> Vec<[f64; 2]> {
                let of_kind = own.iter().filter(|row| row.workload.chained().is_some() == chained);
                let mut points: Vec<_> =
                    of_kind.filter_map(|row| Some([row.frames as f64, row.ms?])).collect();
                points.sort_by(|a, b| a[0].total_cmp(&b[0]));
                points
            };
            let (line, dots) = (points(true), points(false));
            let mode = if mode == Mode::Cold { "cold" } else { "drag" };
            let name = format!("{}, {mode}", name_of(*backend));
            let series = Series { name, colour: Some(colour), dashed: mode == "drag", line, dots };
            all.extend((!series.line.is_empty() || !series.dots.is_empty()).then_some(series));
        }
    }
    all.extend((system == System::All).then(|| published(rows)).flatten());
    all
}

/// The paper's own times for the scenes that were measured.
fn published(rows: &[&Row]) -> Option<Series> {
    let point = |row: &&Row| Some([row.frames as f64, row.workload.published()?.laplacian_ms]);
    let mut dots: Vec<_> = rows.iter().filter_map(point).collect();
    dots.dedup();
    let name = "the paper, full edit".to_owned();
    (!dots.is_empty()).then(|| Series { name, dots, ..Series::default() })
}

fn remarks(rows: &[&Row], system: System) -> Vec<String> {
    let mut remarks =
        vec!["cold: from rest paths and rows".to_owned(), "drag: new targets, the rest reused".to_owned()];
    if rows.iter().any(|row| row.workload.published().is_some()) {
        remarks.push("lines: relay chains".to_owned());
        remarks.push("dots: scenes of the paper's Table 1".to_owned());
        remarks.extend((system == System::All).then(|| "crosses: its times, on hardware of 2009".to_owned()));
    }
    remarks
}
