//! Prints the comparison: see the README beside this.

use cotillion_peers::measure::LIBRARIES;
use cotillion_peers::measure::{Case, Statistic};
use cotillion_peers::options::{HELP, Options, parse};
use cotillion_peers::peer::versions;
use cotillion_peers::race::{Effort, all_fields, race};
use cotillion_peers::relay::{self, relay_table};
use cotillion_peers::table::{Size, details, json, notes, table};
use cotillion_solvers::workload::relay_chain;
use std::env;
use std::error::Error;
use std::fs;
use std::io::{self, Write};
use std::os::unix::process::CommandExt;
use std::process::{Command, ExitCode};

/// Libraries read these when they are loaded, before `main`.
const THREADS: [&str; 4] =
    ["OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "RAYON_NUM_THREADS"];

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            let _ = writeln!(io::stderr(), "peers: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run() -> Result<(), Box<dyn Error>> {
    stay_on_one_thread()?;
    let options = match parse(env::args().skip(1)) {
        Ok(options) => options,
        Err(error) => return Err(error.to_string().into()),
    };
    if options.help {
        return Ok(io::stdout().write_all(HELP.as_bytes())?);
    }
    if !options.relays.is_empty() {
        return relays(&options);
    }
    let sizes = measure(&options)?;
    let text = if options.json {
        json(&sizes, &about())?
    } else {
        let details = if options.all { details(&sizes)? } else { String::new() };
        let statistic = if options.least { "least times" } else { "medians" };
        format!("{}; {statistic}\n\n{details}{}{}", about(), table(&sizes)?, notes(&sizes)?)
    };
    Ok(io::stdout().write_all(text.as_bytes())?)
}

/// Starts this program anew unless all libraries were told at their start to use one thread.
fn stay_on_one_thread() -> io::Result<()> {
    if THREADS.iter().all(|name| env::var(name).is_ok_and(|count| count == "1")) {
        return Ok(());
    }
    let one = THREADS.map(|name| (name, "1"));
    Err(Command::new(env::current_exe()?).args(env::args_os().skip(1)).envs(one).exec())
}

fn measure(options: &Options) -> Result<Vec<Size>, Box<dyn Error>> {
    let mut fields = all_fields();
    let mut sizes = Vec::new();
    let statistic = if options.least { Statistic::Least } else { Statistic::Median };
    for &characters in &options.characters {
        writeln!(io::stderr(), "{characters} characters ...")?;
        let repeats = options.repeats.unwrap_or(if characters <= 200 { 31 } else { 7 });
        let effort = Effort { repeats, budget: options.budget, all: options.all, statistic };
        let case = Case::new(relay_chain(characters))?;
        let rows = race(&case, &mut fields, effort);
        sizes.push(Size { characters, samples: case.workload.samples(), rows });
    }
    Ok(sizes)
}

/// Prints a table for each relay.
fn relays(options: &Options) -> Result<(), Box<dyn Error>> {
    let libraries = if options.all { &LIBRARIES[..] } else { &LIBRARIES[..1] };
    let mut text = format!("{}\n", about());
    for &characters in &options.relays {
        writeln!(io::stderr(), "a relay of {characters} ...")?;
        text += &format!("\n{}", relay_table(&relay::measure(characters, libraries, options.budget)?));
    }
    Ok(io::stdout().write_all(text.as_bytes())?)
}

/// Processor, libraries, BLAS.
fn about() -> String {
    let machine = fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let processor = machine.lines().find_map(|line| line.strip_prefix("model name")?.split_once(": "));
    let loaded = fs::read_to_string("/proc/self/maps").unwrap_or_default();
    let is_blas = |file: &&str| file.rsplit('/').next().is_some_and(|name| name.contains("blas"));
    let blas = loaded.lines().filter_map(|line| line.split_whitespace().last()).find(is_blas);
    let processor = processor.map_or("unknown processor", |(_, name)| name);
    format!("{processor}, one thread; {}; BLAS: {}", versions(), blas.unwrap_or("none"))
}
