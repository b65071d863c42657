"""Fixtures shared by all tests."""

from __future__ import annotations

import os
import signal
import threading
from pathlib import Path

import pytest
from hypothesis import settings

settings.register_profile("shared", deadline=None)
settings.load_profile("shared")


def pytest_configure() -> None:
    """Signals end what tests start, even where nohup or a job in the background ignores them."""
    if threading.current_thread() is threading.main_thread():
        for each in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            if signal.getsignal(each) is signal.SIG_IGN:
                usual = signal.default_int_handler if each is signal.SIGINT else signal.SIG_DFL
                signal.signal(each, usual)


@pytest.fixture(scope="session")
def shared() -> Path:
    """The folder with recorded human demonstrations and reference outcomes, beside the checkout."""
    folder = Path(os.environ.get("DRAKE_SCREW_SHARED", Path(__file__).parents[2] / "shared"))
    if not (folder / "demos").is_dir():
        pytest.skip(f"recorded demonstrations not found in {folder}")
    return folder
