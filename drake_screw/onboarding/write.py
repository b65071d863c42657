"""A design as the text of a scenario, in which every assumption is said."""

from __future__ import annotations

import json
import os
import re
from pathlib import Path

from drake_screw.onboarding.at_height import BOWL
from drake_screw.onboarding.design import Design
from drake_screw.onboarding.table import LOW_SHOULDER, USUAL

WIDTH = 96


def scenario_text(design: Design, name: str, folder: Path, command: str) -> str:
    """The scenario.

    Args:
        design: what was found.
        name: of the scenario.
        folder: that it will be in; the model's path is relative to it where it is near.
        command: that it was written by.
    """
    arm, hand, found, table = design.arm, design.hand, design.found, design.table
    motion = "pours into" if design.task == "pouring" else "scoops from"
    lines = [
        f"# Written by: {command}",
        f"# A robot's arm {motion} a bowl that stands anywhere in the work area. What is below was",
        "# found from the model by sampling; every number may be changed. Then",
        "#   drake-screw check FILE      says what is wrong, and",
        "#   drake-screw run FILE        acquires demonstrations until all of the area is covered.",
        "# Lengths are in metres, angles in radians, seen from the robot's base, z up.",
        "# All keys: docs/scenario.md",
        "",
        f"name: {name}",
        f"description: {_quoted(f'{design.robot.file.stem} {motion} a bowl')}",
        "",
        "robot:",
        f"  model: {_quoted(model_path(design, folder))}",
        *_read_with(design, folder),
        *_arm_comment(design),
        *_wrapped(f"  joints: [{', '.join(map(_quoted, arm.joints))}]", 11),
        *_hand_comment(design),
        f"  end_effector: {_quoted(hand.frame)}",
    ]
    if hand.rotation is not None:
        lines.append(f"  end_effector_rotation: [{_numbers(hand.rotation)}]")
    lines += [
        "  # Every plan starts here: the hand level before the work area, "
        f"{design.start.margin:.2f} rad from the joints'",
        "  # limits at least, touching nothing. One value for each joint above.",
        *_wrapped(f"  start: [{_numbers(design.start.q)}]", 10),
        f"  base: {_quoted(arm.base)}",
        *_rest(design),
        *_touching(design),
        "",
        *_table_comment(design),
        "table:",
        f"  center: [{_numbers(table.center)}]",
        f"  size: [{_numbers(table.size)}]",
        f"  top: {_number(table.top)}",
        f"  thickness: {_number(table.thickness)}",
        "",
        "# Where the bowl may stand: the largest area found in which a simulated demonstration at",
        f"# the corner {found.corner[0]:.2f}, {found.corner[1]:.2f} covers {found.share:.1%} of "
        "it. The picture beside this file shows",
        "# what the arm reaches. A larger area takes more demonstrations, or is not certified.",
        "objects:",
        f"  - name: {BOWL.name}",
        f"    x: [{_numbers(found.area.x)}]",
        f"    y: [{_numbers(found.area.y)}]",
        "    yaw: 0",
        f"    z: {_number(table.top)}                   # height of its bottom: the table's top",
        f"    radius: {_number(BOWL.radius)}",
        f"    height: {_number(BOWL.height)}",
        "    symmetry: {axis: z, turns: any}  # a body of revolution: any side will do",
        "",
        "# The work area is measured region by region: cells along x and y.",
        "regions:",
        f"  grid: {{x: {_cells(found.area.size[0])}, y: {_cells(found.area.size[1])}}}",
        "",
        "# The run ends when each succeeds with probability beta at least, confidence 1 - delta.",
        "coverage:",
        "  beta: 0.95",
        "  epsilon: 0.02",
        "  delta: 0.05",
        "",
        "demonstrations:",
        "  initial: 1",
        "  first: farthest            # at the corner of the work area farthest from the shoulder",
        "  budget: 12                 # most demonstrations in total",
        "",
        "# The simulated teacher leads this very arm. For recordings of yours instead:",
        "#   kind: recorded",
        "#   folder: recordings",
        "teacher:",
        "  kind: simulated",
        f"  motion: {design.task}            # pouring or scooping",
        "",
        "planner:",
        *_free_axis(design),
        "  collision: true            # a plan fails along which the robot touches anything",
        *_unseen(design),
        "",
        "seed: 0                      # the same seed gives the same run",
    ]
    return "\n".join(lines) + "\n"


def assumptions(design: Design) -> list[str]:
    """What was assumed, a line each, and how to change it."""
    arm, hand, found = design.arm, design.hand, design.found
    why = f" ({design.why_this_arm})" if design.why_this_arm else ""
    others = ", ".join(other.name for other in design.arms if other is not arm)
    lines = [
        f"arm: {arm.name}, {len(arm.joints)} joints, {arm.joints[0]} ... {arm.joints[-1]}{why}"
        + (f"; --arm takes another: {others}" if others else "")
    ]
    if arm.held:
        lines.append(f"held: {', '.join(arm.held)} (robot.parked says where)")
    turned = f", turned by [{_numbers(hand.rotation)}]" if hand.rotation else ""
    lines.append(f"hand: '{hand.frame}'{turned}; z out of the hand by {hand.derived_from}")
    if design.touching:
        both = ", ".join(f"{a} and {b}" for a, b in design.touching[:3])
        more = f" and {len(design.touching) - 3} more pairs" if len(design.touching) > 3 else ""
        lines.append(f"touching: {both}{more} touch always; ignored (robot.ignore_collisions)")
    why_high = "as asked for" if design.height_given else _why_high(design)
    lines.append(f"table: top at {design.table.top:g} m, {why_high}; --table-height changes it")
    lines.append(
        f"start: {design.start.margin:.2f} rad from the limits, the hand level (robot.start)"
    )
    if (axis := design.start.free_axis) is not None:
        lines.append(
            f"free: the roll about the hand's axis [{_numbers(axis)}], for want of a sixth joint "
            "(planner.task, planner.free_axis)"
        )
    lines.append(
        f"work area: x {_range(found.area.x)} m, y {_range(found.area.y)} m; one simulated "
        f"demonstration covers {found.share:.1%} of it (objects.0.x and y)"
    )
    return [*lines, *(f"note: {remark}" for remark in design.remarks)]


def _free_axis(design: Design) -> list[str]:
    axis = design.start.free_axis
    if axis is None:
        return []
    return [
        "  # Five joints cannot give the hand all six motions: its position and one axis of it are",
        "  # followed, and the roll about that axis is whatever the joints make of it. The axis is",
        f"  # the one that this arm follows best while {design.task}, in the end effector's frame;",
        "  # x, y or z may be written as well. Not followed is how the hand turns about it.",
        "  task: position_and_axis",
        f"  free_axis: [{_numbers(axis)}]",
    ]


def scenario_name(robot: str) -> str:
    """A scenario's name from a model's: letters, digits, - and _."""
    return re.sub(r"[^A-Za-z0-9_-]+", "_", robot).strip("_-") or "robot"


def model_path(design: Design, folder: Path) -> str:
    """How the scenario names its model: as it is shipped, or by a path from the folder."""
    if "://" in design.robot.given.model:
        return design.robot.given.model
    if os.sep not in design.robot.given.model and not Path(design.robot.given.model).is_file():
        return design.robot.given.model
    return _near(design.robot.file, folder)


def _near(file: Path, folder: Path) -> str:
    """A path from the folder, or in full where that is far."""
    relative = os.path.relpath(file.resolve(), folder.resolve())
    far = relative.startswith(os.path.join("..", "..", ".."))
    return str(file.resolve()) if far else relative


def _read_with(design: Design, folder: Path) -> list[str]:
    """Packages, arguments of xacro and SRDF, as far as they were given."""
    given, lines = design.robot.given, []
    if given.packages:
        where = (f"{_quoted(k)}: {_quoted(_near(v, folder))}" for k, v in given.packages.items())
        lines += _wrapped(f"  packages: {{{', '.join(where)}}}", 13)
    if given.xacro:
        values = (f"{_quoted(k)}: {json.dumps(v)}" for k, v in given.xacro.items())
        lines += _wrapped(f"  xacro: {{{', '.join(values)}}}", 10)
    if given.srdf is not None:
        address = given.srdf if "://" in given.srdf else _near(Path(given.srdf), folder)
        lines.append(f"  srdf: {_quoted(address)}")
    return lines


def _unseen(design: Design) -> list[str]:
    if not design.unseen:
        return []
    return [
        "  # Without this a run is refused: collision shapes cannot be had; it is not looked at",
        f"  # what would touch them ({len(design.unseen)}; drake-screw check names them).",
        "  incomplete_shapes: true",
    ]


def _arm_comment(design: Design) -> list[str]:
    arm = design.arm
    text = [f"  # Arm '{arm.name}', base to hand."]
    if design.why_this_arm:
        text.append(f"  # It is {design.why_this_arm}; for another one: --arm.")
    if arm.held:
        text.append(f"  # Left out, held where `parked` says: {', '.join(arm.held)}.")
    if arm.remark:
        text.append(f"  # Note: {arm.remark}.")
    return text


def _hand_comment(design: Design) -> list[str]:
    text = [
        "  # The frame that demonstrations move; its z axis has to point out of the hand, which is"
    ]
    told = f"  # {design.hand.derived_from}"
    if design.hand.rotation is None:
        return [*text, f"{told}."]
    return [*text, f"{told}: it is turned there by roll, pitch and yaw."]


def _rest(design: Design) -> list[str]:
    if not design.rest:
        return []
    entries = ", ".join(f"{_quoted(k)}: {_number(v)}" for k, v in design.rest.items())
    return [
        "  # Where other joints rest: fingers open, other arms out of the way, all else as in the",
        "  # model.",
        *_wrapped(f"  parked: {{{entries}}}", 11),
    ]


def _touching(design: Design) -> list[str]:
    if not design.touching:
        return []
    pairs = ", ".join(f"[{_quoted(a)}, {_quoted(b)}]" for a, b in design.touching)
    return [
        "  # Links that touch wherever the arm is, as their shapes are drawn: it is not looked at",
        "  # whether they do.",
        *_wrapped(f"  ignore_collisions: [{pairs}]", 22),
    ]


def _table_comment(design: Design) -> list[str]:
    why = "it was asked for" if design.height_given else _why_high(design)
    return [
        "# A box that the arm must not touch. It is as high as it is because",
        f"# {why}.",
        "# For another height: --table-height.",
    ]


def _why_high(design: Design) -> str:
    if design.on_the_table:
        return f"the robot stands on it (its shoulder is no higher than {LOW_SHOULDER:g} m)"
    where = f"of those heights about {USUAL:g} m below the shoulder that have a work area"
    return f"the arm reaches most there, {where}"


def _cells(size: float) -> int:
    return max(1, min(4, round(size / 0.1)))


def _numbers(values: object) -> str:
    return ", ".join(_number(v) for v in values)  # type: ignore[attr-defined]


def _number(value: float) -> str:
    return f"{round(float(value), 5) + 0.0:g}" if float(value) else "0.0"


def _range(interval: tuple[float, float]) -> str:
    return "..".join(map(_number, interval))


def _quoted(text: str) -> str:
    """A text as YAML has it, in quotation marks only where it needs them."""
    plain = re.fullmatch(r"[A-Za-z_/][\w./ -]*", text) and not re.fullmatch(
        r"(?i)y|n|yes|no|on|off|true|false|null", text
    )
    return text if plain and " #" not in text else json.dumps(text)


def _wrapped(text: str, indent: int) -> list[str]:
    """A flow list or mapping on lines that are not too long."""
    lines, line = [], ""
    for part in re.split(r"(?<=,) ", text):
        if line and len(line) + len(part) + 1 > WIDTH:
            lines.append(line)
            line = " " * indent + part
        else:
            line = f"{line} {part}" if line else part
    return [*lines, line]
