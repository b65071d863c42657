"""Executions of a round in progress, on disk."""

from __future__ import annotations

import pytest

from drake_screw.errors import RunDirectoryError
from drake_screw.execution.parallel import Judged
from drake_screw.runs.kept_executions import FILE, KeptExecutions

GOOD = Judged("", "", 3, 1.0, 1e-3, 2e-3, 0.0, 0.0, 0.0)
BAD = Judged("pushed", "the bowl is pushed by 9.0 mm", 2, 0.4, 1e-3, 2e-3, 9e-3, 0.1, 4.0)
PLACE, OTHER = (0.1 + 0.2, 1 / 3, 0.0), (0.7, 0.1, 0.0)


def test_what_is_kept_is_known_again_to_the_last_bit(tmp_path) -> None:
    KeptExecutions(tmp_path).keep(0, PLACE, GOOD)
    KeptExecutions(tmp_path).keep(0, OTHER, BAD)
    assert KeptExecutions(tmp_path).known(0) == {PLACE: GOOD, OTHER: BAD}
    assert KeptExecutions(tmp_path).known(1) == {}


def test_a_line_that_was_cut_off_is_dropped(tmp_path) -> None:
    kept = KeptExecutions(tmp_path)
    kept.keep(0, PLACE, GOOD)
    with (tmp_path / FILE).open("a") as file:
        file.write('{"round": 1, "pla')
    assert kept.known(0) == {PLACE: GOOD}
    kept.keep(0, OTHER, BAD)
    assert kept.known(0) == {PLACE: GOOD, OTHER: BAD}


@pytest.mark.parametrize(
    "line", ["nonsense", "{}", "[" * 100_000, '{"round": 1, "place": [], "judged": {}}', "3"]
)
def test_a_damaged_line_is_told_with_its_number(tmp_path, line: str) -> None:
    kept = KeptExecutions(tmp_path)
    kept.keep(0, PLACE, GOOD)
    with (tmp_path / FILE).open("a") as file:
        file.write(f"{line}\n")
    with pytest.raises(RunDirectoryError, match="no execution") as error:
        kept.known(0)
    assert f"{FILE}:2" in str(error.value)


def test_it_is_gone_once_it_is_forgotten(tmp_path) -> None:
    kept = KeptExecutions(tmp_path)
    kept.forget()
    kept.keep(0, PLACE, GOOD)
    kept.forget()
    assert list(tmp_path.iterdir()) == []


def test_what_cannot_be_written_is_told(tmp_path) -> None:
    with pytest.raises(RunDirectoryError, match="cannot be written"):
        KeptExecutions(tmp_path / "nowhere").keep(0, PLACE, GOOD)
