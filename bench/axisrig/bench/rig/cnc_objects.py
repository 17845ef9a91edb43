"""The CNC objects of distance control as a list for the user of plans."""

from textwrap import fill

from axisrig.kernel.distance.objects import channel_objects, objects

GROUP = "0x120300"
"""Index group of the objects of an axis (CNC objects 1147811083)."""
CHANNEL_GROUP = "0x12130<CID>"
"""Of those of a channel (3D objects 1030357643)."""


def objects_table() -> str:
    """Describe every CNC object of distance control: unit, type, access, address, meaning."""
    lines = [
        "A column plc:<axis>.object.<name> of a plan writes an object, in its unit; it acts at the",
        f"next change from INACTIVE or FREEZE to ACTIVE. Address: index group {GROUP}; the offset",
        "begins with the number of the axis (AID); empty where no source gives an address.",
        "",
    ]
    for item in objects().values():
        access = "read write" if item.is_writable else "read"
        address = f"0x<AID>{item.offset}" if item.offset else ""
        words = [item.name, item.type, item.unit, access, address]
        lines.append("  ".join(word for word in words if word))
        lines.append(fill(item.meaning, 78, initial_indent="    ", subsequent_indent="    "))
    lines += [
        "",
        "3D distance control (#DIST CTRL), in the order of its loop; they can only be read.",
        f"Address: index group {CHANNEL_GROUP}; those of an axis have none in any source.",
        "",
    ]
    for number, row in enumerate(channel_objects().values(), 1):
        address = f"0x{row.offset}" if row.offset else ""
        of_axis = "of each axis" if row.of_axis else ""
        words = [f"{number}", row.name, row.type, row.unit, "read", of_axis, address]
        lines.append("  ".join(word for word in words if word))
        lines.append(fill(row.meaning, 78, initial_indent="    ", subsequent_indent="    "))
    return "\n".join(lines)
