//! Figures and pages that a notebook displays.

use std::path::PathBuf;

use mindgap_command::kinds;
use mindgap_figures::pictures::NamedFigure;
use mindgap_figures::report;
use mindgap_files as files;
use mindgap_foundations::error::Result;
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::error::raised;
use crate::places;

/// Height of a page within a notebook, px.
const PAGE_HEIGHT_PX: u32 = 700;

/// A figure.
#[pyclass(frozen, module = "mindgap")]
pub struct Figure {
    /// The name of its files.
    #[pyo3(get)]
    name: String,
    figure: report::Figure,
}

#[pymethods]
impl Figure {
    /// The figure as SVG.
    #[getter]
    fn svg(&self) -> &str {
        self.figure.svg()
    }

    /// Returns the figure as PNG with 288 dots per inch.
    fn png<'py>(&self, py: Python<'py>) -> Bound<'py, PyBytes> {
        PyBytes::new(py, &py.detach(|| self.figure.png()))
    }

    fn _repr_svg_(&self) -> &str {
        self.figure.svg()
    }

    fn __repr__(&self) -> String {
        format!("<mindgap.Figure {}>", self.name)
    }
}

/// Converts figures for Python.
pub fn figures(figures: Vec<NamedFigure>) -> Vec<Figure> {
    figures.into_iter().map(|NamedFigure { name, figure }| Figure { name, figure }).collect()
}

/// Returns the SVG of figures one below the other.
pub fn below_each_other(figures: &[NamedFigure]) -> String {
    figures.iter().map(|named| format!("<div>{}</div>", named.figure.svg())).collect()
}

/// A page for a browser.
#[pyclass(frozen, module = "mindgap")]
pub struct Page {
    /// Its self-contained HTML.
    #[pyo3(get)]
    html: String,
}

impl Page {
    /// Wraps the HTML of a page.
    pub fn made(html: Result<String>) -> PyResult<Self> {
        html.map(|html| Page { html }).map_err(raised)
    }
}

#[pymethods]
impl Page {
    /// Writes the page; replacing anything but a page by mindgap needs `force`.
    #[pyo3(signature = (path, *, force=false))]
    fn write(&self, path: PathBuf, force: bool) -> PyResult<()> {
        places::file(&path, kinds::PAGE, force)?;
        files::write(&path, &self.html).map_err(raised)
    }

    fn _repr_html_(&self) -> String {
        // These characters would end the attribute.
        let whole = self.html.replace('&', "&amp;").replace('"', "&quot;");
        format!(
            "<iframe title=\"A page by mindgap\" srcdoc=\"{whole}\" \
             style=\"width: 100%; height: {PAGE_HEIGHT_PX}px; border: 0\"></iframe>"
        )
    }

    fn __repr__(&self) -> String {
        format!("<mindgap.Page of {} bytes>", self.html.len())
    }
}
