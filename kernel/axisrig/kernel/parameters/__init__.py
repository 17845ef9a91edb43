"""Machine data: parameters of axes and channel under the names, types and units of the manuals.

`table.py` reads the tables of everything known, `values.py` holds what one list and the plan set
and resolves the rest, `lists.py` reads and writes lists, `errata.py` contains what scans make of
names, `start_up.py` corrects what the control corrects when it starts.
"""

from axisrig.kernel.parameters.lists import list_text, read_list, read_sections, write_list
from axisrig.kernel.parameters.origin import Origin
from axisrig.kernel.parameters.start_up import start_up
from axisrig.kernel.parameters.table import KINDS, Kind, Parameter, Table, names, table
from axisrig.kernel.parameters.types import INTEGER_RANGES, Value, convert, written
from axisrig.kernel.parameters.units import UNITS, Unit
from axisrig.kernel.parameters.values import ParameterSet, Resolved

__all__ = [
    "INTEGER_RANGES",
    "KINDS",
    "UNITS",
    "Kind",
    "Origin",
    "Parameter",
    "ParameterSet",
    "Resolved",
    "Table",
    "Unit",
    "Value",
    "convert",
    "list_text",
    "names",
    "read_list",
    "read_sections",
    "start_up",
    "table",
    "write_list",
    "written",
]
