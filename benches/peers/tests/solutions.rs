//! Every library, in every configuration that is tried, solves the systems it is given.

use cotillion_peers::configuration::{Configuration, configurations};
use cotillion_peers::measure::{Case, LIBRARIES, run_ours, run_peer};
use cotillion_peers::ours::ROUTES;
use cotillion_peers::peer::{Library, Peer};
use cotillion_peers::system::{FORMS, Form, NUMBERS, Numbers, assemble, layout, points_of, right_hand_side};
use cotillion_solvers::workload::relay_chain;
use cotillion_solvers::{LeastSquares, RowMatrix, c64, solve};

/// Well-conditioned: rounding, and the largest shift after two steps of refinement.
const TINY_TOLERANCE: f64 = 1e-12;

/// Metres. The squared condition number of ten paths is about 1e11.
const NORMAL_TOLERANCE: f64 = 1e-4;

/// Metres. Pivots kept on the diagonal, without refinement, lose most.
const HACHTEL_TOLERANCE: f64 = 1e-4;

fn every_configuration() -> impl Iterator<Item = Configuration> {
    let systems = FORMS.into_iter().flat_map(|form| NUMBERS.map(|numbers| (form, numbers)));
    let of = |(form, numbers)| LIBRARIES.map(|library| configurations(library, form, numbers));
    systems.flat_map(of).flatten()
}

fn tolerance(form: Form) -> f64 {
    if form == Form::Hachtel { HACHTEL_TOLERANCE } else { NORMAL_TOLERANCE }
}

/// Three points as evenly spaced as possible, the first drawn to 0 and turned on the way, the last held.
fn tiny_problem() -> LeastSquares<c64> {
    let (mut soft, mut hard) = (RowMatrix::new(3), RowMatrix::new(3));
    soft.push_row(&[(0, c64::new(-0.5, 0.25)), (1, c64::new(1.0, 0.0)), (2, c64::new(-0.5, -0.25))]);
    soft.push_row(&[(0, c64::new(1.0, 0.0))]);
    hard.push_row(&[(2, c64::new(0.0, 1.0))]);
    LeastSquares { columns: 3, soft: soft.to_csr(), hard: hard.to_csr() }
}

#[test]
fn tiny_system_is_solved_by_every_configuration() {
    let problem = tiny_problem();
    let (m, h) = ([c64::new(0.5, 0.0), c64::default()], [c64::new(3.0, 1.0)]);
    let expected = solve(&problem, &m, &h).expect("three points are held").x;
    for configuration in every_configuration() {
        let Configuration { library, form, numbers, options, label } = configuration;
        let matrix = assemble(&problem, form, numbers);
        let b = right_hand_side(&problem, form, &m, &h);
        let mut x = vec![0.0; b.len()];
        let mut peer = Peer::new(&matrix, library, options).expect("memory for a tiny matrix");
        let solved = peer.analyse().and_then(|()| peer.factor()).and_then(|()| peer.solve(&b, &mut x));
        assert_eq!(solved, Ok(()), "{library:?}, {form:?}, {label}");
        for (found, expected) in points_of(layout(&problem, form), &x).iter().zip(&expected) {
            assert!((found - expected).norm() < TINY_TOLERANCE, "{library:?}, {form:?}, {label}: {found}");
        }
    }
}

#[test]
fn ten_paths_are_solved_by_every_configuration_that_pivots() {
    let case = Case::new(relay_chain(10)).expect("four pins hold the chain");
    for configuration in every_configuration().filter(|c| c.library != Library::Ldlt) {
        let Configuration { library, form, label, .. } = &configuration;
        let run = run_peer(&case.posed, &configuration).expect("a regular system");
        assert!(run.error < tolerance(*form), "{library:?}, {form:?}, {label}: {:e}", run.error);
        assert!(run.cold > 0.0 && run.drag > 0.0);
    }
}

#[test]
fn ten_paths_are_solved_by_the_best_configuration_without_pivots() {
    let case = Case::new(relay_chain(10)).expect("four pins hold the chain");
    for form in FORMS {
        let runs = configurations(Library::Ldlt, form, Numbers::Complex)
            .into_iter()
            .map(|c| run_peer(&case.posed, &c));
        let least = runs.flatten().map(|run| run.error).fold(f64::INFINITY, f64::min);
        assert!(least < tolerance(form), "{form:?}: {least:e}");
    }
}

#[test]
fn ten_paths_are_solved_by_every_route_of_ours() {
    let case = Case::new(relay_chain(10)).expect("four pins hold the chain");
    for route in ROUTES {
        let run = run_ours(&case, route).expect("four pins hold the chain");
        assert!(run.error < NORMAL_TOLERANCE, "{}: {:e}", route.name(), run.error);
    }
}

#[test]
#[should_panic(expected = "factored once, after the analysis")]
fn steps_out_of_order_are_refused() {
    let configuration = every_configuration().next().expect("something is tried");
    let matrix = assemble(&tiny_problem(), configuration.form, configuration.numbers);
    let mut peer = Peer::new(&matrix, configuration.library, configuration.options).expect("a tiny matrix");
    let _ = peer.factor();
}
