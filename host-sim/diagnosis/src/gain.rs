//! What one hypothesis gains over another, and whether that counts.

use mindgap_foundations::statistics::summary::error_of_sum;

/// How much better one hypothesis does than another on runs that it was not fitted on.
#[derive(Clone, Copy, Debug)]
pub struct Gain {
    /// Nats over all blocks, less the price of the parameters.
    pub nats: f64,
    /// The same with less of the blocks that gain most: what only an eighth of them shows is no property of the robot.
    pub broad_nats: f64,
    /// Standard error over blocks.
    pub error: f64,
}

/// One block in this many, and one at least, is one of those that gain most. An effect that one place in ten shows still
/// counts, and so does none that a single run shows.
const MOST: usize = 8;

impl Gain {
    /// Nothing.
    pub const NONE: Gain = Gain { nats: 0.0, broad_nats: 0.0, error: 0.0 };

    /// The gain of each block, together, of a form with few parameters: those that gain most count as the next best
    /// (a winsorized sum). Nothing would be left of an effect that shows here and there only, an echo by way of a second wall,
    /// if they did not count at all.
    pub fn of(by_block: &[f64]) -> Self {
        let most = most(by_block);
        let ascending = ascending(by_block);
        let others = &ascending[..by_block.len() - most];
        let next_best = others.last().copied().unwrap_or(0.0);
        Gain { broad_nats: others.iter().sum::<f64>() + most as f64 * next_best, ..Gain::without_best(by_block, most) }
    }

    /// The same of a form so free that a few blocks can have something in common by chance: those that gain most do not
    /// count.
    pub fn of_free_form(by_block: &[f64]) -> Self {
        Gain::without_best(by_block, most(by_block))
    }

    /// The same where so many of the best blocks do not count.
    pub fn without_best(by_block: &[f64], left_out: usize) -> Self {
        let others = by_block.len().saturating_sub(left_out);
        let broad_nats = ascending(by_block)[..others].iter().sum();
        Gain { nats: by_block.iter().sum(), broad_nats, error: error_of_sum(by_block) }
    }

    /// The same at a price.
    pub fn less(self, nats: f64) -> Self {
        Gain { nats: self.nats - nats, broad_nats: self.broad_nats - nats, ..self }
    }

    /// A share of it, all over this.
    pub fn over(self, divisor: f64) -> Self {
        Gain { nats: self.nats / divisor, broad_nats: self.broad_nats / divisor, error: self.error / divisor }
    }

    /// Whether it counts: it is large enough with less of the blocks that gain most.
    pub fn passes(&self, gate_nats: f64) -> bool {
        self.broad_nats >= gate_nats
    }
}

/// How many blocks are those that gain most.
fn most(by_block: &[f64]) -> usize {
    by_block.len().div_ceil(MOST)
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

    /// The sample variance of 1, 3 and 5 is 4; three blocks of that add up to 12.
    #[test]
    fn a_gain_is_the_sum_and_its_error_that_of_independent_blocks() {
        assert_eq!(gain(&[1.0, 3.0, 5.0]), [9.0, 12f64.sqrt()]);
        assert_eq!(gain(&[2.0; 8]), [16.0, 0.0]);
        assert_eq!(gain(&[7.0]), [7.0, 0.0]);
    }

    /// What a single block gains beyond the others does not count, and of nine blocks not what two do.
    #[test]
    fn a_gate_asks_for_a_gain_that_more_than_a_few_blocks_show() {
        let broad = |by_block: &[f64]| Gain::of(by_block).broad_nats;
        assert_eq!([broad(&[100.0]), broad(&[100.0, 0.0, 0.0]), broad(&[3.0; 8])], [0.0, 0.0, 24.0]);
        let nine = [100.0, 90.0, 2.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0];
        assert_eq!([broad(&nine), Gain::of_free_form(&nine).broad_nats], [12.0, 8.0]);
        assert!(Gain::of(&[6.0, 9.0]).passes(12.0) && !Gain::of(&[5.9, 900.0]).passes(12.0));
        assert!(!Gain::of(&[6.0, 9.0]).less(0.1).passes(12.0), "less its price");
        assert!(!Gain::of(&[11.9, 90.0]).over(2.0).passes(12.0) && Gain::of(&[12.0, 90.0]).over(2.0).passes(12.0));
    }
}
