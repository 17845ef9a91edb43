"""The pages of `axisrig diff` and `axisrig trend` in headless Chromium: from a file, no network."""

import os
import shutil
from pathlib import Path

import pytest
from tests.tools.chromium import MISSING, Browser, chromium

pytestmark = [
    pytest.mark.long,
    pytest.mark.skipif(chromium() is None, reason=MISSING),
]
_LEVELS = ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa"]


def _axe() -> Path | None:
    folders = os.environ.get("NODE_PATH", "").split(os.pathsep)
    paths = [Path(folder) / "axe-core" / "axe.min.js" for folder in folders if folder]
    return next((path for path in paths if path.is_file()), None)


@pytest.fixture(scope="module")
def pages(folder_of_results: Path, tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    """Both pages of two folders of which the second has changed, with hostile text."""
    from axisrig.bench.cli.main import main  # noqa: PLC0415

    place = tmp_path_factory.mktemp("pages")
    one, other = place / "one", place / "<b>other"
    for folder in (one, other):
        shutil.copytree(folder_of_results, folder)
    table = (other / "cases.csv").read_text(encoding="utf-8").replace("slow,pass", "slow,fail")
    (other / "cases.csv").write_text(table, encoding="utf-8")
    shutil.copy(other / "traces" / "touch-fast.parquet", other / "traces" / "touch-slow.parquet")
    made = [place / "diff.html", place / "trend.html"]
    for words in (
        ["diff", one, other, "-o", made[0]],
        ["trend", one, other, "--metric", "latch_error_um", "-o", made[1]],
    ):
        with pytest.raises(SystemExit):
            main([str(word) for word in words])
    return made


@pytest.mark.parametrize("is_dark", [False, True], ids=["light", "dark"])
def test_pages_open_without_network_errors_and_findings(
    pages: list[Path], *, is_dark: bool
) -> None:
    axe = _axe()
    for path in pages:
        with Browser(is_dark=is_dark) as page:
            page.open(path)
            assert page.run("document.querySelectorAll('svg.cmp').length") > 0
            assert page.run("document.querySelectorAll('b.other, h1 b').length") == 0
            assert "<b>other" in page.run("document.body.innerText")
            assert [url for url in page.requested if not url.startswith("file://")] == []
            assert page.errors == []
            if axe is not None:
                page.run(axe.read_text(encoding="utf-8") + "\n;0")
                found = page.run(
                    f"axe.run(document, {{ runOnly: {_LEVELS} }})"
                    ".then((r) => r.violations.map((v) => [v.id, v.nodes.map((n) => n.html)]))"
                )
                assert found == []
