"""The work of all peers in Python: a 2-10-1 network over 1000 samples, as the paper trains it."""

import time

import numpy as np

SAMPLES, UNITS, POPULATION, GENERATIONS = 1000, 5, 100, 50
# Five summation units of two weights, a bias and an output weight; five product units of two exponents and an output
# weight; the output's bias.
GENES = UNITS * 4 + UNITS * 3 + 1
LOW, HIGH = -1.0, 1.0

_rng = np.random.default_rng(1)
INPUTS = 1.0 + _rng.random((SAMPLES, 2), dtype=np.float32)
LOGS = np.log(INPUTS)
TARGETS = (INPUTS[:, 0] + 0.1 * INPUTS[:, 1] ** 2 - 1.0).astype(np.float32)


def errors(population):
    """Mean squared error of every individual of an array of shape (n, GENES)."""
    genes = np.asarray(population, dtype=np.float32)
    summation = genes[:, : UNITS * 4].reshape(-1, UNITS, 4)
    product = genes[:, UNITS * 4 : -1].reshape(-1, UNITS, 3)
    hidden = summation[:, :, :2] @ INPUTS.T + summation[:, :, 2:3]
    outputs = (hidden * summation[:, :, 3:4]).sum(axis=1)
    powers = np.exp(product[:, :, :2] @ LOGS.T)
    outputs += (powers * product[:, :, 2:3]).sum(axis=1) + genes[:, -1:]
    return ((outputs - TARGETS) ** 2).mean(axis=1)


def report(run):
    """Times `run(generations)` and prints generations per second."""
    run(3)
    begin = time.perf_counter()
    run(GENERATIONS)
    print(GENERATIONS / (time.perf_counter() - begin))
