"""A report with everything that its runs open, as a reader sees it after a click on each."""

import base64
import gzip
import json
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any

_STORED = re.compile(
    r'<script type="text/plain" class="stored" data-run="([\w.+-]+)">(.*?)\n(.*?)</script>\n'
)


@dataclass(frozen=True)
class Opened:
    """What a run opens. html: its page. chart: description of its plots. packed: its signals."""

    html: str
    chart: dict[str, Any]
    packed: str


def opened(page: Path | str) -> dict[str, Opened]:
    """What each run of a report opens, by its ID."""
    text = page.read_text(encoding="utf-8") if isinstance(page, Path) else page
    found = {}
    for run, body, packed in _STORED.findall(text):
        content = json.loads(gzip.decompress(base64.b64decode(body)))
        found[run] = Opened(content["html"], content["chart"], packed)
    return found


def whole(page: Path | str) -> str:
    """The source of a report with every run open, below the row of each."""
    text = page.read_text(encoding="utf-8") if isinstance(page, Path) else page
    bodies = opened(text)
    for run, body in bodies.items():
        row = re.compile(rf'(<tbody id="{re.escape(run)}".*?)</tbody>', re.DOTALL)
        inner = f'<tr class="opened"><td colspan="6"><article class="run">{body.html}</article>'
        text = row.sub(lambda m, inner=inner: f"{m[1]}{inner}</td></tr></tbody>", text, count=1)
    return _STORED.sub("", text)
