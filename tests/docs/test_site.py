"""`make docs`: the site builds without a warning and loads nothing from elsewhere."""

import re
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
MODULES = ("sphinx", "furo", "myst_parser")
# What a page loads by itself; a link that a reader follows is none of it
LOADS = re.compile(
    r"<(?:script|img|iframe|source|embed|object)\b[^>]*?\b(?:src|data)=[\"'](?:https?:)?//"
    r"|<link\b[^>]*?\brel=[\"'][^\"']*(?:stylesheet|icon|preload|preconnect|font)[^>]*?"
    r"\bhref=[\"'](?:https?:)?//"
    r"|<link\b[^>]*?\bhref=[\"'](?:https?:)?//[^>]*?\brel=[\"'][^\"']*"
    r"(?:stylesheet|icon|preload|preconnect|font)"
)
STYLE_LOADS = re.compile(r"@import|url\(\s*[\"']?(?:https?:)?//")


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    missing = [name for name in MODULES if find_spec(name) is None]
    if missing:
        pytest.skip(f"{', '.join(missing)} not installed: pip install -e '.[docs]', or make docs")
    folder = tmp_path_factory.mktemp("site")
    words = ["-W", "--keep-going", "-q", "-b", "html", "-d", str(folder / "cache")]
    done = subprocess.run(
        [sys.executable, "-m", "sphinx", *words, "-c", "docs/site", ".", str(folder / "html")],
        cwd=ROOT, capture_output=True, text=True, timeout=300, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    return folder / "html"


@pytest.mark.long
def test_the_first_page_has_every_group_and_the_sample(site: Path) -> None:
    text = (site / "index.html").read_text("utf-8")
    groups = re.findall(r"^## (.+)$", (ROOT / "docs" / "index.md").read_text("utf-8"), re.MULTILINE)
    assert len(groups) > 8
    assert all(group in re.findall(r'caption-text">([^<]+)<', text) for group in groups)
    (sample,) = set(re.findall(r'href="(_downloads/\w+/report\.html)"', text))
    assert (site / sample).is_file()


@pytest.mark.long
def test_every_document_is_a_page(site: Path) -> None:
    pages = [*(ROOT / "docs").rglob("*.md"), ROOT / "README.md", ROOT / "CONTRIBUTING.md"]
    names = [path.relative_to(ROOT).with_suffix(".html") for path in pages]
    assert [name for name in names if not (site / name).is_file()] == []


@pytest.mark.long
def test_nothing_is_loaded_from_elsewhere(site: Path) -> None:
    pages = sorted(site.rglob("*.html"))
    assert len(pages) > 40
    assert [path.name for path in pages if LOADS.search(path.read_text("utf-8"))] == []
    styles = sorted(site.rglob("*.css"))
    assert styles
    assert [path.name for path in styles if STYLE_LOADS.search(path.read_text("utf-8"))] == []


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ('<script src="https://cdn.example/x.js"></script>', True),
        ('<script async src="//cdn.example/x.js"></script>', True),
        ('<script src="_static/x.js"></script>', False),
        ('<link rel="stylesheet" href="https://fonts.example/x.css">', True),
        ('<link href="https://fonts.example" rel="preconnect">', True),
        ('<link rel="stylesheet" type="text/css" href="_static/furo.css?v=1" />', False),
        ('<a href="https://github.com/modelica/Reference-FMUs">x</a>', False),
        ('<img src="http://example.org/badge.svg">', True),
    ],
)
def test_the_search_finds_what_loads(text: str, found: bool) -> None:
    assert (LOADS.search(text) is not None) is found
