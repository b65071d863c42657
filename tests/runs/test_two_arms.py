"""A run with two arms: recorded, evaluated, certified or not, executed, exported, inspected."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from unittest.mock import patch

import numpy as np
import pytest

from drake_screw import Setup, load_scenario
from drake_screw.acquisition import Finished
from drake_screw.assembly.looking import look_at_path
from drake_screw.assembly.preview import preview
from drake_screw.demonstrations import write_recording
from drake_screw.errors import RecordingError
from drake_screw.runs.codec import load_evaluation
from drake_screw.runs.executions import execute
from drake_screw.runs.outcome_table import tabulate_outcomes
from drake_screw.runs.run import new_run, open_run
from drake_screw.runs.trajectory import write_trajectory
from drake_screw.web.inspector_page import save_page
from drake_screw.web.look_page import look_page
from drake_screw.web.selection import select
from tests.assembly.two_arms import START, scenario_in, setup_in, shown

TURNS = "objects.0.symmetry={axis: z, turns: any}"
CHANGES = ["objects.0.y=[-0.6, 0.6]", "objects.0.x=0.5", TURNS]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Scenario and a recording of the right arm."""
    folder = tmp_path_factory.mktemp("two")
    recording = shown(setup_in(folder), 1)
    write_recording(recording, folder / "recordings" / recording.name)
    return folder


@pytest.fixture(scope="module")
def finished(folder: Path) -> Path:
    scenario = load_scenario(folder / "two_arms.yaml", CHANGES)
    *_, end = new_run(scenario, folder / "run").events()
    assert isinstance(end, Finished)
    return folder / "run"


def test_the_check_tells_of_both(folder: Path) -> None:
    text = str(preview(load_scenario(folder / "two_arms.yaml")))
    assert "arm left: two, 3 joints, end effector 'left_hand', reach" in text
    assert "arm right: two, 3 joints, end effector 'right_hand', reach" in text
    assert "1 recording" in text


def test_the_certificate_says_which_arms_may_be_used(finished: Path) -> None:
    stated = open_run(finished).certificate
    assert stated is not None
    assert stated.arms == ("left", "right")
    said = " ".join(stated.statement)
    assert "A plan is of one arm, left or right, the first of these that can, from its own" in said
    assert json.loads((finished / "run.json").read_text())["certificate"]["arms"] == [
        "left",
        "right",
    ]


def test_the_run_remembers_the_arms_and_an_old_one_has_but_one(finished: Path) -> None:
    file = finished / "round_01" / "instances.npz"
    assert set(np.unique(load_evaluation(file).outcomes.arm)) == {0, 1}
    with np.load(file) as data:
        before = {name: data[name] for name in data if name != "arm"}
    old = finished.parent / "old.npz"
    np.savez(old, **before)
    assert not load_evaluation(old).outcomes.arm.any()


@pytest.mark.parametrize(("y", "arm", "joint"), [(0.5, "left", "l1"), (-0.4, "right", "r1")])
def test_the_arm_of_the_plan_moves_and_the_other_holds_its_start(
    finished: Path, tmp_path: Path, y: float, arm: str, joint: str
) -> None:
    done = execute(finished, instance=[0.5, y], workers=1)
    assert f"1 executed: 1 by arm {arm}" in str(done)
    assert done.summary.done == 1, str(done)
    table = (done.folder / "executions.csv").read_text().splitlines()
    row = dict(zip(table[0].split(","), table[1].split(","), strict=True))
    assert (row["arm"], row["status"]) == (arm, "done")
    assert (done.folder / "executions.html").is_file()
    made = write_trajectory(finished, [0.5, y], "npz", tmp_path / "plan.npz")
    assert f"for arm {arm}" in str(made)
    with np.load(tmp_path / "plan.npz") as data:
        assert data["joint_names"][0] == joint
        np.testing.assert_allclose(data["q"][0], START[arm])


def test_the_inspector_names_the_arm_and_shows_the_other_at_rest(
    finished: Path, tmp_path: Path
) -> None:
    reader = open_run(finished).reader
    outcomes = reader.event(0).evaluation.outcomes
    for number, name in enumerate(START):
        instance = int(np.flatnonzero(outcomes.success[:, 0] & (outcomes.arm[:, 0] == number))[0])
        selection = select(reader, 0, instance)
        page = save_page(reader, selection, tmp_path / f"{name}.html")
        found = json.loads(page.with_suffix(".json").read_text())["attempts"][0]
        assert found["arm"] == name
        assert f"succeeds with arm {name}" in found["words"]
        assert f"arm {name}" in page.read_text()


def test_a_table_of_outcomes_has_the_arm(folder: Path, tmp_path: Path) -> None:
    instances = tmp_path / "instances.csv"
    instances.write_text("x,y\n0.5,0.5\n0.5,-0.2\n0.5,-0.4\n0.5,1.3\n")
    scenario = load_scenario(folder / "two_arms.yaml", [TURNS])
    table = tabulate_outcomes(scenario, folder / "recordings", instances, tmp_path / "out.csv")
    assert table.arms == {"left": 0.25, "right": 0.5}
    assert "of these with arm right: 50.00%" in str(table)
    header, *rows = (tmp_path / "out.csv").read_text().splitlines()
    column = header.split(",").index("demo_01:arm")
    assert [row.split(",")[column] for row in rows][:3] == ["left", "right", "right"]


def with_both(folder: Path, setup: Setup, number: int, *, wild: bool = False) -> Path:
    """A recording with the columns of both arms, of which one moves."""
    recording, other = shown(setup, number), setup.arms[1 - number]
    idle = np.tile(other.start, (len(recording.t), 1))
    if wild:
        recording = replace(recording, q=recording.q + 40.0 * (np.arange(len(idle)) == 9)[:, None])
        recording = replace(recording, q=np.where(np.arange(120)[:, None] > 60, 9.0, recording.q))
    names = (*other.arm.joint_names, *recording.joint_names)
    both = replace(recording, joint_names=names, q=np.hstack([idle, recording.q]))
    write_recording(both, folder)
    return folder


@pytest.mark.parametrize("number", [0, 1])
def test_a_recording_of_both_arms_is_of_the_one_that_moves(tmp_path: Path, number: int) -> None:
    setup = setup_in(tmp_path)
    read = setup.recorder.read(with_both(tmp_path / "demo", setup, number))
    assert read.joint_names == setup.arms[number].arm.joint_names
    name = setup.arms[number].name
    assert any(f"taken to be of '{name}', which moves most" in note for note in read.notes)
    learned = setup.learn(read)
    expected = setup.arms[number].arm.pose(shown(setup, number).q[-1])
    np.testing.assert_allclose(learned.path[-1], expected, atol=1e-6)


def test_the_page_of_a_recording_moves_the_arm_that_was_led(folder: Path) -> None:
    setup = Setup(load_scenario(folder / "two_arms.yaml"))
    looks = look_at_path(setup, folder / "recordings" / "demo_01")
    assert looks.looks[0].recording.joint_names[0] == "r1"
    with patch("drake_screw.web.look_page.animate") as moved:
        look_page(looks)
    (call,) = moved.call_args_list
    assert call.args[1].arm.joint_names == ("r1", "r2", "r3")


def test_an_arm_that_rests_is_not_taken_for_one_whose_angles_cannot_be(tmp_path: Path) -> None:
    setup = setup_in(tmp_path)
    with pytest.raises(RecordingError, match="r1"):
        setup.recorder.read(with_both(tmp_path / "demo", setup, 1, wild=True))


def test_a_recording_of_neither_arm_is_refused(tmp_path: Path) -> None:
    setup = setup_in(tmp_path)
    other = replace(shown(setup, 0), joint_names=("a", "b", "c"))
    write_recording(other, tmp_path / "demo")
    with pytest.raises(RecordingError, match="l1") as caught:
        setup.recorder.read(tmp_path / "demo")
    assert "The joints of one arm are needed, 'left' or 'right'." in str(caught.value.remedy)


def test_a_table_from_elsewhere_is_of_the_arm_that_moves(tmp_path: Path) -> None:
    setup = setup_in(tmp_path)
    recording, left = shown(setup, 1), setup.arms[0]
    head = ["time", *left.arm.joint_names, *recording.joint_names]
    idle = np.tile(left.start, (len(recording.t), 1))
    rows = np.column_stack([recording.t, idle, recording.q])
    (tmp_path / "log").mkdir()
    np.savetxt(
        tmp_path / "log" / "a.csv", rows, fmt="%.9f", delimiter=",", header=",".join(head),
        comments="",
    )  # fmt: skip
    (tmp_path / "log" / "recording.yaml").write_text("objects: {pot: [0.6, -0.3]}\n")
    (read,) = setup.recordings(tmp_path / "log")
    assert read.joint_names == recording.joint_names
    assert any("taken to be of 'right'" in note for note in read.notes)


def test_scenario_is_what_a_run_keeps(folder: Path, finished: Path) -> None:
    again = open_run(finished).setup.scenario
    assert again == load_scenario(scenario_in(folder), CHANGES)
