//! A finished drawing and its files.

use std::path::Path;
use std::sync::Arc;

use krilla::Document;
use krilla::geom::Size;
use krilla::page::PageSettings;
use krilla_svg::{SurfaceExt, SvgSettings};
use plotters::coord::Shift;
use plotters::drawing::{DrawingArea, DrawingAreaErrorKind, IntoDrawingArea};
use plotters::prelude::SVGBackend;
use plotters::style::WHITE;
use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::fontdb::Database;
use resvg::usvg::{Options, Tree};

use super::style::UNIT;
use mindgap_files as files;
use mindgap_foundations::error::Result;

/// Pixels of the PNG per pixel of the SVG: 288 to the inch, so that it stays sharp in print and on dense screens.
const PNG_SCALE: u32 = 3;
/// Points of a PDF, 72 to the inch, per pixel of the SVG, 96 to the inch.
const POINTS_PER_PX: f32 = 0.75;

/// The canvas of a figure; [`UNIT`] canvas units are one pixel of the SVG.
pub(super) type Canvas<'a> = DrawingArea<SVGBackend<'a>, Shift>;

/// Result of drawing. The canvas is a string in memory, so a failure is a defect: see [`Figure::draw`].
pub(super) type Drawn<T = ()> = std::result::Result<T, DrawingAreaErrorKind<std::io::Error>>;

/// A picture.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Figure {
    svg: String,
    width_px: u32,
    height_px: u32,
}

impl Figure {
    /// Draws upon a white sheet of this size, px.
    pub(super) fn draw(width_px: u32, height_px: u32, drawing: impl FnOnce(&Canvas) -> Drawn) -> Self {
        let (width, height) = (width_px * UNIT, height_px * UNIT);
        let mut inner = String::new();
        let canvas = SVGBackend::with_string(&mut inner, (width, height)).into_drawing_area();
        canvas
            .fill(&WHITE)
            .and_then(|()| drawing(&canvas))
            .and_then(|()| canvas.present())
            .expect("drawing into memory cannot fail");
        drop(canvas);
        let svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width_px}\" height=\"{height_px}\" \
             viewBox=\"0 0 {width} {height}\">\n{inner}</svg>\n"
        );
        Figure { svg, width_px, height_px }
    }

    /// The picture as an SVG document. Its text prefers Noto Sans and falls back to any sans-serif.
    pub fn svg(&self) -> &str {
        &self.svg
    }

    /// The SVG as a PNG of three times its size, with the font that comes with the program.
    pub fn png(&self) -> Vec<u8> {
        let mut pixels =
            Pixmap::new(self.width_px * PNG_SCALE, self.height_px * PNG_SCALE).expect("a figure has a size");
        let scale = PNG_SCALE as f32;
        resvg::render(&self.tree(), Transform::from_scale(scale, scale), &mut pixels.as_mut());
        pixels.encode_png().expect("encoding into memory cannot fail")
    }

    /// The SVG as a PDF of one page, with text that can be searched and copied.
    pub fn pdf(&self) -> Vec<u8> {
        let (width, height) = (self.width_px as f32 * POINTS_PER_PX, self.height_px as f32 * POINTS_PER_PX);
        let size = Size::from_wh(width, height).expect("a figure has a size");
        let mut document = Document::new();
        let mut page = document.start_page_with(PageSettings::new(size));
        let mut surface = page.surface();
        surface.draw_svg(&self.tree(), size, SvgSettings::default()).expect("a figure has nothing that PDF lacks");
        surface.finish();
        page.finish();
        document.finish().expect("a figure has nothing that PDF lacks")
    }

    fn tree(&self) -> Tree {
        let mut fonts = Database::new();
        fonts.load_font_data(ttf_noto_sans::REGULAR.to_vec());
        fonts.load_font_data(ttf_noto_sans::BOLD.to_vec());
        // Whatever family is asked for: no other font is there.
        fonts.set_sans_serif_family("Noto Sans");
        let options = Options { fontdb: Arc::new(fonts), ..Options::default() };
        Tree::from_str(&self.svg, &options).expect("the figure is well-formed SVG")
    }

    /// Writes `name.svg`, `name.png` and `name.pdf` into a folder, each atomically.
    ///
    /// # Errors
    /// When the folder is missing or not writable.
    pub fn write(&self, folder: &Path, name: &str) -> Result<()> {
        files::write(&folder.join(format!("{name}.svg")), &self.svg)?;
        files::write(&folder.join(format!("{name}.png")), self.png())?;
        files::write(&folder.join(format!("{name}.pdf")), self.pdf())
    }
}
