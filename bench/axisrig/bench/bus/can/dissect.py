"""CANopen frames taken apart: which service, of which node, with what in it.

`dissect` looks at one frame alone, as a sniffer does. Source: CiA 301 (services and their frames),
CiA 305 (LSS); `identifiers.csv` is the pre-defined connection set.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field

from axisrig.bench.bus.can.frame import Frame
from axisrig.kernel.profiles.canopen import nmt
from axisrig.kernel.profiles.canopen.identifiers import service_of

UPLOAD_REQUEST, DOWNLOAD_REQUEST, DOWNLOAD_SEGMENT, UPLOAD_SEGMENT, ABORT = 2, 1, 0, 3, 4
BLOCK_UPLOAD, BLOCK_DOWNLOAD = 5, 6  # of a client; of a server the other way round
BLOCK_SENDER = 6  # of the side that has the data: client in a download, server in an upload
BLOCK_BEGIN, BLOCK_END, BLOCK_TAKEN, BLOCK_START = 0, 1, 2, 3  # lowest bits of block frames
ABORT_COMMAND = 0x80  # the only first byte of an abort: its other bits are reserved, 0
UNKNOWN = 7
# (client or server, command specifier) -> words
_SDO_COMMANDS = {
    ("request", DOWNLOAD_SEGMENT): "download segment",
    ("request", DOWNLOAD_REQUEST): "download",
    ("request", UPLOAD_REQUEST): "upload",
    ("request", UPLOAD_SEGMENT): "upload segment",
    ("request", BLOCK_UPLOAD): "block upload",
    ("request", BLOCK_DOWNLOAD): "block download",
    ("answer", 0): "upload segment",
    ("answer", 1): "download segment",
    ("answer", 2): "upload",
    ("answer", 3): "download",
    ("answer", 5): "block download",
    ("answer", 6): "block upload",
}
_INITIATE = {"request": (1, 2), "answer": (2, 3)}
NMT_COMMANDS = {
    nmt.START: "start", nmt.STOP: "stop", nmt.ENTER_PRE_OPERATIONAL: "enter pre-operational",
    nmt.RESET_NODE: "reset node", nmt.RESET_COMMUNICATION: "reset communication",
}  # fmt: skip
STATES = {
    nmt.BOOT_UP: "boot-up", nmt.STOPPED: "stopped", nmt.OPERATIONAL: "operational",
    nmt.PRE_OPERATIONAL: "pre-operational",
}  # fmt: skip


@dataclass(frozen=True)
class Dissected:
    """A frame in the terms of CANopen.

    service: of `identifiers.csv`, "error frame", or "unknown". node: id, None where it has none.
    fields: what it carries, e.g. command, index, sub, abort_code, code, state; numbers as sent.
    """

    service: str
    node: int | None = None
    fields: Mapping[str, int | bytes] = field(default_factory=dict)


def dissect(frame: Frame, *, is_error: bool = False) -> Dissected:
    """Take a frame apart; one too short for its service gives the fields that are there."""
    if is_error:
        return Dissected("error frame")
    service = None if frame.is_extended_id else service_of(frame.arbitration_id)
    if service is None:
        return Dissected("unknown", None, {"data": frame.data})
    node = None if service.node_base is None else frame.arbitration_id - service.node_base
    if frame.is_remote_frame:
        return Dissected(service.name, node, {"remote": 1})
    return Dissected(service.name, node, _fields(service.name, frame.data))


def _fields(service: str, data: bytes) -> dict[str, int | bytes]:
    fields: dict[str, int | bytes] = {"data": data} if data else {}
    if service == "NMT" and len(data) >= 2:
        fields = {"command": data[0], "target": data[1]}
    elif service == "SYNC" and data:
        fields = {"counter": data[0]}
    elif service == "EMCY" and len(data) >= 3:
        code = int.from_bytes(data[:2], "little")
        fields = {"code": code, "register": data[2], "vendor": data[3:]}
    elif service == "heartbeat" and data:
        fields = {"state": data[0] & 0x7F, "toggle": data[0] >> 7}
    elif service.startswith("SDO ") and data:
        fields = _sdo(service.removeprefix("SDO "), data)
    elif service.startswith("LSS ") and data:
        fields = {"command": data[0], "data": data[1:]}
    return fields


def _sdo(side: str, data: bytes) -> dict[str, int | bytes]:
    """Split an SDO frame into fields. One frame alone does not show if it is a block segment."""
    specifier = data[0] >> 5
    is_known = (side, specifier) in _SDO_COMMANDS or data[0] == ABORT_COMMAND
    if not is_known:
        return {"specifier": UNKNOWN, "data": data, "is_last": 0}
    fields: dict[str, int | bytes] = {"specifier": specifier}
    if specifier in (BLOCK_UPLOAD, BLOCK_DOWNLOAD):
        return fields | _block(side, specifier, data)
    if specifier == ABORT or specifier in _INITIATE[side]:
        fields |= _object(data)
    else:
        fields["toggle"] = data[0] >> 4 & 1
    if specifier == ABORT:
        fields["abort_code"] = int.from_bytes(data[4:8], "little")
    elif (side, specifier) in (("request", DOWNLOAD_REQUEST), ("answer", 2)):
        if data[0] & 2:  # expedited
            unused = data[0] >> 2 & 3 if data[0] & 1 else 0
            fields["value"] = data[4 : 8 - unused]
        elif data[0] & 1:
            fields["size"] = int.from_bytes(data[4:8], "little")
    elif (side, specifier) in (("request", 0), ("answer", 0)):
        fields["data"] = data[1 : 8 - (data[0] >> 1 & 7)]
        fields["is_last"] = data[0] & 1
    return fields


def _object(data: bytes) -> dict[str, int | bytes]:
    return {"index": int.from_bytes(data[1:3], "little"), "sub": data[3] if len(data) > 3 else 0}


def _block(side: str, specifier: int, data: bytes) -> dict[str, int | bytes]:
    """Split a frame of a block transfer that is no segment: begin, block taken, end.

    Source: CiA 301, SDO block download and upload. The side that has the data says their size and
    the end with its CRC, the other one the size of blocks and what it has taken.
    """
    is_sender = specifier == BLOCK_SENDER
    step = data[0] & (1 if is_sender else 3)
    if step == BLOCK_BEGIN:
        fields = _object(data)
        if not is_sender:
            fields["block_size"] = data[4] if len(data) > 4 else 0
        elif data[0] & 2:
            fields["size"] = int.from_bytes(data[4:8], "little")
        return fields
    if is_sender:
        crc = int.from_bytes(data[1:3], "little")
        return {"step": BLOCK_END, "unused": data[0] >> 2 & 7, "crc": crc}
    if step == BLOCK_TAKEN and len(data) > 2:
        return {"step": step, "taken": data[1], "block_size": data[2]}
    return {"step": step}


def sdo_words(side: str, specifier: int) -> str:
    """Say what an SDO frame is; side: "request" or "answer"."""
    return "abort" if specifier == ABORT else _SDO_COMMANDS.get((side, specifier), "unknown")
