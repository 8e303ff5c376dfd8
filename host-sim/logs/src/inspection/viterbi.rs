//! Dynamic programming (Viterbi) over a sequence with outliers: finds the cheapest choice of which members to keep, in which
//! state, and where the sequence breaks.

use std::collections::VecDeque;

/// Cost of excluding a member.
const EXCLUDE: f64 = 2.0;
/// Cost of a break, where a member cannot follow the one before: two excluded members are cheaper, three are dearer, so that
/// a jump that persists becomes a break.
const BREAK: f64 = 5.0;
/// Cost of a change of state: there and back is slightly cheaper than an excluded member.
const SWITCH: f64 = 0.9;
/// Maximum number of consecutive excluded members considered; more than two cost more than a break.
const MAX_EXCLUDED: usize = 4;

/// A member that is kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Kept {
    /// State of the member.
    pub state: u8,
    /// Whether it cannot follow the kept member before it.
    pub breaks: bool,
}

/// Back pointer of the cheapest path to a member in a state; compact, since there is one per member and state.
#[derive(Clone, Copy)]
struct BackPointer {
    /// Distance to the previous kept member; zero if there is none.
    back: u8,
    /// State of the previous kept member.
    from: u8,
    /// Whether the sequence breaks between the two.
    breaks: bool,
}

/// Returns the cheapest path through `members` members with `S` states each; `None` for an excluded member.
///
/// `cost(member, state)` is the cost of a member in a state. `follows([member, state], [member, state])` is the cost of the
/// second after the first with all between them excluded, or `None` if it cannot follow.
pub fn cheapest_path<const S: usize>(
    members: usize,
    cost: impl Fn(usize, usize) -> f64,
    follows: impl Fn([usize; 2], [usize; 2]) -> Option<f64>,
) -> Vec<Option<Kept>> {
    let mut pointers: Vec<[BackPointer; S]> = Vec::with_capacity(members);
    // Costs of the cheapest paths that end at the preceding members.
    let mut recent: VecDeque<[f64; S]> = VecDeque::new();
    let mut end: Option<(f64, [usize; 2])> = None;
    for member in 0..members {
        let mut here = [(EXCLUDE * member as f64, BackPointer { back: 0, from: 0, breaks: false }); S];
        for (state, best) in here.iter_mut().enumerate() {
            for (before, costs) in (member - recent.len()..).zip(&recent) {
                for (from, so_far) in costs.iter().enumerate() {
                    let following = follows([before, from], [member, state]);
                    let breaks = following.is_none();
                    if breaks && before + 1 < member {
                        continue;
                    }
                    let total = so_far
                        + EXCLUDE * (member - before - 1) as f64
                        + following.unwrap_or(BREAK)
                        + if from == state { 0.0 } else { SWITCH };
                    if total < best.0 {
                        *best = (total, BackPointer { back: (member - before) as u8, from: from as u8, breaks });
                    }
                }
            }
            best.0 += cost(member, state);
            let complete = best.0 + EXCLUDE * (members - 1 - member) as f64;
            if end.is_none_or(|(least, _)| complete < least) {
                end = Some((complete, [member, state]));
            }
        }
        if recent.len() > MAX_EXCLUDED {
            recent.pop_front();
        }
        recent.push_back(here.map(|(cost, _)| cost));
        pointers.push(here.map(|(_, step)| step));
    }
    let mut kept = vec![None; members];
    let mut next = end.map(|(_, end)| end);
    while let Some([member, state]) = next {
        let BackPointer { back, from, breaks } = pointers[member][state];
        kept[member] = Some(Kept { state: state as u8, breaks });
        next = (back > 0).then(|| [member - usize::from(back), usize::from(from)]);
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers may change by one per member; in state 1 they count ten less.
    fn path(numbers: &[f64]) -> Vec<Option<Kept>> {
        let value = |[member, state]: [usize; 2]| numbers[member] - 10.0 * state as f64;
        cheapest_path::<2>(
            numbers.len(),
            |_, state| 0.1 * state as f64,
            |a, b| ((value(a) - value(b)).abs() <= (b[0] - a[0]) as f64).then_some(0.0),
        )
    }

    fn states(numbers: &[f64]) -> Vec<Option<u8>> {
        path(numbers).iter().map(|kept| kept.map(|kept| kept.state)).collect()
    }

    #[test]
    fn consistent_sequence_is_kept() {
        assert!(path(&[0.0, 1.0, 1.5, 1.0, 0.0]).iter().all(|kept| *kept == Some(Kept { state: 0, breaks: false })));
        assert!(path(&[]).is_empty());
    }

    #[test]
    fn outliers_are_excluded_and_shifted_members_change_state() {
        assert_eq!(states(&[0.0, 1.0, 40.0, 1.0, 0.0]), [Some(0), Some(0), None, Some(0), Some(0)]);
        assert_eq!(states(&[0.0, 1.0, 11.0, 1.0, 0.0]), [Some(0), Some(0), Some(1), Some(0), Some(0)]);
        assert_eq!(states(&[40.0, 1.0, 2.0, 1.0]), [None, Some(0), Some(0), Some(0)]);
    }

    #[test]
    fn persistent_jump_breaks_once() {
        let kept = path(&[0.0, 0.0, 0.0, 0.0, 40.0, 40.0, 40.0, 40.0]);
        let breaks: Vec<bool> = kept.iter().map(|kept| kept.is_some_and(|kept| kept.breaks)).collect();
        assert_eq!(breaks, [false, false, false, false, true, false, false, false]);
    }
}
