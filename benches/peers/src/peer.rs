//! Other libraries through the C interface of `shim/`. The only file with unsafe code.
#![expect(unsafe_code, reason = "the libraries compared with are written in C and C++")]

use crate::system::{Matrix, Numbers};
use std::ffi::{CStr, c_char};
use std::fmt;
use std::marker::PhantomData;

/// Libraries compared with; the numbers are those of `peer_new`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Library {
    /// SuiteSparse's multifrontal LU.
    Umfpack = 0,
    /// SuiteSparse's LU for circuit matrices.
    Klu = 1,
    /// Eigen's supernodal LU.
    SparseLu = 2,
    /// Eigen's LDLᵀ without pivoting, of the shifted matrix, refined on the true one.
    Ldlt = 3,
}

/// Status a library gave in place of a result; -1 for an exception.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Failed(pub i32);

/// A solver for one matrix.
pub struct Peer<'a> {
    raw: *mut RawPeer,
    length: usize,
    stage: Stage,
    /// The other side reads the matrix for as long as it lives.
    _matrix: PhantomData<&'a Matrix>,
}

/// What a solver is ready for; steps out of order would be undefined behaviour in some libraries.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stage {
    New,
    Analysed,
    Factored,
    Failed,
}

/// Opaque: `Peer` of `shim/peer.h`.
#[repr(C)]
struct RawPeer {
    _private: [u8; 0],
}

/// `Matrix` of `shim/peer.h`.
#[repr(C)]
struct RawMatrix {
    size: i32,
    is_complex: i32,
    starts: *const i32,
    rows: *const i32,
    values: *const f64,
    signs: *const f64,
}

unsafe extern "C" {
    fn peer_new(matrix: *const RawMatrix, library: i32, options: *const f64) -> *mut RawPeer;
    fn peer_analyse(peer: *mut RawPeer) -> i32;
    fn peer_factor(peer: *mut RawPeer) -> i32;
    fn peer_solve(peer: *mut RawPeer, b: *const f64, x: *mut f64) -> i32;
    fn peer_free(peer: *mut RawPeer);
    fn peer_cpu_seconds() -> f64;
    fn peer_versions() -> *const c_char;
}

impl Library {
    /// For tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Umfpack => "UMFPACK",
            Self::Klu => "KLU",
            Self::SparseLu => "Eigen SparseLU",
            Self::Ldlt => "Eigen SimplicialLDLT",
        }
    }
}

/// Seconds that all threads of this process have run: what others do on the machine lengthens them least.
pub fn cpu_seconds() -> f64 {
    // SAFETY: it takes nothing.
    unsafe { peer_cpu_seconds() }
}

/// Names and versions of the libraries.
pub fn versions() -> String {
    // SAFETY: a string constant of the shim.
    unsafe { CStr::from_ptr(peer_versions()) }.to_string_lossy().into_owned()
}

impl<'a> Peer<'a> {
    /// A solver that has not looked at its matrix yet. `options`: see `shim/peer.h`.
    ///
    /// # Errors
    /// [`Failed`] if memory runs out.
    pub fn new(matrix: &'a Matrix, library: Library, options: [f64; 3]) -> Result<Self, Failed> {
        let size = matrix.starts.len() - 1;
        let is_complex = matrix.numbers == Numbers::Complex;
        let raw_matrix = RawMatrix {
            size: i32::try_from(size).map_err(|_| Failed(-1))?,
            is_complex: i32::from(is_complex),
            starts: matrix.starts.as_ptr(),
            rows: matrix.rows.as_ptr(),
            values: matrix.values.as_ptr(),
            signs: matrix.signs.as_ptr(),
        };
        // SAFETY: the arrays have the lengths that the shim expects (`starts` ends with the number of entries) and outlive
        // the solver: `matrix` is borrowed. The shim copies `raw_matrix` and `options`.
        let raw = unsafe { peer_new(&raw const raw_matrix, library as i32, options.as_ptr()) };
        let length = if is_complex { 2 * size } else { size };
        if raw.is_null() {
            return Err(Failed(-1));
        }
        Ok(Self { raw, length, stage: Stage::New, _matrix: PhantomData })
    }

    /// Chooses an order of elimination.
    ///
    /// # Errors
    /// [`Failed`] with the library's status.
    ///
    /// # Panics
    /// If called twice.
    pub fn analyse(&mut self) -> Result<(), Failed> {
        assert_eq!(self.stage, Stage::New, "analysed once");
        // SAFETY: `raw` is a live solver, held by nobody else.
        let status = unsafe { peer_analyse(self.raw) };
        self.reach(Stage::Analysed, status)
    }

    /// Factors.
    ///
    /// # Errors
    /// [`Failed`] with the library's status.
    ///
    /// # Panics
    /// If called twice, or before [`analyse`](Self::analyse) succeeded.
    pub fn factor(&mut self) -> Result<(), Failed> {
        assert_eq!(self.stage, Stage::Analysed, "factored once, after the analysis");
        // SAFETY: `raw` is a live solver that has analysed its matrix.
        let status = unsafe { peer_factor(self.raw) };
        self.reach(Stage::Factored, status)
    }

    /// Solves for one right-hand side, in pairs.
    ///
    /// # Errors
    /// [`Failed`] with the library's status.
    ///
    /// # Panics
    /// If a vector does not have two numbers per complex unknown, or before [`factor`](Self::factor) succeeded.
    pub fn solve(&mut self, b: &[f64], x: &mut [f64]) -> Result<(), Failed> {
        assert_eq!(self.stage, Stage::Factored, "solved after the factorisation");
        assert!(b.len() == self.length && x.len() == self.length, "vectors have the length of the system");
        // SAFETY: `raw` is a live solver that has factored its matrix; both vectors have the length that the shim reads and writes.
        let status = unsafe { peer_solve(self.raw, b.as_ptr(), x.as_mut_ptr()) };
        self.reach(Stage::Factored, status)
    }

    fn reach(&mut self, stage: Stage, status: i32) -> Result<(), Failed> {
        self.stage = if status == 0 { stage } else { Stage::Failed };
        if status == 0 { Ok(()) } else { Err(Failed(status)) }
    }
}

impl Drop for Peer<'_> {
    fn drop(&mut self) {
        // SAFETY: made by `peer_new`, freed only here.
        unsafe { peer_free(self.raw) }
    }
}

impl fmt::Display for Failed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "failed with status {}", self.0)
    }
}
