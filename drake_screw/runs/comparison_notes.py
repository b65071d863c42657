"""What cannot be compared between runs, or only with care, in words."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from drake_screw.acquisition import RoundFinished
from drake_screw.errors import listed
from drake_screw.runs.common_regions import RegionTable
from drake_screw.runs.shared_instances import SharedInstances
from drake_screw.scenario.differences import Difference

_SUCCESS = (
    "success",
    "execution",
    "collisions_checked",
    "clearance",
    "joint_margin",
    "slide_margin",
    "arms",
    "incomplete_shapes",
    "ignored_collisions",
    "tool_touches",
    "approach",
    "led_around",
    "freedoms",
    "free_roll",
)
"""Entries of certificates that say what succeeding is."""
_CLAIM = ("beta", "epsilon", "delta", "strategy", "guarantee", "confidence_holds_for")
"""Entries that say what was to be shown, how surely, and by which promise."""


def notes(
    runs: Sequence[int],
    rounds: Mapping[int, RoundFinished],
    by_area: Sequence[Sequence[int]],
    tables: Sequence[RegionTable],
    shared: Sequence[SharedInstances],
    certificates: Sequence[Difference],
) -> tuple[str, ...]:
    """Sentences for whoever compares runs.

    Args:
        runs: their numbers.
        rounds: the last round of each, where there is one.
        by_area: those of the same work area together.
        tables: of runs that have the same regions.
        shared: what runs have drawn together.
        certificates: entries in which these differ.
    """
    return (
        *_of_rounds([number for number in runs if number not in rounds]),
        *_of_areas(by_area),
        *_of_regions(rounds, tables),
        *_of_certificates(certificates),
        *_of_instances(shared),
    )


def _of_rounds(without: Sequence[int]) -> Iterator[str]:
    if without:
        yield f"{_runs(without)} ended before a first round, and measured no coverage."


def _of_areas(by_area: Sequence[Sequence[int]]) -> Iterator[str]:
    if len(by_area) > 1:
        sets = "; ".join(_runs(group, start=False) for group in by_area)
        yield (
            f"Work areas differ ({sets}): coverage is of a run's own work area, and numbers of "
            "different ones are not of the same thing."
        )


def _of_regions(
    rounds: Mapping[int, RoundFinished], tables: Sequence[RegionTable]
) -> Iterator[str]:
    inside = {number for table in tables for number in table.runs}
    alone = [number for number in rounds if number not in inside]
    if alone:
        yield (
            f"{_runs(alone)} {'has' if len(alone) == 1 else 'have'} regions that no other run has, "
            "and cannot be compared region by region; nor is the weakest of few large regions to "
            "be compared with that of many small ones."
        )
    if tables:
        held = dict.fromkeys(
            f"{rounds[number].verdict.level:g} "
            f"{'in all regions at once' if rounds[number].verdict.simultaneous else 'in each'}"
            for number in sorted(inside)
        )
        yield (
            "Failure probabilities are called different where the bounds of two runs do not "
            "overlap, which is right if both hold; where they overlap nothing is shown. Bounds "
            "are of a run's last round; those of any one round hold with confidence "
            f"{' or '.join(held)}."
        )


def _of_certificates(certificates: Sequence[Difference]) -> Iterator[str]:
    keys = [d.key.split(".")[0] for d in certificates]
    meaning = list(dict.fromkeys(key for key in keys if key in _SUCCESS))
    if meaning:
        yield (
            f"Success does not mean the same in all runs ({listed(meaning)} of the certificates "
            "differ), so that rates of it are not of the same thing."
        )
    claimed = list(dict.fromkeys(key for key in keys if key in _CLAIM))
    if claimed:
        yield f"Certificates are not of the same claim: {listed(claimed)} differ."


def _of_instances(shared: Sequence[SharedInstances]) -> Iterator[str]:
    pairs = [f"{each.first} and {each.second}" for each in shared if each.instances == 0]
    if pairs:
        yield (
            f"The last rounds of runs {'; '.join(pairs)} have no instance in common: only rounds "
            "of the same number, with the same seed and regions, draw the same."
        )


def _runs(numbers: Sequence[int], *, start: bool = True) -> str:
    noun = "run" if len(numbers) == 1 else "runs"
    return f"{noun.capitalize() if start else noun} {listed([str(n) for n in numbers])}"
