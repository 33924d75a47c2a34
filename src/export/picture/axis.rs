//! Round numbers along an axis.

/// Most marks of an axis.
const MOST: u32 = 200;

/// The least of 1, 2, 5 times a power of ten that is `least` or more; 1 if that is no positive number.
pub(super) fn round_step(least: f64) -> f64 {
    if !(least.is_finite() && least > 0.0) {
        return 1.0;
    }
    let power = 10f64.powf(least.log10().floor());
    let factor = [1.0, 2.0, 5.0].into_iter().find(|factor| factor * power >= least * (1.0 - 1e-9));
    factor.unwrap_or(10.0) * power
}

/// Multiples of `step` from `low` to `high`.
pub(super) fn marks(low: f64, high: f64, step: f64) -> Vec<f64> {
    let first = (low / step - 1e-9).ceil();
    (0..MOST).map(|k| (first + f64::from(k)) * step).take_while(|mark| *mark <= high + 1e-9 * step).collect()
}

/// A multiple of `step` with as many decimals as `step` has, and a true minus.
pub(super) fn mark_label(mark: f64, step: f64) -> String {
    let text = if mark.abs() >= 1e6 {
        format!("{mark:e}")
    } else {
        let decimals =
            (1..12).find(|decimals| step * 10f64.powi(*decimals) >= 10.0 * (1.0 - 1e-9)).unwrap_or(12) - 1;
        format!("{:.*}", usize::try_from(decimals).unwrap_or(0), if mark == 0.0 { 0.0 } else { mark })
    };
    text.replace('-', "−")
}
