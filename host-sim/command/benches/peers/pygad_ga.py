"""PyGAD with the paper's genetic algorithm as far as it has it; fitness of the whole population at once."""

import network
import numpy as np
import pygad


def fitness(_, solutions, __):
    return list(1.0 / (1e-9 + network.errors(np.atleast_2d(solutions))))


def mutate(children, _):
    chosen = np.random.random(children.shape) < 0.05
    return children + chosen * np.random.normal(0.0, 0.1, children.shape)


def run(generations):
    pygad.GA(
        num_generations=generations,
        num_parents_mating=network.POPULATION,
        fitness_func=fitness,
        fitness_batch_size=network.POPULATION,
        sol_per_pop=network.POPULATION,
        num_genes=network.GENES,
        init_range_low=network.LOW,
        init_range_high=network.HIGH,
        parent_selection_type="tournament",
        K_tournament=33,
        keep_elitism=0,
        keep_parents=0,
        crossover_type="sbx",
        crossover_probability=0.8,
        mutation_type=mutate,
        random_seed=1,
        suppress_warnings=True,
    ).run()


network.report(run)
