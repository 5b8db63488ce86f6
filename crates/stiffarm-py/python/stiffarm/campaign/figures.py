"""Figures of a summary, by matplotlib: each headline figure by each axis, and what failed."""

from __future__ import annotations

import inspect
import math
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .errors import load
from .spread import statistics_of
from .values import show

if TYPE_CHECKING:
    from .summary import Summary

_LINE, _BAND, _BAR = "#1f4e79", "#9dbcd8", "#b5532a"
#: Size of a panel [inch].
_WIDE, _HIGH = 4.2, 3.2
#: Panels beside each other, and most values of an axis with a box of their own.
_COLUMNS, _MOST = 3, 60
_STYLE = {
    "font.size": 9, "axes.spines.top": False, "axes.spines.right": False, "axes.grid": True,
    "grid.color": "#e4e4e4", "axes.axisbelow": True, "svg.hashsalt": "stiffarm",
    "svg.fonttype": "none",
}  # fmt: skip


def draw(summary: Summary, folder: Path) -> list[Path]:
    """Draws all figures of a summary as PNG and SVG.

    Numbers along an axis become a line of medians with a band from the 5 % to the 95 % quantile;
    names become boxes from quartile to quartile with whiskers from the 5 % to the 95 % quantile.

    Raises:
        CampaignError: ``missing-package`` without matplotlib.
    """
    matplotlib = load("matplotlib", "Drawing figures")
    figure_module = load("matplotlib.figure", "Drawing figures")
    load("matplotlib.backends.backend_agg", "Drawing figures")
    folder.mkdir(parents=True, exist_ok=True)
    files: list[Path] = []
    with matplotlib.rc_context(_STYLE):
        for name in summary.figures[: summary.headline]:
            axes = [axis for axis in summary.axes if len(summary.group(axis, name)) > 1]
            if axes:
                files += _save(_panels(figure_module, summary, name, axes), folder / name)
        if summary.failures:
            files += _save(_failures(figure_module, summary), folder / "failures")
    return files


def _save(figure: Any, stem: Path) -> list[Path]:
    files = [stem.with_name(f"{stem.name}{ending}") for ending in (".png", ".svg")]
    figure.savefig(files[0], dpi=150)
    # Without a date, equal results give equal files.
    figure.savefig(files[1], metadata={"Date": None})
    return files


def _panels(module: Any, summary: Summary, name: str, axes: Sequence[str]) -> Any:
    columns = min(_COLUMNS, len(axes))
    lines = math.ceil(len(axes) / columns)
    groups = [summary.group(axis, name) for axis in axes]
    # Lying boxes: room for names, and a line for each value.
    tallest = max(len(group) if not _numeric(group) else 0 for group in groups)
    height = max(_HIGH, 0.22 * min(tallest, _MOST) + 1.0)
    wide = _WIDE * columns if columns > 1 else 6.4
    figure = module.Figure(figsize=(wide, height * lines + 0.5), layout="constrained")
    figure.suptitle(f"{summary.name}: {_words(name)}", fontsize=10)
    values = [value for group in groups for part in group.values() for value in part]
    logarithmic = bool(values) and min(values) > 0 and max(values) / min(values) > 30
    for place, (axis, group) in enumerate(zip(axes, groups)):
        panel = figure.add_subplot(lines, columns, place + 1)
        if _numeric(group):
            _band(panel, group)
            panel.set_xlabel(_words(axis))
            panel.set_ylabel(_words(name))
            if logarithmic:
                panel.set_yscale("log")
        else:
            _boxes(panel, group)
            panel.set_xlabel(_words(name))
            panel.set_ylabel(_words(axis))
            if logarithmic:
                panel.set_xscale("log")
    return figure


def _numeric(group: dict[Any, list[float]]) -> bool:
    return all(type(key) in (int, float) for key in group)


def _band(panel: Any, group: dict[Any, list[float]]) -> None:
    keys = sorted(key for key, values in group.items() if values)
    found = [statistics_of(group[key]) for key in keys]
    low, high = [f["p05"] for f in found], [f["p95"] for f in found]
    panel.fill_between(keys, low, high, color=_BAND, alpha=0.5, linewidth=0, label="5 % to 95 %")
    median = [f["median"] for f in found]
    panel.plot(keys, median, color=_LINE, marker="o", markersize=3.5, label="median")
    if len(keys) <= 8:
        panel.set_xticks(keys)
    elif all(type(key) is int for key in keys):
        panel.xaxis.get_major_locator().set_params(integer=True)
    panel.legend(
        frameon=False, fontsize=8, ncols=2, loc="lower right", bbox_to_anchor=(1.0, 1.0), borderpad=0
    )


def _boxes(panel: Any, group: dict[Any, list[float]]) -> None:
    keys = list(group)[:_MOST]
    boxes = []
    for key in keys:
        found = statistics_of(group[key])
        if not found["values"]:
            nan = float("nan")
            found = dict.fromkeys(found, nan)
        boxes.append(
            {
                "label": show(key) if not isinstance(key, tuple) else ", ".join(map(show, key)),
                "whislo": found["p05"],
                "q1": found["p25"],
                "med": found["median"],
                "q3": found["p75"],
                "whishi": found["p95"],
                "fliers": [],
            }
        )
    # The name of this argument changed with matplotlib 3.10.
    turnable = "orientation" in inspect.signature(panel.bxp).parameters
    lying: dict[str, Any] = {"orientation": "horizontal"} if turnable else {"vert": False}
    panel.bxp(
        boxes,
        **lying,
        showfliers=False,
        widths=0.6,
        patch_artist=True,
        boxprops={"facecolor": _BAND, "edgecolor": _LINE, "linewidth": 0.8},
        medianprops={"color": _LINE, "linewidth": 1.6},
        whiskerprops={"color": _LINE, "linewidth": 0.8},
        capprops={"color": _LINE, "linewidth": 0.8},
    )
    # The first value on top, as in the declaration.
    panel.invert_yaxis()
    panel.grid(axis="y", visible=False)


def _failures(module: Any, summary: Summary) -> Any:
    codes = [str(failure["error_code"]) for failure in summary.failures]
    counts = [int(failure["count"]) for failure in summary.failures]
    figure = module.Figure(figsize=(6.4, 0.35 * len(codes) + 1.4), layout="constrained")
    panel = figure.add_subplot()
    panel.barh(codes, counts, color=_BAR, height=0.6)
    panel.bar_label(panel.containers[0], padding=3)
    panel.invert_yaxis()
    panel.grid(axis="y", visible=False)
    panel.margins(x=0.12)
    panel.xaxis.get_major_locator().set_params(integer=True)
    panel.set_xlabel(f"items of {summary.done} done")
    panel.set_title(f"{summary.name}: what failed", fontsize=10)
    return figure


def _words(name: str) -> str:
    """A column's name as a label: ``anchor_mm`` → ``anchor [mm]``."""
    for ending, unit in _UNITS.items():
        if name.endswith(ending):
            return f"{name.removesuffix(ending).replace('_', ' ')} [{unit}]"
    return name.replace("_", " ")


_UNITS = {"_nm_per_rad": "N·m/rad", "_mm": "mm", "_deg": "°", "_n": "N", "_m": "m", "_s": "s"}
