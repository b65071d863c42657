"""Recordings made on one robot, followed by another: recorded_on, and the scenario of the iiwa."""

from __future__ import annotations

import json
import re
from itertools import islice
from pathlib import Path

import numpy as np
import pytest

from drake_screw.acquisition import Finished, RoundFinished, Suggestion
from drake_screw.assembly.preview import preview
from drake_screw.assembly.setup import Setup
from drake_screw.assembly.swap_model import swap_model
from drake_screw.demonstrations import (
    Recording,
    demonstration_from_recording,
    read_recording,
    write_recording,
)
from drake_screw.errors import (
    DrakeScrewError,
    ModelError,
    RecordingError,
    RunDirectoryError,
    ScenarioError,
)
from drake_screw.resources import find_resource
from drake_screw.runs.executions import execute
from drake_screw.runs.outcome_table import tabulate_outcomes
from drake_screw.runs.run import new_run, open_run
from drake_screw.runs.trajectory import write_trajectory
from drake_screw.scenario.loader import dump_scenario, load_scenario

PLACES = ((0.75, 0.2), (0.8, 0.65), (0.95, 0.0))
IIWA = [f"iiwa_joint_{i}" for i in range(1, 8)]
QUICK = [
    "objects.0.symmetry=null",
    "regions.grid={x: 1, y: 2}",
    "coverage.beta=0.6",
    "coverage.epsilon=0.1",
]


@pytest.fixture(scope="module")
def baxter() -> Setup:
    return Setup(load_scenario("pouring"))


@pytest.fixture(scope="module")
def library(baxter: Setup, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Recordings of Baxter in its own work area, two of which lie outside that of the iiwa."""
    folder = tmp_path_factory.mktemp("of_baxter")
    for number, place in enumerate(PLACES):
        suggestion = Suggestion(0, np.array([[*place, 0.0]]))
        lesson = baxter.teacher.demonstrate(
            suggestion, number=number, used=(), rng=np.random.default_rng(number)
        )
        assert lesson.recording is not None
        write_recording(lesson.recording, folder / lesson.recording.name)
    return folder


@pytest.fixture(scope="module")
def changes(library: Path) -> list[str]:
    return ["teacher={kind: recorded}", f"teacher.folder={library}", *QUICK]


@pytest.fixture(scope="module")
def finished(changes: list[str], tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A finished run of the iiwa with Baxter's recordings; do not change it."""
    folder = tmp_path_factory.mktemp("runs") / "iiwa"
    events = list(new_run(load_scenario("pouring_iiwa", changes), folder).events())
    assert isinstance(events[-1], Finished)
    return folder


def read(folder: Path, setup: Setup) -> Recording:
    arm = setup.workcell.arm
    return read_recording(folder, arm.joint_names, arm.lower, arm.upper)


def test_the_shipped_scenario_is_of_the_iiwa_and_knows_of_baxter(baxter: Setup) -> None:
    scenario = load_scenario("pouring_iiwa")
    robot, other = scenario.robot, scenario.recorded_on
    assert (robot.model, robot.joints, robot.end_effector) == ("iiwa14", tuple(IIWA), "hand")
    assert other is not None
    assert other.joints == baxter.scenario.robot.joints
    assert other.end_effector == baxter.scenario.robot.end_effector
    setup = Setup(scenario)
    assert setup.workcell.arm.margin(setup.workcell.start).min() > 0.1
    own, theirs = scenario.objects[0], baxter.scenario.objects[0]
    for axis in ("x", "y"):
        ours, width = getattr(own, axis), getattr(theirs, axis)
        assert ours.upper - ours.lower == pytest.approx(width.upper - width.lower, abs=0.005)
    bowl = setup.area.X_WO(np.array([[0.45, 0.0, 0.0]]))
    assert not setup.workcell.collides(setup.workcell.start[None], bowl).any()


def test_guiding_poses_are_those_of_the_arm_that_was_led(
    baxter: Setup, library: Path, changes: list[str]
) -> None:
    setup = Setup(load_scenario("pouring_iiwa", changes))
    for folder in sorted(library.iterdir()):
        expected = demonstration_from_recording(read(folder, baxter), baxter.workcell.arm)
        recording = setup.recorder.read(folder)
        assert recording.robot == "baxter"
        learned = setup.learn(recording)
        np.testing.assert_array_equal(learned.X_OE, expected.X_OE)
        np.testing.assert_allclose(learned.transfer(expected.X_WO), expected.path[expected.kept])


def test_check_tells_what_an_arm_cannot_follow_of_what_it_was_shown(changes: list[str]) -> None:
    """The segment, and why; nothing of recordings that it can follow where they were made."""
    lost = "not planned where it was shown"
    seven = preview(load_scenario("pouring_iiwa", changes)).kept
    assert [lost in line for line in seven] == [False, False, True], seven
    five = [
        f"robot.joints=[{', '.join(IIWA[i] for i in (0, 1, 3, 5, 6))}]",
        "robot.start=[0.7, 0.6, -1.9, -0.93, 0.0]",
        "robot.parked={iiwa_joint_3: 0.3, iiwa_joint_5: 0.3}",
    ]
    said = preview(load_scenario("pouring_iiwa", [*changes, *five])).kept
    assert len(said) == len(PLACES)
    for line in said:
        assert re.search(
            rf"; {lost}, of \d+ segments: .*\bsegment \d+( is out of reach)?$",
            line,
        ), line


def test_places_are_seen_from_the_shoulder_at_the_height_of_the_object(
    baxter: Setup, library: Path, changes: list[str]
) -> None:
    setup = Setup(load_scenario("pouring_iiwa", changes))
    recording = setup.recorder.read(library / "demo_01")
    seen = setup.recorder.seen(recording)
    ours, theirs = (s.workcell.arm.screw_chain().shoulder for s in (setup, baxter))
    np.testing.assert_allclose(
        seen[0, :2, 3] - ours[:2], recording.X_WO[0, :2, 3] - theirs[:2], atol=1e-12
    )
    assert seen[0, 2, 3] == setup.area.z[0]
    learned = setup.learn(recording)
    np.testing.assert_array_equal(learned.X_WO, seen)
    np.testing.assert_allclose(
        learned.transfer(learned.X_WO), learned.path[learned.kept], atol=1e-12
    )


def test_the_teacher_prefers_recordings_that_work_where_it_is_asked(changes: list[str]) -> None:
    setup = Setup(load_scenario("pouring_iiwa", changes))
    rng = np.random.default_rng(0)
    recordings = setup.recorder.library(setup.scenario.teacher.folder or Path())
    learned = [setup.learn(recording) for recording in recordings]
    asked = 0
    for place in rng.uniform(setup.area.lower, setup.area.upper, (40, 1, 3)):
        X_WO = setup.area.X_WO(place)[None]
        works = setup.planner.all_outcomes(learned, X_WO, setup.workcell.start).success[0]
        lesson = setup.teacher.demonstrate(Suggestion(0, place), number=0, used=(), rng=rng)
        assert lesson.recording is not None
        names = [r.name for r, good in zip(recordings, works, strict=True) if good]
        if 0 < len(names) < len(recordings):
            asked += 1
            assert lesson.recording.name in names
            assert "that work there" in lesson.remark
    assert asked > 5


def test_the_run_directory_keeps_the_recordings_of_the_other_robot(
    finished: Path, library: Path, baxter: Setup
) -> None:
    record = json.loads((finished / "run.json").read_text())
    assert set(record["hashes"]) == {"model", "recorded_on"}
    for entry in record["demonstrations"]:
        assert entry["robot"] == "baxter"
        copied = (finished / entry["folder"] / "joint_angles.csv").read_bytes()
        assert copied == (library / entry["name"] / "joint_angles.csv").read_bytes()
    run = open_run(finished)
    assert run.setup.scenario == load_scenario(finished / "scenario.yaml")
    rounds = [e for e in run.replay() if isinstance(e, RoundFinished)]
    assert len(rounds) == len(record["rounds"])
    for demonstration in run.demonstrations:
        recording = read(library / demonstration.name, baxter)
        expected = demonstration_from_recording(recording, baxter.workcell.arm)
        np.testing.assert_array_equal(demonstration.X_OE, expected.X_OE)
    reader = open_run(finished).reader
    tried = reader.attempts(0, 0)[0]
    found = reader.outcomes(0, 0)
    assert tried.arm.joint_names == tuple(IIWA)
    assert (tried.failed_segment is None) == bool(found.success[0])


@pytest.mark.slow
def test_an_interrupted_run_ends_as_if_it_had_not_been(
    finished: Path, changes: list[str], tmp_path: Path
) -> None:
    run = new_run(load_scenario("pouring_iiwa", changes), tmp_path / "run")
    events = run.events()
    list(islice(events, 4))
    events.close()  # type: ignore[attr-defined]
    for _ in open_run(tmp_path / "run").events():
        pass
    ends = [json.loads((path / "run.json").read_text()) for path in (finished, tmp_path / "run")]
    for key in ("status", "rounds", "certificate"):
        assert ends[0][key] == ends[1][key]


def test_plans_are_executed_and_exported_with_the_own_arm(finished: Path, tmp_path: Path) -> None:
    setup = open_run(finished).setup
    rng = np.random.default_rng(5)
    X = rng.uniform(setup.area.lower, setup.area.upper, (50, 1, 3))
    outcomes = setup.planner.any_success(
        open_run(finished).demonstrations, setup.area.X_WO(X), setup.workcell.start
    )
    place = X[int(np.argmax(outcomes.any_success))][0, :2].tolist()
    before = set(finished.iterdir())
    text = str(execute(finished, instance=place, workers=1))
    assert "1 instance, 1 executed" in text
    assert {item.name for item in set(finished.iterdir()) - before} <= {"executions"}
    write_trajectory(finished, place, "npz", tmp_path / "plan.npz")
    with np.load(tmp_path / "plan.npz") as plan:
        assert plan["joint_names"].tolist() == IIWA
        np.testing.assert_allclose(plan["q"][0], setup.workcell.start, atol=1e-9)
    write_trajectory(finished, place, "ros-trajectory", tmp_path / "plan.yaml")
    assert "iiwa_joint_7" in (tmp_path / "plan.yaml").read_text()
    with pytest.raises(ScenarioError, match="baxter-csv is for Baxter, which has no joint") as e:
        write_trajectory(finished, place, "baxter-csv", tmp_path / "plan.csv")
    assert e.value.remedy is not None
    assert "--format ros-trajectory or " in e.value.remedy
    assert "baxter-csv" not in e.value.remedy
    assert not (tmp_path / "plan.csv").exists()


def test_listed_recordings_are_of_the_other_robot_and_the_teachers_of_the_own(
    library: Path, tmp_path: Path
) -> None:
    changes = [f"demonstrations.initial=[{library / 'demo_02'}]", "demonstrations.budget=2", *QUICK]
    scenario = load_scenario("pouring_iiwa", [*changes, "coverage.beta=0.8"])
    assert "recorded   on baxter, 7 joints" in str(preview(scenario))
    for _ in new_run(scenario, tmp_path / "run").events():
        pass
    record = json.loads((tmp_path / "run" / "run.json").read_text())
    assert [entry["robot"] for entry in record["demonstrations"]] == ["baxter", None]
    header = (tmp_path / "run" / record["demonstrations"][1]["folder"] / "joint_angles.csv").open()
    assert header.readline().strip().split(",") == ["time", *IIWA]
    first, second = open_run(tmp_path / "run").demonstrations
    assert first.X_OE.shape[1:] == second.X_OE.shape[1:] == (4, 4)


def test_places_are_evaluated_with_the_other_robots_recordings(
    library: Path, tmp_path: Path
) -> None:
    (tmp_path / "places.csv").write_text("x,y\n0.6,-0.1\n0.7,0.2\n")
    scenario = load_scenario("pouring_iiwa")
    tabulate_outcomes(scenario, library, tmp_path / "places.csv", tmp_path / "outcomes.csv")
    rows = (tmp_path / "outcomes.csv").read_text().splitlines()
    assert len(rows) == 3
    names = ["demo_01", "demo_02", "demo_03"]
    assert rows[0].split(",") == ["x", "y", *names, *(f"{name}:bowl" for name in names)]
    turns = np.array([row.split(",")[-3:] for row in rows[1:]], dtype=float)
    assert (np.abs(turns) <= np.pi).all()
    assert len(np.unique(turns)) > 1


def test_a_model_of_the_other_robot_that_changed_is_noticed(
    finished: Path, changes: list[str], tmp_path: Path
) -> None:
    model = tmp_path / "theirs.sdf"
    model.write_text(find_resource("models", "baxter", (".sdf",)).read_text())
    scenario = load_scenario("pouring_iiwa", [*changes, f"recorded_on.model={model}"])
    new_run(scenario, tmp_path / "run")
    assert open_run(tmp_path / "run").setup.recorder.model_file == model
    model.write_text(model.read_text() + "\n")
    with pytest.raises(RunDirectoryError, match=r"theirs\.sdf has changed since this run"):
        open_run(tmp_path / "run")


def test_another_model_of_the_robot_leaves_the_other_robot_alone(tmp_path: Path) -> None:
    scenario = load_scenario("pouring_iiwa")
    own = find_resource("models", "iiwa14", (".sdf",))
    swapped = swap_model(scenario, own)
    assert swapped.robot.model == str(own)
    assert swapped.recorded_on == scenario.recorded_on
    with pytest.raises(ModelError, match="the joints of the robot that recordings were") as e:
        swap_model(scenario, find_resource("models", "baxter", (".sdf",)))
    assert "--set recorded_on.model=" in (e.value.remedy or "")


def test_a_path_of_its_model_is_seen_from_the_file(tmp_path: Path) -> None:
    text = dump_scenario(load_scenario("pouring_iiwa")).replace("model: baxter", "model: other.sdf")
    (tmp_path / "mine.yaml").write_text(text)
    scenario = load_scenario(tmp_path / "mine.yaml")
    assert scenario.recorded_on is not None
    assert scenario.recorded_on.model == str(tmp_path / "other.sdf")
    with pytest.raises(ModelError, match=r"recorded_on: no file '.*other\.sdf'"):
        preview(scenario)
    assert scenario == load_scenario(tmp_path / "mine.yaml")


@pytest.mark.parametrize(
    ("change", "message", "remedy"),
    [
        ("recorded_on.end_effector=left_hnd", "recorded_on: no frame 'left_hnd'", "'left_hand'"),
        ("recorded_on.base=foot", "recorded_on: no link 'foot' in model 'baxter'", "Links: base"),
        ("recorded_on.joints=[left_s0, left_s9]", "recorded_on: no joint 'left_s9'", "left_s1"),
        (
            "recorded_on=null",
            "no column 'iiwa_joint_1'",
            "describe that one in a block recorded_on, as scenario pouring_iiwa does",
        ),
    ],
)
def test_what_is_wrong_with_the_other_robot_is_said(
    changes: list[str], change: str, message: str, remedy: str
) -> None:
    scenario = load_scenario("pouring_iiwa", [*changes, change])
    with pytest.raises(DrakeScrewError) as caught:
        preview(scenario)
    assert message in str(caught.value)
    assert remedy in (caught.value.remedy or "")


def test_recordings_of_the_own_robot_are_told_apart(library: Path) -> None:
    theirs = "recorded_on={model: iiwa14, joints: [iiwa_joint_1, iiwa_joint_2], end_effector: hand}"
    teacher = ["teacher={kind: recorded}", f"teacher.folder={library}"]
    with pytest.raises(RecordingError, match="no column 'iiwa_joint_1'") as caught:
        preview(load_scenario("pouring", [*teacher, theirs]))
    assert "It is of the scenario's own robot: remove the block" in (caught.value.remedy or "")


@pytest.mark.parametrize(
    ("block", "message"),
    [
        ("{model: baxter}", "recorded_on.joints: missing; expected a list of texts"),
        ("{model: baxter, joints: [a], end_effector: b, start: [0]}", "recorded_on.start: unknown"),
        ("baxter", "recorded_on: expected a mapping with keys model, joints, end_effector"),
        ("{model: baxter, joints: [], end_effector: b}", "recorded_on.joints: expected at least"),
    ],
)
def test_a_block_that_cannot_be_used_is_refused(block: str, message: str) -> None:
    with pytest.raises(ScenarioError) as caught:
        load_scenario("pouring_iiwa", ["recorded_on=null", f"recorded_on={block}"])
    assert message in str(caught.value)


@pytest.mark.slow
def test_a_simulated_teacher_of_the_iiwa_leads_to_a_certificate(tmp_path: Path) -> None:
    scenario = load_scenario("pouring_iiwa", QUICK)
    assert "none yet" in str(preview(scenario))
    *_, end = new_run(scenario, tmp_path / "run").events()
    assert isinstance(end, Finished)
    assert end.status == "certified"
    record = json.loads((tmp_path / "run" / "run.json").read_text())
    assert {entry["robot"] for entry in record["demonstrations"]} == {None}


@pytest.mark.slow
def test_people_who_led_baxter_teach_the_iiwa(shared: Path, tmp_path: Path) -> None:
    model = shared / "reference" / "baxter_left_calibrated.sdf"
    changes = [
        "teacher={kind: recorded}",
        f"teacher.folder={shared / 'demos' / 'pouring'}",
        f"recorded_on.model={model}",
    ]
    scenario = load_scenario("pouring_iiwa", changes)
    run = new_run(scenario, tmp_path / "run")
    *_, end = run.events()
    assert isinstance(end, Finished)
    assert end.status == "certified"
    assert len(end.demonstrations) <= 8
    rng = np.random.default_rng(11)
    X = run.setup.area.X_WO(rng.uniform(run.setup.area.lower, run.setup.area.upper, (2000, 1, 3)))
    served = run.setup.planner.any_success(end.demonstrations, X, run.setup.workcell.start)
    assert served.any_success.mean() >= scenario.coverage.beta
    own = scenario.model_copy(update={"recorded_on": None})
    with pytest.raises(RecordingError, match="no column 'iiwa_joint_1'"):
        new_run(own, tmp_path / "own")
    assert not (tmp_path / "own").exists()
