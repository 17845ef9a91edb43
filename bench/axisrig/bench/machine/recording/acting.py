"""Warnings of the controls that acted in a run: with mode, sensor and parameters of then."""

from axisrig.bench.machine.recording.distance_log import DistanceLog
from axisrig.bench.oracles.distance.lists import CHANNEL
from axisrig.bench.rig.distance.loops import unstable
from axisrig.bench.rig.distance.sensors import sensors_of
from axisrig.bench.rig.settings import Settings


def acting_warnings(settings: Settings, log: DistanceLog) -> list[str]:
    """Say which control that acted cannot be stable; each once, in the order in which they acted.

    A dry run moves nothing: it has no loop. There is no data on the loop of a sensor that the rig
    does not have, such as a variable that the program writes.
    """
    found = []
    for name in (*log.axes, CHANNEL):
        sensors = {sensor.source: sensor for sensor in sensors_of(settings, name)}
        for change in log.recorded(name):
            sensor = sensors.get(change.sensor)
            if change.is_on and not change.is_dry_run and sensor is not None:
                control = change.controller.control
                found.append(unstable(settings, name, sensor, change.mode, control))
    return list(dict.fromkeys(text for text in found if text is not None))
