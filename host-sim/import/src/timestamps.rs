//! Timestamps: numbers in seconds, milliseconds or finer, from any origin or as Unix time, and ISO 8601 text.

use jiff::Timestamp;
use jiff::civil::{Date, DateTime};
use jiff::tz::TimeZone;

use super::units::Time;
use mindgap_foundations::statistics::summary::median;

/// A timestamp as written in a file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Stamp {
    /// A number in a unit yet unknown.
    Number(f64),
    /// A date and time, ms since 1970.
    Moment(f64),
    /// A time of day, ms since midnight.
    OfDay(f64),
    /// A date alone, ms since 1970.
    Date(f64),
}

/// A clock that goes back by more than this was reset, ms; by less, its timestamps are out of order.
const RESET_MS: f64 = 1000.0;
/// A time of day that goes back by more than this has passed midnight, ms.
const MIDNIGHT_MS: f64 = 4.32e7;
const DAY_MS: f64 = 8.64e7;
/// Digits of a fraction of a second that are parsed; no clock has more.
const FRACTION_DIGITS: usize = 9;

impl Stamp {
    /// Parses a cell; a date without an offset from UTC is taken as UTC.
    pub fn parse(cell: &str) -> Option<Self> {
        if let Ok(number) = cell.parse::<f64>() {
            return number.is_finite().then_some(Stamp::Number(number));
        }
        // Words and other cells without digits are the most frequent.
        if !cell.contains(|c: char| c.is_ascii_digit()) || cell.len() > 64 {
            return None;
        }
        let text = with_short_fraction(cell);
        let moment = || Some(text.parse::<Timestamp>().ok()?.as_microsecond() as f64 / 1e3);
        moment().map(Stamp::Moment).or_else(|| civil(&text))
    }

    /// Returns the moment of a date and a time of day in two columns.
    pub fn with(self, other: Self) -> Option<Self> {
        match (self, other) {
            (Stamp::Date(day_ms), Stamp::OfDay(ms)) | (Stamp::OfDay(ms), Stamp::Date(day_ms)) => {
                Some(Stamp::Moment(day_ms + ms))
            }
            _ => None,
        }
    }
}

/// Converts dates and times of day to ms; `None` if kinds are mixed. Times of day continue after midnight.
pub fn moments_ms(stamps: &[Stamp]) -> Option<Vec<f64>> {
    let (mut days_ms, mut before_ms) = (0.0, f64::NEG_INFINITY);
    let ms = stamps.iter().map(|stamp| match stamp {
        Stamp::Moment(ms) => Some(*ms),
        Stamp::OfDay(ms) => {
            if before_ms - ms > MIDNIGHT_MS {
                days_ms += DAY_MS;
            }
            before_ms = *ms;
            Some(days_ms + ms)
        }
        Stamp::Number(_) | Stamp::Date(_) => None,
    });
    let is_of_day = |stamp: &Stamp| matches!(stamp, Stamp::OfDay(_));
    let is_mixed = stamps.iter().any(is_of_day) && !stamps.iter().all(is_of_day);
    if is_mixed { None } else { ms.collect() }
}

/// Writes a decimal comma as a point, and cuts a fraction to the digits that can be parsed.
fn with_short_fraction(cell: &str) -> String {
    let is_comma = cell.contains(':') && !cell.contains('.');
    let text = if is_comma { cell.replacen(',', ".", 1) } else { cell.to_owned() };
    let Some((whole, rest)) = text.split_once('.') else { return text };
    let digits = rest.bytes().take_while(u8::is_ascii_digit).count();
    format!("{whole}.{}{}", &rest[..digits.min(FRACTION_DIGITS)], &rest[digits..])
}

/// Parses dates and times without an offset from UTC, such as `2024-06-01 12:00:00.5`, `6/1/2024`, `12:00:00.5` or `1:00:00 PM`.
fn civil(text: &str) -> Option<Stamp> {
    let utc_ms = |moment: DateTime| {
        let moment = TimeZone::UTC.to_timestamp(moment).ok()?;
        Some(moment.as_microsecond() as f64 / 1e3)
    };
    let (text, afternoon) = match text.to_ascii_lowercase() {
        lower if lower.ends_with("pm") => (&text[..text.len() - 2], Some(true)),
        lower if lower.ends_with("am") => (&text[..text.len() - 2], Some(false)),
        _ => (text, None),
    };
    let mut parts = text.split(['T', ' ']).filter(|part| !part.is_empty());
    match (parts.next()?, parts.next(), parts.next()) {
        (date, None, _) if date.contains(['-', '/']) => Some(Stamp::Date(utc_ms(day(date)?.at(0, 0, 0, 0))?)),
        (time, None, _) => Some(Stamp::OfDay(of_day_ms(time, afternoon)?)),
        (date, Some(time), None) => {
            Some(Stamp::Moment(utc_ms(day(date)?.at(0, 0, 0, 0))? + of_day_ms(time, afternoon)?))
        }
        _ => None,
    }
}

/// Parses a date: year, month, day; or month and day, in either order, and the year.
fn day(text: &str) -> Option<Date> {
    let numbers = text.split(['-', '/', '.']).map(str::parse);
    let [a, b, c]: [i16; 3] = numbers.collect::<Result<Vec<i16>, _>>().ok()?.try_into().ok()?;
    let date = |year: i16, month: i16, day: i16| Date::new(year, month.try_into().ok()?, day.try_into().ok()?).ok();
    if a > 31 { date(a, b, c) } else { date(c, a, b).or_else(|| date(c, b, a)) }
}

fn of_day_ms(text: &str, afternoon: Option<bool>) -> Option<f64> {
    let mut parts = text.split(':');
    let mut whole = |below: u32| parts.next()?.parse::<u32>().ok().filter(|value| *value < below);
    let (hours, minutes) = (whole(24)?, whole(60)?);
    let seconds = parts.next().map_or(Some(0.0), |text| text.parse::<f64>().ok())?;
    let is_whole = parts.next().is_none() && (0.0..61.0).contains(&seconds);
    let hours = afternoon.map_or(hours, |afternoon| hours % 12 + if afternoon { 12 } else { 0 });
    is_whole.then_some(f64::from(hours * 60 + minutes) * 6e4 + seconds * 1e3)
}

/// Guesses the unit of timestamps from their size and spacing; `None` if ambiguous.
pub fn guess_unit(numbers: &[f64]) -> Option<(f64, &'static str)> {
    let units = [(Time::S.ms(), "s"), (Time::Ms.ms(), "ms"), (Time::Us.ms(), "us"), (1e-6, "ns")];
    // Unix times from 2001 to 2065.
    let unix_ms = 1e12..3e12;
    let first = *numbers.first()?;
    if let Some(unit) = units.into_iter().find(|(ms, _)| unix_ms.contains(&(first * ms))) {
        return Some(unit);
    }
    // Robots are logged at intervals between 2 ms and 900 ms.
    let spacing = median(numbers.windows(2).map(|pair| pair[1] - pair[0]).filter(|d| *d > 0.0));
    let fits = |ms: f64| (2.0..=900.0).contains(&(spacing * ms));
    let mut fitting = units.into_iter().filter(|(ms, _)| fits(*ms));
    fitting.next().filter(|_| fitting.next().is_none())
}

/// Returns which timestamps, ms, are later than all before them.
///
/// # Errors
/// When the clock was reset: the index of the timestamp, and a message.
pub fn in_order(stamps_ms: &[f64]) -> std::result::Result<Vec<bool>, (usize, String)> {
    let mut latest_ms = f64::NEG_INFINITY;
    let kept = stamps_ms.iter().enumerate().map(|(i, ms)| {
        if latest_ms - ms > RESET_MS {
            let what = format!(
                "the clock goes back from {:.3} s to {:.3} s: cut the recording here and import both parts",
                latest_ms / 1e3,
                ms / 1e3
            );
            return Err((i, what));
        }
        let is_later = *ms > latest_ms;
        latest_ms = latest_ms.max(*ms);
        Ok(is_later)
    });
    kept.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dates_are_parsed_with_and_without_an_offset() {
        let moment = |text| match Stamp::parse(text) {
            Some(Stamp::Moment(ms)) => ms,
            other => panic!("{text}: {other:?}"),
        };
        assert_eq!(moment("2024-06-01T12:00:00Z"), 1_717_243_200_000.0);
        assert_eq!(moment("2024-06-01 12:00:00.250"), 1_717_243_200_250.0);
        assert_eq!(moment("2024-06-01T14:00:00.5+02:00"), 1_717_243_200_500.0);
        assert_eq!(moment("2024-06-01T12:00:00.2500000001Z"), 1_717_243_200_250.0);
        assert_eq!(moment("2024-06-01 12:00:00,250"), 1_717_243_200_250.0);
        assert_eq!(moment("6/1/2024 12:00:00 PM"), 1_717_243_200_000.0);
        assert_eq!(moment("2024/06/01 12:00"), 1_717_243_200_000.0);
        assert_eq!(Stamp::parse("12.5"), Some(Stamp::Number(12.5)));
        assert_eq!([Stamp::parse("noon"), Stamp::parse("inf"), Stamp::parse("")], [None; 3]);
    }

    #[test]
    fn times_of_day_continue_after_midnight() {
        let day: Vec<Stamp> = ["23:59:59.5", "00:00:00.25"].into_iter().filter_map(Stamp::parse).collect();
        assert_eq!(moments_ms(&day), Some(vec![86_399_500.0, 86_400_250.0]));
        let [date, time] = ["2024-06-01", "12:00:00"].map(|cell| Stamp::parse(cell).expect("parsed"));
        assert_eq!(date.with(time), Some(Stamp::Moment(1_717_243_200_000.0)));
        assert_eq!(moments_ms(&[date, time]), None);
        assert_eq!(["25:00:00", "12:61:00", "12:00:00:00", "31-31-31"].map(Stamp::parse), [None; 4]);
    }

    #[test]
    fn units_are_guessed_from_size_and_spacing() {
        let every = |first: f64, step: f64| (0..5).map(|i| first + step * f64::from(i)).collect::<Vec<_>>();
        let unit = |first, step| guess_unit(&every(first, step)).map(|(_, unit)| unit);
        assert_eq!(unit(0.0, 0.02), Some("s"));
        assert_eq!(unit(1_717_243_200.0, 1.0), Some("s"));
        assert_eq!(unit(1_717_243_200_000.0, 20.0), Some("ms"));
        assert_eq!(unit(1.717_243_2e18, 2e7), Some("ns"));
        assert_eq!(unit(0.0, 400.0), Some("ms"));
        assert_eq!(unit(5.0, 20_000.0), Some("us"));
        assert_eq!(unit(5.0, 0.0), None);
    }

    #[test]
    fn disorder_is_skipped_and_clock_reset_is_rejected() {
        assert_eq!(in_order(&[0.0, 20.0, 20.0, 10.0, 40.0]), Ok(vec![true, true, false, false, true]));
        let (at, what) = in_order(&[0.0, 5000.0, 20.0]).expect_err("set back");
        assert!(at == 2 && what.contains("from 5.000 s to 0.020 s"), "{what}");
    }
}
