//! The generational genetic algorithm (GA) that trains networks and evolves controllers (paper, section VII).
//!
//! Each generation replaces the whole population. Parents are selected by [`tournament`], recombined by [`sbx`] and
//! mutated by [`mutation`]; [`stopping`] ends the run. What the paper leaves open is a field of [`Settings`].

pub mod mutation;
pub mod sbx;
pub mod stopping;
pub mod tournament;

use rand::RngExt;
use serde::{Deserialize, Serialize};

use mindgap_foundations::error::Result;
use mindgap_foundations::executor::{self, Executor};
use mindgap_foundations::random::{Generator, generator};
use mutation::Mutation;
use stopping::StagnationCriterion;

/// Parameters of the algorithm. The defaults are those of the paper, section VII; where the paper gives none (marked
/// "open"), they are common in the literature.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Number of individuals (paper: 100).
    pub population: usize,
    /// Number of individuals in a tournament, drawn without replacement (paper: 33).
    pub tournament: usize,
    /// Probability that two parents cross over (paper: 0.8).
    pub crossover_probability: f64,
    /// Distribution index of the simulated binary crossover (open; 15 is common).
    pub sbx_index: f32,
    /// How children mutate (paper: 5 %, normal).
    pub mutation: Mutation,
    /// Number of best individuals that survive unchanged (open; 0).
    pub elite: usize,
    /// When to stop for lack of improvement (paper: under 0.1 % over 300 generations); `None` for never.
    pub stagnation: Option<StagnationCriterion>,
    /// Maximum number of generations (paper: 1000 for a controller, no bound for a network).
    pub max_generations: usize,
}

/// Result of a run of the algorithm.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RunResult {
    /// The fittest individual of all generations.
    pub best: Vec<f32>,
    /// Its fitness.
    pub fitness: f64,
    /// Number of generations run.
    pub generations: usize,
    /// The last population, fittest first.
    pub population: Vec<Vec<f32>>,
}

/// Number of individuals per piece of work. With five, training a small network spent a third of its time on distributing
/// work; more than 25 leave processors idle.
const BATCH_SIZE: usize = 25;

/// An optimisation problem: how genotypes are made, repaired and evaluated.
pub trait Problem: Sync {
    /// Draws a random genotype for the first generation.
    fn random(&self, rng: &mut Generator) -> Vec<f32>;
    /// Brings the genes of a child back into their bounds.
    fn repair(&self, genes: &mut [f32]);
    /// Returns the number of individuals that are evaluated as one piece of work.
    fn batch_size(&self) -> usize {
        BATCH_SIZE
    }
    /// Returns the fitness of consecutive individuals of a generation, from index `first`; larger is better, and NaN is
    /// worst.
    fn fitness(&self, generation: usize, first: usize, individuals: &[Vec<f32>]) -> Vec<f64>;
}

impl Default for Settings {
    fn default() -> Self {
        Settings {
            population: 100,
            tournament: 33,
            crossover_probability: 0.8,
            sbx_index: 15.0,
            mutation: Mutation::default(),
            elite: 0,
            stagnation: Some(StagnationCriterion::default()),
            max_generations: usize::MAX,
        }
    }
}

/// A run of the algorithm in progress: a population with its own random draws.
pub struct Lineage<'a, P> {
    problem: &'a P,
    seed: u64,
    population: Vec<Vec<f32>>,
    best: Option<(Vec<f32>, f64)>,
    /// The best fitness up to each generation.
    history: Vec<f64>,
    is_over: bool,
}

/// Runs the algorithm from a random population. `seed` fixes every draw; `watch` receives the generation and the best
/// fitness up to it, on the first rank.
///
/// # Errors
/// If the executor fails.
pub fn run(
    executor: &dyn Executor,
    settings: &Settings,
    problem: &impl Problem,
    seed: u64,
    watch: impl FnMut(usize, f64),
) -> Result<RunResult> {
    let result = run_side_by_side(executor, settings, vec![Lineage::random(settings, problem, seed)], watch)?;
    Ok(result.into_iter().next().expect("one result per lineage"))
}

/// Runs several lineages, each as it would run alone. Their generations run side by side, so that the individuals of all
/// lineages are distributed at once. `watch` receives the generation and the best fitness of any lineage.
///
/// # Errors
/// If the executor fails.
pub fn run_side_by_side<P: Problem>(
    executor: &dyn Executor,
    settings: &Settings,
    mut lineages: Vec<Lineage<P>>,
    mut watch: impl FnMut(usize, f64),
) -> Result<Vec<RunResult>> {
    for generation in 0.. {
        let batch_size = |number: usize| lineages[number].problem.batch_size();
        let pieces: Vec<(usize, usize)> = (0..lineages.len())
            .filter(|number| !lineages[*number].is_over)
            .flat_map(|number| {
                (0..lineages[number].population.len()).step_by(batch_size(number)).map(move |i| (number, i))
            })
            .collect();
        let give = |piece: usize| {
            let (number, first) = pieces[piece];
            let population = &lineages[number].population;
            (number, first, population[first..population.len().min(first + batch_size(number))].to_vec())
        };
        let evaluate = |_, (number, first, some): (usize, usize, Vec<Vec<f32>>)| {
            Ok(lineages[number].problem.fitness(generation, first, &some))
        };
        let mut fitness = executor::map_inputs(executor, pieces.len(), give, evaluate)?.into_iter().flatten();
        // Only the first rank breeds; the others receive the individuals that they evaluate.
        let is_over = executor::once(executor, || {
            for lineage in lineages.iter_mut().filter(|lineage| !lineage.is_over) {
                let own: Vec<f64> = fitness.by_ref().take(lineage.population.len()).collect();
                lineage.advance(settings, generation, &own);
            }
            let best = lineages.iter().filter_map(|lineage| lineage.history.last().copied());
            watch(generation, best.fold(f64::NAN, f64::max));
            Ok(lineages.iter().all(|lineage| lineage.is_over))
        })?;
        if is_over {
            break;
        }
    }
    executor::once(executor, || Ok(lineages.into_iter().map(Lineage::result).collect()))
}

impl<'a, P: Problem> Lineage<'a, P> {
    /// Starts from a random population.
    pub fn random(settings: &Settings, problem: &'a P, seed: u64) -> Self {
        let mut rng = generator(seed, &[0]);
        Lineage::from(problem, (0..settings.population).map(|_| problem.random(&mut rng)).collect(), seed)
    }

    /// Starts from a given population, whose size it keeps.
    pub fn from(problem: &'a P, population: Vec<Vec<f32>>, seed: u64) -> Self {
        Lineage { problem, seed, population, best: None, history: Vec::new(), is_over: false }
    }

    /// Breeds the next generation, or sorts the last one by fitness.
    fn advance(&mut self, settings: &Settings, generation: usize, fitness: &[f64]) {
        let ranking = tournament::ranking(fitness);
        let leader = ranking[0];
        if self.best.as_ref().is_none_or(|(_, f)| fitness[leader] > *f) {
            self.best = Some((self.population[leader].clone(), fitness[leader]));
        }
        self.history.push(self.best.as_ref().map_or(f64::NAN, |best| best.1));
        let stalled = settings.stagnation.is_some_and(|w| w.has_stalled(&self.history));
        self.is_over = stalled || self.history.len() >= settings.max_generations;
        self.population = if self.is_over {
            ranking.iter().map(|i| std::mem::take(&mut self.population[*i])).collect()
        } else {
            let mut rng = generator(self.seed, &[1, generation as u64]);
            offspring(settings, self.problem, &self.population, &ranking, &mut rng)
        };
    }

    fn result(self) -> RunResult {
        let (best, fitness) = self.best.unwrap_or_default();
        RunResult { best, fitness, generations: self.history.len(), population: self.population }
    }
}

fn offspring(
    settings: &Settings,
    problem: &impl Problem,
    parents: &[Vec<f32>],
    ranking: &[usize],
    rng: &mut Generator,
) -> Vec<Vec<f32>> {
    let mut children: Vec<Vec<f32>> = ranking.iter().take(settings.elite).map(|i| parents[*i].clone()).collect();
    let mut arena = tournament::Tournament::new(ranking);
    while children.len() < parents.len() {
        let mother = &parents[arena.winner(settings.tournament, rng)];
        let father = &parents[arena.winner(settings.tournament, rng)];
        let (mut daughter, mut son) = (mother.clone(), father.clone());
        if rng.random_bool(settings.crossover_probability) {
            sbx::cross(&mut daughter, &mut son, settings.sbx_index, rng);
        }
        for mut child in [daughter, son] {
            if children.len() < parents.len() {
                settings.mutation.apply(&mut child, rng);
                problem.repair(&mut child);
                children.push(child);
            }
        }
    }
    children
}

#[cfg(test)]
mod tests {
    use super::*;
    use mindgap_foundations::executor::Serial;

    /// The sphere function: fitness is highest at the origin.
    struct Sphere;

    impl Problem for Sphere {
        fn random(&self, rng: &mut Generator) -> Vec<f32> {
            (0..8).map(|_| rng.random_range(-1.0..1.0)).collect()
        }

        fn repair(&self, _: &mut [f32]) {}

        fn batch_size(&self) -> usize {
            7
        }

        fn fitness(&self, _: usize, _: usize, individuals: &[Vec<f32>]) -> Vec<f64> {
            individuals.iter().map(|g| -g.iter().map(|x| f64::from(x * x)).sum::<f64>()).collect()
        }
    }

    fn settings() -> Settings {
        Settings { max_generations: 150, stagnation: None, ..Settings::default() }
    }

    #[test]
    fn sphere_function_is_maximised() {
        let outcome = run(&Serial, &settings(), &Sphere, 1, |_, _| {}).unwrap();
        assert!(outcome.fitness > -0.05, "{}", outcome.fitness);
        assert_eq!(outcome.generations, 150);
    }

    #[test]
    fn seed_determines_the_run() {
        let again = |seed| run(&Serial, &settings(), &Sphere, seed, |_, _| {}).unwrap();
        assert_eq!(again(5), again(5));
        assert_ne!(again(5).best, again(6).best);
    }

    #[test]
    fn lineages_side_by_side_run_as_if_alone() {
        // Each ends when ten generations have not halved its squared distance from the optimum, so they end at different
        // times.
        let stagnation = Some(StagnationCriterion { generations: 10, improvement: -0.5 });
        let settings = Settings { stagnation, ..settings() };
        let lineages = [5, 6, 7].map(|seed| Lineage::random(&settings, &Sphere, seed));
        let beside = run_side_by_side(&Serial, &settings, lineages.into(), |_, _| {}).unwrap();
        assert_eq!(beside, [5, 6, 7].map(|seed| run(&Serial, &settings, &Sphere, seed, |_, _| {}).unwrap()));
    }

    #[test]
    fn elite_never_loses_the_best_individual() {
        let mut last = f64::NEG_INFINITY;
        let outcome = run(&Serial, &Settings { elite: 1, ..settings() }, &Sphere, 2, |_, best| {
            assert!(best >= last);
            last = best;
        })
        .unwrap();
        assert_eq!(Sphere.fitness(0, 0, &outcome.population)[0], outcome.fitness, "the elite survives");
    }

    #[test]
    fn population_of_one_runs() {
        let outcome =
            run(&Serial, &Settings { population: 1, max_generations: 3, ..settings() }, &Sphere, 3, |_, _| {}).unwrap();
        assert_eq!(outcome.population.len(), 1);
    }
}
