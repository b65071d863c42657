"""What a run writes is read again as it was, and what is damaged is named."""

from __future__ import annotations

import csv
import io
import json
import os
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from drake_screw.acquisition import Evaluation, RoundFinished
from drake_screw.bandits import Verdict
from drake_screw.errors import RunDirectoryError
from drake_screw.files import printable, write_text
from drake_screw.planning import Outcomes
from drake_screw.runs.codec import json_text, load_evaluation, read_run_record, save_evaluation
from drake_screw.runs.records import RoundRecord
from drake_screw.runs.region_table import regions_csv
from drake_screw.tasks import ObjectArea, WorkArea, grid_regions
from tests.small_runs import finished_run

__all__ = ["finished_run"]

AREA = WorkArea((ObjectArea("bowl, blue", (0.5, -0.5, 0.0), (1.0, 0.5, 0.0), -0.06),))


def evaluation(region: np.ndarray) -> Evaluation:
    N = len(region)
    outcomes = Outcomes(
        np.zeros((N, 1), "u1"), np.full((N, 1), -1, "i2"), np.full((N, 1), -1, "i1"),
        np.ones((N, 1), "f4"), np.zeros((N, 1), "i2"),
    )  # fmt: skip
    return Evaluation(np.zeros((N, 1, 3)), region, outcomes)


@pytest.mark.parametrize(("K", "dtype"), [(16, "uint16"), (65_536, "uint16"), (70_000, "uint32")])
def test_regions_are_stored_as_integers_that_hold_them(tmp_path: Path, K: int, dtype: str) -> None:
    region = np.arange(K)
    save_evaluation(tmp_path / "instances.npz", evaluation(region))
    with np.load(tmp_path / "instances.npz") as data:
        assert data["region"].dtype == dtype
    found = load_evaluation(tmp_path / "instances.npz").region
    assert found.dtype == np.int64
    np.testing.assert_array_equal(found, region)


def test_a_round_without_instances_can_be_stored(tmp_path: Path) -> None:
    save_evaluation(tmp_path / "instances.npz", evaluation(np.empty(0, dtype=np.int64)))
    assert len(load_evaluation(tmp_path / "instances.npz").region) == 0


@pytest.mark.parametrize(
    ("name", "change", "message"),
    [
        ("segment", lambda a: a.astype(str), "segment is of type <U.* and shape"),
        ("cause", lambda a: a[:, 0], "segment is of type int16 and shape"),
        ("pair", lambda a: a[:1], "pair is of type int16 and shape"),
        ("fraction", lambda a: a.astype(int), "fraction is of type int64 and shape"),
        ("cause", lambda a: a + 99, "cause holds numbers that stand for none"),
        ("region", lambda a: a.astype(int) - 5, "region holds numbers below 0"),
        ("x_y_yaw", lambda a: a + np.nan, "x_y_yaw holds numbers that are not finite"),
        ("x_y_yaw", lambda a: a[..., 0], "x_y_yaw is of type float64 and shape"),
    ],
)
def test_instances_of_another_kind_or_shape_are_damaged(
    tmp_path: Path, name: str, change: Callable[[np.ndarray], np.ndarray], message: str
) -> None:
    file = tmp_path / "instances.npz"
    save_evaluation(file, evaluation(np.arange(4)))
    with np.load(file) as data:
        arrays = dict(data)
    np.savez(file, **arrays | {name: change(arrays[name])})
    with pytest.raises(ValueError, match=message):
        load_evaluation(file)


def test_run_json_is_written_as_it_was_read(finished_run: Path) -> None:
    file = finished_run / "run.json"
    record = read_run_record(file)
    assert json_text(record) == file.read_text()
    assert record.certificate is not None
    assert record.certificate.reason == record.reason


def verdict_of(K: int, samples: int) -> Verdict:
    return Verdict(
        certified=False,
        region=K - 1,
        reason="region flagged",
        claim="this region fails",
        samples=np.full(K, samples),
        failures=np.zeros(K, dtype=np.int64),
        lower=np.linspace(0.0, 1.0 / 3.0, K),
        upper=np.ones(K),
        level=0.95,
        simultaneous=True,
        gap=None,
        coverage=0.1,
        attempted=False,
        looks=1,
    )


def test_a_verdict_comes_back_exactly() -> None:
    verdict, regions = verdict_of(3, samples=7), grid_regions(AREA, {"x": 3})
    event = RoundFinished(0, (), evaluation(np.zeros(1, int)), verdict, None, regions)
    again = RoundRecord.of(event).verdict.verdict
    for name, value in vars(verdict).items():
        np.testing.assert_array_equal(getattr(again, name), value)
        assert type(getattr(again, name)) is type(value)
    assert again.samples.dtype == verdict.samples.dtype


def test_rates_of_regions_without_samples_are_kept(finished_run: Path, tmp_path: Path) -> None:
    record = read_run_record(finished_run / "run.json")
    rates = (*record.rounds[0].failure_rates[2:], float("nan"), float("inf"))
    first = replace(record.rounds[0], failure_rates=rates)
    file = tmp_path / "run.json"
    file.write_text(json_text(replace(record, rounds=(first,))))
    np.testing.assert_array_equal(read_run_record(file).rounds[0].failure_rates, rates)


def test_the_table_of_regions_is_csv() -> None:
    regions = grid_regions(AREA, {"x": 2})
    rows = list(csv.DictReader(io.StringIO(regions_csv(verdict_of(2, samples=0), regions))))
    assert [row["region"] for row in rows] == ["0", "1"]
    assert [row["x_min"] for row in rows] == ["0.5", "0.75"]
    assert rows[1]["lower"] == "0.333333"
    assert rows[0]["failure_rate"] == "nan"
    assert None not in rows[0]


def change_verdict(record: dict) -> None:
    record["rounds"][1]["verdict"]["samples"][3] = "many"


def remove_from_verdict(record: dict) -> None:
    del record["rounds"][0]["verdict"]["upper"]


def change_remark(record: dict) -> None:
    record["demonstrations"][1]["remark"] = 7


def remove_coverage(record: dict) -> None:
    del record["certificate"]["coverage"]


def leave_out_a_region(record: dict) -> None:
    record["rounds"][0]["failure_rates"].pop()


def leave_out_bounds(record: dict) -> None:
    record["rounds"][0]["verdict"]["upper"] = []


def name_no_region(record: dict) -> None:
    record["rounds"][1]["weakest_region"] = 16


def conclude_of_no_region(record: dict) -> None:
    record["rounds"][1]["verdict"]["region"] = -1


def change_seed(record: dict) -> None:
    record["seed"] = "3"


@pytest.mark.parametrize("text", ["", "[" * 100_000, '{"format":' * 100_000, "[1]", '{"a": 1}'])
def test_what_is_no_record_is_told(text: str, tmp_path) -> None:
    (tmp_path / "run.json").write_text(text)
    with pytest.raises(RunDirectoryError, match=r"damaged|not what a run writes") as error:
        read_run_record(tmp_path / "run.json")
    assert error.value.file == tmp_path / "run.json"


@pytest.mark.parametrize(
    ("damage", "expected"),
    [
        (change_verdict, "what it says of round 2 is damaged: 'verdict.samples.3' is 'many'"),
        (remove_from_verdict, "what it says of round 1 is incomplete: no 'verdict.upper'"),
        (change_remark, "what it says of demonstration 2 is damaged: 'remark' is 7"),
        (remove_coverage, "'certificate' is "),
        (change_seed, "'seed' is '3'"),
        (leave_out_a_region, "what it says of round 1 is of different numbers of regions"),
        (leave_out_bounds, "what it says of round 1 is of different numbers of regions"),
        (name_no_region, "what it says of round 2 is of a weakest region that is none of its 16"),
        (
            conclude_of_no_region,
            "what it says of round 2 is of a weakest region that is none of its 16",
        ),
    ],
)
def test_damage_is_named_with_its_place(finished_run, tmp_path, damage, expected) -> None:
    record = json.loads((finished_run / "run.json").read_text())
    damage(record)
    (tmp_path / "run.json").write_text(json.dumps(record))
    with pytest.raises(RunDirectoryError) as error:
        read_run_record(tmp_path / "run.json")
    assert expected in error.value.message
    assert error.value.file == tmp_path / "run.json"


def test_names_of_files_that_are_no_utf_8_are_written_as_they_can_be(
    finished_run: Path, tmp_path: Path
) -> None:
    """Linux takes any bytes for a name; Python has those that are no UTF-8 as lone surrogates."""
    name = os.fsdecode(b"d\xffmo")
    assert printable(name) == r"d\xffmo"
    record = replace(read_run_record(finished_run / "run.json"), model=name)
    write_text(tmp_path / "run.json", json_text(record))
    assert read_run_record(tmp_path / "run.json").model == "d?mo"
