"""A round as run.json and the files beside it have it."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

import numpy as np

from drake_screw.acquisition import RoundFinished, Suggestion
from drake_screw.bandits import Verdict
from drake_screw.tasks import Regions

ARRAYS = ("samples", "failures", "lower", "upper")
"""Fields of a verdict that are arrays (K,)."""


def round_record(event: RoundFinished, regions: Regions) -> dict[str, Any]:
    """What run.json keeps of a round."""
    verdict = event.verdict
    fields = asdict(verdict)
    for name in ARRAYS:
        fields[name] = fields[name].tolist()
    return {
        "round": event.round + 1,
        "demonstrations": len(event.demonstrations),
        "samples": np.bincount(event.evaluation.region, minlength=regions.K).tolist(),
        "failure_rates": verdict.estimates.tolist(),
        "weakest_region": verdict.region,
        "certified": verdict.certified,
        "reason": verdict.reason,
        "next_demonstration": None
        if event.suggestion is None
        else suggestion_record(event.suggestion, regions),
        "verdict": fields,
    }


def suggestion_record(suggestion: Suggestion, regions: Regions) -> dict[str, Any]:
    """Where the next demonstration is asked for."""
    objects = zip(regions.area.objects, suggestion.x_y_yaw.tolist(), strict=True)
    return {
        "region": suggestion.region,
        "region_name": regions.name(suggestion.region),
        "objects": {o.name: {"x": x, "y": y, "yaw": yaw} for o, (x, y, yaw) in objects},
        "failed_segment": None if suggestion.segment is None else suggestion.segment + 1,
    }


def regions_csv(verdict: Verdict, regions: Regions) -> str:
    """The table of a round's regions: bounds in m and rad, counts, confidence bounds."""
    axes = [f"{o.name}_{a}" for o in regions.area.objects for a in ("x", "y", "yaw")]
    header = ["region", *(f"{a}_{end}" for a in axes for end in ("min", "max"))]
    rows = [",".join([*header, "samples", "failures", "failure_rate", "lower", "upper"])]
    for j in range(regions.K):
        lower, upper = regions.bounds(j)
        ends = np.stack([lower.ravel(), upper.ravel()], axis=1).ravel()
        numbers = [verdict.estimates[j], verdict.lower[j], verdict.upper[j]]
        rows.append(
            ",".join(
                [str(j), *(f"{e:.6g}" for e in ends)]
                + [str(verdict.samples[j]), str(verdict.failures[j])]
                + [f"{v:.6g}" for v in numbers]
            )
        )
    return "\n".join(rows) + "\n"
