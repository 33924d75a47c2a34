//! Smooth curves through keys, for motions that are drawn by a few places.

use glam::DVec3;

/// A cubic spline: twice continuously differentiable, with given slopes at its ends.
#[derive(Clone, Debug)]
pub(super) struct Curve {
    /// Rising arguments and the values there; at least two.
    keys: Vec<(f64, DVec3)>,
    /// One a key.
    slopes: Vec<DVec3>,
}

impl Curve {
    /// Through `keys`, whose arguments rise, with slopes `ends` at the first and at the last.
    ///
    /// Source: de Boor, *A Practical Guide to Splines*, chapter IV, complete cubic spline.
    pub(super) fn through(keys: &[(f64, DVec3)], ends: [DVec3; 2]) -> Self {
        let last = keys.len() - 1;
        let step = |k: usize| keys[k + 1].0 - keys[k].0;
        let rise = |k: usize| (keys[k + 1].1 - keys[k].1) / step(k);
        let mut slopes = vec![ends[0]; keys.len()];
        slopes[last] = ends[1];
        // Thomas' elimination of the slopes in between; `above` is what remains of the superdiagonal.
        let mut above = vec![0.0; keys.len()];
        for k in 1..last {
            let pivot = 2.0 * (step(k - 1) + step(k)) - step(k) * above[k - 1];
            let right = 3.0 * (step(k) * rise(k - 1) + step(k - 1) * rise(k));
            above[k] = step(k - 1) / pivot;
            slopes[k] = (right - step(k) * slopes[k - 1]) / pivot;
        }
        for k in (1..last).rev() {
            let next = slopes[k + 1];
            slopes[k] -= above[k] * next;
        }
        Self { keys: keys.to_vec(), slopes }
    }

    /// Value at `argument`, that of the nearer end outside.
    pub(super) fn at(&self, argument: f64) -> DVec3 {
        let last = self.keys.len() - 1;
        let argument = argument.clamp(self.keys[0].0, self.keys[last].0);
        let after = self.keys.iter().position(|key| argument <= key.0).unwrap_or(last).max(1);
        let ((start, from), (end, to)) = (self.keys[after - 1], self.keys[after]);
        let (step, u) = (end - start, (argument - start) / (end - start));
        let slopes = [self.slopes[after - 1] * step, self.slopes[after] * step];
        let v = 1.0 - u;
        from * (v * v * (1.0 + 2.0 * u)) + to * (u * u * (1.0 + 2.0 * v)) + slopes[0] * (u * v * v)
            - slopes[1] * (u * u * v)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cubic_is_its_own_spline() {
        let cubic = |t: f64| DVec3::new(t * t * t - t, 2.0 * t * t, 1.0 - t);
        let slope = |t: f64| DVec3::new(3.0 * t * t - 1.0, 4.0 * t, -1.0);
        let keys: Vec<_> = [-1.0, -0.4, 0.1, 0.7, 2.0].map(|t| (t, cubic(t))).into();
        let curve = Curve::through(&keys, [slope(-1.0), slope(2.0)]);
        for k in 0..=30 {
            let t = -1.0 + 0.1 * f64::from(k);
            assert!(curve.at(t).distance(cubic(t)) < 1e-12, "{t}");
        }
    }

    #[test]
    fn two_keys_are_enough() {
        let curve = Curve::through(&[(0.0, DVec3::ZERO), (2.0, DVec3::X)], [DVec3::ZERO; 2]);
        assert!(curve.at(1.0).distance(DVec3::X * 0.5) < 1e-15);
        assert_eq!(curve.at(-1.0), DVec3::ZERO);
    }
}
