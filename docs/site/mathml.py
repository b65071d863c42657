"""Sphinx math renderer ``mathml``: formulas as MathML, so that pages need no network for them."""

import re
from html import escape

from docutils import nodes
from docutils.utils.math import MathError, latex2mathml
from sphinx.application import Sphinx
from sphinx.util import logging
from sphinx.writers.html5 import HTML5Translator

_log = logging.getLogger(__name__)


def _inline(translator: HTML5Translator, node: nodes.math) -> None:
    translator.body.append(converted(node, block=False))
    raise nodes.SkipNode


def _block(translator: HTML5Translator, node: nodes.math_block) -> None:
    translator.body.append(f'<div class="math">{converted(node, block=True)}</div>\n')
    raise nodes.SkipNode


def converted(node: nodes.math | nodes.math_block, *, block: bool) -> str:
    """A formula as MathML; one that docutils cannot read is warned of, and shown as it is."""
    bare = re.search(r"\\[dt]?frac(?![a-zA-Z])\s*[^{\s]+", node.astext())
    if bare:
        _log.warning(
            "%s: docutils takes other arguments than TeX does; write \\frac{1}{2}",
            bare[0],
            location=node,
        )
    try:
        return latex2mathml.tex2mathml(node.astext(), as_block=block)
    except MathError as error:
        _log.warning("formula that cannot be drawn: %s", error, location=node)
        return f"<code>{escape(node.astext())}</code>"


def setup(app: Sphinx) -> dict[str, bool]:
    app.add_html_math_renderer("mathml", (_inline, None), (_block, None))
    return {"parallel_read_safe": True, "parallel_write_safe": True}
