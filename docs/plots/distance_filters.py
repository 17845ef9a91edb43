"""The filters of the sensor value over an obstacle of 2.8 mm, as in the filter test of FCT-M3 4.

One run of `testplans/distance_filters.csv` gives what the sensor showed with distance control in
DRYRUN; every curve is a filter of the kernel over these values. `python
docs/plots/distance_filters.py` draws docs/images/filter-*.svg.
"""

import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

HERE = Path(__file__).parent
ROOT = HERE.parents[1]
sys.path.insert(0, str(ROOT))

from axisrig.bench.campaign.preparing import settings_of  # noqa: E402
from axisrig.bench.machine.machine import Machine  # noqa: E402
from axisrig.bench.plan.plan import read_plan  # noqa: E402
from axisrig.kernel.distance.filters import FilterSettings, filter_kinds, make_filter  # noqa: E402
from axisrig.kernel.nc.text.parser import read_program  # noqa: E402
from axisrig.kernel.time.clock import MS  # noqa: E402

PLAN = ROOT / "testplans" / "distance_filters.csv"
PERIOD_NS = 1 * MS


@dataclass(frozen=True)
class Panel:
    """One row of a picture: a parameter that changes, all others fixed."""

    settings: FilterSettings
    parameter: str
    values: Sequence[float]
    label: str

    def curves(self) -> Mapping[str, FilterSettings]:
        """Label and settings of each curve."""
        return {
            self.label.format(value): replace(self.settings, **{self.parameter: value})
            for value in self.values
        }


def _panel(kind: str, label: str, parameter: str, *values: float, **fixed: Any) -> Panel:
    return Panel(FilterSettings(kind, **fixed), parameter, values, label)


N, A, SIGMA = "n_cycles {:g}", "smoothing factor {:g}", "sigma {:g}"
PICTURES: dict[str, Sequence[Panel]] = {
    "moving-average": [_panel("MOVING_AVERAGE", N, "n_cycles", 4, 20, 50)],
    "expo-mean": [
        _panel("EXPO_MEAN", A, "smoothing_factor", 0.7, 0.3, 0.1, 0.03, n_cycles=30),
        _panel("EXPO_MEAN", N, "n_cycles", 5, 15, 50, smoothing_factor=0.05),
    ],
    "lowpass": [
        _panel("LOWPASS", "order {:g}", "low_pass_filter_order", 1, 2, 4, 6),
        _panel("LOWPASS", "{:g} Hz", "low_pass_filter_fg_f0", 100.0, 50.0, 25.0, 10.0),
    ],
    "kalman-ma": [
        _panel("KALMAN_MA", N, "n_cycles", 5, 20, 50, kalman_sigma=2000.0),
        _panel("KALMAN_MA", SIGMA, "kalman_sigma", 200.0, 1000.0, 5000.0, n_cycles=20),
    ],
    "kalman-expo": [
        _panel("KALMAN_EXPO", N, "n_cycles", 5, 20, 50, smoothing_factor=0.05, kalman_sigma=2000.0),
        _panel("KALMAN_EXPO", A, "smoothing_factor", 0.5, 0.1, 0.03, n_cycles=30, kalman_sigma=2e3),
        _panel(
            "KALMAN_EXPO",
            SIGMA,
            "kalman_sigma",
            200.0,
            1000.0,
            5000.0,
            n_cycles=30,
            smoothing_factor=0.05,
        ),
    ],
}


@cache
def recorded() -> tuple[Any, Any]:
    """Times (ms) and distances (mm) that the kernel got, without the approach."""
    case = read_plan(PLAN).cases[0]
    settings = settings_of(case)
    machine = Machine(settings, read_program(case.program, tuple(settings.rig.axis)))
    try:
        machine.run()
        table = machine.recorder.table()
    finally:
        machine.close()
    # The row of the command itself has no value yet
    rows = np.flatnonzero(np.asarray(table["Z.distance_state"]))[1:]
    times_ms = np.asarray(table["time_ns"])[rows] * 1e-6
    return times_ms - times_ms[0], np.asarray(table["Z.distance_cnc_mm"])[rows]


def filtered(settings: FilterSettings, values_mm: Any) -> Any:
    """What a filter makes of these values."""
    made = make_filter(settings.kind, settings, PERIOD_NS)
    made.restart(float(values_mm[0]))
    return np.array([made.step(float(value)) for value in values_mm])


def draw(folder: Path) -> list[Path]:
    """Draw a picture per filter; return where they lie."""
    import matplotlib as mpl  # noqa: PLC0415
    from matplotlib import pyplot as plt  # noqa: PLC0415

    mpl.use("svg")
    mpl.rcParams.update({"svg.hashsalt": "axisrig", "svg.fonttype": "none", "font.size": 9})
    times_ms, values_mm = recorded()
    written = []
    for name, panels in PICTURES.items():
        figure, rows = plt.subplots(
            len(panels),
            3,
            figsize=(9.5, 0.4 + 2.5 * len(panels)),
            squeeze=False,
            layout="constrained",
            width_ratios=(3, 2, 2),
        )
        for panel, places in zip(panels, rows, strict=True):
            _draw_panel(panel, places, times_ms, values_mm)
        written.append(folder / f"filter-{name}.svg")
        figure.savefig(written[-1], metadata={"Date": None})
        plt.close(figure)
    return written


def _draw_panel(panel: Panel, places: Any, times_ms: Any, values_mm: Any) -> None:
    """The obstacle on the left, then, magnified, the plane before it and the end of its flank."""
    high, low = (float(np.percentile(values_mm, share)) for share in (50, 2))
    begins, reached, ends = (
        float(times_ms[index])
        for index in (
            np.argmax(values_mm < high - 0.05 * (high - low)),
            np.argmax(values_mm < low + 0.02 * (high - low)),
            len(values_mm) - np.argmax(values_mm[::-1] < high - 0.05 * (high - low)),
        )
    )
    spans = [(begins - 100, ends + 150), (begins - 150, begins), (reached - 40, reached + 120)]
    curves = {label: filtered(settings, values_mm) for label, settings in panel.curves().items()}
    for place, (first, last) in zip(places, spans, strict=True):
        rows = (times_ms >= first) & (times_ms <= last)
        shown_ms = times_ms[rows] - begins
        place.plot(shown_ms, values_mm[rows], color="0.75", linewidth=0.8, label="unfiltered")
        for label, curve in curves.items():
            place.plot(shown_ms, curve[rows], linewidth=1.2, label=label)
        place.set_xlabel("ms")
        place.grid(alpha=0.3)
    places[1].set_ylim(high - 0.15, high + 0.15)
    places[2].set_ylim(low - 0.12 * (high - low), low + 0.3 * (high - low))
    places[0].set_ylabel("distance, mm")
    fixed = [
        f"{name.removeprefix('low_pass_filter_')} {getattr(panel.settings, name):g}"
        for name in filter_kinds()[panel.settings.kind].parameters
        if name != panel.parameter
    ]
    places[0].set_title(", ".join([panel.settings.kind, *fixed]), loc="left")
    places[0].legend(fontsize=8)


if __name__ == "__main__":
    for path in draw(HERE.parent / "images"):
        print(path)
