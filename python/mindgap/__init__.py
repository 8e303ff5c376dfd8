"""Finds the gap between a small robot and its simulator, and evolves controllers that cross it."""

from .mindgap import *
from .mindgap import __all__
