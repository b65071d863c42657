"""The soak of broken inputs: it judges as it says, and finds nothing in a few hundred."""

from __future__ import annotations

import sys
from collections import Counter
from pathlib import Path

import numpy as np
import pytest

FOLDER = Path(__file__).parents[2] / "benchmarks"
sys.path.insert(0, str(FOLDER))

from soak import shared_out, table, verdicts  # noqa: E402
from soak_breaking import BREAKERS  # noqa: E402
from soak_inputs import KINDS  # noqa: E402
from soak_originals import make_originals  # noqa: E402
from soak_worker import FAULTS, verdict_of  # noqa: E402

RIGHT = "error: a.yaml:3: x: expected a number\n  Meaning: how many.\n"


@pytest.mark.parametrize(
    ("code", "printed", "changed", "verdict"),
    [
        (2, RIGHT, [], "refused"),
        (2, f"converting meshes, once\n{RIGHT}", [], "refused"),
        (2, "Usage: drake-screw check [OPTIONS]\n\nError: No such option: --x\n", [], "refused"),
        (0, "", ["new"], "accepted"),
        (1, "", ["new"], "ended"),
        (3, RIGHT, [], "exit code"),
        (-11, "", [], "exit code"),
        (2, "", [], "message"),
        (2, RIGHT + RIGHT, [], "message"),
        (2, RIGHT + "  more\n" * 100, [], "message"),
        (2, f"error: a.yaml: {'x' * 5000}\n", [], "message"),
        (2, "error: something is wrong\n", [], "nameless"),
        (2, RIGHT, ["out/half"], "left"),
        (1, "Traceback (most recent call last):\n", [], "traceback"),
        (0, "/a/b.py:3: RuntimeWarning: overflow encountered\n  x * y\n", [], "warning"),
    ],
)
def test_what_a_call_came_to(code: int, printed: str, changed: list[str], verdict: str) -> None:
    assert verdict_of(code, printed, changed, ["a.yaml"]) == verdict


@pytest.mark.parametrize("suffix", [".yaml", ".json", ".csv", ".sdf"])
def test_a_file_is_broken_in_many_ways_and_the_same_way_again(suffix: str) -> None:
    data = {
        ".yaml": b"name: small\nobjects:\n  - {x: [0.4, 0.7], y: 1}\nseed: 0\n",
        ".json": b'{"regions": [1, 2], "hashes": {"model": "x"}}',
        ".csv": b"x,y\n0.5,0.1\n0.6,0.2\n",
        ".sdf": b"<sdf><model name='m'><link name='l'><pose>0 0 1</pose></link></model></sdf>",
    }[suffix]
    broken = [BREAKERS[suffix](np.random.default_rng(i), data) for i in range(200)]
    assert broken[:20] == [BREAKERS[suffix](np.random.default_rng(i), data) for i in range(20)]
    assert len(set(broken)) > 100
    assert sum(one != data for one in broken) > 180


def test_inputs_are_shared_out_by_the_kinds_shares() -> None:
    found = Counter(kind for kind, _ in shared_out(1000, list(KINDS)))
    total = sum(share for share, _ in KINDS.values())
    wanted = {kind: 1000 * share / total for kind, (share, _) in KINDS.items()}
    assert wanted == pytest.approx(found, abs=1.0)
    assert sum(found.values()) == 1000
    some = Counter(kind for kind, _ in shared_out(100, ["study", "run directory"]))
    assert some == {"study": 33, "run directory": 67}


def test_the_table_counts_by_kind_and_in_all() -> None:
    counts = Counter({("log", "refused"): 1200, ("log", "crash"): 1, ("study", "refused"): 3})
    head, _, *rows = table(counts).splitlines()
    assert head.split(" | ")[:3] == ["| kind", "inputs", "refused"]
    found = [[cell.strip() for cell in row.strip("|").split("|")][:3] for row in rows]
    assert found == [["log", "1,201", "1,200"], ["study", "3", "3"], ["all", "1,204", "1,203"]]


@pytest.mark.slow
def test_four_hundred_broken_inputs_show_no_fault(tmp_path: Path) -> None:
    make_originals(tmp_path)
    found = list(verdicts(shared_out(400, list(KINDS)), 2026, tmp_path, 2))
    assert len(found) == 400
    assert [one for one in found if one["verdict"] in FAULTS] == []
