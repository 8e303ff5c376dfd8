"""pymoo with the paper's genetic algorithm; the whole population at once. It keeps the best of parents and children."""

import network
import numpy as np
from pymoo.algorithms.soo.nonconvex.ga import GA
from pymoo.core.problem import Problem
from pymoo.operators.crossover.sbx import SBX
from pymoo.operators.mutation.gauss import GaussianMutation
from pymoo.operators.selection.tournament import TournamentSelection
from pymoo.optimize import minimize


class Weights(Problem):
    def __init__(self):
        super().__init__(n_var=network.GENES, n_obj=1, xl=network.LOW, xu=network.HIGH)

    def _evaluate(self, x, out, *args, **kwargs):
        out["F"] = network.errors(x)


def fittest(population, contests, **_):
    errors = population.get("F")[:, 0]
    return contests[np.arange(len(contests)), errors[contests].argmin(axis=1)][:, None]


def run(generations):
    algorithm = GA(
        pop_size=network.POPULATION,
        selection=TournamentSelection(func_comp=fittest, pressure=33),
        crossover=SBX(prob=0.8, eta=2),
        mutation=GaussianMutation(prob=1.0, prob_var=0.05, sigma=0.1),
        eliminate_duplicates=False,
    )
    minimize(Weights(), algorithm, ("n_gen", generations), seed=1)


network.report(run)
