//! The two number types of the crate, and sums of products that keep the digits cancellation would eat.

use crate::lu::Element;
use num_complex::Complex64;

/// Entry of a vector or matrix: `f64`, or [`c64`](crate::c64) where rows are complex-linear.
///
/// Arithmetic, `conjugate`, `modulus`, `from_real` and the like come from nalgebra's `ComplexField`. Sealed.
pub trait Scalar: nalgebra::ComplexField<RealField = f64> + Element + Copy + Default {
    /// Adds `a · b` to a sum kept in two parts, to about 32 digits.
    fn add_product(sum: &mut TwoPart<Self>, a: Self, b: Self);

    /// True if neither part is infinite or not a number.
    fn all_finite(self) -> bool;
}

/// Unevaluated sum `high + low`, `|low|` at most half a unit in the last place of `high`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TwoPart<T> {
    /// The sum, rounded.
    pub high: T,
    /// What rounding left out.
    pub low: T,
}

impl<T: Scalar> TwoPart<T> {
    /// Adds `change`.
    pub fn add(&mut self, change: T) {
        T::add_product(self, change, T::one());
    }

    /// Adds `other · factor`.
    pub fn add_scaled(&mut self, other: Self, factor: T) {
        T::add_product(self, other.high, factor);
        T::add_product(self, other.low, factor);
    }

    /// This number times a power of two, exactly.
    pub fn scaled(self, power_of_two: f64) -> Self {
        Self { high: self.high.scale(power_of_two), low: self.low.scale(power_of_two) }
    }
}

impl Scalar for f64 {
    fn add_product(sum: &mut TwoPart<f64>, a: f64, b: f64) {
        (sum.high, sum.low) = plus_product(sum.high, sum.low, a, b);
    }

    fn all_finite(self) -> bool {
        self.is_finite()
    }
}

impl Scalar for Complex64 {
    fn add_product(sum: &mut TwoPart<Complex64>, a: Complex64, b: Complex64) {
        let (re, re_low) = plus_product(sum.high.re, sum.low.re, a.re, b.re);
        let (re, re_low) = plus_product(re, re_low, -a.im, b.im);
        let (im, im_low) = plus_product(sum.high.im, sum.low.im, a.re, b.im);
        let (im, im_low) = plus_product(im, im_low, a.im, b.re);
        *sum = TwoPart { high: Complex64::new(re, im), low: Complex64::new(re_low, im_low) };
    }

    fn all_finite(self) -> bool {
        self.re.is_finite() && self.im.is_finite()
    }
}

/// `high + low + a b` in two parts.
///
/// Source: Dekker, *A floating-point technique for extending the available precision*, Numer. Math. 18 (1971).
#[inline]
fn plus_product(high: f64, low: f64, a: f64, b: f64) -> (f64, f64) {
    let (product, product_error) = two_product(a, b);
    let (sum, sum_error) = two_sum(high, product);
    let rest = low + (sum_error + product_error);
    let new_high = sum + rest;
    (new_high, rest - (new_high - sum))
}

/// `a + b` as rounded sum and its exact error.
#[inline]
fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let b_seen = sum - a;
    (sum, (a - (sum - b_seen)) + (b - b_seen))
}

/// `a b` as rounded product and its exact error. Splits by hand: fused multiply-add is a library call on plain x86-64.
#[inline]
fn two_product(a: f64, b: f64) -> (f64, f64) {
    let product = a * b;
    let (a_high, a_low) = split(a);
    let (b_high, b_low) = split(b);
    let error = ((a_high * b_high - product) + a_high * b_low + a_low * b_high) + a_low * b_low;
    (product, error)
}

/// Splits a number into two halves of 26 bits.
#[inline]
fn split(a: f64) -> (f64, f64) {
    const TWO_TO_27_PLUS_1: f64 = 134_217_729.0;
    let scaled = TWO_TO_27_PLUS_1 * a;
    let high = scaled - (scaled - a);
    (high, a - high)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cancelled_digits_survive() {
        let mut sum = TwoPart::default();
        f64::add_product(&mut sum, 1e16, 1.0);
        f64::add_product(&mut sum, 1.0, 1.0);
        f64::add_product(&mut sum, -1e8, 1e8);
        assert_eq!(sum.high, 1.0);
        let third = 1.0 / 3.0_f64;
        let mut rest = TwoPart::default();
        f64::add_product(&mut rest, third, 3.0);
        f64::add_product(&mut rest, -1.0, 1.0);
        assert_eq!(rest.high, -f64::EPSILON / 4.0); // 3 fl(1/3) = 1 − 2⁻⁵⁴ exactly
    }

    #[test]
    fn complex_products_add_up_like_real_ones() {
        let mut sum = TwoPart::default();
        let a = Complex64::new(1e8 + 1.0, 1e8);
        Complex64::add_product(&mut sum, a, a.conj());
        Complex64::add_product(&mut sum, Complex64::new(-2e16, 0.0), Complex64::new(1.0, 0.0));
        assert_eq!(sum.high, Complex64::new(2e8 + 1.0, 0.0));
    }
}
