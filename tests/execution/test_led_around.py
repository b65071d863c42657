"""A plan that is led around a pole: its timed path keeps clear of it, and so does the arm."""

from __future__ import annotations

import numpy as np
import pytest

from drake_screw.execution.parallel import Job, StationConfig, execute_all
from drake_screw.execution.timing import time_plan
from drake_screw.planning import Plan
from drake_screw.robot import Workcell, build_workcell
from tests.planning.pole_in_the_way import PASSABLE, POLE, START, lesson_of, planner_of, robot_in

pytest.importorskip("ompl")


@pytest.fixture(scope="module")
def config(tmp_path_factory: pytest.TempPathFactory) -> StationConfig:
    return StationConfig(robot_in(tmp_path_factory.mktemp("models")), None, (POLE,))


@pytest.fixture(scope="module")
def workcell(config: StationConfig) -> Workcell:
    return build_workcell(config.robot, objects=config.objects)


@pytest.fixture(scope="module")
def plan(workcell: Workcell) -> Plan:
    planner, lesson = planner_of(workcell), lesson_of(workcell, PASSABLE)
    found = planner.any_success([lesson], PASSABLE[None], START)[0, 0]
    assert found.success
    assert planner.planner.plan(lesson, PASSABLE, START, int(found.variant)).success
    return planner.plan(lesson, PASSABLE, START, int(found.variant))


def test_the_timed_path_is_the_one_that_was_checked(workcell: Workcell, plan: Plan) -> None:
    arm = workcell.arm
    timed = time_plan(plan, np.concatenate([arm.pose(plan.q[:1]), plan.guides]), arm)
    _, q, _ = timed.sampled(2e-3)
    assert not workcell.collides(q, PASSABLE).any()
    approach = plan.q[plan.segment == 0]
    moved = np.array([p.q for p in map(timed.at, np.arange(0, timed.segments[0].duration, 2e-3))])
    a, b = approach[:-1], approach[1:]
    share = np.einsum("mij,ij->mi", moved[:, None] - a, b - a) / np.sum((b - a) ** 2, axis=1)
    nearest = a + np.clip(share, 0.0, 1.0)[..., None] * (b - a)
    off = np.linalg.norm(moved[:, None] - nearest, axis=-1).min(axis=1)
    assert off.max() < 1e-3


def test_it_is_executed_without_contact(config: StationConfig, plan: Plan) -> None:
    (done,) = execute_all(config, [Job(plan, PASSABLE)], workers=1)
    assert done.report.flawless, str(done.report.status)
    assert not done.report.contacts
