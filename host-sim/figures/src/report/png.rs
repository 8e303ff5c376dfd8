//! Figures as PNG.

use std::sync::Arc;

use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::fontdb::Database;
use resvg::usvg::{Options, Tree};

use super::Figure;

/// Pixels of the PNG per pixel of the SVG: 288 to the inch, so that it stays sharp in print and on dense screens.
const SCALE: u32 = 3;

impl Figure {
    /// The SVG as a PNG of three times its size, with the font that comes with the program.
    ///
    /// # Panics
    /// When the figure is not well-formed SVG, which would be a defect of the drawing.
    pub fn png(&self) -> Vec<u8> {
        let mut fonts = Database::new();
        fonts.load_font_data(ttf_noto_sans::REGULAR.to_vec());
        fonts.load_font_data(ttf_noto_sans::BOLD.to_vec());
        // Whatever family is asked for: no other font is there.
        fonts.set_sans_serif_family("Noto Sans");
        let options = Options { fontdb: Arc::new(fonts), ..Options::default() };
        let tree = Tree::from_str(&self.svg, &options).expect("the figure is well-formed SVG");
        let mut pixels = Pixmap::new(self.width_px * SCALE, self.height_px * SCALE).expect("a figure has a size");
        let scale = SCALE as f32;
        resvg::render(&tree, Transform::from_scale(scale, scale), &mut pixels.as_mut());
        pixels.encode_png().expect("encoding into memory cannot fail")
    }
}
