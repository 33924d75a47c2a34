//! Charts of costs: both axes logarithmic, one line for each way to do the same thing.

use super::svg::{GREY, INK, Point, Rect, Sheet, TextStyle, number, title_of};
use crate::export::palette::colour;

/// What is drawn.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Chart {
    /// First line.
    pub title: String,
    /// Second line, smaller.
    pub subtitle: String,
    /// What is counted to the right, with its unit.
    pub x_label: String,
    /// What is counted upwards, with its unit.
    pub y_label: String,
    /// In the order of the legend.
    pub series: Vec<Series>,
    /// Below the legend, line by line.
    pub remarks: Vec<String>,
}

/// One line of a chart. Only points with two positive numbers are drawn.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Series {
    /// For the legend.
    pub name: String,
    /// Number of its colour; series with equal numbers have equal colours. None: grey.
    pub colour: Option<usize>,
    /// Dashed with open marks, else solid with filled ones.
    pub dashed: bool,
    /// Points that are joined, by rising x.
    pub line: Vec<[f64; 2]>,
    /// Points that stand alone.
    pub dots: Vec<[f64; 2]>,
}

const WIDTH: f64 = 940.0;
const HEIGHT: f64 = 560.0;
const FRAME: Rect = Rect { x: 78.0, y: 70.0, w: 600.0, h: 430.0 };
/// Left edge of the legend, px.
const LEGEND: f64 = 700.0;
/// Height of a line of the legend, px.
const LINE: f64 = 21.0;
/// Space between the outermost points and the frame, as a factor.
const ROOM: f64 = 1.6;

/// SVG of a chart, 940 px wide. Equal charts give equal text.
pub fn chart_svg(chart: &Chart) -> String {
    let mut sheet = Sheet::default();
    let scales = [Scale::of(chart, 0), Scale::of(chart, 1)];
    let heading = |size, colour| TextStyle { size, colour, anchor: "start", halo: false };
    sheet.text([FRAME.x, 32.0], heading(19.0, INK), &chart.title);
    sheet.text([FRAME.x, 53.0], heading(12.0, GREY), &chart.subtitle);
    draw_axes(&mut sheet, &scales, chart);
    for series in &chart.series {
        draw_series(&mut sheet, &scales, series);
    }
    draw_legend(&mut sheet, chart);
    let (width, height) = (number(WIDTH), number(HEIGHT));
    let size = format!(r#"width="{width}" height="{height}" viewBox="0 0 {width} {height}""#);
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" {size} font-family=\"{}\">\n{}\n\
         <rect width=\"{width}\" height=\"{height}\" fill=\"#ffffff\"/>\n{}</svg>\n",
        super::FONTS,
        title_of(&chart.title),
        sheet.body
    )
}

/// Powers of ten along one axis.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Scale {
    low: f64,
    high: f64,
}

impl Scale {
    /// Fits all points; one decade at least.
    fn of(chart: &Chart, axis: usize) -> Self {
        let points = chart.series.iter().flat_map(|series| series.line.iter().chain(&series.dots));
        let values = points.filter(|point| drawable(point)).map(|point| point[axis]);
        let (least, most) =
            values.fold((f64::INFINITY, 0.0_f64), |(least, most), v| (least.min(v), most.max(v)));
        let (least, most) = if least <= most { (least, most) } else { (1.0, 10.0) };
        let (low, high) = ((least / ROOM).log10(), (most * ROOM).log10());
        let lacking = (1.0 - (high - low)).max(0.0) / 2.0;
        Self { low: low - lacking, high: high + lacking }
    }

    /// 0 at the low end, 1 at the high end.
    fn share(&self, value: f64) -> f64 {
        (value.log10() - self.low) / (self.high - self.low)
    }

    /// Marks 1 to 9 times each power of ten within the scale; whether each is the power itself.
    fn marks(&self) -> Vec<(f64, bool)> {
        let mut marks = Vec::new();
        let mut power = self.low.floor();
        while power <= self.high {
            let decade = 10f64.powf(power);
            let multiples = (1..10).map(|k| (f64::from(k) * decade, k == 1));
            marks.extend(multiples.filter(|(mark, _)| (0.0..=1.0).contains(&self.share(*mark))));
            power += 1.0;
        }
        marks
    }
}

fn drawable(point: &[f64; 2]) -> bool {
    point.iter().all(|value| value.is_finite() && *value > 0.0)
}

fn place(scales: &[Scale; 2], [x, y]: [f64; 2]) -> Point {
    [FRAME.x + scales[0].share(x) * FRAME.w, FRAME.y + (1.0 - scales[1].share(y)) * FRAME.h]
}

fn draw_axes(sheet: &mut Sheet, scales: &[Scale; 2], chart: &Chart) {
    let bottom = FRAME.y + FRAME.h;
    let style = |anchor| TextStyle { size: 11.5, colour: GREY, anchor, halo: false };
    for (mark, whole) in scales[0].marks() {
        let x = FRAME.x + scales[0].share(mark) * FRAME.w;
        sheet.line([x, FRAME.y], [x, bottom], grid(whole));
        if whole {
            sheet.text([x, bottom + 18.0], style("middle"), &grouped(mark));
        }
    }
    for (mark, whole) in scales[1].marks() {
        let y = FRAME.y + (1.0 - scales[1].share(mark)) * FRAME.h;
        sheet.line([FRAME.x, y], [FRAME.x + FRAME.w, y], grid(whole));
        if whole {
            sheet.text([FRAME.x - 8.0, y + 4.0], style("end"), &grouped(mark));
        }
    }
    sheet.rect(FRAME, r##"fill="none" stroke="#9aa1a9" stroke-width="1""##);
    let style = TextStyle { size: 12.5, colour: INK, anchor: "middle", halo: false };
    sheet.text([FRAME.x + FRAME.w / 2.0, bottom + 42.0], style, &chart.x_label);
    let middle = FRAME.y + FRAME.h / 2.0;
    sheet.raw(&format!(r#"<g transform="translate(22 {}) rotate(-90)">"#, number(middle)));
    sheet.text([0.0, 0.0], style, &chart.y_label);
    sheet.close();
}

fn grid(whole: bool) -> &'static str {
    if whole { r##"stroke="#d5d9de" stroke-width="1""## } else { r##"stroke="#eef0f2" stroke-width="0.8""## }
}

/// A power of ten with its thousands apart, as many decimals as it needs.
fn grouped(mark: f64) -> String {
    if mark < 1.0 {
        let decimals = (1..12).find(|decimals| mark * 10f64.powi(*decimals) > 0.9).unwrap_or(12);
        return format!("{mark:.*}", usize::try_from(decimals).unwrap_or(0));
    }
    let digits = format!("{mark:.0}");
    let mut out = String::new();
    for (k, digit) in digits.chars().enumerate() {
        if k > 0 && (digits.len() - k).is_multiple_of(3) {
            out.push('\u{a0}');
        }
        out.push(digit);
    }
    out
}

/// sRGB of a series.
fn ink(series: &Series) -> String {
    series.colour.map_or(GREY.to_owned(), |index| {
        let [r, g, b] = colour(index);
        format!("rgb({r},{g},{b})")
    })
}

fn draw_series(sheet: &mut Sheet, scales: &[Scale; 2], series: &Series) {
    sheet.open("", &series.name);
    let placed = |points: &[[f64; 2]]| -> Vec<Point> {
        points.iter().filter(|point| drawable(point)).map(|point| place(scales, *point)).collect()
    };
    let line = placed(&series.line);
    if line.len() > 1 {
        sheet.polyline(&line, &pen(series));
    }
    line.iter().for_each(|at| draw_mark(sheet, *at, series, 3.4));
    placed(&series.dots).iter().for_each(|at| draw_mark(sheet, *at, series, 2.4));
    sheet.close();
}

fn pen(series: &Series) -> String {
    let dash = if series.dashed { r#" stroke-dasharray="6 4""# } else { "" };
    format!(r#"stroke="{}" stroke-width="1.8"{dash}"#, ink(series))
}

/// A cross for what is grey and has no line; else a disk, white inside if the line is dashed.
fn draw_mark(sheet: &mut Sheet, at: Point, series: &Series, radius: f64) {
    let own = ink(series);
    if series.colour.is_none() && series.line.is_empty() {
        let pen = format!(r#"stroke="{own}" stroke-width="1.6""#);
        let r = radius * 1.3;
        sheet.line([at[0] - r, at[1] - r], [at[0] + r, at[1] + r], &pen);
        sheet.line([at[0] - r, at[1] + r], [at[0] + r, at[1] - r], &pen);
        return;
    }
    let fill = if series.dashed { "#ffffff" } else { own.as_str() };
    sheet.circle(at, radius, &format!(r#"fill="{fill}" stroke="{own}" stroke-width="1.4""#));
}

fn draw_legend(sheet: &mut Sheet, chart: &Chart) {
    let style = |colour| TextStyle { size: 12.0, colour, anchor: "start", halo: false };
    let mut y = FRAME.y + LINE / 2.0;
    for series in &chart.series {
        if !series.line.is_empty() {
            sheet.polyline(&[[LEGEND, y], [LEGEND + 34.0, y]], &pen(series));
        }
        draw_mark(sheet, [LEGEND + 17.0, y], series, 3.4);
        sheet.text([LEGEND + 44.0, y + 4.2], style(INK), &series.name);
        y += LINE;
    }
    for remark in &chart.remarks {
        y += LINE * 0.85;
        sheet.text([LEGEND, y], TextStyle { size: 10.5, ..style(GREY) }, remark);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chart() -> Chart {
        let series = Series {
            name: "quick & <dirty>".to_owned(),
            colour: Some(0),
            line: vec![[2_000.0, 0.5], [200_000.0, 60.0]],
            dots: vec![[600.0, 0.0], [700.0, f64::NAN]],
            ..Series::default()
        };
        Chart { title: "Costs".to_owned(), series: vec![series], ..Chart::default() }
    }

    #[test]
    fn what_has_no_logarithm_is_left_out() {
        let svg = chart_svg(&chart());
        // Two marks on the line, one in the legend.
        assert_eq!(svg.matches("<circle").count(), 3);
        assert!(!svg.contains("NaN") && !svg.contains("inf"));
    }

    #[test]
    fn empty_chart_is_a_picture_still() {
        let png = super::super::to_png(&chart_svg(&Chart::default()), 200);
        assert!(png.is_ok_and(|bytes| !bytes.is_empty()));
    }

    #[test]
    fn marks_are_written_without_exponents() {
        assert_eq!(
            ["0.01", "1", "1\u{a0}000\u{a0}000"],
            [0.01, 1.0, 1e6].map(grouped).each_ref().map(String::as_str)
        );
    }
}
