"""The reference page of scenario files, written from the schema so that the two cannot differ.

``python -m drake_screw.scenario.reference_page > docs/scenario.md`` writes it anew.
"""

from __future__ import annotations

import inspect
import math
import re
import sys
import textwrap
from collections.abc import Iterator, Mapping
from dataclasses import MISSING, Field, fields, is_dataclass
from types import NoneType
from typing import Any, NamedTuple, get_args, get_origin, get_type_hints

from drake_screw.bandits import STRATEGIES, Goal, make_strategy
from drake_screw.scenario.convert import describe
from drake_screw.scenario.schema import NAME_PATTERN, CoverageBlock, Interval, Scenario

COMMAND = "python -m drake_screw.scenario.reference_page > docs/scenario.md"

MINIMAL = """\
name: my_pouring
robot:
  model: baxter
  joints: [left_s0, left_s1, left_e0, left_e1, left_w0, left_w1, left_w2]
  end_effector: left_hand
  start: [1.043, -0.220, -0.747, 1.524, 1.882, -0.969, -0.491]
objects:
  - {name: bowl, x: [0.71, 1.08], y: [-0.24, 0.78], z: -0.064, radius: 0.08, height: 0.06}
regions:
  grid: {x: 4, y: 4}
teacher: {kind: simulated, motion: pouring}
"""
"""A scenario file with nothing but what every one must have."""

_INTRODUCTION = """\
<!-- Do not edit. Written from drake_screw/scenario/schema.py by:
     {command} -->
# Scenario files

A scenario says what a run is about, in YAML: the arm, where the objects may lie, how the work area
is divided, what must be shown, and who demonstrates. This page is written from the schema that
reads the files, so every key there is stands here.

The smallest file that runs has just the keys without a default:

```yaml
{minimal}```

Save it as `my_pouring.yaml`, look at it with `drake-screw check my_pouring.yaml`, and run it with
`drake-screw run my_pouring.yaml`. The shipped scenarios, [pouring](../scenarios/pouring.yaml) and
[scooping](../scenarios/scooping.yaml), have comments and are good to start from.

- Lengths are in metres, angles in radians. The world's frame is the frame `robot.base`, z up.
- A path in the file is relative to the file; `~` is your home folder.
- An empty value stands for an empty mapping, and `null` for "none" where that is the default.
- A key that is not listed here is an error, and so is a value of another type or out of its limits.
  The message names file, line and key, what was expected, and the nearest valid key; where several
  things are wrong it lists them all.
- On the command line `--set key.path=value` replaces one value: `--set coverage.beta=0.9`. Entries
  of lists are counted from 0: `--set objects.0.x=0.9`. The value is YAML; paths in it are relative
  to the folder you are in.
- A run keeps its scenario with every key written out, in `scenario.yaml` of the
  [run directory](file_formats.md#run-directory).

In the tables, *required* means that there is no default.
"""

_OPTIONS = """\
Keys of `coverage.options`. What the strategies promise and what they cost is in
[guarantees.md](guarantees.md) and [statistics.md](statistics.md). None and False are Python's: in a
file write `false`, and leave an option out for its default.
"""

_RULES = """\
## Rules about several keys

- `robot.start` has one value for each joint and lies strictly inside the model's joint limits.
- In `robot`, and likewise in `recorded_on`, no joint is named twice, and none of the arm's joints
  is in `parked`.
- `regions` has either `grid` or `adaptive`. An axis whose range is a single value cannot be
  divided.
- With `regions.adaptive`, `coverage.strategy` is not used and `coverage.options` must be empty.
- `coverage.epsilon` is below 1 - `coverage.beta`, or no run could end with a certificate.
- `demonstrations.budget` is at least the number of initial demonstrations.
- A `simulated` teacher needs `motion` and has no `folder`; a `recorded` one needs `folder` and has
  no `motion`; an `interactive` one may have a `folder` and has no `motion`.
- Object names differ; the range of a yaw is no wider than a full turn; the work area is within
  reach of the arm.
"""


class _Block(NamedTuple):
    """A block of the file: its dataclass, the keys that lead to it, and what it is."""

    kind: type
    path: str
    meaning: str
    several: bool
    optional: bool


def reference_page() -> str:
    """The whole page, in Markdown."""
    top = _Block(Scenario, "", "", False, False)
    parts = [_INTRODUCTION.format(minimal=MINIMAL, command=COMMAND)]
    parts += ["## The file\n", _table(top)]
    for block in _blocks(top):
        parts += [f"## {block.path}\n", _lead(block), _table(block)]
    parts += [_options(), _RULES]
    return "\n".join(parts)


def _blocks(block: _Block) -> Iterator[_Block]:
    """The blocks inside a block, each before the blocks inside it."""
    for item, hint in _keys(block.kind):
        kinds, several = _inner(hint)
        for kind in kinds:
            path = f"{block.path}.{item.name}" if block.path else item.name
            inner = _Block(kind, path, item.metadata["meaning"], several, _optional(hint))
            yield inner
            yield from _blocks(inner)


def _inner(hint: Any) -> tuple[list[type], bool]:
    """The blocks that a key's type names, and whether it is a list of them."""
    several = get_origin(hint) is tuple
    kinds = [kind for kind in (hint, *get_args(hint)) if is_dataclass(kind) and kind != Interval]
    return [kind for kind in kinds if isinstance(kind, type)], several


def _optional(hint: Any) -> bool:
    return NoneType in get_args(hint)


def _keys(kind: type) -> list[tuple[Field[Any], Any]]:
    hints = get_type_hints(kind)
    return [(f, hints[f.name]) for f in fields(kind) if "meaning" in f.metadata]


def _lead(block: _Block) -> str:
    text = f"{block.meaning[:1].upper()}{block.meaning[1:]}."
    if block.several:
        text += " A list; each entry is a mapping with these keys."
    return textwrap.fill(text, 100) + "\n"


def _table(block: _Block) -> str:
    rows = ["| key | type | unit | default | limits | meaning |", "|---|---|---|---|---|---|"]
    rows += [_row(block, item, hint) for item, hint in _keys(block.kind)]
    return "\n".join(rows) + "\n"


def _row(block: _Block, item: Field[Any], hint: Any) -> str:
    kinds, several = _inner(hint)
    if kinds:
        path = f"{block.path}.{item.name}" if block.path else item.name
        what = "a list of mappings" if several else "a mapping"
        kind = f"{what}, see [{path}](#{path.replace('.', '')})"
    else:
        kind = describe(hint)
    cells = [
        f"`{item.name}`",
        kind,
        item.metadata["unit"],
        _default(item),
        _limits(item.metadata),
        item.metadata["meaning"],
    ]
    return "| " + " | ".join(cell.replace("|", "\\|").replace("<", "\\<") for cell in cells) + " |"


def _default(item: Field[Any]) -> str:
    if item.default_factory is not MISSING:
        return _value(item.default_factory())
    return "*required*" if item.default is MISSING else _value(item.default)


def _value(value: Any) -> str:
    if value is None:
        return "none"
    if is_dataclass(value) and not isinstance(value, Interval):
        return "each key's own"
    if isinstance(value, Interval):
        return f"`{value.lower:g}`" if value.fixed else f"`[{value.lower:g}, {value.upper:g}]`"
    if isinstance(value, bool):
        return f"`{str(value).lower()}`"
    if isinstance(value, float):
        return f"`{value!r}`"
    if value == "":
        return "empty"
    if value in ({}, ()):
        return "`{}`" if value == {} else "`[]`"
    return f"`{value}`"


def _limits(rules: Mapping[str, Any]) -> str:
    if rules["choices"]:
        return ", ".join(f"`{choice}`" for choice in rules["choices"])
    if rules["pattern"]:
        named = rules["pattern"] == NAME_PATTERN
        return "letters, digits, `-`, `_`" if named else f"`{rules['pattern']}`"
    words = (("above", "above"), ("at_least", "at least"), ("below", "below"))
    return ", ".join(
        f"{word} {rules[name]:g}" for name, word in words if math.isfinite(rules[name])
    )


def _options() -> str:
    """The options of every strategy, as their classes have them."""
    block = CoverageBlock()
    goal = Goal(block.beta, block.epsilon, block.delta)
    rows = ["| strategy | option | default | meaning |", "|---|---|---|---|"]
    for name in STRATEGIES:
        strategy = make_strategy(name, goal)
        meanings = _arguments(type(strategy))
        for item in fields(strategy):  # type: ignore[arg-type]
            if item.name != "goal":
                cells = f"`{name}`", f"`{item.name}`", _value(item.default), meanings[item.name]
                rows.append(f"| {' | '.join(cells)} |")
    return "\n".join(["## Options of the strategies\n", _OPTIONS, *rows, ""])


def _arguments(kind: type) -> dict[str, str]:
    """What the docstrings of a class and its bases say of its arguments."""
    found: dict[str, str] = {}
    for base in reversed(kind.__mro__):
        _, _, arguments = inspect.cleandoc(base.__doc__ or "").partition("Args:\n")
        for entry in re.split(r"\n(?= {4}\w)", "\n" + arguments.partition("\n\n")[0]):
            name, colon, text = entry.strip().partition(": ")
            if colon:
                found[name] = " ".join(text.split()).rstrip(".")
    return found


def main() -> None:
    """Print the page."""
    sys.stdout.write(reference_page())


if __name__ == "__main__":
    main()
