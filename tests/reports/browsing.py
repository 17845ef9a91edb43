"""What a reader does with a report in a real browser, and the text that others may have put in."""

import json
from typing import Any

from tests.tools.chromium import Browser

HOSTILE = (
    """</script><script>document.title = "taken"</script><img src=x onerror="alert(1)">"' ä €"""
)


def shown(page: Browser) -> list[str]:
    """The runs whose rows are seen, from top to bottom."""
    found = page.run(
        "[...document.querySelectorAll('.verdicts > tbody')].filter((b) => b.offsetHeight)"
        ".map((b) => b.dataset.run)"
    )
    return list(found)


def find(page: Browser, words: str) -> None:
    page.run(
        f"(() => {{ const f = document.getElementById('find'); f.value = {json.dumps(words)};"
        " f.dispatchEvent(new Event('input')); })()"
    )


def click(page: Browser, selector: str) -> None:
    page.run(f"document.querySelector({json.dumps(selector)}).click()")


def open_run(page: Browser, run: str) -> None:
    click(page, f"[id='{run}'] .opens")


def mouse(page: Browser, kind: str, x: float, y: float, buttons: int, **more: Any) -> None:
    what = {"type": kind, "x": x, "y": y, "button": "left", "buttons": buttons, "clickCount": 1}
    page.call("Input.dispatchMouseEvent", **{**what, **more})
    page.run("new Promise((done) => requestAnimationFrame(() => done(0)))")


# How many plots of each run that is open have at least one drawn pixel, and how many there are
