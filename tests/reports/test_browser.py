"""The page in a real browser: headless Chromium opens it from `file://`."""

from pathlib import Path

import pytest
from tests.reports.browsing import HOSTILE, click, find, mouse, open_run, shown
from tests.reports.swept import folder as folder_of
from tests.tools.chromium import MISSING, Browser, chromium

from axisrig.reports.build import build_report

pytestmark = [
    pytest.mark.long,
    pytest.mark.skipif(chromium() is None, reason=MISSING),
]

BAD = ["error", "aborted", "fail", "inconclusive"]


def test_it_opens_without_network_and_without_errors(page: Browser, folder: Path) -> None:
    for run in shown(page):
        open_run(page, run)
    assert page.run("document.querySelectorAll('.opened').length") == 14
    assert page.errors == []
    assert page.requested == [(folder / "report.html").as_uri()]


def test_runs_are_found_filtered_and_sorted_and_the_address_keeps_it(
    page: Browser, folder: Path
) -> None:
    everything = shown(page)
    assert len(everything) == 14
    find(page, "FEED_5 falling")
    assert shown(page) == []
    find(page, "FEED_5_ machine")
    assert shown(page) == ["probing-feed_5_a", "probing-feed_5_b"]
    find(page, "50052")
    assert shown(page) == ["probing-feed_5_b"]
    assert page.run("document.getElementById('found').textContent") == "1 of 14"
    find(page, "")
    click(page, ".filter input[value=pass]")
    click(page, ".sort[data-sort=verdict]")
    kept = shown(page)
    assert kept[:2] == ["probing-feed_50_b", "probing-feed_25_b"]
    assert len(kept) == 8
    open_run(page, kept[2])
    address = page.run("location.hash")
    page.open(folder.parent)
    page.open(folder / "report.html", address)
    assert shown(page) == kept
    assert page.run("document.querySelector('.opened').parentNode.dataset.run") == kept[2]
    page.open(folder.parent)
    page.open(folder / "report.html", "#probing-feed_2_a")
    assert page.run("document.querySelector('.opened').parentNode.dataset.run").endswith("_2_a")
    assert page.errors == []


def cards(page: Browser) -> list[str]:
    """The runs whose cards are seen."""
    found = page.run(
        "[...document.querySelectorAll('.card')].filter((c) => c.offsetHeight)"
        ".map((c) => c.dataset.run)"
    )
    return list(found)


def test_cards_follow_find_and_the_boxes_and_contents_change_nothing(page: Browser) -> None:
    everything = cards(page)
    assert len(everything) == 6
    click(page, ".filter input[value=fail]")
    kept = cards(page)
    assert 0 < len(kept) < 6
    assert set(kept) <= set(shown(page))
    click(page, ".contents a[href='#glossary_title']")
    page.run("new Promise((done) => setTimeout(done, 50))")
    assert cards(page) == kept
    find(page, "no such run")
    assert cards(page) == []
    find(page, "")
    click(page, ".filter input[value=fail]")
    assert cards(page) == everything
    # The number of equal runs leads to these runs
    page.run("location.hash = 'find=' + document.querySelector('.card').dataset.card")
    page.run("new Promise((done) => setTimeout(done, 50))")
    assert shown(page) == everything[:1]
    assert page.errors == []


def test_the_page_has_landmarks_and_a_way_past_them(page: Browser) -> None:
    for landmark in ("header", "nav[aria-label]", "[role=search]", "main", "footer"):
        assert page.run(f"document.querySelectorAll('body > {landmark}').length") == 1
    assert page.run("document.body.firstElementChild.hash") == "#main"
    places = page.run(
        "[...document.querySelectorAll('.contents a')].map((a) => [a.textContent,"
        " document.getElementById(a.hash.slice(1))?.textContent])"
    )
    assert all(text and text.startswith(name) for name, text in places), places


def pressed(page: Browser) -> list[str]:
    """The buttons of stretches that show what is seen."""
    found = page.run(
        "[...document.querySelectorAll('.tools button[aria-pressed=true]')]"
        ".map((b) => b.textContent)"
    )
    return [word for word in found if word not in "XYZ"]


def test_a_plot_is_zoomed_by_dragging_and_shown_whole_by_a_double_click(page: Browser) -> None:
    open_run(page, "probing-feed_50_a")
    assert pressed(page) == ["measurement"]
    place = page.run(
        "(() => { const over = document.querySelector('.u-over');"
        " over.scrollIntoView({ block: 'center' }); const b = over.getBoundingClientRect();"
        " return [b.left, b.top, b.width, b.height]; })()"
    )
    left, top, width, height = place
    y = top + height / 2
    for kind, x, buttons in (
        ("mouseMoved", left + 0.2 * width, 0),
        ("mousePressed", left + 0.2 * width, 1),
        ("mouseMoved", left + 0.5 * width, 1),
        ("mouseReleased", left + 0.5 * width, 0),
    ):
        mouse(page, kind, x, y, buttons)
    assert pressed(page) == []
    for count in (1, 2):
        mouse(page, "mousePressed", left + 9, y, 1, clickCount=count)
        mouse(page, "mouseReleased", left + 9, y, 0, clickCount=count)
    assert pressed(page) == ["whole run"]
    assert page.errors == []


_DRAWN = """Object.fromEntries([...document.querySelectorAll('.opened')].map((row) => {
  const plots = [...row.querySelectorAll('.uplot canvas')];
  const drawn = plots.filter((c) => c.getContext('2d')
    .getImageData(0, 0, c.width, c.height).data.some((value) => value));
  return [row.parentNode.dataset.run, [drawn.length, plots.length]];
}))"""


# How many plots of position of each run that is open show the signal, by its colour
_SIGNALS = """Object.fromEntries([...document.querySelectorAll('.opened')].map((row) => {
  const plots = [...row.querySelectorAll('.uplot canvas')].slice(1, 2);
  const blue = (d, i) => d[i] === 0x56 && d[i + 1] === 0xb4 && d[i + 2] === 0xe9;
  const found = plots.map((c) => {
    const d = c.getContext('2d').getImageData(0, 0, c.width, c.height).data;
    let count = 0;
    for (let i = 0; i < d.length; i += 4) count += blue(d, i);
    return count;
  });
  return [row.parentNode.dataset.run, found];
}))"""


def test_what_is_printed_is_drawn_and_only_failures_are(page: Browser, tmp_path: Path) -> None:
    verdicts = page.run(
        "Object.fromEntries([...document.querySelectorAll('.verdicts > tbody')]"
        ".map((b) => [b.dataset.run, b.dataset.verdict]))"
    )
    bad = {run for run, verdict in verdicts.items() if verdict in BAD}
    page.run("dispatchEvent(new Event('beforeprint'))")
    drawn = page.run(_DRAWN)
    assert set(drawn) == bad
    assert all(done == there for done, there in drawn.values())
    assert sum(there > 0 for _, there in drawn.values()) == 4  # two have left no signals
    signals = page.run(_SIGNALS)
    assert all(count > 100 for counts in signals.values() for count in counts), signals
    unprinted = page.run(
        "[...document.querySelectorAll('tbody.unprinted')].map((b) => b.dataset.run)"
    )
    assert set(unprinted) == set(verdicts) - bad
    page.run("dispatchEvent(new Event('afterprint'))")
    assert page.run("document.querySelectorAll('.opened').length") == 0
    page.printed(tmp_path / "bad.pdf")
    click(page, "#print_all")
    page.run("dispatchEvent(new Event('beforeprint'))")
    assert set(page.run(_DRAWN)) == set(verdicts)
    page.run("dispatchEvent(new Event('afterprint'))")
    page.printed(tmp_path / "all.pdf")
    sizes = [pages(tmp_path / name) for name in ("bad.pdf", "all.pdf")]
    assert len(bad) <= sizes[0] < sizes[1]
    assert page.errors == []


def pages(path: Path) -> int:
    data = path.read_bytes()
    return data.count(b"/Type /Page") - data.count(b"/Type /Pages")


def colour_at(page: Browser, plot: int, share: float) -> list[int]:
    """The colour of a plot of the open run at a share of its width, near its upper edge."""
    found = page.run(
        f"(() => {{ const c = document.querySelectorAll('.opened .uplot canvas')[{plot}];"
        f" const o = c.parentNode.querySelector('.u-over'), r = devicePixelRatio;"
        f" const x = (o.offsetLeft + {share} * o.offsetWidth) * r, y = (o.offsetTop + 3) * r;"
        " return [...c.getContext('2d').getImageData(x, y, 1, 1).data]; })()"
    )
    return list(found)


CHOSEN = "#ffe9a8"


def test_a_block_is_chosen_in_the_table_and_in_the_lane(page: Browser) -> None:
    open_run(page, "probing-feed_50_a")
    rows = "document.querySelectorAll('.opened .blocks tr[data-at]')"
    assert page.run(f"{rows}.length") == 4
    chosen = f"[...{rows}].findIndex((row) => row.classList.contains('chosen'))"
    stretch = "[...document.querySelectorAll('.tools button')].find((b) => b.textContent === {})"
    page.run(stretch.format("'edge'") + ".click()")
    click(page, ".opened .blocks tr[data-at='0'] .pick")
    assert page.run(chosen) == 0
    assert page.run(f"{rows}[0].querySelector('.pick').getAttribute('aria-pressed')") == "true"
    page.run("new Promise((done) => setTimeout(done, 100))")
    # It was not seen, so it is zoomed to, with a quarter of its time on either side
    rgb = [int(CHOSEN[at : at + 2], 16) for at in (1, 3, 5)]
    assert colour_at(page, 1, 0.5)[:3] == rgb
    assert colour_at(page, 1, 0.02)[:3] != rgb
    # The lane of the whole run, 499 ms: a click chooses the block under it, again none
    page.run(stretch.format("'whole run'") + ".click()")
    page.run("document.querySelector('.opened .u-over').scrollIntoView({ block: 'center' })")
    left, top, width, height = page.run(
        "(() => { const b = document.querySelector('.opened .u-over').getBoundingClientRect();"
        " return [b.left, b.top, b.width, b.height]; })()"
    )
    for time_ms, row in ((175, -1), (327, 1)):
        x = left + time_ms / 499 * width
        for kind, buttons in (("mouseMoved", 0), ("mousePressed", 1), ("mouseReleased", 0)):
            mouse(page, kind, x, top + height / 2, buttons)
        assert page.run(chosen) == row
    page.run("new Promise((done) => setTimeout(done, 100))")
    assert colour_at(page, 1, 327 / 499)[:3] == rgb
    legend = page.run("document.querySelector('.opened .u-legend').textContent")
    assert "N20 G100 Z0 F1000" in legend
    assert page.errors == []


def in_the_map(page: Browser, run: str, row: int) -> tuple[float, float]:
    """Where the cell of a run is in the window; row 0 is the run, then its metrics."""
    place = page.run(
        "(() => { const c = document.querySelector('.map canvas');"
        " c.scrollIntoView({ block: 'center' }); const b = c.getBoundingClientRect();"
        " return [b.left, b.top, b.width, b.height]; })()"
    )
    left, top, width, height = place
    runs, rows, size = shown(page), 7, 15  # six metrics
    assert abs(height - (rows * size + 4)) <= 1
    begin = left + width - len(runs) * size
    return begin + (runs.index(run) + 0.5) * size, top + 2 + (row + 0.5) * size


def test_the_map_shows_what_is_filtered_and_a_cell_opens_its_run(page: Browser) -> None:
    x, y = in_the_map(page, "probing-feed_50_a", 1)
    mouse(page, "mouseMoved", x, y, 0)
    said = "document.querySelector('.map-at').textContent"
    assert page.run(said) == "probing-feed_50_a · latch_error_um:Z: ✖ fail"
    for kind, buttons in (("mousePressed", 1), ("mouseReleased", 0)):
        mouse(page, kind, x, y, buttons)
    assert page.run("document.querySelector('.opened').parentNode.dataset.run") == (
        "probing-feed_50_a"
    )
    click(page, ".filter input[value=pass]")
    label = "document.querySelector('.map canvas').getAttribute('aria-label')"
    # Its keys are its own: a screen reader has to hand them on
    assert page.run("document.querySelector('.map canvas').getAttribute('role')") == "application"
    assert page.run(label).startswith(f"probing: {len(shown(page))} runs across, 6 metrics down: ")
    assert "pass" not in page.run(label)
    # The filter stays, and what is opened by the keyboard is what is chosen
    page.run(
        "(() => { const c = document.querySelector('.map canvas'); c.focus();"
        " for (const key of ['ArrowRight', 'ArrowRight', 'ArrowDown', 'Enter'])"
        " c.dispatchEvent(new KeyboardEvent('keydown', { key, bubbles: true })); })()"
    )
    assert page.run(said).startswith(f"{shown(page)[1]} · latch_error_um:Z")
    opened = page.run(
        "[...document.querySelectorAll('.opened')].map((r) => r.parentNode.dataset.run)"
    )
    assert shown(page)[1] in opened
    assert "verdict=" in page.run("location.hash")
    find(page, "no such run")
    assert page.run("document.querySelector('.map figure').hidden")
    assert page.errors == []


def test_hostile_text_stays_text(page: Browser) -> None:
    for run in ("probing-feed_1_a", "probing-feed_50_a"):
        open_run(page, run)
    assert page.run("document.title") == "error · probing · axisrig"
    assert page.run("document.querySelectorAll('main img, main script').length") == 0
    title = page.run("document.querySelector('.verdicts .row .title').textContent")
    assert title == HOSTILE
    printed = page.run("document.querySelector('.opened pre').textContent")
    assert HOSTILE in printed
    assert page.run("document.querySelectorAll('.opened .pick')[1].textContent") == HOSTILE
    find(page, '"taken"</script>')
    assert len(shown(page)) == 14
    assert page.errors == []


def test_the_value_under_the_pointer_is_said(browser: Browser, tmp_path: Path) -> None:
    rows = [("c", str(a), "1", a * 2.0, "pass") for a in range(1, 30)]
    build_report(folder_of(tmp_path, rows))
    browser.open(tmp_path)
    browser.errors.clear()
    browser.open(tmp_path / "report.html")
    x, y = browser.run(
        "(() => { const dot = document.querySelectorAll('svg.dots .dot')[6];"
        " dot.scrollIntoView({ block: 'center' }); const b = dot.getBoundingClientRect();"
        " return [b.left + b.width / 2 + 2, b.top + b.height / 2 + 5]; })()"
    )
    mouse(browser, "mouseMoved", x, y, 0)
    said = "document.querySelector('.dots-at')?.textContent"
    assert browser.run(said) == "r6: 14 at 7, pass"
    mouse(browser, "mouseMoved", 2, 2, 0)
    assert browser.run(said) is None
    assert browser.errors == []
