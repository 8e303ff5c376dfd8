//! Assigns quantities and units to the columns of a table, by name, by options or by a mapping file.

use super::mapping::Mapped;
use super::quantities::{Dimension, Quantity, Unit, meaning};
use super::recording::Kind;
use super::table::{Line, Table};
use super::timestamps::{Stamp, guess_unit};
use super::units::Units;
use mindgap_foundations::error::{Error, Result};

/// The recognised columns of a table.
pub struct Columns {
    /// Time may have two columns: seconds and the fraction of a second.
    columns: Vec<Column>,
}

struct Column {
    quantity: Quantity,
    index: usize,
    name: String,
    /// `None` for a time or motor command whose unit is guessed from the numbers.
    unit: Option<Unit>,
    sign: f64,
}

/// The meaning of command pairs, their scale, and how it was guessed.
pub struct CommandKind {
    /// Meaning of the pairs.
    pub kind: Kind,
    /// Factor to multiply with.
    pub factor: f64,
    guessed: Option<String>,
}

const POSES: [Quantity; 6] = [Quantity::X, Quantity::Y, Quantity::Heading, Quantity::Qz, Quantity::Qw, Quantity::Qx];
const TWIST: [Quantity; 2] = [Quantity::Forward, Quantity::Turn];
const WHEELS: [Quantity; 2] = [Quantity::Left, Quantity::Right];

impl Columns {
    /// Finds the columns of a table: those that are `mapped`, or else those with recognised names.
    ///
    /// # Errors
    /// When a required column or unit is missing, or columns are ambiguous.
    pub fn find(table: &Table, mapped: Option<&[Mapped]>, units: &Units) -> Result<Self> {
        let found = match mapped {
            Some(mapped) => by_mapping(table, mapped),
            None => by_names(table),
        };
        let columns = Columns { columns: found.map_err(|what| Error::at_line(&table.file, 1, what))? };
        columns.with_units(units).and_then(|columns| columns.complete(table)).map_err(|what| match what {
            Lack::Anything => {
                let names = table.names.join(", ");
                let what = format!(
                    "contains no command, pose or reading: its columns are {names}; assign them in a --map file"
                );
                Error::in_file(&table.file, what)
            }
            Lack::Column(what) => Error::at_line(&table.file, 1, what),
        })
    }

    /// Returns whether there is a column for a quantity.
    pub fn has(&self, quantity: Quantity) -> bool {
        self.column(quantity).is_some()
    }

    /// Returns whether there are columns of poses.
    pub fn has_poses(&self) -> bool {
        self.has(Quantity::X)
    }

    /// Returns the two columns of commands, if any.
    pub fn command_columns(&self) -> Option<(Quantity, Quantity)> {
        [TWIST, WHEELS].into_iter().find(|pair| self.has(pair[0])).map(|[a, b]| (a, b))
    }

    /// Returns the number in a cell, in ms, cm, rad, cm/s or rad/s if its unit is known; `None` if it is empty.
    ///
    /// # Errors
    /// When it is not a number.
    pub fn value(&self, quantity: Quantity, line: &Line) -> Result<Option<f64>> {
        let Some(column) = self.column(quantity) else { return Ok(None) };
        let factor = column.sign * column.unit.map_or(1.0, |unit| unit.factor);
        Ok(line.number(column.index)?.map(|number| factor * number))
    }

    /// Returns the timestamp of a line, in ms if it is a number of known unit.
    ///
    /// # Errors
    /// When it is neither a number nor a date.
    pub fn stamp(&self, line: &Line) -> Result<Stamp> {
        let mut sum: Option<Stamp> = None;
        for column in self.columns.iter().filter(|column| column.quantity == Quantity::Time) {
            let cell = line.text(column.index);
            let number = || Some(Stamp::Number(line.number(column.index).ok()??)).filter(|_| !cell.is_empty());
            let stamp = Stamp::parse(cell).or_else(number).ok_or_else(|| {
                line.error(format!(
                    "{} = {cell:?} is not a time: write a number or 2024-06-01T12:00:00.000Z",
                    column.name
                ))
            })?;
            let factor = column.unit.map_or(1.0, |unit| unit.factor);
            sum = Some(match (sum, stamp) {
                (None, Stamp::Number(number)) => Stamp::Number(number * factor),
                (Some(Stamp::Number(so_far)), Stamp::Number(number)) => Stamp::Number(so_far + number * factor),
                (_, moment) => moment,
            });
        }
        sum.ok_or_else(|| line.error("has no time".into()))
    }

    /// Converts all timestamps to ms; also returns a description of the guessed unit, if any.
    ///
    /// # Errors
    /// When the unit cannot be determined, or numbers and dates are mixed.
    pub fn ms(&self, table: &Table, stamps: &[Stamp]) -> Result<(Vec<f64>, Option<String>)> {
        let numbers: Vec<f64> =
            stamps.iter().filter_map(|s| if let Stamp::Number(n) = s { Some(*n) } else { None }).collect();
        let moments = || stamps.iter().filter_map(|s| if let Stamp::Moment(ms) = s { Some(*ms) } else { None });
        let Some(column) = self.column(Quantity::Time).filter(|_| !numbers.is_empty()) else {
            return Ok((moments().collect(), None));
        };
        if numbers.len() < stamps.len() {
            let what = format!("{} contains both numbers and dates", column.name);
            return Err(Error::in_file(&table.file, what));
        }
        if column.unit.is_some() {
            return Ok((numbers, None));
        }
        let (factor, unit) = guess_unit(&numbers).ok_or_else(|| {
            let what = format!(
                "the unit of {} cannot be determined: name it {0}_s, {0}_ms and the like, or give --time-unit",
                column.name
            );
            Error::at_line(&table.file, 1, what)
        })?;
        let description = format!("{} is in {unit}, judging by size and spacing", column.name);
        Ok((numbers.into_iter().map(|number| number * factor).collect(), Some(description)))
    }

    /// Determines the meaning of the commands, as read by [`value`](Self::value).
    ///
    /// # Errors
    /// When motor commands exceed 100 and have no stated unit.
    pub fn kind<'a>(&self, table: &Table, samples: impl Iterator<Item = &'a [f64; 2]>) -> Result<CommandKind> {
        let exact = |kind| Ok(CommandKind { kind, factor: 1.0, guessed: None });
        let Some(left) = self.column(Quantity::Left) else { return exact(Kind::Twist) };
        match left.unit.map(|unit| unit.dimension) {
            Some(Dimension::Speed) => return exact(Kind::WheelSpeeds),
            Some(Dimension::Rate) => return exact(Kind::WheelRates),
            Some(_) => return exact(Kind::Motors),
            None => {}
        }
        let max = samples.flatten().map(|v| v.abs()).fold(0.0, f64::max);
        let (factor, range) = match max {
            max if max <= 1.0 => (100.0, "-1 to 1"),
            max if max <= 100.0 => (1.0, "-100 to 100"),
            _ => {
                let what = format!(
                    "motor commands reach {max} and so exceed 100: give the value of full command, or their unit, in a --map \
                     file, as in left = {{ column = {:?}, unit = \"255\" }}",
                    left.name
                );
                return Err(Error::in_file(&table.file, what));
            }
        };
        let guessed = Some(format!("motor commands range from {range}, since none exceeds {max}"));
        Ok(CommandKind { kind: Kind::Motors, factor, guessed })
    }

    /// Returns the assignments of quantities to columns.
    pub fn mapped(&self) -> Vec<String> {
        self.columns.iter().map(|column| format!("{} = {}", column.quantity.name(), column.name)).collect()
    }

    /// Returns the names of unrecognised columns.
    pub fn unrecognised(&self, table: &Table) -> Vec<String> {
        let is_used = |index: usize| self.columns.iter().any(|column| column.index == index);
        let names = table.names.iter().enumerate();
        names.filter(|(index, _)| !is_used(*index)).map(|(_, name)| name.clone()).collect()
    }

    fn column(&self, quantity: Quantity) -> Option<&Column> {
        self.columns.iter().find(|column| column.quantity == quantity)
    }

    /// Adds the units stated by options where names do not state them.
    fn with_units(mut self, units: &Units) -> std::result::Result<Self, Lack> {
        for column in &mut self.columns {
            let stated = |factor: Option<f64>, dimension| factor.map(|factor| Unit { dimension, factor });
            let length = units.length.map(|length| length.cm());
            let angle = units.angle.map(|angle| angle.rad());
            let (stated_unit, option) = match column.quantity.dimensions() {
                [Dimension::Time] => (stated(units.time.map(|time| time.ms()), Dimension::Time), None),
                [Dimension::Length] => {
                    (stated(length, Dimension::Length), Some("_m, _cm or _mm, or give --length-unit"))
                }
                [Dimension::Angle] => (stated(angle, Dimension::Angle), Some("_rad or _deg, or give --angle-unit")),
                [Dimension::Speed] => {
                    (stated(length, Dimension::Speed), Some("_m_s, _cm_s or _mm_s, or give --length-unit"))
                }
                [Dimension::Rate] => (stated(angle, Dimension::Rate), Some("_rad_s or _deg_s, or give --angle-unit")),
                _ => (None, None),
            };
            column.unit = column.unit.or(stated_unit);
            if let Some(how) = option.filter(|_| column.unit.is_none()) {
                return Err(Lack::Column(format!("column {0} has no unit: name it {0}{how}", column.name)));
            }
        }
        Ok(self)
    }

    /// Checks that nothing is missing.
    fn complete(self, table: &Table) -> std::result::Result<Self, Lack> {
        let has = |quantity: &Quantity| self.has(*quantity);
        let missing = |quantity: Quantity, the: &str, names: &str| {
            let (what, others) = (quantity.name(), self.unrecognised(table).join(", "));
            let which = if others.is_empty() { String::new() } else { format!(" of {others}") };
            let map = format!("or assign one{which} in a --map file, as in {what} = \"its name\"");
            Err(Lack::Column(format!("no column for {the}{what}: name it {names}, {map}")))
        };
        if [TWIST, WHEELS].iter().flatten().chain(&POSES).chain([&Quantity::Range]).all(|quantity| !has(quantity)) {
            return Err(Lack::Anything);
        }
        if !has(&Quantity::Time) {
            return missing(Quantity::Time, "the ", "t_s, time_ms, timestamp or the like");
        }
        if TWIST.iter().any(has) && WHEELS.iter().any(has) {
            let names = |pair: [Quantity; 2]| pair.map(|q| self.column(q).map_or("", |column| &column.name)).join(" ");
            let what = format!("both speeds ({}) and wheels ({}) could be the commands", names(TWIST), names(WHEELS));
            return Err(Lack::Column(what + ": choose in a --map file"));
        }
        for [a, b] in [TWIST, WHEELS, [Quantity::X, Quantity::Y]] {
            if has(&a) != has(&b) {
                let lacking = if has(&a) { b } else { a };
                return missing(lacking, "", "as in docs/how-to/bring-your-own-robot.md");
            }
        }
        let unequal = WHEELS.map(|wheel| self.column(wheel).and_then(|column| Some(column.unit?.dimension)));
        if unequal[0] != unequal[1] {
            return Err(Lack::Column("left and right have units of different kinds".into()));
        }
        let has_heading = has(&Quantity::Heading) || (has(&Quantity::Qz) && has(&Quantity::Qw));
        if has(&Quantity::X) && !has_heading {
            return missing(Quantity::Heading, "the ", "heading_deg, yaw_rad, or qx, qy, qz, qw of a quaternion");
        }
        Ok(self)
    }
}

impl CommandKind {
    /// Returns the description of a guess, if any.
    pub fn guessed(&self) -> Option<&str> {
        self.guessed.as_deref()
    }
}

/// Why a table cannot be used.
enum Lack {
    /// No column is recognised.
    Anything,
    /// A column or its unit is missing.
    Column(String),
}

fn by_mapping(table: &Table, mapped: &[Mapped]) -> std::result::Result<Vec<Column>, String> {
    let column = |mapped: &Mapped| {
        let Mapped { quantity, column, unit, negate } = mapped;
        let index = table.names.iter().position(|name| name == column).ok_or_else(|| {
            format!("has no column {column:?}, which the --map file names: its columns are {}", table.names.join(", "))
        })?;
        let unit = unit.or_else(|| meaning(column).unit.filter(|u| quantity.dimensions().contains(&u.dimension)));
        let sign = if *negate { -1.0 } else { 1.0 };
        Ok(Column { quantity: *quantity, index, name: column.clone(), unit, sign })
    };
    mapped.iter().map(column).collect()
}

fn by_names(table: &Table) -> std::result::Result<Vec<Column>, String> {
    let named = table.names.iter().enumerate().map(|(index, name)| (index, name, meaning(name)));
    let mut recognised: Vec<_> =
        named.filter_map(|(index, name, meaning)| Some((meaning.quantity?, index, name, meaning))).collect();
    recognised.sort_by_key(|(quantity, index, ..)| (*quantity, *index));
    let mut columns = Vec::new();
    for same in recognised.chunk_by(|a, b| a.0 == b.0) {
        let commanded: Vec<_> = same.iter().filter(|(.., meaning)| meaning.is_commanded).collect();
        let quantity = same[0].0;
        let chosen = match (same, commanded.as_slice()) {
            ([_], _) => same.iter().collect(),
            (_, [_]) => commanded,
            // Seconds and the fraction of a second.
            ([a, b], _) if quantity == Quantity::Time && a.3.unit.zip(b.3.unit).is_some_and(|(a, b)| a != b) => {
                vec![a, b]
            }
            _ => {
                let names: Vec<&str> = same.iter().map(|(_, _, name, _)| name.as_str()).collect();
                let names = names.join(", ");
                return Err(format!(
                    "more than one column for {}: {names}; choose one in a --map file",
                    quantity.name()
                ));
            }
        };
        columns.extend(chosen.into_iter().map(|(quantity, index, name, meaning)| Column {
            quantity: *quantity,
            index: *index,
            name: (*name).clone(),
            unit: meaning.unit,
            sign: 1.0,
        }));
    }
    Ok(columns)
}
