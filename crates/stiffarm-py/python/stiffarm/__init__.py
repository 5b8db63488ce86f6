"""Which postures to measure, what joint stiffness the measurements give, and how far an industrial robot bends at work.

The steps, from a cell to a deflection::

    import stiffarm

    cell = stiffarm.Cell("cell.toml")                  # or stiffarm.Cell.built_in("comau")
    plan = stiffarm.select(cell, 6)                    # which postures to measure
    plan.postures.save("plan.csv")
    found = stiffarm.identify(cell, "readings.csv")    # the stiffness, and how sure it is
    bend = stiffarm.predict(cell, found, "path.csv")   # how far the arm bends at work

Every command of ``stiffarm`` is a function with the same options (:mod:`stiffarm.commands`). Arrays of angles are in
radians unless ``degrees=True``; other numbers have their unit in their name. Every result is what the command prints with
``--json``, to the last bit: ``print(result)`` says it in words, keys are attributes, ``to_dict()``, ``to_frame()``,
``save()`` and ``report()`` hand it on. Whatever is wrong raises :class:`StiffarmError` with a code, a place and a hint.
"""

from . import plot
from ._errors import StiffarmError, StiffarmWarning
from ._record import Record
from ._result import Result
from ._stiffarm import __version__, set_threads
from ._table import Table
from .arrays import certificate, index_names, indices, observation_matrix, simulate_measurements
from .cell import Cell
from .commands import (
    capsules,
    check,
    compensate,
    coverage,
    evaluate,
    export,
    identify,
    init,
    measure,
    pose,
    predict,
    register,
    report,
    robots,
    route,
    schema,
    select,
    simulate,
    study,
    validate,
    zones,
)
# Not in __all__: it would hide the builtin.
from .commands import map as map
from .objective import Objective
from .paths import read_path, write_path
from .postures import Postures
from .robot import Branch, Robot

__all__ = [
    "Branch",
    "Cell",
    "Objective",
    "Postures",
    "Record",
    "Result",
    "Robot",
    "StiffarmError",
    "StiffarmWarning",
    "Table",
    "__version__",
    "capsules",
    "certificate",
    "check",
    "compensate",
    "coverage",
    "evaluate",
    "export",
    "identify",
    "index_names",
    "indices",
    "init",
    "measure",
    "observation_matrix",
    "plot",
    "pose",
    "predict",
    "read_path",
    "register",
    "report",
    "robots",
    "route",
    "schema",
    "select",
    "set_threads",
    "simulate",
    "simulate_measurements",
    "study",
    "validate",
    "write_path",
    "zones",
]
