"""From an ESI file to the EEPROM, by the rules of docs/ethercat.md: written without a look at ours.

An ESI file says no serial number; texts of the EEPROM are numbered as they come: name, group,
order, then for each TxPDO and RxPDO its name and those of its entries, then the modes of the clock.
"""

import struct
from collections.abc import Callable
from xml.etree import ElementTree

SM_TYPES = {"MBoxOut": 1, "MBoxIn": 2, "Outputs": 3, "Inputs": 4}
FMMU_TYPES = {"Outputs": 1, "Inputs": 2, "MBoxState": 3}
DATA_TYPES = {"SINT": 2, "INT": 3, "DINT": 4, "USINT": 5, "UINT": 6, "UDINT": 7}
COE_BITS = ("SdoInfo", "PdoAssign", "PdoConfig", "PdoUpload", "CompleteAccess")


def number(text: str | None) -> int:
    assert text is not None
    return int(text.removeprefix("#x"), 16) if text.startswith("#x") else int(text)


def crc8(data: bytes) -> int:
    crc = 0xFF
    for byte in data:
        for bit in range(7, -1, -1):
            top = crc >> 7 ^ byte >> bit & 1
            crc = (crc << 1 ^ (0x07 if top else 0)) & 0xFF
    return crc


def clock_modes(device: ElementTree.Element, text: Callable[[str | None], int]) -> bytes:
    clock = b""
    for mode in device.findall("Dc/OpMode"):
        cycle = mode.find("CycleTimeSync0")
        factor = 0 if cycle is None else number(cycle.get("Factor"))
        assign = number(mode.findtext("AssignActivate"))
        clock += struct.pack(
            "<IIIhHhBB4x", 0, 0, 0, 0, assign, factor, text(mode.findtext("Name")), 0
        )
    return clock


def eeprom_of(esi: str, serial: int) -> bytes:
    root = ElementTree.fromstring(esi.encode())
    device = root.find("./Descriptions/Devices/Device")
    assert device is not None
    size = number(device.findtext("Eeprom/ByteSize"))
    texts: list[str] = []

    def text(value: str | None) -> int:
        assert value is not None
        if value not in texts:
            texts.append(value)
        return texts.index(value) + 1

    kind = device.find("Type")
    assert kind is not None
    head = bytearray(128)
    configuration = bytes.fromhex(device.findtext("Eeprom/ConfigData") or "")
    head[: len(configuration)] = configuration
    head[14] = crc8(head[:14])
    vendor = number(root.findtext("Vendor/Id"))
    product, revision = number(kind.get("ProductCode")), number(kind.get("RevisionNo"))
    struct.pack_into("<4I", head, 16, vendor, product, revision, serial)
    managers = [
        (
            number(sm.get("StartAddress")),
            number(sm.get("DefaultSize")),
            number(sm.get("ControlByte")),
            0,
            number(sm.get("Enable")),
            SM_TYPES[sm.text or ""],
        )
        for sm in device.findall("Sm")
    ]
    coe, soe = device.find("Mailbox/CoE"), device.find("Mailbox/SoE")
    assert (coe is None) != (soe is None)
    words = (*managers[0][:2], *managers[1][:2], 4 if soe is None else 16)
    struct.pack_into("<5H", head, 48, *words)
    struct.pack_into("<2H", head, 124, size // 128 - 1, 1)

    name = text(device.findtext("Name"))
    group, order = text(device.findtext("GroupType")), text(kind.text)
    details = int(coe is not None)  # SDO at all
    for bit, key in enumerate(COE_BITS, 1):
        details |= (coe is not None and coe.get(key) == "1") << bit
    general = bytearray(32)
    general[0], general[2], general[3], general[5] = group, order, name, details
    channels = 0 if soe is None else number(soe.get("ChannelCount"))
    general[8], general[9] = channels, int(not channels)
    ports = {"Y": 1, "K": 3, " ": 0}
    for place, letter in enumerate(device.get("Physics") or ""):
        general[16 + place // 2] |= ports[letter] << 4 * (place % 2)
    categories = [(30, bytes(general))]
    categories.append((40, bytes(FMMU_TYPES[fmmu.text or ""] for fmmu in device.findall("Fmmu"))))
    categories.append((41, b"".join(struct.pack("<HHBBBB", *manager) for manager in managers)))
    for category, tag in ((50, "TxPdo"), (51, "RxPdo")):
        for pdo in device.findall(tag):
            entries = pdo.findall("Entry")
            manager = number(pdo.get("Sm")) if pdo.get("Sm") else 0xFF
            index = number(pdo.findtext("Index"))
            body = struct.pack(
                "<HBBBBH", index, len(entries), manager, 0, text(pdo.findtext("Name")), 0
            )
            for entry in entries:
                body += struct.pack(
                    "<HBBBBH",
                    number(entry.findtext("Index")),
                    number(entry.findtext("SubIndex")),
                    text(entry.findtext("Name")),
                    DATA_TYPES[entry.findtext("DataType") or ""],
                    number(entry.findtext("BitLen")),
                    0,
                )
            categories.append((category, body))
    categories.append((60, clock_modes(device, text)))
    content = bytes(head)
    strings = bytes((len(texts),)) + b"".join(
        bytes((len(value),)) + value.encode() for value in texts
    )
    for category, body in [(10, strings), *categories]:
        fill = b"\x00" if category == 10 else b"\xff"
        padded = body + fill * (len(body) % 2)
        content += struct.pack("<HH", category, len(padded) // 2) + padded
    return (content + b"\xff\xff").ljust(size, b"\xff")
