"""Random arms, and their generated code run as plain Python, for tests of the compiled planner."""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil, floor, sqrt
from typing import Any

import numpy as np

from drake_screw.planning.compiled import rows as r
from drake_screw.planning.compiled import step_code
from drake_screw.planning.compiled.link_frames import LinkFrames, link_frames
from drake_screw.robot import ScrewChain
from drake_screw.screws import adjoint, exp, inverse

NAMES = {"ceil": ceil, "floor": floor, "sqrt": sqrt, "uintp": int, "lane_code": lambda f: f}
LIMIT = 3.0


def run_in_python(source: str) -> dict[str, Any]:
    """The functions of generated source text, not compiled."""
    names = dict(NAMES)
    exec(source, names)
    return names


def random_chain(
    rng: np.random.Generator, n: int, *, sliding: float = 0.0, square: bool = False
) -> ScrewChain:
    """An arm with joints anywhere.

    Args:
        sliding: share of prismatic joints.
        square: axes along x, y and z only, so that many are parallel or meet.
    """
    screws = np.empty((n, 6))
    for S in screws:
        axis = rng.normal(size=3)
        if square:
            axis = np.eye(3)[rng.integers(3)] * rng.choice([-1.0, 1.0])
        axis = axis / np.linalg.norm(axis)
        if rng.random() < sliding:
            S[:] = [0.0, 0.0, 0.0, *axis]
        else:
            S[:3], S[3:] = axis, np.cross(rng.normal(size=3) * 0.4, axis)
    names = tuple(f"j{i}" for i in range(n))
    limit = np.full(n, LIMIT)
    return ScrewChain(names, screws, exp(rng.normal(size=6)), -limit, limit)


@dataclass
class Bench:
    """An arm's generated functions and a block of lanes to run them on.

    Attributes:
        chain: the arm.
        frames: its link frames.
        functions: by name.
        block: (rows, lanes), a view on `flat`.
        flat: the block as the functions take it.
        rows: places in the block.
    """

    chain: ScrewChain
    frames: LinkFrames
    functions: dict[str, Any]
    block: np.ndarray
    flat: np.ndarray
    rows: r.Rows

    def run(self, name: str) -> None:
        self.functions[name](self.flat)

    def base_twist(self, V: np.ndarray) -> np.ndarray:
        """Twists (..., 6) in W as the block holds them, in B."""
        return V @ adjoint(inverse(self.frames.X_WB)).T

    def base_pose(self, X: np.ndarray) -> np.ndarray:
        """Poses (..., 4, 4) in W as the block holds them: (..., 12) in B."""
        X_B = inverse(self.frames.X_WB) @ X
        return X_B[..., :3, :].reshape(*X.shape[:-2], 12)


def bench(chain: ScrewChain, settings: step_code.Settings | None = None) -> Bench:
    """Lay out everything for an arm."""
    settings = settings or step_code.Settings()
    frames, n = link_frames(chain.screws, chain.home), chain.n
    arrive, aim, count = step_code.arrive_and_aim(frames, settings)
    judge = step_code.judge(chain.lower.tolist(), chain.upper.tolist(), settings)
    parts = [step_code.blend(n, k) for k in range(1, 7)] + [step_code.rate(frames), arrive, aim]
    flat = np.zeros(count * r.LANES)
    functions = run_in_python("\n\n".join([*parts, judge]))
    return Bench(chain, frames, functions, flat.reshape(-1, r.LANES), flat, r.Rows(n))
