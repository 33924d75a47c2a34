//! placeholder

#[doc(no_inline)]
pub use num_complex::Complex64 as c64;
