//! The terms that a formula may contain: simple factors and products of two.

use std::sync::LazyLock;

use mindgap_models::effects::own::expression::Expression;
use mindgap_models::effects::own::variables::{Circumstances, Stage};

/// A term with its values.
pub struct Term {
    /// As an expression.
    pub text: String,
    /// The units of its factors that have one.
    pub units: Vec<&'static str>,
    /// Number of factors.
    pub factors: usize,
    /// Its value for each row.
    pub values: Vec<f64>,
}

/// A factor as an expression, and its unit.
struct Factor {
    text: &'static str,
    unit: &'static str,
    expression: Expression,
}

/// Factors of motion: the predicted motion, its sign, its change, time, heading, and position.
const MOTION: &[(&str, &str)] = &[
    ("1", ""),
    ("forward_cm", "cm"),
    ("abs(forward_cm)", "cm"),
    ("sign(forward_cm)", ""),
    ("turn_rad", "rad"),
    ("abs(turn_rad)", "rad"),
    ("sign(turn_rad)", ""),
    ("(v_cm_s - previous_v_cm_s)", "cm/s"),
    ("abs(v_cm_s - previous_v_cm_s)", "cm/s"),
    ("(w_rad_s - previous_w_rad_s)", "rad/s"),
    ("abs(w_rad_s - previous_w_rad_s)", "rad/s"),
    ("elapsed_min", "min"),
    ("cos(heading_rad)", ""),
    ("sin(heading_rad)", ""),
    ("(x_cm - middle_x_cm)", "cm"),
    ("(y_cm - middle_y_cm)", "cm"),
];
/// Factors of readings: distance and incidence, time, heading, and position.
const READING: &[(&str, &str)] = &[
    ("1", ""),
    ("distance_cm", "cm"),
    ("incidence_rad", "rad"),
    ("abs(incidence_rad)", "rad"),
    ("elapsed_min", "min"),
    ("cos(heading_rad)", ""),
    ("sin(heading_rad)", ""),
    ("(x_cm - middle_x_cm)", "cm"),
    ("(y_cm - middle_y_cm)", "cm"),
];

static MOTION_FACTORS: LazyLock<Vec<Factor>> = LazyLock::new(|| compiled(MOTION, Stage::Motion));
static READING_FACTORS: LazyLock<Vec<Factor>> = LazyLock::new(|| compiled(READING, Stage::Reading));

/// Compiles factors. One that failed to compile would be left out; a test compiles all.
fn compiled(table: &[(&'static str, &'static str)], stage: Stage) -> Vec<Factor> {
    let factor = |(text, unit): &(&'static str, &'static str)| {
        Some(Factor { text, unit, expression: Expression::compile(text, &[], stage).ok()? })
    };
    table.iter().filter_map(factor).collect()
}

/// Returns all terms with their values, factors first. Unknown values count as zero.
pub fn terms(stage: Stage, rows: &[Circumstances]) -> Vec<Term> {
    let factors = if stage == Stage::Reading { &READING_FACTORS } else { &MOTION_FACTORS };
    let single = |factor: &Factor| Term {
        text: factor.text.into(),
        units: Some(factor.unit).filter(|unit| !unit.is_empty()).into_iter().collect(),
        factors: 1,
        values: rows.iter().map(|row| factor.expression.value(&[], row).unwrap_or(0.0)).collect(),
    };
    let singles: Vec<Term> = factors.iter().map(single).collect();
    // Products with the constant one are left out.
    let pairs = (1..singles.len()).flat_map(|i| (i..singles.len()).map(move |j| (i, j)));
    let products: Vec<Term> = pairs.map(|(i, j)| product(&singles[i], &singles[j])).collect();
    singles.into_iter().chain(products).collect()
}

fn product(one: &Term, other: &Term) -> Term {
    Term {
        text: format!("{} * {}", one.text, other.text),
        units: one.units.iter().chain(&other.units).copied().collect(),
        factors: one.factors + other.factors,
        values: one.values.iter().zip(&other.values).map(|(a, b)| a * b).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_factor_compiles() {
        assert_eq!((MOTION_FACTORS.len(), READING_FACTORS.len()), (MOTION.len(), READING.len()));
    }

    #[test]
    fn factors_come_before_products_without_duplicates() {
        let terms = terms(Stage::Reading, &[]);
        let n = READING.len();
        assert_eq!(terms.len(), n + (n - 1) * n / 2);
        assert!(terms[..n].iter().all(|term| term.factors == 1) && terms[n..].iter().all(|term| term.factors == 2));
        let squared = terms.iter().find(|term| term.text == "distance_cm * distance_cm").expect("a square");
        assert_eq!(squared.units, ["cm", "cm"]);
    }
}
