"""Random arms, and their programs run in numpy, for tests of the compiled planner."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from drake_screw.planning.compiled import arm_module, step_code
from drake_screw.planning.compiled import rows as r
from drake_screw.planning.compiled.expressions import Node, Program
from drake_screw.planning.compiled.link_frames import LinkFrames, link_frames
from drake_screw.robot import ScrewChain
from drake_screw.screws import adjoint, exp, inverse

OPERATIONS: dict[str, Callable[..., Any]] = {
    "+": np.add,
    "-": np.subtract,
    "*": np.multiply,
    "/": np.divide,
    "neg": np.negative,
    "abs": np.abs,
    "sqrt": np.sqrt,
    "floor": np.floor,
    "ceil": np.ceil,
    "min": lambda x, y: np.where(y < x, y, x),
    "max": lambda x, y: np.where(y > x, y, x),
    "<": np.less,
    "<=": np.less_equal,
    ">": np.greater,
    ">=": np.greater_equal,
    "&": np.logical_and,
    "|": np.logical_or,
    "~": np.logical_not,
    "where": np.where,
}
LIMIT = 3.0


def run_in_numpy(program: Program, block: np.ndarray) -> None:
    """Do what a program says on a block (rows, lanes), without compiling it."""
    values: dict[Node, Any] = {}
    for node in program.nodes:
        arguments = [values[argument] for argument in node.arguments]
        match node.operation:
            case "constant":
                values[node] = node.number
            case "load":
                values[node] = block[node.row].copy()
            case "store":
                block[node.row] = arguments[0]
            case operation:
                values[node] = OPERATIONS[operation](*arguments)


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
    """An arm's programs and a block of lanes to run them on.

    Attributes:
        chain: the arm.
        frames: its link frames.
        programs: by name.
        block: (rows, lanes).
        rows: places in the block.
    """

    chain: ScrewChain
    frames: LinkFrames
    programs: dict[str, Program]
    block: np.ndarray
    rows: r.Rows

    def run(self, name: str) -> None:
        run_in_numpy(self.programs[name], self.block)

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
    frames = link_frames(chain.screws, chain.home)
    programs, count = arm_module.programs(frames, chain.lower, chain.upper, settings)
    block = np.zeros((count, r.LANES))
    return Bench(chain, frames, {p.name: p for p in programs}, block, r.Rows(chain.n))
