//! The surface as colours on the plane of distance and angle.

use plotters::element::Rectangle;
use plotters::style::text_anchor::{HPos, VPos};
use plotters::style::{Color, FontTransform};

use super::{ROW_PX, Surface, colour};
use crate::report::chart::{BELOW_PX, chart};
use crate::report::figure::{Canvas, Drawn};
use crate::report::glyph::{Place, bead, solid_line};
use crate::report::style::{FAINT, GREY, INK, SMALL_PX, TEXT_PX, line, px, text};

const COLUMNS: usize = 60;
const ROWS: usize = 45;
/// Margin for the colour scale right of the map, px.
const SCALE_PX: f64 = 88.0;
const BAR_PX: f64 = 12.0;
const BAR_STEPS: i32 = 64;

pub fn draw(canvas: &Canvas, surface: &Surface) -> Drawn {
    let (width, _) = canvas.dim_in_pixel();
    let (map, scale) = canvas.split_horizontally(width as i32 - px(SCALE_PX));
    draw_map(&map, surface)?;
    draw_scale(&scale, surface)
}

fn draw_map(canvas: &Canvas, surface: &Surface) -> Drawn {
    let chart = chart(canvas, &surface.distance_axis(), &surface.incidence_axis())?;
    let (width, height) = chart.canvas.dim_in_pixel();
    let at = |share: f64, length: u32| libm::round(share * f64::from(length)) as i32;
    for row in 0..ROWS {
        for column in 0..COLUMNS {
            let share = |cell: usize, of: usize| (cell as f64 + 0.5) / of as f64;
            let (distance, incidence) = (share(column, COLUMNS), 1.0 - share(row, ROWS));
            let Some(value) = surface.share_of_value(surface.at_share(distance, incidence)) else { continue };
            let edge = |cell: usize, of: usize, length: u32| at(cell as f64 / of as f64, length);
            let low = (edge(column, COLUMNS, width), edge(row, ROWS, height));
            // A pixel of overlap with the next cell keeps white from shining through the seam.
            let high = (edge(column + 1, COLUMNS, width), edge(row + 1, ROWS, height));
            let high = ((high.0 + px(1.0)).min(width as i32), (high.1 + px(1.0)).min(height as i32));
            if surface.is_known_at(distance, incidence) {
                chart.canvas.draw(&Rectangle::new([low, high], colour(value).filled()))?;
            } else {
                hatched(&chart.canvas, [low, high])?;
            }
        }
    }
    for sample in surface.test_shares() {
        let place = (at(sample.x, width), at(1.0 - sample.y, height));
        bead(&chart.canvas, place, colour(sample.z))?;
    }
    Ok(())
}

/// A cell without data.
pub fn hatched(canvas: &Canvas, [low, high]: [Place; 2]) -> Drawn {
    canvas.draw(&Rectangle::new([low, high], FAINT.filled()))?;
    solid_line(canvas, &[(low.0, high.1), (high.0, low.1)], line(GREY, 0.5))
}

/// Whether a cell of the map has no data.
pub fn has_gaps(surface: &Surface) -> bool {
    let share = |cell: usize, of: usize| (cell as f64 + 0.5) / of as f64;
    (0..ROWS).any(|row| (0..COLUMNS).any(|column| !surface.is_known_at(share(column, COLUMNS), share(row, ROWS))))
}

/// A bar with all colours of the scale and their values.
fn draw_scale(canvas: &Canvas, surface: &Surface) -> Drawn {
    let (left, right, height) = (px(16.0), px(16.0 + BAR_PX), px(ROW_PX) - px(BELOW_PX));
    for step in 0..BAR_STEPS {
        let edge = |step: i32| height - height * step / BAR_STEPS;
        let share = (f64::from(step) + 0.5) / f64::from(BAR_STEPS);
        let corners = [(left, edge(step + 1)), (right, (edge(step) + px(1.0)).min(height))];
        canvas.draw(&Rectangle::new(corners, colour(share).filled()))?;
    }
    let axis = surface.value_axis();
    let style = text(SMALL_PX, INK, HPos::Left, VPos::Center);
    for value in &axis.ticks.at {
        let Some(share) = surface.share_of_value(*value) else { continue };
        let y = height - libm::round(share * f64::from(height)) as i32;
        solid_line(canvas, &[(right, y), (right + px(3.0), y)], line(GREY, 0.75))?;
        canvas.draw_text(&axis.ticks.label(*value), &style, (right + px(6.0), y))?;
    }
    let style = text(TEXT_PX, INK, HPos::Center, VPos::Center).transform(FontTransform::Rotate270);
    canvas.draw_text(&axis.name, &style, (right + px(40.0), height / 2))
}
