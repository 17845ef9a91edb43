"""Both texts of one FMU, the C source and the model description, and the token that binds them."""

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass

from axisrig.fmus.equations.system import read_system
from axisrig.fmus.reading.ir import Ir
from axisrig.fmus.reading.modified import refuse_unknown_modifiers
from axisrig.fmus.reading.target import SLAVES, TARGET, runtime_files
from axisrig.fmus.reading.texts import Texts
from axisrig.fmus.writing.archive import other_files
from axisrig.fmus.writing.description import TOKEN_MARK, describe, head_of, identifier_of
from axisrig.fmus.writing.fixed_parameters import folded_slots, with_notes
from axisrig.fmus.writing.source import write_source
from axisrig.fmus.writing.variables import read_variables, scalars


@dataclass(frozen=True)
class Generated:
    """Texts of one FMU.

    fmi: version of the standard. identifier: modelIdentifier, the name of the library file. token:
    instantiationToken or guid, a hash of the two texts and of the runtime. others: further
    files of the archive by name.
    """

    model: str
    fmi: str
    identifier: str
    token: str
    source: str
    description: str
    others: Mapping[str, bytes]


def generate(ir: Ir, step_s: float, fmi: str = "3.0") -> Generated:
    """Write the texts for a compiled model with an internal step of `step_s` seconds.

    fmi: "3.0" or "2.0". Version 2.0 has no arrays: each element is a variable of its own.
    Raises BuildError for any construct that the runtime does not hold.
    """
    system = read_system(ir)
    folded = folded_slots(ir, system)
    texts = Texts(ir)
    refuse_unknown_modifiers(ir, texts)
    variables = read_variables(ir, system, texts)
    if fmi == "2.0":
        variables = scalars(variables)
    variables = with_notes(variables, folded)
    source = write_source(ir, system, variables, folded, step_s, SLAVES[fmi][0])
    description = describe(ir, texts, system, variables, step_s, fmi)
    digest = hashlib.sha256()
    digest.update(source.encode())
    digest.update(description.encode())
    for name in runtime_files(fmi):
        digest.update((TARGET / name).read_bytes())
    token = digest.hexdigest()[:32]
    return Generated(
        ir.model,
        fmi,
        identifier_of(ir.model),
        token,
        source.replace(TOKEN_MARK, token),
        description.replace(TOKEN_MARK, token),
        other_files(ir.model, texts, variables, head_of(ir, texts), fmi),
    )
