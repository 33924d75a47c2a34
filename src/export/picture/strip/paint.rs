//! Draws a body: shadow, then groups from far to near, each with one outline around it.

use super::camera::Camera;
use super::figure::{Ball, Cloth, Group, Kind, Part};
use super::hull::{Disk, hull};
use crate::export::picture::svg::{Point, Sheet, number, tinted};
use glam::DVec3;

/// Where a pose stands on the sheet.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stand {
    /// Ground below the body, world metres …
    pub(super) origin: DVec3,
    /// … and its place on the sheet, px.
    pub(super) at: Point,
    /// Pixels a metre.
    pub(super) scale: f64,
}

/// Draws bodies, one after the other.
pub(super) struct Painter<'a> {
    pub(super) sheet: &'a mut Sheet,
    pub(super) camera: Camera,
    /// Gradients so far; each has a name of its own.
    pub(super) gradients: usize,
}

/// Width of outlines, px.
const RIM: f64 = 1.0;
/// Corners of a disk.
const CORNERS: u32 = 28;
/// Corners of a shadow's disk.
const SHADOW_CORNERS: u32 = 14;
/// Parts of a group less far apart than this keep their order, metres.
const SAME_DEPTH: f64 = 0.04;
/// Depth behind the body's middle at which a limb is as dark as it gets, metres.
const DARKEST: f64 = 0.16;
/// How dark a far limb gets.
const FAR_SHADE: f64 = 0.66;
/// Direction that light comes from, on the sheet.
const LIGHT: Point = [-0.45, -0.89];
/// Colour of shadows, opaque: they melt into one.
const SHADOW: &str = "#dbe0e5";

impl Painter<'_> {
    /// Draws the shadow that a body throws straight down.
    pub(super) fn shadow(&mut self, groups: &[Group], stand: &Stand) {
        let flatness = self.camera.towards.y.max(1e-3);
        for part in groups.iter().flat_map(|group| &group.parts) {
            let disks: Vec<Disk> = part
                .balls
                .iter()
                .map(|ball| {
                    let [x, y] = self.camera.place(ball.centre.with_y(stand.origin.y) - stand.origin);
                    ([x, y / flatness], ball.radius)
                })
                .collect();
            let outline: Vec<Point> = hull(&disks, SHADOW_CORNERS)
                .into_iter()
                .map(|[x, y]| [stand.at[0] + x * stand.scale, stand.at[1] - y * flatness * stand.scale])
                .collect();
            self.sheet.polygon(&outline, &format!(r#"fill="{SHADOW}""#));
        }
    }

    /// Draws a body; far limbs are darker.
    pub(super) fn body(&mut self, groups: &[Group], stand: &Stand) {
        let nearness = |group: &Group| nearness(&self.camera, &group.parts);
        let middle = mean(groups.iter().map(nearness));
        let mut order: Vec<(f64, &Group)> = groups.iter().map(|group| (nearness(group), group)).collect();
        order.sort_by(|a, b| (a.0 + a.1.bias).total_cmp(&(b.0 + b.1.bias)));
        for (nearness, group) in order {
            let behind = ((middle - nearness) / DARKEST).clamp(0.0, 1.0);
            let shade = if group.kind == Kind::Limb { 1.0 - (1.0 - FAR_SHADE) * behind } else { 1.0 };
            self.group(group.kind, &sorted(&self.camera, group), stand, shade);
        }
    }

    /// One outline around limbs; every face of a thing has its own.
    fn group(&mut self, kind: Kind, parts: &[&Part], stand: &Stand, shade: f64) {
        if kind == Kind::Thing {
            parts.iter().for_each(|part| self.parts(&[part], stand, shade));
        } else {
            self.parts(parts, stand, shade);
        }
    }

    fn parts(&mut self, parts: &[&Part], stand: &Stand, shade: f64) {
        let outlines: Vec<Vec<Point>> = parts.iter().map(|part| self.outline(part, stand)).collect();
        for (part, outline) in parts.iter().zip(&outlines).filter(|(part, _)| part.rim) {
            let dark = scaled(colour(part.cloth), 0.5 * shade);
            let pen = format!(
                r#"fill="{dark}" stroke="{dark}" stroke-width="{}" stroke-linejoin="round""#,
                number(2.0 * RIM)
            );
            self.sheet.polygon(outline, &pen);
        }
        for (part, outline) in parts.iter().zip(&outlines) {
            let fill = self.gradient(part, stand, shade);
            self.sheet.polygon(outline, &format!(r#"fill="url(#{fill})""#));
        }
    }

    fn outline(&self, part: &Part, stand: &Stand) -> Vec<Point> {
        let disks: Vec<Disk> = part.balls.iter().map(|ball| self.disk(ball, stand)).collect();
        hull(&disks, CORNERS)
    }

    fn disk(&self, ball: &Ball, stand: &Stand) -> Disk {
        let [x, y] = self.camera.place(ball.centre - stand.origin);
        ([stand.at[0] + x * stand.scale, stand.at[1] - y * stand.scale], ball.radius * stand.scale)
    }

    /// Light on one side of a part, dark on the other; the name of the gradient.
    fn gradient(&mut self, part: &Part, stand: &Stand, shade: f64) -> String {
        let disks: Vec<Disk> = part.balls.iter().map(|ball| self.disk(ball, stand)).collect();
        let middle = [0, 1].map(|axis| mean(disks.iter().map(|(centre, _)| centre[axis])));
        let normal = lit_normal(&disks);
        let reach = disks.iter().map(|([x, y], radius)| {
            ((x - middle[0]) * normal[0] + (y - middle[1]) * normal[1]).abs() + radius
        });
        let reach = reach.fold(0.0, f64::max);
        let [x1, y1, x2, y2] = [
            middle[0] + normal[0] * reach,
            middle[1] + normal[1] * reach,
            middle[0] - normal[0] * reach,
            middle[1] - normal[1] * reach,
        ]
        .map(number);
        let name = format!("g{}", self.gradients);
        self.gradients += 1;
        let base = colour(part.cloth);
        let lit = tinted(base.map(|channel| channel * shade), 0.36 * shade);
        let stops = [(0, lit), (50, scaled(base, shade)), (100, scaled(base, 0.66 * shade))]
            .map(|(place, colour)| format!(r#"<stop offset="{place}%" stop-color="{colour}"/>"#));
        self.sheet.raw(&format!(
            r#"<linearGradient id="{name}" gradientUnits="userSpaceOnUse" x1="{x1}" y1="{y1}" x2="{x2}" y2="{y2}">{}</linearGradient>"#,
            stops.concat()
        ));
        name
    }
}

/// Across a part, to the side that light falls on.
fn lit_normal(disks: &[Disk]) -> Point {
    let (Some((from, _)), Some((to, radius))) = (disks.first(), disks.last()) else {
        return LIGHT;
    };
    let along = [to[0] - from[0], to[1] - from[1]];
    let length = along[0].hypot(along[1]);
    if length < 0.6 * radius {
        return LIGHT;
    }
    let normal = [along[1] / length, -along[0] / length];
    let sign = if normal[0] * LIGHT[0] + normal[1] * LIGHT[1] < 0.0 { -1.0 } else { 1.0 };
    normal.map(|coordinate| coordinate * sign)
}

fn nearness<'a>(camera: &Camera, parts: impl IntoIterator<Item = &'a Part>) -> f64 {
    mean(parts.into_iter().flat_map(|part| part.balls.iter().map(|ball| camera.nearness(ball.centre))))
}

/// Parts from far to near; parts of the trunk, and parts about as far, as they are listed.
fn sorted<'a>(camera: &Camera, group: &'a Group) -> Vec<&'a Part> {
    let middle = nearness(camera, &group.parts);
    let same = if group.kind == Kind::Thing { f64::MIN_POSITIVE } else { SAME_DEPTH };
    let step = |part: &Part| ((nearness(camera, [part]) - middle) / same).round();
    let mut parts: Vec<&Part> = group.parts.iter().collect();
    if group.kind != Kind::Trunk {
        parts.sort_by(|a, b| step(a).total_cmp(&step(b)));
    }
    parts
}

const fn colour(cloth: Cloth) -> [f64; 3] {
    match cloth {
        Cloth::Shirt => [76.0, 138.0, 200.0],
        Cloth::PartnerShirt => [150.0, 160.0, 148.0],
        Cloth::Trousers => [84.0, 94.0, 122.0],
        Cloth::Skin => [236.0, 188.0, 152.0],
        Cloth::Hair => [96.0, 70.0, 54.0],
        Cloth::Shoe => [66.0, 62.0, 68.0],
        Cloth::Bone => [150.0, 162.0, 178.0],
        Cloth::Thing => [206.0, 164.0, 104.0],
    }
}

fn scaled(colour: [f64; 3], shade: f64) -> String {
    tinted(colour.map(|channel| channel * shade), 0.0)
}

/// Mean of some numbers; 0 of none.
fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0.0), |(sum, count), value| (sum + value, count + 1.0));
    if count > 0.0 { sum / count } else { 0.0 }
}
