"""Fixtures of the pages' tests."""

from __future__ import annotations

from tests.visualization.conftest import meshcat

__all__ = ["meshcat"]
