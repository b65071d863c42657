"""Recordings of demonstrations, and the guiding poses extracted from them."""

from drake_screw.demonstrations.demonstration import Demonstration, demonstration_from_recording
from drake_screw.demonstrations.deviations import Deviations
from drake_screw.demonstrations.faithful import FaithfulConfig, faithful_guiding_poses
from drake_screw.demonstrations.fidelity import Fidelity
from drake_screw.demonstrations.library import read_library, read_recording, write_recording
from drake_screw.demonstrations.look import Look, look_at
from drake_screw.demonstrations.recording import Recording
from drake_screw.demonstrations.refusal import NoMotionKept
from drake_screw.demonstrations.segmentation import SegmentationConfig, guiding_poses, segment

__all__ = [
    "Demonstration",
    "Deviations",
    "FaithfulConfig",
    "Fidelity",
    "Look",
    "NoMotionKept",
    "Recording",
    "SegmentationConfig",
    "demonstration_from_recording",
    "faithful_guiding_poses",
    "guiding_poses",
    "look_at",
    "read_library",
    "read_recording",
    "segment",
    "write_recording",
]
