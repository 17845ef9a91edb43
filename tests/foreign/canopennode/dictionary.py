"""Object dictionary of the foreign slave: OD.h and OD.c as CANopenNode V4 wants them.

A table of its own, written from CiA 301 and 402, not from the tables of our drive.
"""

from pathlib import Path

# index: (name, [(sub, C type, attribute, initial value)]); one sub 0 alone = a plain variable
R, RW, RX, TX = "ODA_SDO_R", "ODA_SDO_RW", "ODA_SDO_RW | ODA_TRPDO", "ODA_SDO_R | ODA_TPDO"
Subs = list[tuple[int, str, str, int]]


def _communication(rpdo: bool, number: int) -> Subs:
    subs = [
        (0, "uint8_t", R, 5 if rpdo else 6),
        (1, "uint32_t", RW, 0x80000000 | (0x200 if rpdo else 0x180) + 0x100 * number),
        (2, "uint8_t", RW, 254),
    ]
    if not rpdo:
        subs.append((3, "uint16_t", RW, 0))
    subs.append((5, "uint16_t", RW, 0))
    if not rpdo:
        subs.append((6, "uint8_t", RW, 0))
    return subs


_MAPPING: Subs = [(0, "uint8_t", RW, 0), *((n, "uint32_t", RW, 0) for n in range(1, 9))]

RECORDS: dict[int, Subs] = {
    0x1000: [(0, "uint32_t", R, 0x00020192)],
    0x1001: [(0, "uint8_t", TX, 0)],
    0x1005: [(0, "uint32_t", RW, 0x80)],
    0x1006: [(0, "uint32_t", RW, 0)],
    0x1007: [(0, "uint32_t", RW, 0)],
    0x1014: [(0, "uint32_t", RW, 0x80)],
    0x1015: [(0, "uint16_t", RW, 0)],
    0x1017: [(0, "uint16_t", RW, 0)],
    0x1018: [(n, "uint8_t" if n == 0 else "uint32_t", R, 4 if n == 0 else 0) for n in range(5)],
    0x1019: [(0, "uint8_t", RW, 0)],
    0x1200: [
        (0, "uint8_t", R, 2),
        (1, "uint32_t", TX, 0x600),
        (2, "uint32_t", TX, 0x580),
    ],
    **{0x1400 + n: _communication(True, n) for n in range(4)},
    **{0x1600 + n: _MAPPING for n in range(4)},
    **{0x1800 + n: _communication(False, n) for n in range(4)},
    **{0x1A00 + n: _MAPPING for n in range(4)},
    0x603F: [(0, "uint16_t", TX, 0)],
    0x6040: [(0, "uint16_t", RX, 0)],
    0x6041: [(0, "uint16_t", TX, 0)],
    0x6060: [(0, "int8_t", RX, 0)],
    0x6061: [(0, "int8_t", TX, 0)],
    0x6064: [(0, "int32_t", TX, 0)],
    0x6065: [(0, "uint32_t", RX, 0xFFFFFFFF)],
    0x6066: [(0, "uint16_t", RX, 0)],
    0x6072: [(0, "uint16_t", RX, 1000)],
    0x607A: [(0, "int32_t", RX, 0)],
    0x608F: [(0, "uint8_t", R, 2), (1, "uint32_t", RW, 1 << 20), (2, "uint32_t", RW, 1)],
    0x6091: [(0, "uint8_t", R, 2), (1, "uint32_t", RW, 1), (2, "uint32_t", RW, 1)],
    0x6092: [(0, "uint8_t", R, 2), (1, "uint32_t", RW, 1 << 20), (2, "uint32_t", RW, 1)],
    0x60B8: [(0, "uint16_t", RX, 0)],
    0x60B9: [(0, "uint16_t", TX, 0)],
    **{0x60BA + n: [(0, "int32_t", TX, 0)] for n in range(4)},
    **{0x60D5 + n: [(0, "uint16_t", TX, 0)] for n in range(4)},
    0x60FD: [(0, "uint32_t", TX, 0)],
    0x6502: [(0, "uint32_t", R, 1 << 7)],
}
ARRAYS = {0x1003: 8, 0x1016: 4}
"""Index: length. Both hold uint32_t."""

_SIZE = {"uint8_t": 1, "int8_t": 1, "uint16_t": 2, "int16_t": 2, "uint32_t": 4, "int32_t": 4}
_COUNTERS = {
    "NMT": 1, "EM": 1, "EM_PROD": 1, "SYNC": 1, "SYNC_PROD": 1, "HB_PROD": 1, "HB_CONS": 1,
    "SDO_SRV": 1, "RPDO": 4, "TPDO": 4,
}  # fmt: skip


def write_dictionary(folder: Path) -> None:
    """Write OD.h and OD.c into a folder."""
    indices = sorted([*RECORDS, *ARRAYS])
    head = ["#ifndef OD_H", "#define OD_H"]
    head += [f"#define OD_CNT_{name} {count}" for name, count in _COUNTERS.items()]
    head += [f"#define OD_CNT_ARR_{index:X} {length}" for index, length in ARRAYS.items()]
    head += ["extern OD_t *OD;"]
    head += [
        f"#define OD_ENTRY_H{index:X} &OD->list[{place}]" for place, index in enumerate(indices)
    ]
    (folder / "OD.h").write_text("\n".join([*head, "#endif", ""]), encoding="ascii")
    body = ["#define OD_DEFINITION", '#include "301/CO_ODinterface.h"', '#include "OD.h"']
    entries = []
    for index in indices:
        body += _array(index, ARRAYS[index]) if index in ARRAYS else _record(index, RECORDS[index])
        count = ARRAYS[index] + 1 if index in ARRAYS else len(RECORDS[index])
        kind = "ODT_ARR" if index in ARRAYS else "ODT_VAR" if count == 1 else "ODT_REC"
        entries.append(f"    {{0x{index:X}, {count}, {kind}, &o{index:X}, NULL}},")
    body += ["static OD_entry_t list[] = {", *entries, "    {0, 0, 0, NULL, NULL}};"]
    body += [f"static OD_t dictionary = {{{len(indices)}, list}};", "OD_t *OD = &dictionary;", ""]
    (folder / "OD.c").write_text("\n".join(body), encoding="ascii")


def _attribute(attribute: str, size: int) -> str:
    return f"{attribute} | ODA_MB" if size > 1 else attribute


def _record(index: int, subs: Subs) -> list[str]:
    lines = [f"{ctype} v{index:X}_{sub} = {value};" for sub, ctype, _, value in subs]
    if len(subs) == 1:
        _, ctype, attribute, _ = subs[0]
        size = _SIZE[ctype]
        return [
            *lines,
            f"static OD_obj_var_t o{index:X} = "
            f"{{&v{index:X}_0, {_attribute(attribute, size)}, {size}}};",
        ]
    parts = ", ".join(
        f"{{&v{index:X}_{sub}, {sub}, {_attribute(attribute, _SIZE[ctype])}, {_SIZE[ctype]}}}"
        for sub, ctype, attribute, _ in subs
    )
    return [*lines, f"static OD_obj_record_t o{index:X}[] = {{{parts}}};"]


def _array(index: int, length: int) -> list[str]:
    first = 0 if index == 0x1003 else length
    access = "ODA_SDO_R" if index == 0x1003 else "ODA_SDO_RW"
    access_0 = "ODA_SDO_RW" if index == 0x1003 else "ODA_SDO_R"
    return [
        f"uint8_t v{index:X}_0 = {first};",
        f"uint32_t v{index:X}[{length}];",
        f"static OD_obj_array_t o{index:X} = "
        f"{{&v{index:X}_0, &v{index:X}[0], {access_0}, {access} | ODA_MB, 4, 4}};",
    ]
