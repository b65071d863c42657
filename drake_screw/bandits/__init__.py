"""Bernoulli arms and nothing else: strategies that certify that every arm seldom fails."""

from drake_screw.bandits.cell import Cell, cell_number
from drake_screw.bandits.mixture import coverage_bound
from drake_screw.bandits.strategies import STRATEGIES, make_strategy
from drake_screw.bandits.tree import CellPull, CertifyOrSplit, TreeVerdict
from drake_screw.bandits.verdict import BanditError, Goal, OfFixedSize, Pull, Strategy, Verdict

__all__ = [
    "STRATEGIES",
    "BanditError",
    "Cell",
    "CellPull",
    "CertifyOrSplit",
    "Goal",
    "OfFixedSize",
    "Pull",
    "Strategy",
    "TreeVerdict",
    "Verdict",
    "cell_number",
    "coverage_bound",
    "make_strategy",
]
