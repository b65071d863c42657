"""The documentation site has every page, every public name and every verb, and no dead link."""

from __future__ import annotations

import importlib.util
import re
import sys
from pathlib import Path
from types import ModuleType

import pytest

import drake_screw

ROOT = Path(__file__).parents[2]
SITE = ROOT / "docs" / "site"
TOCTREE = re.compile(r"^```\{toctree\}\n(?:^:[^\n]*\n)*(.*?)^```", re.MULTILINE | re.DOTALL)


def load(name: str) -> ModuleType:
    """A module of the site's own, which is no package."""
    spec = importlib.util.spec_from_file_location(f"site_{name}", SITE / f"{name}.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


def in_toctrees(page: Path) -> set[str]:
    """What the toctrees of a page list, as paths from the root of the checkout without suffix."""
    entries = "\n".join(TOCTREE.findall(page.read_text())).split("\n")
    names = [re.sub(r".*<(.*)>", r"\1", entry) for entry in entries if entry]
    return {str((page.parent / name).resolve().relative_to(ROOT)) for name in names}


def test_every_page_and_tutorial_is_in_a_toctree() -> None:
    listed = in_toctrees(ROOT / "docs" / "index.md")
    listed |= in_toctrees(ROOT / "tutorials" / "README.md") | {"docs/index"}
    pages = [*ROOT.glob("docs/*.md"), *ROOT.glob("tutorials/*.*"), *ROOT.glob("docs/site/*.rst")]
    names = {str(page.relative_to(ROOT).with_suffix("")) for page in pages}
    assert sorted(names - listed) == []
    assert {name for name in listed if name.startswith(("docs", "tutorials"))} <= names | {
        "docs/site/api/index"
    }


def test_every_public_name_is_in_the_api_reference() -> None:
    """Packages with an `__all__` have a page that documents all of it, by itself or by name."""
    texts = {page.stem: page.read_text() for page in (SITE / "api").glob("*.rst")}
    found = []
    for file in sorted((ROOT / "drake_screw").glob("*/__init__.py")):
        package = file.parent.name
        names = getattr(importlib.import_module(f"drake_screw.{package}"), "__all__", ())
        if names and f"automodule:: drake_screw.{package}\n   :members:" not in texts[package]:
            found += [name for name in names if f"{package}.{name}\n" not in texts[package]]
    assert found == []
    stable = texts["drake_screw"]
    words = set(re.findall(r"[\w.]+", stable))
    missing = {
        name
        for name in drake_screw.__all__
        if name not in words and not any(word.endswith(f".{name}") for word in words)
    }
    assert missing == {"__version__"}


def test_dead_links_of_a_site_are_told(tmp_path: Path) -> None:
    check = load("check_links")
    (tmp_path / "a.html").write_text(
        '<h1 id="top">A</h1><a href="b.html#x">b</a><a href="b.html#gone">no</a>'
        '<a href="#top">up</a><img src="no.png"><a href="https://a.b/c">web</a>'
    )
    (tmp_path / "b.html").write_text('<p id="x"><a href="a.html?q=1">a</a>')
    pages = check.read_site(tmp_path)
    dead = [line.partition(": ")[2] for line in check.dead_links(pages)]
    assert dead == ["b.html#gone: nothing there has this id", "no.png: no such file"]
    assert check.to_elsewhere(pages) == {"https://a.b/c"}


def test_command_reference_is_the_help_of_every_verb() -> None:
    pytest.importorskip("docutils")
    from docutils import nodes
    from docutils.core import publish_doctree
    from docutils.parsers.rst import directives

    from drake_screw.cli import _VERBS

    directives.register_directive("command-reference", load("command_reference").CommandReference)
    tree = publish_doctree("Commands\n========\n\nWords.\n\n.. command-reference::\n")
    titles = [section[0].astext() for section in tree.findall(nodes.section)]
    assert titles == list(_VERBS)
    helps = [block.astext() for block in tree.findall(nodes.literal_block)]
    assert "Usage: drake-screw [OPTIONS] COMMAND" in helps[0]
    assert "Usage: drake-screw run [OPTIONS]" in helps[1 + titles.index("run")]
    assert "drake-screw run pouring" in helps[1 + titles.index("run")]


def test_what_cannot_be_drawn_of_a_formula_is_a_warning_and_shown_as_it_is(
    caplog: pytest.LogCaptureFixture,
) -> None:
    pytest.importorskip("sphinx")
    from docutils import nodes

    mathml = load("mathml")
    assert "<mi>x</mi>" in mathml.converted(nodes.math("", "x^2"), block=False)
    wrong = nodes.math("", r"\nosuchthing < 1")
    with caplog.at_level("WARNING"):
        assert mathml.converted(wrong, block=False) == r"<code>\nosuchthing &lt; 1</code>"
    assert "nosuchthing" in caplog.text


@pytest.mark.parametrize(
    ("formula", "warned"),
    [(r"\tfrac12 p", True), (r"\frac1{k + 1}", True), (r"\frac{1}{2} \fraction", False)],
)
def test_a_fraction_without_braces_is_a_warning_as_it_would_be_another_one(
    formula: str, warned: bool, caplog: pytest.LogCaptureFixture
) -> None:
    pytest.importorskip("sphinx")
    from docutils import nodes

    with caplog.at_level("WARNING"):
        load("mathml").converted(nodes.math("", formula), block=False)
    assert ("write \\frac{1}{2}" in caplog.text) == warned


@pytest.fixture
def execute(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    """`docs/site/execute.py` on a checkout of one module and one notebook, which raises."""
    pytest.importorskip("jupyter_cache")
    import nbformat

    module = load("execute")
    monkeypatch.setattr(module, "ROOT", tmp_path)
    for folder in ("drake_screw", "tutorials"):
        (tmp_path / folder).mkdir()
    (tmp_path / "drake_screw" / "a.py").write_text("x = 1\n")
    cells = [nbformat.v4.new_code_cell("1 / 0")]
    nbformat.write(nbformat.v4.new_notebook(cells=cells), tmp_path / "tutorials" / "bad.ipynb")
    return module


def test_without_the_extra_docs_its_name_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "jupyter_cache", None)
    with pytest.raises(SystemExit, match=r"jupyter_cache is not installed.*'\.\[docs\]'"):
        load("execute")


def test_outputs_are_kept_by_what_they_were_made_with(execute: ModuleType) -> None:
    before = execute.cache_folder()
    assert execute.cache_folder() == before
    (execute.ROOT / "drake_screw" / "a.py").write_text("x = 2\n")
    assert execute.cache_folder() != before


def test_a_tutorial_that_raises_fails_the_build(
    execute: ModuleType, capfd: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as ended:
        execute.main()
    assert ended.value.code == 1
    out, err = capfd.readouterr()
    assert "executed 0 notebooks; 1 failed" in out
    assert "bad.ipynb:" in err
    assert "division by zero" in err
