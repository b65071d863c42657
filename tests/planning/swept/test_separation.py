"""Bounds on the distance of two convex shapes, beside Drake's signed distances."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from pydrake.geometry import (
    Box,
    Capsule,
    Convex,
    Cylinder,
    Ellipsoid,
    GeometryFrame,
    GeometryInstance,
    HalfSpace,
    Mesh,
    ProximityProperties,
    SceneGraph,
    Shape,
    Sphere,
)
from pydrake.geometry import FramePoseVector_ as FramePoses
from pydrake.math import RigidTransform
from scipy.optimize import nnls

from benchmarks.mesh_arm import write_obj
from drake_screw.planning.swept.convex import BOX, HULL, POINT, SEGMENT
from drake_screw.planning.swept.cores import Core, core_of, together
from drake_screw.screws import exp, pose
from tests.planning.swept.compiled import bounds_on_distance, farthest, nearest_points

CLOSE = 2e-5
"""m, within which Drake is hardly ever wrong, and no bound may be."""

DRAKES = 1e-3
"""m, by which Drake's distances of round shapes and of hulls are too large at worst."""

BALLS = 2e-5
"""m, of two of `convex.BALL`: as deep as that the upper bound tells."""


@pytest.fixture(scope="module")
def solids(tmp_path_factory: pytest.TempPathFactory) -> list[Shape]:
    """Two of each kind, long and flat ones among them."""
    rng, folder = np.random.default_rng(3), tmp_path_factory.mktemp("meshes")
    few = write_obj(folder / "few.obj", np.add(rng.uniform(-0.1, 0.1, (12, 3)), [0.3, 0, 0.1]))
    ball = rng.normal(size=(300, 3))
    ball = ball / np.linalg.norm(ball, axis=1)[:, None] * [0.1, 0.05, 0.2]
    many = write_obj(folder / "many.obj", ball)
    return [
        Sphere(0.1),
        Sphere(0.01),
        Capsule(0.04, 0.5),
        Capsule(0.1, 0.001),
        Box(0.2, 0.05, 0.6),
        Box(0.3, 0.3, 0.004),
        Cylinder(0.05, 0.7),
        Cylinder(0.3, 0.02),
        Ellipsoid(0.1, 0.2, 0.05),
        Ellipsoid(0.01, 0.02, 0.4),
        Mesh(str(few), 1.0),
        Convex(str(many), 1.5),
    ]


class Distances:
    """Signed distances of all pairs of shapes, by Drake."""

    def __init__(self, solids: list[Shape]) -> None:
        self._graph = graph = SceneGraph()
        self._source = graph.RegisterSource("tests")
        self._frames, self._shapes = [], []
        for i, shape in enumerate(solids):
            frame = graph.RegisterFrame(self._source, GeometryFrame(f"frame {i}"))
            instance = GeometryInstance(RigidTransform(), shape, f"shape {i}")
            instance.set_proximity_properties(ProximityProperties())
            self._shapes.append(graph.RegisterGeometry(self._source, frame, instance))
            self._frames.append(frame)
        self._context = graph.CreateDefaultContext()

    def __call__(self, a: int, X_WA: np.ndarray, b: int, X_WB: np.ndarray) -> float:
        poses = FramePoses[float]()
        for frame in self._frames:
            poses.set_value(frame, RigidTransform())
        poses.set_value(self._frames[a], RigidTransform(X_WA))
        poses.set_value(self._frames[b], RigidTransform(X_WB))
        port = self._graph.get_source_pose_port(self._source)
        port.FixValue(self._context, poses)
        query = self._graph.get_query_output_port().Eval(self._context)
        pair = query.ComputeSignedDistancePairClosestPoints(self._shapes[a], self._shapes[b])
        return float(pair.distance)


def placed(solids: list[Shape]):  # type: ignore[no-untyped-def]
    """The shapes as cores, and the frames (S, 4, 4) of these in those of the shapes."""
    cores = [core_of(shape) for shape in solids]
    return together(cores), pose(np.eye(3), np.array([core.p for core in cores]))


def some_poses(rng: np.random.Generator, N: int, far: float = 0.6) -> np.ndarray:
    X = exp(rng.normal(size=(N, 6)) * [2.0, 2.0, 2.0, 0.0, 0.0, 0.0])
    X[:, :3, 3] = rng.uniform(-far, far, (N, 3))
    return X


def test_bounds_hold_drakes_distances(solids: list[Shape]) -> None:
    """Of every pair of kinds, apart and within one another."""
    rng, distance = np.random.default_rng(1), Distances(solids)
    shapes, X_SG = placed(solids)
    pairs = np.array(list(itertools.combinations_with_replacement(range(len(solids)), 2)) * 12)
    pairs = pairs[pairs[:, 0] != pairs[:, 1]]
    X_WA, X_WB = some_poses(rng, len(pairs), 0.15), some_poses(rng, len(pairs), 0.15)
    true = np.array([distance(a, A, b, B) for (a, b), A, B in zip(pairs, X_WA, X_WB, strict=True)])
    frames = X_WA @ X_SG[pairs[:, 0]], X_WB @ X_SG[pairs[:, 1]]
    lower, upper = bounds_on_distance(shapes, pairs, *frames, 1e3, np.maximum(true, 0.0))
    apart = true > CLOSE
    assert 0.2 < apart.mean() < 0.8
    assert (lower <= true + CLOSE).all()
    assert (upper[apart] >= true[apart] - DRAKES).all()
    assert (upper[apart] >= true[apart] - CLOSE).mean() > 0.98
    assert (upper - lower)[apart].max() < 2e-3
    assert np.quantile((upper - lower)[apart], 0.9) < 2.0 * CLOSE
    within = true < -BALLS
    assert (upper[within] < -1e-5).all()
    assert (upper[~within] >= true[~within] - DRAKES).all()


def corners_of(core: Core) -> np.ndarray:
    """Corners (c, 3) of a core that has any."""
    if core.kind == HULL:
        return core.corners
    signs = np.array(list(itertools.product([-1.0, 1.0], repeat=3)))
    return np.unique(signs * core.size, axis=0)


def test_bounds_hold_the_distances_of_polytopes(solids: list[Shape]) -> None:
    """By nonnegative least squares, of boxes, hulls, balls and capsules: closer than Drake."""
    rng = np.random.default_rng(10)
    shapes, _ = placed(solids)
    some = [s for s, kind in enumerate(shapes.kind) if kind in (POINT, SEGMENT, BOX, HULL)]
    cores = [core_of(solid) for solid in solids]
    pairs = rng.choice(some, (300, 2))
    X_WA, X_WB = some_poses(rng, 300, 0.25), some_poses(rng, 300, 0.25)
    true = np.empty(300)
    for i, (a, b) in enumerate(pairs):
        A, B = (
            corners_of(cores[s]) @ X[i, :3, :3].T + X[i, :3, 3] for s, X in ((a, X_WA), (b, X_WB))
        )
        true[i] = distance_by_weights(A, B) - cores[a].round - cores[b].round
    lower, upper = bounds_on_distance(shapes, pairs, X_WA, X_WB, 1e3, np.maximum(true, 0.0))
    apart = true > CLOSE
    assert 0.3 < apart.mean() < 0.95
    assert (lower <= true + 1e-8)[apart].all()
    assert (upper >= true - 1e-8)[apart].all()
    assert (upper - lower)[apart].max() < 5.0 * CLOSE


def distance_by_weights(A: np.ndarray, B: np.ndarray) -> float:
    """Distance in m of the hulls of points (a, 3) and (b, 3)."""
    heavy = 1e4
    M = np.zeros((5, len(A) + len(B)))
    M[:3], M[3, : len(A)], M[4, len(A) :] = np.vstack([A, -B]).T, heavy, heavy
    weights, _ = nnls(M, np.array([0.0, 0.0, 0.0, heavy, heavy]))
    a, b = weights[: len(A)], weights[len(A) :]
    return float(np.linalg.norm(a / a.sum() @ A - b / b.sum() @ B))


def test_what_is_known_early_is_true_as_well(solids: list[Shape]) -> None:
    """The search ends as soon as the question is answered, by bounds that hold."""
    rng, distance = np.random.default_rng(2), Distances(solids)
    shapes, X_SG = placed(solids)
    N = 800
    pairs = np.array([rng.permutation(len(solids))[:2] for _ in range(N)])
    X_WA, X_WB = some_poses(rng, N, 0.2), some_poses(rng, N, 0.2)
    true = np.array([distance(a, A, b, B) for (a, b), A, B in zip(pairs, X_WA, X_WB, strict=True)])
    frames = X_WA @ X_SG[pairs[:, 0]], X_WB @ X_SG[pairs[:, 1]]
    for least in (0.0, 0.02):
        needed = least + rng.choice([2e-5, 1e-3, 0.05, 0.3], N)
        lower, upper = bounds_on_distance(shapes, pairs, *frames, needed, least)
        assert (lower <= true + CLOSE).all()
        assert (upper >= true - DRAKES)[true > -BALLS].all()
        assert (lower > needed)[true > needed + DRAKES].all()
        assert (upper < least - 1e-5)[true < least - DRAKES].all()
        between = (true > least + DRAKES) & (true < needed - DRAKES)
        assert ((lower > least + 1e-5) & (upper < needed))[between].all()


@pytest.mark.parametrize("least", [0.0, 0.13])
def test_shapes_side_by_side_are_as_far_apart_as_they_are(least: float) -> None:
    """Whose difference is flat, or has edges and faces side by side."""
    solids = [Capsule(0.05, 0.6), Box(0.1, 0.2, 0.3), Cylinder(0.05, 0.3), Capsule(0.02, 0.4)]
    shapes, _ = placed(solids)
    widths, rng = [0.05, 0.05, 0.05, 0.02], np.random.default_rng(11)
    for (a, wa), (b, wb) in itertools.product(enumerate(widths), repeat=2):
        X_WA = some_poses(rng, 40)
        gap = np.concatenate([[least, least + 1e-4], rng.uniform(least, 0.4, 38)])
        X_AB = pose(np.eye(3), np.column_stack([gap + wa + wb, np.zeros(40), np.zeros(40)]))
        lower, upper = bounds_on_distance(shapes, [(a, b)] * 40, X_WA, X_WA @ X_AB, 1e3, gap)
        np.testing.assert_allclose(lower, gap, atol=CLOSE)
        np.testing.assert_allclose(upper, gap, atol=CLOSE)


@pytest.mark.parametrize("depth", [-1e-3, -1e-6, 0.0, 1e-6, 1e-3])
def test_balls_that_just_touch_are_told_to_a_nanometre(depth: float) -> None:
    shapes, X_SG = placed([Sphere(0.1), Sphere(0.05)])
    rng = np.random.default_rng(4)
    X_WA, way = some_poses(rng, 50), rng.normal(size=(50, 3))
    X_WB = X_WA.copy()
    X_WB[:, :3, 3] += way / np.linalg.norm(way, axis=1)[:, None] * (0.15 - depth)
    lower, upper = bounds_on_distance(
        shapes, [(0, 1)] * 50, X_WA @ X_SG[0], X_WB @ X_SG[1], 1e-4, 0.0
    )
    assert (lower <= -depth + 1e-12).all()
    assert (upper >= -depth - 1e-12).all()
    np.testing.assert_allclose(upper if depth > 1e-5 else lower, -depth, atol=1e-9)


@pytest.mark.parametrize("gap", [0.0, 1e-6, -1e-6])
def test_faces_that_just_touch_are_left_open(gap: float) -> None:
    """A plate on a plate, and a can and a hull on it: nothing is said that rounding decides."""
    solids = [Box(0.4, 0.4, 0.1), Box(0.2, 0.2, 0.2), Cylinder(0.1, 0.2), Capsule(0.1, 0.2)]
    shapes, _ = placed(solids)
    X_WA, X_WB = np.eye(4), np.eye(4)
    for b, half in ((1, 0.1), (2, 0.1), (3, 0.2)):
        X_WB[:3, 3] = 0.03, 0.02, 0.05 + half + gap
        turn = exp(np.array([0.3, -0.4, 0.2, 0.1, 0.2, 0.3]))
        A, B = (turn @ X for X in (X_WA, X_WB))
        lower, upper = bounds_on_distance(shapes, [(0, b)], A[None], B[None], 1e3, 0.0)
        assert -CLOSE <= lower[0] <= gap + 1e-9
        assert gap - 1e-9 <= upper[0] <= CLOSE


def test_a_half_space_is_level_and_endless(solids: list[Shape]) -> None:
    """Beside Drake for balls, and by hand for boxes, of which Drake knows no distance."""
    rng, N = np.random.default_rng(5), 60
    some = [HalfSpace(), Sphere(0.1), Box(0.2, 0.05, 0.6)]
    shapes, X_SG = placed(some)
    X_WH, X = some_poses(rng, N, 2.0), some_poses(rng, N, 1.0)
    distance = Distances(some)
    for b in (1, 2):
        half = np.array([0.1, 0.025, 0.3])
        spread = np.abs(X[:, 2, :3]) @ half if b == 2 else 0.1
        true = X[:, 2, 3] - spread
        frames = X_WH @ X_SG[0], X_WH @ X @ X_SG[b]
        least = np.maximum(true, 0.0)
        lower, upper = bounds_on_distance(shapes, [(0, b)] * N, *frames, 1e3, least)
        if b == 1:
            drake = [distance(0, H, 1, H @ B) for H, B in zip(X_WH, X, strict=True)]
            np.testing.assert_allclose(drake, true, atol=1e-12)
        apart = true > CLOSE
        assert 0.2 < apart.mean() < 0.8
        assert (lower <= true + CLOSE).all()
        assert (np.abs(lower - true)[apart] < CLOSE).all()
        assert (np.abs(upper - true)[apart] < CLOSE).all()
        assert (upper[true < -CLOSE] <= 0.0).all()


def test_far_corners_of_hulls_are_found_uphill(solids: list[Shape]) -> None:
    """Whatever corner the search begins at."""
    rng = np.random.default_rng(6)
    for solid in solids[-2:]:
        core = core_of(solid)
        shapes = together([core_of(Sphere(0.1)), core_of(solids[-2]), core])
        directions = rng.normal(size=(3000, 3))
        p = farthest(shapes, 2, directions)
        best = (core.corners @ directions.T).max(axis=0)
        np.testing.assert_allclose((p[:, :3] * directions).sum(axis=1), best, rtol=1e-12)


def test_inner_cores_hold_a_ball_everywhere(solids: list[Shape]) -> None:
    """In every direction the shape is farther out than its inner core by the ball's radius."""
    rng = np.random.default_rng(7)
    directions = rng.normal(size=(2000, 3))
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    shapes, _ = placed(solids)
    for s, kind in enumerate(shapes.kind):
        p = farthest(shapes, s, directions)
        out, inside = ((x * directions).sum(axis=1) for x in (p[:, :3], p[:, 3:]))
        if kind <= 1:
            np.testing.assert_array_equal(out, inside)
        else:
            assert (out - inside).min() >= 1e-5 - 1e-12


def brute_force(W: np.ndarray) -> float:
    """Least distance in m of the origin from a simplex (c, 3): weights by least squares."""
    heavy = 1e4
    A = np.vstack([W.T, np.full(len(W), heavy)])
    weights, _ = nnls(A, np.array([0.0, 0.0, 0.0, heavy]))
    return float(np.linalg.norm(weights / weights.sum() @ W))


@pytest.mark.parametrize("flat", ["full", "plane", "line", "point", "needle"])
def test_nearest_points_of_simplices(flat: str) -> None:
    """Beside nonnegative least squares; degenerate ones may cost a little, never lie outside."""
    rng, N = np.random.default_rng(8), 400
    W = rng.normal(size=(N, 4, 3)) + rng.normal(size=(N, 1, 3))
    if flat == "plane":
        W = W @ np.diag([1.0, 1.0, 0.0]) + [0.0, 0.0, 0.3]
    elif flat == "line":
        W = rng.normal(size=(N, 4, 1)) * rng.normal(size=(N, 1, 3)) + rng.normal(size=(N, 1, 3))
    elif flat == "point":
        W[:] = W[:, :1]
    elif flat == "needle":
        W[:, 2:] = W[:, :2] + 1e-7 * rng.normal(size=(N, 2, 3))
    count = rng.integers(1, 5, N)
    weights, inside = nearest_points(W, count)
    outside = ~inside
    assert inside.any() == (flat == "full")
    assert (count[inside] == 4).all()
    np.testing.assert_allclose(weights[outside].sum(axis=1), 1.0, atol=1e-12)
    assert (weights[outside] >= 0.0).all()
    for i in range(N):
        least = brute_force(W[i, : count[i]])
        if inside[i]:
            assert least < 1e-6
            continue
        assert (weights[i, count[i] :] == 0.0).all()
        found = np.linalg.norm(weights[i] @ W[i])
        assert least - 1e-6 <= found
        if flat in ("full", "plane"):
            assert found <= least + 1e-6
        assert found <= np.linalg.norm(W[i, : count[i]], axis=1).min() + 1e-6


def test_a_corner_at_the_origin_is_nearest() -> None:
    W = np.random.default_rng(9).normal(size=(80, 4, 3))
    count = np.repeat([1, 2, 3, 4], 20)
    W[np.arange(80), np.tile(np.arange(20), 4) % count] = 0.0
    weights, inside = nearest_points(W, count)
    found = np.linalg.norm(np.einsum("ni,nij->nj", weights, W), axis=1)
    assert (found[~inside] < 1e-12).all()
