"""What the program logs, to standard error."""

from __future__ import annotations

import logging
import sys

_BRIEF = logging.Formatter("%(message)s")
_VERBOSE = logging.Formatter("%(asctime)s %(levelname)s %(name)s: %(message)s")


class _StandardError(logging.Handler):
    """Prints to what is the standard error then: a progress bar may have taken its place."""

    def emit(self, record: logging.LogRecord) -> None:
        print(self.format(record), file=sys.stderr)


def _worth_reading(record: logging.LogRecord) -> bool:
    return record.levelno >= logging.WARNING


def set_up_logging(*, verbose: bool = False) -> None:
    """Show messages of drake_screw, and warnings of Drake.

    Importing pydrake sets its logger's level, so its messages are filtered instead.

    Args:
        verbose: show all of drake_screw's messages, with their times.
    """
    drake, own = logging.getLogger("drake"), logging.getLogger("drake_screw")
    drake.addFilter(_worth_reading)
    if not any(isinstance(handler, _StandardError) for handler in own.handlers):
        own.addHandler(_StandardError())
    for handler in own.handlers:
        handler.setFormatter(_VERBOSE if verbose else _BRIEF)
    own.propagate = False  # importing pydrake gives the root logger a handler of its own
    own.setLevel(logging.DEBUG if verbose else logging.INFO)
