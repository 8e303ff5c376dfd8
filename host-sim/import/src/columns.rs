//! The columns of one table: which holds what, in which unit, by their names, by options or by a mapping file.

use super::mapping::Mapped;
use super::quantities::{Dimension, Quantity, Unit, meaning};
use super::recording::Kind;
use super::table::{Line, Table};
use super::timestamps::{Stamp, guessed};
use super::units::Units;
use mindgap_foundations::error::{Error, Result};

/// The columns of a table that are used.
pub struct Columns {
    /// Two of time where one has the seconds and the other what is beyond.
    columns: Vec<Column>,
}

struct Column {
    quantity: Quantity,
    place: usize,
    name: String,
    /// None of a time or of motors, where it is guessed from the numbers.
    unit: Option<Unit>,
    sign: f64,
}

/// What pairs of commands mean, what they are multiplied by, and what was guessed.
pub struct OfCommands {
    /// What they mean.
    pub kind: Kind,
    /// Their factor.
    pub factor: f64,
    guessed: Option<String>,
}

const POSES: [Quantity; 6] = [Quantity::X, Quantity::Y, Quantity::Heading, Quantity::Qz, Quantity::Qw, Quantity::Qx];
const TWIST: [Quantity; 2] = [Quantity::Forward, Quantity::Turn];
const WHEELS: [Quantity; 2] = [Quantity::Left, Quantity::Right];

impl Columns {
    /// Finds the columns of a table: those that are `mapped`, or else those whose names are plain.
    ///
    /// # Errors
    /// When a needed column is missing or cannot be told from another, or when a unit is missing.
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
                    "holds no command, pose or reading: its columns are {names}; say in a --map which of them hold what"
                );
                Error::in_file(&table.file, what)
            }
            Lack::Column(what) => Error::at_line(&table.file, 1, what),
        })
    }

    /// Whether there is a column for a quantity.
    pub fn has(&self, quantity: Quantity) -> bool {
        self.of(quantity).is_some()
    }

    /// Whether there are columns of poses.
    pub fn has_poses(&self) -> bool {
        self.has(Quantity::X)
    }

    /// The two columns of commands, if there are some.
    pub fn of_commands(&self) -> Option<(Quantity, Quantity)> {
        [TWIST, WHEELS].into_iter().find(|pair| self.has(pair[0])).map(|[a, b]| (a, b))
    }

    /// A cell in ms, cm, rad, cm/s, rad/s or as the number that it is; `None` where it is empty.
    ///
    /// # Errors
    /// When it is no number.
    pub fn value(&self, quantity: Quantity, line: &Line) -> Result<Option<f64>> {
        let Some(column) = self.of(quantity) else { return Ok(None) };
        let one = column.sign * column.unit.map_or(1.0, |unit| unit.one);
        Ok(line.number(column.place)?.map(|number| one * number))
    }

    /// The stamp of a line; in ms where it is a number of a known unit.
    ///
    /// # Errors
    /// When it is neither a number nor a point in time.
    pub fn stamp(&self, line: &Line) -> Result<Stamp> {
        let mut sum: Option<Stamp> = None;
        for column in self.columns.iter().filter(|column| column.quantity == Quantity::Time) {
            let cell = line.text(column.place);
            let number = || Some(Stamp::Number(line.number(column.place).ok()??)).filter(|_| !cell.is_empty());
            let stamp = Stamp::read(cell).or_else(number).ok_or_else(|| {
                line.error(format!("{} = {cell:?} is no time: write a number or 2024-06-01T12:00:00.000Z", column.name))
            })?;
            let one = column.unit.map_or(1.0, |unit| unit.one);
            sum = Some(match (sum, stamp) {
                (None, Stamp::Number(number)) => Stamp::Number(number * one),
                (Some(Stamp::Number(so_far)), Stamp::Number(number)) => Stamp::Number(so_far + number * one),
                (_, moment) => moment,
            });
        }
        sum.ok_or_else(|| line.error("has no time".into()))
    }

    /// All stamps in ms, and which unit was guessed.
    ///
    /// # Errors
    /// When the unit cannot be told, or numbers and points in time are mixed.
    pub fn ms(&self, table: &Table, stamps: &[Stamp]) -> Result<(Vec<f64>, Option<String>)> {
        let numbers: Vec<f64> =
            stamps.iter().filter_map(|s| if let Stamp::Number(n) = s { Some(*n) } else { None }).collect();
        let moments = || stamps.iter().filter_map(|s| if let Stamp::Moment(ms) = s { Some(*ms) } else { None });
        let Some(column) = self.of(Quantity::Time).filter(|_| !numbers.is_empty()) else {
            return Ok((moments().collect(), None));
        };
        if numbers.len() < stamps.len() {
            let what = format!("{} holds both numbers and points in time", column.name);
            return Err(Error::in_file(&table.file, what));
        }
        if column.unit.is_some() {
            return Ok((numbers, None));
        }
        let (one, unit) = guessed(&numbers).ok_or_else(|| {
            let what = format!(
                "the unit of {} cannot be told: name it {0}_s, {0}_ms and the like, or give --time-unit",
                column.name
            );
            Error::at_line(&table.file, 1, what)
        })?;
        let told = format!("{} is in {unit}, by its size and spacing", column.name);
        Ok((numbers.into_iter().map(|number| number * one).collect(), Some(told)))
    }

    /// What the commands mean, which have been read by [`value`](Self::value).
    ///
    /// # Errors
    /// When motors get numbers that have to be explained.
    pub fn kind<'a>(&self, table: &Table, samples: impl Iterator<Item = &'a [f64; 2]>) -> Result<OfCommands> {
        let of = |kind| Ok(OfCommands { kind, factor: 1.0, guessed: None });
        let Some(left) = self.of(Quantity::Left) else { return of(Kind::Twist) };
        match left.unit.map(|unit| unit.dimension) {
            Some(Dimension::Speed) => return of(Kind::WheelSpeeds),
            Some(Dimension::Rate) => return of(Kind::WheelRates),
            Some(_) => return of(Kind::Motors),
            None => {}
        }
        let most = samples.flatten().map(|v| v.abs()).fold(0.0, f64::max);
        let (factor, range) = match most {
            most if most <= 1.0 => (100.0, "-1 to 1"),
            most if most <= 100.0 => (1.0, "-100 to 100"),
            _ => {
                let what = format!(
                    "commands of motors are as large as {most} and so exceed 100: say what motors get at full command, or their \
                     unit, in a --map, as left = {{ column = {:?}, unit = \"255\" }}",
                    left.name
                );
                return Err(Error::in_file(&table.file, what));
            }
        };
        let guessed = Some(format!("motors take {range}, since no command exceeds {most}"));
        Ok(OfCommands { kind: Kind::Motors, factor, guessed })
    }

    /// Which columns were taken as what.
    pub fn taken(&self) -> Vec<String> {
        self.columns.iter().map(|column| format!("{} = {}", column.quantity.name(), column.name)).collect()
    }

    /// The names of columns that were taken as nothing.
    pub fn left_over(&self, table: &Table) -> Vec<String> {
        let is_taken = |place: usize| self.columns.iter().any(|column| column.place == place);
        let names = table.names.iter().enumerate();
        names.filter(|(place, _)| !is_taken(*place)).map(|(_, name)| name.clone()).collect()
    }

    fn of(&self, quantity: Quantity) -> Option<&Column> {
        self.columns.iter().find(|column| column.quantity == quantity)
    }

    /// The same with the units that options state where names do not.
    fn with_units(mut self, units: &Units) -> std::result::Result<Self, Lack> {
        for column in &mut self.columns {
            let stated = |one: Option<f64>, dimension| one.map(|one| Unit { dimension, one });
            let length = units.length.map(|length| length.cm());
            let angle = units.angle.map(|angle| angle.rad());
            let (of_option, option) = match column.quantity.dimensions() {
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
            column.unit = column.unit.or(of_option);
            if let Some(how) = option.filter(|_| column.unit.is_none()) {
                return Err(Lack::Column(format!("column {0} has no unit: name it {0}{how}", column.name)));
            }
        }
        Ok(self)
    }

    /// The same if nothing is missing.
    fn complete(self, table: &Table) -> std::result::Result<Self, Lack> {
        let has = |quantity: &Quantity| self.has(*quantity);
        let missing = |quantity: Quantity, the: &str, names: &str| {
            let (what, others) = (quantity.name(), self.left_over(table).join(", "));
            let which = if others.is_empty() { String::new() } else { format!(" of {others}") };
            let map = format!("or say in a --map which one{which} it is, as {what} = \"its name\"");
            Err(Lack::Column(format!("no column for {the}{what}: name it {names}, {map}")))
        };
        if [TWIST, WHEELS].iter().flatten().chain(&POSES).chain([&Quantity::Range]).all(|quantity| !has(quantity)) {
            return Err(Lack::Anything);
        }
        if !has(&Quantity::Time) {
            return missing(Quantity::Time, "the ", "t_s, time_ms, timestamp or the like");
        }
        if TWIST.iter().any(has) && WHEELS.iter().any(has) {
            let of = |pair: [Quantity; 2]| pair.map(|q| self.of(q).map_or("", |column| &column.name)).join(" ");
            let what = format!("both speeds ({}) and wheels ({}) could be the commands", of(TWIST), of(WHEELS));
            return Err(Lack::Column(what + ": say in a --map which are"));
        }
        for [a, b] in [TWIST, WHEELS, [Quantity::X, Quantity::Y]] {
            if has(&a) != has(&b) {
                let lacking = if has(&a) { b } else { a };
                return missing(lacking, "", "as in docs/bring-your-own-robot.md");
            }
        }
        let unequal = WHEELS.map(|wheel| self.of(wheel).and_then(|column| Some(column.unit?.dimension)));
        if unequal[0] != unequal[1] {
            return Err(Lack::Column("left and right are in units of different kinds".into()));
        }
        let has_heading = has(&Quantity::Heading) || (has(&Quantity::Qz) && has(&Quantity::Qw));
        if has(&Quantity::X) && !has_heading {
            return missing(Quantity::Heading, "the ", "heading_deg, yaw_rad, or qx, qy, qz, qw of a quaternion");
        }
        Ok(self)
    }
}

impl OfCommands {
    /// What was guessed.
    pub fn guessed(&self) -> Option<&str> {
        self.guessed.as_deref()
    }
}

/// What keeps a table from being used.
enum Lack {
    /// No column holds anything of use.
    Anything,
    /// A column or its unit is missing.
    Column(String),
}

fn by_mapping(table: &Table, mapped: &[Mapped]) -> std::result::Result<Vec<Column>, String> {
    let column = |mapped: &Mapped| {
        let Mapped { quantity, column, unit, negate } = mapped;
        let place = table.names.iter().position(|name| name == column).ok_or_else(|| {
            format!("has no column {column:?}, which the --map names: its columns are {}", table.names.join(", "))
        })?;
        let unit = unit.or_else(|| meaning(column).unit.filter(|u| quantity.dimensions().contains(&u.dimension)));
        let sign = if *negate { -1.0 } else { 1.0 };
        Ok(Column { quantity: *quantity, place, name: column.clone(), unit, sign })
    };
    mapped.iter().map(column).collect()
}

fn by_names(table: &Table) -> std::result::Result<Vec<Column>, String> {
    let named = table.names.iter().enumerate().map(|(place, name)| (place, name, meaning(name)));
    let mut plain: Vec<_> = named.filter_map(|(place, name, said)| Some((said.quantity?, place, name, said))).collect();
    plain.sort_by_key(|(quantity, place, ..)| (*quantity, *place));
    let mut columns = Vec::new();
    for same in plain.chunk_by(|a, b| a.0 == b.0) {
        let commanded: Vec<_> = same.iter().filter(|(.., said)| said.is_commanded).collect();
        let quantity = same[0].0;
        let chosen = match (same, commanded.as_slice()) {
            ([_], _) => same.iter().collect(),
            (_, [_]) => commanded,
            // The seconds and what is beyond them.
            ([a, b], _) if quantity == Quantity::Time && a.3.unit.zip(b.3.unit).is_some_and(|(a, b)| a != b) => {
                vec![a, b]
            }
            _ => {
                let names: Vec<&str> = same.iter().map(|(_, _, name, _)| name.as_str()).collect();
                let names = names.join(", ");
                return Err(format!("more than one column for {}: {names}; say in a --map which one", quantity.name()));
            }
        };
        columns.extend(chosen.into_iter().map(|(quantity, place, name, said)| Column {
            quantity: *quantity,
            place: *place,
            name: (*name).clone(),
            unit: said.unit,
            sign: 1.0,
        }));
    }
    Ok(columns)
}
