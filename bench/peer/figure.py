"""Best index against time as a figure."""

import math

import matplotlib

matplotlib.use("svg")

import matplotlib.pyplot as plt
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter, NullLocator

from .names import PEERS, peer_name

# Okabe and Ito's colours, told apart by colour-blind readers; a dash marks a library's second way.
STYLES = {
    "stiffarm": ("#000000", "-", 2.6),
    "numpy-slsqp": ("#E69F00", "-", 1.6),
    "numpy-slsqp-batched": ("#E69F00", "--", 1.6),
    "pinocchio-slsqp": ("#009E73", "-", 1.6),
    "jax-lbfgsb": ("#56B4E9", "-", 1.6),
    "jax-lbfgsb-smoothed": ("#0072B2", "-", 1.6),
    "jax-slsqp-epigraph": ("#0072B2", "--", 1.6),
    "differential-evolution": ("#D55E00", "-", 1.6),
    "dual-annealing": ("#CC79A7", "-.", 1.6),
}
# The axis of the index ends at this multiple of the best one; random groups are in the thousands.
TOP = 10.0


def curves(record):
    """(key, label, trace, seconds) of everything with a trace."""
    found = [
        ("stiffarm", f"stiffarm {run['version']}", run["trace"], record["seconds"])
        for run in record["stiffarm"]
        if run["trace"]
    ]
    for peer in PEERS:
        found += [
            (peer, peer_name(peer), race["trace"], race["seconds"])
            for race in record["races"]
            if race["peer"] == peer and race["trace"]
        ]
    return found


def draw(record, path):
    """Writes the figure as SVG; False where there is nothing to draw."""
    lines = curves(record)
    if not lines:
        return False
    best = min(trace[-1]["value"] for _, _, trace, _ in lines)
    end = max(seconds for _, _, _, seconds in lines)
    first = min(
        (e["seconds"] for _, _, trace, _ in lines for e in trace if e["value"] < TOP * best),
        default=0.01,
    )
    start = 10.0 ** math.floor(math.log10(min(max(first, 1e-4), end / 10)))
    plt.rcParams.update({"svg.hashsalt": "stiffarm", "font.size": 11, "axes.spines.top": False})
    plt.rcParams.update({"axes.spines.right": False})
    figure, axes = plt.subplots(figsize=(9.6, 5.0), layout="constrained")
    seen = {}
    for key, label, trace, seconds in lines:
        colour, dash, width = STYLES[key]
        x = [max(e["seconds"], start / 10) for e in trace] + [max(seconds, trace[-1]["seconds"])]
        y = [e["value"] for e in trace]
        y.append(y[-1])
        (line,) = axes.step(x, y, where="post", color=colour, linestyle=dash, linewidth=width)
        # Several seeds share one entry of the legend, with the best of them.
        if key not in seen or y[-1] < seen[key][1]:
            seen[key] = (line, y[-1], label)
    axes.set(xscale="log", yscale="log", xlim=(start, end * 1.02), ylim=(0.95 * best, TOP * best))
    axes.set_xlabel("time from the first random group [s]")
    axes.set_ylabel("best novel index, max k(J$_N$) · cond(Ψ)")
    plain = FuncFormatter(lambda value, _: f"{value:g}")
    axes.xaxis.set_major_formatter(plain)
    axes.xaxis.set_minor_formatter(NullFormatter())
    axes.yaxis.set_major_locator(LogLocator(subs=(1.0, 1.5, 2.0, 3.0, 5.0, 7.0)))
    axes.yaxis.set_minor_locator(NullLocator())
    axes.yaxis.set_major_formatter(plain)
    axes.grid(color="0.88", linewidth=0.8)
    axes.set_axisbelow(True)
    ranked = sorted(seen.values(), key=lambda item: item[1], reverse=True)
    figure.legend(
        [line for line, _, _ in ranked],
        [f"{value:.2f}  {label}" for _, value, label in ranked],
        title="best at the end",
        loc="outside right center",
        frameon=False,
        fontsize=10,
        title_fontsize=10,
        alignment="left",
    )
    machine = record["machine"]
    cores = machine["cores_used"]
    axes.set_title(
        f"Novel index of six postures, reference cell; {machine['processor']}, "
        f"{cores} core{'' if cores == 1 else 's'}",
        fontsize=11,
        loc="left",
    )
    figure.savefig(path, metadata={"Date": None, "Title": "Best novel index against time"})
    plt.close(figure)
    return True
