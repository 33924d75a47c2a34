//! `cotillion bench` measures what it says: every case has its rows, and answers are right. How fast is not tested.

use std::fs;
use std::process::{Command, Output};

use serde_json::Value;

/// The accuracy that is claimed for the chains of 10 and 78 characters, metres (times: seconds).
const CLAIMED_ERROR: f64 = 1e-9;

fn bench(arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_cotillion"));
    command.arg("bench").args(arguments).env("NO_COLOR", "1").output().expect("the program starts")
}

fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn rows(output: &Output) -> Vec<Value> {
    assert!(output.status.success(), "{}", stderr(output));
    let json: Value = serde_json::from_slice(&output.stdout).expect("JSON and nothing else");
    json.as_array().expect("an array of rows").clone()
}

fn text<'a>(row: &'a Value, key: &str) -> &'a str {
    row[key].as_str().unwrap_or_else(|| panic!("{key} of {row}"))
}

/// Rows of one repetition on one thread, all measured and right.
fn right_rows(cases: &[&str]) -> Vec<Value> {
    let rows = rows(&bench(&[&["--threads", "1", "--json", "--repetitions", "1"], cases].concat()));
    for row in &rows {
        let (ms, least) = (row["ms"].as_f64(), row["least_ms"].as_f64());
        assert!(least.is_some_and(|ms| ms > 0.0) && ms == least, "{row}");
        assert!(row["max_error"].as_f64().is_some_and(|error| error < CLAIMED_ERROR), "{row}");
        assert!(row["characters"].is_u64() && row["frames"].is_u64(), "{row}");
        assert!(row["note"].is_null(), "{row}");
        let peak = &row["peak_mb"];
        assert_eq!(
            peak.as_f64().is_some_and(|megabytes| megabytes > 0.0),
            cfg!(target_os = "linux"),
            "{row}"
        );
    }
    rows
}

#[test]
fn every_back_end_agrees_with_the_reference() {
    let rows = right_rows(&["--workload", "relay-chain-10,high-five"]);
    let count = |key: &str, value: &str| rows.iter().filter(|row| text(row, key) == value).count();
    for workload in ["relay-chain-10", "high-five"] {
        assert_eq!(count("workload", workload), rows.len() / 2);
    }
    for system in ["shape", "scale", "time", "all"] {
        assert_eq!(count("system", system), rows.len() / 4);
    }
    for backend in ["direct-real", "direct-complex", "chain", "compliance"] {
        assert_eq!(count("backend", backend), rows.len() / 4);
    }
    assert_eq!(count("mode", "cold"), rows.len() / 2);
}

#[test]
fn default_back_end_keeps_its_accuracy_on_a_long_chain() {
    assert_eq!(right_rows(&["--workload", "relay-chain-78", "--backend", "compliance"]).len(), 8);
}

#[test]
fn phases_add_up_and_a_drag_reuses_the_factor() {
    let arguments = ["--workload", "high-five", "--backend", "direct-complex", "compliance"];
    let rows =
        rows(&bench(&[&arguments[..], &["--threads", "1,2", "--json", "--repetitions", "3"]].concat()));
    assert_eq!(rows.iter().filter(|row| row["threads"] == 2).count(), rows.len() / 2);
    for row in rows {
        let phases = row["phases_ms"].as_object().expect("phases");
        let sum: f64 = phases.values().filter_map(Value::as_f64).sum();
        let total = row["ms"].as_f64().expect("a time");
        // Five numbers are summed in two orders.
        assert!((sum - total).abs() <= 1e-12 * total, "{row}");
        assert_eq!(phases["factor"].is_null(), text(&row, "mode") == "drag", "{row}");
    }
}

#[test]
fn what_is_too_large_is_said_to_be_skipped() {
    let arguments = ["--workload", "relay-chain-10000", "--backend", "direct-real", "direct-complex"];
    for row in rows(&bench(&[&arguments[..], &["--json"]].concat())) {
        assert!(row["ms"].is_null() && row["max_error"].is_null() && row["peak_mb"].is_null(), "{row}");
        assert!(text(&row, "note").starts_with("skipped: 2000000 frames"), "{row}");
    }
    let table = String::from_utf8_lossy(&bench(&arguments).stdout).into_owned();
    assert_eq!(table.matches("skipped").count(), 2, "{table}");
}

#[test]
fn unknown_names_are_refused_with_those_that_exist() {
    for (option, known) in
        [("--workload", "relay-chain-78"), ("--backend", "direct-complex"), ("--system", "shape")]
    {
        let output = bench(&[option, "nonsense"]);
        assert_eq!(output.status.code(), Some(2));
        let said = stderr(&output);
        assert!(said.contains("nonsense") && said.contains(known), "{said}");
    }
    let output = bench(&["--threads", "0"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("from 1 to"), "{}", stderr(&output));
}

#[test]
fn folder_gets_measurements_and_their_plot() {
    let home = tempfile::tempdir().expect("a temporary folder");
    let folder = home.path().join("new");
    let path = folder.to_str().expect("a plain path");
    let case = ["--workload", "chair", "--backend", "direct-complex", "--threads", "1"];
    let output = bench(&[&case[..], &["--repetitions", "1", "-o", path]].concat());
    assert!(output.status.success(), "{}", stderr(&output));
    let table = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(table.contains("3 characters, 885 frames") && table.contains("80.2 ms"), "{table}");
    let json = fs::read(folder.join("bench.json")).expect("measurements");
    let rows: Vec<Value> = serde_json::from_slice(&json).expect("an array");
    assert!(!rows.is_empty());
    let svg = fs::read_to_string(folder.join("bench.svg")).expect("a plot");
    assert!(svg.contains("milliseconds") && svg.contains("direct-complex, drag"));
    assert!(cotillion::export::picture::to_png(&svg, 300).is_ok());
}
