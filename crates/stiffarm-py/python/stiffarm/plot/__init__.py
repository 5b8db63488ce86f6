"""Figures of results, with matplotlib (``pip install stiffarm[plot]``).

Each function draws one result and returns what it drew into; none shows or saves anything. ``found.plot()`` is the same as
``stiffarm.plot.stiffness(found)``, for the first function that a result has here::

    axes = stiffarm.plot.stiffness(found)
    axes.figure.savefig("stiffness.pdf")

Without ``ax`` it makes a figure of its own for a journal's column: 3.5 in wide, no text below 8 pt; ``width_in=7`` gives
two columns. In given axes the caller's own settings hold. Colours are those of Okabe and Ito; markers and line styles
differ as well, so that figures can be read in grey. Names are drawn as they are: no part of them is taken for mathematics.

==========================  ========================================  ==================================================
function                    of                                        shows
==========================  ========================================  ==================================================
:func:`simulation`          :func:`stiffarm.simulate`                 deviation of k against noise, the paper's Fig. 8
:func:`expected`            :func:`stiffarm.evaluate`, plans          relative standard error of k by joint
:func:`validation`          :func:`stiffarm.validate`                 deviations by measuring point, the paper's Fig. 10
:func:`scene`               cell and postures                         the cell in three dimensions, Figs. 5 to 7
:func:`residuals`           :func:`stiffarm.identify`                 what the fit leaves, against the expected noise
:func:`stiffness`           :func:`stiffarm.identify`                 k with intervals and prior
:func:`deflection`          :func:`stiffarm.predict`, ``compensate``  deflection along a path with its band
:func:`number_of_postures`  :func:`stiffarm.select`, ``curve=True``   value by number of postures with its bound
:func:`stiffness_map`       :func:`stiffarm.map`                      a slice of a map
==========================  ========================================  ==================================================
"""

from __future__ import annotations

from ._estimates import expected, residuals, simulation, stiffness, validation
from ._scene import scene
from ._work import deflection, number_of_postures, stiffness_map

__all__ = [
    "deflection",
    "expected",
    "number_of_postures",
    "residuals",
    "scene",
    "simulation",
    "stiffness",
    "stiffness_map",
    "validation",
]
