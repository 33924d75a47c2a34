//! Configurations of the other libraries that are tried.

use crate::peer::Library;
use crate::system::{Form, Numbers};

/// One way to use a library.
#[derive(Clone, Debug, PartialEq)]
pub struct Configuration {
    /// Library.
    pub library: Library,
    /// System it is given.
    pub form: Form,
    /// Numbers it is given.
    pub numbers: Numbers,
    /// See `shim/peer.h`.
    pub options: [f64; 3],
    /// The options in words.
    pub label: String,
}

/// Options and their words.
type Choice = ([f64; 3], String);

/// All that is tried of a library on one system, the library's defaults first.
pub fn configurations(library: Library, form: Form, numbers: Numbers) -> Vec<Configuration> {
    let choices = match library {
        Library::Umfpack => umfpack(),
        Library::Klu => klu(),
        Library::SparseLu => sparse_lu(),
        Library::Ldlt => ldlt(),
    };
    choices
        .into_iter()
        .map(|(options, label)| Configuration { library, form, numbers, options, label })
        .collect()
}

/// Strategy × ordering × refinement; numbers of `umfpack.h`.
fn umfpack() -> Vec<Choice> {
    let strategies =
        [(0.0, "automatic strategy"), (3.0, "symmetric strategy"), (1.0, "unsymmetric strategy")];
    let orderings = [(1.0, "AMD/COLAMD"), (3.0, "METIS")];
    let refinements = [(2.0, "refined"), (0.0, "not refined")];
    let mut choices = Vec::new();
    for (refinement, refined) in refinements {
        for (strategy, how) in strategies {
            choices.extend(
                orderings.map(|(o, order)| ([strategy, o, refinement], format!("{how}, {order}, {refined}"))),
            );
        }
    }
    choices
}

/// Ordering × block triangular form; numbers of `klu.h`.
fn klu() -> Vec<Choice> {
    let choices = [
        (0.0, 1.0, "AMD, BTF"),
        (0.0, 0.0, "AMD, no BTF"),
        (1.0, 1.0, "COLAMD, BTF"),
        (1.0, 0.0, "COLAMD, no BTF"),
    ];
    choices.map(|(ordering, btf, words)| ([ordering, btf, 0.0], words.to_owned())).to_vec()
}

/// Ordering, symmetric mode, pivot threshold. The symmetric mode is for diagonal pivots, thus the low threshold.
fn sparse_lu() -> Vec<Choice> {
    let choices = [
        ([0.0, 0.0, 1.0], "COLAMD"),
        ([1.0, 0.0, 1.0], "AMD"),
        ([1.0, 1.0, 0.01], "AMD, symmetric mode, threshold 0.01"),
    ];
    choices.map(|(options, words)| (options, words.to_owned())).to_vec()
}

/// Steps of refinement, shift of the diagonal. The largest shift is what quasi-definite systems are usually given; it changes
/// the weak directions of long chains beyond what refinement makes up for. Shifts near rounding do better, but promise
/// nothing: without pivots some orders of elimination break down, which shows as errors of metres.
fn ldlt() -> Vec<Choice> {
    let choices = [(1.0, 1e-15), (1.0, 1e-16), (0.0, 1e-16), (2.0, 1e-15), (2.0, 1e-16), (2.0, 1e-8)];
    let words = |refinements, shift| format!("AMD, shift {shift:.0e}, refined {refinements} times");
    choices.map(|(refinements, shift)| ([refinements, shift, 0.0], words(refinements, shift))).to_vec()
}
