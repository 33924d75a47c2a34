//! Curves along time made smooth: averages, and the smooth curve above a rough one.

use std::collections::VecDeque;

/// A smooth curve on or above `values` ≥ 0: the largest value within `window` seconds, averaged over as many with weights
/// `(1 − u²)³`. Exactly 0 where all values within two windows are. Cost: linear in samples times samples in a window.
pub fn envelope(times: &[f64], values: &[f64], window: f64) -> Vec<f64> {
    if values.iter().all(|value| *value == 0.0) {
        return vec![0.0; values.len()];
    }
    average(times, &widened(times, values, window), window)
}

/// The largest of `values` within `window` seconds of each sample.
fn widened(times: &[f64], values: &[f64], window: f64) -> Vec<f64> {
    // Candidates from the largest down, each later than the one before.
    let mut candidates: VecDeque<usize> = VecDeque::new();
    let mut next = 0;
    let mut largest = Vec::with_capacity(values.len());
    for &time in times {
        while next < times.len() && times[next] <= time + window {
            while candidates.back().is_some_and(|&at| values[at] <= values[next]) {
                candidates.pop_back();
            }
            candidates.push_back(next);
            next += 1;
        }
        while candidates.front().is_some_and(|&at| times[at] < time - window) {
            candidates.pop_front();
        }
        largest.push(candidates.front().map_or(0.0, |&at| values[at]));
    }
    largest
}

/// Averages of `values` over `window` seconds on each side, with weights `(1 − u²)³`, each sample standing for the time
/// around it.
pub fn average(times: &[f64], values: &[f64], window: f64) -> Vec<f64> {
    let last = times.len().saturating_sub(1);
    let stands_for = |at: usize| times[(at + 1).min(last)] - times[at.saturating_sub(1)];
    let mut first = 0;
    let mut averages = Vec::with_capacity(values.len());
    for (own, &time) in times.iter().enumerate() {
        while times[first] <= time - window {
            first += 1;
        }
        let (mut sum, mut weights) = (0.0, 0.0);
        for at in first..times.len() {
            let u = (times[at] - time) / window;
            if u >= 1.0 {
                break;
            }
            let weight = (1.0 - u * u).max(0.0).powi(3) * stands_for(at);
            sum += weight * values[at];
            weights += weight;
        }
        averages.push(if weights > 0.0 { sum / weights } else { values[own] });
    }
    averages
}
