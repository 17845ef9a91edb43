"""What the control hears of a slave on EtherCAT beside its process data, from begin to end."""

from types import SimpleNamespace
from typing import Any

from axisrig.kernel.drives.ethercat.watch import EthercatWatch
from axisrig.kernel.drives.power import Power
from axisrig.kernel.errors import Alarm


def test_a_slave_is_watched_from_begin_to_end_and_its_fall_counts_before_a_jump() -> None:
    log: list[str] = []
    fallen: list[Alarm | None] = [None]
    carrier: Any = SimpleNamespace(
        watch=log.append, watch_no_more=lambda: log.append("no more"),
        fallen=lambda axis: fallen[0] if axis == "Z" else None,
    )  # fmt: skip
    link: Any = SimpleNamespace(
        name="Z", begin=lambda: log.append("begin"), jump_mm=None, power=Power.OPERATING
    )
    watch = EthercatWatch(link, carrier)
    for _ in range(2):
        watch.begin()
        assert watch.communication() is None
        link.jump_mm, fallen[0] = 7.5, Alarm(900732, axis="Z", position=1, state="?", code="0")
        assert watch.communication() is fallen[0]
        fallen[0] = None
        jump = watch.communication()
        assert jump is not None
        assert (jump.id, jump.values["jump_mm"]) == (900029, "7.500")
        assert watch.communication() is None
        watch.end()
    assert log == ["begin", "Z", "no more"] * 2
