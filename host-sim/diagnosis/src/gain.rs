//! The gain of one explanation over another, and whether it counts.

use mindgap_foundations::statistics::summary::standard_error_of_sum;

/// The gain of one explanation over another on blocks that neither was fitted to.
#[derive(Clone, Copy, Debug)]
pub struct Gain {
    /// Sum over all blocks, less the complexity penalty.
    pub nats: f64,
    /// The same sum winsorized over blocks: what only an eighth of the blocks shows is not a property of the robot.
    pub winsorized_nats: f64,
    /// Standard error over blocks.
    pub error: f64,
}

/// One block in this many, and at least one, counts as extreme. An effect that shows at one place in ten still counts; an
/// effect that a single run shows does not.
const EXTREME: usize = 8;

impl Gain {
    /// No gain.
    pub const NONE: Gain = Gain { nats: 0.0, winsorized_nats: 0.0, error: 0.0 };

    /// Sums gains per block, for an explanation with few parameters. The largest gains are replaced by the next one (a
    /// winsorized sum). Trimming them would leave nothing of an effect that shows only here and there, such as an echo by way
    /// of a second wall.
    pub fn of(by_block: &[f64]) -> Self {
        let extreme = extreme(by_block);
        let ascending = ascending(by_block);
        let others = &ascending[..by_block.len() - extreme];
        let next_largest = others.last().copied().unwrap_or(0.0);
        let winsorized_nats = others.iter().sum::<f64>() + extreme as f64 * next_largest;
        Gain { winsorized_nats, ..Gain::trimmed(by_block, extreme) }
    }

    /// Sums gains per block, for an explanation so flexible that a few blocks can share a pattern by chance: the largest gains
    /// are left out of the winsorized sum.
    pub fn of_free_form(by_block: &[f64]) -> Self {
        Gain::trimmed(by_block, extreme(by_block))
    }

    /// Sums gains per block and leaves the largest `trimmed` of them out of the winsorized sum.
    pub fn trimmed(by_block: &[f64], trimmed: usize) -> Self {
        let kept = by_block.len().saturating_sub(trimmed);
        let winsorized_nats = ascending(by_block)[..kept].iter().sum();
        Gain { nats: by_block.iter().sum(), winsorized_nats, error: standard_error_of_sum(by_block) }
    }

    /// Subtracts a penalty.
    pub fn less(self, nats: f64) -> Self {
        Gain { nats: self.nats - nats, winsorized_nats: self.winsorized_nats - nats, ..self }
    }

    /// Divides all figures by `divisor`.
    pub fn over(self, divisor: f64) -> Self {
        let Gain { nats, winsorized_nats, error } = self;
        Gain { nats: nats / divisor, winsorized_nats: winsorized_nats / divisor, error: error / divisor }
    }

    /// Returns whether it counts: the winsorized gain reaches the gate.
    pub fn passes(&self, gate_nats: f64) -> bool {
        self.winsorized_nats >= gate_nats
    }
}

/// Returns the number of extreme blocks.
fn extreme(by_block: &[f64]) -> usize {
    by_block.len().div_ceil(EXTREME)
}

fn ascending(by_block: &[f64]) -> Vec<f64> {
    let mut ascending = by_block.to_vec();
    ascending.sort_by(f64::total_cmp);
    ascending
}

#[cfg(test)]
mod tests {
    use super::*;

    fn gain(by_block: &[f64]) -> [f64; 2] {
        let Gain { nats, error, .. } = Gain::of(by_block);
        [nats, error]
    }

    /// The sample variance of 1, 3 and 5 is 4; three blocks of it add up to 12.
    #[test]
    fn gain_is_the_sum_with_the_error_of_independent_blocks() {
        assert_eq!(gain(&[1.0, 3.0, 5.0]), [9.0, 12f64.sqrt()]);
        assert_eq!(gain(&[2.0; 8]), [16.0, 0.0]);
        assert_eq!(gain(&[7.0]), [7.0, 0.0]);
    }

    /// Of one to eight blocks the largest gain is replaced by the next one, of nine the largest two.
    #[test]
    fn gate_ignores_what_only_a_few_blocks_gain() {
        let winsorized = |by_block: &[f64]| Gain::of(by_block).winsorized_nats;
        assert_eq!([winsorized(&[100.0]), winsorized(&[100.0, 0.0, 0.0]), winsorized(&[3.0; 8])], [0.0, 0.0, 24.0]);
        let nine = [100.0, 90.0, 2.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0];
        assert_eq!([winsorized(&nine), Gain::of_free_form(&nine).winsorized_nats], [12.0, 8.0]);
        assert!(Gain::of(&[6.0, 9.0]).passes(12.0) && !Gain::of(&[5.9, 900.0]).passes(12.0));
        assert!(!Gain::of(&[6.0, 9.0]).less(0.1).passes(12.0), "less its penalty");
        assert!(!Gain::of(&[11.9, 90.0]).over(2.0).passes(12.0) && Gain::of(&[12.0, 90.0]).over(2.0).passes(12.0));
    }
}
