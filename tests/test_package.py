"""The package's own names: stable, loaded when asked for, with types."""

from __future__ import annotations

import importlib.metadata
import subprocess
import sys
from pathlib import Path

import pytest

import drake_screw

STABLE = {
    "Demonstration",
    "DrakeScrewError",
    "ModelError",
    "Outcomes",
    "RecordingError",
    "RunDirectoryError",
    "ScenarioError",
    "ScrewPlanExecutor",
    "Setup",
    "__version__",
    "load_scenario",
    "new_run",
    "open_run",
    "screws",
}


def test_the_stable_names_are_there_and_shown_in_the_documentation() -> None:
    assert set(drake_screw.__all__) >= STABLE
    page = (Path(__file__).parents[1] / "docs" / "python.md").read_text()
    for name in drake_screw.__all__:
        assert getattr(drake_screw, name) is not None
        assert name in dir(drake_screw)
        assert name in page, name
    assert drake_screw.__version__ == importlib.metadata.version("drake-screw")
    assert (Path(drake_screw.__file__).parent / "py.typed").is_file()


def test_a_name_that_is_not_there_is_an_attribute_error() -> None:
    with pytest.raises(AttributeError, match="has no attribute 'lod_scenario'"):
        drake_screw.lod_scenario  # noqa: B018


def test_importing_the_package_loads_neither_drake_nor_numpy() -> None:
    code = "import sys, drake_screw; print({'pydrake', 'numpy'} & set(sys.modules))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "set()"


def test_from_drake_screw_import_everything() -> None:
    found: dict[str, object] = {}
    exec("from drake_screw import *", found)
    assert set(drake_screw.__all__) <= found.keys()
