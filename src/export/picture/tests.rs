//! What a picture promises.

use proptest::prelude::*;
use resvg::tiny_skia::Pixmap;
use resvg::usvg::{Options, Tree};

use super::*;

/// Motion of one actor: rest path, edited path, headings, times.
struct Motion {
    rest: Vec<c64>,
    edited: Vec<c64>,
    headings: Vec<f64>,
    times: Vec<f64>,
}

/// Walks along arcs of their own, `frames` long.
fn motions(count: u32, frames: u32) -> Vec<Motion> {
    let angle = |k: u32, frame: u32| f64::from(k) * 2.4 + f64::from(frame) * 0.01;
    let place = |k: u32, frame: u32| {
        let radius = 2.0 + f64::from(k).sqrt();
        c64::from_polar(radius, angle(k, frame))
    };
    let motion = |k: u32| Motion {
        rest: (0..frames).map(|frame| place(k, frame) + c64::new(0.3, 0.2)).collect(),
        edited: (0..frames).map(|frame| place(k, frame)).collect(),
        headings: (0..frames).map(|frame| angle(k, frame) + std::f64::consts::FRAC_PI_2).collect(),
        times: (0..frames).map(|frame| f64::from(frame + k) / 30.0).collect(),
    };
    (0..count).map(motion).collect()
}

fn picture<'a>(motions: &'a [Motion], names: &'a [String]) -> Picture<'a> {
    let actors = motions.iter().zip(names).map(|(motion, name)| Actor {
        name,
        rest: &motion.rest,
        edited: &motion.edited,
        headings: &motion.headings,
        times: &motion.times,
        clips: vec![("walk <fast>".to_owned(), 0, motion.times.len() / 2), ("stand".to_owned(), 50, 99)],
        stationary: vec![(60, 90)],
    });
    let handle = |actor, frame, partner: Option<(usize, f64)>| Handle {
        actor,
        frame,
        target: Some(c64::new(1.0, -2.0)).filter(|_| partner.is_none()),
        facing: Some(0.5),
        hard: actor == 0,
        name: format!("hold & keep {actor}"),
        partner,
        dragged_from: Some(c64::new(-1.0, 0.5)).filter(|_| actor == 0),
    };
    let tie = |pinned| Tie { points: vec![(1, 2.5), (0, 2.0)], name: "at \"once\"".to_owned(), pinned };
    let object = PictureObject {
        name: "tea < table",
        size: [1.5, 0.8, 0.7],
        poses: (0..9).map(|k| ObjectPose::on_ground(c64::new(0.5, 0.2 * f64::from(k)), 0.4)).collect(),
        grasped: vec![c64::new(0.5, 0.2)],
        released: vec![c64::new(0.5, f64::NAN), c64::new(0.5, 1.6)],
    };
    Picture {
        title: "Tea & <cake>",
        actors: actors.collect(),
        objects: vec![object],
        handles: vec![handle(0, 3.5, None), handle(1, 1e9, None), handle(0, 40.0, Some((1, 30.25)))],
        ties: vec![tie(false), tie(true)],
        clock: (0.0, 4.0),
    }
}

fn names(count: u32) -> Vec<String> {
    (0..count).map(|k| format!("actor <{k}> & co")).collect()
}

/// Parses as SVG and holds no number that is none.
fn check(svg: &str) -> Result<(), TestCaseError> {
    prop_assert!(!svg.contains("NaN") && !svg.contains("inf"), "not a number");
    prop_assert!(Tree::from_str(svg, &Options::default()).is_ok(), "no SVG");
    Ok(())
}

#[test]
fn every_name_is_there_and_escaped() {
    for count in [2, 12, 60] {
        let (motions, names) = (motions(count, 120), names(count));
        let svg = to_svg(&picture(&motions, &names));
        check(&svg).expect("a picture");
        check(&animated_svg(&picture(&motions, &names))).expect("a picture in motion");
        for name in names.iter().map(String::as_str).chain([
            "Tea & <cake>",
            "tea < table",
            "hold & keep 0",
            "at \"once\"",
        ]) {
            assert!(svg.contains(&svg::escaped(name)), "{name}");
            assert!(!svg.contains(name), "{name} is not escaped");
        }
    }
}

#[test]
fn equal_pictures_are_equal_files() {
    let (motions, names) = (motions(5, 200), names(5));
    assert_eq!(to_svg(&picture(&motions, &names)), to_svg(&picture(&motions, &names)));
}

#[test]
fn nobody_and_nothing_is_a_picture() {
    check(&to_svg(&Picture::default())).expect("a picture");
    let (motions, names) = (motions(3, 0), names(3));
    check(&to_svg(&picture(&motions, &names))).expect("actors without frames");
}

#[test]
fn names_of_control_characters_stay_xml() {
    let (motions, names) = (motions(2, 10), vec!["\u{0}\n\u{7}".to_owned(), String::new()]);
    check(&to_svg(&picture(&motions, &names))).expect("a picture");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Points that coincide, lie far out, are tiny or no numbers: still a picture.
    #[test]
    fn degenerate_motion_is_a_picture(
        frames in 1_u32..5,
        scale in prop::sample::select(vec![0.0, 1e-300, 1e-9, 1.0, 1e9, 1e300, f64::INFINITY, f64::NAN]),
        offset in prop::sample::select(vec![0.0, -1e11, 1e15, f64::NEG_INFINITY]),
        time_scale in prop::sample::select(vec![0.0, 1e-12, 1e11, f64::NAN]),
    ) {
        let (mut motions, names) = (motions(3, frames), names(3));
        for motion in &mut motions {
            let moved = |p: &c64| c64::new(p.re * scale + offset, p.im * scale);
            motion.edited = motion.edited.iter().map(moved).collect();
            motion.times.iter_mut().for_each(|time| *time *= time_scale);
            motion.headings.iter_mut().for_each(|heading| *heading *= scale);
        }
        check(&to_svg(&picture(&motions, &names)))?;
        check(&animated_svg(&picture(&motions, &names)))?;
    }
}

#[test]
fn hundreds_of_actors_are_a_picture() {
    let (motions, names) = (motions(300, 90), names(300));
    let svg = to_svg(&picture(&motions, &names));
    check(&svg).expect("a picture");
    check(&animated_svg(&picture(&motions, &names))).expect("a picture in motion");
    assert!(svg.len() < 300 * BYTES_OF_ONE, "{} bytes", svg.len());
    assert!(names.iter().all(|name| svg.contains(&svg::escaped(name))), "everybody can be pointed at");
}

/// Of an actor among hundreds, with its share of grid and legend.
const BYTES_OF_ONE: usize = 300;

/// Whoever stands still has two keyframes, and whoever moves is where they are at those that are left.
#[test]
fn a_picture_in_motion_has_the_keyframes_it_needs() {
    let names = names(2);
    let animated = |x: fn(f64) -> f64| {
        let times: Vec<f64> = (0..90).map(|k| f64::from(k) / 30.0).collect();
        let edited = times.iter().map(|time| c64::new(x(*time), 0.0)).collect();
        let motion = [Motion { rest: Vec::new(), edited, headings: vec![0.5; 90], times }];
        animated_svg(&Picture { objects: Vec::new(), ties: Vec::new(), ..picture(&motion, &names) })
    };
    let keys = |svg: &str, kind: &str| {
        let own = svg
            .split("<animateTransform")
            .skip(1)
            .find(|own| own.contains(kind))
            .expect("everybody is animated");
        let values = own.split("values=\"").nth(1).and_then(|own| own.split('"').next()).expect("values");
        values.split(';').count()
    };
    let (still, straight) = (animated(|_| 1.0), animated(|time| time));
    assert_eq!((keys(&still, "translate"), keys(&still, "rotate")), (2, 2));
    // Where it begins and ends, and the end once more while the picture pauses.
    assert_eq!((keys(&straight, "translate"), keys(&straight, "rotate")), (3, 2));
}

#[test]
fn png_is_as_wide_as_asked_and_not_blank() {
    let (motions, names) = (motions(4, 150), names(4));
    let png = to_png(&to_svg(&picture(&motions, &names)), 640).expect("a PNG");
    let pixmap = Pixmap::decode_png(&png).expect("a PNG");
    assert_eq!(pixmap.width(), 640);
    let dark = pixmap.pixels().iter().filter(|pixel| pixel.red() < 100).count();
    assert!(dark > 500, "{dark} dark pixels");
}

#[test]
fn text_needs_no_font() {
    let text = |text: &str| {
        let body = format!(r##"<text x="10" y="30" font-size="20" fill="#000000">{text}</text>"##);
        let svg = format!(r#"<svg xmlns="http://www.w3.org/2000/svg" width="200" height="40">{body}</svg>"#);
        let pixmap = Pixmap::decode_png(&to_png(&svg, 200).expect("a PNG")).expect("a PNG");
        pixmap.pixels().iter().filter(|pixel| pixel.red() < 128).count()
    };
    assert_eq!(text(" "), 0);
    assert!(text("Hello 42 &amp; é") > 300);
    let blank: Vec<char> =
        ('!'..='~').filter(|letter| text(&svg::escaped(&letter.to_string())) == 0).collect();
    assert!(blank.is_empty(), "{blank:?}");
}

#[test]
fn a_png_without_pixels_is_refused() {
    let svg = to_svg(&Picture::default());
    assert!(matches!(to_png(&svg, 0), Err(PictureError::Size { width: 0, .. })));
    assert!(matches!(to_png(&svg, u32::MAX), Err(PictureError::Size { .. })));
    assert!(matches!(to_png("no picture", 100), Err(PictureError::Xml(_))));
    assert!(matches!(to_png("<p/>", 100), Err(PictureError::Svg(_))));
}
