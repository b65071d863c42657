"""The reference page of scenario files, written from the schema so that the two cannot differ.

``python -m drake_screw.scenario.reference_page > docs/scenario.md`` writes it.
"""

from __future__ import annotations

import inspect
import re
import sys
import textwrap
from collections.abc import Iterator
from typing import Any, NamedTuple

from drake_screw.plugins import BUILT_IN, find
from drake_screw.scenario.json_schema import (
    Schema,
    alternatives,
    describe,
    json_schema,
    limits,
    resolved,
)

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
<!-- Do not edit. Written from the schema in drake_screw/scenario by:
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
[scooping](../scenarios/scooping.yaml), explain every key; `drake-screw init` writes a copy to start
from. [pouring_paper](../scenarios/pouring_paper.yaml) and
[scooping_paper](../scenarios/scooping_paper.yaml) read the tasks as the paper does, whatever
becomes of the defaults.

- Lengths are in metres, angles in radians, both up to 1,000. The world's frame is the frame
  `robot.base`, z up.
- A path in the file is relative to the file; `~` is your home folder.
- An empty value stands for an empty mapping, and `null` for "none" where that is the default.
- A key that is not listed here is an error, and so is a value of another type or out of its limits.
  The message names file, line and key, what was expected, and the nearest valid key; where several
  things are wrong it lists them all.
- On the command line `--set key.path=value` replaces one value: `--set coverage.beta=0.9`. Entries
  of lists are counted from 0: `--set objects.0.x=0.9`. The value is YAML; paths in it are relative
  to the folder you are in.
- Editors that know YAML by JSON Schema complete and check the keys of a file whose first line is
  `# yaml-language-server: $schema=` and the path of
  [scenario.schema.json](../scenarios/scenario.schema.json), as in the shipped scenarios.
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
- `robot` has either `joints`, `end_effector` and `start` (and perhaps `end_effector_rotation` and
  `tool`), or `arms`, each of which has its own. Names of arms differ, they share no joint, and
  nothing of the robot touches itself where all of them are at their starts.
- `regions` has either `grid` or `adaptive`. An axis whose range is a single value cannot be
  divided.
- With `regions.adaptive`, `coverage.strategy` is not used and `coverage.options` must be empty.
- `coverage.success: execution` needs `planner.collision`, and objects that stand on something.
- `coverage.epsilon` is below 1 - `coverage.beta`, or no run could end with a certificate.
- `demonstrations.budget` is at least the number of initial demonstrations.
- A `simulated` teacher needs `motion` and has no `folder`; a `recorded` one needs `folder` and has
  no `motion`; an `interactive` one may have a `folder` and has no `motion`.
- `demonstrations.first` says nothing where `demonstrations.initial` is 0 or a list of recordings;
  `teacher.choose` is for a `recorded` teacher.
- `teacher.kind`, `teacher.motion`, `coverage.strategy` and `demonstrations.ask` may also name a
  part of your own, as `package.module:Object`, or one that an installed package declares as an
  entry point. Only such a teacher may have further keys: it is given them as options, texts as they
  are written.
- `robot.tool.shape` and every obstacle have one shape: `box`, `cylinder`, `sphere` or `mesh`;
  `scale` is for a mesh. At the start nothing touches the tool, and no obstacle the robot.
- Names of objects and obstacles differ, also from the table and from the robot's links, frames and
  joints; the ranges of a yaw and a roll are no wider than a full turn, a pitch is between -pi/2
  and pi/2; the work area is within reach of the arm.
- With `orientation: any` an object has no `roll`, `pitch` and `yaw`. What objects stand on (`on`)
  leads to the world.
- `apart` needs two objects and a grid, and some room in each of its regions.
"""


class _Block(NamedTuple):
    """A block of the file: the keys that lead to it, its schema, and whether it is a list's."""

    path: str
    schema: Schema
    several: bool


def reference_page() -> str:
    """The whole page, in Markdown."""
    top = _Block("", json_schema(), False)
    parts = [_INTRODUCTION.format(minimal=MINIMAL, command=COMMAND)]
    parts += ["## The file\n", _table(top)]
    for block in _blocks(top):
        parts += [f"## {block.path}\n", _lead(block), _table(block)]
    parts += [_options(), _RULES]
    return "\n".join(parts)


def _blocks(block: _Block) -> Iterator[_Block]:
    """The blocks inside a block, each before the blocks inside it."""
    for name in block.schema["properties"]:
        inner = _inner(block, name)
        if inner is not None:
            yield inner
            yield from _blocks(inner)


def _inner(block: _Block, name: str) -> _Block | None:
    """The block under a key, or each one of the list there."""
    key = resolved(block.schema["properties"][name])
    several = key.get("type") == "array" and "items" in key
    schema = {**resolved(key["items"]), "description": key["description"]} if several else key
    path = f"{block.path}.{name}" if block.path else name
    return _Block(path, schema, several) if "properties" in schema else None


def _lead(block: _Block) -> str:
    meaning = block.schema["description"]
    text = f"{meaning[:1].upper()}{meaning[1:]}."
    if block.several:
        text += " A list; each entry is a mapping with these keys."
    return textwrap.fill(text, 100) + "\n"


def _table(block: _Block) -> str:
    rows = ["| key | type | unit | default | limits | meaning |", "|---|---|---|---|---|---|"]
    rows += [_row(block, name) for name in block.schema["properties"]]
    return "\n".join(rows) + "\n"


def _row(block: _Block, name: str) -> str:
    key, inner = block.schema["properties"][name], _inner(block, name)
    kind = describe(key)
    if inner is not None:
        what = "a list of mappings" if inner.several else "a mapping"
        kind = f"{what}, see [{inner.path}](#{inner.path.replace('.', '')})"
    default = "*required*"
    if name not in block.schema.get("required", ()):
        default = "each key's own" if inner and key["default"] else _value(key["default"])
    cells = [f"`{name}`", kind, key.get("unit", ""), default, _limits(key), key["description"]]
    return "| " + " | ".join(cell.replace("|", "\\|").replace("<", "\\<") for cell in cells) + " |"


def _value(value: Any) -> str:
    if value is None:
        return "none"
    if isinstance(value, bool):
        return f"`{str(value).lower()}`"
    if isinstance(value, float):
        return f"`{value:.12g}`"
    return "empty" if value == "" else f"`{value}`"


def _limits(schema: Schema) -> str:
    if "pattern" in schema:
        return "letters, digits, `-`, `_`"
    return ", ".join([f"`{name}`" for name in _names(schema)] or limits(schema))


def _names(schema: Schema) -> list[str]:
    """The names of parts that are built in, of which a value may be one."""
    return [*schema.get("enum", ()), *(n for s in alternatives(schema) for n in _names(s))]


def _options() -> str:
    """The options of every strategy, as their classes have them."""
    rows = ["| strategy | option | default | meaning |", "|---|---|---|---|"]
    for name in BUILT_IN["strategies"]:
        strategy = find("strategies", name)
        meanings = _arguments(strategy)
        for option in inspect.signature(strategy).parameters.values():
            if option.name != "goal":
                cells = (
                    f"`{name}`",
                    f"`{option.name}`",
                    _value(option.default),
                    meanings[option.name],
                )
                rows.append(f"| {' | '.join(cells)} |")
    return "\n".join(["## Options of the strategies\n", _OPTIONS, *rows, ""])


def _arguments(kind: Any) -> dict[str, str]:
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
