from __future__ import annotations

import numpy as np

from drake_screw.planning import Cause, Outcomes
from drake_screw.tasks import ObjectArea, WorkArea, grid_regions
from drake_screw.visualization.rounds import cells, details, headline, instance_causes, sample

from .conftest import BOWL


def outcomes(cause: list[list[int]], segment: list[list[int]], fraction: float = 0.5) -> Outcomes:
    c, s = np.array(cause, dtype=np.uint8), np.array(segment, dtype=np.int16)
    joint = np.full(c.shape, -1, dtype=np.int8)
    return Outcomes(c, s, joint, np.full(c.shape, fraction, dtype=np.float32))


def test_an_instance_fails_as_its_best_attempt_did() -> None:
    J, U, S, N = Cause.JOINT_LIMIT, Cause.UNREACHABLE, Cause.SUCCESS, Cause.NOT_TRIED
    found = instance_causes(
        outcomes(
            [[J, U], [U, J], [U, S], [N, J], [N, N]], [[3, 1], [0, 2], [4, -1], [0, 0], [0, 0]]
        )
    )
    assert found.tolist() == [J, J, S, J, N]


def test_a_finished_segment_is_not_the_next_one_begun() -> None:
    J, U = Cause.JOINT_LIMIT, Cause.UNREACHABLE
    done = outcomes([[J, U]], [[1, 2]])
    done.fraction[:] = [[1.0, 0.0]]
    assert instance_causes(done).tolist() == [U]


def test_without_demonstrations_nothing_was_tried() -> None:
    none = outcomes([[]], [[]])
    assert instance_causes(none).tolist() == [Cause.NOT_TRIED]


def test_samples_are_capped_stated_and_repeatable(make_round, regions) -> None:
    evaluation = make_round(regions, [5, 0, 0, 0, 0, 0], each=1000).evaluation
    first, second = sample(evaluation, 100), sample(evaluation, 100)
    assert len(first.x_y_yaw) == len(first.cause) == 100
    assert first.statement == "100 of 6,000 instances, drawn at random"
    np.testing.assert_array_equal(first.x_y_yaw, second.x_y_yaw)
    assert sample(evaluation, 6000).statement == "all 6,000 instances"


def test_a_sample_keeps_the_causes_of_its_instances(make_round, regions) -> None:
    evaluation = make_round(regions, [4, 0, 6, 0, 0, 0]).evaluation
    shown = sample(evaluation, 10_000)
    np.testing.assert_array_equal(shown.cause, evaluation.outcomes.cause[:, 0])
    assert sum(shown.count(cause) for cause in Cause) == 60


def test_cells_of_a_plain_grid_are_its_regions(regions) -> None:
    drawn = cells(regions, np.zeros(regions.K))
    assert drawn.stack == 1
    np.testing.assert_array_equal(drawn.region, np.arange(6))
    lower, upper = regions.bounds(np.arange(6))
    np.testing.assert_allclose(drawn.lower, lower[:, 0, :2])
    np.testing.assert_allclose(drawn.upper, upper[:, 0, :2])


def test_a_stack_shows_its_worst_region() -> None:
    area = WorkArea((ObjectArea("bowl", (0.6, 0.0, -1.0), (1.0, 0.4, 1.0), 0.0),))
    regions = grid_regions(area, {"x": 2, "yaw": 3})
    drawn = cells(regions, np.array([0.1, 0.9, 0.5, np.nan, 0.2, 0.3]))
    assert drawn.stack == 3
    assert drawn.region.tolist() == [2, 1]
    assert drawn.of_region.tolist() == [0, 1, 0, 1, 0, 1]


def test_the_first_object_that_can_move_is_drawn() -> None:
    fixed = ObjectArea("cup", (0.5, 0.2, 0.0), (0.5, 0.2, 0.0), 0.0)
    regions = grid_regions(WorkArea((fixed, BOWL)), {"bowl.x": 2})
    drawn = cells(regions, np.zeros(2))
    assert drawn.object == 1
    np.testing.assert_allclose(drawn.lower, [[0.6, -0.3], [0.8, -0.3]])


def test_a_round_in_words(make_round, regions) -> None:
    weak = make_round(regions, [0, 0, 7, 0, 0, 0], number=2, demonstrations=1)
    assert headline(weak) == "round 3, 1 demonstration: not certified"
    assert details(weak, regions).startswith("weakest region: x 0.60..0.80, y 0.10..0.50; largest")
    sure = make_round(regions, [0] * 6)
    assert headline(sure) == "round 1, 2 demonstrations: certified"
