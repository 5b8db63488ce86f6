"""Which postures to measure, what joint stiffness the measurements give, and how far an industrial robot bends at work.

The steps, from a cell to a deflection::

    import stiffarm

    cell = stiffarm.Cell("cell.toml")                  # or stiffarm.Cell.built_in("comau")
    plan = stiffarm.select(cell, 6)                    # which postures to measure
    plan.postures.save("plan.csv")
    found = stiffarm.identify(cell, "readings.csv")    # the stiffness, and how sure it is
    bend = stiffarm.predict(cell, found, "path.csv")   # how far the arm bends at work

Arrays of angles are in radians unless ``degrees=True``; other numbers have their unit in their name. Every result is
what the command ``stiffarm`` prints with ``--json``, to the last bit: keys as attributes, ``to_dict()``,
``to_frame()``, ``save()``; ``call`` and ``options`` say how it was made. Whatever is wrong raises
:class:`StiffarmError` with a code, a place and a hint.
"""

from . import plot
from ._errors import StiffarmError, StiffarmWarning
from ._result import Record, Result
from ._stiffarm import __version__, set_threads
from ._table import Table
from .cell import Cell, cases, measured, rope, tool, weight, wrench
from .measure import (
    coverage,
    diagnose,
    identify,
    register,
    simulate,
    simulate_measurements,
    validate,
)
from .objective import Objective
from .plan import (
    certificate,
    check,
    curve,
    drop,
    evaluate,
    index_names,
    indices,
    observation_matrix,
    select,
    space_filling,
)
from .postures import Postures
from .robot import Branch, Robot, robots
from .work import compensate, map, place, predict

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
    "cases",
    "certificate",
    "check",
    "compensate",
    "coverage",
    "curve",
    "diagnose",
    "drop",
    "evaluate",
    "identify",
    "index_names",
    "indices",
    "map",
    "measured",
    "observation_matrix",
    "place",
    "plot",
    "predict",
    "register",
    "robots",
    "rope",
    "select",
    "set_threads",
    "simulate",
    "simulate_measurements",
    "space_filling",
    "tool",
    "validate",
    "weight",
    "wrench",
]
