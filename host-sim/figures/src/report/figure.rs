//! A finished drawing.

use super::chart::{heading, heading_px};
use super::legend::{self, Entry};
use super::style::{FONTS, WHITE};
use super::svg::{Area, Svg};

/// Width of a figure with one chart, px: its letters can still be read on a phone.
pub const CHART_PX: f64 = 400.0;
/// Margin on all sides of a figure, px.
pub const MARGIN_PX: f64 = 8.0;
/// Pixels of a page per px of a figure where there is room for them, so that letters are about as large as the page's.
const PAGE_SCALE: f64 = 1.3;

/// A picture.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Figure {
    /// As a document of its own.
    pub(super) svg: String,
    elements: String,
    pub(super) width_px: u32,
    pub(super) height_px: u32,
}

impl Figure {
    /// Draws into a space of this size, px, with a margin around it and a legend below.
    pub(super) fn draw(width_px: f64, height_px: f64, entries: &[Entry], draw: impl FnOnce(&mut Svg, Area)) -> Self {
        let all_px = height_px + legend::height_px(entries, width_px);
        let inner = Area { left: MARGIN_PX, top: MARGIN_PX, width: width_px, height: all_px };
        let (space, strip) = inner.split_down(height_px);
        let mut svg = Svg::default();
        draw(&mut svg, space);
        legend::draw(&mut svg, strip, entries);
        Self::of(svg, width_px + 2.0 * MARGIN_PX, all_px + 2.0 * MARGIN_PX)
    }

    /// Draws one chart with a title, which may be empty, and a body of this height.
    pub(super) fn chart(title: &str, body_px: f64, entries: &[Entry], draw: impl FnOnce(&mut Svg, Area)) -> Self {
        let width_px = CHART_PX - 2.0 * MARGIN_PX;
        Self::draw(width_px, heading_px(title, 0) + body_px, entries, |svg, space| {
            let body = heading(svg, space, title, &[]);
            draw(svg, body);
        })
    }

    fn of(Svg { elements }: Svg, width_px: f64, height_px: f64) -> Self {
        let (width, height) = (libm::ceil(width_px) as u32, libm::ceil(height_px) as u32);
        let svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
             viewBox=\"0 0 {width} {height}\" font-family=\"{FONTS}\">\n\
             <rect width=\"{width}\" height=\"{height}\" fill=\"{WHITE}\"/>\n{elements}</svg>\n"
        );
        Figure { svg, elements, width_px: width, height_px: height }
    }

    /// The picture as an SVG document. Its text prefers Noto Sans and falls back to any sans-serif.
    pub fn svg(&self) -> &str {
        &self.svg
    }

    /// The picture as an element of a page, whose style sheet sets fonts and, in the dark, colours. Assistive technology
    /// ignores it: the page describes it in words.
    pub fn in_page(&self) -> String {
        let Figure { elements, width_px: width, height_px: height, .. } = self;
        let [wide, high] = [width, height].map(|px| libm::round(PAGE_SCALE * f64::from(*px)));
        format!(
            "<svg width=\"{wide}\" height=\"{high}\" viewBox=\"0 0 {width} {height}\" aria-hidden=\"true\">\n{elements}</svg>"
        )
    }
}
