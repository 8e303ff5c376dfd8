//! Stamps: seconds, milliseconds and finer, since anything; Unix time; points in time as text (ISO 8601).

use jiff::Timestamp;
use jiff::civil::DateTime;
use jiff::tz::TimeZone;

use super::units::Time;
use mindgap_foundations::statistics::summary::median;

/// A stamp as it stands in a file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Stamp {
    /// A number, of a unit still to be known.
    Number(f64),
    /// A point in time, ms since 1970.
    Moment(f64),
}

/// A clock that goes back by more than this was set anew, ms; by less its stamps came in disorder.
const SET_ANEW_MS: f64 = 1000.0;

impl Stamp {
    /// Reads a cell; a point in time without its offset from UTC is taken to be in UTC.
    pub fn read(cell: &str) -> Option<Self> {
        if let Ok(number) = cell.parse::<f64>() {
            return number.is_finite().then_some(Stamp::Number(number));
        }
        let moment = cell.parse::<Timestamp>().ok();
        let moment = moment.or_else(|| TimeZone::UTC.to_timestamp(cell.parse::<DateTime>().ok()?).ok())?;
        Some(Stamp::Moment(moment.as_microsecond() as f64 / 1e3))
    }
}

/// The unit of stamps whose column names none, by their size and spacing; `None` where they could be of several.
pub fn guessed(numbers: &[f64]) -> Option<(f64, &'static str)> {
    let units = [(Time::S.ms(), "s"), (Time::Ms.ms(), "ms"), (Time::Us.ms(), "us"), (1e-6, "ns")];
    // From 2001 to 2065.
    let unix_ms = 1e12..3e12;
    let first = *numbers.first()?;
    if let Some(unit) = units.into_iter().find(|(ms, _)| unix_ms.contains(&(first * ms))) {
        return Some(unit);
    }
    // Nobody logs a drive slower than once in 900 ms, or faster than once in 2 ms.
    let spacing = median(numbers.windows(2).map(|pair| pair[1] - pair[0]).filter(|d| *d > 0.0));
    let fits = |ms: f64| (2.0..=900.0).contains(&(spacing * ms));
    let mut fitting = units.into_iter().filter(|(ms, _)| fits(*ms));
    fitting.next().filter(|_| fitting.next().is_none())
}

/// Which stamps, ms, come after all before them.
///
/// # Errors
/// When the clock was set back: the stamp's place, and what to do.
pub fn in_order(stamps_ms: &[f64]) -> std::result::Result<Vec<bool>, (usize, String)> {
    let mut latest_ms = f64::NEG_INFINITY;
    let kept = stamps_ms.iter().enumerate().map(|(i, ms)| {
        if latest_ms - ms > SET_ANEW_MS {
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
    fn points_in_time_are_read_with_and_without_an_offset() {
        let moment = |text| match Stamp::read(text) {
            Some(Stamp::Moment(ms)) => ms,
            other => panic!("{text}: {other:?}"),
        };
        assert_eq!(moment("2024-06-01T12:00:00Z"), 1_717_243_200_000.0);
        assert_eq!(moment("2024-06-01 12:00:00.250"), 1_717_243_200_250.0);
        assert_eq!(moment("2024-06-01T14:00:00.5+02:00"), 1_717_243_200_500.0);
        assert_eq!(Stamp::read("12.5"), Some(Stamp::Number(12.5)));
        assert_eq!([Stamp::read("noon"), Stamp::read("inf"), Stamp::read("")], [None; 3]);
    }

    #[test]
    fn units_are_told_by_size_and_spacing() {
        let every = |first: f64, step: f64| (0..5).map(|i| first + step * f64::from(i)).collect::<Vec<_>>();
        let unit = |first, step| guessed(&every(first, step)).map(|(_, unit)| unit);
        assert_eq!(unit(0.0, 0.02), Some("s"));
        assert_eq!(unit(1_717_243_200.0, 1.0), Some("s"));
        assert_eq!(unit(1_717_243_200_000.0, 20.0), Some("ms"));
        assert_eq!(unit(1.717_243_2e18, 2e7), Some("ns"));
        assert_eq!(unit(0.0, 400.0), Some("ms"));
        assert_eq!(unit(5.0, 20_000.0), Some("us"));
        assert_eq!(unit(5.0, 0.0), None);
    }

    #[test]
    fn disorder_is_left_out_and_a_clock_set_back_is_refused() {
        assert_eq!(in_order(&[0.0, 20.0, 20.0, 10.0, 40.0]), Ok(vec![true, true, false, false, true]));
        let (at, what) = in_order(&[0.0, 5000.0, 20.0]).expect_err("set back");
        assert!(at == 2 && what.contains("from 5.000 s to 0.020 s"), "{what}");
    }
}
