//! A compact, lossless column of numbers.

/// Marks a missing number among scaled integers.
const NONE: i32 = i32::MIN;
/// Maximum number of decimals to try: numbers with more come from arithmetic, not from a file.
const MAX_DECIMALS: usize = 4;
/// Powers of ten. All are exact, so that a scaled integer divided by one of them is the number that was written.
const POWERS: [f64; MAX_DECIMALS + 1] = [1.0, 10.0, 100.0, 1000.0, 10_000.0];

/// Optional numbers by row; rows beyond the stored ones have none.
#[derive(Clone)]
pub struct Column {
    unit: Unit,
    cells: Cells,
}

/// The unit of a number in memory relative to the one in the file.
#[derive(Clone, Copy)]
pub enum Unit {
    /// The same unit.
    AsWritten,
    /// Degrees in the file, radians in memory.
    DegreesToRadians,
}

#[derive(Clone)]
enum Cells {
    /// Integers scaled by a power of ten, as logs are written: half the size of floats.
    Decimal { decimals: usize, scaled: Vec<i32> },
    /// Floats, once one number is not such a decimal; NaN marks a missing number.
    Float(Vec<f64>),
}

impl Column {
    /// Returns a column without numbers.
    pub const fn new(unit: Unit) -> Self {
        Column { unit, cells: Cells::Decimal { decimals: 0, scaled: Vec::new() } }
    }

    /// Returns the number of a row.
    #[inline]
    pub fn get(&self, row: usize) -> Option<f64> {
        match &self.cells {
            Cells::Decimal { decimals, scaled } => {
                let scaled = scaled.get(row).copied().filter(|scaled| *scaled != NONE)?;
                Some(self.unit.decoded(scaled, *decimals))
            }
            Cells::Float(numbers) => numbers.get(row).copied().filter(|number| !number.is_nan()),
        }
    }

    /// Sets the number of a row.
    pub fn set(&mut self, row: usize, number: Option<f64>) {
        if let (Cells::Decimal { decimals, .. }, Some(number)) = (&self.cells, number)
            && self.unit.scaled(number, *decimals).is_none()
        {
            self.widen(number);
        }
        match &mut self.cells {
            Cells::Decimal { decimals, scaled } => {
                put(scaled, row, number.and_then(|number| self.unit.scaled(number, *decimals)), NONE);
            }
            Cells::Float(numbers) => put(numbers, row, number, f64::NAN),
        }
    }

    /// Keeps only the first `rows` rows.
    pub fn truncate(&mut self, rows: usize) {
        match &mut self.cells {
            Cells::Decimal { scaled, .. } => scaled.truncate(rows),
            Cells::Float(numbers) => numbers.truncate(rows),
        }
    }

    /// Releases spare capacity.
    pub fn shrink(&mut self) {
        match &mut self.cells {
            Cells::Decimal { scaled, .. } => scaled.shrink_to_fit(),
            Cells::Float(numbers) => numbers.shrink_to_fit(),
        }
    }

    /// Changes the representation to hold a number: more decimals if that is enough, otherwise floats.
    fn widen(&mut self, number: f64) {
        let Cells::Decimal { decimals, scaled } = &mut self.cells else { return };
        let finer = (*decimals + 1..=MAX_DECIMALS).find(|decimals| self.unit.scaled(number, *decimals).is_some());
        let rescaled = finer.and_then(|finer| Some((finer, rescaled(scaled, 10i32.pow((finer - *decimals) as u32))?)));
        self.cells = match rescaled {
            Some((decimals, scaled)) => Cells::Decimal { decimals, scaled },
            None => Cells::Float(
                scaled.iter().map(|u| if *u == NONE { f64::NAN } else { self.unit.decoded(*u, *decimals) }).collect(),
            ),
        };
    }
}

impl Unit {
    #[inline]
    fn decoded(self, scaled: i32, decimals: usize) -> f64 {
        let number = f64::from(scaled) / POWERS[decimals];
        match self {
            Unit::AsWritten => number,
            Unit::DegreesToRadians => number.to_radians(),
        }
    }

    /// Returns the scaled integer that stands for a number exactly, if there is one.
    fn scaled(self, number: f64, decimals: usize) -> Option<i32> {
        let written = match self {
            Unit::AsWritten => number,
            Unit::DegreesToRadians => number.to_degrees(),
        };
        // Numbers out of range saturate and then differ.
        let scaled = libm::round(written * POWERS[decimals]) as i32;
        (scaled != NONE && self.decoded(scaled, decimals).to_bits() == number.to_bits()).then_some(scaled)
    }
}

/// Sets a row of a vector, growing it as needed.
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

/// Multiplies all numbers by `factor`, unless one overflows.
fn rescaled(scaled: &[i32], factor: i32) -> Option<Vec<i32>> {
    scaled.iter().map(|u| if *u == NONE { Some(NONE) } else { u.checked_mul(factor) }).collect()
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Returns the numbers of a column after setting them row by row, and whether it stores them as decimals.
    fn stored(unit: Unit, numbers: &[Option<f64>]) -> (Vec<Option<f64>>, bool) {
        let mut column = Column::new(unit);
        numbers.iter().enumerate().for_each(|(row, number)| column.set(row, *number));
        let stored = (0..numbers.len()).map(|row| column.get(row)).collect();
        (stored, matches!(column.cells, Cells::Decimal { .. }))
    }

    #[test]
    fn numbers_with_few_decimals_are_stored_as_decimals() {
        let numbers = [Some(400.0), None, Some(-12.5), Some(0.07), Some(-7.25), None];
        assert_eq!(stored(Unit::AsWritten, &numbers), (numbers.to_vec(), true));
        let headings = [26.51, -179.99, 180.0].map(|degrees: f64| Some(degrees.to_radians()));
        assert_eq!(stored(Unit::DegreesToRadians, &headings), (headings.to_vec(), true));
    }

    #[test]
    fn other_numbers_switch_the_column_to_floats_without_loss() {
        for odd in [1.0 / 3.0, 1e12, f64::INFINITY, 5e-324] {
            let numbers = [None, Some(0.01), Some(odd), Some(2.0)];
            assert_eq!(stored(Unit::AsWritten, &numbers), (numbers.to_vec(), false));
        }
        // More decimals would overflow.
        let numbers = [Some(2e9), Some(0.25)];
        assert_eq!(stored(Unit::AsWritten, &numbers), (numbers.to_vec(), false));
        assert!(stored(Unit::AsWritten, &[Some(-0.0)]).0[0].is_some_and(f64::is_sign_negative));
    }

    #[test]
    fn empty_column_takes_no_memory() {
        let mut column = Column::new(Unit::AsWritten);
        (0..100).for_each(|row| column.set(row, None));
        assert!(matches!(&column.cells, Cells::Decimal { scaled, .. } if scaled.capacity() == 0));
        column.set(7, Some(1.5));
        assert_eq!([6, 7, 8].map(|row| column.get(row)), [None, Some(1.5), None]);
        column.truncate(7);
        assert_eq!(column.get(7), None);
    }

    proptest! {
        #[test]
        fn every_number_round_trips_bit_for_bit(
            numbers in prop::collection::vec(
                prop::option::of(prop_oneof![
                    (-1_000_000i32..1_000_000, 0u8..6).prop_map(|(scaled, decimals)| f64::from(scaled) / libm::pow(10.0, f64::from(decimals))),
                    any::<f64>().prop_filter("a number", |number| !number.is_nan()),
                ]),
                1..20,
            ),
            is_angle: bool,
        ) {
            let (stored, _) = stored(if is_angle { Unit::DegreesToRadians } else { Unit::AsWritten }, &numbers);
            let bits = |numbers: &[Option<f64>]| numbers.iter().map(|n| n.map(f64::to_bits)).collect::<Vec<_>>();
            prop_assert_eq!(bits(&stored), bits(&numbers));
        }
    }
}
