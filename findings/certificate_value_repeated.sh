#!/usr/bin/env bash
# pydcc 0.2.33 gives a number of a calibration certificate once more where the next quantity is in words.
#
# A digital calibration certificate has the error of a scale at 100 mm, a judgement in words (dcc:noQuantity), the error at 200 mm, and a list of names of the points (dcc:charsXMLList). The
# guess: four results, two of them with their text, or two; and the serial number is found by its name, be it the only identification or not (schema DCC 3.3.0, quantityType: a choice
# of noQuantity, charsXMLList and the si types; identificationListType: one identification or more). What comes: 1.2 um twice and -0.8 um twice, each also by its name, and neither
# the judgement nor the names of the points; a certificate that begins with words is refused, as nothing came before. And the serial number is found
# among two identifications, and refused if it is the only one.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --no-deps --disable-pip-version-check pydcc==0.2.33
cd "$work"
cat >try.py <<'PYTHON'
import sys
import unittest.mock

# What checks signatures and the schema, by servers and the OpenSSL of the machine, is left out: nothing here is signed.
for module in ("asn1crypto", "certvalidator", "cryptography", "dcc.dcc_xml_validator", "requests", "signxml", "signxml.xades"):
    sys.modules[module] = unittest.mock.MagicMock()
from dcc import DCC  # noqa: E402


def name(text):
    return f'<dcc:name><dcc:content lang="en">{text}</dcc:content><dcc:content lang="de">{text}</dcc:content></dcc:name>'


def number(value):
    return f"<si:real><si:value>{value}</si:value><si:unit>\\micro\\metre</si:unit></si:real>"


def certificate(quantities, identifications=1):
    data = "".join(f"<dcc:quantity>{name(title)}{content}</dcc:quantity>" for title, content in quantities)
    marks = "".join(f"<dcc:identification><dcc:issuer>manufacturer</dcc:issuer><dcc:value>{value}</dcc:value>{name(title)}</dcc:identification>" for title, value in (("Serial no.", "4711"), ("Model", "LS-200"))[:identifications])
    text = f"""<dcc:digitalCalibrationCertificate xmlns:dcc="https://ptb.de/dcc" xmlns:si="https://ptb.de/si" schemaVersion="3.3.0">
<dcc:administrativeData><dcc:coreData><dcc:uniqueIdentifier>rig-1</dcc:uniqueIdentifier></dcc:coreData>
<dcc:items>{name("Scale")}<dcc:item>{name("Scale")}<dcc:identifications>{marks}</dcc:identifications></dcc:item></dcc:items></dcc:administrativeData>
<dcc:measurementResults><dcc:measurementResult>{name("Length")}<dcc:results><dcc:result>{name("Error")}
<dcc:data><dcc:list>{data}</dcc:list></dcc:data></dcc:result></dcc:results></dcc:measurementResult></dcc:measurementResults></dcc:digitalCalibrationCertificate>"""
    return DCC(byte_array=text.encode())


words = ("Judgement", "<dcc:noQuantity><dcc:content>outside of class 1</dcc:content></dcc:noQuantity>")
points = ("Points", "<dcc:charsXMLList>left right</dcc:charsXMLList>")
for quantities in ([("at 100 mm", number(1.2)), words, ("at 200 mm", number(-0.8)), points], [words, ("at 100 mm", number(1.2))]):
    print("certificate of", ", ".join(title for title, _ in quantities))
    try:
        for title, value in certificate(quantities).get_calibration_results("name", "en"):
            print(f"  {title.strip()}: {value['real']['value']} {value['real']['unit']}")
    except UnboundLocalError as error:
        print(f"  {type(error).__name__}")
for count in (1, 2):
    try:
        found = certificate([words], count).get_item_id_by_name("Serial no.")
    except TypeError as error:
        found = type(error).__name__
    print(f"serial number of an item with {count} identification{'s' * (count - 1)}: {found}")
PYTHON
cat >expected <<'TEXT'
certificate of at 100 mm, Judgement, at 200 mm, Points
  Length Error at 100 mm: 1.2 \micro\metre
  Length Error at 100 mm: 1.2 \micro\metre
  Length Error at 200 mm: -0.8 \micro\metre
  Length Error at 200 mm: -0.8 \micro\metre
certificate of Judgement, at 100 mm
  UnboundLocalError
serial number of an item with 1 identification: TypeError
serial number of an item with 2 identifications: 4711
TEXT
venv/bin/python try.py 2>log >seen || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
