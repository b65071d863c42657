"""A run and its certificate as HTML, for notebooks."""

from __future__ import annotations

import base64
from collections.abc import Sequence
from pathlib import Path

from jinja2 import Environment
from markupsafe import Markup

from drake_screw.planning import Cause
from drake_screw.visualization.palette import OUTCOME_COLORS

_ENVIRONMENT = Environment(autoescape=True, trim_blocks=True, lstrip_blocks=True)

_CERTIFICATE = _ENVIRONMENT.from_string(
    """\
<div style="border-left: 4px solid {{ color }}; padding: 0 0.8em; max-width: 60em">
<b>{{ title }}</b>
{% for sentence in statement %}
<br>{{ sentence }}
{% endfor %}
</div>
"""
)

_RUN = _ENVIRONMENT.from_string(
    """\
<table>
{% for name, value in facts %}
<tr><th style="text-align: left">{{ name }}</th>\
<td style="text-align: left">{{ value }}</td></tr>
{% endfor %}
</table>
{{ certificate }}
{% if picture %}
<img alt="all rounds of the run" style="max-width: 100%" src="data:image/png;base64,{{ picture }}">
{% endif %}
"""
)


def certificate_html(certified: bool, statement: Sequence[str]) -> str:
    """A certificate's sentences below a heading that says whether it is one."""
    return _CERTIFICATE.render(
        title="Certificate" if certified else "No certificate",
        color=OUTCOME_COLORS[Cause.SUCCESS if certified else Cause.JOINT_LIMIT],
        statement=statement,
    )


def run_html(facts: Sequence[tuple[str, object]], certificate: str, picture: Path | None) -> str:
    """A table of facts, a certificate, and a picture.

    Args:
        facts: names and values.
        certificate: as HTML, by `certificate_html`; empty where there is none.
        picture: a PNG, which becomes a part of the text.
    """
    data = "" if picture is None else base64.b64encode(picture.read_bytes()).decode()
    return _RUN.render(facts=facts, certificate=Markup(certificate), picture=data)
