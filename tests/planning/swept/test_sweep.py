"""First touches along whole paths: nothing goes unnoticed between the places looked at."""

from __future__ import annotations

import itertools
from pathlib import Path

import numpy as np
import pytest

from drake_screw.planning.compiled.trace import dense_output
from drake_screw.planning.swept import SweptChecker, lines
from drake_screw.planning.swept.cell import QUESTIONS
from drake_screw.planning.swept.checker import Touched
from drake_screw.planning.swept.sweep import COARSE
from drake_screw.robot import ObjectConfig, RobotConfig, build_workcell
from drake_screw.robot.obstacles import ObstacleConfig
from drake_screw.robot.shapes import BoxShape, PlacedShape, SphereShape
from drake_screw.screws import pose
from tests.robot.small_arms import PLANAR, JointText, sdf

BALL = "<sphere><radius>0.03</radius></sphere>"
POLE = ObjectConfig("pole", 0.02, 0.6)
FAR = pose(np.eye(3), [[-9.0, -9.0, 0.0]])
"""X_WO (1, 4, 4) of a pole that is out of the way."""

SCISSORS = (
    JointText("turn", "0 0 0.5 0 0 0"),
    JointText("left", "0.5 0 0 0 0 0", kind="fixed"),
    JointText("between", "0 0 0 0 0 0", parent="turn_link"),
    JointText("open", "0 0 0 0 0 0"),
    JointText("right", "0.5 0 0 0 0 0", kind="fixed"),
)
RAILS = tuple(
    JointText(f"x{i}", "0 0 0.5 0 0 0" if i == 0 else "0 0 0 0 0 0", "1 0 0", "prismatic", (-5, 5))
    for i in range(4)
)
"""Four carriages, one on the other, all along x: no bound on their travel is larger than it."""


def checker_of(
    folder: Path,
    joints: tuple[JointText, ...],
    shapes: dict[str, str],
    *,
    clearance: float = 0.0,
    objects: tuple[ObjectConfig, ...] = (POLE,),
    obstacles: tuple[ObstacleConfig, ...] = (),
) -> SweptChecker:
    """A checker of an arm with a shape each on some links."""
    file = folder / "arm.sdf"
    file.write_text(sdf(joints, hand="0.1 0 0 0 0 0", shapes=shapes))
    names = tuple(joint.name for joint in joints if joint.kind != "fixed")
    robot = RobotConfig(str(file), names, "hand", (0.0,) * len(names))
    return SweptChecker(build_workcell(robot, objects=objects, obstacles=obstacles), clearance)


def along(checker: SweptChecker, q: np.ndarray, X_WO: np.ndarray = FAR) -> Touched:
    """A path of straight lines through points q (m, n)."""
    steps = lines(np.asarray(q, dtype=float))
    return checker.along(steps, np.array([0, len(steps)]), X_WO[None])


def standing(x: float, y: float, z: float = 0.2) -> np.ndarray:
    return pose(np.eye(3), [[x, y, z]])


@pytest.fixture(scope="module")
def rails(tmp_path_factory: pytest.TempPathFactory) -> SweptChecker:
    """Balls on the second and on the fourth carriage, the latter beside the pole's height."""
    at = tmp_path_factory.mktemp("rails")
    return checker_of(at, RAILS, {"x1_link": BALL, "x3_link": BALL})


def steps_to(way: float, rng: np.random.Generator, most: float = 0.3) -> np.ndarray:
    """Places (m,) from 0 to a way in m, in steps of any length."""
    between = way * rng.random(int(np.ceil(2.0 * abs(way) / most)) + rng.integers(8))
    return np.concatenate([[0.0], between[np.argsort(abs(between))], [way]])


@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_a_carriage_stops_just_before_the_pole_or_just_in_it(rails, sign: float) -> None:
    """Along a straight rail, by steps of any length, with the pole any distance away."""
    rng = np.random.default_rng(1)
    for _ in range(60):
        away = rng.choice([0.1, 0.5, 2.0, 4.5]) * rng.uniform(0.5, 1.0)
        share = rng.dirichlet([0.5, 0.5, 0.5, 0.5])
        short, deep = (
            np.outer(steps_to(sign * (away + past), rng), share) for past in (-2e-4, 2e-4)
        )
        q0 = np.array([0.0, -2.0 * sign, 2.0 * sign, 0.0])
        X_WO = standing(sign * (away + 0.05), 0.0, 0.2)
        assert not along(rails, q0 + short, X_WO).touches[0]
        found = along(rails, q0 + deep, X_WO)
        assert found.touches[0]
        assert found.step[0] == len(deep) - 2
        assert abs(found.q[0] - q0 - deep[-1]).sum() <= 2.0 * COARSE
        assert rails.workcell.collides(found.q, X_WO)[0]


def test_there_and_back_in_one_step(rails) -> None:
    """A step that bends: at both of its ends the ball is clear of the pole."""
    rng = np.random.default_rng(2)
    for _ in range(40):
        q0 = np.array([0.0, -3.0, 3.0, 0.0])
        far = rng.uniform(0.05, 1.5)
        share = rng.dirichlet([0.5, 0.5, 0.5, 0.5])
        step = np.zeros((1, 5, 4))
        step[:, :2] = q0
        step[:, 2], step[:, 3] = 4.0 * far * share, -4.0 * far * share
        u = np.linspace(0.0, 1.0, 101)
        reached = (dense_output(np.tile(step[0], (101, 1, 1)), u) - q0).sum(axis=1).max()
        for past, touches in ((-2e-4, False), (4e-4, True)):
            X_WO = standing(reached + 0.05 - past, 0.0)
            found = rails.along(step, np.array([0, 1]), X_WO[None])
            assert found.touches[0] == touches
            if touches:
                assert 0.2 < found.place[0] < 0.8


def test_carriages_run_into_one_another(rails) -> None:
    """What moves both of them does not count, what moves only the second one does."""
    rng = np.random.default_rng(3)
    for _ in range(60):
        away = rng.uniform(0.1, 2.0)
        share = rng.dirichlet([0.5, 0.5])
        q0 = np.array([0.0, 0.0, 0.0, away + 0.06])
        for past, touches in ((-2e-4, False), (2e-4, True)):
            way = steps_to(away + past, rng)
            q = q0 + np.outer(way, [0.0, 0.0, -share[0], -share[1]])
            q[:, 0] += rng.uniform(-1.0, 1.0) * way
            q[:, 1] += rng.uniform(-1.0, 1.0) * np.sin(9.0 * way)
            found = along(rails, q)
            assert found.touches[0] == touches
            if touches:
                assert found.step[0] == len(q) - 2
                names = rails.workcell.touching(int(found.pair[0]))
                assert set(names) == {"x1_link", "x3_link"}


def test_links_that_move_as_one_never_touch_anything_new(rails) -> None:
    """However far: the arm's own pairs are seen from where they are mounted."""
    q = np.zeros((2, 4))
    q[:, 3] = 0.0602
    q[1, :2] = 3.0, -1.0
    assert not along(rails, q).touches[0]


@pytest.fixture(scope="module")
def wood(tmp_path_factory: pytest.TempPathFactory) -> SweptChecker:
    """A planar arm with long links among many thin things, near one another in groups."""
    rng = np.random.default_rng(4)
    trees = []
    for i in range(14):
        x, y = (0.3 + 0.42 * rng.random()) * np.array([np.cos(i * 0.45), np.sin(i * 0.45)])
        solid = SphereShape(0.01) if i % 2 else BoxShape((0.02, 0.01, 0.3))
        trees.append(ObstacleConfig(f"tree {i}", PlacedShape(solid, (x, y, 0.5), (0, 0, i))))
    rod = "<capsule><radius>0.015</radius><length>0.2</length></capsule>"
    shapes = {"p1_link": rod, "p2_link": BALL, "p3_link": BALL}
    at = tmp_path_factory.mktemp("wood")
    return checker_of(at, PLANAR, shapes, obstacles=tuple(trees))


def some_paths(rng: np.random.Generator, N: int) -> list[np.ndarray]:
    """Paths (m, 3) of a few points, long steps and short ones."""
    paths = []
    for _ in range(N):
        m, size = rng.integers(2, 12), rng.choice([0.02, 0.1, 0.3])
        q = rng.uniform(-2.2, 2.2, 3) + np.cumsum(rng.normal(size=(m, 3)) * size, axis=0)
        paths.append(np.clip(q, -2.5, 2.5))
    return paths


def dense(q: np.ndarray, apart: float = 1e-3) -> tuple[np.ndarray, np.ndarray]:
    """Points (t, 3) along a path (m, 3), and the step and place in it of each as one number."""
    points, places = [], []
    for k, (a, b) in enumerate(itertools.pairwise(q)):
        u = np.linspace(0.0, 1.0, 2 + int(abs(b - a).sum() / apart))
        points.append(a + u[:, None] * (b - a))
        places.append(k + u)
    return np.concatenate(points), np.concatenate(places)


def test_first_touches_are_those_of_a_dense_search(wood) -> None:
    """Each path by itself and all at once, whatever was looked at before."""
    rng = np.random.default_rng(5)
    paths = some_paths(rng, 80)
    X_WO = np.array([standing(*rng.uniform(-1.0, 1.0, 2)) for _ in paths])
    steps = [lines(q) for q in paths]
    first = np.cumsum([0, *map(len, steps)])
    found = wood.along(np.concatenate(steps), first, X_WO)
    late = []
    for i, (q, X) in enumerate(zip(paths, X_WO, strict=True)):
        points, places = dense(q)
        hit = np.flatnonzero(wood.workcell.collides(points, X))
        if not found.touches[i]:
            assert len(hit) == 0
            assert np.isnan(found.q[i]).all()
            continue
        assert wood.workcell.collides(found.q[i : i + 1], X)[0]
        if len(hit):
            k = int(np.searchsorted(places, found.step[i] + found.place[i]))
            late.append(abs(np.diff(points[hit[0] : k + 1], axis=0)).sum())
        alone = along(wood, q, X)
        assert (alone.step[0], alone.place[0]) == (found.step[i], found.place[i])
    assert 0.2 < found.touches.mean() < 0.95
    assert len(late) > 15
    assert np.median(late) < 1.5e-2
    assert (np.array(late) < 3e-2).mean() > 0.9


def test_paths_from_the_same_start_are_judged_each_by_itself(wood) -> None:
    """Also where the object stands elsewhere each time, and where another start comes between."""
    rng = np.random.default_rng(9)
    starts = rng.uniform(-1.5, 1.5, (3, 3))
    starts[1] = starts[0] + [0.0, 0.0, 1e-9]
    paths, X_WO = [], []
    for i in range(240):
        q = np.vstack([np.zeros(3), np.cumsum(rng.normal(size=(3, 3)) * 0.2, axis=0)])
        paths.append(np.clip(starts[i // 2 % 3] + q, -2.5, 2.5))
        # Half of the poles stand where one of the arm's links is at the start, or next to it.
        turn = starts[i // 2 % 3, 0]
        near = 0.3 * np.array([np.cos(turn), np.sin(turn)]) + rng.normal(size=2) * 0.05
        X_WO.append(standing(*(near if i % 2 else rng.uniform(-1.0, 1.0, 2))))
    steps = [lines(q) for q in paths]
    first = np.cumsum([0, *map(len, steps)])
    found = wood.along(np.concatenate(steps), first, np.array(X_WO))
    for i, (q, X) in enumerate(zip(paths, X_WO, strict=True)):
        alone = along(wood, q, X)
        assert alone.touches[0] == found.touches[i]
        assert (alone.step[0], alone.place[0]) == (found.step[i], found.place[i])
    assert 0.2 < found.touches[::2].mean() < found.touches[1::2].mean()


def test_a_path_is_judged_the_same_however_it_is_divided(wood) -> None:
    rng = np.random.default_rng(6)
    for q in some_paths(rng, 80):
        fine = [q[:1]]
        for a, b in itertools.pairwise(q):
            u = np.sort(rng.random(rng.integers(1, 6)))[:, None]
            fine += [a + u * (b - a), b[None]]
        one, other = (along(wood, p) for p in (q, np.concatenate(fine)))
        assert one.touches[0] == other.touches[0]


@pytest.fixture(scope="module")
def passing(tmp_path_factory: pytest.TempPathFactory) -> SweptChecker:
    """A ball on a carriage that moves past the pole or through its edge."""
    return checker_of(tmp_path_factory.mktemp("passing"), RAILS[:2], {"x1_link": BALL})


def test_a_pole_is_grazed_or_just_missed(passing) -> None:
    """The ball passes by it, 0.4 mm deep at most, or as far away as that."""
    rng = np.random.default_rng(7)
    for _ in range(60):
        begin, end = -rng.uniform(0.05, 1.0), rng.uniform(0.05, 1.0)
        q = np.array([[begin, 0.0], [begin, end - begin]])
        for gap, touches in ((-4e-4, True), (4e-4, False)):
            found = along(passing, q, standing(rng.uniform(-0.01, 0.01), 0.05 + gap))
            assert found.touches[0] == touches


def test_parts_that_swap_places_meet_in_between(tmp_path: Path) -> None:
    """Each moves as far as the gap is wide: each needs a bound of half the gap."""
    checker = checker_of(tmp_path, SCISSORS, {"left_link": BALL, "right_link": BALL})
    q = np.array([[-0.2, 0.0, 0.4], [0.2, 0.0, -0.4]])
    assert not checker.workcell.collides(q, FAR).any()
    found = along(checker, q)
    assert found.touches[0]
    assert 0.2 < found.place[0] < 0.5
    names = checker.workcell.touching(int(found.pair[0]))
    assert set(names) == {"left_link", "right_link"}


@pytest.mark.parametrize(("gap", "asked"), [(5e-6, 1), (-5e-6, 1), (4e-5, 0), (-4e-5, 0)])
def test_only_what_is_within_rounding_is_put_to_drake(passing, gap: float, asked: int) -> None:
    """Of an arm that stands still, so that there is no travel."""
    before = passing.asked
    found = along(passing, np.zeros((1, 2)), standing(0.0, 0.05 + gap))
    assert found.touches[0] == (gap < 0.0)
    assert passing.asked - before == asked
    assert found.step[0] == (0 if gap < 0.0 else -1)


def test_what_stays_within_rounding_is_asked_about_all_along(passing, monkeypatch) -> None:
    """A box that slides along the ball's path at its very edge leaves too many questions."""
    asked = []
    monkeypatch.setattr(
        SweptChecker,
        "touches",
        lambda self, q, X_WO: asked.append(len(q)) or np.zeros(len(q), bool),
    )
    q = np.stack([np.linspace(-0.3, 0.3, 60), np.zeros(60)], axis=1)
    back = np.concatenate([q, q[::-1], q, q[::-1], q])
    X_WO = standing(0.0, 0.05 - 2e-6)
    near = np.concatenate([np.tile([[-1e-4, 0.0], [1e-4, 0.0]], (20, 1)), back])
    assert not along(passing, near, X_WO).touches[0]
    assert asked[0] > QUESTIONS


def test_drake_finds_the_first_of_the_configurations_in_question(passing, monkeypatch) -> None:
    """The earliest of those that it says touch, in step and place."""
    near = np.tile([[-1e-4, 0.0], [1e-4, 0.0]], (3, 1))
    X_WO = standing(0.0, 0.05 + 2e-6)
    said: list[np.ndarray] = []

    def last_two(self: SweptChecker, q: np.ndarray, X_WO: np.ndarray) -> np.ndarray:
        said.append(q)
        return np.arange(len(q)) >= len(q) - 2

    monkeypatch.setattr(SweptChecker, "touches", last_two)
    found = along(passing, near, X_WO)
    assert len(said[0]) >= 3
    assert found.touches[0]
    assert found.pair[0] == -1
    np.testing.assert_allclose(found.q[0], said[0][-2], atol=1e-12)


def test_an_object_that_stands_in_the_base_touches_from_the_start(tmp_path: Path) -> None:
    """Of which the arm moves neither: at every path of these objects, and at no other."""
    shapes = {"base": "<box><size>0.2 0.2 0.2</size></box>", "x1_link": BALL}
    checker = checker_of(tmp_path, RAILS[:2], shapes)
    q = np.array([[0.5, 0.0], [0.6, 0.0]])
    steps, first = np.tile(lines(q), (3, 1, 1)), np.arange(4)
    X_WO = np.array([FAR, standing(0.11, 0.0, 0.0), FAR])
    found = checker.along(steps, first, X_WO)
    np.testing.assert_array_equal(found.touches, [False, True, False])
    assert (found.step[1], found.place[1]) == (0, 0.0)
    np.testing.assert_array_equal(found.q[1], q[0])
    assert set(checker.workcell.touching(int(found.pair[1]))) == {"base", "pole"}
    for gap, asked in ((5e-6, 1), (-5e-6, 1), (1e-4, 0)):
        before = checker.asked
        found = along(checker, q, standing(0.12 + gap, 0.0, 0.0))
        assert found.touches[0] == (gap < 0.0)
        assert checker.asked - before == asked


@pytest.mark.parametrize("clearance", [0.01, 0.2])
def test_a_clearance_is_kept_from_all_else_and_itself(tmp_path: Path, clearance: float) -> None:
    rng = np.random.default_rng(8)
    checker = checker_of(tmp_path, RAILS, {"x1_link": BALL, "x3_link": BALL}, clearance=clearance)
    q0 = np.array([0.0, -3.0, 3.0, 0.0])
    for _ in range(15):
        away = rng.uniform(0.1, 1.0)
        for past, touches in ((-2e-4, False), (2e-4, True)):
            q = q0 + np.outer(steps_to(away + past, rng), [0.25, 0.25, 0.25, 0.25])
            X_WO = standing(away + 0.05 + clearance, 0.0)
            assert along(checker, q, X_WO).touches[0] == touches
            itself = np.zeros((len(q), 4))
            itself[:, 3] = away + 0.06 + clearance - (q - q0).sum(axis=1)
            assert along(checker, itself).touches[0] == touches
    before = checker.asked
    for gap in (-5e-6, 5e-6):
        X_WO = standing(0.05 + clearance + gap, 0.0)
        assert along(checker, q0[None], X_WO).touches[0] == (gap < 0.0)
    assert checker.asked == before + 2


def test_no_paths_touch_nothing(passing) -> None:
    found = passing.along(np.zeros((0, 5, 2)), np.array([0]), np.zeros((0, 1, 4, 4)))
    assert len(found.touches) == len(found.q) == 0
