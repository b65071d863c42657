"""Follow every link inside a built site: python docs/site/check_links.py build/site

Links and pictures must lead to files, and fragments to elements with that id. Links to other sites
are counted, not followed. Ends with 1 where something is dead.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from dataclasses import dataclass, field
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit


@dataclass
class _Page(HTMLParser):
    """What a page has: ids of its elements, and where its links and pictures lead."""

    ids: set[str] = field(default_factory=set)
    targets: list[str] = field(default_factory=list)

    def __post_init__(self) -> None:
        super().__init__()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        for name, value in attrs:
            if name in ("id", "name") and value:
                self.ids.add(value)
            elif name in ("href", "src") and value:
                self.targets.append(value)


def read_site(site: Path) -> dict[Path, _Page]:
    """All pages of a site, by their resolved paths."""
    pages = {}
    for file in sorted(site.resolve().rglob("*.html")):
        page = _Page()
        page.feed(file.read_text(encoding="utf-8"))
        pages[file] = page
    return pages


def dead_links(pages: dict[Path, _Page]) -> Iterator[str]:
    """A line for each link that leads nowhere."""
    for file, page in pages.items():
        for target in page.targets:
            parts = urlsplit(target)
            if parts.scheme or parts.netloc:
                continue
            there = (file.parent / unquote(parts.path)).resolve() if parts.path else file
            if not there.is_file():
                yield f"{file}: {target}: no such file"
            elif there in pages and unquote(parts.fragment) not in pages[there].ids | {""}:
                yield f"{file}: {target}: nothing there has this id"


def to_elsewhere(pages: dict[Path, _Page]) -> set[str]:
    """Addresses of other sites that the pages link to."""
    targets = {target for page in pages.values() for target in page.targets}
    return {target for target in targets if urlsplit(target).scheme in ("http", "https")}


def main() -> None:
    pages = read_site(Path(sys.argv[1]))
    dead = list(dead_links(pages))
    print(*dead, sep="\n", end="\n" if dead else "")
    count = sum(len(page.targets) for page in pages.values())
    print(
        f"{len(pages)} pages, {count} links, {len(dead)} of them dead; "
        f"{len(to_elsewhere(pages))} other addresses, which `make linkcheck` asks for"
    )
    sys.exit(1 if dead or not pages else 0)


if __name__ == "__main__":
    main()
