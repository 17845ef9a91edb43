"""What `axisrig check` shows of a drive that only takes a speed, by hand for each family.

The limit of an integrator with d dead cycles under a held speed is 2 sin(pi/(2 (2 d + 1)))/T.
"""

import math
from collections.abc import Callable
from pathlib import Path

import pytest

from axisrig.bench.rig.conventional.checks import describe_conventional
from axisrig.bench.rig.encoder_terminal.checks import describe_encoder_terminal
from axisrig.bench.rig.lightbus.checks import describe_lightbus
from axisrig.bench.rig.settings import Settings

RIGS = Path(__file__).parents[2] / "testplans" / "rigs"
RigAbove = Callable[..., Settings]
ANALOGUE = ("drive:servo.rpm_at_10v=1500", "drive:servo.output_bits=12",
            "drive:servo.output_offset=-100")  # fmt: skip
FAMILIES = [
    # 1500 rpm of 10 mm are 250 mm/s at 32767; 12 bits are steps of 16
    ("conventional", describe_conventional, ANALOGUE, 12, 16, -100, "a counter is no absolute"),
    ("encoder-terminal", describe_encoder_terminal, ANALOGUE, 12, 16, -100,
     "a counter of 16 bits is no absolute"),
    ("lightbus", describe_lightbus, ("drive:servo.rpm_at_full=1500",), 16, 1, 0,
     "nothing beside its image gives"),
]  # fmt: skip


@pytest.mark.parametrize(
    ("family", "describe", "keys", "bits", "step", "offset", "reason"),
    FAMILIES,
    ids=[row[0] for row in FAMILIES],
)
def test_loop_output_and_place_of_a_speed_drive_in_words(
    rig_above: RigAbove,
    family: str,
    describe: Callable[[Settings, str, int], list[str]],
    keys: tuple[str, ...],
    bits: int,
    step: int,
    offset: int,
    reason: str,
) -> None:
    """Kv 25/s, a quarter of the speed is lag: 0.75 x 10/25 mm. 1.5 cycles of way and half of one
    in the drive are two dead ones."""
    settings = rig_above(
        f"probe-z-{family}.toml", "", *keys, "set:Z.getriebe[0].kv=2500",
        "set:Z.vorsteuer.vorsteuerung=1", "set:Z.vorsteuer.default_active=1",
        "set:Z.vorsteuer.vs_v_faktor=1", "set:Z.vorsteuer.vs_v_nenner=4",
        "drive:servo.speed_loop_us=500",
    )  # fmt: skip
    loop, output, *rest = describe(settings, "Z", 1_500_000)
    limit = 2.0 * math.sin(math.pi / 10.0) / 1e-3
    assert loop == (
        "axis Z: the CNC closes the position loop: Kv 25 1/s, feed-forward 0.25, lag 0.3 mm at"
        f" 10 mm/s; stable below {limit:.4g} 1/s with 2 dead cycles"
    )
    one_um_s = 250e3 / 32767
    words = [f"{one_um_s * counts:.4g} um/s" for counts in (step, offset)]
    lags = [f"{one_um_s * counts / 25:.4g} um" for counts in (step, offset)]
    assert output == (
        f"axis Z: output of {bits} bits, 250 mm/s at the full one: steps of {words[0]} are"
        f" {lags[0]} of lag, its offset {words[1]} {lags[1]}"
    )
    places = [line for line in rest if line.startswith("warning: axis Z: the position from which")]
    assert len(places) == 1
    assert f"telegrams alone: an axis jumps by what is wrong in them: {reason}" in places[0]


@pytest.mark.parametrize(
    ("keys", "mode"),
    [
        ((), None),
        (("drive:servo.in2mode=25",), 25),
        (("drive:servo.in2mode=25", "set:Z.kenngr.messachse=0"), None),
        (("drive:servo.in2mode=25", "set:Z.kenngr.measure.signal=PLC"), None),
    ],
)
def test_an_input_that_latches_nothing_is_warned_of_where_an_axis_measures_with_it(
    rig_above: RigAbove, keys: tuple[str, ...], mode: int | None
) -> None:
    """IN2MODE 26 latches; the rig has it."""
    found = describe_lightbus(rig_above("probe-z-lightbus.toml", "", *keys), "Z", 1_000_000)
    warned = [line for line in found if "latches nothing" in line]
    assert warned == ([] if mode is None else [
        f"warning: axis Z: in2mode of its drive is {mode} and not 26: its input 2 latches nothing"
    ])  # fmt: skip


def test_a_drive_without_in2mode_is_warned_of(
    tmp_path: Path, settings_of: Callable[..., Settings]
) -> None:
    """The rig without the key: nothing says that input 2 latches."""
    text = (RIGS / "probe-z-lightbus.toml").read_text(encoding="utf-8")
    assert text.count("in2mode = 26\n") == 1
    text = text.replace("in2mode = 26\n", "").replace('"lists/', f'"{RIGS.as_posix()}/lists/')
    rig = tmp_path / "rig.toml"
    rig.write_text(text, encoding="utf-8")
    found = describe_lightbus(settings_of(rig), "Z", 1_000_000)
    assert [line for line in found if "latches nothing" in line] == [
        "warning: axis Z: in2mode of its drive is 0 and not 26: its input 2 latches nothing"
    ]
