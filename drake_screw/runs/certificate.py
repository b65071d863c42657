"""The statement a run makes at its end: as data for run.json, and in words."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from drake_screw.assembly.freedoms import Freedom
from drake_screw.errors import confidence, listed, rounded_down
from drake_screw.runs.execution_terms import ExecutionTerms
from drake_screw.runs.html import certificate_html


@dataclass(frozen=True, kw_only=True)
class Certificate:
    """What a run states at its end, whether or not it certified; `docs/guarantees.md` explains it.

    From `claim` on entries are None where no round was evaluated, the last two also where regions
    are adaptive.

    Attributes:
        certified: whether every region is shown to succeed often enough.
        demonstrations: how many were in hand.
        regions: how many there were in the end.
        beta, epsilon, delta: what was to be certified, see `drake_screw.bandits.Goal`.
        collisions_checked: whether touching something counts as failing.
        clearance: m, that the robot keeps from all else and itself, where that is checked.
        joint_margin: rad, that revolute joints keep from their limits.
        slide_margin: m, that prismatic ones keep.
        arms: names of the robot's arms that a plan may be of, in the order in which they are tried;
            () where there is only one.
        incomplete_shapes: links of the robot that lack collision shapes of its model; what touches
            there is not seen.
        strategy: name of the bandit.
        guarantee: what it can be relied on for, in one sentence.
        claim: what is shown; of the weakest region where not certified.
        coverage: beta, or where not certified the success probability shown for every region.
        confidence: 1 - delta.
        confidence_holds_for: "the whole run" or "each round".
        fresh_instances: drawn for the last verdict.
        instances_in_all_rounds: drawn in the run.
        delta_spent_over_attempts: whether the rounds share delta.
        attempt: number of the last round's attempt to certify, from 1.
        delta_of_attempt: its share of delta.
        ignored_collisions: pairs of links that may touch.
        tool_touches: what the thing in the hand may touch; None where that is nothing.
        turned_any_way: objects whose orientation is uniform on SO(3); None where none is.
        apart: True where places at which objects overlap are left out, else None.
        freedoms: symmetries that were taken for granted.
        free_roll: what of the hand's motion was not followed, in a sentence; None where all was.
        approach: how the arm comes to the first guiding pose: "screw", or "free" for any joint
            motion.
        led_around: whether an arm was led around what a free approach touches, for which OMPL has
            to be there; None where that was not asked of it, or is not known.
        success: what counts as one, a "plan" or its "execution".
        execution: what executions had to do; None where plans are not executed.
        kept_position: m, and
        kept_rotation: rad, largest deviation of what was shown near the objects from what the
            demonstrations keep of it; None where it is not known.
        reason: why the run ended.
    """

    certified: bool
    demonstrations: int
    regions: int
    beta: float
    epsilon: float
    delta: float
    collisions_checked: bool
    strategy: str
    guarantee: str
    claim: str | None = None
    coverage: float | None = None
    confidence: float | None = None
    confidence_holds_for: str | None = None
    fresh_instances: int | None = None
    instances_in_all_rounds: int | None = None
    delta_spent_over_attempts: bool | None = None
    attempt: int | None = None
    delta_of_attempt: float | None = None
    clearance: float = 0.0
    joint_margin: float = 0.0
    slide_margin: float = 0.0
    ignored_collisions: tuple[tuple[str, str], ...] = ()
    arms: tuple[str, ...] = ()
    incomplete_shapes: tuple[str, ...] = ()
    tool_touches: tuple[str, ...] | None = None
    turned_any_way: tuple[str, ...] | None = None
    apart: bool | None = None
    freedoms: tuple[Freedom, ...] = ()
    free_roll: str | None = None
    approach: Literal["screw", "free"] = "screw"
    led_around: bool | None = None
    success: Literal["plan", "execution"] = "plan"
    execution: ExecutionTerms | None = None
    kept_position: float | None = None
    kept_rotation: float | None = None
    reason: str = ""

    def __post_init__(self) -> None:
        rests_on = (
            self.coverage,
            self.confidence,
            self.confidence_holds_for,
            self.fresh_instances,
            self.instances_in_all_rounds,
            self.delta_spent_over_attempts,
        )
        if self.claim is not None and None in rests_on:
            raise ValueError("a claim without all that it rests on")

    @property
    def statement(self) -> tuple[str, ...]:
        """The certificate in words, sentence by sentence."""
        if self.claim is None:
            return (_sentence(self.reason),)
        if self.certified:
            shown = [_sentence(self.claim)]
        else:
            assert self.confidence is not None
            assert self.coverage is not None
            held = f"confidence {confidence(self.confidence)} for {self.confidence_holds_for}"
            least = f"beta' = {rounded_down(self.coverage)}"
            shown = [
                _sentence(self.reason),
                f"Shown so far: every region succeeds at least {least} of the time ({held}).",
                f"Of the weakest region: {self.claim}.",
            ]
        free_roll = () if self.free_roll is None else (self.free_roll,)
        freedoms = (*free_roll, *map(str, self.freedoms))
        scope = self._scope(), *self._ignored()
        return (*shown, *scope, *freedoms, *self._fidelity(), self._evidence())

    def _scope(self) -> str:
        if not self.collisions_checked:
            collisions = "; collisions do not count"
        elif self.clearance > 0.0:
            collisions = (
                f" along which the robot keeps {self.clearance:g} m from all else and itself"
            )
        else:
            collisions = " that touches nothing"
        within = "within"
        if self.joint_margin > 0.0 or self.slide_margin > 0.0:
            kept = [f"{self.joint_margin:g} rad"] if self.joint_margin > 0.0 else []
            kept += [f"{self.slide_margin:g} m, where joints slide,"] * (self.slide_margin > 0.0)
            within = f"at least {' and '.join(kept)} within"
        return (
            f"This is of {self.regions} region{'' if self.regions == 1 else 's'}, with "
            f"{self.demonstrations} demonstration{'' if self.demonstrations == 1 else 's'}, for "
            f"places drawn uniformly in each region{self._places()}. To succeed is to have a plan "
            f"{within} the joint limits of the robot's model{collisions}."
            f"{self._of_arms()}{self._unseen()}{self._way_there()}"
            f"{'' if self.execution is None else f' {self.execution}'}"
        )

    def _of_arms(self) -> str:
        if len(self.arms) < 2:
            return ""
        *others, last = self.arms
        rest = "the others rest" if len(others) > 1 else "the other rests"
        return (
            f" A plan is of one arm, {', '.join(others)} or {last}, the first of these that can, "
            f"from its own start; {rest} at {'theirs' if len(others) > 1 else 'its own'}."
        )

    def _places(self) -> str:
        words = ""
        if self.turned_any_way:
            words += f", {listed(self.turned_any_way)} turned in any way, uniformly on SO(3)"
        if self.apart:
            words += ", without those at which objects overlap"
        return words

    def _unseen(self) -> str:
        if not self.collisions_checked or not self.incomplete_shapes:
            return ""
        links = ", ".join(self.incomplete_shapes)
        return (
            " What these links touch was seen in part or not at all, as collision shapes of theirs "
            f"could not be had: {links}."
        )

    def _ignored(self) -> tuple[str, ...]:
        if not self.collisions_checked:
            return ()
        pairs = [f"{a} and {b}" for a, b in self.ignored_collisions]
        pairs += [f"what the hand holds and {name}" for name in self.tool_touches or ()]
        return (f"Whether these touch is not looked at: {', '.join(pairs)}.",) if pairs else ()

    def _way_there(self) -> str:
        if self.approach != "free":
            return ""
        any_motion = " The way to the first guiding pose may be any joint motion"
        if self.led_around is None:
            return f"{any_motion}."
        if self.led_around:
            return f"{any_motion}; where the straight one touches something, it is led around that."
        return (
            f"{any_motion}, but only the straight one was tried: without OMPL, which was not "
            "installed, the arm is not led around what it touches."
        )

    def _fidelity(self) -> tuple[str, ...]:
        if self.kept_position is None or self.kept_rotation is None:
            return ()
        return (
            "Of what was shown near the objects, the part that the demonstrations keep is kept to "
            f"{1e3 * self.kept_position:.0f} mm and {self.kept_rotation:.2f} rad.",
        )

    def _evidence(self) -> str:
        shown = (
            f"Shown by {self.strategy} on {self.fresh_instances:,} fresh instances "
            f"({self.instances_in_all_rounds:,} in all rounds)"
        )
        if not self.delta_spent_over_attempts:
            shown += "; delta is not spent over attempts, so several rounds may err more often"
        elif self.attempt is not None:
            shown += (
                f"; attempt {self.attempt} to certify, given {self.delta_of_attempt:.4g} of "
                f"delta = {self.delta:g}"
            )
        return f"{shown}."

    def _repr_html_(self) -> str:
        return certificate_html(self.certified, self.statement)


def _sentence(text: str) -> str:
    return f"{text[:1].upper()}{text[1:]}."
