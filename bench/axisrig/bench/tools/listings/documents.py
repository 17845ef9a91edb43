"""The pages of the documents, as a checkout or an installed wheel has them."""

import shutil
from importlib import resources
from pathlib import Path

from axisrig.kernel.errors import UserError, nearest
from axisrig.reports import glossary

NOTEBOOK = "results.ipynb"


def folder() -> Path:
    """Return the folder of the documents. Raises UserError where an installation has none."""
    packaged = Path(str(resources.files("axisrig.reports").joinpath(glossary.PACKAGED)))
    found = packaged if packaged.is_dir() else glossary.CHECKOUT.parent
    if not (found / "index.md").is_file():
        raise UserError("the documents are missing", file=found, hint="install axisrig again")
    return found


def pages() -> dict[str, str]:
    """Return the title of each page by its name, in alphabetical order."""
    names = sorted(folder().glob("*.md"))
    return {path.stem: _title(path.read_text(encoding="utf-8")) for path in names}


def listing() -> str:
    """Say where the documents are, and each page with its title."""
    known = pages()
    width = max(map(len, known))
    lines = [f"{name:<{width}}  {title}" for name, title in known.items()]
    return "\n".join([str(folder()), *lines])


def page(name: str) -> Path:
    """Return the file of a page. Raises UserError for one that is missing, with near names."""
    known = pages()
    stem = name.removesuffix(".md")
    if stem not in known:
        near = list(nearest(stem, known))
        raise UserError(
            "no such page",
            value=name,
            allowed=near or None,
            hint="`axisrig docs` lists the pages",
        )
    return folder() / f"{stem}.md"


def copy_notebook(into: Path) -> Path:
    """Copy the notebook about results. Raises UserError where the file is there already."""
    path = into / NOTEBOOK if into.is_dir() else into
    if path.exists():
        raise UserError("the file is there already", file=path)
    shutil.copyfile(folder() / NOTEBOOK, path)
    return path


def _title(text: str) -> str:
    heads = (line.removeprefix("# ") for line in text.splitlines() if line.startswith("# "))
    return next(heads, "")
