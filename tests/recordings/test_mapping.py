"""What is said of a mapping that cannot be used."""

from __future__ import annotations

from pathlib import Path

import pytest

from drake_screw.errors import RecordingError
from drake_screw.recordings.mapping import read_mapping


def test_a_wrong_value_is_answered_with_the_meaning_of_its_key(tmp_path: Path) -> None:
    file = tmp_path / "mapping.yaml"
    file.write_text("joints: [a, b]\nlengths: inches\n")
    with pytest.raises(RecordingError) as refused:
        read_mapping(file)
    assert (refused.value.file, refused.value.line) == (file, 2)
    assert "lengths" in refused.value.message
    assert refused.value.remedy == "Meaning: unit of hand positions and of joints that slide."
