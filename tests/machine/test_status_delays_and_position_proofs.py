"""How old the status words of drives are, and what proves latches and positions of their links."""

from types import SimpleNamespace
from typing import Any, cast

import pytest
from tests.machine.made_rigs import settings_of

from axisrig.bench.machine.canopen.links import _link_settings
from axisrig.bench.machine.cyclic.profidrive_drive import profidrive_settings
from axisrig.bench.machine.ethercat import cia402_slave
from axisrig.bench.machine.ethercat.cia402_slave import slave_settings
from axisrig.kernel.drives.ethercat.link import make_data
from axisrig.kernel.time.scheduler import new_scheduler


@pytest.mark.parametrize("cycles", [0, 1, 2])
@pytest.mark.parametrize(
    ("base", "read"), [("probe-z.toml", _link_settings), ("probe-z-ethercat.toml", slave_settings)]
)
def test_a_status_word_is_as_old_as_the_drive_has_it(base: str, read: Any, cycles: int) -> None:
    """By status_delay_cycles, on whatever carrier."""
    settings = settings_of(base, f"drive:servo.status_delay_cycles={cycles}")
    assert read(settings, "Z").status_delay_cycles == cycles


@pytest.mark.interpreted
@pytest.mark.parametrize("latches", [True, False])
@pytest.mark.parametrize("places", [True, False])
def test_on_a_line_latches_and_places_are_proved_each_for_itself(
    latches: bool, places: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """latch_check and position_check of the drive."""
    made: list[dict[str, Any]] = []

    def link(*_: Any, **proofs: Any) -> Any:
        made.append(proofs)
        return SimpleNamespace(node_id=1, mailbox=None, set_object=None)

    for name in ("EthercatLink", "StartUp", "CoeSteps"):
        monkeypatch.setattr(cia402_slave, name, link)
    keys = {"latch_check": latches, "position_check": places}
    changes = [f"drive:servo.{key}={str(value).lower()}" for key, value in keys.items()]
    settings = settings_of("probe-z-ethercat.toml", *changes)
    ends: Any = cia402_slave.Cia402Ends.__new__(cia402_slave.Cia402Ends)
    ends._settings, ends.settings = settings, slave_settings(settings, "Z")
    ends.data = make_data(ends.settings)
    monkeypatch.setattr(cia402_slave, "Mailbox", lambda *_: SimpleNamespace(port=None))
    ends.connect(cast("Any", None), new_scheduler())
    assert made[0] == {"proves_latches": latches, "proves_places": places}


@pytest.mark.parametrize("check", [True, False])
@pytest.mark.parametrize(("p1042", "p1043"), [(11, 11), (11, 12), (11, 9)])
def test_a_place_of_profidrive_is_proved_where_both_positions_count_alike(
    check: bool, p1042: int, p1043: int
) -> None:
    """P1043 fine bits of the absolute position as P1042 of G1_XIST1, and position_check."""
    keys = {"p1042": p1042, "p1043": p1043, "position_check": str(check).lower()}
    changes = [f"drive:servo.{key}={value}" for key, value in keys.items()]
    found = profidrive_settings(settings_of("probe-z-profidrive.toml", *changes), "Z")
    assert found.proves_places is (check and p1042 == p1043)
