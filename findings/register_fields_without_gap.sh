#!/usr/bin/env bash
# peakrdl-ethercat-xml 0.1.0 leaves out the unused bits between two fields of a register, so that all behind them comes from other bits.
#
# The process data of an EtherCAT slave are its registers in their order, described in SystemRDL: of the first register bit 0 enables, bits 8 to 15 are
# a mode and 16 to 31 a target; a position of 32 bits follows. The tool writes the PDO for the slave's description (ETG.2000), and its page says that
# a place is the sum of the lengths before, and that gaps between fields are filled. The guess: mode at bit 8, target at 16, position at 32.
# What comes: mode at 1, target at 9; the seven bits are filled behind them, at the end of the register, so that the position is right again. A register
# with two fields that touch each other is right as well. Nothing is printed.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check \
    peakrdl-ethercat-xml==0.1.0 peakrdl-cli==1.5.0 systemrdl-compiler==1.33.0 lxml==6.1.3
cd "$work"
cat >drive.rdl <<'RDL'
addrmap drive {
    reg {
        regwidth = 32;
        field {sw = rw; hw = r;} enable[0:0] = 0;
        field {sw = rw; hw = r;} mode[15:8] = 0;
        field {sw = rw; hw = r;} target[31:16] = 0;
    } control @ 0x0;
    reg {
        regwidth = 32;
        field {sw = rw; hw = r;} value[31:0] = 0;
    } position @ 0x4;
    reg {
        regwidth = 32;
        field {sw = rw; hw = r;} low[15:0] = 0;
        field {sw = rw; hw = r;} high[31:16] = 0;
    } limit @ 0x8;
};
RDL
cat >try.py <<'PYTHON'
from lxml import etree
from systemrdl import RDLCompiler
from systemrdl.node import FieldNode

compiler = RDLCompiler()
compiler.compile_file("drive.rdl")
place = {}
for field in compiler.elaborate().top.descendants(unroll=True):
    if isinstance(field, FieldNode):
        place[field.inst_name] = field.parent.absolute_address * 8 + field.lsb
bit = 0
for entry in etree.parse("out/drive.xml").iter("Entry"):
    name, length = entry.findtext("Name"), int(entry.findtext("BitLen"))
    wanted = f", in the register map {place[name.split('__')[-1]]}" if name.split("__")[-1] in place else ""
    print(f"{name}: {length} bits at bit {bit}{wanted}")
    bit += length
PYTHON
cat >expected <<'TEXT'
control__enable: 1 bits at bit 0, in the register map 0
control__mode: 8 bits at bit 1, in the register map 8
control__target: 16 bits at bit 9, in the register map 16
Reserved_00: 7 bits at bit 25
value: 32 bits at bit 32, in the register map 32
limit__low: 16 bits at bit 64, in the register map 64
limit__high: 16 bits at bit 80, in the register map 80
TEXT
venv/bin/peakrdl ethercat-xml drive.rdl -o out 2>log || { cat log; exit 2; }
cat log
venv/bin/python try.py >seen 2>log || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
