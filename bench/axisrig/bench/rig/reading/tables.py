"""What every table of a rig file has in common, and the tables of its time base."""

from typing import Annotated

from pydantic import AfterValidator, BaseModel, ConfigDict, Field

Name = Annotated[str, Field(pattern=r"^[A-Za-z][A-Za-z0-9_]*$")]


class Table(BaseModel):
    """A table of the rig: unknown keys are refused, values are not converted."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, allow_inf_nan=False)


def _not_one(value: int) -> int:
    if value == 1:
        raise ValueError("a SYNC counter runs from 1 to 2 .. 240; 0 sends SYNC without one")
    return value


class CycleTable(Table):
    """`[cycle]`: the time base of the machine, all in microseconds or cycles."""

    period_us: Annotated[int, Field(ge=250, le=20_000)] = 1000
    cycle_offset_us: Annotated[int, Field(ge=0)] = 600
    exchange_us: Annotated[int, Field(ge=10, le=20_000)] = 20_000
    fine_us: Annotated[int, Field(ge=10, le=20_000)] = 50
    buffer_cycles: Annotated[int, Field(ge=0, le=100)] = 0
    sync_counter: Annotated[int, Field(ge=0, le=240), AfterValidator(_not_one)] = 0
    heartbeat_ms: Annotated[int, Field(ge=0, le=65_535)] = 0
    master_node: Annotated[int, Field(ge=1, le=127)] = 127


class RealtimeTable(Table):
    """`[realtime]`: for runs on a real bus; nothing here acts on simulated ones.

    late_us: from where on a SYNC counts as late. wait_ms: how long a cycle waits for answers of
    the drives that come later than cycle_offset_us; not said = by the interface.
    """

    late_us: Annotated[float, Field(ge=1, le=1e6)] = 100.0
    wait_ms: Annotated[float, Field(ge=0, le=1000)] | None = None


_WORDS = {
    "model_type": "must be a table",
    "dict_type": "must be a table",
    "string_pattern_mismatch": "must be a letter, then letters, digits and _",
    "bool_type": "must be a number, true or false, or a text",
    "string_type": "must be a text",
    "int_type": "must be a whole number",
    "float_type": "must be a number",
    "finite_number": "must be a finite number",
}


def in_words(kind: str, message: str) -> str:
    """Say what is wrong with a value; pydantic's own words where they fit an engineer."""
    return _WORDS.get(kind) or message[:1].lower() + message[1:]
