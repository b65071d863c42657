"""Several arms: whichever can has the plan, the others rest and count in collisions."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from drake_screw import Setup, load_scenario
from drake_screw.assembly.freedoms import freedoms
from drake_screw.assembly.ranked_plans import RankedPlan
from drake_screw.assembly.ways import why_failed
from drake_screw.demonstrations import Demonstration
from drake_screw.errors import ScenarioError
from drake_screw.planning import Cause
from drake_screw.planning.touching import known_pair
from drake_screw.robot.shapes import SphereShape
from tests.assembly.two_arms import START, lesson, setup_in

ONLY_LEFT, BOTH, ONLY_RIGHT = 0.3, 0.1, -0.3
"""y in m, at x = 0.6 m, where the arms have plans with what the right one shows."""


@pytest.fixture(scope="module")
def setup(tmp_path_factory: pytest.TempPathFactory) -> Setup:
    return setup_in(tmp_path_factory.mktemp("two"))


@pytest.fixture(scope="module")
def shown(setup: Setup) -> Demonstration:
    return lesson(setup, 1)


def at(setup: Setup, *ys: float) -> np.ndarray:
    return setup.area.X_WO(np.array([[[0.6, y, 0.0]] for y in ys]))


def test_each_workcell_has_the_other_arm_at_its_start(setup: Setup) -> None:
    left, right = (one.workcell for one in setup.arms)
    assert left.pairs == right.pairs
    np.testing.assert_array_equal(setup.start, np.concatenate(list(START.values())))
    q = left.positions(setup.arms[0].start, left.objects_away)
    np.testing.assert_array_equal(q, right.positions(setup.arms[1].start, right.objects_away))


def test_the_first_arm_that_can_has_the_plan(setup: Setup, shown: Demonstration) -> None:
    X_WO = at(setup, 0.2, BOTH, -0.2, 0.95)
    found = setup.planner.all_outcomes([shown], X_WO, setup.start)[:, 0]
    each = [
        one.careful_planner.all_outcomes([shown], X_WO, one.start).success[:, 0]
        for one in setup.arms
    ]
    np.testing.assert_array_equal(each, [[1, 1, 0, 0], [0, 1, 1, 0]])
    np.testing.assert_array_equal(found.success, [1, 1, 1, 0])
    np.testing.assert_array_equal(found.arm[:3], [0, 0, 1])
    any_ = setup.planner.any_success([shown], X_WO, setup.start)[:, 0]
    np.testing.assert_array_equal(any_.arm, found.arm)
    np.testing.assert_array_equal(any_.cause, found.cause)


def test_of_a_failure_it_is_the_arm_that_came_furthest(setup: Setup, shown: Demonstration) -> None:
    X_WO = at(setup, *np.linspace(-1.1, 1.1, 12))
    each = [one.careful_planner.all_outcomes([shown], X_WO, one.start)[:, 0] for one in setup.arms]
    found = setup.planner.all_outcomes([shown], X_WO, setup.start)[:, 0]
    done = np.stack([one.segment + 0.5 * one.fraction for one in each])
    failed = ~found.success
    assert failed.sum() > 3
    np.testing.assert_array_equal(found.arm[failed], done.argmax(axis=0)[failed])
    fractions = np.stack([one.fraction for one in each])
    own = fractions[found.arm, np.arange(len(X_WO))]
    np.testing.assert_array_equal(found.fraction[failed], own[failed])


def test_arms_are_tried_as_listed(tmp_path: Path, setup: Setup, shown: Demonstration) -> None:
    left, right = (
        f"{{name: {side}, joints: [{side[0]}1, {side[0]}2, {side[0]}3], "
        f"end_effector: {side}_hand, start: {list(START[side])}}}"
        for side in ("left", "right")
    )
    swapped = setup_in(tmp_path, f"robot.arms=[{right}, {left}]")
    found = swapped.planner.all_outcomes([shown], at(swapped, BOTH), swapped.start)[0, 0]
    assert found.success
    assert swapped.arm_of(found).name == "right"


def test_the_same_plan_is_found_again(setup: Setup, shown: Demonstration) -> None:
    X_WO = at(setup, 0.2, -0.2)
    found = setup.planner.any_success([shown], X_WO, setup.start)[:, 0]
    for i, one in enumerate(setup.arms):
        plan = setup.judged_plan(shown, X_WO[i], found[i])
        assert plan.success
        np.testing.assert_array_equal(plan.q[0], one.start)
        np.testing.assert_allclose(one.arm.pose(plan.q[-1]), plan.guides[-1], atol=1e-3)


def test_a_resting_arm_is_in_the_way(tmp_path: Path, shown: Demonstration) -> None:
    """The left arm is stretched out to where the right one has to go."""
    blocked = setup_in(tmp_path, "robot.arms.0.start=[-0.9, 0.0, 0.0]")
    X_WO = at(blocked, -0.2)
    found = blocked.planner.all_outcomes([shown], X_WO, blocked.start)[0, 0]
    right = blocked.arms[1]
    alone = right.careful_planner.all_outcomes([shown], X_WO, right.start)[0, 0]
    assert alone.cause == Cause.COLLISION
    pair = known_pair(alone, right.workcell)
    assert pair is not None
    assert {name[0] for name in pair} == {"l", "r"}
    assert not found.success
    assert right.batch_planner.all_outcomes([shown], X_WO, right.start).success.all()
    why = why_failed(blocked.arms, found[None], [shown], X_WO[0])
    assert why.startswith(f"{blocked.arm_name(found)}: with turn, ")


@pytest.fixture(scope="module")
def best(setup: Setup, shown: Demonstration) -> RankedPlan:
    return setup.plan([shown], {"pot": (0.6, BOTH)})


def test_the_best_plan_is_the_best_of_both_arms(setup: Setup, best: RankedPlan, shown) -> None:
    place = {"pot": (0.6, BOTH)}
    each = {one.name: setup.plan([shown], place, start={one.name: one.start}) for one in setup.arms}
    assert {name: plan.arm_name for name, plan in each.items()} == {n: n for n in each}
    ranked = [best, *best.alternatives]
    assert [one.margin for one in ranked] == sorted((p.margin for p in each.values()), reverse=True)
    assert {one.arm_name for one in ranked} == set(each)
    assert f"with arm {best.arm_name}" in str(best)
    assert set(best.margins) == set(best.arm.joint_names)


def test_a_start_is_of_one_arm(setup: Setup, shown: Demonstration) -> None:
    place, q = {"pot": (0.6, -0.2)}, np.add(START["right"], 0.05)
    assert np.array_equal(setup.plan([shown], place, start={"right": q}).plan.q[0], q)
    with pytest.raises(ScenarioError, match="a start of one arm") as caught:
        setup.plan([shown], place, start=q)
    assert "start={'left': [...]}" in str(caught.value.remedy)
    with pytest.raises(ScenarioError, match="a start of middle") as caught:
        setup.plan([shown], place, start={"middle": q})
    assert caught.value.remedy == "Arms: left, right."


def test_where_none_can_it_is_said_of_each(setup: Setup, shown: Demonstration) -> None:
    with pytest.raises(ScenarioError) as caught:
        setup.plan([shown], {"pot": (0.6, 1.1)})
    assert "left: with turn" in caught.value.message
    assert "right: with turn" in caught.value.message


def test_the_first_demonstration_is_asked_for_where_the_nearest_shoulder_is_far(
    tmp_path: Path,
) -> None:
    far = setup_in(tmp_path, "demonstrations.first=farthest", "objects.0.y=[-0.3, 1.2]")
    np.testing.assert_array_equal(far.first[0, :2], [0.7, 1.2])
    assert far.nearest_arm(np.array([[0.5, 0.4, 0.0]])).name == "left"
    assert far.nearest_arm(np.array([[0.5, -0.1, 0.0]])).name == "right"


def test_symmetries_of_tools_are_told_apart_where_they_differ() -> None:
    round_cup = "{symmetry: {axis: x, turns: any}}"
    one = load_scenario("pouring_both", [f"robot.arms.1.tool={round_cup}"])
    assert [freedom.body for freedom in freedoms(one)] == ["bowl", "right tool"]
    assert "the end effector may be turned" in str(freedoms(one)[1])
    changes = [f"robot.arms.{i}.tool={round_cup}" for i in range(2)]
    both = load_scenario("pouring_both", changes)
    assert [freedom.body for freedom in freedoms(both)] == ["bowl", "tool"]


def test_tools_rest_with_their_arms(tmp_path: Path) -> None:
    """What the left hand holds is there while the right arm moves, where it is otherwise."""
    turned = "robot.arms.0.end_effector_rotation=[0.2, 0.3, 0.4]"
    tool = (
        "{xyz: [0.1, 0.02, 0.03], rpy: [0.3, 0.2, 0.1], "
        "shape: {sphere: {radius: 0.02}, xyz: [0.0, 0.0, 0.05]}}"
    )
    held = setup_in(tmp_path, turned, f"robot.arms.0.tool={tool}")
    left, right = held.arms
    assert isinstance(left.robot.tools[0].shape.solid, SphereShape)
    assert left.workcell.pairs == right.workcell.pairs
    assert right.workcell.tool is None
    poses = []
    for one in held.arms:
        plant, context = one.workcell.plant, one.workcell.plant.CreateDefaultContext()
        q = one.workcell.positions(one.start, one.workcell.objects_away)
        plant.SetPositions(context, q)
        body = plant.GetBodyByName("left_tool")
        poses.append(body.EvalPoseInWorld(context).GetAsMatrix4())
    np.testing.assert_allclose(poses[0], poses[1], atol=1e-12)
