"""Numbers of long tables are kept on disk, and are the same there."""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np
import pytest

from drake_screw.errors import RecordingError
from drake_screw.tables import text
from drake_screw.tables.rows import Columns, Rows
from drake_screw.tables.text import read_table


@pytest.mark.parametrize("most", [1, 10_000, 1 << 20])
def test_columns_are_those_of_the_rows(most: int) -> None:
    values = np.random.default_rng(0).normal(size=(1000, 5))
    kept = Rows(5, most)
    for part in np.split(values, [0, 1, 400, 999]):
        kept.add(part)
    assert len(kept) == 1000
    columns = Columns(["a", "b", "a", "c", "d"], kept)
    assert list(columns) == ["a", "b", "c", "d"]
    assert len(columns) == 4
    assert "b" in columns
    assert "e" not in columns
    for name, j in (("d", 4), ("a", 0), ("c", 3), ("b", 1)):
        np.testing.assert_array_equal(columns[name], values[:, j])


def test_without_rows_columns_are_empty() -> None:
    for kept in (Rows(2, 1), Rows(2, 1 << 20)):
        assert len(kept) == 0
        assert kept.column(1).shape == (0,)


@pytest.fixture
def file(tmp_path: Path) -> Path:
    values = np.random.default_rng(1).normal(size=(5000, 3))
    path = tmp_path / "long.csv"
    np.savetxt(path, values, fmt="%.17g", delimiter=",", header="t,x,y", comments="")
    return path


def test_a_large_file_is_read_as_a_small_one(file: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(text, "BLOCK", 10_000)
    small = read_table(file)
    monkeypatch.setattr(text, "LARGE", 1)
    large = read_table(file)
    assert large.names == small.names == ("t", "x", "y")
    assert large.numeric == small.numeric
    np.testing.assert_array_equal(large.lines, small.lines)
    for name in small.names:
        np.testing.assert_array_equal(large.numbers(name), small.numbers(name))
    some = large.rows(np.array([3, 4000]))
    np.testing.assert_array_equal(some.numbers("y"), small.numbers("y")[[3, 4000]])


def test_a_large_file_with_words_is_read_cell_by_cell(
    file: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(text, "LARGE", 1)
    file.write_text(file.read_text() + "1,2,three\n")
    assert read_table(file).columns["y"][-1] == "three"


def test_no_room_on_the_disk_is_told(file: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(text, "LARGE", 1)

    def full(**_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(tempfile, "TemporaryFile", full)
    with pytest.raises(RecordingError, match=r"cannot be read: .*No space left"):
        read_table(file)
