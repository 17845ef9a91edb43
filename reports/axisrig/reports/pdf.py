"""The report as PDF, printed by a Chromium that is found on this machine."""

import shutil
import subprocess
import tempfile
from pathlib import Path

from axisrig.kernel.errors import UserError

NAMES = (
    "chromium",
    "chromium-browser",
    "google-chrome",
    "google-chrome-stable",
    "chrome",
    "msedge",
)
PLACES = (
    "/Applications/Google Chrome.app/Contents/MacOS/Google Chrome",
    "/Applications/Chromium.app/Contents/MacOS/Chromium",
    "C:/Program Files/Google/Chrome/Application/chrome.exe",
    "C:/Program Files (x86)/Microsoft/Edge/Application/msedge.exe",
)
LIMIT_S = 180.0
_FLAGS = (
    *("--headless=new", "--disable-gpu", "--no-first-run", "--disable-extensions"),
    *("--disable-background-networking", "--disable-component-update", "--disable-sync"),
    *("--disable-dev-shm-usage", "--no-pdf-header-footer", "--no-proxy-server"),
    "--no-sandbox",  # the page is of this machine, and a container has no sandbox
)


def browser() -> str | None:
    """Return the path of a Chromium, None where none is found."""
    named = (shutil.which(name) for name in NAMES)
    return next((path for path in (*named, *PLACES) if path and Path(path).is_file()), None)


def print_pdf(report: Path) -> Path:
    """Print a report beside it, as the button of the page does, and return the path.

    Raises UserError where no Chromium is found, or where it wrote nothing.
    """
    path = browser()
    if path is None:
        raise UserError(
            "no Chromium is found to print with",
            allowed=NAMES,
            hint="install one, or print the report with the button of the page",
        )
    pdf = report.with_suffix(".pdf").resolve()
    pdf.unlink(missing_ok=True)
    with tempfile.TemporaryDirectory(prefix="axisrig-pdf-", ignore_cleanup_errors=True) as folder:
        words = [path, *_FLAGS, f"--user-data-dir={folder}", f"--print-to-pdf={pdf}"]
        try:
            done = subprocess.run(
                [*words, report.resolve().as_uri()],
                check=False,
                capture_output=True,
                timeout=LIMIT_S,
                text=True,
            )
        except subprocess.TimeoutExpired as error:
            raise UserError(f"{path} did not end within {LIMIT_S:g} s", file=report) from error
    if not pdf.is_file():
        last = (done.stderr.strip().splitlines() or ["it said nothing"])[-1]
        raise UserError(f"{path} wrote no PDF: {last}", file=report)
    return pdf
