"""Recordings from the files that people have: read, understood, checked, and put in a library."""

from drake_screw.recordings.mapping import Mapping, read_mapping
from drake_screw.recordings.raw import Raw
from drake_screw.recordings.reading import read_recordings
from drake_screw.recordings.understood import Robot, Understood

__all__ = ["Mapping", "Raw", "Robot", "Understood", "read_mapping", "read_recordings"]
