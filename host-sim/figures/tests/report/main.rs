//! The figures as files: well-formed, complete, the same every time, and calm about data that are missing or broken.

mod synthetic;

use glam::{DVec2, DVec3};
use mindgap_figures::report::expected_against_predicted::{Panel, Samples};
use mindgap_figures::report::paths::{PathPanel, Trace};
use mindgap_figures::report::sonar_surfaces::Surface;
use mindgap_figures::report::{Figure, expected_against_predicted, paths, sonar_surfaces};
use mindgap_foundations::geometry::{Pose, Wall};
use mindgap_logs::Scene;
use proptest::prelude::*;
use resvg::tiny_skia::Pixmap;
use resvg::usvg::roxmltree::{Document, Node};

const BLUE: &str = "#0072B2";
const VERMILION: &str = "#D55E00";
const OBSTACLE: &str = "#C9CED4";
const INK: &str = "#1D2227";

/// How many elements of a kind have all these attributes, of their own or from a group.
fn count(figure: &Figure, tag: &str, attributes: &[(&str, &str)]) -> usize {
    elements(&Document::parse(figure.svg()).expect("well-formed"), tag, attributes).len()
}

fn elements<'d>(document: &'d Document, tag: &str, attributes: &[(&str, &str)]) -> Vec<Node<'d, 'd>> {
    let fits = |node: &Node| {
        let inherited = |name: &str| node.ancestors().find_map(|element| element.attribute(name));
        node.has_tag_name(tag) && attributes.iter().all(|(name, value)| inherited(name) == Some(value))
    };
    document.descendants().filter(fits).collect()
}

fn says(figure: &Figure, words: &str) -> usize {
    let document = Document::parse(figure.svg()).expect("well-formed");
    elements(&document, "text", &[]).iter().filter(|t| t.text().unwrap_or_default().trim() == words).count()
}

#[test]
fn every_sample_of_figure_2_is_marked() {
    let figure = expected_against_predicted(&synthetic::networks());
    // Three networks of 500, 1460 readings within the frame, ten bins, two marks of the legend.
    assert_eq!(count(&figure, "circle", &[("fill", BLUE)]), 3 * 500 + 1460 + 10 + 2);
    // The wild prediction, and its mark in the legend.
    assert_eq!(count(&figure, "polygon", &[]), 2);
    assert_eq!(says(&figure, "n = 1461, 1 beyond the frame, 1 not drawable"), 1);
    assert_eq!(says(&figure, "n = 1700"), 1);
}

#[test]
fn figure_2_states_the_trend() {
    let pairs = (0..20).map(|i| DVec2::new(f64::from(i), 0.5 * f64::from(i) - 2.0)).collect();
    let samples = Samples::Values { unit: "cm".into(), pairs };
    let figure = expected_against_predicted(&[Panel { title: "a".into(), samples }]);
    assert_eq!(says(&figure, "slope 0.500, intercept −2.000, R² 1.000"), 1);
}

#[test]
fn every_cell_and_sample_of_figure_3_is_drawn_in_both_views() {
    let figure = sonar_surfaces(&synthetic::surfaces());
    assert_eq!(count(&figure, "polygon", &[]), 2 * 24 * 24);
    // A halo and a rimmed disc for every sample, twice, and once in the legend.
    assert_eq!(count(&figure, "circle", &[]), 2 * (2 * 2 * 160 + 1));
}

#[test]
fn figure_4_shows_every_path_crash_and_obstacle() {
    let figure = paths(&synthetic::starts());
    // Twelve real paths, three of them in two pieces, and the legend's.
    assert_eq!(count(&figure, "polyline", &[("stroke", VERMILION), ("stroke-width", "1.5")]), 12 + 3 + 1);
    // Two crashes of two strokes.
    assert_eq!(count(&figure, "polyline", &[("stroke", VERMILION), ("stroke-width", "2")]), 2 * 2);
    assert_eq!(count(&figure, "rect", &[("fill", OBSTACLE)]), 4 * 4);
    assert_eq!(count(&figure, "polygon", &[]), 4 + 1);
}

#[test]
fn figure_4_has_equal_scales() {
    let figure = paths(&synthetic::starts());
    let document = Document::parse(figure.svg()).unwrap();
    for obstacle in elements(&document, "rect", &[("fill", OBSTACLE)]).chunks(4).map(|panel| panel[0]) {
        let side = |name: &str| obstacle.attribute(name).unwrap().parse::<f64>().unwrap();
        // The first obstacle is 40 cm by 25 cm; sides are rounded to tenths of a pixel.
        assert!((side("width") / 40.0 - side("height") / 25.0).abs() < 0.01);
    }
}

#[test]
fn the_png_is_the_svg_at_three_times_its_size_and_has_letters() {
    for figure in [expected_against_predicted(&[]), paths(&synthetic::starts()[..1])] {
        let document = Document::parse(figure.svg()).unwrap();
        let side = |name: &str| document.root_element().attribute(name).unwrap().parse::<u32>().unwrap();
        let pixels = Pixmap::decode_png(&figure.png()).unwrap();
        assert_eq!((pixels.width(), pixels.height()), (3 * side("width"), 3 * side("height")));
        assert!(pixels.pixels().iter().any(|p| p.red() < 128), "the sheet is blank");
        assert!(pixels.pixels().iter().all(|p| p.alpha() == 255));
    }
}

#[test]
fn the_same_data_give_the_same_bytes() {
    let twice = |figure: fn() -> Figure| assert_eq!(figure(), figure());
    twice(|| expected_against_predicted(&synthetic::networks()));
    twice(|| sonar_surfaces(&synthetic::surfaces()));
    twice(|| paths(&synthetic::starts()));
    let small = paths(&synthetic::starts()[..1]);
    assert_eq!(small.png(), small.png());
}

#[test]
fn both_files_are_written_or_a_reason_is_given() {
    let folder = tempfile::tempdir().unwrap();
    let figure = paths(&synthetic::starts()[..1]);
    figure.write(folder.path(), "paths").unwrap();
    assert_eq!(std::fs::read_to_string(folder.path().join("paths.svg")).unwrap(), figure.svg());
    assert_eq!(std::fs::read(folder.path().join("paths.png")).unwrap(), figure.png());
    let missing = figure.write(&folder.path().join("missing"), "paths").unwrap_err();
    assert!(missing.to_string().contains("paths.svg: cannot be written"), "{missing}");
}

#[test]
fn without_panels_a_figure_says_so() {
    for figure in [expected_against_predicted(&[]), sonar_surfaces(&[]), paths(&[])] {
        assert_eq!(says(&figure, "no data"), 1);
    }
}

#[test]
fn panels_without_sound_data_say_so() {
    let nan = DVec2::NAN;
    let values = |pairs| Panel { title: "v".into(), samples: Samples::Values { unit: "cm".into(), pairs } };
    let events = |events| Panel { title: "e".into(), samples: Samples::Events(events) };
    let panels = [values(vec![]), values(vec![nan, nan]), events(vec![]), events(vec![(f64::NAN, true), (1.5, true)])];
    let figure = expected_against_predicted(&panels);
    assert_eq!(says(&figure, "no data"), 4);
    assert_eq!(says(&figure, "n = 0, 2 not drawable"), 1);
    assert_eq!(says(&figure, "n = 0, 2 not in 0..1"), 1);

    let lost = Trace { points_cm: vec![nan, nan], crashed: true };
    let panel = PathPanel {
        title: "p".into(),
        scene: Scene::default(),
        start: Pose::new(0.0, 0.0, 0.0),
        target_radius_cm: 10.0,
        simulated: vec![],
        real: vec![lost],
    };
    assert_eq!(says(&paths(&[panel]), "no data"), 1);
}

#[test]
fn non_finite_surface_values_are_left_out() {
    let half = |distance_cm: f64, _| if distance_cm < 50.0 { f64::NAN } else { f64::INFINITY };
    let surface = |value| Surface {
        title: "s".into(),
        value_name: "v".into(),
        at: Box::new(half),
        known: Box::new(|_, _| true),
        distance_cm: 0.0..100.0,
        incidence_deg: 0.0..90.0,
        value,
        test: vec![DVec3::new(10.0, 10.0, f64::NAN), DVec3::new(101.0, 10.0, 1.0), DVec3::new(60.0, 10.0, 1.0)],
    };
    let figure = sonar_surfaces(&[surface(0.0..1.0), surface(1.0..1.0)]);
    assert_eq!(count(&figure, "polygon", &[]), 12 * 24);
    assert_eq!(count(&figure, "circle", &[]), 2 * (2 + 1));
    assert_eq!(says(&figure, "no data"), 1);
}

#[test]
fn a_map_of_bare_walls_is_drawn() {
    let wall = |x0, y0, x1, y1| Wall { from_cm: DVec2::new(x0, y0), to_cm: DVec2::new(x1, y1) };
    let panel = PathPanel {
        scene: Scene { walls: vec![wall(-20.0, 0.0, 0.0, 168.0), wall(0.0, 168.0, 90.0, 168.0)], ..Scene::default() },
        ..synthetic::starts().remove(1)
    };
    let figure = paths(&[panel]);
    assert_eq!(count(&figure, "polyline", &[("stroke", INK), ("stroke-width", "1.5")]), 2);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]
    #[test]
    fn no_numbers_break_a_figure(raw in prop::collection::vec((any::<f64>(), any::<f64>()), 0..12)) {
        let points: Vec<DVec2> = raw.iter().copied().map(DVec2::from).collect();
        let values = Samples::Values { unit: "cm".into(), pairs: points.clone() };
        let events = Samples::Events(raw.iter().map(|(p, q)| (*p, *q > 0.0)).collect());
        let panels = [values, events].map(|samples| Panel { title: "p".into(), samples });
        let trace = Trace { points_cm: points.clone(), crashed: true };
        let panel = PathPanel { real: vec![trace.clone()], simulated: vec![trace], ..synthetic::starts().remove(0) };
        let test = raw.iter().map(|(x, y)| DVec3::new(*x, *y, *x)).collect();
        let surface = Surface { test, ..synthetic::surfaces().remove(0) };
        for figure in [expected_against_predicted(&panels), paths(&[panel]), sonar_surfaces(&[surface])] {
            prop_assert!(Document::parse(figure.svg()).is_ok());
        }
    }
}
