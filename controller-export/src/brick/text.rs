//! Conversion between numbers and text, as in the firmware's C library.

/// Formats a float with at most two decimals, or with six digits and an exponent if it would not fit on the display.
pub(super) fn from_float(x: f32) -> String {
    const FITS: std::ops::RangeInclusive<f32> = -1e12..=1e13;
    if x.is_nan() {
        return "nan".to_owned();
    }
    if x.is_infinite() {
        return if x > 0.0 { "inf" } else { "-inf" }.to_owned();
    }
    if !FITS.contains(&x) {
        return with_exponent(x);
    }
    let text = format!("{x:.2}");
    match text.strip_suffix('0') {
        Some(tenths) if tenths.ends_with('0') => format!("{x:.0}"),
        Some(tenths) => tenths.to_owned(),
        None => text,
    }
}

fn with_exponent(x: f32) -> String {
    let text = format!("{x:.5e}");
    let (digits, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    let digits = digits.trim_end_matches('0').trim_end_matches('.');
    format!("{digits}e+{exponent:0>2}")
}

/// Parses the number at the start of a text, after white space, as `%f` does in C.
pub(super) fn to_float(text: &[u8]) -> Option<f32> {
    let start = text.iter().position(|c| !c.is_ascii_whitespace())?;
    let text = &text[start..];
    let signs = usize::from(matches!(text.first(), Some(b'+' | b'-')));
    let digits = |from: usize| text[from..].iter().take_while(|c| c.is_ascii_digit()).count();
    let whole = digits(signs);
    let mut end = signs + whole;
    let mut decimals = 0;
    if text.get(end) == Some(&b'.') {
        decimals = digits(end + 1);
        end += 1 + decimals;
    }
    if whole + decimals == 0 {
        return None;
    }
    if let Some(b'e' | b'E') = text.get(end) {
        let sign = usize::from(matches!(text.get(end + 1), Some(b'+' | b'-')));
        let power = digits((end + 1 + sign).min(text.len()));
        if power > 0 {
            end += 1 + sign + power;
        }
    }
    std::str::from_utf8(&text[..end]).ok()?.parse().ok()
}

/// Returns the end of the first number in a text from `from`: digits with at most one decimal point.
pub(super) fn end_of_number(text: &[u8], from: usize) -> usize {
    let is_digit = |at: usize| text.get(at).is_some_and(u8::is_ascii_digit);
    let mut at = from;
    while at < text.len() && !is_digit(at) {
        at += 1;
    }
    let mut points = 0;
    while is_digit(at) || (points == 0 && text.get(at) == Some(&b'.')) {
        points += usize::from(!is_digit(at));
        at += 1;
    }
    at
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn floats_are_formatted_as_on_the_brick() {
        for (x, text) in [(0.0, "0"), (1.5, "1.5"), (-2.25, "-2.25"), (3.0, "3"), (0.004, "0"), (1e20, "1e+20")] {
            assert_eq!(from_float(x), text);
        }
        assert_eq!(from_float(-1.25e13), "-1.25e+13");
    }

    #[test]
    fn number_is_parsed_from_the_start_of_a_text() {
        assert_eq!(to_float(b" -12.5cm"), Some(-12.5));
        assert_eq!(to_float(b"1e2"), Some(100.0));
        assert_eq!(to_float(b"1e"), Some(1.0));
        assert_eq!(to_float(b"cm"), None);
        assert_eq!(to_float(b"-."), None);
        assert_eq!(end_of_number(b" -12.5.7", 0), 6);
    }
}
