//! Lines with as few points as a picture can tell apart, and as few letters.

use std::fmt::Write as _;

use super::svg::Point;

/// Which of `count` points are kept so that none of the others is off by more than `most`, the first and the last among them.
/// `off`: by how much point `k` is off where only `a` and `b` around it are kept.
///
/// Cost: about count · log count, at worst count².
///
/// Source: Douglas & Peucker, *Algorithms for the reduction of the number of points required to represent a digitized line*,
/// 1973.
pub(super) fn kept(count: usize, most: f64, off: impl Fn((usize, usize), usize) -> f64) -> Vec<usize> {
    if count <= 2 {
        return (0..count).collect();
    }
    let mut kept = vec![false; count];
    (kept[0], kept[count - 1]) = (true, true);
    let mut open = vec![(0, count - 1)];
    while let Some((a, b)) = open.pop() {
        let priced = (a + 1..b).map(|k| (k, off((a, b), k)));
        let farthest = priced.max_by(|x, y| x.1.total_cmp(&y.1));
        if let Some((k, _)) = farthest.filter(|(_, off)| *off > most) {
            kept[k] = true;
            open.extend([(a, k), (k, b)]);
        }
    }
    (0..count).filter(|k| kept[*k]).collect()
}

/// The points without those that lie within `most` px of the line through those that are kept.
pub(super) fn simplified(points: &[Point], most: f64) -> Vec<Point> {
    let off = |(a, b): (usize, usize), k: usize| off_segment(points[k], (points[a], points[b]));
    kept(points.len(), most, off).into_iter().map(|k| points[k]).collect()
}

/// Distance of a point to a segment.
fn off_segment(p: Point, (a, b): (Point, Point)) -> f64 {
    let (along, to) = ([b[0] - a[0], b[1] - a[1]], [p[0] - a[0], p[1] - a[1]]);
    let squared = along[0] * along[0] + along[1] * along[1];
    let share = if squared > 0.0 { (to[0] * along[0] + to[1] * along[1]) / squared } else { 0.0 };
    let share = share.clamp(0.0, 1.0);
    (to[0] - share * along[0]).hypot(to[1] - share * along[1])
}

/// Path data through the points, in tenths of pixels: `<g transform="scale(.1)">` is around it. One point is a dot.
pub(super) fn tenths(points: &[Point]) -> String {
    let mut text = String::with_capacity(points.len() * 7 + 4);
    let mut at = [0_i64; 2];
    for (k, point) in points.iter().enumerate() {
        let next = point.map(tenth);
        let [x, y] = [next[0] - at[0], next[1] - at[1]];
        let command = match k {
            0 => "M",
            1 => "l",
            _ => "",
        };
        let gap = if k > 1 && x >= 0 { " " } else { "" };
        let between = if y >= 0 { " " } else { "" };
        let _ = write!(text, "{command}{gap}{x}{between}{y}");
        at = next;
    }
    if points.len() == 1 {
        text.push_str("h0");
    }
    text
}

#[expect(clippy::cast_possible_truncation, reason = "casts of floats saturate, far off the sheet")]
fn tenth(px: f64) -> i64 {
    let px = if px.is_finite() { px.clamp(-1e6, 1e6) } else { 0.0 };
    (px * 10.0).round() as i64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn straight_lines_keep_their_ends_and_bends_their_corners() {
        let line: Vec<Point> = (0..90).map(|k| [f64::from(k), 2.0 * f64::from(k)]).collect();
        assert_eq!(simplified(&line, 0.1), [line[0], line[89]]);
        let bent: Vec<Point> = (0..90).map(|k| [f64::from(k), f64::from((k - 30_i32).max(0))]).collect();
        assert_eq!(simplified(&bent, 0.1), [bent[0], bent[30], bent[89]]);
        assert_eq!(simplified(&line[..1], 0.1), line[..1]);
    }

    #[test]
    fn nothing_left_out_is_farther_off_than_allowed() {
        let points: Vec<Point> =
            (0..5000).map(|k| f64::from(k) * 0.01).map(|t| [20.0 * t.cos() * t, 20.0 * t.sin()]).collect();
        let few = simplified(&points, 0.4);
        assert!(few.len() < 500, "{}", few.len());
        let off = |p: &Point| {
            let nearest = few.windows(2).map(|pair| off_segment(*p, (pair[0], pair[1])));
            nearest.fold(f64::INFINITY, f64::min)
        };
        assert!(points.iter().map(off).fold(0.0, f64::max) <= 0.4);
    }

    #[test]
    fn path_data_is_short_and_exact_to_a_tenth() {
        assert_eq!(tenths(&[[1.0, 2.0], [1.04, 3.0], [0.0, 2.9]]), "M10 20l0 10-10-1");
        assert_eq!(tenths(&[[1.0, -2.0]]), "M10-20h0");
        assert_eq!(tenths(&[]), "");
    }
}
