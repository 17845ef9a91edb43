"""No object of the drive profile is a mere memory cell.

Every object from 6000 on that can be written stands in `EFFECTS` with a value and a scene. The
scene is played twice on a bus, once with the value written and once without: what the axis is told
or what the drive says on the bus must differ. `WITHOUT_EFFECT` names the others with the reason.
That the effect is the right one is the matter of the tests of each mode, limit and option code.
"""

from collections.abc import Callable
from dataclasses import astuple
from typing import Any

import pytest

from axisrig.bench.drive.cia402.dictionary.objects import variables
from axisrig.kernel.time.clock import MS

Make = Callable[..., Any]
Write = Callable[[], None]
Scene = Callable[[Any, Write], None]
SDO_IDS = (0x583, 0x603)
WITHOUT_EFFECT: dict[tuple[int, int], str] = {}


def run_ms(bench: Any, time_ms: float) -> None:
    """Go on with a SYNC in each millisecond."""
    end_ns = bench.scheduler.now_ns + round(time_ms * MS)
    while bench.scheduler.now_ns < end_ns:
        bench.master.send_message(0x80, b"")
        bench.scheduler.run_until(bench.scheduler.now_ns + 1 * MS)


def enabled(bench: Any, mode: int, write: Write) -> None:
    sdo = bench.remote.sdo
    sdo[0x6060].raw = mode
    write()
    bench.remote.nmt.send_command(1)
    for word in (0x06, 0x07, 0x0F):
        sdo[0x6040].raw = word
    run_ms(bench, 2)


def csp(bench: Any, write: Write) -> None:
    """3 mm in 30 SYNCs, 100 mm/s."""
    enabled(bench, 8, write)
    for n in range(30):
        bench.set_values(0x0F, round(10_485.76 * (n + 1)))
        run_ms(bench, 1)


def csp_and(word: int) -> Scene:
    """Csp, then a controlword while the axis runs."""

    def scene(bench: Any, write: Write) -> None:
        csp(bench, write)
        for _ in range(200):
            bench.set_values(word, 314_573)
            run_ms(bench, 1)

    return scene


def csp_and_fault(bench: Any, write: Write) -> None:
    csp(bench, write)
    bench.node.servo.fault(0x2310, 0x02, bench.scheduler.now_ns)
    run_ms(bench, 100)


def csp_and_silence(bench: Any, write: Write) -> None:
    """The connection is lost in motion."""
    csp(bench, write)
    bench.node.servo.connection_lost(bench.scheduler.now_ns)
    run_ms(bench, 100)


def stuck(bench: Any, write: Write) -> None:
    """The axis does not follow; the following error is monitored with 0.1 mm and 5 ms."""
    bench.axis.motion = lambda t: 0.0
    sdo = bench.remote.sdo
    sdo[0x6065].raw, sdo[0x6066].raw = 10_486, 5
    csp(bench, write)


def pp(bench: Any, write: Write) -> None:
    """10 mm as a set-point, there and (unless 607A is written) back."""
    sdo = bench.remote.sdo
    sdo[0x6083].raw = sdo[0x6084].raw = 104_857_600
    sdo[0x607A].raw = 1_048_576
    enabled(bench, 1, write)
    sdo[0x6040].raw = 0x1F
    run_ms(bench, 250)


def pp_jumpy(bench: Any, write: Write) -> None:
    """As pp, and the axis is off by 0.005 mm now and then for 20 ms."""
    bench.axis.motion = lambda t: (
        bench.axis.demand_position_m() + (5e-6 if round(t * 1e3) % 100 < 20 else 0.0)
    )
    pp(bench, write)


def pv(bench: Any, write: Write) -> None:
    """1 mm/s with 5 mm/s2, then back to rest: windows of 0.5 mm/s open half way."""
    sdo = bench.remote.sdo
    sdo[0x60FF].raw = 104_858
    sdo[0x6083].raw = sdo[0x6084].raw = 524_288
    enabled(bench, 3, write)
    run_ms(bench, 250)
    sdo[0x60FF].raw = 0
    run_ms(bench, 250)


def switching_on(bench: Any, write: Write) -> None:
    """The walk to operation enabled is left to the write."""
    write()
    bench.remote.nmt.send_command(1)
    run_ms(bench, 2)


def csv(bench: Any, write: Write) -> None:
    enabled(bench, 9, write)
    run_ms(bench, 5)


def cst(bench: Any, write: Write) -> None:
    bench.remote.sdo[0x6071].raw = 100
    enabled(bench, 10, write)
    run_ms(bench, 5)


def cst_at_rest(bench: Any, write: Write) -> None:
    enabled(bench, 10, write)
    run_ms(bench, 5)


def cst_back(bench: Any, write: Write) -> None:
    bench.remote.sdo[0x6071].raw = -100
    enabled(bench, 10, write)
    run_ms(bench, 5)


def without_1006(bench: Any, write: Write) -> None:
    """Csv on a plant of its own pace: the period comes from 60C2."""
    bench.remote.sdo[0x1006].raw = 0
    bench.remote.sdo[0x60FF].raw = 1_000_000
    csv(bench, write)


def hm(method: int) -> Scene:
    """Homing by a method, for 100 ms."""

    def scene(bench: Any, write: Write) -> None:
        bench.remote.sdo[0x6098].raw = method
        enabled(bench, 6, write)
        for _ in range(100):
            bench.set_values(0x1F, 0)
            run_ms(bench, 1)

    return scene


def second_encoder(bench: Any, write: Write) -> None:
    """60E4:1 in TPDO4; the second encoder stands at 3 mm."""
    bench.axis.encoder_2_m = 0.003
    sdo = bench.remote.sdo
    sdo[0x1A03][1].raw, sdo[0x1A03][0].raw = 0x60E40120, 1
    sdo[0x1803][2].raw, sdo[0x1803][1].raw = 1, 0x483
    csp(bench, write)


EFFECTS: dict[tuple[int, int], tuple[int, Scene]] = {
    (0x6007, 0): (2, csp_and_silence),
    (0x6040, 0): (0x06, switching_on),
    (0x605A, 0): (5, csp_and(0x02)),
    (0x605B, 0): (1, csp_and(0x06)),
    (0x605C, 0): (0, csp_and(0x07)),
    (0x605D, 0): (2, csp_and(0x10F)),
    (0x605E, 0): (0, csp_and_fault),
    (0x6060, 0): (9, csp),
    (0x6065, 0): (0xFFFFFFFF, stuck),
    (0x6066, 0): (8, stuck),
    (0x6067, 0): (100, pp_jumpy),
    (0x6068, 0): (30, pp),
    (0x606D, 0): (100, pv),
    (0x606E, 0): (15, pv),
    (0x606F, 0): (100, pv),
    (0x6070, 0): (15, pv),
    (0x6071, 0): (50, cst_at_rest),
    (0x6072, 0): (80, cst),
    (0x607A, 0): (500_000, pp),
    (0x607C, 0): (1000, hm(37)),
    (0x607D, 1): (-2_000_000, csp),
    (0x607D, 2): (100_000, csp),
    (0x607F, 0): (1_000_000, pp),
    (0x6080, 0): (60, csp),
    (0x6081, 0): (5_000_000, pp),
    (0x6083, 0): (50_000_000, pp),
    (0x6084, 0): (50_000_000, pp),
    (0x6085, 0): (50_000_000, csp_and(0x02)),
    (0x6086, 0): (1, pp),
    (0x608F, 1): (1 << 19, csp),
    (0x608F, 2): (2, csp),
    (0x6091, 1): (2, csp),
    (0x6091, 2): (2, csp),
    (0x6092, 1): (10_000, csp),
    (0x6092, 2): (2, csp),
    (0x6098, 0): (33, hm(34)),
    (0x6099, 1): (1_000_000, hm(-3)),
    (0x6099, 2): (1_000_000, hm(34)),
    (0x609A, 0): (1_000_000, hm(34)),
    (0x60B0, 0): (1000, csp),
    (0x60B1, 0): (1_000_000, csv),
    (0x60B2, 0): (50, cst),
    (0x60C2, 1): (2, without_1006),
    (0x60C2, 2): (-2, without_1006),
    (0x60C5, 0): (50_000_000, pp),
    (0x60C6, 0): (50_000_000, pp),
    (0x60E0, 0): (80, cst),
    (0x60E1, 0): (80, cst_back),
    (0x60E6, 1): (1 << 19, second_encoder),
    (0x60EB, 1): (3, second_encoder),
    (0x60FF, 0): (1_000_000, csv),
}
# Objects of the touch probe: their effects are shown in test_probe_on_bus.py
OF_THE_PROBE = [(0x60B8, 0), (0x60D0, 1), (0x60D0, 2)]


def played(make: Make, scene: Scene, key: tuple[int, int], value: int | None) -> tuple[Any, ...]:
    """What the axis was told and the drive said; value None = what stands there is written again.

    The scene goes on at the next full millisecond after the write, so that the length of the SDO
    frames does not show.
    """
    bench = make()
    index, sub = key
    bits = variables()[key].data_type.bits

    def write() -> None:
        data = bench.remote.sdo.upload(index, sub)
        if value is not None:
            data = value.to_bytes(bits // 8, "little", signed=value < 0)
        bench.remote.sdo.download(index, sub, data)
        bench.scheduler.run_until(-(-bench.scheduler.now_ns // (10 * MS)) * 10 * MS)

    scene(bench, write)
    found = [astuple(command) for command in bench.axis.commands]
    said = [frame for frame in bench.heard if frame[1] not in SDO_IDS]
    return found, bench.axis.limits, said


def test_every_object_that_can_be_written_has_an_effect_or_a_reason() -> None:
    writable = {key for key, row in variables().items() if key[0] >= 0x6000 and row.access == "rw"}
    named = [*EFFECTS, *OF_THE_PROBE, *WITHOUT_EFFECT]
    assert sorted(named) == sorted(writable)


@pytest.mark.long(but=1)
@pytest.mark.parametrize("key", EFFECTS, ids=lambda key: f"{key[0]:04X}_{key[1]}")
def test_a_write_changes_what_the_axis_is_told_or_what_the_drive_says(
    drive_bench: Make, key: tuple[int, int]
) -> None:
    value, scene = EFFECTS[key]
    assert played(drive_bench, scene, key, None) != played(drive_bench, scene, key, value)


def test_a_write_by_itself_changes_nothing(drive_bench: Make) -> None:
    """Whichever object is written with the value that it has, the scene is the same."""
    for key in [(0x6065, 0), (0x60E0, 0), (0x6091, 2)]:
        assert played(drive_bench, csp, key, None) == played(drive_bench, csp, (0x6066, 0), None)
