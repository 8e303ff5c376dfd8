//! What a recording holds, without importing it: columns or topics, rates, time span and bodies.

use std::path::Path;

use schemars::JsonSchema;
use serde::Serialize;

use super::columns::{Columns, ReadTimes};
use super::layouts;
use super::quantities::meaning;
use super::units::{Angle, Length, Units};
use mindgap_foundations::error::Result;

/// The contents of a recording.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Contents {
    /// Kind of the file, in words.
    pub kind: String,
    /// Time span, s; null if no clock is recognised.
    pub seconds: Option<f64>,
    /// Its columns or topics.
    pub streams: Vec<StreamContents>,
    /// Names of its bodies.
    pub bodies: Vec<String>,
}

/// A column or topic.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct StreamContents {
    /// Its name.
    pub name: String,
    /// Type of the messages, or quantity of the column.
    pub r#type: String,
    /// Samples per second; null if no clock is recognised.
    pub rate_hz: Option<f64>,
    /// Number of samples.
    pub rows: usize,
}

impl Contents {
    /// Describes a table.
    ///
    /// # Errors
    /// When it cannot be read or a line is malformed.
    pub fn of_table(file: &Path) -> Result<Self> {
        let layouts::Opened { table, columns, format } = layouts::open(file)?;
        // Lengths are not needed, so any unit does.
        let units = Units { length: Some(Length::M), angle: Some(Angle::Rad), time: None };
        let is_known = columns.is_some();
        let columns = columns.or_else(|| Columns::find(&table, None, &units, &[]).ok()).unwrap_or_default();
        let mut times = ReadTimes::new(&table, &columns.times);
        let mut rows = 0;
        let mut seen = vec![0; columns.bodies.len()];
        let mut filled = vec![0; table.names().len()];
        table.for_each(|line| {
            times.push(line)?;
            rows += 1;
            for (count, body) in seen.iter_mut().zip(&columns.bodies) {
                *count += usize::from(body.pose(line)?.is_some());
            }
            filled
                .iter_mut()
                .enumerate()
                .for_each(|(column, count)| *count += usize::from(!line.text(column).is_empty()));
            Ok(())
        })?;
        let ms = times.choose().map(|times| times.ms).ok();
        let seconds = ms.and_then(|ms| Some((ms.last()? - ms.first()?) / 1e3));
        let rate_hz = |rows: usize| seconds.filter(|s| *s > 0.0).map(|s| rows.saturating_sub(1) as f64 / s);
        let stream =
            |name: String, r#type: String, rows: usize| StreamContents { name, r#type, rate_hz: rate_hz(rows), rows };
        let of_bodies = columns.bodies.iter().zip(&seen);
        let of_columns = table.names().iter().zip(&filled);
        let streams = if is_known {
            of_bodies.map(|(body, rows)| stream(body.name.clone(), "pose".into(), *rows)).collect()
        } else {
            let quantity = |name: &str| meaning(name).quantity.map_or("not recognised", |quantity| quantity.name());
            of_columns.map(|(name, rows)| stream(name.clone(), quantity(name).into(), *rows)).collect()
        };
        let bodies = columns.bodies.iter().map(|body| body.name.clone()).filter(|name| !name.is_empty()).collect();
        Ok(Contents { kind: format!("{format}: {rows} rows"), seconds, streams, bodies })
    }
}
