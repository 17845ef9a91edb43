"""Builds `report.html`: one page that opens offline by double click, from the result files alone.

Equal result folders give equal bytes: the page holds no clock and no path of the machine. Runs are
made one at a time: their rows and failures are text of some kilobytes, what they open is packed
into a temporary file and appended at the end.
"""

import base64
import gzip
import json
import posixpath
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from tempfile import TemporaryFile
from typing import IO, Any
from urllib.parse import quote

from jinja2 import Environment, FunctionLoader, StrictUndefined, Template
from markupsafe import Markup

from axisrig.bench.campaign.results.layout import run_of_log
from axisrig.bench.campaign.results.stored import (
    PROBE,
    RECORDED_IN,
    RECORDINGS,
    StoredResults,
    StoredRun,
    read_results,
)
from axisrig.bench.files import write_parts
from axisrig.bench.judge.topics import findings
from axisrig.bench.plan.verdict import Verdict
from axisrig.reports.blocks.section import blocks_style
from axisrig.reports.budget.drawing import budget_style
from axisrig.reports.budget.section import budget_section
from axisrig.reports.campaign_map.section import CampaignMap, map_style
from axisrig.reports.campaign_sections import SECTIONS, Results
from axisrig.reports.coverage.section import Coverage
from axisrig.reports.failures.section import SEEN, Cards
from axisrig.reports.glossary import glossary
from axisrig.reports.heading import heading
from axisrig.reports.kinematics.section import tool_script, tool_style
from axisrig.reports.parts.shipped import licences, page_style, plot_scripts, shipped_text
from axisrig.reports.parts.topic import ReportTopic
from axisrig.reports.run import (
    BUS_LOG,
    SECTION,
    Findings,
    Parts,
    probe_rows,
    readable,
    run_view,
)
from axisrig.reports.sweeps.searches import search_pictures
from axisrig.reports.topics import TOPICS

WHOLE_BYTES = 10_000_000
"""Packed signals of runs that did not pass are whole until they take so much."""
_BLOCK = 1 << 20


def build_report(
    results_dir: Path,
    *,
    findings: Findings = findings,
    topics: Sequence[ReportTopic] = TOPICS,
    is_full: bool = False,
    put_out: Callable[[str], None] = lambda _: None,
) -> Path:
    """Write `report.html` into a results folder and return its path.

    findings: of a recorded run, a block for each of the topics by its name. is_full: keep every
    sample of every run; else a run that passed has smallest and largest values, with all samples
    in the stretches that have a button. put_out: takes what is said of runs whose files are not
    those that they have written.
    Raises UserError when the folder is none, or a recording is damaged, OSError with the name of
    the file.
    """
    path = results_dir / "report.html"
    results = read_results(results_dir)
    pages = _Pages(Parts(findings, topics))
    with TemporaryFile("w+", encoding="ascii", newline="") as store:
        made = _made(results, pages, store, is_full=is_full)
        for line in made.altered:
            put_out(line)
        head, tail = pages.page.render(_page(results, made, topics)).split(_STORE)
        store.seek(0)
        write_parts(path, (head, *iter(lambda: store.read(_BLOCK), ""), tail))
    return path


_STORE = "<!-- packed runs -->"
_STYLES = (
    *(page_style, blocks_style, map_style, budget_style, tool_style),
    *(section.style for section in SECTIONS),
)


class _Pages:
    """The templates of the page."""

    def __init__(self, parts: Parts) -> None:
        self.parts = parts
        self._packages = {f"{topic.name}/{SECTION}": topic.package for topic in parts.topics}
        environment = Environment(
            loader=FunctionLoader(self._text),
            autoescape=True,
            undefined=StrictUndefined,
            trim_blocks=True,
            lstrip_blocks=True,
        )
        self.page: Template = environment.get_template("page.html")
        self.row: Template = environment.get_template("row.html")
        self.card: Template = environment.get_template("card.html")
        self.run: Template = environment.get_template("run.html")

    def _text(self, name: str) -> str:
        """Return a template; `<topic>/section.html` is that of a topic."""
        if name in self._packages:
            return shipped_text(SECTION, self._packages[name])
        return shipped_text(name)


@dataclass
class _Made:
    """What is kept of the runs until the page is written."""

    cards: Cards
    rows: list[Markup] = field(default_factory=list)
    campaign: CampaignMap = field(default_factory=CampaignMap)
    altered: list[str] = field(default_factory=list)
    coverage: Coverage = field(default_factory=Coverage)
    seconds: dict[str, list[float]] = field(default_factory=lambda: {"sim": [], "real": []})


def _made(results: StoredResults, pages: _Pages, store: IO[str], *, is_full: bool) -> _Made:
    made, spent = _Made(Cards(results, lambda card: pages.card.render(card=card))), 0
    output = _output(results)
    links, columns = _links(results), results.input_columns
    probes: dict[str, list[StoredRun]] = {}
    for one in results.runs:
        probes.setdefault(one.case.get(PROBE, ""), []).append(one)
    folder = results.place or results.folder
    has_plans = len({run.case["plan"] for run in results.runs}) > 1
    for stored in results.runs:
        run = replace(stored)  # what it reads goes with it
        is_whole = is_full or (run.verdict is not Verdict.PASS and spent < WHOLE_BYTES)
        made.coverage.add(run)
        view = run_view(run, columns, output, pages.parts, links(run), is_reduced=not is_whole)
        spent += len(view["data"]) * (is_whole and run.verdict is not Verdict.PASS)
        own = probes.get(run.run, ())
        view |= {"has_plans": has_plans, "probes": probe_rows(run, own)}
        view["altered"] = run.altered_words
        made.altered += [f"{run.run}: {run.altered_words}"] if run.altered else []
        with readable(run, "budget"):
            view["budget"] = budget_section(folder, run)
        view["searched"] = search_pictures(run, own) if view["probes"] else ""
        view["card"] = made.cards.name_of(run.run)
        view["is_example"] = made.cards.is_example(run.run)
        made.rows.append(Markup(pages.row.render(run=view)))
        made.cards.add(view)
        if not run.is_probe:  # its row has verdict and time of its probes
            made.campaign.add(run)
        if not run.is_statistic:  # its time is that of its runs
            clock = "real" if view["clock"] == "ran" else "sim"
            made.seconds[clock].append(float(run.case["sim_s"]))
        store.write(_packed(view, pages.run.render(run=view)))
    return made


def _packed(view: Mapping[str, Any], body: str) -> str:
    """What a run opens: its page and the description of its plots, and after a line the signals."""
    content = json.dumps({"html": body, "chart": view["chart"]}, ensure_ascii=False)
    octets = gzip.compress(content.encode(), compresslevel=6, mtime=0)
    text = base64.b64encode(octets).decode()
    return (
        f'<script type="text/plain" class="stored" data-run="{view["id"]}">'
        f"{text}\n{view['data']}</script>\n"
    )


def _page(results: StoredResults, made: _Made, topics: Sequence[ReportTopic]) -> dict[str, Any]:
    """Everything the template of the whole page prints."""
    campaign = Results(results, made.coverage)
    written = [(section, section.make(campaign)) for section in SECTIONS]
    sections = [(section.title, section.place, text) for section, text in written if text]
    cards = made.cards.made
    return {
        "view": heading(results, made.seconds)
        | {
            "failed": made.cards.failed,
            "altered": made.altered,
            "cards": cards[:SEEN],
            "folded": cards[SEEN:],
            "left_out": made.cards.left_out,
            "rows": made.rows,
            "contents": [(title, place) for title, place, _ in sections],
            "legends": [topic.legend for topic in topics if topic.legend],
            "glossary": glossary(),
        },
        "sections": [text for _, _, text in sections],
        "map": made.campaign.data(),
        "map_script": Markup(shipped_text("campaign_map/map.js")),
        "tool_script": tool_script(),
        "style": Markup("").join(style() for style in _STYLES),
        "scripts": plot_scripts(),
        "script": Markup(shipped_text("points.js") + shipped_text("page.js")),
        "licences": licences(),
        "store": Markup(_STORE),
    }


def _output(results: StoredResults) -> str:
    """The folder with the recordings as the command line named it."""
    folder = results.manifest.get("output", results.folder.name)
    return str(results.manifest.get(RECORDED_IN, folder))


# ---- where files are, from the page


def _links(results: StoredResults) -> Callable[[StoredRun], list[tuple[str, str, str]]]:
    """Return what gives the files of a run: what it is, its name, and the address from the page."""
    manifest = results.manifest
    base = manifest.get(RECORDINGS, "")
    plans = {plan["name"]: plan["path"] for plan in manifest.get("plans", [])}
    output = str(manifest.get("output", ""))
    logs: dict[str, list[str]] = {}
    folder = None if results.place is None else results.place / "bus"
    for log in sorted(folder.iterdir()) if folder is not None and folder.is_dir() else []:
        logs.setdefault(run_of_log(log.name), []).append(log.name)

    def links(run: StoredRun) -> list[tuple[str, str, str]]:
        found = []
        if run.trace is not None:
            found.append(("signals", "traces", run.trace.name))
        if run.file is not None:
            found.append(("facts", "runs", run.file.name))
        found += [(BUS_LOG, "bus", name) for name in logs.get(run.recorded, [])]
        files = [
            (what, f"{place}/{name}", _address(base, place, name)) for what, place, name in found
        ]
        plan = plans.get(run.case["plan"], "").replace("\\", "/")
        program = run.case.get("program", "").replace("\\", "/")
        name = posixpath.basename(plan)
        rows = [row.reference for row in run.checks if row.reference.startswith(f"{name}:")]
        for what, shown, path in (
            ("plan", next(iter(rows), name), plan),
            ("program", program, posixpath.join(posixpath.dirname(plan), program)),
        ):
            if plan and shown and path:
                files.append((what, shown, relative_address(path, output)))
        return files

    return links


def _address(*parts: str) -> str:
    return quote(posixpath.join(*parts))


def relative_address(path: str, output: str) -> str:
    """Return the address of a file from the results folder, both as a command line named them.

    Empty where it depends on the folder of that command: one is absolute, or one is above it.
    """
    path, output = posixpath.normpath(path), posixpath.normpath(output.replace("\\", "/"))
    is_absolute = posixpath.isabs(path), posixpath.isabs(output)
    if is_absolute[0] != is_absolute[1] or ".." in (path.split("/")[0], output.split("/")[0]):
        return ""
    return (
        quote(posixpath.relpath(path, output))
        if all(is_absolute)
        else quote(posixpath.relpath(f"/{path}", f"/{output}"))
    )
