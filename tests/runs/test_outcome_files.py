"""Tables of outcomes: whole or not there, the same however they are written."""

from __future__ import annotations

import csv
import gzip
from pathlib import Path

import numpy as np
import pyarrow.parquet as pq
import pytest

from drake_screw.runs.outcome_files import Column, outcome_file

NAMES = ["demo, second try", 'the "good" one']


def blocks() -> list[list[Column]]:
    """Two, of which the second says that something touches."""
    return [
        [
            Column("x", np.array([0.6, 0.1 + 0.2]), ".9g"),
            Column(NAMES[0], np.array(["0:0", "3:5"])),
            Column(NAMES[1], np.array(["1:n", "2:c"])),
            Column("turn", np.array([0.12345, -1.0]), ".4f"),
            Column("first:touches", np.array(["", ""]), dispensable=True),
            Column("second:touches", np.array(["", touches]), dispensable=True),
        ]
        for touches in ("", "hand-bowl")
    ]


def write(file: Path) -> bytes:
    with outcome_file(file) as table:
        for block in blocks():
            table.add(block)
    return file.read_bytes()


TEXT = """x,"demo, second try","the ""good"" one",turn,second:touches
0.6,0:0,1:n,0.1235,
0.3,3:5,2:c,-1.0000,
0.6,0:0,1:n,0.1235,
0.3,3:5,2:c,-1.0000,hand-bowl
"""


def test_what_touches_has_a_column_where_something_does(tmp_path: Path) -> None:
    assert write(tmp_path / "out.csv").decode() == TEXT
    assert [file.name for file in tmp_path.iterdir()] == ["out.csv"]


def test_gzipped_it_is_the_same_to_the_byte_every_time(tmp_path: Path) -> None:
    content = write(tmp_path / "out.csv.gz")
    assert gzip.decompress(content).decode() == TEXT
    assert content == write(tmp_path / "other.csv.gz")


def test_parquet_has_the_same_columns_with_numbers_as_they_are(tmp_path: Path) -> None:
    content = write(tmp_path / "out.parquet")
    assert content == write(tmp_path / "other.parquet")
    table = pq.read_table(tmp_path / "out.parquet")
    rows = list(csv.reader(TEXT.splitlines()))
    assert table.column_names == rows[0]
    assert [str(field.type) for field in table.schema] == [
        "double", "string", "string", "double", "string",
    ]  # fmt: skip
    assert table["x"].to_pylist() == [0.6, 0.1 + 0.2] * 2
    assert table["turn"].to_pylist() == [0.12345, -1.0] * 2
    assert table[NAMES[0]].to_pylist() == [row[1] for row in rows[1:]]
    assert table["second:touches"].to_pylist() == [row[4] for row in rows[1:]]


@pytest.mark.parametrize("name", ["out.csv", "out.csv.gz", "out.parquet"])
@pytest.mark.parametrize("error", [ValueError, KeyboardInterrupt])
def test_nothing_stays_of_a_table_that_is_given_up(tmp_path: Path, name: str, error) -> None:
    (tmp_path / name).write_bytes(b"as it was")

    def give_up() -> None:
        with outcome_file(tmp_path / name) as table:
            table.add(blocks()[0])
            raise error

    with pytest.raises(error):
        give_up()
    assert [file.name for file in tmp_path.iterdir()] == [name]
    assert (tmp_path / name).read_bytes() == b"as it was"
