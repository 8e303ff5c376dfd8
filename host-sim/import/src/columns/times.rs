//! Columns of times. A table may have several clocks: the time of receipt, the stamps in messages, a date and a time of day.

use crate::column::Column;
use crate::left_out::LeftOut;
use crate::table::{Line, Table};
use crate::timestamps::{Stamp, guess_unit, moments_ms};
use mindgap_foundations::error::{Error, Result};
use mindgap_foundations::statistics::summary::median;

/// The columns of one clock: one, or seconds and the fraction of a second.
#[derive(Clone, Debug)]
pub struct TimeColumns {
    /// The columns, coarsest unit first.
    pub columns: Vec<Column>,
    /// Whether they are stamps in messages.
    pub is_stamp: bool,
    /// Whether they belong to the topic of all other columns.
    pub is_shared: bool,
}

/// The timestamps of a table, as read.
pub struct ReadTimes<'a> {
    table: &'a Table,
    clocks: &'a [TimeColumns],
    /// The stamps by clock; empty for clocks that lack some.
    stamps: Vec<Vec<Stamp>>,
    rows: usize,
    /// The first cell that is not a time.
    error: Option<Error>,
}

/// The timestamps of the chosen clock.
pub struct Times {
    /// The times, ms.
    pub ms: Vec<f64>,
    /// The column of the clock.
    pub name: String,
    /// Guesses made.
    pub guessed: Vec<String>,
    /// The other clocks.
    pub left_out: Vec<LeftOut>,
}

/// Stamps in messages further than this from the times of receipt are on another clock, ms.
const SAME_CLOCK_MS: f64 = 1000.0;

impl TimeColumns {
    /// Returns the name of the clock.
    pub fn name(&self) -> String {
        self.columns.iter().map(|column| column.name.as_str()).collect::<Vec<_>>().join(" and ")
    }

    /// Returns the timestamp in a line, in ms if it is a number of known unit.
    fn stamp(&self, line: &Line) -> Option<Stamp> {
        let scaled = |column: &Column| {
            let cell = line.text(column.index);
            let number = || line.number(column.index).ok().flatten().filter(|number| number.is_finite());
            let factor = column.unit.map_or(1.0, |unit| unit.factor);
            match Stamp::parse(cell).or_else(|| number().map(Stamp::Number))? {
                Stamp::Number(number) => Some(Stamp::Number(number * factor)),
                moment => Some(moment),
            }
        };
        match self.columns.as_slice() {
            [whole, fraction] => match (scaled(whole)?, scaled(fraction)?) {
                (Stamp::Number(whole_ms), Stamp::Number(ms)) => {
                    let unit_ms = whole.unit.map_or(1.0, |unit| unit.factor);
                    let is_fraction = (0.0..unit_ms).contains(&ms) && whole_ms % unit_ms == 0.0;
                    is_fraction.then_some(Stamp::Number(whole_ms + ms))
                }
                _ => None,
            },
            columns => scaled(columns.first()?),
        }
    }

    /// Converts stamps to ms; also returns a description of the guessed unit, if any.
    fn ms(&self, table: &Table, stamps: &[Stamp]) -> Result<(Vec<f64>, Option<String>)> {
        let column = &self.columns[0];
        let number = |stamp: &Stamp| if let Stamp::Number(number) = stamp { Some(*number) } else { None };
        let numbers: Vec<f64> = stamps.iter().filter_map(number).collect();
        if numbers.is_empty() {
            let what = || Error::in_file(&table.file, format!("{} contains different kinds of times", column.name));
            return Ok((moments_ms(stamps).ok_or_else(what)?, None));
        }
        if numbers.len() < stamps.len() {
            return Err(Error::in_file(&table.file, format!("{} contains both numbers and dates", column.name)));
        }
        if column.unit.is_some() {
            return Ok((numbers, None));
        }
        // PlotJuggler writes seconds.
        let guessed = if column.name == "__time" { Some((1e3, "s")) } else { guess_unit(&numbers) };
        let (factor, unit) = guessed.ok_or_else(|| {
            let what = format!(
                "the unit of {} cannot be determined: name it {0}_s, {0}_ms and the like, or give --time-unit",
                column.name
            );
            Error::at_line(&table.file, table.header.line, what)
        })?;
        let description = format!("{} is in {unit}, judging by size and spacing", column.name);
        Ok((numbers.into_iter().map(|number| number * factor).collect(), Some(description)))
    }
}

impl<'a> ReadTimes<'a> {
    /// Starts to read the times of a table.
    pub fn new(table: &'a Table, clocks: &'a [TimeColumns]) -> Self {
        ReadTimes { table, clocks, stamps: vec![Vec::new(); clocks.len()], rows: 0, error: None }
    }

    /// Reads the times in a line.
    ///
    /// # Errors
    /// When the only clock has none.
    pub fn push(&mut self, line: &Line) -> Result<()> {
        for (clock, stamps) in self.clocks.iter().zip(&mut self.stamps) {
            let stamp = clock.stamp(line);
            if stamp.is_none() && self.error.is_none() {
                let column = &clock.columns[0];
                let cell = crate::table::shortened(line.text(column.index));
                let what =
                    format!("{} = {cell:?} is not a time: write a number or 2024-06-01T12:00:00.000Z", column.name);
                self.error = Some(line.error(what));
                if self.clocks.len() == 1 {
                    return self.error.take().map_or(Ok(()), Err);
                }
            }
            if let Some(stamp) = stamp.filter(|_| stamps.len() == self.rows) {
                stamps.push(stamp);
            }
        }
        self.rows += 1;
        Ok(())
    }

    /// Chooses the clock: stamps in the messages if they are set and on the clock of the times of receipt; otherwise the times of
    /// receipt with the finest resolution.
    ///
    /// # Errors
    /// When no clock is usable.
    pub fn choose(mut self) -> Result<Times> {
        let dated = self.dated();
        let whole: Vec<usize> = (0..self.clocks.len()).filter(|clock| self.stamps[*clock].len() == self.rows).collect();
        let mut read = Vec::new();
        let mut error = self.error.take();
        for clock in whole {
            match self.clocks[clock].ms(self.table, &self.stamps[clock]) {
                Ok((ms, guessed)) => read.push((&self.clocks[clock], ms, guessed)),
                Err(e) => error = error.or(Some(e)),
            }
        }
        let steps = |ms: &[f64]| ms.windows(2).filter(|pair| pair[1] > pair[0]).count();
        // The first of the finest; a clock without steps does not run.
        let finest = |is_stamp: bool| {
            let candidates = read.iter().enumerate().rev().filter(|(_, (clock, ..))| clock.is_stamp == is_stamp);
            candidates.max_by_key(|(_, (clock, ms, _))| (steps(ms), clock.columns[0].unit.is_some())).map(|(i, _)| i)
        };
        let receipt = finest(false);
        let stamp = finest(true).filter(|i| steps(&read[*i].1) > 0 && (read[*i].0.is_shared || receipt.is_none()));
        let off_ms =
            receipt.zip(stamp).map(|(a, b)| median(read[a].1.iter().zip(&read[b].1).map(|(a, b)| (a - b).abs())));
        let chosen = match (receipt, stamp, off_ms) {
            (_, Some(stamp), None) => stamp,
            (_, Some(stamp), Some(off_ms)) if off_ms <= SAME_CLOCK_MS => stamp,
            (Some(receipt), ..) => receipt,
            (None, ..) => {
                let what =
                    || Error::at_line(&self.table.file, self.table.header.line, "no column of times is complete");
                return Err(error.unwrap_or_else(what));
            }
        };
        let (clock, ms, guessed) = read.swap_remove(chosen);
        let name = dated.unwrap_or_else(|| clock.name());
        let mut guessed: Vec<String> = guessed.into_iter().collect();
        let reason = if clock.is_stamp && receipt.is_some() {
            guessed.push(format!(
                "time = {name}, the stamps in the messages, which are within 1 s of the times of receipt"
            ));
            format!("another clock: the stamps in {name} are used")
        } else if receipt.is_some() && off_ms.is_some() {
            guessed
                .push(format!("time = {name}, the times of receipt: the stamps in the messages are on another clock"));
            format!("stamps in the messages on another clock than {name}")
        } else {
            format!("another clock: {name} is used")
        };
        let is_used = |columns: &TimeColumns| name.contains(&columns.name());
        let unused = self.clocks.iter().filter(|columns| !is_used(columns));
        let left_out =
            unused.flat_map(|c| &c.columns).map(|column| LeftOut::column(&column.name, reason.clone())).collect();
        Ok(Times { ms, name, guessed, left_out })
    }

    /// Combines a column of dates and one of times of day to one clock, and returns the names of both.
    fn dated(&mut self) -> Option<String> {
        let first_is = |is: fn(&Stamp) -> bool| {
            let is_whole = |stamps: &&Vec<Stamp>| stamps.len() == self.rows && stamps.first().is_some_and(is);
            self.stamps.iter().position(|stamps| is_whole(&stamps))
        };
        let date = first_is(|stamp| matches!(stamp, Stamp::Date(_)))?;
        let time = first_is(|stamp| matches!(stamp, Stamp::OfDay(_)))?;
        let both = self.stamps[date].iter().zip(&self.stamps[time]).map(|(date, time)| date.with(*time));
        self.stamps[time] = both.collect::<Option<_>>()?;
        self.stamps[date].clear();
        Some(format!("{} and {}", self.clocks[date].name(), self.clocks[time].name()))
    }
}
