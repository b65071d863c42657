from __future__ import annotations

import json
import re

import pytest
from jinja2 import UndefinedError
from markupsafe import Markup

from drake_screw.visualization.meshcat_page import add_to_page, render

PAGE = "<html><head><title>Drake MeshCat</title></head><body>a </body> in a string</body></html>"


def test_html_is_added_at_the_end_of_the_body() -> None:
    page = add_to_page(PAGE, Markup("<p>1 &lt; 2</p>"), title="<b> & c", head=Markup("<style/>"))
    assert page == (
        '<html><head>\n<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        "<style/><title>&lt;b&gt; &amp; c</title></head>"
        "<body>a </body> in a string<p>1 &lt; 2</p></body></html>"
    )


def test_data_cannot_end_the_script_it_stands_in() -> None:
    state = {"name": "</script><script>alert(1)//", "yaw": None, "order": {"b": 1, "a": [2.5]}}
    page = render("drake_screw.web", "inspector.html.j2", key=(), saved_state=state)
    assert page.count("</script>") == 1
    found = re.search(r"const saved_state = (.*);\n", page)
    assert found is not None
    assert json.loads(found[1]) == state
    assert list(json.loads(found[1])["order"]) == ["b", "a"]


def test_text_is_escaped() -> None:
    page = render("drake_screw.web", "inspector.html.j2", key=[("red", "<i>")], saved_state=None)
    assert "</i>&lt;i&gt;</div>" in page
    assert "const saved_state = null;" in page


def test_what_a_template_names_must_be_given() -> None:
    with pytest.raises(UndefinedError, match="key"):
        render("drake_screw.web", "inspector.html.j2", saved_state=None)
