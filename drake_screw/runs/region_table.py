"""The table of a round's regions."""

from __future__ import annotations

import numpy as np

from drake_screw.bandits import Verdict
from drake_screw.files import csv_text
from drake_screw.tasks import Regions, column_names


def regions_csv(verdict: Verdict, regions: Regions) -> str:
    """A row for each region of a round: its range in m and rad, counts, confidence bounds."""
    area = regions.area
    ends = [f"{axis}_{end}" for axis in column_names(area) for end in ("min", "max")]
    rows: list[list[object]] = [
        ["region", *ends, "samples", "failures", "failure_rate", "lower", "upper"]
    ]
    rates = np.stack([verdict.estimates, verdict.lower, verdict.upper], axis=1)
    for j in range(regions.K):
        corners = np.stack(regions.bounds(j), axis=-1)
        rows.append(
            [
                j,
                *(f"{v:.6g}" for i, j in area.columns for v in corners[i, j]),
                verdict.samples[j],
                verdict.failures[j],
                *(f"{v:.6g}" for v in rates[j]),
            ]
        )
    return csv_text(rows)
