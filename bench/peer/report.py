"""The record as a Markdown page."""

import math
from statistics import median

from .names import PEERS, peer_name
from .verify import best_at, time_to

# Two searches that end in the same minimum differ in the last digits; "reached" allows for that.
REACHED = 1 + 1e-4
# What the project promises: ratio -> target.
TARGETS = {
    "JAX called singly from SciPy": 20.0,
    "JAX, vmap-batched": 4.0,
    "NumPy, SciPy's forward differences": 1000.0,
    "NumPy, batched differences": 1000.0,
}
TIME_TARGET = 50.0
# (library, what, batched) of each of them among the rates.
MEASURES = {
    "JAX called singly from SciPy": ("jax", "value+gradient"),
    "JAX, vmap-batched": ("jax", "values+gradients, batched"),
    "NumPy, SciPy's forward differences": ("numpy", "value+gradient"),
    "NumPy, batched differences": ("numpy", "value+gradient, batched differences"),
}
NAMES = {"numpy": "NumPy", "pinocchio": "Pinocchio", "jax": "JAX"}


def number(value, digits=3):
    """A number with so many significant digits, thousands separated; a dash for none."""
    if value is None:
        return "—"
    if value == 0:
        return "0"
    rounded = float(f"{value:.{digits}g}")
    places = max(0, digits - 1 - math.floor(math.log10(abs(rounded))))
    return f"{rounded:,.{places}f}"


def table(headings, rows, left=1):
    """A Markdown table; the first `left` columns are left-aligned, the others right."""
    lines = ["| " + " | ".join(headings) + " |"]
    lines.append("|" + "|".join(":--" if i < left else "--:" for i in range(len(headings))) + "|")
    lines += ["| " + " | ".join(str(cell) for cell in row) + " |" for row in rows]
    return "\n".join(lines)


def stiffarm_rate(record, what, threads):
    """stiffarm's rate, the mean over the seeds' runs; None where it was not measured."""
    rates = [
        entry["per_second"]
        for run in record["stiffarm"]
        for entry in run["rates"]
        if entry["what"] == what and entry["threads"] == threads
    ]
    return sum(rates) / len(rates) if rates else None


def best_rate(record, library, what, cores):
    """A library's best rate on so many cores, over batch sizes and ways to use them."""
    rates = [
        entry
        for entry in record["rates"]
        if (entry["library"], entry["what"], entry["cores"]) == (library, what, cores)
    ]
    return max(rates, key=lambda entry: entry["per_second"], default=None)


def ratio_rows(record):
    """Rows of the promised ratios of gradient rates."""
    cores = record["machine"]["cores_used"]
    rows = []
    for name, (library, what) in MEASURES.items():
        ratios = []
        for count in sorted({1, cores}):
            own = stiffarm_rate(record, "value+gradient", count)
            peer = best_rate(record, library, what, count)
            ratios.append(own / peer["per_second"] if own and peer else None)
        rows.append((f"gradient rate ÷ {name}", ratios, TARGETS[name]))
    return rows


def verdict(value, target):
    """Whether a target is met, in words."""
    if value is None:
        return "not measured"
    return "met" if value >= target else "**missed**"


def seeds_of(record):
    """(seed, stiffarm's run, races) for every seed with a race."""
    runs = {run["seed"]: run for run in record["stiffarm"]}
    for seed in record["seeds"]:
        races = [r for r in record["races"] if r["seed"] == seed and r.get("best") is not None]
        if races:
            yield seed, runs.get(seed), races


def time_rows(record):
    """Per seed: the best peer, its best, its time, stiffarm's time to that value."""
    rows = []
    for seed, run, races in seeds_of(record):
        best = min(races, key=lambda r: r["best"])
        value = best["best"]
        own = time_to(run["trace"], value * REACHED) if run else None
        own_best = run["trace"][-1]["value"] if run and run["trace"] else None
        rows.append(
            {
                "seed": seed,
                "peer": peer_name(best["peer"]),
                "value": value,
                "peer_seconds": time_to(best["trace"], value * REACHED),
                "seconds": own,
                "own_best": own_best,
                "ratio": record["seconds"] / max(own, 1e-9) if own is not None else None,
                "measured": run is not None,
            }
        )
    return rows


def promises(record):
    """The section with the promised ratios."""
    cores = record["machine"]["cores_used"]
    counts = sorted({1, cores})
    headings = ["stiffarm against"]
    headings += ["one core on each side" if c == 1 else f"{c} cores on each side" for c in counts]
    headings += ["target", "on all cores"]
    rows = [
        [name, *(number(r) for r in ratios), f"≥ {target:g}", verdict(ratios[-1], target)]
        for name, ratios, target in ratio_rows(record)
    ]
    times = time_rows(record)
    ratios = [t["ratio"] for t in times if t["ratio"] is not None]
    middle = median(ratios) if times and len(ratios) == len(times) else None
    what = f"{record['seconds']:g} s ÷ time to the best peer's best"
    if len(times) > 1:
        what += f", median of {len(times)} seeds"
    state = verdict(middle, TIME_TARGET)
    if middle is None and any(t["measured"] for t in times):
        state = "**missed**, not reached"
    rows.append([what, *["" for _ in counts[:-1]], number(middle), f"≥ {TIME_TARGET:g}", state])
    text = ["## What the project promises", "", table(headings, rows), ""]
    for t in times:
        sentence = (
            f"Seed {t['seed']}: the best peer was {t['peer']} with {t['value']:.4f} after "
            f"{number(t['peer_seconds'])} s. "
        )
        if not t["measured"]:
            sentence += "stiffarm was not run."
        elif t["seconds"] is None:
            sentence += f"stiffarm did not reach it; its best was {number(t['own_best'], 5)}."
        else:
            sentence += (
                f"stiffarm had it after {number(t['seconds'])} s "
                f"({number((t['peer_seconds'] or 0) / max(t['seconds'], 1e-9))} times sooner); "
                f"its own best was {t['own_best']:.4f}."
            )
        text += [sentence, ""]
    return text


def rate_section(record):
    """Evaluations per second of everything."""
    cores = record["machine"]["cores_used"]
    counts = sorted({1, cores})
    per_core = ["one core" if c == 1 else f"{c} cores" for c in counts]
    gradients = [
        ["stiffarm", *(number(stiffarm_rate(record, "value+gradient", c)) for c in counts), ""]
    ]
    values = [["stiffarm", *(number(stiffarm_rate(record, "value", c)) for c in counts), ""]]

    def row(label, library, what):
        found = [best_rate(record, library, what, c) for c in counts]
        remarks = []
        if found[-1] and cores > 1 and library == "jax":
            remarks.append(found[-1]["way"])
        if found[-1] and found[-1]["batch"] > 1:
            remarks.insert(0, f"batches of {found[-1]['batch']}")
        return [label, *(number(f["per_second"] if f else None) for f in found), ", ".join(remarks)]

    gradients += [
        row("JAX, vmap-batched", "jax", "values+gradients, batched"),
        row("JAX, one call per gradient", "jax", "value+gradient"),
        row("NumPy, batched differences", "numpy", "value+gradient, batched differences"),
        row("NumPy, SciPy's forward differences", "numpy", "value+gradient"),
        row("Pinocchio, SciPy's forward differences", "pinocchio", "value+gradient"),
    ]
    values += [
        row("JAX, vmap-batched", "jax", "values, batched"),
        row("JAX, one call per value", "jax", "value"),
        row("NumPy, batched", "numpy", "values, batched"),
        row("NumPy", "numpy", "value"),
        row("Pinocchio", "pinocchio", "value"),
    ]
    return [
        "## Evaluations per second",
        "",
        "Value and all 36 derivatives of ln(index):",
        "",
        table(["", *per_core, "how, on all cores"], gradients),
        "",
        "Value alone:",
        "",
        table(["", *per_core, "how, on all cores"], values),
        "",
    ]


def race_section(record, figure):
    """Best index against time."""
    seconds = record["seconds"]
    times = [t for t in (0.1, 1, 10, 100, 1000) if t < seconds]
    text = ["## Best index against time", ""]
    if figure:
        text += [f"![Best novel index against time of each peer]({figure})", ""]
    for seed, run, races in seeds_of(record):
        rows = []
        if run:
            trace = run["trace"]
            rows.append(
                [f"stiffarm {run['version']}"]
                + [number(best_at(trace, t), 4) for t in (*times, seconds)]
                + [number(trace[-1]["seconds"] if trace else None), "", ""]
            )
        for race in sorted(races, key=lambda r: list(PEERS).index(r["peer"])):
            own = time_to(run["trace"], race["best"] * REACHED) if run else None
            name = peer_name(race["peer"]) + (" (interrupted)" if race["interrupted"] else "")
            rows.append(
                [name]
                + [number(best_at(race["trace"], t), 4) for t in (*times, seconds)]
                + [
                    number(time_to(race["trace"], race["best"] * REACHED)),
                    number(own) if own is not None else ("not reached" if run else "—"),
                    f"{race['starts']:,}",
                ]
            )
        headings = ["", *(f"at {t:g} s" for t in (*times, seconds))]
        headings += ["its best after [s]", "stiffarm there after [s]", "starts"]
        if len(record["seeds"]) > 1:
            text += [f"Seed {seed}:", ""]
        text += [table(headings, rows), ""]
    return text


def size_section(record):
    """stiffarm's cost against the number of postures."""
    rows = [
        [
            entry["index"],
            entry["postures"],
            number(entry["value_us"]),
            number(entry["gradient_us"]),
            number(entry["selection_seconds"]),
            f"{entry['evaluations']:,}",
            number(entry["value"], 5),
        ]
        for run in record["stiffarm"][:1]
        for entry in run.get("cost_against_n", [])
    ]
    if not rows:
        return []
    headings = ["index", "postures", "value [µs]", "value + gradient [µs]", "selection [s]"]
    return [
        "## stiffarm's cost against the number of postures",
        "",
        table([*headings, "evaluations", "index reached"], rows),
        "",
    ]


def markdown(record, figure, raw):
    """The whole page."""
    machine, versions = record["machine"], record["versions"]
    cores = machine["cores_used"]
    load = machine["load_at_start"]
    text = [
        f"# Minimising the novel index, {record['started'][:10]}",
        "",
        "Reference cell (`cells/comau-reference.toml`), six postures, joint bounds only. "
        "[bench/README.md](../README.md) says how each number is measured.",
        "",
        table(
            ["", ""],
            [
                ["command", f"`{record['command']}`"],
                ["started", record["started"]],
                ["processor", machine["processor"]],
                ["cores", f"{cores} of {machine['cores_present']}"],
                ["load at the start", number(load)],
                ["system", machine["system"]],
                ["versions", ", ".join(f"{k} {v}" for k, v in versions.items())],
                [
                    "stiffarm",
                    ", ".join(sorted({r["version"] for r in record["stiffarm"]})) or "not run",
                ],
                ["budget per race", f"{record['seconds']:g} s"],
                ["seeds", ", ".join(map(str, record["seeds"]))],
                ["raw numbers", f"[{raw}]({raw})"],
            ],
            left=2,
        ),
        "",
    ]
    if load is not None and load > 0.3 * cores:
        text += [
            "**The machine was busy with other work at the start; the rates are too low.**",
            "",
        ]
    if record["problems"]:
        text += ["**Not everything went well:**", ""]
        text += [f"- {problem}" for problem in record["problems"]] + [""]
    text += promises(record) + rate_section(record) + race_section(record, figure)
    text += size_section(record)
    checks = ", ".join(f"{NAMES[k]} {v:.0e}" for k, v in record["checks"].items())
    text += [
        "## Checks",
        "",
        f"Largest relative difference to the golden numbers before timing: {checks}. "
        "Each peer's best group was recomputed by singular values and lies within the bounds"
        + (", where nothing else is said above." if record["problems"] else "."),
    ]
    return "\n".join(text) + "\n"
