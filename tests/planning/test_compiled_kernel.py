"""The compiled planner on the shipped arm: bitwise repeatable, and ends where it says."""

from __future__ import annotations

import numpy as np
import pytest

from drake_screw.assembly.setup import Setup
from drake_screw.planning import BatchPlanner, Cause
from drake_screw.planning.compiled import Kernel, kernel
from drake_screw.planning.compiled.lanes import Answers
from drake_screw.planning.contract import POSITION_TOLERANCE, ROTATION_TOLERANCE
from drake_screw.robot import Workcell
from drake_screw.scenario.loader import load_scenario
from drake_screw.screws import exp, rotation_angle, translation_distance

N, D = 500, 4
LENGTHS = (1, 4, 2, 6)


@pytest.fixture(scope="module")
def workcell() -> Workcell:
    return Setup(load_scenario("pouring")).workcell


@pytest.fixture(scope="module")
def baxter(workcell: Workcell) -> Kernel:
    """The kernel that plans for the shipped scenarios."""
    chain = workcell.arm.screw_chain()
    return Kernel(chain.screws, chain.home, chain.lower, chain.upper)


@pytest.fixture(scope="module")
def work(workcell: Workcell) -> dict:
    """Random walks of the joints, moved about with the object."""
    rng, arm = np.random.default_rng(5), workcell.arm
    X_OE = [
        arm.pose(workcell.start + np.cumsum(rng.uniform(-0.35, 0.35, (g, arm.n)), axis=0))
        for g in LENGTHS
    ]
    V = rng.normal(size=(N, 1, 6)) * [0.05, 0.05, 0.3, 0.06, 0.06, 0.03]
    return {
        "X_OE": X_OE,
        "objects": [np.zeros(g, dtype=np.int64) for g in LENGTHS],
        "X_WO": exp(V),
        "q_start": workcell.start,
    }


@pytest.fixture(scope="module")
def answers(baxter: Kernel, work: dict) -> Answers:
    return joined(baxter.plan(**work, threads=1))


@pytest.fixture(scope="module")
def which() -> np.ndarray:
    """A demonstration for each instance."""
    return np.random.default_rng(7).integers(D, size=N)


@pytest.fixture(scope="module")
def traced(baxter: Kernel, work: dict, which: np.ndarray) -> list[Answers]:
    return baxter.trace(**work, which=which, threads=1)


def kept(answers: Answers) -> list[np.ndarray]:
    """The steps of the plans, without the room of those at work."""
    return list(answers.trace[-6:])


def assert_same_bits(a: Answers, b: Answers) -> None:
    for x, y in zip((*a[:-1], *kept(a)), (*b[:-1], *kept(b)), strict=True):
        assert x.tobytes() == y.tobytes()


def joined(parts: list[Answers]) -> Answers:
    """Answers of all parts, one after the other."""
    columns = zip(*(part[:-1] for part in parts), strict=True)
    return Answers(*map(np.concatenate, columns), parts[0].trace)


def whole(traced: list[Answers]) -> list[np.ndarray]:
    """Answers and steps of all parts, one after the other; without `first`."""
    parts = [(*a[:-1], np.diff(a.trace.first), *a.trace[-4:]) for a in traced]
    return [np.concatenate(x) for x in zip(*parts, strict=True)]


def test_there_is_something_to_compare(answers: Answers) -> None:
    for cause in (Cause.SUCCESS, Cause.JOINT_LIMIT, Cause.UNREACHABLE):
        assert (answers.cause == cause).sum() > 50


def test_successes_end_on_the_last_guiding_pose(
    workcell: Workcell, work: dict, which: np.ndarray, traced: list[Answers]
) -> None:
    """By the plant's kinematics, not the planner's own."""
    arm, before, seen = workcell.arm, 0, 0
    for a in traced:
        for i in np.flatnonzero(a.cause[:, 0] == Cause.SUCCESS):
            d, end = which[before + i], a.trace.q[a.trace.first[i + 1] - 1, 1]
            X_WE, X_WG = arm.pose(end), work["X_WO"][before + i, 0] @ work["X_OE"][d][-1]
            assert translation_distance(X_WE, X_WG) <= POSITION_TOLERANCE
            assert rotation_angle(X_WE, X_WG) <= ROTATION_TOLERANCE
            assert (arm.margin(end) > 0.0).all()
            seen += 1
        before += len(a.cause)
    assert seen > 50


@pytest.mark.parametrize("chunk", [1, 100, 700, 10**6])
@pytest.mark.parametrize("threads", [1, 3])
def test_neither_chunks_nor_threads_matter(
    baxter: Kernel,
    work: dict,
    answers: Answers,
    monkeypatch: pytest.MonkeyPatch,
    chunk: int,
    threads: int,
) -> None:
    monkeypatch.setattr(kernel, "CHUNK", chunk)
    assert_same_bits(joined(baxter.plan(**work, threads=threads)), answers)


@pytest.mark.parametrize(
    "part", [slice(0, 1), slice(17, 18), slice(100, 131), slice(None, None, 7)]
)
def test_neighbours_in_the_batch_do_not_matter(
    baxter: Kernel, work: dict, answers: Answers, part: slice
) -> None:
    some = joined(baxter.plan(**(work | {"X_WO": work["X_WO"][part]})))
    assert_same_bits(some, answers.part(part))


def test_order_does_not_matter(baxter: Kernel, work: dict, answers: Answers) -> None:
    rng = np.random.default_rng(6)

    def shuffled(X_WO: np.ndarray) -> np.ndarray:
        return np.argsort(rng.random((len(X_WO), D)), axis=1)

    assert_same_bits(joined(baxter.plan(**work, order=shuffled, threads=1)), answers)
    some = joined(baxter.plan(**work, order=shuffled, threads=1, run=D))
    tried = some.cause != Cause.NOT_TRIED
    success = some.cause == Cause.SUCCESS
    np.testing.assert_array_equal(success.any(axis=1), (answers.cause == Cause.SUCCESS).any(axis=1))
    assert tried[~success.any(axis=1)].all()
    for x, y in zip(some[:-1], answers[:-1], strict=True):
        assert x[tried].tobytes() == y[tried].tobytes()


def test_traced_plans_have_the_answers_of_the_others(
    which: np.ndarray, answers: Answers, traced: list[Answers]
) -> None:
    """Writing the steps down changes nothing."""
    assert answers.trace.segment.size == 0
    chosen = answers.part((np.arange(N)[:, None], which[:, None]))
    for x, y in zip(chosen[:-1], whole(traced), strict=False):
        assert x.tobytes() == y.tobytes()
    for a in traced:
        np.testing.assert_array_equal(a.trace.plan[:, 0], np.arange(len(a.cause)))
        assert (np.diff(a.trace.first) <= a.steps[:, 0]).all()


def test_plans_longer_than_the_room_for_them(
    baxter: Kernel, work: dict, which: np.ndarray, traced: list[Answers]
) -> None:
    """Are planned again, in more room."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(kernel, "ROOM", 2)
        again = baxter.trace(**work, which=which, threads=1)
    for x, y in zip(whole(again), whole(traced), strict=True):
        assert x.tobytes() == y.tobytes()


@pytest.mark.parametrize("chunk", [1, 100, 10**6])
@pytest.mark.parametrize("threads", [1, 3])
def test_neither_chunks_nor_threads_matter_to_the_steps(
    baxter: Kernel,
    work: dict,
    which: np.ndarray,
    traced: list[Answers],
    monkeypatch: pytest.MonkeyPatch,
    chunk: int,
    threads: int,
) -> None:
    monkeypatch.setattr(kernel, "TRACED", chunk)
    again = baxter.trace(**work, which=which, threads=threads)
    for x, y in zip(whole(again), whole(traced), strict=True):
        assert x.tobytes() == y.tobytes()


def test_a_plan_to_where_the_end_effector_is_takes_no_motion(
    workcell: Workcell, baxter: Kernel, work: dict
) -> None:
    here = workcell.arm.pose(workcell.start)
    (plan,) = baxter.trace(
        [np.stack([here, here])],
        [np.zeros(2, dtype=np.int64)],
        np.eye(4)[None, None],
        workcell.start,
        np.zeros(1, dtype=np.int64),
    )
    assert plan.cause[0, 0] == Cause.SUCCESS
    np.testing.assert_allclose(plan.trace.q[-1, 1], workcell.start, atol=1e-9)


def test_compiled_says_whether_the_first_plan_waits(workcell: Workcell, answers: Answers) -> None:
    assert BatchPlanner(workcell.arm.screw_chain()).compiled
