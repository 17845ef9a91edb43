"""Positions of the axes at the start: in reach of their encoders, and before their stops."""

from axisrig.bench.rig.reading.file import rig_error
from axisrig.bench.rig.real_axes import outside_axes
from axisrig.bench.rig.settings import Settings
from axisrig.kernel.cosim.plant.axis import PlantAxis
from axisrig.kernel.cosim.plant.outputs import POSITION, STOP_FACE, STOP_FORCE
from axisrig.kernel.cosim.plant.plant import Plant
from axisrig.kernel.errors import UserError

START = ("position_start",)
STOP = (*START, "stop_position", "stop_direction", "stop_speed", "stop_begin", "stop_end")


def check_places(settings: Settings, plant: Plant) -> None:
    """Refuse axes that cannot be meant to start where they are; the plant is at time 0.

    An FMU whose stop is not that of the library may mean to start pressed: it gets a note.
    Raises UserError with file, line and key of the rig, or the place of the last start value of
    the run that has put the axis there.
    """
    outside = outside_axes(settings)
    for name, axis in settings.rig.axis.items():
        if name not in outside:
            _check_encoder(settings, plant, name, axis.plant)
            _check_stop(settings, plant, name, axis.plant)


def _check_encoder(settings: Settings, plant: Plant, name: str, instance: str) -> None:
    limit_mm = settings.rig.drive[settings.rig.axis[name].drive].facts().reach_mm
    position_mm = plant.axes[instance].position_m() * 1e3
    if abs(position_mm) < limit_mm:
        return
    refusal = UserError(
        f"axis {name} starts outside the 32 bits of its encoder",
        value=f"{position_mm:g} mm",
        allowed=f"-{limit_mm:g} .. {limit_mm:g} mm, ends out",
    )
    raise blamed_start(settings, instance, refusal, START)


def _check_stop(settings: Settings, plant: Plant, name: str, instance: str) -> None:
    """Refuse an axis that its stop would throw out in the first moment."""
    axis = plant.axes[instance]
    force_n = axis.motion[STOP_FORCE]
    if not force_n:
        return
    if not _has_our_stop(axis):
        plant.notes[instance].append(f"its stop presses with {force_n:g} N when the run begins")
        return
    position_mm, face_mm = axis.motion[POSITION] * 1e3, axis.motion[STOP_FACE] * 1e3
    direction, bound = (1, "at most") if position_mm > face_mm else (-1, "at least")
    refusal = UserError(
        f"axis {name} is {abs(position_mm - face_mm):g} mm inside its stop when the run begins",
        value=f"{position_mm:g} mm",
        allowed=f"{bound} {face_mm:g} mm, the stop, with stop_direction {direction}",
        hint=f"correct position_start, stop_position or stop_direction of plant {instance};"
        " 1: the stop is met going up, -1: going down",
    )
    raise blamed_start(settings, instance, refusal, STOP)


def _has_our_stop(axis: PlantAxis) -> bool:
    parameters = axis.slave.names("parameter")
    is_ours = any(name.startswith("stop_direction") for name in parameters)
    return is_ours and axis.roles.has("stop_face")


def blamed_start(
    settings: Settings, instance: str, refusal: UserError, names: tuple[str, ...]
) -> UserError:
    """Give a refusal the place of the last start value of the run that has to do with it.

    names: what those begin with; with none of them it is the place of the plant in the rig.
    """
    owner = settings.rig.plant[instance].shares or instance
    for item, located in reversed(settings.start.get(owner, [])):
        if item.name.startswith(names):  # an FMU of two axes puts a number after it
            return located(refusal, item)
    keys = ("plant", owner, "start") if settings.rig.plant[owner].start else ("plant", owner)
    return rig_error(
        settings.files,
        keys,
        refusal.message,
        value=refusal.value,
        allowed=refusal.allowed,
        hint=refusal.hint,
    )
