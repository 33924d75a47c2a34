//! A curve from a drawing: the one `path`, `polyline` or `polygon` of an SVG file. Only here is XML and the path syntax read.

use kurbo::{BezPath, PathEl, Point, Shape};
use roxmltree::{Document, Node};

use crate::geometry::c64;

/// Why a drawing holds no curve.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{fault}")]
pub struct DrawingError {
    /// Line, from 1; 0 where none is to blame.
    pub line: usize,
    /// Column in characters, from 1.
    pub column: usize,
    /// What is wrong there.
    pub fault: DrawingFault,
}

/// What is wrong with a drawing.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DrawingFault {
    /// The file is no XML.
    #[error("not SVG: {0}")]
    NotXml(String),
    /// No element to follow.
    #[error("the drawing has no path, polyline or polygon")]
    NoCurve,
    /// No element of the name asked for.
    #[error("no path, polyline or polygon has the id \"{0}\"")]
    NoSuchId(String),
    /// More than one element to follow.
    #[error("this is the second curve of the drawing, of {0}")]
    Several(usize),
    /// A path that cannot be read.
    #[error("the path cannot be read: {0}")]
    Path(String),
    /// A list of points that cannot be read.
    #[error("the points cannot be read: \"{0}\" is no number")]
    Points(String),
    /// A path of several pieces.
    #[error("the path jumps: it has {0} pieces")]
    Jumps(usize),
    /// A transform, which is not applied.
    #[error("the curve is transformed, and transforms are not applied")]
    Transformed,
    /// Fewer than two points.
    #[error("the curve has fewer than two points")]
    TooShort,
}

impl DrawingFault {
    /// What to do about it.
    pub const fn help(&self) -> &'static str {
        match self {
            Self::NotXml(_) => "save it as plain SVG",
            Self::NoCurve => {
                "draw a path, polyline or polygon; other shapes are not followed: convert them to paths"
            }
            Self::NoSuchId(_) => "name the id of one of them after '#', or draw just one and name none",
            Self::Several(_) => {
                "keep one, or name the id of the one that is meant, as in --along drawing.svg#route"
            }
            Self::Path(_) => {
                "commands are M, L, H, V, C, S, Q, T, A and Z, small or capital, each with its numbers"
            }
            Self::Points(_) => "write pairs of numbers, as in points=\"0,0 10,5\"",
            Self::Jumps(_) => "join its pieces: one M, at the beginning",
            Self::Transformed => "let the drawing program apply transforms to the path, or leave them out",
            Self::TooShort => "draw it longer",
        }
    }
}

/// A bent curve becomes straight pieces that are off by so much at most, as a share of its size.
const TOLERANCE: f64 = 1e-4;

/// Points of the curve in a drawing, y up as it is seen; in the drawing's units. `id`: which one, where there are several.
///
/// # Errors
/// [`DrawingError`] with its place.
pub fn drawing(text: &str, id: Option<&str>) -> Result<Vec<c64>, DrawingError> {
    let document = Document::parse(text).map_err(|error| {
        let at = error.pos();
        let (line, column) = (at.row as usize, at.col as usize);
        DrawingError { line, column, fault: DrawingFault::NotXml(error.to_string()) }
    })?;
    let curves: Vec<Node<'_, '_>> =
        document.descendants().filter(|node| is_curve(node) && is_drawn(node)).collect();
    let named = |name: &str| curves.iter().find(|node| node.attribute("id") == Some(name));
    let fault = |node: Option<&Node<'_, '_>>, fault: DrawingFault| {
        let at = node.map(|node| document.text_pos_at(node.range().start));
        let (line, column) = at.map_or((0, 0), |at| (at.row as usize, at.col as usize));
        DrawingError { line, column, fault }
    };
    let node = match (id, &curves[..]) {
        (Some(id), _) => named(id).ok_or_else(|| fault(None, DrawingFault::NoSuchId(id.to_owned())))?,
        (None, [only]) => only,
        (None, []) => return Err(fault(None, DrawingFault::NoCurve)),
        (None, [_, second, ..]) => return Err(fault(Some(second), DrawingFault::Several(curves.len()))),
    };
    if node.ancestors().any(|above| above.has_attribute("transform")) {
        return Err(fault(Some(node), DrawingFault::Transformed));
    }
    points(node).map_err(|found| fault(Some(node), found))
}

fn is_curve(node: &Node<'_, '_>) -> bool {
    node.is_element() && matches!(node.tag_name().name(), "path" | "polyline" | "polygon")
}

/// Whether an element is shown, and not only there to be used by others.
fn is_drawn(node: &Node<'_, '_>) -> bool {
    let hidden = ["defs", "symbol", "clipPath", "mask", "marker", "pattern"];
    !node.ancestors().any(|above| hidden.contains(&above.tag_name().name()))
}

fn points(node: &Node<'_, '_>) -> Result<Vec<c64>, DrawingFault> {
    let points = match node.tag_name().name() {
        "path" => path(node.attribute("d").unwrap_or_default())?,
        name => corners(node.attribute("points").unwrap_or_default(), name == "polygon")?,
    };
    let points: Vec<c64> = points.into_iter().map(|point| c64::new(point.x, -point.y)).collect();
    let sound = points.len() >= 2 && points.iter().all(|point| point.re.is_finite() && point.im.is_finite());
    if sound { Ok(points) } else { Err(DrawingFault::TooShort) }
}

fn path(data: &str) -> Result<Vec<Point>, DrawingFault> {
    let path = BezPath::from_svg(data).map_err(|error| DrawingFault::Path(error.to_string()))?;
    let pieces = path.elements().iter().filter(|element| matches!(element, PathEl::MoveTo(_))).count();
    if pieces > 1 {
        return Err(DrawingFault::Jumps(pieces));
    }
    let bounds = path.bounding_box();
    let size = bounds.width().hypot(bounds.height());
    if !(size > 0.0 && size.is_finite()) {
        return Err(DrawingFault::TooShort);
    }
    let mut points: Vec<Point> = Vec::new();
    kurbo::flatten(&path, size * TOLERANCE, |element| match element {
        PathEl::MoveTo(point) | PathEl::LineTo(point) => points.push(point),
        PathEl::ClosePath => points.extend(points.first().copied()),
        // Flattening leaves none of these.
        PathEl::QuadTo(..) | PathEl::CurveTo(..) => {}
    });
    Ok(points)
}

fn corners(text: &str, closed: bool) -> Result<Vec<Point>, DrawingFault> {
    let cells = text.split(|c: char| c == ',' || c.is_whitespace()).filter(|cell| !cell.is_empty());
    let number = |cell: &str| cell.parse().map_err(|_| DrawingFault::Points(cell.chars().take(40).collect()));
    let numbers: Vec<f64> = cells.map(number).collect::<Result<_, _>>()?;
    let mut points: Vec<Point> = numbers.chunks_exact(2).map(|pair| Point::new(pair[0], pair[1])).collect();
    if closed {
        points.extend(points.first().copied());
    }
    Ok(points)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn svg(inside: &str) -> String {
        format!("<svg xmlns=\"http://www.w3.org/2000/svg\">\n{inside}\n</svg>")
    }

    fn read(inside: &str) -> Result<Vec<c64>, DrawingError> {
        drawing(&svg(inside), None)
    }

    #[test]
    fn straight_lines_are_read_corner_by_corner_and_y_points_up() {
        let corners = Ok(vec![c64::new(0.0, 0.0), c64::new(4.0, 0.0), c64::new(4.0, -3.0)]);
        assert_eq!(read("<path d=\"M0 0 L4,0 4 3\"/>"), corners);
        assert_eq!(read("<path d=\"m 0 0 h 4 v 3\"/>"), corners);
        assert_eq!(read("<polyline points=\"0,0 4,0 4,3\"/>"), corners);
        let closed = read("<polygon points=\"0,0 4,0 4,3\"/>").expect("it is a curve");
        assert_eq!(read("<path d=\"M0 0 L4 0 L4 3 Z\"/>").expect("it is a curve"), closed);
        assert_eq!(closed[3], c64::new(0.0, 0.0));
    }

    #[test]
    fn bent_commands_stay_on_their_curves() {
        // A half circle of radius 5 about (5, 0), as an arc; cubics and quadratics end where they should.
        let arc = read("<path d=\"M0 0 A5 5 0 0 1 10 0\"/>").expect("it is a curve");
        assert!(arc.len() > 10);
        for point in &arc {
            // The tolerance on a box 10 wide and 5 high, and that of the cubics that kurbo makes of arcs, 0.1 in all.
            assert!(((*point - c64::new(5.0, 0.0)).norm() - 5.0).abs() < 0.1, "{point}");
        }
        assert!(arc.iter().all(|point| point.im > -1e-9), "up on the plan, as seen in the drawing");
        for data in ["M0 0 C0 4 4 4 4 0", "M0 0 Q2 4 4 0"] {
            let bent = read(&format!("<path d=\"{data}\"/>")).expect("it is a curve");
            assert!(bent.len() > 4 && (bent[bent.len() - 1] - c64::new(4.0, 0.0)).norm() < 1e-12);
        }
    }

    #[test]
    fn faults_tell_where_and_what_to_do() {
        let fault = |inside: &str| read(inside).expect_err("it is at fault");
        assert_eq!(fault("<rect/>").fault, DrawingFault::NoCurve);
        let several = fault("<path d=\"M0 0 1 1\"/>\n<path d=\"M0 0 1 1\"/>");
        assert_eq!((several.line, several.column, several.fault), (3, 1, DrawingFault::Several(2)));
        assert!(matches!(fault("<path d=\"M0 0 L\"/>").fault, DrawingFault::Path(_)));
        assert_eq!(fault("<path d=\"M0 0 1 1 M5 5 6 6\"/>").fault, DrawingFault::Jumps(2));
        assert_eq!(
            fault("<g transform=\"scale(2)\"><path d=\"M0 0 1 1\"/></g>").fault,
            DrawingFault::Transformed
        );
        assert_eq!(fault("<polyline points=\"0,0 x,1\"/>").fault, DrawingFault::Points("x".to_owned()));
        assert_eq!(fault("<path d=\"M0 0 0 0\"/>").fault, DrawingFault::TooShort);
        assert_eq!(fault("<polyline points=\"1 1\"/>").fault, DrawingFault::TooShort);
        let broken = drawing("<svg>\n</path>", None).expect_err("it is no XML");
        assert!(broken.line == 2 && matches!(broken.fault, DrawingFault::NotXml(_)));
    }

    #[test]
    fn one_of_several_is_chosen_by_id_and_what_only_others_use_does_not_count() {
        let text = svg(
            "<defs><path d=\"M0 0 9 9\"/></defs><path id=\"a\" d=\"M0 0 1 0\"/><path id=\"b\" d=\"M0 0 2 0\"/>",
        );
        assert_eq!(drawing(&text, Some("b")), Ok(vec![c64::new(0.0, 0.0), c64::new(2.0, 0.0)]));
        assert!(matches!(
            drawing(&text, Some("c")),
            Err(DrawingError { fault: DrawingFault::NoSuchId(_), .. })
        ));
    }

    proptest! {
        #[test]
        fn no_path_panics(data in "[MLHVCSQTAZmlhvcsqtaz0-9 ,.e-]{0,40}") {
            if let Ok(points) = read(&format!("<path d=\"M0 0{data}\"/>")) {
                prop_assert!(points.len() >= 2);
            }
        }
    }
}
