"""The statement a finished run makes: as data for run.json, and in words."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from drake_screw.acquisition import Finished, Status
from drake_screw.assembly.setup import Setup
from drake_screw.bandits.spending import attempt_delta


def certificate(
    setup: Setup, finished: Finished, rounds: Sequence[Mapping[str, Any]]
) -> dict[str, Any]:
    """What a finished run states, in plain data; `docs/guarantees.md` explains every entry.

    Args:
        setup: of the run.
        finished: its last event.
        rounds: the entries of run.json on its rounds.
    """
    verdict, block, bandit = finished.verdict, setup.scenario.coverage, setup.bandit
    stated: dict[str, Any] = {
        "certified": finished.status is Status.CERTIFIED,
        "demonstrations": len(finished.demonstrations),
        "regions": setup.regions.K if verdict is None else len(verdict.samples),
        "beta": block.beta,
        "epsilon": block.epsilon,
        "delta": block.delta,
        "collisions_checked": setup.scenario.planner.collision,
        "strategy": bandit.name,
        "guarantee": bandit.guarantee,
    }
    if verdict is None:
        return stated
    spent = bool(getattr(bandit, "spend", True))
    stated |= {
        "claim": verdict.claim,
        "coverage": block.beta if verdict.certified else verdict.coverage,
        "confidence": 1.0 - block.delta,
        "confidence_holds_for": "the whole run" if spent else "each round",
        "fresh_instances": verdict.total_samples,
        "instances_in_all_rounds": sum(sum(entry["samples"]) for entry in rounds),
        "delta_spent_over_attempts": spent,
    }
    if setup.tree is None:
        attempt = 1 + sum(entry["verdict"]["attempted"] for entry in rounds[:-1])
        share = attempt_delta(block.delta, attempt, spend=spent)
        stated |= {"attempt": attempt, "delta_of_attempt": share}
    return stated


def statement(stated: Mapping[str, Any], reason: str) -> list[str]:
    """A certificate in words, a line for each sentence.

    Args:
        stated: by `certificate`.
        reason: why the run ended.
    """
    lines = [] if stated["certified"] else [f"{_sentence(reason)}"]
    if "claim" not in stated:
        return lines
    held = f"confidence {stated['confidence']:g} for {stated['confidence_holds_for']}"
    if stated["certified"]:
        lines.append(_sentence(stated["claim"]))
    else:
        lines.append(
            f"Shown so far: every region succeeds at least beta' = {stated['coverage']:.4f} of the "
            f"time ({held})."
        )
        lines.append(f"Of the weakest region: {stated['claim']}.")
    count = stated["demonstrations"]
    collisions = (
        " that touches nothing" if stated["collisions_checked"] else "; collisions do not count"
    )
    lines.append(
        f"This is of {stated['regions']} regions, with {count} "
        f"demonstration{'' if count == 1 else 's'}, for places drawn uniformly in each region. To "
        "succeed is to have a plan within the joint limits of the robot's model"
        f"{collisions}."
    )
    shown = (
        f"Shown by {stated['strategy']} on {stated['fresh_instances']:,} fresh instances "
        f"({stated['instances_in_all_rounds']:,} in all rounds)"
    )
    if not stated["delta_spent_over_attempts"]:
        shown += "; delta is not spent over attempts, so several rounds may err more often"
    elif "attempt" in stated:
        shown += (
            f"; attempt {stated['attempt']} to certify, given {stated['delta_of_attempt']:.4g} of "
            f"delta = {stated['delta']:g}"
        )
    return [*lines, f"{shown}."]


def _sentence(text: str) -> str:
    return f"{text[:1].upper()}{text[1:]}."
