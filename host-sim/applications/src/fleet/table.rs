//! `robots.parquet`: one row per part of each robot's gap, written as the robots are finished, then one row per robot.

use std::collections::BTreeMap;
use std::fs::File;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use parquet::basic::Compression;
use parquet::data_type::{ByteArray, ByteArrayType, DataType, DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedFileWriter, SerializedRowGroupWriter};
use parquet::schema::parser::parse_message_type;

use super::robot::Robot;
use mindgap_diagnosis::verdict::Verdict;
use mindgap_foundations::error::{Error, Result};

/// Number of rows per row group.
const GROUP: usize = 1000;
/// The columns, in the order of [`Table::write`].
const SCHEMA: &str = "message robots {
    REQUIRED BYTE_ARRAY robot (STRING);
    OPTIONAL BYTE_ARRAY verdict (STRING);
    OPTIONAL INT64 runs;
    OPTIONAL INT64 rows;
    OPTIONAL DOUBLE gap_nats;
    OPTIONAL DOUBLE closed;
    OPTIONAL INT64 group;
    OPTIONAL BYTE_ARRAY effect (STRING);
    OPTIONAL DOUBLE probability;
    OPTIONAL DOUBLE share;
    OPTIONAL DOUBLE share_low;
    OPTIONAL DOUBLE share_high;
    OPTIONAL BYTE_ARRAY variant (STRING);
    OPTIONAL BYTE_ARRAY parameters (STRING);
    OPTIONAL BYTE_ARRAY refused (STRING);
}";

/// A table in progress.
pub struct Table {
    path: PathBuf,
    /// `None` until the first rows are written.
    writer: Option<SerializedFileWriter<File>>,
    rows: Vec<Row>,
    /// Rows of the robots, whose groups are not known until the end.
    own: Vec<Row>,
}

/// A row of the table. That of a robot has no effect, that of a part has no verdict.
#[derive(Default)]
struct Row {
    robot: String,
    verdict: Option<&'static str>,
    runs: Option<usize>,
    rows: Option<usize>,
    gap_nats: Option<f64>,
    closed: Option<f64>,
    group: Option<usize>,
    effect: Option<String>,
    probability: Option<f64>,
    share: Option<f64>,
    share_ends: Option<[f64; 2]>,
    variant: Option<String>,
    parameters: Option<String>,
    refused: Option<String>,
}

impl Table {
    /// Returns a new table for a path.
    pub fn at(path: &Path) -> Self {
        Table { path: path.to_owned(), writer: None, rows: Vec::new(), own: Vec::new() }
    }

    /// Adds a robot, or the reason why it could not be diagnosed.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn add(&mut self, name: &str, robot: std::result::Result<&Robot, &String>) -> Result<()> {
        match robot {
            Ok(robot) => {
                self.own.push(own(name, robot));
                self.rows.extend(parts(name, robot));
            }
            Err(reason) => {
                self.own.push(Row { robot: name.into(), refused: Some(reason.clone()), ..Row::default() });
            }
        }
        if self.rows.len() >= GROUP { self.write().map_err(|e| failed(&self.path, &e)) } else { Ok(()) }
    }

    /// Writes the remaining rows, with the group of each robot that has one.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn close(mut self, groups: &BTreeMap<&str, usize>) -> Result<()> {
        let own = std::mem::take(&mut self.own).into_iter();
        self.rows.extend(own.map(|row| Row { group: groups.get(row.robot.as_str()).copied(), ..row }));
        let written = self.write().and_then(|()| self.writer.map_or(Ok(()), |writer| writer.close().map(|_| ())));
        written.map_err(|e| failed(&self.path, &e))
    }

    fn write(&mut self) -> std::result::Result<(), ParquetError> {
        let rows = std::mem::take(&mut self.rows);
        let writer = match self.writer.take() {
            Some(writer) => writer,
            None => create(&self.path)?,
        };
        let mut group = self.writer.insert(writer).next_row_group()?;
        let texts = |of: &dyn Fn(&Row) -> Option<&str>| -> Vec<Option<ByteArray>> {
            rows.iter().map(|row| of(row).map(ByteArray::from)).collect()
        };
        let numbers = |of: &dyn Fn(&Row) -> Option<f64>| -> Vec<Option<f64>> { rows.iter().map(of).collect() };
        let counts = |of: &dyn Fn(&Row) -> Option<usize>| -> Vec<Option<i64>> {
            rows.iter().map(|row| of(row).map(|count| count as i64)).collect()
        };
        column::<ByteArrayType>(&mut group, &texts(&|row| Some(&row.robot)))?;
        column::<ByteArrayType>(&mut group, &texts(&|row| row.verdict))?;
        column::<Int64Type>(&mut group, &counts(&|row| row.runs))?;
        column::<Int64Type>(&mut group, &counts(&|row| row.rows))?;
        column::<DoubleType>(&mut group, &numbers(&|row| row.gap_nats))?;
        column::<DoubleType>(&mut group, &numbers(&|row| row.closed))?;
        column::<Int64Type>(&mut group, &counts(&|row| row.group))?;
        column::<ByteArrayType>(&mut group, &texts(&|row| row.effect.as_deref()))?;
        column::<DoubleType>(&mut group, &numbers(&|row| row.probability))?;
        column::<DoubleType>(&mut group, &numbers(&|row| row.share))?;
        column::<DoubleType>(&mut group, &numbers(&|row| row.share_ends.map(|ends| ends[0])))?;
        column::<DoubleType>(&mut group, &numbers(&|row| row.share_ends.map(|ends| ends[1])))?;
        column::<ByteArrayType>(&mut group, &texts(&|row| row.variant.as_deref()))?;
        column::<ByteArrayType>(&mut group, &texts(&|row| row.parameters.as_deref()))?;
        column::<ByteArrayType>(&mut group, &texts(&|row| row.refused.as_deref()))?;
        group.close().map(|_| ())
    }
}

/// Creates the file with its columns.
fn create(path: &Path) -> std::result::Result<SerializedFileWriter<File>, ParquetError> {
    let schema = Arc::new(parse_message_type(SCHEMA)?);
    let properties = WriterProperties::builder()
        .set_created_by(format!("mindgap {}", env!("CARGO_PKG_VERSION")))
        .set_compression(Compression::UNCOMPRESSED);
    SerializedFileWriter::new(File::create(path)?, schema, Arc::new(properties.build()))
}

/// Returns the row of a robot.
fn own(name: &str, robot: &Robot) -> Row {
    Row {
        robot: name.into(),
        verdict: Some(Verdict::id(robot.verdict)),
        runs: Some(robot.runs),
        rows: Some(robot.rows),
        gap_nats: robot.gap_nats,
        closed: robot.closed,
        ..Row::default()
    }
}

/// Returns the rows of a robot's effects and of the other parts of its gap.
fn parts(name: &str, robot: &Robot) -> Vec<Row> {
    let part = |id: &str| robot.budget.iter().find(|part| part.0 == id);
    let effects = robot.effects.iter().map(|cause| Row {
        robot: name.into(),
        effect: Some(cause.id.clone()),
        probability: Some(cause.probability),
        share: part(&cause.id).map(|part| part.1),
        share_ends: part(&cause.id).map(|part| part.2),
        variant: cause.strength.as_ref().map(|(variant, _)| variant.clone()),
        parameters: cause.strength.as_ref().and_then(|(_, values)| serde_json::to_string(values).ok()),
        ..Row::default()
    });
    let others = robot.budget.iter().filter(|part| robot.effects.iter().all(|cause| cause.id != part.0));
    let others = others.map(|(id, share, ends)| Row {
        robot: name.into(),
        effect: Some(id.clone()),
        share: Some(*share),
        share_ends: Some(*ends),
        ..Row::default()
    });
    effects.chain(others).collect()
}

/// Writes the next column of a row group.
fn column<T: DataType>(
    group: &mut SerializedRowGroupWriter<'_, File>,
    cells: &[Option<T::T>],
) -> std::result::Result<(), ParquetError> {
    let Some(mut column) = group.next_column()? else {
        return Err(ParquetError::General("the schema has fewer columns".into()));
    };
    let levels: Vec<i16> = cells.iter().map(|cell| i16::from(cell.is_some())).collect();
    let values: Vec<T::T> = cells.iter().flatten().cloned().collect();
    column.typed::<T>().write_batch(&values, Some(&levels), None)?;
    column.close()
}

fn failed(path: &Path, e: &ParquetError) -> Error {
    Error::in_file(path, format!("cannot be written: {e}"))
}

#[cfg(test)]
mod tests {
    use parquet::file::reader::{FileReader, SerializedFileReader};

    use super::*;
    use crate::fleet::robot::Cause;
    use mindgap_models::effects::parameter::Setting;

    #[test]
    fn every_robot_has_a_row_and_one_per_part_of_its_gap() {
        let strength = Some(("fast".into(), BTreeMap::from([("loss".into(), Setting::Number(0.25))])));
        let robot = Robot {
            measures: mindgap_built_in_robot::default_robot(),
            verdict: Verdict::Known,
            runs: 24,
            rows: 900,
            gap_nats: Some(0.5),
            closed: Some(0.9),
            budget: vec![("slip".into(), 0.75, [0.7, 0.8]), ("scatter".into(), 0.25, [0.2, 0.3])],
            effects: vec![Cause { id: "slip".into(), probability: 0.9, strength }],
            untestable: vec![],
        };
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join(crate::fleet::TABLE);
        let mut table = Table::at(&path);
        for number in 0..GROUP {
            table.add(&format!("robot-{number}"), Ok(&robot)).expect("a row");
        }
        table.add("broken", Err(&"robot.toml: is missing".into())).expect("a row");
        table.close(&BTreeMap::from([("robot-0", 2)])).expect("a table");
        let reader = SerializedFileReader::new(File::open(&path).expect("a file")).expect("a table");
        assert_eq!(reader.metadata().num_row_groups(), 3, "two of parts and one of robots");
        let cells = |row: &parquet::record::Row| -> BTreeMap<String, String> {
            row.get_column_iter().map(|(name, cell)| (name.clone(), cell.to_string())).collect()
        };
        let rows: Vec<_> = reader.get_row_iter(None).expect("rows").map(|row| cells(&row.expect("a row"))).collect();
        assert_eq!(rows.len(), 3 * GROUP + 1);
        let names = ["robot", "verdict", "runs", "group", "effect", "share", "parameters"];
        let row = |number: usize| names.map(|name| rows[number][name].as_str());
        assert_eq!(row(0)[4..], ["\"slip\"", "0.75", r#""{"loss":0.25}""#]);
        assert_eq!(row(1)[4..], ["\"scatter\"", "0.25", "null"]);
        assert_eq!(row(2 * GROUP), ["\"robot-0\"", "\"known\"", "24", "2", "null", "null", "null"]);
        assert_eq!(row(2 * GROUP + 1)[3], "null");
        assert_eq!(rows[3 * GROUP]["refused"], "\"robot.toml: is missing\"");
    }
}
