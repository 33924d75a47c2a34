//! Places for names where they hide little.

use std::f64::consts::TAU;

use super::svg::{Point, Rect, Sheet, TextStyle, text_width};

/// Directions tried around a point.
const DIRECTIONS: u32 = 16;
/// Distances tried, px.
const DISTANCES: [f64; 5] = [8.0, 12.0, 18.0, 27.0, 40.0];
/// Cost of hiding another name, a symbol, a point of a path; a pixel of distance costs 1.
const COSTS: [f64; 3] = [1000.0, 60.0, 9.0];
/// From this distance on a hairline leads from a name to its point, px.
const LEADER: f64 = 26.0;

/// What names must not hide, and where names stand.
pub(super) struct Labels {
    /// Where names may stand.
    pub frame: Rect,
    /// Names so far.
    pub names: Vec<Rect>,
    /// Symbols.
    pub symbols: Vec<Rect>,
    /// Points of paths.
    pub ink: Vec<Point>,
}

impl Labels {
    /// A symbol of some radius.
    pub(super) fn reserve(&mut self, [x, y]: Point, radius: f64) {
        self.symbols.push(Rect { x: x - radius, y: y - radius, w: 2.0 * radius, h: 2.0 * radius });
    }

    /// Writes a name on or near its point, where it hides least; not at all where that costs more than `most`.
    pub(super) fn write(
        &mut self,
        sheet: &mut Sheet,
        at: Point,
        (name, style): (&str, TextStyle),
        most: f64,
    ) {
        let size = [text_width(name, style.size) + 4.0, style.size * 1.2];
        let places = DISTANCES.into_iter().flat_map(|distance| {
            (0..DIRECTIONS)
                .map(move |k| beside(at, size, f64::from(k) * TAU / f64::from(DIRECTIONS), distance))
        });
        let middle = Rect { x: at[0] - size[0] / 2.0, y: at[1] - size[1] / 2.0, w: size[0], h: size[1] };
        let priced = std::iter::once((middle, 0.0))
            .chain(places)
            .map(|(rect, distance)| (self.cost(&rect) + distance, distance, rect));
        let best = priced.min_by(|a, b| a.0.total_cmp(&b.0));
        let Some((_, distance, rect)) = best.filter(|(cost, ..)| *cost <= most) else { return };
        if distance >= LEADER {
            let edge = [at[0].clamp(rect.x, rect.x + rect.w), at[1].clamp(rect.y, rect.y + rect.h)];
            sheet.line(at, edge, r##"stroke="#8a9098" stroke-width="0.7""##);
        }
        let style = TextStyle { anchor: "middle", halo: true, ..style };
        sheet.text([rect.x + rect.w / 2.0, rect.y + style.size * 0.93], style, name);
        self.names.push(rect);
    }

    fn cost(&self, rect: &Rect) -> f64 {
        let outside = f64::from(u8::from(!self.frame.encloses(rect)));
        let count = |rects: &[Rect]| rects.iter().filter(|other| rect.overlaps(other)).count() as f64;
        let ink = self.ink.iter().filter(|point| rect.contains(**point)).count() as f64;
        COSTS[0] * (outside + count(&self.names)) + COSTS[1] * count(&self.symbols) + COSTS[2] * ink
    }
}

/// A rectangle beside a point, touching a circle around it, and the circle's radius.
fn beside(at: Point, [w, h]: [f64; 2], angle: f64, distance: f64) -> (Rect, f64) {
    let (sine, cosine) = angle.sin_cos();
    let centre = [at[0] + cosine * (distance + w / 2.0), at[1] + sine * (distance + h / 2.0)];
    (Rect { x: centre[0] - w / 2.0, y: centre[1] - h / 2.0, w, h }, distance)
}
