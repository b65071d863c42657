"""The product of exponentials is the plant's kinematics."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import yaml

from drake_screw.robot import Arm, ScrewChain
from drake_screw.screws import adjoint, exp, inverse, log
from tests.robot.small_arms import PLANAR, SEVEN, SLIDING, JointText, arm_of, plant_of

ARMS = {"7R": SEVEN, "with prismatic joints": SLIDING, "planar 3R": PLANAR}


@pytest.fixture(params=ARMS.values(), ids=ARMS.keys())
def arm(request: pytest.FixtureRequest) -> Arm:
    return arm_of(request.param)


def test_pose_agrees_with_the_plant(arm: Arm) -> None:
    q = np.random.default_rng(0).uniform(arm.lower, arm.upper, (50, arm.n))
    np.testing.assert_allclose(arm.screw_chain().pose(q), arm.pose(q), atol=1e-13)


def test_jacobian_is_the_plants_seen_from_the_origin(arm: Arm) -> None:
    chain = arm.screw_chain()
    for q in np.random.default_rng(1).uniform(arm.lower, arm.upper, (20, arm.n)):
        X_WE, J_WE = arm.pose_and_jacobian(q)
        J = chain.jacobian(q)
        np.testing.assert_allclose(J[:3], J_WE[:3], atol=1e-13)
        at_hand = J[3:] + np.cross(J[:3], X_WE[:3, 3], axis=0)
        np.testing.assert_allclose(at_hand, J_WE[3:], atol=1e-13)


def test_motions_are_the_factors_of_pose_and_jacobian(arm: Arm) -> None:
    rng, chain = np.random.default_rng(4), arm.screw_chain()
    q = rng.uniform(np.maximum(arm.lower, -3.0), np.minimum(arm.upper, 3.0), (20, arm.n))
    E = chain.motions(q)
    assert E.shape == (arm.n, 20, 4, 4)
    np.testing.assert_allclose(E[-1] @ chain.home, chain.pose(q), atol=1e-12)
    before = np.concatenate([np.tile(np.eye(4), (1, 20, 1, 1)), E[:-1]])
    J = adjoint(before) @ chain.screws[:, None, :, None]
    np.testing.assert_allclose(np.moveaxis(J[..., 0], 0, -1), chain.jacobian(q), atol=1e-12)


def test_jacobian_is_the_derivative_of_pose(arm: Arm) -> None:
    chain, rng, step = arm.screw_chain(), np.random.default_rng(2), 1e-6
    q, rates = rng.uniform(arm.lower, arm.upper), rng.normal(size=arm.n)
    moved = chain.pose(q + step * rates) @ inverse(chain.pose(q - step * rates))
    np.testing.assert_allclose(chain.jacobian(q) @ rates, log(moved) / (2.0 * step), atol=1e-8)


def test_screws_have_unit_size_and_limits_are_the_arms(arm: Arm) -> None:
    chain = arm.screw_chain()
    turning = np.linalg.norm(chain.screws[:, :3], axis=1)
    sliding = np.linalg.norm(chain.screws[:, 3:], axis=1)
    kinds = [arm.plant.GetJointByName(name).type_name() for name in arm.joint_names]
    for kind, w, v in zip(kinds, turning, sliding, strict=True):
        assert w == pytest.approx(1.0 if kind == "revolute" else 0.0, abs=1e-12)
        if kind == "prismatic":
            assert v == pytest.approx(1.0)
    np.testing.assert_array_equal(chain.lower, arm.lower)
    np.testing.assert_array_equal(chain.upper, arm.upper)
    assert chain.joint_names == arm.joint_names
    assert chain.n == arm.n


def test_chain_keeps_parked_joints_where_they_are() -> None:
    names = [joint.name for joint in SEVEN]
    whole = arm_of(SEVEN)
    upper = Arm(whole.plant, names[1:], "hand", parked={"a1": 0.7})
    middle = Arm(whole.plant, [*names[:3], *names[4:]], "hand", parked={"a4": -0.5})
    q = np.random.default_rng(3).uniform(-1.5, 1.5, (10, 6))
    np.testing.assert_allclose(
        upper.screw_chain().pose(q), whole.pose(np.insert(q, 0, 0.7, axis=1)), atol=1e-13
    )
    np.testing.assert_allclose(
        middle.screw_chain().pose(q), whole.pose(np.insert(q, 3, -0.5, axis=1)), atol=1e-13
    )


@pytest.mark.parametrize("shape", [(), (3,), (2, 3), (0,)])
def test_leading_axes_are_carried(shape: tuple[int, ...]) -> None:
    chain = arm_of(SEVEN).screw_chain()
    q = np.random.default_rng(4).uniform(-1.0, 1.0, (*shape, 7))
    X, J = chain.pose(q), chain.jacobian(q)
    assert X.shape == (*shape, 4, 4)
    assert J.shape == (*shape, 6, 7)
    for index in np.ndindex(shape):
        np.testing.assert_allclose(X[index], chain.pose(q[index]), atol=1e-15)
        np.testing.assert_allclose(J[index], chain.jacobian(q[index]), atol=1e-15)


def test_planar_chain_by_hand() -> None:
    chain = arm_of(PLANAR).screw_chain()
    np.testing.assert_allclose(chain.screws[:, :3], np.tile([0.0, 0.0, 1.0], (3, 1)), atol=1e-15)
    np.testing.assert_allclose(
        chain.screws[:, 3:], [[0, 0, 0], [0, -0.4, 0], [0, -0.7, 0]], atol=1e-15
    )
    np.testing.assert_allclose(chain.home[:3, 3], [0.8, 0.0, 0.55], atol=1e-15)
    np.testing.assert_allclose(
        chain.pose([np.pi / 2, 0.0, np.pi / 2])[:3, 3], [-0.1, 0.7, 0.55], atol=1e-15
    )


def test_no_configuration_lies_beyond_the_reach(arm: Arm) -> None:
    chain = arm.screw_chain()
    q = np.random.default_rng(5).uniform(chain.lower, chain.upper, (3000, chain.n))
    away = np.linalg.norm(chain.pose(q)[:, :3, 3] - chain.shoulder, axis=1)
    assert away.max() <= chain.reach
    assert chain.reach <= 2.5 * away.max()


def test_reach_of_a_stretched_planar_arm_is_its_length() -> None:
    chain = arm_of(PLANAR).screw_chain()
    assert chain.reach == pytest.approx(0.8)
    np.testing.assert_allclose(chain.shoulder, [0.0, 0.0, 0.55])
    rail = JointText("x", "0 0 0 0 0 0", axis="1 0 0", kind="prismatic", limits=(-0.2, 0.6))
    assert arm_of((rail,)).screw_chain().reach == pytest.approx(0.6)


def test_calibrated_model_is_its_published_product_of_exponentials(shared: Path) -> None:
    published = yaml.safe_load((shared / "reference/baxter_left_calibrated.yaml").read_text())
    plant = plant_of((shared / "reference/baxter_left_calibrated.sdf").read_text())
    arm = Arm(plant, published["joints"], "left_hand")
    chain = arm.screw_chain()
    axes, points = np.array(published["axis"]), np.array(published["point"])
    home, limits = np.array(published["home"]), np.array(published["limits"])
    np.testing.assert_allclose(chain.screws[:, :3], axes, atol=2e-6)
    np.testing.assert_allclose(chain.screws[:, 3:], np.cross(points, axes), atol=3e-6)
    np.testing.assert_allclose(chain.home, home, atol=2e-6)
    np.testing.assert_array_equal(np.stack([chain.lower, chain.upper], axis=1), limits)

    by_numbers = ScrewChain(
        arm.joint_names,
        np.concatenate([axes, np.cross(points, axes)], axis=1),
        home,
        limits[:, 0],
        limits[:, 1],
    )
    q = np.random.default_rng(6).uniform(arm.lower, arm.upper, (100, 7))
    np.testing.assert_allclose(arm.pose(q), by_numbers.pose(q), atol=2e-5)
    product = np.eye(4)
    for S, angle in zip(by_numbers.screws, q[0], strict=True):
        product = product @ exp(S * angle)
    np.testing.assert_allclose(by_numbers.pose(q[0]), product @ home, atol=1e-14)
