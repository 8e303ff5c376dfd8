//! The short and the long form of a test. `tests/run.sh` runs the short forms, `tests/slow.sh` the long ones.

use std::io::{Write, stderr};
use std::sync::LazyLock;
use std::thread;

/// Returns whether the environment asks for long forms: `MINDGAP_SLOW=1`.
pub fn is_long() -> bool {
    static IS_LONG: LazyLock<bool> =
        LazyLock::new(|| std::env::var_os("MINDGAP_SLOW").is_some_and(|value| value == "1"));
    *IS_LONG
}

/// Returns the size of a test in the form that is asked for.
pub fn short_or_long<T>(short: T, long: T) -> T {
    if is_long() { long } else { short }
}

/// Returns whether a test that has only a long form is skipped. Says so in the words of the test runner, for the list of skipped
/// tests in `tests/run.sh`: unlike a macro's, this output is not captured.
///
/// # Panics
/// If standard error cannot be written.
pub fn is_skipped() -> bool {
    if !is_long() {
        let name = thread::current().name().unwrap_or("a test without a name").to_owned();
        write!(stderr(), "\ntest {name} ... ignored, MINDGAP_SLOW=1 runs it\n").expect("standard error");
    }
    !is_long()
}

/// Returns `count` of the items, evenly spread, or all of them where there are fewer.
pub fn spread<T>(items: Vec<T>, count: usize) -> Vec<T> {
    let (all, count) = (items.len(), count.min(items.len()));
    // The middle of each of `count` equal parts.
    let middle = |part: usize| (2 * part + 1) * all / (2 * count);
    let mut part = 0;
    let mut chosen = Vec::with_capacity(count);
    for (at, item) in items.into_iter().enumerate() {
        if part < count && at == middle(part) {
            chosen.push(item);
            part += 1;
        }
    }
    chosen
}

#[cfg(test)]
mod tests {
    use super::spread;

    #[test]
    fn items_are_spread_evenly() {
        let of_ten = |count| spread((0..10).collect(), count);
        assert_eq!((of_ten(1), of_ten(3), of_ten(0)), (vec![5], vec![1, 5, 8], vec![]));
        assert!(of_ten(10) == of_ten(100) && of_ten(10).len() == 10);
    }
}
