//! The cheapest reading of a sequence of which some members are wrong: which to keep, in which state, and where it breaks.

use std::collections::VecDeque;

/// What it costs to leave a member out.
const LEAVE_OUT: f64 = 2.0;
/// What it costs to go on from a member that the next one cannot follow: two members left out are likelier than that, and
/// a jump that stays is likelier than three.
const BREAK: f64 = 5.0;
/// What it costs to change state: there and back is just likelier than a member left out.
const SWITCH: f64 = 0.9;
/// Members left out one after the other; more than two cost more than a break.
const MOST_LEFT_OUT: usize = 4;

/// A member that is kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Kept {
    /// Its state.
    pub state: u8,
    /// It cannot follow the one before.
    pub breaks: bool,
}

/// From where the cheapest reading comes to a member in a state. There is one of each, and runs are long.
#[derive(Clone, Copy)]
struct Step {
    /// How many members before lies the one before it that is kept; zero where there is none,
    back: u8,
    /// and its state.
    from: u8,
    /// Whether it breaks there.
    breaks: bool,
}

/// The cheapest reading of `members` members with `S` states each; none for a member left out.
///
/// `cost` is that of a member in a state, and `follows` that of a member in a state after an earlier one, all between them
/// left out; none where it cannot follow.
pub fn cheapest<const S: usize>(
    members: usize,
    cost: impl Fn(usize, usize) -> f64,
    follows: impl Fn([usize; 2], [usize; 2]) -> Option<f64>,
) -> Vec<Option<Kept>> {
    let mut steps: Vec<[Step; S]> = Vec::with_capacity(members);
    // What readings cost so far that end at the members just before.
    let mut lately: VecDeque<[f64; S]> = VecDeque::new();
    let mut end: Option<(f64, [usize; 2])> = None;
    for at in 0..members {
        let mut here = [(LEAVE_OUT * at as f64, Step { back: 0, from: 0, breaks: false }); S];
        for (state, best) in here.iter_mut().enumerate() {
            for (before, costs) in (at - lately.len()..).zip(&lately) {
                for (from, so_far) in costs.iter().enumerate() {
                    let following = follows([before, from], [at, state]);
                    let breaks = following.is_none();
                    if breaks && before + 1 < at {
                        continue;
                    }
                    let price = so_far
                        + LEAVE_OUT * (at - before - 1) as f64
                        + following.unwrap_or(BREAK)
                        + if from == state { 0.0 } else { SWITCH };
                    if price < best.0 {
                        *best = (price, Step { back: (at - before) as u8, from: from as u8, breaks });
                    }
                }
            }
            best.0 += cost(at, state);
            let whole = best.0 + LEAVE_OUT * (members - 1 - at) as f64;
            if end.is_none_or(|(least, _)| whole < least) {
                end = Some((whole, [at, state]));
            }
        }
        if lately.len() > MOST_LEFT_OUT {
            lately.pop_front();
        }
        lately.push_back(here.map(|(cost, _)| cost));
        steps.push(here.map(|(_, step)| step));
    }
    let mut kept = vec![None; members];
    let mut next = end.map(|(_, end)| end);
    while let Some([at, state]) = next {
        let Step { back, from, breaks } = steps[at][state];
        kept[at] = Some(Kept { state: state as u8, breaks });
        next = (back > 0).then(|| [at - usize::from(back), usize::from(from)]);
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers that follow each other within one; in the other state they are ten less.
    fn read(numbers: &[f64]) -> Vec<Option<Kept>> {
        let value = |[at, state]: [usize; 2]| numbers[at] - 10.0 * state as f64;
        cheapest::<2>(
            numbers.len(),
            |_, state| 0.1 * state as f64,
            |a, b| ((value(a) - value(b)).abs() <= (b[0] - a[0]) as f64).then_some(0.0),
        )
    }

    fn states(numbers: &[f64]) -> Vec<Option<u8>> {
        read(numbers).iter().map(|kept| kept.map(|kept| kept.state)).collect()
    }

    #[test]
    fn what_is_right_stays() {
        assert!(read(&[0.0, 1.0, 1.5, 1.0, 0.0]).iter().all(|kept| *kept == Some(Kept { state: 0, breaks: false })));
        assert!(read(&[]).is_empty());
    }

    #[test]
    fn what_stands_alone_is_left_out_and_what_is_shifted_changes_state() {
        assert_eq!(states(&[0.0, 1.0, 40.0, 1.0, 0.0]), [Some(0), Some(0), None, Some(0), Some(0)]);
        assert_eq!(states(&[0.0, 1.0, 11.0, 1.0, 0.0]), [Some(0), Some(0), Some(1), Some(0), Some(0)]);
        assert_eq!(states(&[40.0, 1.0, 2.0, 1.0]), [None, Some(0), Some(0), Some(0)]);
    }

    #[test]
    fn what_jumps_and_stays_breaks_once() {
        let kept = read(&[0.0, 0.0, 0.0, 0.0, 40.0, 40.0, 40.0, 40.0]);
        let breaks: Vec<bool> = kept.iter().map(|kept| kept.is_some_and(|kept| kept.breaks)).collect();
        assert_eq!(breaks, [false, false, false, false, true, false, false, false]);
    }
}
