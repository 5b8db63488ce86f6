"""What all figures share: matplotlib where it is installed, sizes, colours, and names that are only text."""

from __future__ import annotations

import textwrap
from collections.abc import Generator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import numpy as np

from .. import _checks
from .._errors import StiffarmError

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

#: Sizes for a picture that a journal prints as wide as it is made.
SIZES: dict[str, Any] = {
    "font.size": 8,
    "axes.labelsize": 8,
    "axes.titlesize": 8,
    "xtick.labelsize": 8,
    "ytick.labelsize": 8,
    "legend.fontsize": 8,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.linewidth": 0.7,
    "lines.linewidth": 1.1,
    "lines.markersize": 4,
    "hatch.linewidth": 0.5,
    "legend.frameon": False,
    "legend.handlelength": 2.2,
    "figure.dpi": 144,
    "savefig.dpi": 300,
}


def pyplot() -> Any:
    """matplotlib.pyplot.

    Raises:
        StiffarmError: matplotlib is not installed.
    """
    try:
        import matplotlib.pyplot as plt
    except ImportError:
        raise StiffarmError(
            "Figures need matplotlib, which is not installed.", "unsupported", hint="pip install stiffarm[plot]"
        ) from None
    return plt


@contextmanager
def settings() -> Generator[None, None, None]:
    """:data:`SIZES` while a figure is made.

    Not ``rc_context``: where the first figure of a notebook is made within it, it would undo what the notebook's backend
    has just set, and later figures would not be shown.
    """
    parameters = pyplot().rcParams
    before = {key: parameters[key] for key in SIZES}
    try:
        parameters.update(SIZES)
        yield
    finally:
        parameters.update(before)


def check_axes(ax: Any) -> None:
    """Refuses what are no axes."""
    pyplot()
    if not hasattr(ax, "fill_between"):
        raise StiffarmError(f"These must be axes of matplotlib, got {_checks.shown(ax)}.", "wrong-type", {"key": "ax"})


def fix_ticks(ax: Axes) -> None:
    """Sizes of ticks that are made later, when the settings are the caller's again."""
    ax.tick_params(labelsize=SIZES["xtick.labelsize"], width=SIZES["axes.linewidth"])


def dashes(lengths: str, width: float) -> Any:
    """A line style of the page: lengths of dashes and gaps in pixels, solid without."""
    parts = [float(part) / max(width, 0.1) for part in lengths.split()]
    return (0, tuple(parts + parts if len(parts) % 2 else parts)) if parts else "-"


def short(name: object, most: int = 28) -> str:
    """A name on one line; of a long one the beginning and the end, where such names differ."""
    text = " ".join("".join(c if c.isprintable() else " " for c in str(name)).split())
    tail = (most - 1) // 2
    return text if len(text) <= most else f"{text[: most - 1 - tail]}…{text[-tail:]}"


def wrapped(ax: Axes, text: str) -> str:
    """A text in lines as long as axes are wide."""
    letters = _letters(_width(ax) * ax.get_position().width)
    return "\n".join(textwrap.wrap(" ".join(text.split()), letters)) or text


def legend(target: Any, entries: Sequence[tuple[Any, str]], width_in: float, **keys: Any) -> int:
    """A legend of handles and names in as many columns as fit, and in how many rows; names are text even where matplotlib
    would read more."""
    if not entries:
        return 0
    # Names are set afterwards: matplotlib leaves out those that begin with "_".
    letters = max(12, _letters(width_in) - 7)
    names = ["\n".join(textwrap.wrap(short(name, 2 * letters), letters)) for _, name in entries]
    columns = _columns(names, width_in)
    box = target.legend(
        [handle for handle, _ in entries], ["x"] * len(entries), ncols=columns,
        columnspacing=1.1, handletextpad=0.5, borderaxespad=0.2, **keys,
    )  # fmt: skip
    for text, name in zip(box.get_texts(), names, strict=True):
        text.set_parse_math(False)
        text.set_text(name)
    return -(-(len(names) + sum(name.count("\n") for name in names)) // columns)


def legend_above(ax: Axes, entries: Sequence[tuple[Any, str]]) -> None:
    """A legend above given axes, where it hides nothing."""
    above = 1.02 if not ax.get_title(loc="left") else 1.09
    legend(ax, entries, _width(ax) * ax.get_position().width, loc="lower left", bbox_to_anchor=(0.0, above))


def legend_over(figure: Figure, entries: Sequence[tuple[Any, str]]) -> None:
    """A legend over all of a figure, which becomes as much higher."""
    rows = legend(figure, entries, figure.get_figwidth() - 0.1, loc="outside upper left")
    figure.set_figheight(figure.get_figheight() + 0.17 * rows)


def tick_count(ax: Axes) -> int:
    """How many numbers a horizontal axis has room for."""
    return min(6, max(2, int(_width(ax) * ax.get_position().width / 0.4)))


def _letters(width_in: float) -> int:
    """How many letters a width has room for."""
    from matplotlib import rcParams

    return int(72 * width_in / (0.53 * rcParams["font.size"]))


def _columns(names: Sequence[str], width_in: float) -> int:
    """The most columns of a legend that fit, filled one after the other."""
    from matplotlib import rcParams
    from matplotlib.font_manager import FontProperties
    from matplotlib.textpath import text_to_path

    size = rcParams["legend.fontsize"]
    font = FontProperties(size=size)
    size = font.get_size_in_points()
    lines = [max(name.split("\n"), key=len) for name in names]
    wide = [text_to_path.get_text_width_height_descent(line, font, ismath=False)[0] for line in lines]
    for columns in range(min(len(names), 6), 1, -1):
        # As matplotlib fills them: the first ones are the fuller ones.
        parts = np.array_split(wide, columns)
        # Handle, its distance to the text, and the distance to the next column.
        if sum(3.9 * size + float(part.max()) for part in parts) <= 72 * width_in:
            return columns
    return 1


def names_below(ax: Axes, names: Sequence[str]) -> None:
    """Names below the places 0, 1, ...: turned where they are long, and only every k-th where there are many."""
    width = _width(ax) * ax.get_position().width
    step = -(-len(names) // max(2, int(width / 0.15)))
    shown = [short(name, 16) for name in names[::step]]
    look: dict[str, Any] = {}
    if sum(len(name) + 1 for name in shown) > _letters(width):
        many = len(shown) > 8
        look = {"rotation": 90} if many else {"rotation": 35, "ha": "right", "rotation_mode": "anchor"}
    ax.set_xticks(np.arange(0, len(names), step), labels=shown, parse_math=False, **look)


def names_beside(ax: Axes, names: Sequence[str]) -> None:
    """Names beside the places 0, 1, ... of a vertical axis."""
    ax.set_yticks(np.arange(len(names)), labels=[short(name, 16) for name in names], parse_math=False)


def figure_of(ax: Axes) -> Figure:
    """The figure that axes are in; of a figure within a figure, the outer one."""
    figure: Any = ax.figure.figure
    outer: Figure = figure
    return outer


def _width(ax: Axes) -> float:
    """Width of that figure [in]."""
    return float(figure_of(ax).get_figwidth())


def light_grid(ax: Axes, axis: str = "both") -> None:
    """Thin lines behind the data."""
    ax.set_axisbelow(True)
    ax.grid(True, axis=axis, color="#dddddd", linewidth=0.5)  # type: ignore[arg-type]


def plain_log(ax: Axes, axis: str = "y") -> None:
    """A logarithmic axis with plain numbers: 0.1, 1, 10."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    (ax.set_yscale if axis == "y" else ax.set_xscale)("log")
    which = ax.yaxis if axis == "y" else ax.xaxis
    low, high = sorted(ax.get_ylim() if axis == "y" else ax.get_xlim())
    decades = np.log10(high / low) if low > 0 else 9.0
    steps = (1.0, 2.0, 5.0) if decades < 2.2 else (1.0,)
    which.set_major_locator(LogLocator(subs=steps))
    def tick(value: float, _: object) -> str:
        return number(value)

    which.set_major_formatter(FuncFormatter(tick))
    which.set_minor_formatter(NullFormatter())


def number(value: float) -> str:
    """A number of a tick: no trailing zeros, powers of ten from a million on."""
    if value != 0 and (abs(value) >= 1e6 or abs(value) < 1e-4):
        mantissa, exponent = f"{value:.3e}".split("e")
        mantissa = mantissa.rstrip("0").rstrip(".")
        power = f"10$^{{{int(exponent)}}}$"
        return power if mantissa == "1" else f"{mantissa}·{power}"
    return f"{value:.6g}"


def floats(values: Sequence[float | None]) -> np.ndarray:
    """Numbers, NaN where there is none."""
    return np.array([np.nan if value is None else float(value) for value in values])
