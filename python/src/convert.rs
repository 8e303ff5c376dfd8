//! Conversions between Python's values and the library's.

use std::path::PathBuf;

use mindgap_files as files;
use mindgap_logs::tables::Table;
use mindgap_logs::{Robot, Scene};
use pyo3::buffer::PyBuffer;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{IntoPyDict, PyDict};
use serde::Serialize;

use crate::error::raised;

/// Converts a value to the dicts, lists and numbers that `--json` writes.
pub fn facts<'py>(py: Python<'py>, value: &impl Serialize) -> PyResult<Bound<'py, PyAny>> {
    let text = serde_json::to_string(value).map_err(|e| PyTypeError::new_err(e.to_string()))?;
    py.import("json")?.call_method1("loads", (text,))
}

/// Converts rows to a frame; nested fields have dots in their column names.
pub fn frame<'py>(py: Python<'py>, rows: &impl Serialize) -> PyResult<Bound<'py, PyAny>> {
    py.import("pandas")?.call_method1("json_normalize", (facts(py, rows)?,))
}

/// Reads a robot from a path of robot.toml or a dict with its contents.
pub fn robot(from: &Bound<PyAny>) -> PyResult<Robot> {
    let (path, text) = text(from, "robot")?;
    Robot::parse(&path, &text).map_err(raised)
}

/// Reads a scene from a path of scene.toml or a dict with its contents.
pub fn scene(from: &Bound<PyAny>) -> PyResult<Scene> {
    let (path, text) = text(from, "scene")?;
    Scene::parse(&path, &text).map_err(raised)
}

/// Returns a scene as a dict.
pub fn scene_facts<'py>(py: Python<'py>, scene: &Scene) -> PyResult<Bound<'py, PyAny>> {
    let tables: toml::Table = scene.to_text().parse().map_err(|e| PyTypeError::new_err(format!("{e}")))?;
    facts(py, &tables)
}

/// Returns the text of `NAME.toml`, and its path for messages, from a path of it or a dict with its contents.
pub fn text(from: &Bound<PyAny>, name: &str) -> PyResult<(PathBuf, String)> {
    if let Ok(path) = from.extract::<PathBuf>() {
        let text = files::read_text(&path).map_err(raised)?;
        return Ok((path, text));
    }
    let form = |e: String| {
        PyTypeError::new_err(format!("{name}: expected a path of {name}.toml or a dict with its contents: {e}"))
    };
    let text: String = from.py().import("json")?.call_method1("dumps", (from,))?.extract()?;
    let tables: toml::Table = serde_json::from_str(&text).map_err(|e| form(e.to_string()))?;
    Ok((name.into(), toml::to_string(&tables).map_err(|e| form(e.to_string()))?))
}

/// Reads runs from one frame with a column `run`, or from a mapping from run names to tables.
pub fn tables(runs: &Bound<PyAny>) -> PyResult<Vec<Table>> {
    let py = runs.py();
    if !runs.hasattr("groupby")? {
        let items = runs.call_method0("items")?;
        return items.try_iter()?.map(|item| table(&item?.extract::<(String, Bound<PyAny>)>()?)).collect();
    }
    let groups = runs.call_method("groupby", ("run",), Some(&[("sort", false)].into_py_dict(py)?))?;
    groups
        .try_iter()?
        .map(|group| {
            let (name, rows) = group?.extract::<(Bound<PyAny>, Bound<PyAny>)>()?;
            let columns = [("columns", "run")].into_py_dict(py)?;
            table(&(name.str()?.to_string(), rows.call_method("drop", (), Some(&columns))?))
        })
        .collect()
}

/// Reads a run from a frame, a structured array, or a dict of arrays.
fn table((name, rows): &(String, Bound<PyAny>)) -> PyResult<Table> {
    let names = match rows.getattr("dtype") {
        Ok(kind) => kind.getattr("names")?,
        Err(_) => rows.call_method0("keys")?,
    };
    let column = |column: PyResult<Bound<PyAny>>| {
        let column: String = column?.extract()?;
        let values = numbers(&rows.get_item(&column)?)?;
        Ok((column, values))
    };
    Ok(Table { name: name.clone(), columns: names.try_iter()?.map(column).collect::<PyResult<_>>()? })
}

fn numbers(column: &Bound<PyAny>) -> PyResult<Vec<f64>> {
    let py = column.py();
    let float = [("dtype", "float64")].into_py_dict(py)?;
    let array = py.import("numpy")?.call_method("ascontiguousarray", (column,), Some(&float))?;
    PyBuffer::get(&array)?.to_vec(py)
}

/// Returns a run as a dict of arrays.
pub fn arrays<'py>(py: Python<'py>, table: Table) -> PyResult<Bound<'py, PyDict>> {
    let numpy = py.import("numpy")?;
    let arrays = PyDict::new(py);
    for (name, values) in table.columns {
        arrays.set_item(name, numpy.call_method1("array", (values,))?)?;
    }
    Ok(arrays)
}
