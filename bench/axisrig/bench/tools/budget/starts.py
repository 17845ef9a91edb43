"""Start values of the plants as they act in a row: the rig's, then those of the row."""

from axisrig.bench.plan.assignment import Assignment, parse_assignment
from axisrig.bench.rig.settings import Settings


def start_number(settings: Settings, instance: str, key: str, default: float) -> float:
    """Return a start value of a plant in its SI unit; default: where nobody gives one."""
    found = start_value(settings, instance, key)
    return default if found is None else found.si()


def start_value(settings: Settings, instance: str, key: str) -> Assignment | None:
    """Return the start value of a plant that counts: the last one of the row, else the rig's."""
    table = settings.rig.plant[instance]
    of_rig = [
        parse_assignment(f"plant:{instance}.{name}={value}") for name, value in table.start.items()
    ]
    of_row = [item for item, _ in settings.start.get(instance, [])]
    fitting = [item for item in (*of_rig, *of_row) if item.name == key]
    return fitting[-1] if fitting else None
