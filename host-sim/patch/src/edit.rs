//! Changes of a text: digits in place, all other bytes as they are.

use std::ops::Range;

use super::estimate::Estimate;

/// A piece of text in place of another.
#[derive(Clone, Debug, PartialEq)]
pub struct Edit {
    /// The bytes that are replaced; empty where text is inserted.
    pub at: Range<usize>,
    /// What replaces them.
    pub text: String,
}

/// A change of one tag.
#[derive(Clone, Debug, PartialEq)]
pub struct Change {
    /// Where the tag is: an XPath, or a dotted path.
    pub tag: String,
    /// Its text before; empty if it is added.
    pub old: String,
    /// Its text afterwards.
    pub new: String,
    /// Unit of its numbers; empty if they have none.
    pub unit: &'static str,
    /// 95 % interval of the number that changes.
    pub ci95: Option<[f64; 2]>,
    /// What is done to the text.
    pub edits: Vec<Edit>,
    /// Why, with the formula.
    pub reason: String,
}

/// The changes that write a cause, or why it cannot be written, in words.
pub type Answer = Result<Vec<Change>, String>;

/// Numbers within a text, such as the three of a position.
#[derive(Clone, Debug)]
pub struct Numbers {
    /// Where they are, as [`Change::tag`].
    pub tag: String,
    text: String,
    start: usize,
    tokens: Vec<(Range<usize>, f64)>,
}

/// Significant digits of a written number: more than any measurement has, and fewer than those in which sines go wrong.
const DIGITS: i32 = 12;

impl Numbers {
    /// Reads numbers separated by blanks or commas at a range of a text.
    ///
    /// # Errors
    /// In words, if there is something else.
    pub fn parse(text: &str, at: Range<usize>, tag: String) -> Result<Self, String> {
        let own = &text[at.clone()];
        let is_blank = |c: char| c.is_whitespace() || c == ',';
        let mut tokens = Vec::new();
        for token in own.split(is_blank).filter(|token| !token.is_empty()) {
            let start = token.as_ptr() as usize - own.as_ptr() as usize;
            let number = token.parse::<f64>().ok().filter(|number| number.is_finite());
            let number = number.ok_or_else(|| format!("{tag} holds {:?}, which is not a number", own.trim()))?;
            tokens.push((start..start + token.len(), number));
        }
        Ok(Numbers { tag, text: own.into(), start: at.start, tokens })
    }

    /// Returns all numbers.
    pub fn values(&self) -> Vec<f64> {
        self.tokens.iter().map(|(_, number)| *number).collect()
    }

    /// Returns the number at an index.
    ///
    /// # Errors
    /// In words, if there is none.
    pub fn value(&self, index: usize) -> Result<f64, String> {
        let token = self.tokens.get(index).ok_or_else(|| format!("{} has no number {}", self.tag, index + 1))?;
        Ok(token.1)
    }

    /// Returns the change that writes other numbers at some indices. The interval is that of the first.
    pub fn set(&self, new: &[(usize, Estimate)], unit: &'static str, reason: String) -> Change {
        let edits = new.iter().filter_map(|(index, estimate)| {
            let (at, old) = self.tokens.get(*index)?;
            let written = number(estimate.value);
            // A number that stays keeps its digits.
            let is_same = written == number(*old);
            (!is_same).then(|| Edit { at: self.start + at.start..self.start + at.end, text: written })
        });
        let edits: Vec<Edit> = edits.collect();
        let local = |edit: &Edit| Edit { at: edit.at.start - self.start..edit.at.end - self.start, ..edit.clone() };
        let new_text = applied(&self.text, &edits.iter().map(local).collect::<Vec<Edit>>());
        Change {
            tag: self.tag.clone(),
            old: self.text.trim().into(),
            new: new_text.trim().into(),
            unit,
            ci95: new.first().and_then(|(_, estimate)| estimate.ci95),
            edits,
            reason,
        }
    }
}

/// Returns a text with edits applied. They must not overlap.
pub fn applied(text: &str, edits: &[Edit]) -> String {
    let mut edits: Vec<&Edit> = edits.iter().collect();
    edits.sort_by_key(|edit| edit.at.start);
    let (mut new, mut end) = (String::new(), 0);
    for Edit { at, text: inserted } in edits {
        new += &text[end..at.start];
        new += inserted;
        end = at.end;
    }
    new + &text[end..]
}

/// Returns a number in the shortest form that has [`DIGITS`] significant digits.
pub fn number(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return "0".into();
    }
    // Rounded by the decimal form, which is exact.
    let rounded: f64 = format!("{value:.*e}", DIGITS as usize - 1).parse().unwrap_or(value);
    // What is left of a quarter turn's cosine.
    if rounded.abs() < 1e-12 { "0".into() } else { format!("{rounded}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn estimate(value: f64) -> Estimate {
        Estimate { value, ci95: None }
    }

    #[test]
    fn digits_are_replaced_and_all_other_bytes_stay() {
        let text = "pos = ' 0\t0.0725  -0 ' # 0.0725";
        let at = 7..text.rfind('\'').expect("a quote");
        let numbers = Numbers::parse(text, at, "pos".into()).expect("numbers");
        let change = numbers.set(&[(1, estimate(0.0805))], "m", String::new());
        assert_eq!((change.old.as_str(), change.new.as_str()), ("0\t0.0725  -0", "0\t0.0805  -0"));
        assert_eq!(applied(text, &change.edits), "pos = ' 0\t0.0805  -0 ' # 0.0725");
    }

    #[test]
    fn numbers_have_twelve_digits_and_no_noise() {
        assert_eq!(number(0.1 + 0.2), "0.3");
        assert_eq!(number(-90.000_000_000_000_01), "-90");
        assert_eq!(number(6.1e-17), "0");
        assert_eq!(number(0.162 * 1.12), "0.18144");
        assert_eq!(number(1.0 / 3.0), "0.333333333333");
        assert_eq!(number(1.6e-7), "0.00000016");
    }

    #[test]
    fn expressions_are_not_numbers() {
        let error = Numbers::parse("${2*r}", 0..6, "radius".into()).expect_err("an expression");
        assert_eq!(error, "radius holds \"${2*r}\", which is not a number");
    }
}
