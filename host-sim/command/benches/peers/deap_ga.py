"""DEAP with the paper's genetic algorithm; numpy over the samples of one individual."""

import random

import network
from deap import base, creator, tools

creator.create("Fitness", base.Fitness, weights=(-1.0,))
creator.create("Individual", list, fitness=creator.Fitness)
toolbox = base.Toolbox()
toolbox.register("gene", random.uniform, network.LOW, network.HIGH)
toolbox.register("individual", tools.initRepeat, creator.Individual, toolbox.gene, network.GENES)
toolbox.register("select", tools.selTournament, tournsize=33)
toolbox.register("mate", tools.cxSimulatedBinary, eta=2.0)
toolbox.register("mutate", tools.mutGaussian, mu=0.0, sigma=0.1, indpb=0.05)


def judge(population):
    for individual in population:
        individual.fitness.values = (float(network.errors([individual])[0]),)


def run(generations):
    random.seed(1)
    population = [toolbox.individual() for _ in range(network.POPULATION)]
    judge(population)
    for _ in range(generations):
        children = [toolbox.clone(parent) for parent in toolbox.select(population, network.POPULATION)]
        for one, other in zip(children[::2], children[1::2]):
            if random.random() < 0.8:
                toolbox.mate(one, other)
        for child in children:
            toolbox.mutate(child)
        judge(children)
        population = children


network.report(run)
