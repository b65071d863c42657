from __future__ import annotations

import gzip
import sys
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from drake_screw.errors import ScenarioError
from drake_screw.runs import instance_files
from drake_screw.runs.instance_tables import Instances, read_instances
from drake_screw.steps import Step
from drake_screw.tasks import ObjectArea, WorkArea
from drake_screw.typing import Array

BOWL = ObjectArea("bowl", (0.5, -0.5, 0.25), (1.0, 0.5, 0.25), -0.06)
CUP = ObjectArea("cup", (0.5, -0.5, -1.0), (1.0, 0.5, 1.0), 0.0)
ONE, TWO = WorkArea((BOWL,)), WorkArea((BOWL, CUP))


def read(file: Path, area: WorkArea) -> Array:
    """All coordinates (N, k, c)."""
    return np.concatenate(list(read_instances(file, area).blocks()))


def write(tmp_path, text):
    file = tmp_path / "in.csv"
    file.write_text(text)
    return file


def test_columns_are_found_by_name_in_any_order(tmp_path) -> None:
    file = write(tmp_path, "note,y,x\na,0.1,0.6\n\nb,0.2,0.7\n")
    expected = [[[0.6, 0.1, 0.25]], [[0.7, 0.2, 0.25]]]
    assert np.array_equal(read(file, ONE), expected)


def test_several_objects_have_their_own_columns(tmp_path) -> None:
    file = write(tmp_path, "bowl.x,bowl.y,cup.x,cup.y,cup.yaw\n0.6,0.1,0.8,-0.1,0.5\n")
    expected = [[[0.6, 0.1, 0.25], [0.8, -0.1, 0.5]]]
    assert np.array_equal(read(file, TWO), expected)


def test_what_is_fixed_needs_no_column(tmp_path) -> None:
    rail = ObjectArea("bowl", (0.5, 0.1, 0.25), (1.0, 0.1, 0.25), 0.0)
    file = write(tmp_path, "x\n0.6\n0.7\n")
    assert np.array_equal(read(file, WorkArea((rail,))), [[[0.6, 0.1, 0.25]], [[0.7, 0.1, 0.25]]])
    stand = ObjectArea("stand", (0.4, -0.3, 0.5), (0.4, -0.3, 0.5), 0.0)
    file = write(tmp_path, "bowl.x,bowl.y\n0.6,0.1\n")
    expected = [[[0.6, 0.1, 0.25], [0.4, -0.3, 0.5]]]
    assert np.array_equal(read(file, WorkArea((BOWL, stand))), expected)
    with pytest.raises(ScenarioError, match=r"no column 'bowl\.y', and it varies"):
        read_instances(write(tmp_path, "bowl.x,stand.x\n0.6,0.4\n"), WorkArea((BOWL, stand)))


def test_what_is_fixed_and_given_otherwise_is_counted(tmp_path) -> None:
    stand = ObjectArea("stand", (0.4, -0.3, 0.5), (0.4, -0.3, 0.5), 0.0)
    area = WorkArea((BOWL, stand))
    file = write(tmp_path, "bowl.x,bowl.y,stand.x,stand.y\n0.6,0.1,0.4,-0.3\n9,0.1,0.5,-0.3\n")
    found = read_instances(file, area)
    (coordinates,) = found.blocks()
    assert coordinates[1, 1].tolist() == [0.5, -0.3, 0.5]
    assert found.unlike_fixed == {"stand.x": 1}
    turned = read_instances(write(tmp_path, "x,y,yaw\n0.6,0.1,0.25\n0.6,0.1,1\n"), ONE)
    assert turned.unlike_fixed == {"yaw": 1}


@pytest.mark.parametrize(
    ("text", "message", "line"),
    [
        ("x,z\n1,2\n", "no column 'y'", 1),
        ("", "no column 'x'", 1),
        ("x,y\n1,2\n1,two\n", "y is 'two'", 3),
        ("x,y\n1\n", "y is nothing", 2),
        ("x,y\n1,inf\n", "y is 'inf'", 2),
        ("x,y\n", "no instances", None),
        ("x,y,bowl.x\n1,2,1\n", "the columns 'x' and 'bowl.x' mean the same", 1),
        ("x,y,x\n1,2,1\n", "the columns 'x' and 'x' mean the same", 1),
        ("x,y\n\n1,2\n" + 9 * "1,2\n" + "\n1,\n", "y is ''", 14),
    ],
)
def test_bad_tables_are_refused_with_their_place(tmp_path, text, message, line) -> None:
    file = write(tmp_path, text)
    with pytest.raises(ScenarioError, match=message) as error:
        read_instances(file, ONE)
    assert (error.value.file, error.value.line) == (file, line)


def test_a_yaw_that_varies_is_never_filled_in(tmp_path) -> None:
    turning = WorkArea((ObjectArea("bowl", (0.5, -0.2, -0.8), (1.0, 0.2, 0.8), 0.0),))
    with pytest.raises(ScenarioError, match="no column 'yaw', and it varies") as error:
        read_instances(write(tmp_path, "x,y\n0.6,0.1\n"), turning)
    assert error.value.line == 1
    given = read(write(tmp_path, "x,y,yaw\n0.6,0.1,-0.3\n"), turning)
    assert given.tolist() == [[[0.6, 0.1, -0.3]]]
    with pytest.raises(ValueError, match="the yaw of 'bowl' varies, and is missing"):
        turning.complete([[0.6, 0.1]])
    assert turning.complete([[0.6, 0.1, 0.2]]).tolist() == [[[0.6, 0.1, 0.2]]]


def test_a_missing_table(tmp_path) -> None:
    with pytest.raises(ScenarioError, match="No such file"):
        read_instances(tmp_path / "none.csv", ONE)


@pytest.fixture
def small_blocks(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(instance_files, "ROWS", 4)


TABLE = "region,x,y\n" + "".join(f"{i},{0.5 + 0.01 * i:.2f},0.1\n" for i in range(11))


def written(folder: Path, kind: str, text: str = TABLE) -> Path:
    """The same table as a file of a kind."""
    file = folder / f"in.{kind}"
    if kind == "csv":
        file.write_text(text)
    elif kind == "csv.gz":
        file.write_bytes(gzip.compress(text.encode()))
    else:
        names, *rows = [line.split(",") for line in text.splitlines()]
        columns = zip(*([float(cell) for cell in row] for row in rows), strict=True)
        pq.write_table(pa.table(dict(zip(names, map(list, columns), strict=True))), file)
    return file


@pytest.mark.parametrize("kind", ["csv", "csv.gz", "parquet"])
def test_tables_of_every_kind_are_read_block_by_block(tmp_path, small_blocks, kind) -> None:
    told: list[Step] = []
    found = read_instances(written(tmp_path, kind), ONE, told.append)
    assert len(found) == 11
    assert [len(block) for block in found.blocks()] == [4, 4, 3]
    places = np.concatenate(list(found.blocks()))
    assert np.array_equal(places[:, 0, 0], [float(f"{0.5 + 0.01 * i:.2f}") for i in range(11)])
    assert found.columns == ((0, 0), (0, 1))
    parts = [step.done for step in told[1:]]
    assert parts == sorted(parts)
    assert parts[-1] == 1.0


def test_what_there_is_to_say_is_of_all_blocks(tmp_path, small_blocks) -> None:
    """The yaw is another one in the last row alone."""
    rows = "0.6,0.1,0.25\n" * 9
    assert read_instances(write(tmp_path, f"x,y,yaw\n{rows}"), ONE).columns == ((0, 0), (0, 1))
    found = read_instances(write(tmp_path, f"x,y,yaw\n{rows}0.6,0.1,0.5\n"), ONE)
    assert found.columns == ((0, 0), (0, 1), (0, 2))
    assert found.unlike_fixed == {"yaw": 1}


def test_instances_beyond_memory_come_back_from_the_disk() -> None:
    found, rng = Instances(TWO), np.random.default_rng(0)
    places = rng.uniform(size=(3, 50_000, 2, 3))
    for block in places:
        found.add(block)
    assert np.array_equal(np.stack(list(found.blocks())), places)


@pytest.mark.parametrize("name", ["bowl.x", "bowl_x"])
def test_the_only_object_may_be_named(tmp_path, name) -> None:
    y = name.replace("x", "y")
    file = write(tmp_path, f"region,{name},{y}\n0,0.6,0.1\n")
    assert np.array_equal(read(file, ONE), [[[0.6, 0.1, 0.25]]])


def test_tables_of_executions_are_read_as_they_were_written_once(tmp_path) -> None:
    file = write(tmp_path, "bowl_x,bowl_y,cup_x,cup_y,cup_yaw\n0.6,0.1,0.8,-0.1,0.5\n")
    assert np.array_equal(read(file, TWO), [[[0.6, 0.1, 0.25], [0.8, -0.1, 0.5]]])


@pytest.mark.parametrize(
    ("values", "found"),
    [
        ([1.0, None], "row 12: y is nothing"),
        ([1.0, float("nan")], "row 12: y is nan"),
        (["1.0", "2.0"], "row 1: y is '0.1'"),
    ],
)
def test_rows_of_parquet_are_told_by_their_numbers(tmp_path, small_blocks, values, found) -> None:
    y = [0.1] * 10 + values if values[0] == 1.0 else ["0.1"] * 10 + values
    file = tmp_path / "in.parquet"
    pq.write_table(pa.table({"x": [0.6] * 12, "y": y}), file)
    with pytest.raises(ScenarioError, match=found):
        read_instances(file, ONE)


def test_objects_are_found_in_parquet_by_their_dotted_names(tmp_path) -> None:
    file = tmp_path / "in.parquet"
    columns = {"bowl.x": [0.6], "cup.yaw": [0.5], "bowl.y": [1], "cup.x": [0.8], "cup.y": [0.2]}
    pq.write_table(pa.table(columns), file)
    assert np.array_equal(read(file, TWO), [[[0.6, 1.0, 0.25], [0.8, 0.2, 0.5]]])


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("in.parquet", b"x,y\n0.6,0.1\n", "cannot be read: Parquet magic bytes not found"),
        ("in.csv.gz", b"x,y\n0.6,0.1\n", "cannot be read: Not a gzipped file"),
        (
            "in.csv.gz",
            gzip.compress(TABLE.encode(), mtime=0)[:-12],
            "cannot be read: Compressed file ended",
        ),
        (
            "in.csv",
            gzip.compress(TABLE.encode(), mtime=0),
            "cannot be read: 'utf-8' codec can't decode",
        ),
        ("in.csv", b"x,y\n" + b'"' + 200_000 * b"1" + b'",2\n', "cannot be read: field larger"),
        ("in.parquet.gz", b"", "Parquet is compressed already"),
    ],
)
def test_files_that_are_not_what_they_are_called(tmp_path, name, content, message) -> None:
    file = tmp_path / name
    file.write_bytes(content)
    with pytest.raises(ScenarioError, match=message) as error:
        read_instances(file, ONE)
    assert error.value.file == file


def test_parquet_needs_pyarrow(tmp_path, monkeypatch) -> None:
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    with pytest.raises(ScenarioError, match=r"(?s)need pyarrow.*drake-screw\[parquet\]"):
        read_instances(tmp_path / "in.parquet", ONE)


def test_a_parquet_file_is_never_in_memory_as_a_whole(tmp_path) -> None:
    rng = np.random.default_rng(0)
    file = tmp_path / "in.parquet"
    columns = {"x": rng.uniform(0.5, 1.0, 1 << 20), "y": rng.uniform(-0.5, 0.5, 1 << 20)}
    pq.write_table(pa.table(columns), file, row_group_size=1 << 16)
    before, most, rows = pa.total_allocated_bytes(), 0, 0
    with instance_files.open_instances(file) as found:
        for block in found.blocks((0, 1)):
            most = max(most, pa.total_allocated_bytes() - before)
            rows += len(block.numbers)
    assert rows == 1 << 20
    assert most < file.stat().st_size / 3
