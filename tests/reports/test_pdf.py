"""The printed report: sheets, nothing empty, and what happens without a browser."""

from pathlib import Path

import pytest
from tests.reports.swept import CASES, CHECKS
from tests.tools.chromium import MISSING, chromium

from axisrig.kernel.errors import UserError
from axisrig.reports import pdf
from axisrig.reports.build import build_report

SAMPLE = Path(__file__).parents[2] / "docs" / "sample-report" / "report.html"
needs_chromium = pytest.mark.skipif(chromium() is None, reason=MISSING)


def pages(path: Path) -> int:
    data = path.read_bytes()
    return data.count(b"/Type /Page") - data.count(b"/Type /Pages")


def sweep(place: Path) -> Path:
    """Two times 300 runs of a sweep, and five of other cases: 154 did not pass, in two ways."""
    cases, checks = [CASES], [CHECKS]
    rows = [("feeds", str(a), b, b == "1.9" and a >= 1470) for a in range(10, 3010, 10)
            for b in ("0", "1.9")]  # fmt: skip
    rows += [(f"other-{n}", "1", "1", n == 0) for n in range(5)]
    for number, (case, a, b, is_bad) in enumerate(rows):
        verdict = "fail" if is_bad else "pass"
        value = -2.0 - int(a) / 30000 if is_bad else -0.1
        cases.append(f"p,{case},r{number},{verdict},1,1,1,,,{a},{b}")
        checks.append(f"p,{case},r{number},-2 .. 2,m,{value},um,-2,2,0.01,{verdict},p.csv:2")
    (place / "cases.csv").write_text("\n".join([*cases, ""]), encoding="utf-8")
    (place / "results.csv").write_text("\n".join([*checks, ""]), encoding="utf-8")
    assert sum(is_bad for *_, is_bad in rows) == 155
    return place


@needs_chromium
@pytest.mark.long
def test_605_runs_are_at_most_6_sheets_and_the_sample_3(tmp_path: Path) -> None:
    assert pages(pdf.print_pdf(build_report(sweep(tmp_path)))) <= 6
    copy = tmp_path / "sample.html"
    copy.write_bytes(SAMPLE.read_bytes())
    assert pages(pdf.print_pdf(copy)) == 3


def test_without_a_browser_it_says_what_is_needed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(pdf, "PLACES", ())
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(UserError, match="no Chromium is found") as error:
        pdf.print_pdf(tmp_path / "report.html")
    assert "print the report with the button" in str(error.value)


@pytest.mark.skipif(not Path("/bin/sh").exists(), reason="needs a shell")
def test_a_browser_that_writes_nothing_is_an_error(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A stand-in on the search path; an older PDF is not taken for a new one."""
    stand_in = tmp_path / "chromium"
    stand_in.write_text("#!/bin/sh\necho broken >&2\n", encoding="utf-8")
    stand_in.chmod(0o755)
    monkeypatch.setenv("PATH", str(tmp_path))
    report = tmp_path / "report.html"
    report.with_suffix(".pdf").write_text("old", encoding="utf-8")
    with pytest.raises(UserError, match="wrote no PDF: broken"):
        pdf.print_pdf(report)
    assert not report.with_suffix(".pdf").exists()


def browser_of(folder: Path, patch: pytest.MonkeyPatch, *lines: str) -> Path:
    """A stand-in on the search path, and a report beside it."""
    stand_in = folder / "chromium"
    stand_in.write_text("\n".join(["#!/bin/sh", *lines, ""]), encoding="utf-8")
    stand_in.chmod(0o755)
    patch.setenv("PATH", str(folder))
    return folder / "report.html"


@pytest.mark.skipif(not Path("/bin/sh").exists(), reason="needs a shell")
def test_a_report_is_printed_beside_it_in_place_of_an_older_one(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The browser gets the address of the report last, and a profile of its own."""
    report = browser_of(
        tmp_path, monkeypatch,
        'for word in "$@"; do case "$word" in --print-to-pdf=*) to="${word#*=}";; esac; done',
        'for word in "$@"; do echo "$word"; done > "$to"',
    )  # fmt: skip
    report.with_suffix(".pdf").write_text("old", encoding="utf-8")
    made = pdf.print_pdf(report)
    assert made == report.with_suffix(".pdf").resolve()
    words = made.read_text(encoding="utf-8").split()
    assert words[-1] == report.resolve().as_uri()
    assert f"--print-to-pdf={made}" in words
    (profile,) = [word for word in words if word.startswith("--user-data-dir=")]
    assert not Path(profile.partition("=")[2]).exists()


@pytest.mark.long
@pytest.mark.skipif(not Path("/bin/sh").exists(), reason="needs a shell")
def test_a_browser_that_does_not_end_or_says_nothing_is_an_error(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    report = browser_of(tmp_path, monkeypatch, "exit 1")
    with pytest.raises(UserError, match="wrote no PDF: it said nothing"):
        pdf.print_pdf(report)
    browser_of(tmp_path, monkeypatch, "echo first >&2; echo last >&2")
    with pytest.raises(UserError, match="wrote no PDF: last") as caught:
        pdf.print_pdf(report)
    assert caught.value.file == str(report)
    monkeypatch.setattr(pdf, "LIMIT_S", 0.1)
    browser_of(tmp_path, monkeypatch, "while :; do :; done")
    with pytest.raises(UserError, match=r"did not end within 0\.1 s"):
        pdf.print_pdf(report)
