"""CITATION.cff agrees with the package."""

from __future__ import annotations

import tomllib
from pathlib import Path

import yaml

ROOT = Path(__file__).parents[2]


def test_version_and_licence_are_the_package_s() -> None:
    cited = yaml.safe_load((ROOT / "CITATION.cff").read_text())
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    assert cited["cff-version"] == "1.2.0"
    assert cited["title"] == project["name"].replace("-", "_")
    assert (str(cited["version"]), cited["license"]) == (project["version"], project["license"])
    assert cited["authors"] == [{"name": "The drake_screw developers"}]


def test_every_reference_has_what_the_format_asks_for() -> None:
    references = yaml.safe_load((ROOT / "CITATION.cff").read_text())["references"]
    assert [r["year"] for r in references] == [2024, 2023, 2020, 2002]
    for reference in references:
        assert {"type", "title", "authors"} <= reference.keys()
        assert all(person.keys() == {"family-names"} for person in reference["authors"])
        assert "doi" not in reference
    assert "2410.18275" in references[0]["url"]
