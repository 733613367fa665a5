"""The site builds without a warning, is whole, and asks no other host for anything."""

import os
import re
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass, field
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urldefrag, urlsplit

import pytest

from tests.docs.pages import PAGES, ROOT, name_of

LOADED = {
    "link": ("href",),
    "script": ("src",),
    "img": ("src", "srcset"),
    "source": ("src", "srcset"),
    "iframe": ("src",),
    "embed": ("src",),
    "object": ("data",),
    "video": ("src", "poster"),
    "audio": ("src",),
    "use": ("href", "xlink:href"),
    "image": ("href", "xlink:href"),
    "form": ("action",),
    "base": ("href",),
}
"""what a browser fetches, or sends to, without a click on a link"""

NAMES_ONLY = re.compile(
    r"https?://(?:www\.w3\.org|fontawesome\.com|clipboardjs\.com|lunrjs\.com|tartarus\.org|bit\.ly)"
)
"""in scripts and styles: names of formats, licences, and what error messages refer to"""

REPOSITORY = re.compile(r"https://(?:api\.github\.com|\$\{)")
"""asked for counts of a repository when a page shows one, which none does"""


@dataclass
class Page(HTMLParser):
    """What a page refers to; it grows while it is read."""

    loaded: list[str] = field(default_factory=list)
    links: list[str] = field(default_factory=list)
    anchors: set[str] = field(default_factory=set)
    components: set[str] = field(default_factory=set)
    text: str = ""

    def __post_init__(self) -> None:
        super().__init__()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        for name, value in attrs:
            if value is None:
                continue
            if name in LOADED.get(tag, ()):
                self.loaded.append(value)
            if tag == "a" and name == "href":
                self.links.append(value)
            if name in {"id", "name"}:
                self.anchors.add(value)
            if name == "data-md-component":
                self.components.add(value)
            if name == "style":
                self.loaded += addresses_in_style(value)

    def handle_data(self, data: str) -> None:
        self.text += data


def read(path: Path) -> Page:
    page = Page()
    page.feed(path.read_text(encoding="utf-8"))
    return page


def addresses_in_style(text: str) -> list[str]:
    found = re.findall(r"url\(\s*[\"']?([^\"')]+)|@import\s+[\"']([^\"']+)", text)
    return [first or second for first, second in found]


def is_elsewhere(address: str) -> bool:
    return bool(urlsplit(address).netloc) or address.startswith("//")


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("site")
    done = subprocess.run(
        [sys.executable, "-m", "mkdocs", "build", "--strict", "--site-dir", str(folder)],
        cwd=ROOT, env={**os.environ, "NO_MKDOCS_2_WARNING": "1"},
        capture_output=True, text=True, timeout=300, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout + done.stderr
    assert "WARNING" not in done.stdout + done.stderr
    return folder


def html(site: Path) -> Iterator[Path]:
    return (path for path in site.rglob("*.html") if path.name != "404.html")


def test_every_page_is_built(site: Path) -> None:
    built = {path.relative_to(site).as_posix() for path in html(site)}
    wanted = {name_of(page).removesuffix(".md") + ".html" for page in PAGES}
    wanted |= {
        f"{each}.html"
        for each in ("reference/commands", "reference/errors", "reference/entities",
                         "reference/files", "changelog", "decisions/index")
    }  # fmt: skip
    assert wanted <= built
    assert built - wanted <= {"reference/rest.html"}


def test_no_code_of_the_site_is_published(site: Path) -> None:
    assert not list(site.rglob("*.py"))
    assert not (site / "hooks").exists()


def test_pages_load_nothing_from_another_host(site: Path) -> None:
    for path in site.rglob("*.html"):
        page = read(path)
        assert [each for each in page.loaded if is_elsewhere(each)] == [], path.name
        inside = re.findall(r"<style[^>]*>(.*?)</style>", path.read_text("utf-8"), flags=re.S)
        for style in inside:
            assert not any(map(is_elsewhere, addresses_in_style(style)))


def test_scripts_and_styles_know_no_other_host(site: Path) -> None:
    for path in (*site.rglob("*.css"), *site.rglob("*.js")):
        text = path.read_text(encoding="utf-8")
        if path.suffix == ".css":
            assert not any(map(is_elsewhere, addresses_in_style(text))), path.name
        rest = REPOSITORY.sub("", NAMES_ONLY.sub("", text))
        assert re.findall(r"https?://[^\s\"'`)]+", rest) == [], path.name


def test_no_page_shows_a_repository_whose_counts_would_be_fetched(site: Path) -> None:
    for path in html(site):
        assert "source" not in read(path).components


def test_every_relative_link_and_file_resolves(site: Path) -> None:
    pages = {path: read(path) for path in html(site)}
    for path, page in pages.items():
        for address in (*page.links, *page.loaded):
            if is_elsewhere(address) or urlsplit(address).scheme:
                continue
            place, anchor = urldefrag(address)
            target = (path.parent / unquote(urlsplit(place).path)).resolve() if place else path
            target = target / "index.html" if target.is_dir() else target
            assert target.exists(), f"{path.name}: {address}"
            # The theme's own mark for the top of a page has no element in it.
            if anchor and target in pages and not anchor.startswith("__"):
                assert unquote(anchor) in pages[target].anchors, f"{path.name}: {address}"


def test_links_to_other_hosts_are_few_and_meant(site: Path) -> None:
    hosts = {
        urlsplit(link).netloc
        for path in html(site)
        for link in read(path).links
        if is_elsewhere(link)
    }
    assert hosts <= {"doi.org", "127.0.0.1:8000"}


def test_every_page_is_in_the_navigation(site: Path) -> None:
    links = set(read(site / "index.html").links)
    for path in html(site):
        assert path.relative_to(site).as_posix() in links


def test_the_search_index_is_local_and_finds_text(site: Path) -> None:
    index = (site / "search" / "search_index.json").read_text(encoding="utf-8")
    assert "tool deflection" in index
    assert "nomenclature.html" in index
