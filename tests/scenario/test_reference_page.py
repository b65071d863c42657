"""The reference of scenario files says what the schema says."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import get_args

import pytest

from drake_screw.assembly.setup import Setup
from drake_screw.errors import ScenarioError
from drake_screw.scenario.block import Block
from drake_screw.scenario.loader import load_scenario
from drake_screw.scenario.reference_page import COMMAND, MINIMAL, reference_page
from drake_screw.scenario.schema import Scenario

PAGE = Path(__file__).parents[2] / "docs" / "scenario.md"


def keys(block: type[Block], path: str = "") -> Iterator[tuple[str, str]]:
    """Heading and key of everything a scenario may hold, by a walk of the schema's own."""
    for name, field in block.model_fields.items():
        yield path, name
        for kind in (field.annotation, *get_args(field.annotation)):
            if isinstance(kind, type) and issubclass(kind, Block):
                yield from keys(kind, f"{path}.{name}".lstrip("."))


def section(heading: str) -> str:
    return reference_page().split(f"\n## {heading or 'The file'}\n")[1].split("\n## ")[0]


def test_the_page_in_docs_is_the_one_the_schema_gives() -> None:
    assert PAGE.read_text() == reference_page(), f"docs/scenario.md is stale; run: {COMMAND}"


@pytest.mark.parametrize(("heading", "name"), list(keys(Scenario)))
def test_every_key_has_a_line_in_the_section_of_its_block(heading: str, name: str) -> None:
    lines = [line for line in section(heading).splitlines() if line.startswith(f"| `{name}` |")]
    assert len(lines) == 1
    unit_to_meaning = lines[0].replace("\\|", "").split("|")[2:-1]
    assert len(unit_to_meaning) == 5
    assert unit_to_meaning[-1].strip()


def test_units_defaults_and_limits_are_told() -> None:
    row = next(line for line in section("table").splitlines() if "`thickness`" in line)
    assert row.startswith("| `thickness` | a number | m | `0.04` | above 0 |")
    row = next(line for line in section("segmentation").splitlines() if "`spacing`" in line)
    assert row.startswith("| `spacing` | a number | m | none | above 0 |")
    assert "0.004 where faithful, 0.005 where published" in row
    row = next(line for line in section("robot").splitlines() if "`joints`" in line)
    assert row.startswith("| `joints` | a list of texts |  | none |")
    row = next(line for line in section("coverage").splitlines() if "`strategy`" in line)
    assert "`naive_pac`, `clopper_pearson`" in row


def test_options_are_those_of_the_strategies() -> None:
    options = section("Options of the strategies")
    assert "| `eprocess` | `rank_budget` | `4096` | samples to spend" in options
    assert "| `naive_pac` | `spend` | `false` |" in options
    assert "| `ucb` | `spend` | `true` | share delta out" in options


def test_the_smallest_scenario_is_usable_and_nothing_can_be_left_out(tmp_path: Path) -> None:
    file = tmp_path / "my_pouring.yaml"
    assert f"```yaml\n{MINIMAL}```" in PAGE.read_text()
    file.write_text(MINIMAL)
    setup = Setup(load_scenario(file))
    assert setup.workcell.arm.n == 7
    assert setup.regions.K == 16
    for line in MINIMAL.splitlines():
        key = line.split(":")[0]
        if not key.startswith((" ", "-")):
            start = MINIMAL.index(line)
            rest = MINIMAL[start + len(line) :].split("\n")
            inside = next(i for i, text in enumerate(rest[1:], 1) if not text.startswith(" "))
            file.write_text(MINIMAL[:start] + "\n".join(rest[inside:]))
            with pytest.raises(ScenarioError, match=f"{key}: missing"):
                load_scenario(file)
