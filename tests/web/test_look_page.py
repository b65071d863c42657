"""The page of a look, without a browser."""

from __future__ import annotations

from dataclasses import replace
from html import unescape
from pathlib import Path

import pytest

from drake_screw.assembly.looking import Looks
from drake_screw.assembly.setup import Setup
from drake_screw.errors import DrakeScrewError
from drake_screw.scenario.loader import load_scenario
from drake_screw.web.look_page import look_page, write_look_page
from tests.demonstrations.test_look import looked


@pytest.fixture(scope="module")
def looks() -> Looks:
    setup = Setup(load_scenario("pouring", ["objects.0.name=jug"]))
    look = looked(objects=1, name="<b>a&b", notes=("<script>alert(1)</script>",))
    return Looks(Path("<here>"), True, setup, (look,))


def test_words_of_a_recording_are_escaped(looks: Looks) -> None:
    page = look_page(looks)
    assert "<script" not in page
    assert "<b>" not in page
    assert "<td><script>alert(1)</script></td>" in unescape(page)
    assert "#%3Cb%3Ea%26b" in page
    assert (
        f'<td class="number">{looks.looks[0].demonstration.fidelity[0].guiding_poses}</td>' in page
    )


def test_it_is_there_whole_or_not_at_all(looks: Looks, tmp_path: Path) -> None:
    file = write_look_page(looks, tmp_path / "page.html")
    assert file.read_text(encoding="utf-8").endswith("</html>\n")
    with pytest.raises(DrakeScrewError, match=r"no/page\.html: cannot be written"):
        write_look_page(replace(looks, looks=()), tmp_path / "no" / "page.html")
    assert list(tmp_path.iterdir()) == [file]
