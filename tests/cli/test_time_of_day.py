"""The time of day of some seconds ago, as the command line reports it."""

from datetime import UTC, datetime, tzinfo
from types import SimpleNamespace

import pytest

from axisrig.bench.cli import outside


@pytest.mark.parametrize(
    ("ago_s", "text"),
    [(0.0, "2026-03-01T00:00:30+00:00"), (30.9, "2026-03-01T00:00:00+00:00"),
     (31.0, "2026-02-28T23:59:59+00:00"), (86_400.0, "2026-02-28T00:00:30+00:00")],
)  # fmt: skip
def test_a_time_of_day_is_in_utc_and_whole_seconds(
    ago_s: float, text: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It is half a minute past midnight, and 0.9 s."""

    def now(zone: tzinfo) -> datetime:
        return datetime(2026, 3, 1, 0, 0, 30, 900_000, tzinfo=UTC).astimezone(zone)

    monkeypatch.setattr(outside, "datetime", SimpleNamespace(now=now))
    assert outside.time_of_day(ago_s) == text
