"""An arm whose kinematics are Pinocchio's, for `ReferencePlanner` in place of Drake's."""

from __future__ import annotations

from typing import Any

import numpy as np

from drake_screw.robot import ScrewChain
from drake_screw.typing import Array


def model_of(chain: ScrewChain) -> Any:
    """Pinocchio's model of an arm (Carpentier et al. 2019) with a frame "hand" at its end effector.

    At q = 0 the frames of all joints are parallel to W.

    Args:
        chain: the arm's screws; the model is built of them.

    Raises:
        ImportError: Pinocchio is not installed; it comes with the extra `benchmark`.
    """
    import pinocchio

    model = pinocchio.Model()
    parent, before = 0, np.zeros(3)
    for name, S in zip(chain.joint_names, chain.screws, strict=True):
        turns = np.linalg.norm(S[:3]) > 0.5
        axis, at = (S[:3], np.cross(S[:3], S[3:])) if turns else (S[3:], before)
        kind = (
            pinocchio.JointModelRevoluteUnaligned
            if turns
            else pinocchio.JointModelPrismaticUnaligned
        )
        place = pinocchio.SE3(np.eye(3), at - before)
        parent, before = model.addJoint(parent, kind(*axis), place, name), at
    R, p = chain.home[:3, :3], chain.home[:3, 3]
    place = pinocchio.SE3(R, p - before)
    model.addFrame(pinocchio.Frame("hand", parent, 0, place, pinocchio.FrameType.OP_FRAME))
    return model


class PinocchioArm:
    """What the reference planner asks of an `Arm`, answered by Pinocchio.

    Args:
        chain: the arm's screws.

    Raises:
        ImportError: as `model_of`.
    """

    def __init__(self, chain: ScrewChain) -> None:
        import pinocchio

        self._pin = pinocchio
        self.n, self.lower, self.upper = chain.n, chain.lower, chain.upper
        self._model = model_of(chain)
        self._hand = self._model.getFrameId("hand")
        self._data = self._model.createData()

    def pose(self, q: Array) -> Array:
        """X_WE (4, 4) at q (n,)."""
        self._pin.framesForwardKinematics(self._model, self._data, q)
        return np.array(self._data.oMf[self._hand].homogeneous)

    def pose_and_jacobian(self, q: Array) -> tuple[Array, Array]:
        """X_WE (4, 4) and J_WE (6, n), twists [w; v] of E's origin in W."""
        self._pin.computeJointJacobians(self._model, self._data, q)
        self._pin.updateFramePlacement(self._model, self._data, self._hand)
        J = self._pin.getFrameJacobian(
            self._model, self._data, self._hand, self._pin.LOCAL_WORLD_ALIGNED
        )
        X_WE = np.array(self._data.oMf[self._hand].homogeneous)
        return X_WE, np.concatenate([J[3:], J[:3]])

    def jacobian(self, q: Array) -> Array:
        """J_WE (6, n) at q (n,)."""
        return self.pose_and_jacobian(q)[1]

    def margin(self, q: Array) -> Array:
        """Distance to the nearer limit (n,), negative outside."""
        return np.minimum(q - self.lower, self.upper - q)
