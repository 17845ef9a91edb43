"""Each refusal of the check of a rig points to the line of its key, and names its value.

The line is the one with `# here`, in a rig above a shipped one.
"""

from collections.abc import Callable
from pathlib import Path

import pytest

from axisrig.bench.rig.check import check_rig
from axisrig.bench.rig.reading.file import error_at
from axisrig.bench.rig.settings import Settings
from axisrig.kernel.errors import UserError

RIGS = Path(__file__).parents[2] / "testplans" / "rigs"
EVENT_MAP = (RIGS / "lists" / "pdo-second-every-2.csv").as_posix()
Case = tuple[str, str, str, object]

OF_ANY: list[Case] = [
    ("probe-z", "[cycle]\ncycle_offset_us = 1000 # here", "must start within the period", 1000),
    ("plc-radio", '[plc]\nprogram = "none.py" # here', "the PLC program is no file", ...),
    ("probe-z-ethercat", '[axis.Z]\nsegment = "c7" # here\n[segment.c7]\ncarrier = "cyclic"',
     "segment c7 (carrier cyclic) does not carry drives of the family canopen, which drive servo"
     " is as it names no family", "cyclic"),
    ("probe-z-profidrive", '[axis.Z]\nsegment = "e7" # here\n[segment.e7]\ncarrier = "ethercat"',
     "segment e7 (carrier ethercat) does not carry drives of the family profidrive; found",
     "ethercat"),
    ("probe-xyz", '[axis.X]\nplant = "y" # here', "two axes cannot drive one plant", "y"),
    ("probe-z", '[axis.S] # here\nlist = "lists/s.lst"\nsegment = "can1"\nnode = 9\n'
     'drive = "servo"\nplant = "s"\n[plant.s]\nfmu = "AxisRig.Drives.ServoAxis"',
     "needs a name of its own", "S"),
]  # fmt: skip
OF_CANOPEN: list[Case] = [
    ("distance-xz-one-segment", "[axis.Z]\nnode = 1 # here", "axes X and Z have the same node", 1),
    ("probe-z", "[segment.can1] # here\nbitrate = 125_000", "the cycle does not fit", ...),
    ("probe-z", '[drive.servo]\nlatch_encoder = "second" # here',
     "latches its second encoder and axis Z has none", "second"),
    ("distance-z", '[drive.servo]\npdo_map = "EVENT_MAP"\nmode = 9 # here',
     "carry a set position and mode 9", 9),
    ("distance-z", "[drive.servo]\nmode = 9 # here", "needs a drive that closes the position", 9),
]  # fmt: skip
OF_LINES: list[Case] = [
    ("probe-z-ethercat", '[segment.ec2] # here\ncarrier = "ethercat"', "no axis is on segment ec2",
     ...),
    ("probe-z-ethercat", "[segment.ec1]\nframe_us = 1000 # here", "after the end of the cycle",
     1000),
    ("probe-z-ethercat", "[segment.ec1]\nshift_us = 1000 # here", "after the end of the cycle",
     1000),
    ("probe-z-ethercat", "[segment.ec1]\nframe_us = 600 # here", "at the instant of the NC cycle",
     600),
    ("probe-z-ethercat", "[cycle]\nheartbeat_ms = 10 # here", "heartbeat_ms is about CAN", 10),
    ("probe-z-ethercat", "[cycle]\nheartbeat_ms = 10\nsync_counter = 240 # here",
     "sync_counter is about CAN", 240),
    ("plc-timestamp-line", "[segment.ec1]\ndc = false # here", "the line has none", False),
    ("plc-timestamp-line", "[plc]\nclock_offset_ns = 5 # here", "its clock is that of its slave",
     5),
    ("plc-timestamp-line", "[plc]\nclock_drift_ppm = 2.5 # here", "its clock is that of its slave",
     2.5),
    ("probe-z-ethercat", "[segment.ec1] # here\nwire_ns = 600_000", "the cycle does not fit", ...),
    ("probe-z-ethercat", "[drive.servo]\nguard_time_ms = 100 # here", "there is no node guarding",
     100),
    ("distance-z-ethercat", '[drive.servo]\npdo_map = "EVENT_MAP" # here',
     "TPDO4 comes with every 2. SYNC only", 2),
    *[("probe-z-ethercat", f"[segment.ec1]\n{key} = {{ Z = 1, Q = 5 }} # here",
       f"{key} names no axis of it", "Q")
      for key in ("wire_ns", "slave_ns", "drift_ppm", "clock_start_us", "sample_us",
                  "assumed_sample_us")],
]  # fmt: skip
OF_IMAGES: list[Case] = [
    ("probe-z-conventional", "[segment.card]\noutput_us = 20\nbus_us = 10 # here",
     "a conventional drive is at a card of the control", 10),
    ("probe-z-profidrive", "[segment.bus]\nbus_us = 200\noutput_us = 200\ninput_us = 800 # here",
     "input_us does not fit", 800),
    ("probe-z-profidrive", "[segment.bus]\nbus_us = 601 # here\noutput_us = 700",
     "bus_us does not fit", 601),
    ("probe-z-profidrive", "[segment.bus]\noutput_us = 1000 # here", "output_us does not fit",
     1000),
    ("probe-z-profidrive", "[segment.bus]\nbus_us = 300\noutput_us = 299 # here",
     "before these have come", 299),
    ("probe-z-profidrive", '[segment.two] # here\ncarrier = "cyclic"', "no axis is on segment two",
     ...),
    ("probe-z-encoder-terminal", "[drive.servo]\nlines = 40_960 # here", "how often it has wrapped",
     40_960),
    ("probe-z-lightbus", '[drive.servo]\nmissing_cycles = 9\nlatch_variable = "LATCH16" # here',
     "in which turn LATCH16 was", "LATCH16"),
    ("probe-z-sercos", '[drive.servo]\nat = ["S-0-0051", "S-0-0047"] # here', "the AT cannot carry",
     "S-0-0047"),
    ("probe-z-sercos", '[drive.servo]\nmdt = ["S-0-0036"] # here', "the MDT needs S-0-0047",
     "S-0-0036"),
    ("probe-z-sercos", '[drive.servo]\nat = ["S-0-0051", "S-0-0131"] # here', "does not carry",
     "S-0-0051 S-0-0131"),
    ("probe-z-sercos", "[cycle]\nperiod_us = 1500 # here", "500 us or whole ms", 1500),
]  # fmt: skip
OF_REAL: list[Case] = [
    ("probe-z", "[axis.Z]\noutside = true # here", "cannot have a real drive", ...),
    ("probe-xyz", '[segment.can2]\ninterface = "virtual"\nchannel = "a"\n'
     '[axis.X]\nprobe_1 = "probe" # here', "reads an axis outside", "probe"),
]  # fmt: skip


@pytest.mark.parametrize(
    ("base", "text", "words", "value"), [*OF_ANY, *OF_CANOPEN, *OF_LINES, *OF_IMAGES, *OF_REAL]
)
def test_a_refusal_points_to_its_key(
    rig_above: Callable[..., Settings],
    tmp_path: Path,
    base: str,
    text: str,
    words: str,
    value: object,
) -> None:
    (tmp_path / "lists").mkdir()
    (tmp_path / "lists" / "s.lst").write_text("kopf.log_achs_name S\n", encoding="utf-8")
    settings = rig_above(f"{base}.toml", text.replace("EVENT_MAP", EVENT_MAP))
    with pytest.raises(UserError) as caught:
        check_rig(settings)
    error = caught.value
    assert words in str(error)
    path = tmp_path / "rig.toml"
    (line,) = [n for n, each in enumerate(path.read_text().splitlines(), 1) if "# here" in each]
    assert (error.file, error.line) == (str(path), line)
    assert value is ... or error.value == value


AXIS = """[axis.{0}]
list = "lists/s.lst"
segment = "{1}"
drive = "servo"
plant = "{2}"
[plant.{2}]
fmu = "AxisRig.Drives.ServoAxis"
"""


@pytest.mark.parametrize(
    ("base", "text", "words", "line"),
    [
        # Behind axes that have what they need, and behind others that are wrong too
        ("probe-xyz", AXIS.format("W", "can1", "w"), "the rig lacks the key axis.W.node", 2),
        (
            "probe-xyz",
            AXIS.format("V", "can2", "v") + AXIS.format("W", "can1", "w"),
            "the rig lacks the key axis.V.node",
            2,
        ),
        ("probe-xyz-mixed", AXIS.format("W", "can1", "w"), "the rig lacks the key axis.W.node", 2),
        (
            "probe-xyz-mixed",
            "[axis.Z]\nnode = 9",
            "axis Z: on segment ec1 (ethercat) there are no nodes; found 9",
            3,
        ),
        ("probe-xyz-ethercat", "[axis.Y]\nnode = 9", "axis Y: on segment ec1 (ethercat)", 3),
        ("probe-z-profidrive", "[axis.Z]\nnode = 9", "axis Z: on segment bus (cyclic)", 3),
    ],
)
def test_a_node_that_is_missing_or_too_much_is_found_on_any_axis(
    rig_above: Callable[..., Settings],
    tmp_path: Path,
    base: str,
    text: str,
    words: str,
    line: int,
) -> None:
    with pytest.raises(UserError) as caught:
        rig_above(f"{base}.toml", text)
    assert words in str(caught.value)
    assert (caught.value.file, caught.value.line) == (str(tmp_path / "rig.toml"), line)


def test_an_error_that_gets_the_place_of_a_key_keeps_all_that_it_says(tmp_path: Path) -> None:
    rig = tmp_path / "rig.toml"
    rig.write_text('title = "x"\n\n[drive.servo]\nlead_mm = 5.0\n', encoding="utf-8")
    error = UserError("cannot be", value=5.0, allowed="1 to 3", hint="a shorter one")
    for keys, line, message in (
        (("drive", "servo", "lead_mm"), 4, None),
        (("drive", "servo", "mode"), 3, "another"),
        (("axis", "Z"), None, None),
    ):
        found = error_at([rig], keys, error, message)
        assert (found.file, found.line) == (str(rig), line)
        assert found.message == (message or "cannot be")
        assert (found.value, found.allowed, found.hint) == (5.0, "1 to 3", "a shorter one")
