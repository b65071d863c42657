"""Executions of a run as one page that plays them."""

from __future__ import annotations

from collections.abc import Sequence

from drake_screw.assembly.setup import Setup
from drake_screw.execution import recording_html
from drake_screw.execution.allowed import said
from drake_screw.execution.playback import BAD, GOOD, Shown, spans
from drake_screw.execution.trials import Trial
from drake_screw.visualization.lifetime import scratch
from drake_screw.visualization.object_looks import bowl_look
from drake_screw.visualization.playback_page import Played, with_controls

SHOWN = 4
"""So many executions are on the page, at most."""


def executions_page(
    setup: Setup, trials: Sequence[Trial], *, free_objects: bool = False
) -> str | None:
    """A page with a list of some executions, and controls to play them; None if there are none.

    Shown are what went wrong, the worst tracked, and some from all over the work area.

    Args:
        setup: of the run.
        trials: what was to be executed.
        free_objects: whether objects could be pushed.
    """
    robots = {one.name: one.robot for one in setup.arms}
    chosen, shown = _chosen(trials), list[Shown]()
    for trial in chosen:
        assert trial.execution is not None
        X_WO = setup.area.X_WO(trial.coordinates)
        shown.append((trial.execution, X_WO, robots.get(trial.arm, setup.robot)))
    if not shown:
        return None
    with scratch():
        page = recording_html(
            shown,
            table=setup.table,
            objects=setup.objects,
            obstacles=setup.obstacles,
            free_objects=free_objects,
            looks=[bowl_look(item) for item in setup.objects],
        )
    times = spans([execution for execution, _, _ in shown])
    played = [
        _played(setup, trial, start, end) for trial, (start, end) in zip(chosen, times, strict=True)
    ]
    return with_controls(page, f"{setup.scenario.name}: executions", played)


def _played(setup: Setup, trial: Trial, start: float, end: float) -> Played:
    """What the list says of an execution."""
    report, area = trial.report, setup.area
    assert report is not None
    where = "; ".join(
        f"{item.name} at {area.words(i, trial.coordinates)}" for i, item in enumerate(area.objects)
    )
    by = f", arm {trial.arm}" if trial.arm else ""
    how = (
        f"as planned; at most {1e3 * report.tracking.position:.1f} mm off its set points"
        if report.flawless
        else said(report.flaws)
    )
    words = f"{where} (region {trial.region}), with {trial.demonstration}{by}: {how}"
    return Played(start, end, words, GOOD if report.flawless else BAD)


def _chosen(trials: Sequence[Trial]) -> list[Trial]:
    """What is worth looking at: what went wrong, the worst tracked, then some from all over."""
    executed = [trial for trial in trials if trial.report is not None]

    def badness(trial: Trial) -> tuple[bool, float]:
        assert trial.report is not None
        return not trial.report.flawless, trial.report.tracking.position

    worst = sorted(executed, key=badness, reverse=True)[: SHOWN // 2]
    rest = [trial for trial in executed if trial not in worst]
    return worst + rest[:: max(1, -(-len(rest) // (SHOWN - len(worst))))]
