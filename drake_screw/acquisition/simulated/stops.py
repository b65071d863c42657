"""How far people keep a joint from its stops, and what distance is a comfort to them.

Angles and lengths are not alike: what is 0.15 rad of a hinge is a hand's breadth of a slide that
may be no longer than that. Slides are measured in parts of their range, and put in terms of
radians, so that the joints of an arm compare.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from drake_screw.robot import Arm
from drake_screw.typing import Array

MARGIN = 0.15  # rad, what people mean to keep from the stops of a revolute joint
SLIDE_MARGIN = 0.02  # m, of a prismatic one, and
SLIDE_PART = 0.05  # of its range, whichever is less
TOLERANCE = 1.0 / 3.0  # of these margins, by which people miss them
ROUNDING = 1e-9  # rad
COMFORTABLE = 0.6  # rad, or four such margins, beyond which more distance is no easier


@dataclass(frozen=True, eq=False)
class Stops:
    """The margins of an arm's joints.

    Attributes:
        arm: whose joints they are.
        wanted: (n,) rad or m, what is to be kept from the limits. Where the arm starts nearer to
            one than people would go, it is half of that distance.
    """

    arm: Arm
    wanted: Array

    @classmethod
    def of(cls, arm: Arm, start: ArrayLike) -> Stops:
        """Those of an arm that starts from (n,) rad or m."""
        short = np.minimum(SLIDE_MARGIN, SLIDE_PART * (arm.upper - arm.lower))
        usual = np.where(arm.slides, short, MARGIN)
        at_start = arm.margin(start)
        return cls(arm, np.where(at_start < usual, at_start / 2.0, usual))

    @property
    def ends(self) -> tuple[Array, Array]:
        """(n,) and (n,) m, where slides stop while the other joints move on; others do not.

        A hinge has to be led around its stop, but nobody minds where a lift is.
        """
        slides = self.arm.slides
        lower = np.where(slides, self.arm.lower + self.wanted, -np.inf)
        return lower, np.where(slides, self.arm.upper - self.wanted, np.inf)

    def margin(self, q: Array) -> Array:
        """The least distance from a limit at configurations (..., n), by the joint whose is least.

        In rad: of a joint for which less than MARGIN is wanted, in that proportion.
        """
        return np.asarray((self.arm.margin(q) * (MARGIN / self.wanted)).min(axis=-1))

    def kept(self, q: Array) -> bool:
        """Whether a motion (m, n) that is meant to keep the margins does, but for the tolerance."""
        return not bool((self.arm.margin(q) < self.wanted * (1.0 - TOLERANCE)).any())
