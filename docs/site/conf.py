"""The documentation site, built by ``make docs``. Its source folder is the root of the checkout."""

import posixpath
import re
import sys
from importlib.metadata import version as version_of
from pathlib import Path
from typing import Any

from docutils import nodes
from sphinx.addnodes import pending_xref
from sphinx.application import Sphinx

SITE = Path(__file__).parent
sys.path.insert(0, str(SITE))

from execute import TIMEOUT, cache_folder  # noqa: E402

project = "drake_screw"
author = "the drake_screw contributors"
version = release = version_of("drake-screw")

NAMED_TYPES = ("Array", "ArrayLike", "InstanceLike", "PathLike", "PlaceLike")
"""What signatures call by these names, and not by all that may stand for them."""

extensions = [
    "myst_nb",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx.ext.viewcode",
    "sphinx_copybutton",
    "command_reference",
    "mathml",
]
include_patterns = ["docs/**", "tutorials/*", "README.md", "CHANGELOG.md", "CONTRIBUTING.md"]
exclude_patterns = [".venv", "build", "runs", "studies", "**/.ipynb_checkpoints"]
source_suffix = {".md": "myst-nb", ".ipynb": "myst-nb", ".rst": "restructuredtext"}
root_doc = "docs/index"

html_theme = "furo"
pygments_dark_style = "monokai"  # the default underlines modules as if they were links
html_title = f"drake_screw {version}"
html_static_path = ["static"]
html_css_files = ["site.css"]
html_extra_path = ["root"]
html_math_renderer = "mathml"
html_copy_source = False
html_show_copyright = False

myst_enable_extensions = ["amsmath", "colon_fence", "dollarmath"]
myst_heading_anchors = 4
myst_links_external_new_tab = False

nb_execution_mode = "cache"
nb_execution_cache_path = str(cache_folder())
nb_execution_timeout = TIMEOUT
nb_execution_raise_on_error = True
nb_merge_streams = True

default_role = "py:obj"
autodoc_typehints = "signature"
autodoc_member_order = "bysource"
autodoc_preserve_defaults = True
autodoc_type_aliases = {name: name for name in NAMED_TYPES}
napoleon_google_docstring = True
napoleon_numpy_docstring = False
napoleon_use_ivar = False
napoleon_attr_annotations = False
napoleon_custom_sections = [("Input ports", "params_style"), ("Output ports", "params_style")]

nitpicky = True
nitpick_ignore_regex = [
    ("py:obj", ".*"),  # names in single backticks: a link where there is one, code elsewhere
    ("py:class", ".*"),  # types in signatures, likewise; other libraries are not looked up
]

linkcheck_timeout = 20
linkcheck_anchors = False


def setup(app: Sphinx) -> None:
    app.connect("autodoc-process-docstring", _keep_first_line, priority=400)
    app.connect("autodoc-process-signature", _short_types)
    app.connect("doctree-read", _look_up_nearby)
    app.connect("doctree-resolved", _titles_for_files)
    app.connect("html-page-context", _without_way_back)
    app.connect("html-page-context", _without_network)


def _keep_first_line(
    app: Sphinx, what: str, name: str, obj: object, options: object, lines: list[str]
) -> None:
    """Napoleon takes what is before a colon in the first line of an attribute for its type."""
    if what in ("attribute", "data", "property"):
        lines.insert(0, "")


def _short_types(
    app: Sphinx, what: str, name: str, obj: object, options: object, *parts: str | None
) -> tuple[str | None, ...]:
    """Names of types instead of what autodoc puts for them inside other types."""
    named = re.compile(r"TypeAliasForwardRef\('(\w+)'\)")
    return tuple(text and named.sub(r"\1", text) for text in parts)


def _look_up_nearby(app: Sphinx, doctree: nodes.document) -> None:
    """Only classes are known by their names alone; `q` is not any attribute that is called so."""
    for reference in doctree.findall(pending_xref):
        if not re.match("[A-Z][a-z]", reference["reftarget"]):
            reference.attributes.pop("refspecific", None)


def _titles_for_files(app: Sphinx, doctree: nodes.document, page: str) -> None:
    """A link that a reader of the repository sees as `python.md` has the page's title here."""
    for link in doctree.findall(nodes.reference):
        address = posixpath.join(posixpath.dirname(page), link.get("refuri", "").partition("#")[0])
        target = posixpath.splitext(posixpath.normpath(address))[0]
        if re.fullmatch(r"[\w./]+\.md", link.astext()) and target in app.env.titles:
            link[:] = [nodes.Text(app.env.titles[target].astext())]


def _without_way_back(
    app: Sphinx, page: str, template: str, context: dict[str, Any], doctree: nodes.document | None
) -> None:
    """Source pages lead back by one package's names for a module; others' would be dead links."""
    if page.startswith("_modules/"):
        context["body"] = re.sub('<a class="viewcode-back".*?</a>', "", context["body"])


def _without_network(
    app: Sphinx, page: str, template: str, context: dict[str, Any], doctree: nodes.document | None
) -> None:
    """Matplotlib's player asks another site for the symbols on its buttons; site.css has some."""
    if "body" in context:
        context["body"] = re.sub(
            r'<link rel="stylesheet"\s+href="https?://[^"]*">', "", context["body"]
        )
