//! A curve from a drawing: the one `path`, `polyline` or `polygon` that an SVG file shows, as it shows it. Only here is XML and the
//! path syntax read.

use kurbo::{Affine, BezPath, PathEl, Point, Shape};
use roxmltree::{Document, Node, ParsingOptions};
use svgtypes::NumberListParser;

use super::style::{Styles, Unknown};
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
    #[error("the drawing shows no path, polyline or polygon")]
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
    /// Half a point at the end of a list.
    #[error("the points cannot be read: {0} numbers are no pairs")]
    Odd(usize),
    /// A path of several pieces.
    #[error("the path jumps: it has {0} pieces")]
    Jumps(usize),
    /// The one asked for is hidden.
    #[error("the curve is hidden")]
    Hidden,
    /// A transform that is not understood.
    #[error("the curve is transformed by {property}: {value}, which is not understood", property = .0.property, value = .0.value)]
    Transformed(Unknown),
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
                "draw a path, polyline or polygon, and show it; other shapes are not followed: convert them to paths"
            }
            Self::NoSuchId(_) => "name the id of one of them after '#', or draw just one and name none",
            Self::Several(_) => {
                "keep one, or name the id of the one that is meant, as in --along drawing.svg#route"
            }
            Self::Path(_) => {
                "commands are M, L, H, V, C, S, Q, T, A and Z, small or capital, each with its numbers"
            }
            Self::Points(_) | Self::Odd(_) => "write pairs of numbers, as in points=\"0,0 10,5\"",
            Self::Jumps(_) => "join its pieces: one M, at the beginning",
            Self::Hidden => {
                "show it, or name another: its display, its visibility or that of a group above hides it"
            }
            Self::Transformed(_) => {
                "write it as transform with matrix, translate, scale, rotate, skewX or skewY, in pixels and degrees, or let the drawing program apply it to the path"
            }
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
    // Drawing programs write a document type; what it names outside the file is not read.
    let options = ParsingOptions { allow_dtd: true, ..ParsingOptions::default() };
    let document = Document::parse_with_options(text, options).map_err(|error| {
        let at = error.pos();
        let (line, column) = (at.row as usize, at.col as usize);
        DrawingError { line, column, fault: DrawingFault::NotXml(error.to_string()) }
    })?;
    let styles = Styles::of(&document);
    let all = || document.descendants().filter(|node| is_curve(node) && is_drawn(node));
    let curves: Vec<Node<'_, '_>> = all().filter(|node| styles.is_shown(node)).collect();
    let fault = |node: Option<&Node<'_, '_>>, fault: DrawingFault| {
        let at = node.map(|node| document.text_pos_at(node.range().start));
        let (line, column) = at.map_or((0, 0), |at| (at.row as usize, at.col as usize));
        DrawingError { line, column, fault }
    };
    let node = match (id, &curves[..]) {
        (Some(id), _) => {
            let named = all().find(|node| node.attribute("id") == Some(id));
            let node = named.ok_or_else(|| fault(None, DrawingFault::NoSuchId(id.to_owned())))?;
            if !curves.contains(&node) {
                return Err(fault(Some(&node), DrawingFault::Hidden));
            }
            node
        }
        (None, [only]) => *only,
        (None, []) => return Err(fault(all().next().as_ref(), DrawingFault::NoCurve)),
        (None, [_, second, ..]) => return Err(fault(Some(second), DrawingFault::Several(curves.len()))),
    };
    let transform =
        styles.transform(&node).map_err(|unknown| fault(Some(&node), DrawingFault::Transformed(unknown)))?;
    points(&node, transform).map_err(|found| fault(Some(&node), found))
}

fn is_curve(node: &Node<'_, '_>) -> bool {
    node.is_element() && matches!(node.tag_name().name(), "path" | "polyline" | "polygon")
}

/// Whether an element is shown, and not only there to be used by others.
fn is_drawn(node: &Node<'_, '_>) -> bool {
    let hidden = ["defs", "symbol", "clipPath", "mask", "marker", "pattern"];
    !node.ancestors().any(|above| hidden.contains(&above.tag_name().name()))
}

fn points(node: &Node<'_, '_>, transform: Affine) -> Result<Vec<c64>, DrawingFault> {
    let points = match node.tag_name().name() {
        "path" => path(node.attribute("d").unwrap_or_default(), transform)?,
        name => {
            let corners = corners(node.attribute("points").unwrap_or_default(), name == "polygon")?;
            corners.into_iter().map(|corner| transform * corner).collect()
        }
    };
    let points: Vec<c64> = points.into_iter().map(|point| c64::new(point.x, -point.y)).collect();
    let sound = points.len() >= 2 && points.iter().all(|point| point.re.is_finite() && point.im.is_finite());
    if sound { Ok(points) } else { Err(DrawingFault::TooShort) }
}

fn path(data: &str, transform: Affine) -> Result<Vec<Point>, DrawingFault> {
    let path = BezPath::from_svg(data).map_err(|error| DrawingFault::Path(error.to_string()))?;
    let pieces = path.elements().iter().filter(|element| matches!(element, PathEl::MoveTo(_))).count();
    if pieces > 1 {
        return Err(DrawingFault::Jumps(pieces));
    }
    let path = transform * path;
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
    let fault = |cell: &str| DrawingFault::Points(cell.chars().take(40).collect());
    // The first that is no number by itself is to blame; where each is, the list is.
    let to_blame = || {
        let mut cells = text.split(|c: char| c == ',' || c.is_whitespace()).filter(|cell| !cell.is_empty());
        fault(cells.find(|cell| !cell.parse().is_ok_and(f64::is_finite)).unwrap_or(text))
    };
    let numbers: Vec<f64> = NumberListParser::from(text).collect::<Result<_, _>>().map_err(|_| to_blame())?;
    if numbers.len() % 2 == 1 {
        return Err(DrawingFault::Odd(numbers.len()));
    }
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
        // Signs and points part numbers, too.
        let close = Ok(vec![c64::new(10.0, 5.0), c64::new(3.0, 2.0), c64::new(1.5, -0.5)]);
        assert_eq!(read("<polyline points=\"10-5 3-2 1.5.5\"/>"), close);
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
        assert_eq!(fault("<polyline points=\"0,0 x,1\"/>").fault, DrawingFault::Points("x".to_owned()));
        assert_eq!(fault("<polyline points=\"0,0 NaN,1\"/>").fault, DrawingFault::Points("NaN".to_owned()));
        assert_eq!(fault("<polyline points=\"0,0 5,1 7\"/>").fault, DrawingFault::Odd(5));
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

    #[test]
    fn transforms_of_the_curve_and_of_groups_are_applied_wherever_they_are_written() {
        let turned = Ok(vec![c64::new(20.0, -10.0), c64::new(20.0, -14.0)]);
        let line = "d=\"M0 0 L2,0\"";
        for inside in [
            format!("<path {line} transform=\"translate(20 10) rotate(90) scale(2)\"/>"),
            format!(
                "<g transform=\"translate(20,10)\"><path {line} transform=\"matrix(0 2 -2 0 0 0)\"/></g>"
            ),
            format!("<path {line} style=\"transform: translate(20px, 10px) rotate(90deg) scale(2)\"/>"),
            format!(
                "<style>.way {{ transform: translate(20px, 10px) rotate(90deg) scale(2) }}</style><path class=\"way\" {line}/>"
            ),
            format!(
                "<style>g > path {{ transform: none }} #way {{ transform: scale(2) }}</style>\n<g style=\"transform:translate(20px,10px) rotate(90deg)\"><path id=\"way\" {line} transform=\"scale(9)\"/></g>"
            ),
        ] {
            let read = read(&inside).map(|points| {
                points.iter().map(|point| c64::new(point.re.round(), point.im.round())).collect::<Vec<_>>()
            });
            assert_eq!(read, turned, "{inside}");
        }
        let corners = read("<polyline transform=\"scale(1, 2)\" points=\"0,0 4,3\"/>");
        assert_eq!(corners, Ok(vec![c64::new(0.0, 0.0), c64::new(4.0, -6.0)]));
    }

    #[test]
    fn transforms_that_are_not_understood_are_refused() {
        for inside in [
            "<path d=\"M0 0 1 1\" style=\"transform: rotate(0.2turn)\"/>",
            "<path d=\"M0 0 1 1\" style=\"transform: translate(10%)\"/>",
            "<path d=\"M0 0 1 1\" style=\"rotate: 20deg\"/>",
            "<g style=\"transform-origin: center\" transform=\"rotate(9)\"><path d=\"M0 0 1 1\"/></g>",
            "<path d=\"M0 0 1 1\" transform=\"turn(2)\"/>",
        ] {
            let error = read(inside).expect_err("it is at fault");
            assert!(
                error.line == 2 && matches!(error.fault, DrawingFault::Transformed(_)),
                "{inside}: {error}"
            );
        }
    }

    #[test]
    fn what_is_hidden_is_not_followed() {
        let shown = "<path d=\"M0 0 2 0\"/>";
        let hidden = "d=\"M0 0 9 9\"";
        for inside in [
            format!("<path {hidden} display=\"none\"/>"),
            format!("<path {hidden} style=\"display:none\"/>"),
            format!("<g style=\"visibility: hidden\"><path {hidden}/></g>"),
            format!("<style>.off {{ display: none }}</style><g class=\"off\"><path {hidden}/></g>"),
        ] {
            let both = read(&format!("{inside}{shown}"));
            assert_eq!(both, Ok(vec![c64::new(0.0, 0.0), c64::new(2.0, 0.0)]), "{inside}");
            assert_eq!(read(&inside).expect_err("nothing is shown").fault, DrawingFault::NoCurve);
        }
        let named = drawing(&svg(&format!("<path id=\"a\" display=\"none\" {hidden}/>{shown}")), Some("a"));
        let error = named.expect_err("it is hidden");
        assert_eq!((error.line, error.fault), (2, DrawingFault::Hidden));
        assert!(read("<g visibility=\"hidden\"><path visibility=\"visible\" d=\"M0 0 2 0\"/></g>").is_ok());
    }

    #[test]
    fn a_document_type_does_no_harm() {
        let head = "<?xml version=\"1.0\"?>\n<!DOCTYPE svg PUBLIC \"-//W3C//DTD SVG 1.1//EN\" \"http://www.w3.org/Graphics/SVG/1.1/DTD/svg11.dtd\">\n";
        let text = format!("{head}{}", svg("<path d=\"M0 0 2 0\"/>"));
        assert_eq!(drawing(&text, None), Ok(vec![c64::new(0.0, 0.0), c64::new(2.0, 0.0)]));
    }

    proptest! {
        #[test]
        fn no_style_panics(style in "[a-z0-9:;(){}., %#!/*-]{0,60}") {
            let _ = read(&format!("<style>{style}</style><path style=\"{style}\" transform=\"{style}\" d=\"M0 0 1 1\"/>"));
        }

        #[test]
        fn no_path_panics(data in "[MLHVCSQTAZmlhvcsqtaz0-9 ,.e-]{0,40}") {
            if let Ok(points) = read(&format!("<path d=\"M0 0{data}\"/>")) {
                prop_assert!(points.len() >= 2);
            }
        }
    }
}
