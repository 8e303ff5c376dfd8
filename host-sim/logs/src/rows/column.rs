//! One column of a run in as little memory as keeps every number exactly as it was.

/// Stands for no number among units.
const NONE: i32 = i32::MIN;
/// Numbers are tried with up to so many places: what has more comes of arithmetic and not of a file.
const MOST_PLACES: usize = 4;
/// Powers of ten; all are exact, so that a quotient of units and one of them is the number that was written.
const POWERS: [f64; MOST_PLACES + 1] = [1.0, 10.0, 100.0, 1000.0, 10_000.0];

/// Numbers, or none, by row; all rows behind the last that is there have none.
#[derive(Clone)]
pub struct Column {
    meaning: Meaning,
    cells: Cells,
}

/// What a number means beside how it is written.
#[derive(Clone, Copy)]
pub enum Meaning {
    /// The same.
    Same,
    /// Written in degrees, meant in radians.
    Angle,
}

#[derive(Clone)]
enum Cells {
    /// Units of a power of ten, as logs are written: half of what a float takes.
    Decimal { places: usize, units: Vec<i32> },
    /// Floats, once one of them is no such number; NaN stands for none.
    Float(Vec<f64>),
}

impl Column {
    /// A column without any number.
    pub const fn new(meaning: Meaning) -> Self {
        Column { meaning, cells: Cells::Decimal { places: 0, units: Vec::new() } }
    }

    /// The number of a row.
    #[inline]
    pub fn get(&self, row: usize) -> Option<f64> {
        match &self.cells {
            Cells::Decimal { places, units } => {
                let units = units.get(row).copied().filter(|units| *units != NONE)?;
                Some(self.meaning.of(units, *places))
            }
            Cells::Float(numbers) => numbers.get(row).copied().filter(|number| !number.is_nan()),
        }
    }

    /// Sets the number of a row.
    pub fn set(&mut self, row: usize, number: Option<f64>) {
        if let (Cells::Decimal { places, .. }, Some(number)) = (&self.cells, number)
            && self.meaning.units(number, *places).is_none()
        {
            self.widen(number);
        }
        match &mut self.cells {
            Cells::Decimal { places, units } => {
                put(units, row, number.and_then(|number| self.meaning.units(number, *places)), NONE);
            }
            Cells::Float(numbers) => put(numbers, row, number, f64::NAN),
        }
    }

    /// Keeps the first rows only.
    pub fn truncate(&mut self, rows: usize) {
        match &mut self.cells {
            Cells::Decimal { units, .. } => units.truncate(rows),
            Cells::Float(numbers) => numbers.truncate(rows),
        }
    }

    /// Gives back memory that is kept for further rows.
    pub fn shrink(&mut self) {
        match &mut self.cells {
            Cells::Decimal { units, .. } => units.shrink_to_fit(),
            Cells::Float(numbers) => numbers.shrink_to_fit(),
        }
    }

    /// Makes room for a number that the present units do not hold: more places if that does, else floats.
    fn widen(&mut self, number: f64) {
        let Cells::Decimal { places, units } = &mut self.cells else { return };
        let finer = (*places + 1..=MOST_PLACES).find(|places| self.meaning.units(number, *places).is_some());
        let rescaled = finer.and_then(|finer| Some((finer, rescaled(units, 10i32.pow((finer - *places) as u32))?)));
        self.cells = match rescaled {
            Some((places, units)) => Cells::Decimal { places, units },
            None => Cells::Float(
                units.iter().map(|u| if *u == NONE { f64::NAN } else { self.meaning.of(*u, *places) }).collect(),
            ),
        };
    }
}

impl Meaning {
    #[inline]
    fn of(self, units: i32, places: usize) -> f64 {
        let number = f64::from(units) / POWERS[places];
        match self {
            Meaning::Same => number,
            Meaning::Angle => number.to_radians(),
        }
    }

    /// The units that mean a number to its last bit, if there are such.
    fn units(self, number: f64, places: usize) -> Option<i32> {
        let written = match self {
            Meaning::Same => number,
            Meaning::Angle => number.to_degrees(),
        };
        // What does not fit is cut off, and then is not the same.
        let units = libm::round(written * POWERS[places]) as i32;
        (units != NONE && self.of(units, places).to_bits() == number.to_bits()).then_some(units)
    }
}

/// Sets a row of a vector, which grows as far as it must.
fn put<T: Copy>(cells: &mut Vec<T>, row: usize, value: Option<T>, none: T) {
    match (cells.get_mut(row), value) {
        (Some(cell), value) => *cell = value.unwrap_or(none),
        (None, Some(value)) => {
            cells.resize(row, none);
            cells.push(value);
        }
        (None, None) => (),
    }
}

/// The same numbers in finer units, unless one is too large.
fn rescaled(units: &[i32], factor: i32) -> Option<Vec<i32>> {
    units.iter().map(|u| if *u == NONE { Some(NONE) } else { u.checked_mul(factor) }).collect()
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// What a column that is given numbers row by row says of them, and whether it keeps them as decimals.
    fn kept(meaning: Meaning, numbers: &[Option<f64>]) -> (Vec<Option<f64>>, bool) {
        let mut column = Column::new(meaning);
        numbers.iter().enumerate().for_each(|(row, number)| column.set(row, *number));
        let kept = (0..numbers.len()).map(|row| column.get(row)).collect();
        (kept, matches!(column.cells, Cells::Decimal { .. }))
    }

    #[test]
    fn numbers_of_few_places_are_kept_as_decimals() {
        let numbers = [Some(400.0), None, Some(-12.5), Some(0.07), Some(-7.25), None];
        assert_eq!(kept(Meaning::Same, &numbers), (numbers.to_vec(), true));
        let headings = [26.51, -179.99, 180.0].map(|degrees: f64| Some(degrees.to_radians()));
        assert_eq!(kept(Meaning::Angle, &headings), (headings.to_vec(), true));
    }

    #[test]
    fn a_number_that_is_no_decimal_makes_floats_of_all_and_changes_none() {
        for odd in [1.0 / 3.0, 1e12, f64::INFINITY, 5e-324] {
            let numbers = [None, Some(0.01), Some(odd), Some(2.0)];
            assert_eq!(kept(Meaning::Same, &numbers), (numbers.to_vec(), false));
        }
        // Finer units would be too large.
        let numbers = [Some(2e9), Some(0.25)];
        assert_eq!(kept(Meaning::Same, &numbers), (numbers.to_vec(), false));
        assert!(kept(Meaning::Same, &[Some(-0.0)]).0[0].is_some_and(f64::is_sign_negative));
    }

    #[test]
    fn a_column_without_numbers_takes_no_memory() {
        let mut column = Column::new(Meaning::Same);
        (0..100).for_each(|row| column.set(row, None));
        assert!(matches!(&column.cells, Cells::Decimal { units, .. } if units.capacity() == 0));
        column.set(7, Some(1.5));
        assert_eq!([6, 7, 8].map(|row| column.get(row)), [None, Some(1.5), None]);
        column.truncate(7);
        assert_eq!(column.get(7), None);
    }

    proptest! {
        #[test]
        fn every_number_comes_back_to_its_last_bit(
            numbers in prop::collection::vec(
                prop::option::of(prop_oneof![
                    (-1_000_000i32..1_000_000, 0u8..6).prop_map(|(units, places)| f64::from(units) / libm::pow(10.0, f64::from(places))),
                    any::<f64>().prop_filter("a number", |number| !number.is_nan()),
                ]),
                1..20,
            ),
            is_angle: bool,
        ) {
            let (kept, _) = kept(if is_angle { Meaning::Angle } else { Meaning::Same }, &numbers);
            let bits = |numbers: &[Option<f64>]| numbers.iter().map(|n| n.map(f64::to_bits)).collect::<Vec<_>>();
            prop_assert_eq!(bits(&kept), bits(&numbers));
        }
    }
}
