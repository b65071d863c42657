"""A study: many runs of a scenario for each of several numbers of regions.

It is the experiment of Das et al. (arXiv 2410.18275) on how many demonstrations a run needs. Every
run has its own seed and so its own first place and its own fresh instances. A study directory holds
`runs.csv`, to which every finished run is appended at once, so that an interrupted study resumes
with the runs that are missing; in the end the table is sorted, and so is the same however the runs
were shared out.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

from drake_screw.errors import RunDirectoryError, ScenarioError
from drake_screw.files import (
    csv_text,
    fresh_folder,
    make_folder,
    now,
    write_text,
    writing,
)
from drake_screw.holding import holding
from drake_screw.json_values import decode_json
from drake_screw.runs.begun_with import check_ways_around
from drake_screw.runs.directory import SCENARIO
from drake_screw.scenario.loader import dump_scenario, load_stored_scenario
from drake_screw.scenario.schema import Scenario
from drake_screw.sharing import Workers
from drake_screw.studies.experiment import Experiment, StudyRun, check_runs, split
from drake_screw.studies.figures import Distribution, save_distributions
from drake_screw.studies.hidden_failures import draw_hidden_failure
from drake_screw.studies.shared_runs import check_unchanged, hashes, shared_runs
from drake_screw.studies.table import HEADER, read_runs, row, summary_csv
from drake_screw.typing import PathLike
from drake_screw.versions import versions

FORMAT = 1
STUDY, RUNS, SUMMARY = "study.json", "runs.csv", "summary.csv"
FINISHED = "finished"
_UNWRITABLE = "Free some space or make the study's folder writable, then carry on with --resume."


@dataclass(frozen=True)
class Study:
    """A study that can be carried out, or carried on.

    Attributes:
        path: of its directory.
        scenario: what is studied.
        record: contents of study.json.
    """

    path: Path
    scenario: Scenario
    record: dict[str, Any] = field(repr=False)

    @property
    def regions(self) -> tuple[int, ...]:
        """The numbers of regions K, rising."""
        return tuple(self.record["regions"])

    @property
    def runs(self) -> int:
        """Runs for each K."""
        return int(self.record["runs"])

    @cached_property
    def experiment(self) -> Experiment:
        """The runs as this process would carry them out."""
        return Experiment(self.scenario)

    def finished_runs(self) -> tuple[StudyRun, ...]:
        """The runs in the table, sorted by K and number."""
        return tuple(sorted(read_runs(self.path / RUNS), key=lambda run: (run.K, run.run)))

    def carry_out(self, workers: Workers = None) -> Iterator[StudyRun]:
        """Carry out the runs that are missing, then write summary and pictures.

        Interrupting it leaves a directory that can be carried on; at most the runs in progress are
        lost.

        Args:
            workers: processes to use, with one thread each, as many as processors if None; or a
                cluster. They make no difference to the result.

        Yields:
            Each run as it is finished.

        Raises:
            RunDirectoryError: the table is damaged or cannot be written, another process is at work
                on the study, processes that shared the work were killed or a cluster is lost, or
                runs are missing and OMPL is installed where it was not, or is not where it was.
        """
        with holding(self.path, "study"):
            yield from self._carried_out(workers)

    def _carried_out(self, workers: Workers) -> Iterator[StudyRun]:
        finished = self.finished_runs()
        table = self.path / RUNS
        done = {(run.K, run.run) for run in finished}
        missing = [(K, i) for i in range(self.runs) for K in self.regions if (K, i) not in done]
        if missing:
            before = self.record.get("led_around")
            check_ways_around(self.experiment.setup, before, "study", self.path)
        with writing(table, _UNWRITABLE):
            write_text(table, csv_text([HEADER, *map(row, finished)]))
        self._save("running")
        try:
            with table.open("a") as lines:
                for run in shared_runs(self.experiment, missing, workers, self.path):
                    with writing(table, _UNWRITABLE):
                        lines.write(csv_text([row(run)]))
                        lines.flush()
                    yield run
            self._conclude()
        except BaseException:
            with suppress(RunDirectoryError):  # what ended it is what its user has to know
                self._save("interrupted")
            raise

    def summary(self) -> dict[int, Distribution]:
        """How many demonstrations the finished runs needed, by K."""
        runs = self.finished_runs()
        chosen = {K: [run for run in runs if run.K == K] for K in self.regions}
        return {
            K: Distribution(
                tuple(run.demonstrations for run in of_K if run.certified),
                sum(not run.certified for run in of_K),
            )
            for K, of_K in chosen.items()
            if of_K
        }

    def _conclude(self) -> None:
        runs, summary = self.finished_runs(), self.summary()
        name = self.scenario.name
        with writing(self.path, _UNWRITABLE):
            write_text(self.path / RUNS, csv_text([HEADER, *map(row, runs)]))
            write_text(self.path / SUMMARY, summary_csv(summary))
            save_distributions(summary, self.path / "distributions", scenario=name)
            draw_hidden_failure(self.experiment, runs, self.path / "hidden_pocket")
        self._save(FINISHED)

    def _save(self, status: str) -> None:
        self.record["status"] = status
        self.record["finished"] = now() if status == FINISHED else None
        with writing(self.path / STUDY, _UNWRITABLE):
            write_text(self.path / STUDY, json.dumps(self.record, indent=2) + "\n")


def new_study(
    scenario: Scenario, regions: Sequence[int], runs: int, output: PathLike | None = None
) -> Study:
    """Check a scenario to the bottom, then make a study directory.

    Args:
        scenario: what to study; its own regions are not used, its seed is the study's.
        regions: numbers of regions K, see `experiment.split`.
        runs: for each K, at least 1.
        output: directory, which must not exist or be empty; ``studies/<name>/<time>`` if None.

    Raises:
        DrakeScrewError: something cannot be used; nothing is written then.
    """
    check_runs(runs, regions)
    if scenario.teacher.kind == "interactive":
        raise ScenarioError(
            "teacher.kind: an interactive teacher would be asked in every run of a study",
            remedy="Give --demonstrations DIR, or a scenario with a simulated teacher.",
            file=scenario.source,
        )
    setup = Experiment(scenario).setup
    for K in regions:
        split(setup.area, K)
    for part in (setup.strategy, setup.teacher, setup.ask, setup.initial):
        assert part is not None
    model = setup.workcell.model_file
    record = {
        "format": FORMAT,
        "scenario": scenario.name,
        "status": "running",
        "regions": sorted(set(regions)),
        "runs": runs,
        "seed": scenario.seed,
        "strategy": scenario.coverage.strategy,
        "model": str(model),
        "hashes": hashes(setup),
        "led_around": setup.leads_around,
        "versions": versions(),
        "started": now(),
        "finished": None,
    }
    studies = Path("studies") / scenario.name
    place = studies if output is None else Path(output)
    with writing(place, remedy="Choose a folder you may write to with --output."):
        path = fresh_folder(studies) if output is None else Path(output)
        texts = dump_scenario(scenario), csv_text([HEADER]), json.dumps(record, indent=2) + "\n"
        make_folder(path, "study", dict(zip((SCENARIO, RUNS, STUDY), texts, strict=True)))
    return Study(path, load_stored_scenario(path / SCENARIO), record)


def open_study(path: PathLike) -> Study:
    """Open a study directory, to carry it on or to draw its pictures again.

    Raises:
        RunDirectoryError: it is not one, is damaged, or a model or mesh is not the same any more.
    """
    path = Path(path)
    file = path / STUDY
    if not file.is_file():
        raise RunDirectoryError(
            f"not a study directory: it has no {STUDY}",
            remedy="Give the folder that a study printed. One that was ended before it had begun "
            "can be given to --output again.",
            file=path,
        )
    try:
        record = decode_json(file.read_text())
        found, known = record["format"], dict(record["hashes"])
        numbers = [record["runs"], *record["regions"]]
        if "model" not in known or len(numbers) < 2:
            raise KeyError("keys are missing")
        if not all(type(number) is int and number >= 1 for number in numbers):
            raise ValueError("regions and runs are not whole numbers from 1")
    except (ValueError, KeyError, TypeError, OSError) as error:
        raise RunDirectoryError(
            f"damaged: {error}", remedy="Restore it, or begin the study again.", file=file
        ) from error
    if found != FORMAT:
        raise RunDirectoryError(
            f"written in format {found}; this version reads format {FORMAT}",
            remedy=f"Use the version that wrote it ({record.get('versions', {})}).",
            file=file,
        )
    study = Study(path, load_stored_scenario(path / SCENARIO), record)
    check_unchanged(study.experiment.setup, known, path)
    return study
