//! radiate with the paper's genetic algorithm, on the weights of a 2-10-1 network over 1000 samples; prints generations
//! per second. Its mutation clamps back into the start's range.

use std::time::Instant;

use radiate::*;

const SAMPLES: usize = 1000;
const UNITS: usize = 5;
const GENES: usize = UNITS * 4 + UNITS * 3 + 1;
const GENERATIONS: usize = 200;

struct Sample {
    inputs: [f32; 2],
    logarithms: [f32; 2],
    target: f32,
}

fn main() {
    run(3);
    let begin = Instant::now();
    run(GENERATIONS);
    println!("{}", GENERATIONS as f64 / begin.elapsed().as_secs_f64());
}

fn run(generations: usize) {
    let samples = samples();
    let engine = GeneticEngine::builder()
        .codec(FloatCodec::vector(GENES, -1.0f32..1.0))
        .minimizing()
        .population_size(100)
        .offspring_fraction(1.0)
        .offspring_selector(TournamentSelector::new(33))
        .crossover(SimulatedBinaryCrossover::new(0.8, 2.0))
        .mutator(GaussianMutator::new(0.05))
        .fitness_fn(move |genes: Vec<f32>| error(&genes, &samples))
        .build();
    engine.run(move |epoch| epoch.index() >= generations).expect("radiate runs");
}

/// Mean squared error of a network.
fn error(genes: &[f32], samples: &[Sample]) -> f32 {
    let (summation, rest) = genes.split_at(UNITS * 4);
    let (product, bias) = rest.split_at(UNITS * 3);
    let of = |sample: &Sample| {
        let mut output = bias[0];
        for unit in summation.chunks_exact(4) {
            output += (unit[0] * sample.inputs[0] + unit[1] * sample.inputs[1] + unit[2]) * unit[3];
        }
        for unit in product.chunks_exact(3) {
            output += (unit[0] * sample.logarithms[0] + unit[1] * sample.logarithms[1]).exp() * unit[2];
        }
        (output - sample.target).powi(2)
    };
    samples.iter().map(of).sum::<f32>() / SAMPLES as f32
}

fn samples() -> Vec<Sample> {
    let sample = |i: usize| {
        let inputs = [1.0 + (i % 32) as f32 / 32.0, 1.0 + (i / 32) as f32 / 32.0];
        let target = inputs[0] + 0.1 * inputs[1] * inputs[1] - 1.0;
        Sample { inputs, logarithms: inputs.map(f32::ln), target }
    };
    (0..SAMPLES).map(sample).collect()
}
