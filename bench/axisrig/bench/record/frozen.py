"""The form of every class of a recording."""

from pydantic import ConfigDict


class Frozen:
    """Refuses keys that it does not know; numbers that are none are written as words."""

    __pydantic_config__ = ConfigDict(extra="forbid", ser_json_inf_nan="strings")
