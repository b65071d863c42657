"""Execute the tutorials that the site shows, several at a time, into the cache it takes them from.

    python docs/site/execute.py

Their outputs are kept by the notebooks' code and by `sources_hash`, so only what changed is
executed. A cell that raises ends this with 1 and its traceback.
"""

import hashlib
import logging
import sys
from pathlib import Path

try:
    from jupyter_cache import get_cache
    from jupyter_cache.cache.db import NbProjectRecord
    from jupyter_cache.executors import load_executor
except ModuleNotFoundError as missing:
    sys.exit(f"{missing.name} is not installed: make docs installs it, or pip install '.[docs]'")

ROOT = Path(__file__).parents[2]
TIMEOUT = 300  # s, of a cell


def sources_hash() -> str:
    """Of all that notebooks import or load from this checkout."""
    files = [*ROOT.glob("drake_screw/**/*.py"), *ROOT.glob("models/*"), *ROOT.glob("scenarios/*")]
    content = hashlib.sha256()
    for file in sorted(files):
        content.update(str(file.relative_to(ROOT)).encode() + file.read_bytes())
    return content.hexdigest()[:16]


def cache_folder() -> Path:
    return ROOT / "build" / "executed" / sources_hash()


def main() -> None:
    logging.basicConfig(level=logging.INFO, format="%(message)s")
    cache_folder().mkdir(parents=True, exist_ok=True)
    cache = get_cache(cache_folder())
    for notebook in sorted(ROOT.glob("tutorials/*.ipynb")):
        cache.add_nb_to_project(str(notebook))
    executor = load_executor("local-parallel", cache, logger=logging.getLogger())
    result = executor.run_and_cache(timeout=TIMEOUT)
    for uri in result.excepted:
        record = NbProjectRecord.record_from_uri(uri, cache.db)
        print(f"{uri}:\n{record.traceback}", file=sys.stderr)
    failed = len(result.excepted) + len(result.errored)
    print(f"executed {len(result.succeeded)} notebooks; {failed} failed")
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
