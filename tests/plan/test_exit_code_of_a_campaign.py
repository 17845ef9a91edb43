"""The exit code of a call that goes on with a folder: what stays there counts as what is run."""

from collections.abc import Iterator, Sequence
from pathlib import Path

import pytest
from tests.plan.cases import case_of

from axisrig.bench.campaign import campaign
from axisrig.bench.campaign.results.writer import CaseResult
from axisrig.bench.campaign.resuming import GoingOn
from axisrig.bench.plan.case import Case
from axisrig.bench.plan.checks import judge
from axisrig.bench.plan.verdict import Verdict, exit_code

UNDECIDED = exit_code(Verdict.INCONCLUSIVE)
PLAN = """\
case,program,rig,repeats,check:mean(latch_error_um)
several,a.nc,r.toml,2,<= 1
one,a.nc,r.toml,,
"""


class Calls:
    """Calls of a campaign whose runs pass without being run, and leave no recording.

    So the mean over both of them is undecided.
    """

    def __init__(self, folder: Path) -> None:
        self._plan, self._out = folder / "p.csv", folder / "out"
        self._plan.write_text(PLAN, encoding="utf-8")
        self.verdict = Verdict.PASS

    def running(self, cases: Sequence[Case], *_: object) -> Iterator[CaseResult]:
        for case in cases:
            alarms = () if self.verdict is Verdict.PASS else (50059,)
            yield CaseResult(case, self.verdict, [judge(check, alarms) for check in case.checks])

    def __call__(
        self, going_on: GoingOn = GoingOn.NO, select: str | None = None
    ) -> campaign.Campaign:
        return campaign.run_campaign(
            [self._plan], out=self._out, select=campaign.Choice(select), jobs=1, timeout_s=None,
            assignments=[], command=[], started="", stopwatch=lambda: 0.0, going_on=going_on,
        )  # fmt: skip


@pytest.fixture
def call(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Calls:
    (tmp_path / "a.nc").write_text("N10 M30\n", encoding="utf-8")
    (tmp_path / "r.toml").write_text("[machine]\n", encoding="utf-8")
    calls = Calls(tmp_path)
    monkeypatch.setattr(campaign, "_prepared", lambda *_: ((), []))
    monkeypatch.setattr(campaign, "_running", calls.running)
    monkeypatch.setattr(campaign, "depends_sha256", lambda case: case.run)
    monkeypatch.setattr(campaign, "real_cases", lambda _: [])
    return calls


@pytest.mark.parametrize("going_on", [GoingOn.MISSING, GoingOn.FAILED])
def test_a_row_of_statistics_that_stays_counts(call: Calls, going_on: GoingOn) -> None:
    """Its runs pass and stay, too: nothing is run, and all is as it was."""
    first = call()
    assert [len(first.results), first.exit_code, len(first.kept)] == [4, UNDECIDED, 0]
    again = call(going_on)
    assert (len(again.results), again.exit_code) == (0, UNDECIDED)
    assert sorted(again.kept) == [Verdict.PASS] * 3 + [Verdict.INCONCLUSIVE]


@pytest.mark.long
def test_a_run_that_failed_and_stays_counts(call: Calls) -> None:
    call.verdict = Verdict.FAIL
    assert call().exit_code == 1
    call.verdict = Verdict.PASS
    again = call(GoingOn.MISSING)
    assert (len(again.results), again.exit_code) == (0, 1)
    mended = call(GoingOn.FAILED)
    assert (len(mended.results), mended.exit_code) == (4, UNDECIDED)


def test_what_the_folder_has_of_others_does_not_count(call: Calls) -> None:
    """A call for one run alone, which stays out of the mean that is there."""
    call()
    other = call(select="one")
    assert (len(other.results), other.exit_code, len(other.kept)) == (1, 0, 0)


@pytest.mark.parametrize("going_on", [GoingOn.MISSING, GoingOn.FAILED])
def test_going_on_with_a_part_asks_for_that_part_alone(call: Calls, going_on: GoingOn) -> None:
    """Also of what stays; a mean is asked for with each of its runs."""
    call()
    one = call(going_on, select="one")
    assert (len(one.results), one.exit_code, one.kept) == (0, 0, [Verdict.PASS])
    first = call(going_on, select="several-001")
    assert (len(first.results), first.exit_code) == (0, UNDECIDED)
    assert first.kept == [Verdict.PASS, Verdict.INCONCLUSIVE]


@pytest.mark.parametrize(
    ("ends_at_first", "verdicts", "is_interrupted", "code"),
    [
        (True, [], True, Verdict.ABORTED),
        (True, [Verdict.PASS], True, Verdict.ABORTED),
        (True, [Verdict.MARGINAL], True, Verdict.ABORTED),
        (True, [Verdict.PASS, Verdict.FAIL], False, Verdict.FAIL),
        (True, [Verdict.INCONCLUSIVE], False, Verdict.INCONCLUSIVE),
        (False, [Verdict.PASS, Verdict.FAIL], True, Verdict.ABORTED),
        (True, [Verdict.PASS] * 3, False, Verdict.PASS),
        (False, [Verdict.PASS] * 3, False, Verdict.PASS),
    ],
)
def test_a_campaign_that_stops_before_its_third_run_is_meant_to_by_a_failure_alone(
    ends_at_first: bool, verdicts: list[Verdict], is_interrupted: bool, code: Verdict
) -> None:
    """With `-x`; Ctrl-C before any failure is aborted as without it."""
    results = [CaseResult(case_of(f"r{n}"), verdict, []) for n, verdict in enumerate(verdicts)]
    found = campaign.Campaign(Path("out"), results, 3, ends_at_first=ends_at_first)
    assert (found.is_interrupted, found.exit_code) == (is_interrupted, exit_code(code))
