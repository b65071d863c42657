"""Runs whose objects have more free axes than x, y and yaw: what they leave is read again."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import pytest

from drake_screw import Setup
from drake_screw.acquisition import (
    DemonstrationRequested,
    Finished,
    RoundFinished,
    Suggestion,
)
from drake_screw.errors import ScenarioError
from drake_screw.runs.instance_tables import read_instances
from drake_screw.runs.narration import describe
from drake_screw.runs.outcome_columns import outcome_columns
from drake_screw.runs.pictures import plane_of
from drake_screw.runs.records import SuggestionRecord
from drake_screw.runs.run import Run, new_run, open_run
from drake_screw.scenario.loader import load_scenario

SHELF = [
    "objects.0.z=[-0.0645, 0.1]",
    "objects.0.pitch=[-0.1, 0.1]",
    "objects.0.symmetry=null",
    "regions={grid: {z: 2, y: 2}}",
    "demonstrations.first=middle",
    "demonstrations.budget=1",
    "planner.collision=false",
    "coverage.beta=0.5",
    "coverage.epsilon=0.2",
]


@pytest.fixture(scope="module")
def shelf(tmp_path_factory: pytest.TempPathFactory) -> Run:
    """A run of pouring into a bowl at any height that is a little pitched; do not change it."""
    run = new_run(load_scenario("pouring", SHELF), tmp_path_factory.mktemp("runs") / "shelf")
    assert any(isinstance(event, Finished) for event in run.events())
    return run


def test_its_instances_and_suggestions_are_read_again(shelf: Run) -> None:
    path = shelf.directory.path
    told = [event for event in open_run(path).replay() if isinstance(event, RoundFinished)]
    with np.load(path / "round_01" / "instances.npz") as data:
        assert data["x_y_yaw"].shape[1:] == data["z_roll_pitch"].shape[1:] == (1, 3)
        stored = np.concatenate([data["x_y_yaw"], data["z_roll_pitch"]], axis=-1)
    found = told[0].evaluation.coordinates
    np.testing.assert_array_equal(found, stored)
    assert shelf.setup.area.contains(found).all()
    assert np.ptp(found[:, 0, 3]) > 0.15
    np.testing.assert_array_equal(told[0].regions.index(found), told[0].evaluation.region)


def test_its_tables_have_a_column_for_what_varies(shelf: Run, tmp_path: Path) -> None:
    table = list(csv.reader((shelf.directory.path / "round_01" / "regions.csv").open()))
    ends = [f"{axis}_{end}" for axis in ("x", "y", "yaw", "z", "pitch") for end in ("min", "max")]
    assert table[0] == ["region", *ends, "samples", "failures", "failure_rate", "lower", "upper"]
    file, area = tmp_path / "places.csv", shelf.setup.area
    file.write_text("x,y,z,pitch\n0.9,0.3,0.05,0.02\n")
    places = read_instances(file, area)
    (coordinates,) = places.blocks()
    assert coordinates.tolist() == [[[0.9, 0.3, 0.0, 0.05, 0.0, 0.02]]]
    outcomes = shelf.setup.evaluate(shelf.demonstrations, coordinates)
    told = shelf.setup, shelf.demonstrations, coordinates, places.columns, outcomes
    names = [column.name for column in outcome_columns(*told)]
    assert names[:5] == ["x", "y", "z", "pitch", shelf.demonstrations[0].name]
    file.write_text("x,y,z\n0.9,0.3,0.05\n")
    with pytest.raises(ScenarioError, match="no column 'pitch', and it varies"):
        read_instances(file, area)


def test_a_plan_pours_at_the_height_that_is_given(shelf: Run) -> None:
    plans = [
        shelf.setup.plan(shelf.demonstrations, {"bowl": {"x": 0.9, "y": 0.3, "z": z, "pitch": 0.0}})
        for z in (-0.06, 0.04)
    ]
    low, high = (shelf.setup.workcell.arm.pose(plan.plan.q[-1])[2, 3] for plan in plans)
    assert high - low == pytest.approx(0.1, abs=1e-3)
    with pytest.raises(ScenarioError, match="no z is given for 'bowl', and it varies"):
        shelf.setup.plan(shelf.demonstrations, {"bowl": (0.9, 0.3)})


def test_a_suggestion_survives_its_record(shelf: Run) -> None:
    regions = shelf.setup.regions
    place = np.array([[0.9, 0.3, 0.0, 0.05, 0.0, -0.02]])
    suggestion = Suggestion(1, place, 2, regions)
    record = SuggestionRecord.of(suggestion, regions)
    assert list(record.objects["bowl"]) == ["x", "y", "yaw", "z", "pitch"]
    np.testing.assert_array_equal(record.suggestion(regions).coordinates, place)
    told = describe(DemonstrationRequested(0, 0, suggestion), regions)
    assert "bowl x 0.900 m, y 0.300 m, z 0.050 m, pitch -0.02 rad (region 1" in told


def test_axes_of_pictures_are_named(shelf: Run) -> None:
    assert plane_of(shelf.setup, ["z", "y"]) == ((0, 3), (0, 1))
    assert plane_of(shelf.setup, ["bowl.z", "y"]) == ((0, 3), (0, 1))
    for names, message in (
        (["z"], "expected two axes of a heat map, found z"),
        (["z", "z"], "expected two axes"),
        (["z", "bowl.z"], "expected two axes"),
        (["z", "cup.y"], "no axis 'cup.y' in this work area"),
    ):
        with pytest.raises(ScenarioError, match=message):
            plane_of(shelf.setup, names)


def test_a_certificate_says_how_objects_are_placed(tmp_path: Path) -> None:
    cup = "{name: cup, x: [0.75, 0.95], y: [0.0, 0.3], z: 0.0, radius: 0.04, height: 0.1}"
    two = [
        "objects=[{name: bowl, x: [0.75, 0.95], y: [0.0, 0.3], z: -0.0645, radius: 0.08, "
        f"height: 0.06, orientation: any}}, {cup}]",
        "apart=true",
        "regions={grid: {bowl.pitch: 2}}",
        "demonstrations.budget=1",
        "coverage.beta=0.5",
        "coverage.epsilon=0.2",
    ]
    run = new_run(load_scenario("pouring", two), tmp_path / "two")
    rounds = [event for event in run.events() if isinstance(event, RoundFinished)]
    area = run.setup.area
    found = rounds[0].evaluation.coordinates
    away = np.linalg.norm(np.diff(area.X_WO(found)[:, :, :2, 3], axis=1)[:, 0], axis=-1)
    assert len(found) >= 32
    assert not area.overlaps(found).any()
    assert away.min() > 0.0
    assert area.overlaps(found[:1] * 0.0 + [0.8, 0.1, 0.0, 0.0, 0.0, 0.0]).all()
    words = " ".join(open_run(tmp_path / "two").directory.record.certificate.statement)
    assert (
        "bowl turned in any way, uniformly on SO(3), without those at which objects overlap"
        in words
    )


def test_a_region_without_room_is_refused_before_anything_is_written(tmp_path: Path) -> None:
    crowded = [
        "objects=[{name: bowl, x: [0.8, 0.82], y: [0.0, 0.3], z: 0, radius: 0.08, height: 0.06}, "
        "{name: cup, x: [0.8, 0.82], y: [0.0, 0.3], z: 0, radius: 0.08, height: 0.06}]",
        "apart=true",
        "regions={grid: {bowl.y: 3, cup.y: 3}}",
    ]
    with pytest.raises(ScenarioError) as error:
        new_run(load_scenario("pouring", crowded), tmp_path / "run")
    assert "region 0 (bowl y 0.00..0.10, cup y 0.00..0.10): objects overlap" in str(error.value)
    assert not (tmp_path / "run").exists()
    roomy = load_scenario("pouring", [*crowded[:2], "regions={grid: {}}"])
    assert len(Setup(roomy).workcell.objects) == 2
