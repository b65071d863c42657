"""The table of a round, as the terminal shows it."""

from __future__ import annotations

import numpy as np
import pytest
from rich.console import Console

from drake_screw.bandits import Verdict
from drake_screw.commands.console import round_table
from drake_screw.tasks import ObjectArea, WorkArea, grid_regions

AREA = WorkArea((ObjectArea("bowl", (0.6, 0.0, 0.0), (0.8, 0.2, 0.0), z=0.0),))


def verdict(failures: list[int]) -> Verdict:
    rates = np.array(failures) / 90
    return Verdict(
        certified=not any(failures),
        region=int(np.argmax(failures)),
        reason="",
        claim="",
        samples=np.full(len(failures), 90),
        failures=np.array(failures),
        lower=rates,
        upper=rates,
        level=0.95,
        simultaneous=False,
        gap=None,
        coverage=0.0,
        attempted=True,
        looks=1,
    )


@pytest.mark.parametrize(("failures", "marked"), [([0, 7], 1), ([0, 0], None)])
def test_the_weakest_region_is_marked_where_any_instance_fails(
    failures: list[int], marked: int | None
) -> None:
    console = Console(width=100)
    with console.capture() as shown:
        console.print(round_table(verdict(failures), grid_regions(AREA, {"x": 2})))
    rows = [line for line in shown.get().splitlines() if "x 0." in line]
    assert len(rows) == len(failures)
    assert [j for j, row in enumerate(rows) if row.rstrip().endswith("<")] == (
        [] if marked is None else [marked]
    )
