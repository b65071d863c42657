"""Verbs load no packages that they have no use for: those take longer than many a verb's work."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.commands.test_help import python

HEAVY = (
    *("scipy.signal", "scipy.stats", "scipy.interpolate", "scipy.optimize", "scipy.spatial"),
    *("scipy.sparse", "numba.np.arraymath", "matplotlib", "pandas"),
)
RUN = (
    "import sys\nfrom drake_screw.cli import main\ntry:\n    main()\n"
    f"finally:\n    print(*({set(HEAVY)!r} & set(sys.modules)), file=sys.stderr)"
)


def test_check_loads_no_statistics_filters_or_pictures() -> None:
    done = python(RUN, "check", "pouring")
    assert (done.returncode, done.stderr.split()) == (0, [])
    assert "time" in done.stdout


def test_evaluate_loads_no_statistics_filters_or_pictures(library: Path, tmp_path: Path) -> None:
    places = tmp_path / "places.csv"
    places.write_text("x,y\n0.8,0.1\n0.9,0.3\n")
    given = ("--demonstrations", str(library), "--instances", str(places))
    done = python(RUN, "evaluate", "pouring", *given, "--output", str(tmp_path / "found.csv"))
    assert (done.returncode, done.stderr.split()) == (0, [])
    assert (tmp_path / "found.csv").is_file()


@pytest.mark.parametrize("module", ["runs.run", "runs.trajectory", "assembly.preview"])
def test_what_verbs_are_made_of_loads_no_special_functions(module: str) -> None:
    done = python(
        f"import sys, drake_screw.{module}\n"
        f"print(*({set(HEAVY) | {'scipy.special', 'scipy.linalg'}!r} & set(sys.modules)))"
    )
    assert (done.returncode, done.stdout.split(), done.stderr) == (0, [], "")
