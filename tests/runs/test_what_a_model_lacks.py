"""What a model lacks for simulation: planning goes on, and the rest says what it takes."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from drake_screw.acquisition import Finished
from drake_screw.assembly.preview import preview
from drake_screw.errors import ModelError, ScenarioError
from drake_screw.runs.executions import execute
from drake_screw.runs.run import new_run
from drake_screw.runs.trajectory import write_trajectory
from drake_screw.scenario.loader import dump_scenario, load_scenario
from tests.robot.six_joints import NAMES, scenario, urdf

PLACE = (0.6, 0.1)
Run = Callable[..., Path]


@pytest.fixture
def run(tmp_path: Path) -> Run:
    """Makes a model, and a finished run with it."""

    def make(robot: str = "", **kwargs: object) -> Path:
        (tmp_path / "six.urdf").write_text(urdf(**kwargs))
        (tmp_path / "six.yaml").write_text(scenario(robot=robot))
        *_, end = new_run(load_scenario(tmp_path / "six.yaml"), tmp_path / "run").events()
        assert isinstance(end, Finished)
        assert end.demonstrations
        return tmp_path / "run"

    return make


@pytest.mark.parametrize(
    "limit",
    [
        'velocity="0" effort="100"',
        pytest.param('effort="100"', marks=pytest.mark.slow),
        pytest.param("", marks=pytest.mark.slow),
    ],
)
def test_without_velocity_limits_all_goes_on_and_says_so(run: Run, limit: str) -> None:
    lacking = dict.fromkeys(("j1", "j4"), limit)
    folder = run(limits=lacking, transmissions=NAMES)
    said = "1 rad/s for j1, j4 taken"
    text = str(preview(load_scenario(folder.parent / "six.yaml")))
    assert text.count("no velocity limit") == 1
    assert said in text
    written = write_trajectory(folder, PLACE, "npz", folder / "plan.npz")
    assert str(written).count("no velocity limit") == 1
    assert said in str(written)
    v = np.load(folder / "plan.npz")["v"]
    assert 0.05 < np.abs(v[:, [0, 3]]).max() <= 0.5
    done = execute(folder, instance=PLACE, workers=1)
    assert str(done).count("no velocity limit") == 1
    assert said in str(done)
    assert done.summary.flawless == 1


def test_limits_of_the_scenario_hold_and_are_kept(run: Run) -> None:
    given = "  velocity_limits: {j1: 0.3, j4: 3}"
    folder = run(given, limits={"j1": "", "j4": ""}, transmissions=NAMES)
    loaded = load_scenario(folder.parent / "six.yaml")
    assert "velocity limit" not in str(preview(loaded))
    assert "j1: 0.3" in dump_scenario(loaded)
    write_trajectory(folder, PLACE, "npz", folder / "plan.npz")
    assert np.abs(np.load(folder / "plan.npz")["v"][:, 0]).max() <= 0.15


def test_a_limit_must_be_of_a_joint_and_above_0(tmp_path: Path) -> None:
    for given, said in (("{j9: 1}", "'j9' is no joint of the arm"), ("{j1: 0}", "above 0")):
        (tmp_path / "six.yaml").write_text(scenario(robot=f"  velocity_limits: {given}"))
        with pytest.raises(ScenarioError, match=said):
            load_scenario(tmp_path / "six.yaml")


def test_motors_that_the_model_lacks_are_named(run: Run) -> None:
    folder = run(transmissions=("j1", "j2", "j4"), limits={"j4": 'velocity="2" effort="0"'})
    done = execute(folder, instance=PLACE, workers=1)
    (line,) = done.assumed
    assert "j3, j4, j5, j6 driven without limit" in line
    assert done.summary.flawless == 1


def test_links_without_inertia_are_named_where_they_matter(run: Run) -> None:
    folder = run(inertia=("base", "shoulder", "upper_arm", "forearm", "wrist"))
    write_trajectory(folder, PLACE, "npz", folder / "plan.npz")
    with pytest.raises(ModelError, match="joint 'j5' cannot be driven") as caught:
        execute(folder, instance=PLACE, workers=1)
    assert "its links palm, hand, fingertip have no mass" in str(caught.value)
    assert not (folder / "executions").exists()
