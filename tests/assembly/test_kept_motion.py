"""What a person showed is in the plan: from a recording's folder to joint angles."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from drake_screw.acquisition import random_suggestion
from drake_screw.assembly.setup import Setup
from drake_screw.demonstrations import Recording, write_recording
from drake_screw.resources import SCENARIO_SUFFIXES, find_resource
from drake_screw.scenario.loader import load_scenario
from drake_screw.screws import pose

WRIST = np.array([0.7, 0.2, -0.75, 1.0, 1.88, -0.9, 0.0])
AHEAD = pose(np.eye(3), [0.0, 0.0, 0.25])
AWAY = np.array([0.0, -0.35, 0.0, 0.35, 0.0, 0.0, 0.0])
"""rad. From where the wrist turns back to where an approach begins."""
CUP = "  - {name: cup, x: %g, y: %g, z: -0.064, radius: 0.04, height: 0.1}\n"


def wrist_turns(from_away: bool) -> np.ndarray:
    """(m, 7) the last joint turns from -0.49 to 1.51 rad; perhaps after an approach, and back."""
    turn = np.tile(WRIST, (13, 1))
    turn[:, 6] = np.linspace(-0.49, 1.51, 13)
    if not from_away:
        return turn
    s = np.linspace(1.0, 0.0, 12)[:, None]
    return np.concatenate([turn[0] + s * AWAY, turn[1:-1], turn[-1] + s[::-1] * AWAY])


@pytest.mark.parametrize("from_away", [False, True])
def test_a_turn_on_the_spot_is_in_the_plan(tmp_path, from_away: bool) -> None:
    setup = Setup(load_scenario("pouring"))
    arm, q = setup.workcell.arm, wrist_turns(from_away)
    where = len(q) // 2 - 6
    X_WO = arm.pose(q[where][None]) @ AHEAD
    shown = Recording("turn", arm.joint_names, 0.1 * np.arange(len(q)), q, X_WO)
    write_recording(shown, tmp_path / "turn", {})
    (recording,) = setup.recordings(tmp_path)
    learned = setup.learn(recording)
    (kept,) = learned.fidelity
    assert kept.turn_kept >= 2.0 - 1e-6
    assert kept.rotation <= 0.1
    plan = setup.batch_planner.plan(learned, X_WO, setup.workcell.start)
    assert plan.success
    X_WE, spot = arm.pose(plan.q), arm.pose(q[where][None])[0, :3, 3]
    first = int(np.argmax(np.linalg.norm(X_WE[:, :3, 3] - spot, axis=1) < 0.012))
    R = X_WE[first:, :3, :3]
    cosines = (np.einsum("ij,kij->k", R[0], R) - 1.0) / 2.0
    assert np.arccos(np.clip(cosines, -1.0, 1.0)).max() == pytest.approx(2.0, abs=0.1)


def test_a_bystander_changes_nothing(tmp_path) -> None:
    text = find_resource("scenarios", "pouring", SCENARIO_SUFFIXES).read_text(encoding="utf-8")
    text = text.replace("{x: 4, y: 4}", "{bowl.x: 4, bowl.y: 4}")
    text = text.replace("    symmetry: {axis: z, turns: any}\n", "")
    plans = []
    for x, y in ((0.55, -0.4), (0.4, -0.5)):
        (tmp_path / "two.yaml").write_text(text.replace("\nregions:", f"\n{CUP % (x, y)}regions:"))
        setup = Setup(load_scenario(tmp_path / "two.yaml"))
        rng = np.random.default_rng(0)
        place = random_suggestion(setup.regions, rng)
        lesson = setup.teacher.demonstrate(place, number=0, used=(), rng=rng)
        assert lesson.recording is not None
        recording = lesson.recording
        unnamed = replace(recording, task_objects=())
        named, found = setup.learn(recording), setup.learn(unnamed)
        assert not found.objects.any()
        assert any("cup" in note for note in found.notes)
        np.testing.assert_array_equal(found.X_OE, named.X_OE)
        area = setup.area
        coordinates = np.random.default_rng(1).uniform(
            area.lower, area.upper, (500, *area.lower.shape)
        )
        plans.append(setup.evaluate([found], coordinates))
    assert 0.2 < plans[0].success.mean() < 0.9
    np.testing.assert_array_equal(plans[0].cause, plans[1].cause)
    np.testing.assert_array_equal(plans[0].segment, plans[1].segment)
