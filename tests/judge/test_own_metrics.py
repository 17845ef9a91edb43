"""Metrics of the user: read by name, called with the recording, errors with their line."""

import re
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pyarrow as pa
import pytest
from tests.recordings import MS, facts, kept

from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.judge.topics import judged, observe, sampled
from axisrig.bench.plan import own_metrics
from axisrig.bench.plan.case import Case
from axisrig.bench.plan.own_metrics import OwnModule
from axisrig.bench.plan.plan import read_plan
from axisrig.bench.plan.statistic_checks import StatisticCheck
from axisrig.bench.plan.table import Cell, Place
from axisrig.bench.plan.verdict import Verdict
from axisrig.bench.record.axes import AxisRecord
from axisrig.kernel.errors import UserError

ROWS, PEAK_MM = 101, 0.25


@pytest.fixture(scope="module")
def recording() -> Observed:
    """Z lags by a triangle of 0.25 mm."""
    row = np.arange(ROWS)
    columns = {
        "time_ns": row.astype(np.int64) * MS,
        "Z.set_mm": 0.01 * row,
        "Z.actual_mm": 0.01 * row - PEAK_MM * (1.0 - np.abs(row - 50) / 50.0),
    }
    left = facts(axes={"Z": AxisRecord("can1", 1, 10_000.0)}, sim_ns=ROWS * MS)
    return Observed(left, kept(pa.table(columns)))


def _case(folder: Path, module: str, check: str, condition: str, name: str = "own.py") -> Case:
    for file in ("a.nc", "a.toml"):
        (folder / file).touch()
    (folder / "own.py").write_text(module, encoding="utf-8")
    text = f"case,program,rig,module,{check}\na,a.nc,a.toml,{name},{condition}\n"
    (folder / "plan.csv").write_text(text, encoding="utf-8")
    (case,) = read_plan(folder / "plan.csv").cases
    return case


GOOD = '''
"""Lags."""
import numpy as np


def _lag(recording):
    return recording.column("Z", "set_mm") - recording.column("Z", "actual_mm")


def metric_lag_peak(recording):
    """Largest lag."""
    return np.max(_lag(recording)), "mm", 0.001


def metric_word(recording):
    return "slow", "", 0.0


def metric_nothing(recording):
    return None, "mm", 0.0
'''


@pytest.mark.parametrize(
    ("metric", "condition", "verdict", "value"),
    [
        ("lag_peak", "<= 0.3", Verdict.PASS, PEAK_MM),
        ("lag_peak", "<= 0.2", Verdict.FAIL, PEAK_MM),
        ("lag_peak", "<= 0.2505", Verdict.INCONCLUSIVE, PEAK_MM),
        ("word", "== slow", Verdict.PASS, "slow"),
        ("word", "== fast", Verdict.FAIL, "slow"),
        ("nothing", "<= 1", Verdict.FAIL, None),
    ],
)
def test_it_is_judged_as_any_other(
    tmp_path: Path,
    recording: Observed,
    metric: str,
    condition: str,
    verdict: Verdict,
    value: object,
) -> None:
    case = _case(tmp_path, GOOD, f"check:{metric}", condition)
    _, checks = judged(recording, case.checks[:1], module=case.module)
    (result,) = checks
    assert result.verdict is verdict
    assert result.value == (pytest.approx(value) if isinstance(value, float) else value)
    if metric == "lag_peak":
        assert (result.check.unit, result.uncertainty) == ("mm", 0.001)


@pytest.mark.parametrize(
    ("body", "words"),
    [
        ("x = 1\n    return 1 / 0, 'mm', 0.0", "own.py:3: ZeroDivisionError"),
        ("return 1.0", "TypeError: it returns 1.0, not value, unit, uncertainty"),
        ("return [1], 'mm', 0.0", "the value is"),
        ("return 1, None, 0.0", "the unit is None"),
        ("return 1, 'mm', -1.0", "the uncertainty is -1.0"),
        ("return 1, 'mm', None", "the uncertainty is None"),
        ("return 1, 'mm', float('nan')", "the uncertainty is nan: a number, 0 or more, is exp"),
        ("import sys; sys.exit(3)", "own.py:2: SystemExit: 3"),
        ("return recording.column('Q', 'set_mm'), 'mm', 0.0", "own.py:2: "),
    ],
)
def test_what_it_raises_is_an_error_with_its_line(
    tmp_path: Path, recording: Observed, body: str, words: str
) -> None:
    case = _case(tmp_path, f"def metric_mine(recording):\n    {body}\n", "check:mine", "< 1")
    verdict, (result, _) = judged(recording, case.checks, module=case.module)
    assert (verdict, result.verdict) == (Verdict.ERROR, Verdict.ERROR)
    assert words in result.note


def test_an_error_below_a_metric_is_at_the_line_that_made_it(
    tmp_path: Path, recording: Observed
) -> None:
    """A function of the file called by the metric: its line, not the one of the call."""
    module = "def half(x):\n    y = 2\n    return x / 0\n\n\ndef metric_mine(recording):\n"
    case = _case(tmp_path, module + "    return half(1), 'mm', 0.0\n", "check:mine", "< 1")
    _, (result, *_) = judged(recording, case.checks, module=case.module)
    assert result.note == "own.py:3: ZeroDivisionError: division by zero"


@pytest.mark.parametrize(
    ("value", "shown"),
    [("3", "3"), ("-2", "-2"), ("3.0", "3.0"), ("np.float32(0.5)", "0.5"), ("np.int64(7)", "7.0")],
)
def test_a_whole_number_stays_one_and_a_scalar_becomes_a_number(
    tmp_path: Path, recording: Observed, value: str, shown: str
) -> None:
    module = f"import numpy as np\n\n\ndef metric_mine(recording):\n    return {value}, '', 0\n"
    case = _case(tmp_path, module, "check:mine", "> -9")
    _, (result, *_) = judged(recording, case.checks, module=case.module)
    assert repr(result.value) == shown
    assert (result.verdict, repr(result.uncertainty)) == (Verdict.PASS, "0.0")
    assert result.note == "metric_mine of own.py"


def test_a_module_that_fails_when_it_is_loaded(tmp_path: Path, recording: Observed) -> None:
    module = "import nothing_like_this\n\n\ndef metric_mine(recording):\n    return 1, '', 0\n"
    case = _case(tmp_path, module, "check:mine", "< 1")
    _, (result, _) = judged(recording, case.checks, module=case.module)
    assert (result.verdict, result.note.partition(": ")[0]) == (Verdict.ERROR, "own.py:1")


@pytest.mark.parametrize(
    ("module", "check", "name", "words"),
    [
        ("def metric_mine(r): ...", "check:min", "own.py", "did you mean: mine"),
        ("def metric_mine(r): ...", "check:mine:Z", "own.py", "cannot be asked for like this"),
        ("def mine(r): ...", "check:mine", "own.py", "the module has no metric"),
        ("def metric_alarms(r): ...", "check:alarms", "own.py", "axisrig has a metric"),
        ("def metric_mine(r)", "check:mine", "own.py", "own.py:1.*cannot be read"),
        ("def metric_mine(r): ...", "check:mine", "owm.py", "near it: own.py"),
        ("def metric_mine(r): ...", "check:mine", "somewhere", "no entry point"),
    ],
)
def test_what_a_plan_refuses(
    tmp_path: Path, module: str, check: str, name: str, words: str
) -> None:
    with pytest.raises(UserError) as caught:
        _case(tmp_path, module, check, "< 1", name)
    texts = [str(error) for error in (caught.value, *caught.value.further)]
    others = [text for text in texts if not re.search(words, text)]
    assert len(others) < len(texts), texts
    assert not any("unknown metric" in text for text in others), "it follows from the cause"


def test_a_statistic_takes_it_as_any_other(tmp_path: Path, recording: Observed) -> None:
    case = _case(tmp_path, GOOD, "check:mean(lag_peak)", "<= 0.3")
    check = case.checks[0]
    assert isinstance(check, StatisticCheck)
    found = sampled(recording, [check], module=case.module)
    assert [reading.metric.value for reading in found["mean(lag_peak)"]] == [PEAK_MM]


def test_it_finds_what_is_beside_its_file(tmp_path: Path, recording: Observed) -> None:
    body = "from pathlib import Path\n\n\ndef metric_beside(recording):\n"
    body += "    return float((Path(__file__).parent / 'limit.txt').read_text()), 'mm', 0.0\n"
    (tmp_path / "limit.txt").write_text("0.5", encoding="utf-8")
    case = _case(tmp_path, body, "check:beside", "== 0.5")
    _, ((result),) = judged(recording, case.checks[:1], module=case.module)
    assert (result.verdict, result.value) == (Verdict.PASS, 0.5)


def test_a_module_is_written_as_it_is_found_from_the_folder_of_the_plan(tmp_path: Path) -> None:
    """Below it by the way from there, elsewhere as a whole; an entry point by its name."""
    plan, beside = tmp_path / "plan", tmp_path / "beside"
    found = [
        OwnModule("own", path, {}).text_in(plan)
        for path in (plan / "own.py", plan / "lib" / "own.py", beside / "own.py", None)
    ]
    assert found == ["own.py", "lib/own.py", (beside / "own.py").as_posix(), "own"]


class Points(dict[str, Any]):
    """Entry points of a group, by their names."""

    @property
    def names(self) -> set[str]:
        return set(self)


def test_an_entry_point_brings_the_metrics_that_axisrig_does_not_have(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Without any of its own, one that is not there, or one that breaks is an error of its cell."""

    def metric_peak(_recording: object) -> tuple[float, str, float]:
        """Largest lag.

        More words.
        """
        return 1.0, "mm", 0.0

    def broken() -> None:
        raise ImportError("no such part")

    known = SimpleNamespace(metric_duration_s=metric_peak, other=5)
    loads = {
        "mine": lambda: SimpleNamespace(metric_peak=metric_peak, **vars(known)),
        "known": lambda: known,
        "broken": broken,
    }
    found = Points({name: SimpleNamespace(load=load) for name, load in loads.items()})
    monkeypatch.setattr(own_metrics.metadata, "entry_points", lambda group: found)
    place = Place(Path("p.csv"), 2, 3, "module")
    module = own_metrics.own_module(Cell("mine", place))
    assert (module.name, module.path, set(module.metrics)) == ("mine", None, {"peak"})
    assert module.metrics["peak"].meaning == "Largest lag."
    for name, words in (
        ("known", "the entry point has no metric of its own"),
        ("broken", "the entry point cannot be loaded: ImportError: no such part"),
        ("none", "no Python file, and no entry point of this name is installed"),
    ):
        with pytest.raises(UserError, match=words) as caught:
            own_metrics.own_module(Cell(name, place))
        assert (caught.value.line, caught.value.column) == (2, 3)


def width(value: str) -> str:
    return f"def metric_width(recording):\n    return {value}, 'mm', 0.125\n"


def test_a_file_that_was_changed_meanwhile_counts_as_it_is_now(
    recording: Observed, tmp_path: Path
) -> None:
    """Also where it has the same name; and as it was before when it is put back."""
    for value in (1.5, 2.5, 1.5):
        case = _case(tmp_path, width(str(value)), "check:width", "> 0")
        assert case.module is not None
        _, (result, *_) = judged(recording, case.checks, module=case.module)
        assert (result.value, result.uncertainty) == (value, 0.125)
        found = observe(recording, case.checks[0], module=case.module)
        assert (found.value, found.uncertainty) == (value, 0.125)


def test_what_fails_outside_of_the_file_is_named_without_a_line(
    recording: Observed, tmp_path: Path
) -> None:
    """The function is gone since the plan was read: no line of the file has led to that."""
    case = _case(tmp_path, width("1.5"), "check:width", "> 0")
    assert case.module is not None
    (tmp_path / "own.py").write_text("def metric_other(recording):\n    return 1.0, '', 0.0\n")
    _, (result, *_) = judged(recording, case.checks, module=case.module)
    assert result.verdict is Verdict.ERROR
    assert result.note == f"{case.module.name}: KeyError: 'metric_width'"
    (tmp_path / "own.py").write_text("\n\ndef metric_width(recording):\n    return 1 / 0\n")
    _, (result, *_) = judged(recording, case.checks, module=case.module)
    assert result.note.startswith(f"{case.module.name}:4: ZeroDivisionError: ")
