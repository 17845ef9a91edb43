"""What the measuring types say about a run: speed, stroke of the probe, overtravel, no signal.

`measuring_types.csv` says which of it holds for a type. Nothing here depends on a machine: an
independent axis and the path ask the same functions.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from math import dist, inf

from axisrig.kernel.errors import Alarm
from axisrig.kernel.measuring.fixed_stop.settings import FixedStopSettings
from axisrig.kernel.nc.measuring_types import MeasuringType
from axisrig.kernel.parameters import ParameterSet
from axisrig.kernel.parameters.drive_types import CANOPEN, DriveType
from axisrig.kernel.parameters.signal_sources import SOURCES
from axisrig.kernel.parameters.start_up import drive_type
from axisrig.kernel.time.clock import TimeNs

SIGNAL = "kenngr.measure.signal"
FIXED_STOP = "FIXED_STOP"
PLC, PLC_FIRST_EVENT, PLC_TIMESTAMP = "PLC", "PLC_FIRST_EVENT", "PLC_TIMESTAMP"
EXTERNAL, EXTERNAL_WITH_DRIVE = "PLC_EXT_LATCH_CONTROL", "EXT_PROBE_WITH_DRIVE"
OF_PLC = tuple(name for name, source in SOURCES.items() if source.needs_plc)
"""Sources that need a task of the PLC."""
BY_PROGRAM, BY_PARAMETER = "ERR_NO_SIGNAL", "P-CHAN-00176"
"""What decides about an alarm when no signal comes, ERR_NO_SIGNAL in both."""


@dataclass(frozen=True)
class MeasuringAxis:
    """What the parameter list of an axis says about measuring.

    speed_mm_s: P-AXIS-00215. stroke_mm: P-AXIS-00086. offset_mm, old_offset_mm: allowed way past
    the target, P-AXIS-00467 and P-AXIS-00114. delay_ns: how late its probe signals, P-AXIS-00487.
    probe_inputs: what INPUT=PROBE0 and PROBE1 of #MEAS mean, P-AXIS-00583. source: where the signal
    comes from, P-AXIS-00516 or the older switches. probe_input: P-AXIS-00517 or the older
    one. simulated: mode and the four values of a probe that the CNC simulates, P-AXIS-00112
    and 00145 to 00148; mode 0: a real one. fixed_stop: of runs to one. drive: its type,
    P-AXIS-00020.
    """

    speed_mm_s: float = 16.666
    stroke_mm: float = inf
    offset_mm: float = 0.0
    old_offset_mm: float = 0.0
    delay_ns: TimeNs = 0
    probe_inputs: tuple[int, int] = (1, 1)
    source: str = "DRIVE"
    probe_input: int = 1
    simulated: tuple[int, ...] = (0, 0, 0, 0, 0)
    fixed_stop: FixedStopSettings = field(default_factory=FixedStopSettings)
    drive: DriveType = CANOPEN

    @classmethod
    def read(cls, axis: ParameterSet) -> "MeasuringAxis":
        """Take them from the parameters of an axis."""
        return cls(
            speed_mm_s=axis.mm_s("kenngr.vb_messen"),
            stroke_mm=axis.mm("kenngr.hub_messtaster"),
            offset_mm=axis.mm("kenngr.probing_offset"),
            old_offset_mm=axis.mm("kenngr.mess_offset"),
            delay_ns=axis.ns("kenngr.probe_actuation_time_delay"),
            probe_inputs=(
                axis.integer("kenngr.measure.probe[0].input"),
                axis.integer("kenngr.measure.probe[1].input"),
            ),
            source=axis.word(SIGNAL),
            probe_input=axis.integer("kenngr.measure.input"),
            simulated=(
                axis.integer("meas_simu.meas_simu_mode"),
                *(axis.integer(f"meas_simu.parameter{number}") for number in range(1, 5)),
            ),
            fixed_stop=FixedStopSettings.read(axis),
            drive=drive_type(axis),
        )

    def check(self, axis: str, kind: MeasuringType, source: str, *, is_beside: bool) -> None:
        """Refuse a run that another signal than the one of its type would end.

        source: in use, by the list or by #MEAS. is_beside: for an axis beside the path.
        Raises Alarm 900100, 900241 and 900242.
        """
        mode = self.simulated[0]
        if mode and (is_beside or kind.runs_to_stop):
            word = f"meas_simu.meas_simu_mode = {mode} of axis {axis}"
            where = "in a run to a fixed stop" if kind.runs_to_stop else "beside the path"
            raise Alarm(900100, word=word, what=f"simulated probe {where}")
        if kind.runs_to_stop:
            if source != FIXED_STOP:
                raise Alarm(900241, axis=axis, source=source, type=kind.number)
        elif source == FIXED_STOP and not mode:
            raise Alarm(900242, axis=axis, source=source, type=kind.number)

    def inputs_of(self, source: str) -> int:
        """Return the highest probing input with a source (P-AXIS-00517); others use none."""
        return self.drive.inputs_of(source) or 2

    def needs_plc(self, source: str) -> bool:
        """Return whether a source needs the PLC, which a simulated probe does not."""
        return source in OF_PLC and not self.simulated[0]

    def overtravel_mm(self, kind: MeasuringType) -> float:
        """Return how far the axis may go past its target in a run of a type."""
        known = {"P-AXIS-00467": self.offset_mm, "P-AXIS-00114": self.old_offset_mm}
        return next((known[name] for name in kind.overtravel if known[name]), 0.0)


def least_stroke_mm(kind: MeasuringType, moving: Sequence[MeasuringAxis]) -> float:
    """Return within which way a run has to stop at its signal, inf where its type keeps no stroke.

    moving: the axes that the path moves; the smallest stroke counts for the whole path. Neither the
    time until the stop acts nor the lag of the drives is counted: the manual has the stroke of the
    list allow for it.
    Source: FCT-C4, P-AXIS-00086 with its remark.
    """
    return min(axis.stroke_mm for axis in moving) if kind.keeps_stroke else inf


def lengthened(
    here: Mapping[str, float], target: Mapping[str, float], overtravel_mm: Mapping[str, float]
) -> dict[str, float]:
    """Return the target of a path that is longer by what its axes may go past theirs.

    The axis that allows least decides. All in mm. Source: FCT-C4, P-AXIS-00467.
    """
    start, end = tuple(here.values()), tuple(target[name] for name in here)
    length_mm = dist(start, end)
    extra_mm = min(
        overtravel_mm[name] * length_mm / abs(target[name] - here[name])
        for name in here
        if target[name] != here[name]
    )
    if not extra_mm:
        return dict(target)
    scale = 1.0 + extra_mm / length_mm
    return {name: here[name] + (target[name] - here[name]) * scale for name in here}


def misses_signal(kind: MeasuringType, parameter: bool, programmed: bool | None) -> bool:
    """Return whether a run without a signal is an alarm.

    parameter: P-CHAN-00176, which is about type 1. programmed: ERR_NO_SIGNAL of #MEAS, None where
    the program has not written it.
    """
    if kind.no_signal == BY_PROGRAM:
        return bool(programmed)
    if kind.no_signal == BY_PARAMETER:
        return parameter if programmed is None else programmed
    return kind.no_signal == "alarm"
