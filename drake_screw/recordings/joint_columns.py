"""Which columns are the arm's joints: by name, by what their names have in common, or in order."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

from drake_screw.errors import RecordingError
from drake_screw.tables import Table

_NOT_ANGLES = re.compile(
    r"vel|speed|effort|torque|tau|current|target|desired|cmd|command|accel|error|temp|volt|"
    r"^qd|^dq|[^a-z]qd|[^a-z]dq|ddq|_d$|des_|moment|force|action"
)
"""In names of columns that are numbered like joints and are something else."""


@dataclass(frozen=True)
class Matched:
    """The columns of n joints, in the arm's order, and how they were found, in words."""

    columns: tuple[str, ...]
    how: str


def match_joints(
    table: Table, joints: Sequence[str], taken: Sequence[str], *, any_order: bool = True
) -> Matched | None:
    """The columns of the arm's joints.

    In this order: columns of their very names; of these names with something before or behind
    them, the same for all; numbered columns, as many as there are joints; as many other columns.

    Args:
        table: with the columns.
        joints: n names, in the arm's order.
        taken: columns that mean something else, such as time.
        any_order: whether columns in order will do.

    Returns:
        None where there are none.

    Raises:
        RecordingError: there are several ways.
    """
    names = [name for name in table.numeric if name not in taken]
    if set(joints) <= set(names):
        return Matched(tuple(joints), "by name")
    folded = {name.lower(): name for name in names}
    if all(joint.lower() in folded for joint in joints):
        return Matched(tuple(folded[j.lower()] for j in joints), "by name, but for capitals")
    for cores in (list(joints), _cores(joints)):
        found = _around(names, cores)
        if found:
            return _the_one(found, table, joints)
    found = _numbered(names, len(joints))
    if found:
        return _the_one(found, table, joints)
    if any_order and len(names) == len(joints) and not any(map(_is_other, names)):
        return Matched(tuple(names), "in order, the only columns but time")
    return None


def _the_one(found: Sequence[Matched], table: Table, joints: Sequence[str]) -> Matched:
    plain = [m for m in found if not any(map(_is_other, m.columns))]
    if len(plain) == 1:
        return plain[0]
    which = plain or found
    raise RecordingError(
        f"{len(which)} groups of columns could be the {len(joints)} joints: "
        + "; ".join(f"{m.columns[0]} .. {m.columns[-1]}" for m in which),
        remedy=f"Say which in recording.yaml: joints: [{', '.join(which[0].columns)}]",
        file=table.file,
        line=table.header,
    )


def _is_other(name: str) -> bool:
    return _NOT_ANGLES.search(name.lower()) is not None


def _cores(joints: Sequence[str]) -> list[str]:
    """The names without what all of them have in common."""
    before = _common(joints)
    behind = _common([name[before:][::-1] for name in joints])
    return [name[before : len(name) - behind] for name in joints]


def _common(names: Sequence[str]) -> int:
    """How many characters all of them begin with."""
    return next(
        (i for i, letters in enumerate(zip(*names, strict=False)) if len(set(letters)) > 1),
        min(map(len, names)),
    )


def _around(names: Sequence[str], cores: Sequence[str]) -> list[Matched]:
    """Groups of columns that are the cores with one and the same text around each."""
    if len(cores) < 2 or not all(cores):
        return []
    known = set(names)
    found: list[Matched] = []
    for name in names:
        for place in re.finditer(re.escape(cores[0]), name):
            before, behind = name[: place.start()], name[place.end() :]
            columns = tuple(f"{before}{core}{behind}" for core in cores)
            if set(columns) <= known and columns not in [m.columns for m in found]:
                around = [
                    f"'{before}' before" if before else "",
                    f"'{behind}' behind" if behind else "",
                ]
                said = " and ".join(filter(None, around)) or "short"
                found.append(Matched(columns, f"by name, {said}"))
    return found


def _numbered(names: Sequence[str], n: int) -> list[Matched]:
    """Groups of n columns that are numbered from 0 or 1, and have but that many."""
    groups: dict[tuple[str, str], dict[int, str]] = {}
    for name in names:
        for number in re.finditer(r"\d+", name):
            key = name[: number.start()], name[number.end() :]
            groups.setdefault(key, {})[int(number.group())] = name
    found = []
    for (before, behind), members in groups.items():
        for first in (0, 1):
            if sorted(members) == list(range(first, first + n)) and n > 1:
                columns = tuple(members[first + i] for i in range(n))
                pattern = f"{before}{first}{behind} .. {before}{first + n - 1}{behind}"
                found.append(Matched(columns, f"by number, {pattern}"))
    return found
