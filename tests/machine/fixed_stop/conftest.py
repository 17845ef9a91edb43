"""Runs to a fixed stop on a real plant: a balanced Z whose torque limit is lowered by #DRIVE."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import pytest
from tests.machine.conftest import RIGS, Outcome, run_files

from axisrig.bench.campaign.results.writer import CaseResult
from axisrig.bench.judge.fixed_stop.findings import stop_findings
from axisrig.bench.judge.fixed_stop.stop_findings import StopFindings
from axisrig.bench.judge.observed.observed import Observed
from axisrig.kernel.measuring.fixed_stop.record import FixedStopRecord
from axisrig.kernel.measuring.run import RunRecord


def observed(result: CaseResult) -> Observed:
    """What a case has left, as judges read it."""
    assert result.facts is not None
    assert result.series is not None
    return Observed(result.facts, result.series)


def blocks(result: CaseResult) -> list[StopFindings]:
    """What the report shows of each run to a fixed stop."""
    return stop_findings(observed(result))


DETECT = "set:Z.kenngr.measure.fixed_stop_detect."
TO_STOP = """\
N010 #MEAS MODE[7]
N020 G0 G90 Z{start}
N030 #DRIVE WR SYN [AX=Z KEY=TORQUE_LIMIT VAL={torque} WAIT]
N040 #DRIVE WR SYN [AX=Z KEY=MON_WINDOW VAL={lag_window} WAIT]
N050 G100 Z{target} F{feed}
N060 #MSG SYN["MERF=%d", V.A.MERF.Z]
N070 $IF V.A.MERF.Z
N080 #MSG SYN["MESS=%.9f", V.A.MESS.Z]
N090 $ENDIF
N100 #MSG SYN["ABS=%.9f", V.A.ABS.Z]
"""


@dataclass(frozen=True)
class StopOutcome:
    """A run with its records."""

    outcome: Outcome

    @property
    def record(self) -> RunRecord:
        (record,) = self.outcome.machine.channel.records
        return record

    @property
    def stop(self) -> FixedStopRecord:
        assert self.record.fixed_stop is not None
        return self.record.fixed_stop

    @property
    def alarms(self) -> list[int]:
        return self.outcome.alarms


RunStop = Callable[..., StopOutcome]


@pytest.fixture
def run_stop(tmp_path: Path) -> RunStop:
    """Return `run(stop position or None, *assignments, target=150, feed=600, torque=40, ...)`."""

    def run(
        stop_mm: float | None,
        *assignments: str,
        start: float = 100,
        target: float = 150,
        feed: float = 600,
        torque: float = 40,
        lag_window: int = 2**32 - 1,
        end: str = "",
        before: str = "",
        watch: Callable[..., None] | None = None,
        **detect: object,
    ) -> StopOutcome:
        program = tmp_path / "stop.nc"
        text = TO_STOP.format(
            start=start, target=target, feed=feed, torque=torque, lag_window=lag_window
        )
        program.write_text(f"%stop\n{before}{text}{end}\nN999 M30\n", encoding="utf-8")
        place = [f"plant:z.position_start_mm={start}"]
        place += [] if stop_mm is None else [f"plant:z.stop_position_mm={stop_mm}"]
        settings = [f"{DETECT}{name}={value}" for name, value in detect.items()]
        source = "set:Z.kenngr.measure.signal=FIXED_STOP"
        given = [source, *place, *settings, *assignments]
        rig = RIGS / "drive-functions.toml"
        return StopOutcome(run_files(program, rig, given, watch))

    return run
