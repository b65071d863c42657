"""What the program logs, to standard error."""

from __future__ import annotations

import logging
import sys

from drake_screw.commands.drake_warnings import READER, Gathered, WhenRead

_BRIEF = logging.Formatter("%(message)s")
_VERBOSE = logging.Formatter("%(asctime)s %(levelname)s %(name)s: %(message)s")


class _StandardError(logging.Handler):
    """Prints to what is the standard error then: a progress bar may have taken its place."""

    def emit(self, record: logging.LogRecord) -> None:
        print(self.format(record), file=sys.stderr)


def set_up_logging(*, verbose: bool = False) -> None:
    """Show messages of drake_screw, and warnings of Drake: those about models in short.

    Importing pydrake sets its logger's level, so its messages are filtered instead.

    Args:
        verbose: show all of drake_screw's messages, with their times, and Drake's in full.
    """
    drake, own = logging.getLogger("drake"), logging.getLogger("drake_screw")
    gathered, reader = Gathered(full=verbose), logging.getLogger(READER)
    for logger, new in ((drake, gathered), (reader, WhenRead(gathered))):
        for old in [f for f in logger.filters if isinstance(f, (Gathered, WhenRead))]:
            logger.removeFilter(old)
        logger.addFilter(new)
    reader.setLevel(logging.DEBUG)
    if not logging.root.handlers:  # or Drake's first message adds one that says all again
        logging.root.addHandler(logging.NullHandler())
    for logger in (drake, own):
        if not any(isinstance(handler, _StandardError) for handler in logger.handlers):
            logger.addHandler(_StandardError())
        for handler in logger.handlers:
            handler.setFormatter(_VERBOSE if verbose else _BRIEF)
    own.setLevel(logging.DEBUG if verbose else logging.INFO)
