//! Fixed points of maps that are nearly affine: Anderson acceleration.
//!
//! The next point is where the residual `f = F(x) − x` would vanish if it changed between the last points as a straight
//! line does; on an affine map of `n` unknowns that takes `n + 1` rounds, whether plain repetition converges or not.
//!
//! Source: Walker, Ni, *Anderson Acceleration for Fixed-Point Iterations*, SIAM J. Numer. Anal. 49 (2011).

/// So many differences are remembered.
const MEMORY: usize = 12;
/// A difference that others explain but for this share tells nothing new.
const NOTHING_NEW: f64 = 1e-9;

/// Points and residuals so far.
#[derive(Clone, Debug, Default)]
pub struct Mixer {
    /// The last point and its residual.
    last: Option<(Vec<f64>, Vec<f64>)>,
    /// Differences of points and of residuals, oldest first.
    differences: Vec<(Vec<f64>, Vec<f64>)>,
}

impl Mixer {
    /// The point to try after `x`, where the residual is `f`. Cost: linear in unknowns.
    pub fn next(&mut self, x: &[f64], f: &[f64]) -> Vec<f64> {
        if let Some((before, residual)) = self.last.replace((x.to_vec(), f.to_vec())) {
            self.differences.push((minus(x, &before), minus(f, &residual)));
            if self.differences.len() > MEMORY {
                self.differences.remove(0);
            }
        }
        let (mut next, mut left) = (x.to_vec(), f.to_vec());
        for (step, change) in self.orthonormal() {
            let share = dot(&change, &left);
            add(&mut next, -share, &step);
            add(&mut left, -share, &change);
        }
        add(&mut next, 1.0, &left);
        next
    }

    /// Differences, the newest first, combined so that those of residuals are orthonormal.
    fn orthonormal(&self) -> Vec<(Vec<f64>, Vec<f64>)> {
        let mut basis: Vec<(Vec<f64>, Vec<f64>)> = Vec::new();
        for (step, change) in self.differences.iter().rev() {
            let (mut step, mut change) = (step.clone(), change.clone());
            let size = dot(&change, &change).sqrt();
            for (other_step, other) in &basis {
                let share = dot(other, &change);
                add(&mut step, -share, other_step);
                add(&mut change, -share, other);
            }
            let left = dot(&change, &change).sqrt();
            if left > NOTHING_NEW * size {
                let scaled = |values: Vec<f64>| values.into_iter().map(|value| value / left).collect();
                basis.push((scaled(step), scaled(change)));
            }
        }
        basis
    }
}

fn minus(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn add(to: &mut [f64], factor: f64, what: &[f64]) {
    to.iter_mut().zip(what).for_each(|(to, what)| *to += factor * what);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_affine_map_that_repetition_never_settles_is_settled() {
        // Eigenvalues −5 and 3: repetition runs away.
        let map = |x: &[f64]| vec![-5.0 * x[0] + 1.0, 2.0 * x[0] + 3.0 * x[1] - 4.0];
        let (mut mixer, mut x) = (Mixer::default(), vec![10.0, -7.0]);
        for _ in 0..4 {
            let f = minus(&map(&x), &x);
            x = mixer.next(&x, &f);
        }
        let expected = [1.0 / 6.0, 2.0 - 1.0 / 6.0];
        assert!(minus(&x, &expected).iter().all(|miss| miss.abs() < 1e-12), "{x:?}");
    }

    #[test]
    fn the_first_round_repeats_the_map() {
        assert_eq!(Mixer::default().next(&[1.0, 2.0], &[0.5, -1.0]), [1.5, 1.0]);
    }
}
