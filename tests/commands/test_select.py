"""``drake-screw select``: which recordings to keep, on the terminal and as JSON."""

from __future__ import annotations

import json
import re
import shutil
from pathlib import Path

import numpy as np
import pytest
import yaml

from tests.commands.conftest import QUICK, Command
from tests.commands.test_json import check_keys

SMALL = ["--instances", 100, *QUICK]


@pytest.fixture
def doubled(certified: Path, tmp_path: Path) -> Path:
    """The recordings of a run, each twice: at least half of them are of no use."""
    folder = tmp_path / "twice"
    for recording in sorted((certified / "demonstrations").iterdir()):
        shutil.copytree(recording, folder / recording.name)
        shutil.copytree(recording, folder / f"{recording.name}_again")
    return folder


def test_the_recordings_to_keep_and_by_how_much(command: Command, doubled: Path) -> None:
    code, out, err = command(
        "select", "pouring", "--demonstrations", doubled, *SMALL, "--json", "found.json"
    )
    assert (code, err) == (0, "")
    found = json.loads(Path("found.json").read_text())
    check_keys("select", found)
    chosen = found["chosen"]
    total = len(found["recordings"])
    assert 0 < len(chosen) <= total // 2
    assert not any(name.endswith("again") for name in chosen)  # the first in order of those alike
    assert found["status"] == "certified"
    assert found["folders"] == [str(doubled / name) for name in chosen]
    assert found["attempts"][-1]["recordings"] == chosen
    assert [one["name"] for one in found["recordings"] if one["chosen"]] == chosen
    assert f"attempt 1: {', '.join(found['attempts'][0]['recordings'])}; " in out
    kept = re.findall(r"^([0-9]{2}_demo_[0-9]+) +[\d.]+% +[\d.]+% +kept", out, re.MULTILINE)
    assert kept == chosen
    assert (
        f"{len(chosen)} of {total} recordings: the fewest that solve 85 % of 100 instances" in out
    )
    assert "The runner-up of" in out
    assert "certificate" in out
    block = yaml.safe_load(out[out.index("\ndemonstrations:") :])
    assert block == {"demonstrations": {"initial": found["folders"]}}


def test_a_run_goes_on_from_the_chosen(command: Command, doubled: Path) -> None:
    command("select", "pouring", "--demonstrations", doubled, *SMALL, "--json", "found.json")
    found = json.loads(Path("found.json").read_text())
    initial = f"demonstrations.initial=[{', '.join(found['folders'])}]"
    code, out, _ = command("run", "pouring", *QUICK, "--set", initial, "--output", "here", "-q")
    assert code == 0
    assert f"with {len(found['chosen'])} demonstration" in out.replace("\n", " ")


def test_not_enough_recordings_end_with_where_more_are_needed(
    command: Command, library: Path, tmp_path: Path
) -> None:
    shutil.copytree(library / "demo_01", tmp_path / "one" / "demo_01")
    code, out, err = command(
        "select", "pouring", "--demonstrations", "one", "--instances", 50, "--json", "-"
    )
    found = json.loads(out)
    check_keys("select", found)
    assert code == 1
    assert (found["status"], found["chosen"], found["attempts"]) == ("insufficient", [], [])
    assert found["short"]
    worst = found["short"][0]
    assert worst["failures"] == max(region["failures"] for region in found["short"]) > 2
    assert "where another demonstration is needed" in err
    assert f"{worst['region']}  {worst['name']}" in err
    assert "no certificate" in err
    assert "The recording fails more than 0.05 of the time in" in err
    assert "initial:" not in err


def test_a_recording_of_which_nothing_is_kept_is_named(
    command: Command, doubled: Path, tmp_path: Path
) -> None:
    astray = doubled / "astray"
    shutil.copytree(next(doubled.iterdir()), astray)
    poses = np.loadtxt(astray / "object_poses.csv", delimiter=",")
    poses[2, 3] -= 0.7
    np.savetxt(astray / "object_poses.csv", poses, delimiter=",")
    code, out, _ = command("select", "pouring", "--demonstrations", doubled, *SMALL)
    assert code == 0
    assert "not used: astray: " in out


@pytest.mark.parametrize(
    ("args", "words"),
    [
        (["--demonstrations", "nowhere"], "no such file or folder"),
        (["--demonstrations", "."], "no recordings here"),
        (["--demonstrations", ".", "--set", "coverage.epsilon=0.2"], "epsilon"),
        (["--demonstrations", ".", "--json", "nowhere/found.json"], "there is no folder"),
    ],
)
def test_bad_input_ends_with_a_message(command: Command, args: list[str], words: str) -> None:
    code, out, err = command("select", "pouring", *args)
    assert (code, out) == (2, "")
    assert words in err
    assert list(Path().iterdir()) == []


def test_recordings_of_people(command: Command, shared: Path) -> None:
    code, out, err = command(
        "select", "pouring", "--demonstrations", shared / "demos" / "pouring",
        "--model", shared / "reference" / "baxter_left_calibrated.sdf", "--json", "-",
        "--set", "objects.0.symmetry=null",
    )  # fmt: skip
    found = json.loads(out)
    assert code == 0
    assert len(found["recordings"]) == 16
    assert len(found["chosen"]) == 3
    assert found["smallest"]
    assert found["fewer"]["success_in_weakest"] < 0.97
    assert "3 of 16 recordings" in err
