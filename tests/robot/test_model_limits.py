"""Joint limits that cannot be meant are refused by the joint's name."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from drake_screw.errors import ModelError
from drake_screw.robot.model_file import model_file
from drake_screw.robot.packages import ModelPlace
from tests.robot.six_joints import urdf
from tests.robot.small_arms import SLIDING, sdf

TURNED_ROUND = "joint 'j3': its lower limit 2.6 is above its upper limit -2.6"
TEXT = sdf(SLIDING)
BACKWARDS = "joint 'j2': its velocity limit -2 is below 0"


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (urdf().replace("lower='-2.6' upper='2.6'", "lower='2.6' upper='-2.6'"), TURNED_ROUND),
        (urdf(limits={"j2": 'velocity="-2" effort="9"'}), BACKWARDS),
    ],
)
def test_of_a_urdf(tmp_path: Path, text: str, said: str) -> None:
    file = tmp_path / "arm.urdf"
    file.write_text(text)
    adding, including = tmp_path / "robot.dmd.yaml", tmp_path / "robot.sdf"
    adding.write_text(f"directives: [add_model: {{name: arm, file: 'file://{file}'}}]")
    including.write_text(
        f"<sdf version='1.9'><model name='all'><include><uri>{file}</uri></include></model></sdf>"
    )
    for model in (file, adding, including):
        with pytest.raises(ModelError, match=re.escape(said)) as error:
            model_file(ModelPlace(str(model)))
        assert str(file) in str(error.value)


def test_of_an_sdf(tmp_path: Path) -> None:
    file = tmp_path / "arm.sdf"
    lower = re.search(r"<lower>([^<]+)</lower>", TEXT)
    assert lower is not None
    file.write_text(TEXT.replace(lower[0], "<lower>99</lower>", 1))
    with pytest.raises(ModelError, match=r"lower limit 99 is above its upper limit"):
        model_file(ModelPlace(str(file)))


def test_an_sdf_says_with_minus_one_that_there_is_no_velocity_limit(tmp_path: Path) -> None:
    file = tmp_path / "arm.sdf"
    file.write_text(TEXT.replace("</limit>", "<velocity>-1</velocity></limit>", 1))
    assert model_file(ModelPlace(str(file))).file == file
