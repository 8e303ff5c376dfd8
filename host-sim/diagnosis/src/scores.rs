//! Log-likelihoods as a value: nats per row and channel.

use std::ops::{Add, Sub};
use std::sync::Arc;

use mindgap_foundations::channel::Channel;
use mindgap_learning::evaluation::observations::Observations;

/// The block of every row.
#[derive(Clone, Debug, PartialEq)]
pub struct Blocks {
    of_row: Arc<[usize]>,
    count: usize,
}

/// Log-likelihoods of rows, or differences of them, in nats: rows × channels.
#[derive(Clone, Debug, PartialEq)]
pub struct Scores {
    nats: Vec<[f64; Channel::COUNT]>,
    blocks: Blocks,
}

impl Blocks {
    /// Reads the blocks of observed rows.
    pub fn of(observations: &Observations) -> Self {
        Blocks { of_row: observations.rows.iter().map(|row| row.block).collect(), count: observations.blocks }
    }

    /// Sums one number per row over the rows of each block.
    pub fn sums(&self, terms: &[f64]) -> Vec<f64> {
        let mut sums = vec![0.0; self.count];
        self.of_row.iter().zip(terms).for_each(|(block, term)| sums[*block] += term);
        sums
    }
}

impl Scores {
    /// Returns zero nats for every row and channel.
    pub fn zero(blocks: &Blocks) -> Self {
        Scores { nats: vec![[0.0; Channel::COUNT]; blocks.of_row.len()], blocks: blocks.clone() }
    }

    /// Replaces forward, lateral and turn of every row.
    pub fn with_motion(mut self, motion: &[[f64; 3]]) -> Self {
        self.nats.iter_mut().zip(motion).for_each(|(row, motion)| row[..3].copy_from_slice(motion));
        self
    }

    /// Replaces echo rate and echo value of every row.
    pub fn with_sonar(mut self, sonar: &[[f64; 2]]) -> Self {
        self.nats.iter_mut().zip(sonar).for_each(|(row, sonar)| row[3..5].copy_from_slice(sonar));
        self
    }

    /// Replaces the witnesses of every row: left and right counter, gyro.
    pub fn with_witnesses(mut self, witnesses: &[[f64; 3]]) -> Self {
        self.nats.iter_mut().zip(witnesses).for_each(|(row, witnesses)| row[5..].copy_from_slice(witnesses));
        self
    }

    /// Replaces one channel of every row.
    pub fn with(mut self, channel: Channel, column: &[f64]) -> Self {
        self.nats.iter_mut().zip(column).for_each(|(row, nats)| row[channel.index()] = *nats);
        self
    }

    /// Returns every `step`-th row, beginning with the first; `blocks` are those of these rows.
    pub fn every(&self, step: usize, blocks: &Blocks) -> Self {
        Scores { nats: self.nats.iter().step_by(step).copied().collect(), blocks: blocks.clone() }
    }

    /// Returns all channels of every row.
    pub fn rows(&self) -> &[[f64; Channel::COUNT]] {
        &self.nats
    }

    /// Returns one channel of every row.
    pub fn of(&self, channel: Channel) -> Vec<f64> {
        self.nats.iter().map(|row| row[channel.index()]).collect()
    }

    /// Returns the total of one channel.
    pub fn total_of(&self, channel: Channel) -> f64 {
        self.nats.iter().map(|row| row[channel.index()]).sum()
    }

    /// Keeps these channels and sets the others to zero.
    pub fn only(&self, channels: &[Channel]) -> Self {
        channels.iter().fold(Scores::zero(&self.blocks), |kept, channel| kept.with(*channel, &self.of(*channel)))
    }

    /// Sums all channels of every row.
    pub fn by_row(&self) -> Vec<f64> {
        self.nats
            .iter()
            .map(|[forward, lateral, turn, rate, value, left, right, gyro]| {
                forward + lateral + turn + (rate + value) + (left + right + gyro)
            })
            .collect()
    }

    /// Sums all channels of every block.
    pub fn by_block(&self) -> Vec<f64> {
        self.blocks.sums(&self.by_row())
    }

    /// Returns the number of blocks.
    pub fn block_count(&self) -> usize {
        self.blocks.count
    }

    /// Sums all rows and channels.
    pub fn total(&self) -> f64 {
        self.by_block().iter().sum()
    }

    /// Multiplies all by a factor.
    pub fn scaled(&self, factor: f64) -> Self {
        Scores { nats: self.nats.iter().map(|row| row.map(|nats| factor * nats)).collect(), ..self.clone() }
    }

    fn zip(&self, other: &Scores, combine: impl Fn(f64, f64) -> f64) -> Scores {
        let rows = self.nats.iter().zip(&other.nats);
        let nats = rows.map(|(a, b)| std::array::from_fn(|channel| combine(a[channel], b[channel]))).collect();
        Scores { nats, blocks: self.blocks.clone() }
    }
}

impl Add for &Scores {
    type Output = Scores;

    fn add(self, other: &Scores) -> Scores {
        self.zip(other, |a, b| a + b)
    }
}

impl Sub for &Scores {
    type Output = Scores;

    fn sub(self, other: &Scores) -> Scores {
        self.zip(other, |a, b| a - b)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn channels_are_the_columns_and_rows_and_blocks_their_sums() {
        let blocks = Blocks { of_row: [0, 0, 2].into(), count: 3 };
        let row = Scores::zero(&blocks).with_motion(&[[1.0, 2.0, 3.0]; 3]).with_sonar(&[[4.0, 5.0]; 3]);
        assert_eq!(Channel::SIMULATED.map(|channel| row.of(channel)[0]), [1.0, 2.0, 3.0, 4.0, 5.0]);
        let witnessed = row.clone().with_witnesses(&[[6.0, 7.0, 8.0]; 3]);
        assert_eq!(Channel::WITNESSES.map(|channel| witnessed.of(channel)[0]), [6.0, 7.0, 8.0]);
        assert_eq!(witnessed.by_row(), [36.0; 3]);
        assert_eq!((row.by_row(), row.by_block(), row.total()), (vec![15.0; 3], vec![30.0, 0.0, 15.0], 45.0));
        assert_eq!(row.only(&[Channel::Turn, Channel::EchoRate]).by_row(), [7.0; 3]);
        assert_eq!((&row - &row.scaled(0.5)).total_of(Channel::EchoValue), 7.5);
        assert_eq!((&row + &row).with(Channel::Forward, &[0.0; 3]).by_row(), [28.0; 3]);
    }
}
