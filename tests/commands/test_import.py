"""``drake-screw import`` as a user meets it."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.commands.conftest import Command


@pytest.fixture
def log(library: Path, tmp_path: Path) -> Path:
    """A table as it may come from a logger: other names, tabs, milliseconds, no objects."""
    lines = (sorted(library.iterdir())[0] / "joint_angles.csv").read_text().splitlines()
    rows = [line.split(",")[:8] for line in lines]
    file = tmp_path / "log.tsv"
    header = ["t_ms", *(f"actual_q_{i}" for i in range(7))]
    text = [[f"{float(row[0]) * 1e3:.3f}", *row[1:]] for row in rows[1:]]
    file.write_text("\n".join("\t".join(row) for row in [header, *text]))
    return file


def test_a_dry_run_says_what_is_understood_and_writes_nothing(command: Command, log: Path) -> None:
    before = sorted(log.parent.iterdir())
    code, out, _ = command("import", log, "--dry-run")
    assert code == 0
    for words in (
        "table, separated by tabs",
        "column 't_ms' in ms (by its name)",
        "by number, actual_q_0 .. actual_q_6",
        "radians, within the arm's limits",
        "bowl not said yet",
        "time_unit: ms",
        "joints: [actual_q_0, actual_q_1,",
    ):
        assert words in out
    assert sorted(log.parent.iterdir()) == before


def test_a_library_is_written_that_look_reads(command: Command, log: Path) -> None:
    at_hand = ("--object", "bowl=0.8,0.1")
    code, out, _ = command("import", log, "--output", "mine", *at_hand)
    assert code == 0
    assert "written: mine/log" in out
    code, out, _ = command("look", "mine/log")
    assert code == 0
    assert "of the bowl" in out
    code, _, err = command("import", log, "--output", "mine", *at_hand)
    assert code == 2
    assert "exists already; nothing is overwritten" in err


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ([], "no --output"),
        (["--output", "new"], "where was the bowl? The file does not say"),
        (["--output", "new", "--object", "bowl=800,100"], "It looks like millimetres"),
        (["--output", "new", "--object", "cup=1,2"], "no object 'cup' in the scenario"),
        (["--output", "new", "--object", "bowl=one"], "object bowl: found 'one'"),
        (["--output", "new", "--object", "bowl"], "expected NAME=PLACE"),
        (["--output", "new", "--object", "bowl@hand:99s"], "the recording lasts from 0 to"),
        (["--output", "new", "--format", "tabel"], "Did you mean 'table'?"),
    ],
)
def test_wrong_input(command: Command, log: Path, words: list[str], message: str) -> None:
    code, _, err = command("import", log, *words)
    assert code == 2
    assert message in err
    assert not Path("new").exists()


def test_a_column_that_may_be_the_time_is_named_and_the_line_that_says_so_works(
    command: Command, log: Path
) -> None:
    rows = log.read_text().splitlines()
    log.write_text("\n".join([rows[0].replace("t_ms", "Zeit (ms)"), *rows[1:]]))
    code, _, err = command("import", log, "--dry-run")
    assert code == 2
    assert "no column of time" in err
    assert "the line 'time: Zeit (ms)' into a file recording.yaml beside the data" in err
    assert "--rate HZ" in err
    (log.parent / "recording.yaml").write_text("time: Zeit (ms)\n")
    code, out, _ = command("import", log, "--dry-run")
    assert code == 0
    assert "column 'Zeit (ms)' in ms (by its name)" in out


def test_recordings_are_not_brought_in_again_but_looked_at(command: Command, library: Path) -> None:
    code, _, err = command("import", library, "--dry-run")
    assert code == 2
    assert "these are recordings already" in err
    assert f"drake-screw look {library}" in " ".join(err.split())


def test_a_mapping_beside_the_data_is_read_and_checked(command: Command, log: Path) -> None:
    beside = log.parent / "recording.yaml"
    beside.write_text("objects: {bowl: [0.8, 0.1]}\nangels: rad\n")
    code, _, err = command("import", log, "--output", "new")
    assert code == 2
    assert "recording.yaml:2: angels: unknown key" in err
    assert "Did you mean 'angles'?" in err
    beside.write_text("objects: {bowl: 'hand:1.5s+0,0,0.12'}\n")
    code, out, _ = command("import", log, "--dry-run")
    assert code == 0
    assert "where the hand was at 1.5 s, upright" in out


@pytest.mark.parametrize("encoding", ["latin-1", "ascii"])
def test_words_on_a_console_that_is_not_utf_8(encoding: str) -> None:
    program = (
        "from drake_screw.commands.any_console import any_console; any_console(); "
        "print('\\u2588\\u2588 \\u2264 \\u03c0 \\u2026')"
    )
    done = subprocess.run(
        [sys.executable, "-c", program],
        env={**os.environ, "PYTHONIOENCODING": encoding},
        capture_output=True,
        check=True,
    )
    assert done.stdout == b"## <= pi ...\n"


def test_other_verbs_take_files_to_which_nothing_has_to_be_added(
    command: Command, log: Path
) -> None:
    folder = log.parent / "logs"
    folder.mkdir()
    log.rename(folder / "log.tsv")
    (folder / "recording.yaml").write_text("objects: {bowl: [0.8, 0.1]}\n")
    code, out, _ = command("look", folder)
    assert code == 0
    assert "of the bowl" in out


def test_a_file_with_two_demonstrations_is_cut_at_the_pause(command: Command, log: Path) -> None:
    header, *lines = log.read_text().splitlines()
    end = float(lines[-1].split("\t")[0])
    again = [line.split("\t") for line in lines]
    shifted = [f"{float(row[0]) + end + 3000.0:.3f}\t" + "\t".join(row[1:]) for row in again]
    log.write_text("\n".join([header, *lines, *shifted]))
    at = ("--object", "bowl=0.8,0.1")
    code, _, err = command("import", log, "--output", "mine", *at)
    assert code == 2
    assert "with episodes: pauses in recording.yaml" in err
    code, out, _ = command("import", log, "--dry-run", "--episodes", "pauses", *at)
    assert code == 0
    assert "is 2 of 2 in the file, from " in out
    assert "episodes: pauses" in out
    code, out, _ = command("import", log, "--output", "mine", "--episodes", "pauses", *at)
    assert code == 0
    assert sorted(each.name for each in Path("mine").iterdir()) == ["log_01", "log_02"]
    first, second = (Path("mine") / name / "joint_angles.csv" for name in ("log_01", "log_02"))
    assert len(first.read_text().splitlines()) == len(second.read_text().splitlines())
    code, _, err = command("import", log, "--dry-run", "--episodes", "pause", *at)
    assert code == 2
    assert "episodes: no column 'pause'" in err
    assert "Did you mean 'pauses'?" in err
