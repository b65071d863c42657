"""Meshcat's own page with more HTML in it, and the Jinja2 templates such HTML is made from."""

from __future__ import annotations

from functools import cache
from importlib.resources import files
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup, escape

_NOTHING = Markup()
_VIEWPORT = Markup('<meta name="viewport" content="width=device-width, initial-scale=1">')


def add_to_page(page: str, html: Markup, *, title: str, head: Markup = _NOTHING) -> str:
    """Meshcat's page with a title of its own, as wide as the screen, and HTML at its body's end.

    Args:
        page: as Meshcat serves it, or as `Meshcat.StaticHtml` gives it.
        html: to add.
        title: in place of Meshcat's.
        head: to begin the page's head with.
    """
    page = page.replace("<title>Drake MeshCat</title>", f"<title>{escape(title)}</title>", 1)
    page = page.replace("<head>", f"<head>\n{_VIEWPORT}\n{head}", 1)
    before, end, after = page.rpartition("</body>")
    return f"{before}{html}{end}{after}"


def render(package: str, template: str, **values: Any) -> Markup:
    """HTML by a template of a package's folder ``templates``.

    Values are escaped, and all that a template names must be given. In a template ``asset(name)``
    is a file of the package's folder ``static`` as it stands, and ``value|tojson`` is data as a
    script may contain it.

    Args:
        package: the package's name.
        template: the file's name.
        values: by the names that the template uses.
    """
    return Markup(_environment(package).get_template(template).render(values))


@cache
def _environment(package: str) -> Environment:
    def asset(name: str) -> Markup:
        return Markup((files(package) / "static" / name).read_text(encoding="utf-8"))

    environment = Environment(
        loader=PackageLoader(package),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.globals["asset"] = asset
    environment.policies["json.dumps_kwargs"] = {"separators": (",", ":")}
    return environment
