"""What few regions hide: demonstrations certified with the least K, seen with the greatest."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from drake_screw.acquisition import Evaluation, RoundFinished
from drake_screw.bandits import Verdict, coverage_bound
from drake_screw.bandits.mixture import confidence_interval
from drake_screw.demonstrations import Demonstration
from drake_screw.errors import confidence, counted, rounded_down
from drake_screw.studies.experiment import Experiment, StudyRun, run_seed, split
from drake_screw.studies.figures import save_comparison
from drake_screw.tasks import GridRegions, draw_in_all
from drake_screw.visualization.outlines import outlines

MOST_RUNS = 20
EACH = 1024
"""Instances drawn in each of the greatest K regions."""


@dataclass(frozen=True, eq=False)
class HiddenFailure:
    """One certified run, and how its demonstrations do in smaller regions.

    Attributes:
        coarse: its last round, in `coarse_regions`.
        fine: an evaluation of the same demonstrations, with equally many instances in each of
            `fine_regions`.
    """

    coarse: RoundFinished
    coarse_regions: GridRegions
    fine: RoundFinished
    fine_regions: GridRegions

    @property
    def worst(self) -> float:
        """Largest failure rate among the fine regions."""
        return float(self.fine.verdict.estimates.max())


def find_hidden_failures(
    experiment: Experiment, runs: Sequence[StudyRun]
) -> tuple[HiddenFailure, ...]:
    """The first certified runs of the least K, evaluated with the greatest, the mildest first."""
    least, greatest = min(run.K for run in runs), max(run.K for run in runs)
    chosen = [run for run in runs if run.certified and least >= run.K][:MOST_RUNS]
    if least == greatest:
        return ()
    found = [_seen_closely(experiment, run, greatest) for run in chosen]
    return tuple(sorted(found, key=lambda one: one.worst))


def draw_hidden_failure(experiment: Experiment, runs: Sequence[StudyRun], stem: Path) -> None:
    """Draw the worst of `find_hidden_failures`, if any, as ``<stem>.png`` and ``<stem>.svg``.

    The picture says in how many of those runs a region fails more often than 1 - beta, and how
    often it fails in the middle one.
    """
    found = find_hidden_failures(experiment, runs)
    if not found:
        return
    setup = experiment.setup
    hidden = sum(one.worst > setup.goal.tau for one in found)
    middle, shown = found[len(found) // 2], found[-1]
    K = shown.coarse_regions.K, shown.fine_regions.K
    note = (
        f"{hidden} of {counted(len(found), 'run')} certified with K = {K[0]} leave a region of "
        f"K = {K[1]} that fails more than {setup.goal.tau:.0%} of the time. The worst such region "
        f"is shown; in the middle one of these runs it fails {middle.worst:.0%}."
    )
    save_comparison(
        (shown.coarse, shown.fine),
        (shown.coarse_regions, shown.fine_regions),
        stem,
        scenario=setup.scenario.name,
        note=note,
        things=outlines(setup.obstacles),
    )


def _seen_closely(experiment: Experiment, run: StudyRun, K: int) -> HiddenFailure:
    setup = experiment.setup
    rounds = [e for e in experiment.events(run.K, run.run) if isinstance(e, RoundFinished)]
    last = rounds[-1]
    regions = split(setup.area, K)
    seed = run_seed(setup.scenario.seed, 0, run.run)
    return HiddenFailure(
        last,
        split(setup.area, run.K),
        evenly(experiment, last.demonstrations, regions, seed),
        regions,
    )


def evenly(
    experiment: Experiment,
    demonstrations: tuple[Demonstration, ...],
    regions: GridRegions,
    seed: int,
) -> RoundFinished:
    """A round that draws equally many instances in every region and names the one that fails most.

    It certifies what those show by the e-processes of `bandits.mixture`.
    """
    setup, K = experiment.setup, regions.K
    coordinates, region = draw_in_all(regions, EACH, seed=seed, round=0)
    outcomes = setup.planner.any_success(demonstrations, setup.area.X_WO(coordinates), setup.start)
    evaluation = Evaluation(coordinates, region, outcomes)
    samples = np.full(K, EACH)
    failures = np.bincount(region[evaluation.failed], minlength=K)
    delta = setup.goal.delta
    coverage = coverage_bound(samples, failures, delta)
    lower, upper = confidence_interval(samples, failures, float(np.log(K / delta)))
    verdict = Verdict(
        certified=coverage >= setup.goal.beta,
        region=int(np.argmax(failures)),
        reason=f"{EACH:,} instances in every region",
        claim=f"every region succeeds at least {rounded_down(coverage)} of the time "
        f"(confidence {confidence(1.0 - delta)})",
        samples=samples,
        failures=failures,
        lower=lower,
        upper=upper,
        level=1.0 - delta,
        simultaneous=True,
        gap=None,
        coverage=coverage,
        attempted=True,
        looks=1,
    )
    return RoundFinished(0, demonstrations, evaluation, verdict, None, regions)
