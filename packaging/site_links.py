"""Every link of a built site: those within it have to lead somewhere, and nothing may be loaded from elsewhere.

`python3 packaging/site_links.py SITE` ends with what is lost, and prints the addresses elsewhere that pages link to.
They are not asked.
"""

import sys
from collections.abc import Iterator
from dataclasses import dataclass, field
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

LOADED = {"img": "src", "script": "src", "link": "href", "source": "src", "iframe": "src", "object": "data"}
NAMED_ELSEWHERE = {"canonical", "alternate", "license"}  # links of a page's head that load nothing


@dataclass
class SitePage(HTMLParser):
    """What a page links to, what it loads, and what of it can be linked to."""

    linked: list[str] = field(default_factory=list)
    loaded: list[str] = field(default_factory=list)
    anchors: set[str] = field(default_factory=set)

    def __post_init__(self) -> None:
        super().__init__()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        found = {name: value or "" for name, value in attrs}
        self.anchors |= {found[name] for name in ("id", "name") if name in found}
        if tag == "a" and "href" in found:
            self.linked.append(found["href"])
        target = found.get(LOADED.get(tag, ""))
        if target and found.get("rel") not in NAMED_ELSEWHERE:
            self.loaded.append(target)


def main(site: Path) -> None:
    pages = read_site(site)
    lost = sorted(set(lost_links(pages)))
    for address in sorted({link for page in pages.values() for link in page.linked if is_elsewhere(link)}):
        print(f"not asked: {address}")
    if lost:
        sys.exit("\n".join(f"{page.relative_to(site)}: {why}" for page, why in lost))
    print(f"{len(pages)} pages, {sum(len(page.linked) + len(page.loaded) for page in pages.values())} links.")


def read_site(site: Path) -> dict[Path, SitePage]:
    pages = {}
    for file in sorted(site.rglob("*.html")):
        pages[file.resolve()] = page = SitePage()
        page.feed(file.read_text(encoding="utf-8"))
    return pages


def lost_links(pages: dict[Path, SitePage]) -> Iterator[tuple[Path, str]]:
    """Give each page with what it links to in vain, and what it would load from elsewhere."""
    for file, page in pages.items():
        if file.name == "404.html":  # a server shows it at any address, so its links begin at the root
            continue
        yield from ((file, f"{target} is loaded from elsewhere") for target in page.loaded if is_elsewhere(target))
        for link in {*page.linked, *page.loaded}:
            if is_elsewhere(link) or link.startswith(("data:", "mailto:", "javascript:")):
                continue
            parts = urlsplit(link)
            there = (file.parent / unquote(parts.path)).resolve() if parts.path else file
            if not there.is_file():
                yield file, f"{link} leads to no file"
            elif parts.fragment and there in pages and not is_there(unquote(parts.fragment), pages[there]):
                yield file, f"{link} leads to no place of its page"


def is_there(anchor: str, page: SitePage) -> bool:
    return anchor in page.anchors or anchor in {"only-light", "only-dark"}


def is_elsewhere(link: str) -> bool:
    return link.startswith("//") or urlsplit(link).scheme in {"http", "https"}


if __name__ == "__main__":
    main(Path(sys.argv[1]))
