"""Tables in notebooks."""

from __future__ import annotations

import html
from collections.abc import Mapping
from typing import Any

import numpy as np

#: Rows that a notebook shows.
SHOWN = 20


def table(shown: Mapping[str, Any], row_count: int) -> str:
    """A table of HTML with the first rows of columns; everything in it is text."""
    head = "".join(f"<th>{html.escape(name)}</th>" for name in shown)
    columns = [column[:SHOWN] for column in shown.values()]
    body = "".join(
        "<tr>" + "".join(f"<td>{html.escape(_text(value))}</td>" for value in row) + "</tr>"
        for row in zip(*columns, strict=True)
    )
    more = row_count - SHOWN
    rest = f"<p>and {more} further rows</p>" if more > 0 else ""
    return f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>{rest}"


def _text(value: Any) -> str:
    if value is None:
        return ""
    if isinstance(value, (float, np.floating)):
        return "" if np.isnan(value) else f"{value:.6g}"
    return str(value)
