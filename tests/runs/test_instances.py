from __future__ import annotations

import csv
import io

import numpy as np
import pytest

from drake_screw.errors import ScenarioError
from drake_screw.planning import Cause, Outcomes
from drake_screw.runs.instance_tables import outcomes_csv, read_instances, unlike_fixed
from drake_screw.tasks import ObjectArea, WorkArea

BOWL = ObjectArea("bowl", (0.5, -0.5, 0.25), (1.0, 0.5, 0.25), -0.06)
CUP = ObjectArea("cup", (0.5, -0.5, -1.0), (1.0, 0.5, 1.0), 0.0)
ONE, TWO = WorkArea((BOWL,)), WorkArea((BOWL, CUP))


def write(tmp_path, text):
    file = tmp_path / "in.csv"
    file.write_text(text)
    return file


def test_columns_are_found_by_name_in_any_order(tmp_path) -> None:
    file = write(tmp_path, "note,y,x\na,0.1,0.6\n\nb,0.2,0.7\n")
    expected = [[[0.6, 0.1, 0.25]], [[0.7, 0.2, 0.25]]]
    assert np.array_equal(read_instances(file, ONE), expected)


def test_several_objects_have_their_own_columns(tmp_path) -> None:
    file = write(tmp_path, "bowl.x,bowl.y,cup.x,cup.y,cup.yaw\n0.6,0.1,0.8,-0.1,0.5\n")
    expected = [[[0.6, 0.1, 0.25], [0.8, -0.1, 0.5]]]
    assert np.array_equal(read_instances(file, TWO), expected)


def test_what_is_fixed_needs_no_column(tmp_path) -> None:
    rail = ObjectArea("bowl", (0.5, 0.1, 0.25), (1.0, 0.1, 0.25), 0.0)
    file = write(tmp_path, "x\n0.6\n0.7\n")
    assert np.array_equal(
        read_instances(file, WorkArea((rail,))), [[[0.6, 0.1, 0.25]], [[0.7, 0.1, 0.25]]]
    )
    stand = ObjectArea("stand", (0.4, -0.3, 0.5), (0.4, -0.3, 0.5), 0.0)
    file = write(tmp_path, "bowl.x,bowl.y\n0.6,0.1\n")
    expected = [[[0.6, 0.1, 0.25], [0.4, -0.3, 0.5]]]
    assert np.array_equal(read_instances(file, WorkArea((BOWL, stand))), expected)
    with pytest.raises(ScenarioError, match=r"no column 'bowl\.y', and it varies"):
        read_instances(write(tmp_path, "bowl.x,stand.x\n0.6,0.4\n"), WorkArea((BOWL, stand)))


def test_what_is_fixed_and_given_otherwise_is_counted(tmp_path) -> None:
    stand = ObjectArea("stand", (0.4, -0.3, 0.5), (0.4, -0.3, 0.5), 0.0)
    area = WorkArea((BOWL, stand))
    file = write(tmp_path, "bowl.x,bowl.y,stand.x,stand.y\n0.6,0.1,0.4,-0.3\n9,0.1,0.5,-0.3\n")
    coordinates = read_instances(file, area)
    assert coordinates[1, 1].tolist() == [0.5, -0.3, 0.5]
    assert unlike_fixed(coordinates, area) == {"stand.x": 1}
    turned = read_instances(write(tmp_path, "x,y,yaw\n0.6,0.1,0.25\n0.6,0.1,1\n"), ONE)
    assert unlike_fixed(turned, ONE) == {"yaw": 1}


@pytest.mark.parametrize(
    ("text", "message", "line"),
    [
        ("x,z\n1,2\n", "no column 'y'", 1),
        ("", "no column 'x'", 1),
        ("x,y\n1,2\n1,two\n", "y is 'two'", 3),
        ("x,y\n1\n", "y is 'nothing'", 2),
        ("x,y\n1,inf\n", "y is 'inf'", 2),
        ("x,y\n", "no instances", None),
    ],
)
def test_bad_tables_are_refused_with_their_place(tmp_path, text, message, line) -> None:
    file = write(tmp_path, text)
    with pytest.raises(ScenarioError, match=message) as error:
        read_instances(file, ONE)
    assert (error.value.file, error.value.line) == (file, line)


def test_a_yaw_that_varies_is_never_filled_in(tmp_path) -> None:
    turning = WorkArea((ObjectArea("bowl", (0.5, -0.2, -0.8), (1.0, 0.2, 0.8), 0.0),))
    with pytest.raises(ScenarioError, match="no column 'yaw', and it varies") as error:
        read_instances(write(tmp_path, "x,y\n0.6,0.1\n"), turning)
    assert error.value.line == 1
    given = read_instances(write(tmp_path, "x,y,yaw\n0.6,0.1,-0.3\n"), turning)
    assert given.tolist() == [[[0.6, 0.1, -0.3]]]
    with pytest.raises(ValueError, match="the yaw of 'bowl' varies, and is missing"):
        turning.complete([[0.6, 0.1]])
    assert turning.complete([[0.6, 0.1, 0.2]]).tolist() == [[[0.6, 0.1, 0.2]]]


def test_a_missing_table(tmp_path) -> None:
    with pytest.raises(ScenarioError, match="No such file"):
        read_instances(tmp_path / "none.csv", ONE)


def test_outcomes_are_written_as_codes() -> None:
    outcomes = Outcomes(
        np.array([[Cause.SUCCESS, Cause.JOINT_LIMIT], [Cause.UNREACHABLE, Cause.COLLISION]], "u1"),
        np.array([[-1, 2], [0, 1]], "i2"),
        np.array([[-1, 4], [-1, -1]], "i1"),
        np.ones((2, 2), "f4"),
        np.zeros((2, 2), "i2"),
    )
    coordinates = np.array([[[0.6, 0.1, 0.25]], [[0.7, 0.2, 0.25]]])
    text = outcomes_csv(coordinates, outcomes, ["a", "b"], ONE)
    assert text == "x,y,a,b\n0.6,0.1,0:0,3:5\n0.7,0.2,1:n,2:c\n"
    coordinates[1, 0, 2] = 0.5
    assert outcomes_csv(coordinates, outcomes, ["a", "b"], ONE).startswith("x,y,yaw,a,b\n")


def test_names_with_commas_stay_in_their_column() -> None:
    outcomes = Outcomes(
        np.array([[Cause.SUCCESS, Cause.UNREACHABLE]], "u1"),
        np.array([[-1, 0]], "i2"),
        np.full((1, 2), -1, "i1"),
        np.ones((1, 2), "f4"),
        np.zeros((1, 2), "i2"),
    )
    names = ["demo, second try", 'the "good" one']
    text = outcomes_csv(np.array([[[0.6, 0.1, 0.25]]]), outcomes, names, ONE)
    (row,) = csv.DictReader(io.StringIO(text))
    assert row == {"x": "0.6", "y": "0.1", names[0]: "0:0", names[1]: "1:n"}
