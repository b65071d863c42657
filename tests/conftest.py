"""Fixtures shared by all tests."""

from __future__ import annotations

import os
from pathlib import Path

import pytest
from hypothesis import settings

settings.register_profile("shared", deadline=None)
settings.load_profile("shared")


@pytest.fixture(scope="session")
def shared() -> Path:
    """The folder with recorded human demonstrations and reference outcomes, beside the checkout."""
    folder = Path(os.environ.get("DRAKE_SCREW_SHARED", Path(__file__).parents[2] / "shared"))
    if not (folder / "demos").is_dir():
        pytest.skip(f"recorded demonstrations not found in {folder}")
    return folder
