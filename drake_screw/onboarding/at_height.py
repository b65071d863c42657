"""Reach, start and work area of an arm at a table of one height."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from drake_screw.onboarding.area import (
    LARGEST,
    WANTED,
    Survey,
    Verified,
    farthest_corner,
    survey,
    verify,
)
from drake_screw.onboarding.hand_ik import Range
from drake_screw.onboarding.reach import HOLDS, ReachMap, reach_map
from drake_screw.onboarding.rectangles import Rectangle, best_rectangle
from drake_screw.onboarding.start import Start, starts
from drake_screw.onboarding.table import table_under
from drake_screw.onboarding.trial import Trial
from drake_screw.robot import ObjectConfig, RobotConfig, ScrewChain, TableConfig, build_workcell

BOWL = ObjectConfig("bowl", 0.08, 0.06)

SPACING = 0.05
"""m, of the places that are looked at."""

CLOSEST = 0.25
"""m, from the base's axis to the work area at least."""

COMFORTABLE = 0.62
"""Of the reach, where the middle of a work area is best."""

STARTS = 4
"""That are tried."""

ENOUGH = 0.85
"""Of the largest work area, with which the first start is taken that has it."""

NEARER = 0.1
"""m, by which a second demonstration is nearer than the farthest corner of what may be reached."""

Say = Callable[[str], None]


class NoArea(Exception):
    """There is no work area at a height.

    Attributes:
        top: m, the table's height.
        why: in words.
    """

    def __init__(self, top: float, why: str) -> None:
        super().__init__(top, why)
        self.top, self.why = top, why


@dataclass(frozen=True, eq=False)
class Place:
    """What was found at a height.

    Attributes:
        on_the_table: whether the robot stands on the table.
        table: under the work area.
        reach: shares of directions of approach that inverse kinematics finds.
        planned: places that are planned for from the start.
        start: configuration to start from.
        found: the work area that one demonstration covers.
    """

    on_the_table: bool
    table: TableConfig
    reach: ReachMap
    planned: Survey
    start: Start
    found: Verified


def at_height(
    bare: RobotConfig,
    chain: ScrewChain,
    within: Range,
    top: float,
    task: str,
    *,
    standing: bool,
    say: Say,
) -> Place:
    """Find where an arm works well at a table.

    Args:
        bare: the arm, its start left open.
        chain: the same arm.
        within: where configurations are looked for.
        top: m, the table's height.
        task: "pouring" or "scooping".
        standing: whether the robot is an arm on its foot, that may stand on the table.
        say: told of each step.

    Raises:
        NoArea: nowhere.
    """
    on_it = standing and abs(top) < 0.1
    say(f"table at {top:.2f} m; looking where the arm reaches")
    reach = _reach(chain, within, top, task)
    likely = _likely(reach, chain)
    if likely is None:
        raise NoArea(top, "no directions of approach work anywhere on the table")
    best = _best_start(bare, chain, within, reach, likely, top, on_it, task, say)
    if best is None:
        raise NoArea(top, "no start was found from which the teacher gets anywhere")
    start, planned = best
    begin = _largest(planned, chain)
    if begin is None:
        raise NoArea(top, "plans succeed nowhere on the table")
    table = table_under(begin, top, around_the_base=on_it)
    trial = _trial(bare, start, table, top, task)
    found = verify(trial, begin, chain.shoulder, _middle(chain), SPACING, say)
    if found is None:
        raise NoArea(top, "no area was found that one demonstration covers")
    table = table_under(found.area, top, around_the_base=on_it)
    return Place(on_it, table, reach, planned, start, found)


def _reach(chain: ScrewChain, within: Range, top: float, task: str) -> ReachMap:
    """On a grid before the shoulder, as far as the hand and what it holds get."""
    out = chain.reach + HOLDS[task].behind
    x0, y0 = chain.shoulder[0], chain.shoulder[1]
    x = np.arange(np.ceil((x0 + CLOSEST) / SPACING), np.floor((x0 + out) / SPACING) + 1) * SPACING
    y = np.arange(np.ceil((y0 - out) / SPACING), np.floor((y0 + out) / SPACING) + 1) * SPACING
    return reach_map(chain, within, np.round(x, 6), np.round(y, 6), top, HOLDS[task])


def _middle(chain: ScrewChain) -> tuple[float, float]:
    """x, y in m where a work area is best, as far as nothing else is against it."""
    return float(chain.shoulder[0] + COMFORTABLE * chain.reach), float(chain.shoulder[1])


def _likely(reach: ReachMap, chain: ScrewChain) -> Rectangle | None:
    """A first guess at the work area, from inverse kinematics alone."""
    for share in (0.6, 0.0):
        good = reach.share > share
        found = best_rectangle(reach.x, reach.y, good, most=LARGEST, middle=_middle(chain))
        if found is not None and found.size[0] >= WANTED[0] - 1e-9 and found.size[1] >= WANTED[1]:
            return found
    return found


def _trial(bare: RobotConfig, start: Start, table: TableConfig, top: float, task: str) -> Trial:
    workcell = build_workcell(replace(bare, start=start.q), table=table, objects=[BOWL])
    return Trial(workcell, task, top, free_axis=start.free_axis)


def _best_start(
    bare: RobotConfig,
    chain: ScrewChain,
    within: Range,
    reach: ReachMap,
    likely: Rectangle,
    top: float,
    on_it: bool,
    task: str,
    say: Say,
) -> tuple[Start, Survey] | None:
    """Of some starts the one from which one demonstration covers the largest rectangle."""
    table = table_under(likely, top, around_the_base=on_it)
    workcell = build_workcell(bare, table=table, objects=[BOWL])
    found = starts(workcell, chain, within, likely, top, STARTS, task)
    say(f"{len(found)} configurations to start from are tried")
    corner = farthest_corner(likely, chain.shoulder)
    best: tuple[float, Start, Survey] | None = None
    for number, start in enumerate(found):
        placed = replace(workcell, start=np.array(start.q))
        trial = Trial(placed, task, top, free_axis=start.free_axis)
        seen = survey(trial, reach.x, reach.y, np.array([corner]))
        size = _size(seen, chain)
        say(f"  start {number + 1}: one demonstration covers {size:.2f} m²")
        if best is None or size > 1.05 * best[0]:
            best = size, start, seen
        if size >= ENOUGH * LARGEST[0] * LARGEST[1]:
            return best[1:]
    if best is None:
        return None
    size, start, seen = best
    placed = replace(workcell, start=np.array(start.q))
    nearer = [[x, y] for x in (likely.x[1] - NEARER, sum(likely.x) / 2.0) for y in likely.y]
    trial = Trial(placed, task, top, free_axis=start.free_axis)
    again = survey(trial, reach.x, reach.y, np.array(nearer))
    return start, max(seen, again, key=lambda s: _size(s, chain))


def _size(seen: Survey, chain: ScrewChain) -> float:
    """m² of the largest rectangle that is covered."""
    covered = _largest(seen, chain)
    return 0.0 if covered is None else covered.area


def _largest(seen: Survey, chain: ScrewChain) -> Rectangle | None:
    return best_rectangle(seen.x, seen.y, seen.good, most=LARGEST, middle=_middle(chain))
