"""Joints without limits in pictures, panels and tables: no infinite number gets into them."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from drake_screw.demonstrations.look_summary import summarized
from drake_screw.robot import ObjectConfig, RobotConfig, Workcell, build_workcell
from drake_screw.tasks import ObjectArea, WorkArea
from drake_screw.visualization.attempt import headline
from drake_screw.visualization.inspector import Inspector
from drake_screw.visualization.look_figures import joint_figure
from drake_screw.web.attempt_tables import attempts_json
from drake_screw.web.charts import joint_chart, joint_curves, strip
from drake_screw.web.inspector_panel import drawn_state
from tests.demonstrations.test_look import looked
from tests.robot.small_arms import PLANAR, sdf
from tests.visualization.test_attempt import tried

BOWL = (ObjectConfig("bowl", 0.08, 0.06),)
AREA = WorkArea((ObjectArea("bowl", (0.0, 0.0, 0.0), (1.0, 1.0, 0.0), 0.0),))
NAMES = ("p1", "p2", "p3")


def cell(folder: Path, *endless: str) -> Workcell:
    joints = [replace(j, limits=None) if j.name in endless else j for j in PLANAR]
    file = folder / "arm.sdf"
    file.write_text(sdf(joints))
    robot = RobotConfig(str(file), NAMES, "hand", (9.0, 0.5, 0.5))
    return build_workcell(robot, objects=BOWL)


def no_infinity(text: str) -> None:
    raise AssertionError(f"{text} is no JSON")


@pytest.mark.parametrize("endless", [("p1",), NAMES])
def test_an_attempt(tmp_path: Path, meshcat, endless: tuple[str, ...]) -> None:
    workcell = cell(tmp_path, *endless)
    guides = workcell.arm.pose([[9.3, 0.4, 0.6], [9.8, 0.2, 0.9]])
    made = tried(workcell, *guides)
    assert made.plan.success
    samples = made.samples(50)
    for drawn in (
        joint_chart(made),
        *(strip(made, curve, samples) for curve in joint_curves(made)),
    ):
        assert "nan" not in drawn
        assert "inf" not in drawn
    text = attempts_json([made], {}, AREA)
    end = json.loads(text, parse_constant=no_infinity)["attempts"][0]["end"]
    assert end["p1"]["lower"] is None
    assert end["p1"]["margin"] is None
    state = json.dumps(drawn_state(Inspector(meshcat, [workcell], BOWL).draw(made)))
    joints = json.loads(state, parse_constant=no_infinity)["joints"]
    assert [j["upper"] is None for j in joints] == [name in endless for name in NAMES]
    if endless == NAMES:
        assert headline(made).endswith("; no joint has limits")
    else:
        assert "p1 comes nearest" not in headline(made)


def test_a_look() -> None:
    look = looked()
    n = len(look.lower)
    look = replace(
        look,
        lower=np.append(-np.inf, look.lower[1:]),
        upper=np.append(np.inf, look.upper[1:]),
    )
    axes = joint_figure(look).axes
    assert [sum(line.get_gid() == "limit" for line in ax.lines) for ax in axes] == [0] + [2] * (
        n - 1
    )
    assert all(np.isfinite(ax.get_ylim()).all() for ax in axes)
    assert summarized(look).tightest.name != look.recording.joint_names[0]
    look = replace(look, lower=np.full(n, -np.inf), upper=np.full(n, np.inf))
    assert str(summarized(look).tightest) == "none has limits"
