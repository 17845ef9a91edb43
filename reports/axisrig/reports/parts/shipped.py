"""Files that come with this package: tables, style sheet, scripts."""

import csv
from importlib import resources
from typing import Any

from markupsafe import Markup

_PACKAGE = "axisrig.reports"


def shipped_text(name: str, package: str = _PACKAGE) -> str:
    """Return a text file of a package, by its path below it."""
    return resources.files(package).joinpath(name).read_text(encoding="utf-8")


def shipped_table(name: str) -> list[dict[str, Any]]:
    """Return the rows of a CSV file of `axisrig.reports`."""
    return list(csv.DictReader(shipped_text(name).splitlines()))


def page_style() -> Markup:
    """Return what goes into the element `style` of a page: colours, tables, plots."""
    return Markup(shipped_text("vendor/uplot/uPlot.min.css") + shipped_text("style.css"))


def plot_scripts() -> Markup:
    """Return what goes into an element `script` before the script of a page that draws plots.

    uPlot, the inflate of pako, the lane of NC blocks, and `plots.js`, which gives `axisrigPlots`.
    """
    names = (
        *("vendor/uplot/uPlot.iife.min.js", "vendor/pako/pako_inflate.min.js"),
        *("blocks/lane.js", "plots.js"),
    )
    return Markup("\n".join(shipped_text(name) for name in names))


def licences() -> list[tuple[str, str]]:
    """Return name and licence of what `plot_scripts` contains of others."""
    return [
        ("uPlot draws the plots", shipped_text("vendor/uplot/LICENSE")),
        ("pako unpacks the runs", shipped_text("vendor/pako/LICENSE")),
    ]
