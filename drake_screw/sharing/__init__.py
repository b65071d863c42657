"""Work shared out among processes, of this machine or of a cluster."""

from drake_screw.sharing.crew import Crew, Workers, share_out
from drake_screw.sharing.executor import Executor, SharingError, WorkerLost
from drake_screw.sharing.processes import processors

__all__ = [
    "Crew",
    "Executor",
    "SharingError",
    "WorkerLost",
    "Workers",
    "processors",
    "share_out",
]
