//! Bars of shares with intervals, longest names and all: a budget.

use plotters::element::Rectangle;
use plotters::style::Color;
use plotters::style::text_anchor::{HPos, VPos};

use super::chart::{Axis, BELOW_PX, chart, headed, heading_px, no_data};
use super::figure::{Canvas, Drawn, Figure};
use super::glyph::solid_line;
use super::style::{INK, TEXT_PX, VERMILION, line, px, text};

const WIDTH_PX: f64 = 420.0;
const MARGIN_PX: f64 = 14.0;
/// Height of a bar with its name above it.
const ROW_PX: f64 = 40.0;
const BAR_PX: f64 = 13.0;
/// Half height of the ends of an interval.
const TICK_PX: f64 = 4.0;

/// One bar.
#[derive(Clone, Debug, PartialEq)]
pub struct Bar {
    /// Its name.
    pub name: String,
    /// Its length, 0 to 1.
    pub share: f64,
    /// 95 % interval of that.
    pub interval: [f64; 2],
}

/// Draws bars, the first at the top, with an axis in per cent.
pub fn bars(title: &str, axis: &str, bars: &[Bar]) -> Figure {
    let body_px = bars.len().max(1) as f64 * ROW_PX + BELOW_PX;
    let height_px = heading_px(0) + body_px + 2.0 * MARGIN_PX;
    Figure::draw((WIDTH_PX + 2.0 * MARGIN_PX) as u32, height_px as u32, |canvas| {
        let inner = canvas.margin(px(MARGIN_PX), px(MARGIN_PX), px(MARGIN_PX), px(MARGIN_PX));
        draw(&headed(&inner, title, &[])?, axis, bars)
    })
}

fn draw(canvas: &Canvas, axis: &str, bars: &[Bar]) -> Drawn {
    if bars.is_empty() {
        return no_data(canvas);
    }
    let mut rows = Axis::new("", 0.0..bars.len() as f64, 1);
    rows.ticks.at.clear();
    let chart = chart(canvas, &Axis::new(axis, 0.0..100.0, 6), &rows)?;
    for (row, Bar { name, share, interval }) in bars.iter().enumerate() {
        let place = |share: f64| chart.place(100.0 * share.clamp(0.0, 1.0), (bars.len() - row) as f64);
        let (top, bottom) = (place(0.0).1 + px(ROW_PX - BAR_PX - 6.0), place(0.0).1 + px(ROW_PX - 6.0));
        let corners = [(place(0.0).0, top), (place(*share).0, bottom)];
        chart.canvas.draw(&Rectangle::new(corners, VERMILION.filled()))?;
        let middle = (top + bottom) / 2;
        let [low, high] = interval.map(|end| place(end).0);
        solid_line(&chart.canvas, &[(low, middle), (high, middle)], line(INK, 1.25))?;
        for end in [low, high] {
            solid_line(&chart.canvas, &[(end, middle - px(TICK_PX)), (end, middle + px(TICK_PX))], line(INK, 1.25))?;
        }
        let label = format!("{:.0} %  {name}", 100.0 * share);
        chart.canvas.draw_text(&label, &text(TEXT_PX, INK, HPos::Left, VPos::Bottom), (px(3.0), top - px(2.0)))?;
    }
    Ok(())
}
