"""Figures of results and drawings of cells, with matplotlib (``pip install stiffarm[plot]``).

:func:`figure` draws a figure of a result's page, :func:`cell` the cell in some postures. Numbers, names, colours and the ends
of the axes are those of the page: nothing is calculated here. Nothing is shown or saved either; what comes back is a figure of
matplotlib::

    stiffarm.plot.figure(result, "residuals").savefig("residuals.pdf")
    stiffarm.plot.cell(cell, plan).savefig("cell.png")

``result.plot("residuals")`` is the same as the first line, ``result.figures()`` names them all. A figure is made for a journal's
column: 3.5 in wide, no text below 8 pt; ``width_in=7`` gives two columns. In axes of one's own (``ax=``) the caller's settings
hold. Colours, markers and dashes differ together, so that figures can be read in grey. Names are drawn as they are: no part of
them is taken for mathematics.
"""

from ._drawing import cell
from ._figure import figure

__all__ = ["cell", "figure"]
