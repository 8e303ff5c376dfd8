//! Columns of commands: a speed and a turn rate, or one number per wheel.

use crate::column::Column;
use crate::quantities::{Dimension, Quantity};
use crate::recording::{Commands, Kind};
use crate::table::{Line, Table};
use mindgap_foundations::error::{Error, Result};

/// The two columns of commands.
#[derive(Clone, Debug)]
pub struct CommandColumns {
    /// Whether they are forward speed and turn rate rather than left and right.
    pub is_twist: bool,
    /// The columns.
    pub columns: [Column; 2],
}

/// The meaning of command pairs, their scale, and how it was guessed.
pub struct CommandKind {
    /// Meaning of the pairs.
    pub kind: Kind,
    /// Factor to multiply with.
    pub factor: f64,
    /// The guess, if it was one.
    pub guessed: Option<String>,
}

impl CommandKind {
    /// Returns the commands of rows with their times, ms; rows without a pair have none.
    pub fn commands(
        &self,
        rows: impl Iterator<Item = (usize, f64)>,
        pair: impl Fn(usize) -> Option<[f64; 2]>,
    ) -> Commands {
        let samples = rows.filter_map(|(row, ms)| Some((ms, pair(row)?.map(|number| number * self.factor))));
        Commands { kind: self.kind, samples: samples.collect() }
    }
}

impl CommandColumns {
    /// Combines two columns.
    ///
    /// # Errors
    /// When their units are of different kinds.
    pub fn of(is_twist: bool, columns: [Column; 2]) -> std::result::Result<Self, String> {
        let [a, b] = columns.each_ref().map(|column| column.unit.map(|unit| unit.dimension));
        if !is_twist && a != b {
            return Err("left and right have units of different kinds".into());
        }
        Ok(CommandColumns { is_twist, columns })
    }

    /// Returns the two columns with their quantities.
    pub fn assignments(&self) -> [(Quantity, &Column); 2] {
        let quantities =
            if self.is_twist { [Quantity::Forward, Quantity::Turn] } else { [Quantity::Left, Quantity::Right] };
        let [a, b] = &self.columns;
        [(quantities[0], a), (quantities[1], b)]
    }

    /// Returns the pair in a line; `None` if a cell is empty.
    ///
    /// # Errors
    /// When a cell is not a number.
    pub fn pair(&self, line: &Line) -> Result<Option<[f64; 2]>> {
        let [a, b] = &self.columns;
        Ok(a.value(line)?.zip(b.value(line)?).map(|(a, b)| [a, b]))
    }

    /// Determines the meaning of the commands, as read by [`pair`](Self::pair).
    ///
    /// # Errors
    /// When motor commands exceed 100 and have no stated unit.
    pub fn kind(&self, table: &Table, pairs: impl Iterator<Item = [f64; 2]>) -> Result<CommandKind> {
        let exact = |kind| Ok(CommandKind { kind, factor: 1.0, guessed: None });
        let left = &self.columns[0];
        match left.unit.map(|unit| unit.dimension) {
            _ if self.is_twist => return exact(Kind::Twist),
            Some(Dimension::Speed) => return exact(Kind::WheelSpeeds),
            Some(Dimension::Rate) => return exact(Kind::WheelRates),
            Some(_) => return exact(Kind::Motors),
            None => {}
        }
        let max = pairs.flatten().map(|v| v.abs()).fold(0.0, f64::max);
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
}
