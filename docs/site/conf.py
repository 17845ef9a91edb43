"""Settings of the documentation site; `make docs` builds it.

Pages are the Markdown files of the repository as they are. The groups of `docs/index.md` are the
navigation; a page that is in none of them stops the build, and so does a link that leads nowhere.
"""

import re
import shutil
from pathlib import Path

from sphinx.application import Sphinx

ROOT = Path(__file__).parents[2]
INDEX = ROOT / "docs" / "index.md"

project = "axisrig"
author = "axisrig"
copyright = "axisrig, Apache-2.0"  # noqa: A001 - the name that Sphinx reads
root_doc = "README"
include_patterns = ["*.md", "docs/**.md", "fmus/README.md"]
exclude_patterns = [".venv/**", "out/**", "wheelhouse/**", ".pytest_cache/**", "tests/**"]
extensions = ["myst_parser"]
source_suffix = {".md": "markdown"}
myst_heading_anchors = 4
nitpicky = True
suppress_warnings = ["myst.header", "misc.highlighting_failure"]

# Nothing is loaded from elsewhere: furo uses the fonts of the system and brings its own script
html_theme = "furo"
html_title = "axisrig"
html_static_path = ["wide.css"]
html_css_files = ["wide.css"]
html_copy_source = False
html_show_sphinx = False
pygments_style = "default"
highlight_language = "none"

_LINK = re.compile(r"\]\(([^)#]+\.md)\)")


def _groups() -> str:
    """Return hidden tables of contents, one for each second-level heading of the index."""
    text = INDEX.read_text(encoding="utf-8")
    parts = []
    for section in text.split("\n## ")[1:]:
        title, _, body = section.partition("\n")
        targets = [(INDEX.parent / link).resolve() for link in _LINK.findall(body)]
        pages = [str(path.relative_to(ROOT).with_suffix("")) for path in targets]
        pages = ["docs/index" if page == root_doc else page for page in pages]
        head = ["", "```{toctree}", ":hidden:", f":caption: {title}", ""]
        parts.append("\n".join([*head, *(f"/{page}" for page in pages), "```", ""]))
    return "\n".join(parts)


def _navigation(app: Sphinx, name: str, source: list[str]) -> None:
    """Give the first page the groups of the index as its navigation."""
    if name == root_doc:
        source[0] += "\n" + _groups()


def _first_page(app: Sphinx, failure: Exception | None) -> None:
    """A site is opened by its index.html."""
    if failure is None:
        shutil.copyfile(Path(app.outdir) / f"{root_doc}.html", Path(app.outdir) / "index.html")


def setup(app: Sphinx) -> None:
    """Connect what Sphinx has no setting for."""
    app.connect("source-read", _navigation)
    app.connect("build-finished", _first_page)
