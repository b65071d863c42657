"""A design as a scenario's file and a picture beside it, tried before they are written."""

from __future__ import annotations

import os
from pathlib import Path

from drake_screw.assembly.preview import preview
from drake_screw.files import WRITABLE_OUTPUT, write_text, writing
from drake_screw.onboarding.design import Design
from drake_screw.onboarding.picture import save_reach_picture
from drake_screw.onboarding.write import scenario_name, scenario_text
from drake_screw.scenario.loader import load_scenario


def write_scenario(design: Design, file: Path, command: str) -> Path:
    """Write a scenario and its picture, after it was read back and all that it names was built.

    Args:
        design: what was found.
        file: to appear, with the picture beside it.
        command: that it is written by, for its first line.

    Returns:
        The picture's file.

    Raises:
        DrakeScrewError: the scenario cannot be used, or a file cannot be written. Neither is.
    """
    name = scenario_name(file.stem)
    text = scenario_text(design, name, file.parent, command).replace(" FILE ", f" {file} ")
    tried = file.with_name(f".{file.stem}.part{file.suffix}")
    picture = file.with_name(f"{file.stem}_reach.png")
    with writing(file, WRITABLE_OUTPUT):
        try:
            write_text(tried, text)
            preview(load_scenario(tried))
            save_reach_picture(design, picture)
            os.replace(tried, file)
        finally:
            tried.unlink(missing_ok=True)
    return picture
