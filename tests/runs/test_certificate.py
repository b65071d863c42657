"""The certificate says what is claimed, by what, on how much, and with what reservation."""

from __future__ import annotations

import json
from types import SimpleNamespace

import numpy as np
import pytest

from drake_screw.acquisition import Finished, Status
from drake_screw.bandits import Goal, coverage_bound, make_strategy
from drake_screw.demonstrations import Fidelity
from drake_screw.runs.certifying import certificate
from drake_screw.runs.codec import plain
from drake_screw.scenario.execution_block import ExecutionBlock, NoiseBlock

GOAL = Goal(0.95, 0.02, 0.05)
EARLIER = SimpleNamespace(samples=48, attempted=False)
ATTEMPT = SimpleNamespace(samples=300, attempted=True)


def scenario_of(
    collision=False,
    objects=(),
    tool=None,
    approach="screw",
    ignored=(),
    arms=(),
    execution=None,
    **kept,
):
    each = [SimpleNamespace(name=n, tool=tool, end_effector="hand") for n in arms or ("arm",)]
    success = "plan" if execution is None else "execution"
    return SimpleNamespace(
        coverage=SimpleNamespace(beta=0.95, epsilon=0.02, delta=0.05, success=success),
        execution=execution,
        planner=SimpleNamespace(
            **{"clearance": 0.0, "joint_margin": 0.0, "slide_margin": 0.0, "roll_axis": None}
            | kept,
            collision=collision,
            approach=approach,
            turns=24,
        ),
        objects=objects,
        apart=False,
        robot=SimpleNamespace(
            arms=each if arms else None, each_arm=each, ignore_collisions=ignored
        ),
    )


def stated_by(name, mu, rounds=(), scenario=None, led_around=None, **options):
    """Certificate of a run of three regions whose last round met failure probabilities mu."""
    bandit = make_strategy(name, GOAL, **options)
    attempt = 1 + sum(entry.attempted for entry in rounds)
    rng = np.random.default_rng(0)
    verdict = bandit.decide(lambda counts: rng.binomial(counts, mu), 3, attempt=attempt)
    instances = verdict.total_samples + sum(entry.samples for entry in rounds)
    setup = SimpleNamespace(
        scenario=scenario or scenario_of(),
        bandit=bandit,
        tree=None,
        regions=SimpleNamespace(K=3),
        area=SimpleNamespace(objects=()),
        workcell=SimpleNamespace(model=SimpleNamespace(incomplete=())),
    )
    status = Status.CERTIFIED if verdict.certified else Status.INSUFFICIENT
    kept = [
        Fidelity("bowl", 7, 0.006, 0.08, 0.9, 1.38, 1.36),
        Fidelity("bowl", 5, 0.009, 0.05, 0.8, 1.0, 1.0),
    ]
    demonstrations = tuple(SimpleNamespace(fidelity=(each,)) for each in kept)
    finished = Finished(status, "the budget is used up", verdict, demonstrations)
    stated = certificate(
        setup, finished, attempt=attempt, instances=instances, led_around=led_around
    )
    assert json.loads(json.dumps(plain(stated))) == plain(stated)
    return stated, verdict, " ".join(stated.statement)


def test_a_certificate_by_execution_says_what_executions_had_to_do() -> None:
    exact = ExecutionBlock()
    noisy = ExecutionBlock(
        displacement=0.004, contact_force=5.0, noise=NoiseBlock(object_position=0.005)
    )
    for block, expected in (
        (None, ()),
        (
            exact,
            (
                "within 10 mm and 0.1 rad of where it ought to be",
                "the robot touches nothing;",
                "moved by more than 2 mm or turned by more than 0.05 rad",
                "Objects are measured, and the arm's joints calibrated, exactly.",
            ),
        ),
        (
            noisy,
            (
                "touches nothing with more than 5 N",
                "moved by more than 4 mm",
                "standard deviations: x and y of objects are measured to 0.005 m.",
            ),
        ),
    ):
        stated, _, text = stated_by(
            "eprocess", [0.0] * 3, scenario=scenario_of(True, execution=block)
        )
        assert stated.success == ("plan" if block is None else "execution")
        assert ("That plan is executed, too" in text) == (block is not None)
        assert all(words in text for words in expected)
        assert ("calibrated, exactly" in text) == (block is exact)
    assert stated.execution.noise.object_position == 0.005


def test_a_certificate_of_a_run_that_spent_delta() -> None:
    stated, verdict, text = stated_by("eprocess", [0.0, 0.01, 0.0], [EARLIER, ATTEMPT])
    assert stated.certified
    assert stated.coverage == 0.95
    assert (stated.attempt, stated.delta_of_attempt) == (2, pytest.approx(0.05 / 6))
    assert stated.fresh_instances == verdict.total_samples
    assert stated.instances_in_all_rounds == verdict.total_samples + 48 + 300
    assert stated.confidence_holds_for == "the whole run"
    assert "Every region succeeds at least 0.95 of the time (confidence 0.95" in text
    assert "is kept to 9 mm and 0.08 rad." in text
    assert (stated.kept_position, stated.kept_rotation) == (0.009, 0.08)
    assert "3 regions, with 2 demonstrations" in text
    assert "attempt 2" in text
    assert "budget" not in text


def test_whether_collisions_count_is_said() -> None:
    stated, _, text = stated_by("eprocess", [0.0, 0.0, 0.0])
    assert not stated.collisions_checked
    assert "within the joint limits of the robot's model; collisions do not count." in text
    stated, _, text = stated_by("eprocess", [0.0, 0.0, 0.0], scenario=scenario_of(collision=True))
    assert stated.collisions_checked
    assert "that touches nothing." in text


def test_what_is_kept_is_said() -> None:
    scenario = scenario_of(collision=True, clearance=0.02, joint_margin=0.1)
    stated, _, text = stated_by("eprocess", [0.0, 0.0, 0.0], scenario=scenario)
    assert (stated.clearance, stated.joint_margin) == (0.02, 0.1)
    assert (
        "a plan at least 0.1 rad within the joint limits of the robot's model along which the "
        "robot keeps 0.02 m from all else and itself." in text in text
    )
    assert "touches nothing" not in text
    sliding = scenario_of(joint_margin=0.1, slide_margin=0.01)
    stated, _, text = stated_by("eprocess", [0.0, 0.0, 0.0], scenario=sliding)
    assert stated.slide_margin == 0.01
    assert "at least 0.1 rad and 0.01 m, where joints slide, within the joint limits" in text


@pytest.mark.parametrize(
    ("arms", "said"),
    [
        (("one",), "joint limits of the robot's model; collisions do not count. Of what"),
        (
            ("a", "b"),
            "A plan is of one arm, a or b, the first of these that can, from its own start",
        ),
        (("a", "b"), "; the other rests at its own."),
        (("a", "b", "c"), "a, b or c, the first of these that can, from its own start; the others"),
    ],
)
def test_which_arms_may_be_used_is_said(arms: tuple[str, ...], said: str) -> None:
    stated, _, text = stated_by("eprocess", [0.0, 0.0, 0.0], scenario=scenario_of(arms=arms))
    assert stated.arms == arms
    assert said in text
    _, _, text = stated_by("eprocess", [0.0, 0.0, 0.0])
    assert "A plan is of one arm" not in text


def test_what_may_touch_is_said() -> None:
    pairs = (("left_finger", "right_finger"), ("base", "table"))
    for collision in (True, False):
        scenario = scenario_of(collision=collision, ignored=pairs)
        stated, _, text = stated_by("eprocess", [0.0, 0.0, 0.0], scenario=scenario)
        assert stated.ignored_collisions == pairs
        said = "Whether these touch is not looked at: left_finger and right_finger, base and table."
        assert (said in text) is collision
    tool = SimpleNamespace(symmetry=None, touches=("bowl", "left_finger"))
    scenario = scenario_of(collision=True, tool=tool, arms=("left", "right"))
    stated, _, text = stated_by("eprocess", [0.0, 0.0, 0.0], scenario=scenario)
    assert stated.tool_touches == tool.touches
    assert "what the hand holds and bowl, what the hand holds and left_finger." in text


def test_it_says_what_was_taken_for_granted() -> None:
    stated, _, text = stated_by("eprocess", [0.0, 0.0, 0.0])
    assert stated.freedoms == ()
    assert "taken to be" not in text
    assert "any joint motion" not in text
    symmetry = SimpleNamespace(axis="z", turns="any")
    objects = [
        SimpleNamespace(name="bowl", orientation=None, symmetry=symmetry),
        SimpleNamespace(name="mug", orientation=None, symmetry=None),
        SimpleNamespace(name="box", orientation=None, symmetry=SimpleNamespace(axis="x", turns=4)),
    ]
    tool = SimpleNamespace(symmetry=symmetry, touches=("cup", "table"))
    scenario = scenario_of(collision=True, objects=objects, tool=tool, approach="free")
    stated, _, text = stated_by("eprocess", [0.0, 0.0, 0.0], scenario=scenario)
    assert [(f.body, f.axis, f.turns, f.tried) for f in stated.freedoms] == [
        ("bowl", "z", "any", 24),
        ("box", "x", 4, 4),
        ("tool", "z", "any", 24),
    ]
    assert "The bowl is taken to be a body of revolution about its z axis" in text
    assert "by any angle, of which 24 are tried." in text
    assert "The box is taken to be the same after each of 4 equal turns about its x axis" in text
    assert "the end effector may be turned with it" in text
    assert "not looked at: what the hand holds and cup, what the hand holds and table." in text
    assert "mug" not in text
    assert "The way to the first guiding pose may be any joint motion." in text
    record = plain(stated)
    assert record["freedoms"][0] == {"body": "bowl", "axis": "z", "turns": "any", "tried": 24}
    assert record["approach"] == "free"


@pytest.mark.parametrize(
    ("led_around", "said"),
    [
        (True, "any joint motion; where the straight one touches something, it is led around that"),
        (False, "any joint motion, but only the straight one was tried: without OMPL"),
        (None, "may be any joint motion. "),
    ],
)
def test_whether_the_arm_is_led_around_what_it_touches_is_said(led_around, said) -> None:
    scenario = scenario_of(collision=True, approach="free")
    stated, _, text = stated_by(
        "eprocess", [0.0, 0.0, 0.0], scenario=scenario, led_around=led_around
    )
    assert said in text
    assert plain(stated).get("led_around") is led_around


def test_the_papers_reading_is_labelled() -> None:
    stated, _, text = stated_by("naive_pac", [0.0, 0.01, 0.0], [ATTEMPT])
    assert not stated.delta_spent_over_attempts
    assert stated.delta_of_attempt == 0.05
    assert stated.confidence_holds_for == "each round"
    assert "for this round" in text
    assert "not spent" in text
    spent, _, text = stated_by("naive_pac", [0.0, 0.01, 0.0], [ATTEMPT], spend=True)
    assert spent.delta_of_attempt == pytest.approx(0.05 / 6)
    assert "not spent" not in text


def test_a_run_without_a_certificate_says_what_it_has_shown() -> None:
    stated, verdict, text = stated_by("eprocess", [0.0, 0.3, 0.0], [ATTEMPT])
    assert not stated.certified
    shown = coverage_bound(verdict.samples, verdict.failures, 0.05 / 6)
    assert stated.coverage == verdict.coverage == pytest.approx(shown)
    assert 0.0 < shown < 0.7
    assert text.startswith("The budget is used up. Shown so far: every region succeeds at least")
    assert f"beta' = {shown:.4f}" in text


def test_a_run_that_never_began_states_nothing() -> None:
    bandit = make_strategy("eprocess", GOAL)
    setup = SimpleNamespace(
        scenario=scenario_of(),
        bandit=bandit,
        tree=None,
        regions=SimpleNamespace(K=3),
        area=SimpleNamespace(objects=()),
        workcell=SimpleNamespace(model=SimpleNamespace(incomplete=())),
    )
    finished = Finished(Status.INSUFFICIENT, "no initial demonstration", None, ())
    stated = certificate(setup, finished)
    assert "claim" not in plain(stated)
    assert stated.statement == ("No initial demonstration.",)


def test_a_roll_that_is_free_is_told() -> None:
    free = scenario_of(roll_axis=(0.0, 1.0, 0.0))
    _, _, text = stated_by("eprocess", [0.0, 0.0, 0.0], scenario=free)
    assert "turned about the y axis of 'hand' is free" in text
    assert stated_by("eprocess", [0.0, 0.0, 0.0])[0].free_roll is None
