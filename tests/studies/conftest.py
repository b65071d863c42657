"""The rounds that pictures are tested with."""

from tests.visualization.conftest import make_round, meshcat, regions

__all__ = ["make_round", "meshcat", "regions"]
