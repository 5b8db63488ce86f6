"""What all figures share: matplotlib where it is installed, sizes, colours, and names that are only text."""

from __future__ import annotations

from collections.abc import Generator, Mapping, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from .. import _checks
from .._errors import StiffarmError

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_T = TypeVar("_T")

#: The colours of Okabe and Ito without yellow, which is too faint on white.
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000")
MARKERS = ("o", "s", "^", "D", "v", "P", "X")
DASHES: tuple[Any, ...] = ("-", (0, (5, 2)), (0, (1, 1.2)), (0, (5, 1.5, 1, 1.5)), (0, (3, 1)), (0, (8, 2)), (0, (2, 2)))
GREY = "#666666"

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
def settings(own: bool) -> Generator[None, None, None]:
    """:data:`SIZES` for a figure of one's own, else the caller's settings.

    Not ``rc_context``: where the first figure of a notebook is made within it, it would undo what the notebook's backend
    has just set, and later figures would not be shown.
    """
    parameters = pyplot().rcParams
    before = {key: parameters[key] for key in SIZES} if own else {}
    try:
        parameters.update(SIZES if own else {})
        yield
    finally:
        parameters.update(before)


@contextmanager
def axes(
    ax: Axes | None, width_in: float, height_in: float, layout: str = "constrained"
) -> Generator[Axes, None, None]:
    """The given axes as they are, or new ones in a figure of this size."""
    plt = pyplot()
    if ax is not None:
        if not hasattr(ax, "fill_between"):
            raise StiffarmError(f"These must be axes of matplotlib, got {_checks.shown(ax)}.", "wrong-type", {"key": "ax"})
        yield ax
        return
    with settings(True):
        figure = plt.figure(figsize=(width_in, height_in), layout=layout)
        made = figure.add_subplot()
        fix_ticks(made)
        yield made


def fix_ticks(ax: Axes) -> None:
    """Sizes of ticks that are made later, when the settings are the caller's again."""
    ax.tick_params(labelsize=SIZES["xtick.labelsize"], width=SIZES["axes.linewidth"])


def colour(i: int) -> str:
    """Colour of the i-th series."""
    return COLOURS[i % len(COLOURS)]


def marker(i: int) -> str:
    """Marker of the i-th series; where a colour comes again, it has another marker."""
    return MARKERS[(i + i // len(COLOURS)) % len(MARKERS)]


def dashes(i: int) -> Any:
    """Line style of the i-th series."""
    return DASHES[(i + i // len(COLOURS)) % len(DASHES)]


def short(name: object, most: int = 28) -> str:
    """A name on one line; of a long one the beginning and the end, where such names differ."""
    text = " ".join("".join(c if c.isprintable() else " " for c in str(name)).split())
    tail = (most - 1) // 2
    return text if len(text) <= most else f"{text[: most - 1 - tail]}…{text[-tail:]}"


def legend(target: Any, entries: Sequence[tuple[Any, str]], width_in: float, **keys: Any) -> None:
    """A legend of handles and names in as many columns as fit; names are text even where matplotlib would read more."""
    if not entries:
        return
    # Names are set afterwards: matplotlib leaves out those that begin with "_".
    names = [short(name, 40) for _, name in entries]
    box = target.legend(
        [handle for handle, _ in entries], ["x"] * len(entries), ncols=_columns(names, width_in),
        columnspacing=1.1, handletextpad=0.5, borderaxespad=0.2, **keys,
    )  # fmt: skip
    for text, name in zip(box.get_texts(), names, strict=True):
        text.set_parse_math(False)
        text.set_text(name)


def legend_above(ax: Axes, entries: Sequence[tuple[Any, str]], *, own: bool) -> None:
    """A legend above the axes, where it hides nothing; of a figure of one's own over its whole width."""
    if own:
        legend(ax.figure, entries, _width(ax) - 0.1, loc="outside upper left")
        return
    width = _width(ax) * ax.get_position().width
    legend(ax, entries, width, loc="lower left", bbox_to_anchor=(0.0, 1.0))


def _columns(names: Sequence[str], width_in: float) -> int:
    """The most columns of a legend that fit, filled one after the other."""
    from matplotlib import rcParams
    from matplotlib.font_manager import FontProperties
    from matplotlib.textpath import text_to_path

    size = rcParams["legend.fontsize"]
    font = FontProperties(size=size)
    size = font.get_size_in_points()
    wide = [text_to_path.get_text_width_height_descent(name, font, ismath=False)[0] for name in names]
    for columns in range(min(len(names), 6), 1, -1):
        # As matplotlib fills them: the first ones are the fuller ones.
        parts = np.array_split(wide, columns)
        # Handle, its distance to the text, and the distance to the next column.
        if sum(3.9 * size + float(part.max()) for part in parts) <= 72 * width_in:
            return columns
    return 1


def names_below(ax: Axes, names: Sequence[str]) -> None:
    """Names below the places 0, 1, ...; of joints with numbers the numbers, and what they are as the axis' label.

    Names are turned where they are long, and only every k-th is written where there are many.
    """
    from matplotlib import rcParams

    if all(name.startswith("joint ") and len(name) > 6 for name in names):
        ax.set_xlabel("joint")
        names = [name.removeprefix("joint ") for name in names]
    width = _width(ax) * ax.get_position().width
    step = -(-len(names) // max(2, int(width / 0.15)))
    shown = [short(name, 16) for name in names[::step]]
    letter = 0.53 * rcParams["font.size"] / 72
    turned = letter * sum(len(name) + 1 for name in shown) > width
    look: dict[str, Any] = {}
    if turned:
        many = len(shown) > 8
        look = {"rotation": 90} if many else {"rotation": 35, "ha": "right", "rotation_mode": "anchor"}
    ax.set_xticks(np.arange(0, len(names), step), labels=shown, parse_math=False, **look)
    ax.set_xlim(-0.6, len(names) - 0.4)


def _width(ax: Axes) -> float:
    """Width of the figure that axes are in [in]."""
    # Of a figure within a figure, the outer one.
    figure: Any = ax.figure.figure
    return float(figure.get_figwidth())


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


def check(value: object, kind: type | tuple[type, ...], what: str) -> None:
    """Refuses what is no such result."""
    if not isinstance(value, kind):
        raise StiffarmError(f"This figure is drawn of {what}.", "wrong-type")


def by_name(value: _T | Mapping[str, _T], kind: type | tuple[type, ...], what: str) -> dict[str, _T]:
    """One result, or several by name, as several by name.

    Raises:
        StiffarmError: Something else, or none.
    """
    given: dict[str, Any] = {"": value} if isinstance(value, kind) else dict(value) if isinstance(value, Mapping) else {}
    if not given or not all(isinstance(one, kind) for one in given.values()):
        raise StiffarmError(f"This figure is drawn of {what}, or of several by name.", "wrong-type")
    return {str(name): one for name, one in given.items()}


def floats(values: Sequence[float | None]) -> np.ndarray:
    """Numbers, NaN where there is none."""
    return np.array([np.nan if value is None else float(value) for value in values])
