"""Warnings of the controls that acted in a run: with mode, sensor and parameters of then."""

from axisrig.bench.judge.distance.findings import ON, control_of, mode_of
from axisrig.bench.machine.machine import Machine
from axisrig.bench.rig.distance.check import sensors_of, unstable


def acting_warnings(machine: Machine) -> list[str]:
    """Say which control that acted cannot be stable; each once, in the order in which they acted.

    A dry run moves nothing: it has no loop. Nothing is known of the loop of a sensor that the rig
    does not have, such as a variable that the program writes.
    """
    found = []
    for name in machine.channel.distance.axes:
        sensors = {sensor.source: sensor for sensor in sensors_of(machine.settings, name)}
        for change in machine.distance_log.of(name):
            sensor = sensors.get(change.sensor)
            if change.state in ON and not change.is_dry_run and sensor is not None:
                control = control_of(change.settings)
                found.append(unstable(machine.settings, name, sensor, mode_of(change), control))
    return list(dict.fromkeys(text for text in found if text is not None))
