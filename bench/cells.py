#!/usr/bin/env python3
"""Which index would one choose blind? Six postures under each index in random cells of the catalogue's robots.

    python3 bench/cells.py --binary target/release/stiffarm                  # 200 cells, about an hour on two cores
    python3 bench/cells.py --binary target/release/stiffarm --cells 6        # a smoke run

A cell is a robot of six joints, a rope with a random anchor and force, a random loading point, three to six measuring
points and eight tasks. Postures are chosen by a prior stiffness that is wrong by a factor of 1/2 to 2 in each joint, and
judged by the true one: by the mean expected deviation (the paper's measure), the worst joint, the error of the
deflection at the tasks, and that of an arm of the mixed elastic model (the index `prediction`). Beside them stand random groups out of the same limits. Each cell is a line of JSON in `--keep`,
and one that is there is not calculated again. Needs nothing but Python 3.11.
"""

import argparse
import concurrent.futures
import json
import math
import random
import re
import statistics
import subprocess
import tempfile
import tomllib
from pathlib import Path

INDICES = ["classical", "condition", "novel", "scaled", "expected-error", "worst-joint", "d", "prediction"]
GROUPS, POSTURES, ROUNDS = 21, 6, 2
MEASURES = {
    "deviation": "mean expected deviation",
    "worst": "worst joint",
    "task": "deflection at the tasks, axes alone",
    "prediction": "deflection, all directions give way",
}
RANDOM = "random group"


def changed(text, key, value):
    """The cell with another value of a key, which stands once at the beginning of a line."""
    text, count = re.subn(rf"(?m)^{key} = .*$", f"{key} = {value}", text)
    assert count == 1, (key, count)
    return text


def cell_of(text, dice):
    """A random cell and the true one: the same but for the stiffness."""
    text = re.sub(r"(?m)^# (prior_nm_per_rad = )", r"\1", text)
    given = tomllib.loads(text)
    reach = given["limits"]["box_max_mm"][0]
    x, _, z = given["tool"]["loading_point_mm"]
    turn, out = dice.uniform(-math.pi, math.pi), dice.uniform(0.4, 1.6) * x
    place = lambda *values: "[" + ", ".join(f"{value:.1f}" for value in values) + "]"
    text = changed(text, "loading_point_mm", place(out * math.cos(turn), out * math.sin(turn), dice.uniform(0.6, 1.5) * z))
    text = changed(text, "magnitude_n", f"{dice.uniform(0.4, 1.0) * given['load']['magnitude_n']:.1f}")
    anchor = dice.uniform(0.4, 1.1) * reach, dice.uniform(-0.6, 0.6) * reach, dice.uniform(0, 0.5) * reach
    text = changed(text, "anchor_mm", place(*anchor))
    radius, height = given["tool"]["measuring_point"][0]["position_mm"][0::2]
    points = ""
    for number in range(dice.randint(3, 6)):
        turn, out = dice.uniform(-math.pi, math.pi), dice.uniform(0.5, 1.5) * radius
        at = place(out * math.cos(turn), out * math.sin(turn), dice.uniform(0.5, 2) * height)
        points += f'[[tool.measuring_point]]\nname = "{number + 1}"\nposition_mm = {at}\n\n'
    begin = text.index("[[tool.measuring_point]]")
    end = text.index("# Known compliance between flange")
    text = text[:begin] + points + text[end:]
    guess = given["stiffness"]["prior_nm_per_rad"]
    true = [k * 2 ** dice.uniform(-1, 1) for k in guess]
    number = lambda values: "[" + ", ".join(f"{value:.6g}" for value in values) + "]"
    return changed(text, "prior_nm_per_rad", number(guess)), number(true), given


def table(path, rows):
    """A table of postures."""
    head = "posture," + ",".join(f"q{j + 1}_deg" for j in range(len(rows[0])))
    lines = (f"{i + 1}," + ",".join(f"{q:.2f}" for q in row) for i, row in enumerate(rows))
    path.write_text("\n".join([head, *lines]) + "\n")


def asked(folder, *words):
    """The result of a command; nothing where no posture or plan keeps the limits."""
    ran = subprocess.run([*words, "--threads", "1", "--json"], cwd=folder, capture_output=True, text=True, check=False)
    said = json.loads(ran.stdout)
    if ran.returncode not in (0, 1) and said["error"]["code"] != "infeasible":
        raise SystemExit(f"{' '.join(words)}: {said['error']}")
    return said.get("result")


def one(binary, robots, seed):
    """A cell: what each plan is worth under the true stiffness; nothing where the cell cannot be."""
    dice = random.Random(seed)
    robot = dice.choice(robots)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        subprocess.run([binary, "init", "--robot", robot, "--output-dir", "."], cwd=folder, capture_output=True, check=False)
        if not (folder / "cell.toml").exists():
            return {"seed": seed, "robot": robot, "refused": "init"}
        text, true, given = cell_of((folder / "cell.toml").read_text(), dice)
        (folder / "cell.toml").write_text(text)
        bounds = given["bounds"]["q_deg"]
        rows = [[dice.uniform(*bound) for bound in bounds] for _ in range(4000)]
        table(folder / "random.csv", rows)
        listed = [binary, "select", "cell.toml", "--candidates", "random.csv", "--index", "d", "--no-certificate"]
        found = asked(folder, *listed)
        left_out = {entry["candidate"] for entry in found["forbidden"]} if found else set()
        allowed = [row for i, row in enumerate(rows) if i not in left_out]
        if found is None or len(allowed) < GROUPS * POSTURES // 2:
            return {"seed": seed, "robot": robot, "refused": "no postures"}
        tasks = ""
        tip = given["tool"]["measuring_point"][0]["position_mm"]
        for number in range(8):
            way = [dice.gauss(0, 1) for _ in range(3)]
            size = given["load"]["magnitude_n"] / math.hypot(*way)
            tasks += f'\n[[task]]\nname = "{number}"\nq_deg = {[round(q, 2) for q in dice.choice(allowed)]}\n'
            tasks += f'force_n = {[round(size * part, 2) for part in way]}\naxes = "base"\ntip_mm = {tip}\n'
        (folder / "true.toml").write_text(changed(text, "prior_nm_per_rad", true) + tasks)
        plans = []
        for index in INDICES:
            words = [binary, "select", "cell.toml", "--index", index, "--rounds", str(ROUNDS), "-n", str(POSTURES)]
            if asked(folder, *words, "--no-certificate", "--output", f"{index}.csv") is None:
                return {"seed": seed, "robot": robot, "refused": index}
            plans.append(f"{index}.csv")
        for group in range(GROUPS):
            table(folder / f"{group}.csv", dice.sample(allowed, POSTURES))
            plans.append(f"{group}.csv")
        judged = asked(folder, binary, "evaluate", "true.toml", *plans)
    values = {}
    for group in judged["groups"]:
        errors = group["expected_deviation"]
        values[group["name"]] = {
            "deviation": None if None in errors else sum(errors) / len(errors),
            "worst": group["indices"]["worst_joint"],
            "task": group["indices"]["task"],
            "prediction": group["indices"]["prediction"],
        }
    return {"seed": seed, "robot": robot, "values": values}


def number(value):
    """Not determined is worse than anything."""
    return math.inf if value is None else value


def of_cell(cell, measure):
    """A measure of each index, and its median over the random groups."""
    values = {index: number(cell["values"][index][measure]) for index in INDICES}
    values[RANDOM] = statistics.median(number(cell["values"][str(group)][measure]) for group in range(GROUPS))
    return values


def quantile(values, share):
    """The value that this share of them is not above."""
    return sorted(values)[min(len(values) - 1, math.ceil(share * len(values)) - 1)]


def ratios(cells, measure):
    """Each index against the best of its cell, over the cells."""
    rows = {name: [] for name in [*INDICES, RANDOM]}
    for cell in cells:
        values = of_cell(cell, measure)
        best = min(values.values())
        for name, value in values.items():
            rows[name].append(value / best)
    return rows


def in_order(rows):
    """The indices, the lowest median first."""
    return sorted(rows, key=lambda name: statistics.median(rows[name]))


def page(cells, refused):
    """What came out, in Markdown: the table of docs/selecting.md, and the paper's order."""
    robots = len({cell["robot"] for cell in cells})
    found = {measure: ratios(cells, measure) for measure in MEASURES}
    short = lambda value: "–" if math.isinf(value) else f"{value:.2f}" if value < 9.95 else f"{value:.0f}"
    lines = [
        f"{len(cells)} cells of {robots} robots, {POSTURES} postures ({refused} drawn cells have no plan and do not count). "
        "How many times as large as the best of the cell: median (95 % of the cells below; worst cell).\n",
        f"| six postures by | {' | '.join(MEASURES.values())} |",
        "|:--|" + "--:|" * len(MEASURES),
    ]
    for name in in_order(found["deviation"]):
        row = [found[measure][name] for measure in MEASURES]
        figures = [[statistics.median(values), quantile(values, 0.95), max(values)] for values in row]
        words = [f"{short(middle)} ({short(most)}; {short(worst)})" for middle, most, worst in figures]
        lines.append(f"| {name if name == RANDOM else f'`{name}`'} | {' | '.join(words)} |")
    lines.append("")
    if not {"novel", "classical"} <= set(INDICES):
        return "\n".join(lines)
    told = [of_cell(cell, "deviation") for cell in cells]
    count = lambda holds: f"{sum(holds(values) for values in told)} of {len(told)}"
    lines += [
        f"- `novel` below `classical`: {count(lambda v: v['novel'] < v['classical'])} cells.",
        f"- `classical` below the median random group: {count(lambda v: v['classical'] < v[RANDOM])} cells.",
        f"- `novel` below the median random group: {count(lambda v: v['novel'] < v[RANDOM])} cells.",
        f"- The paper's order, `novel` below `classical` below random: {count(lambda v: v['novel'] < v['classical'] < v[RANDOM])} cells.",
    ]
    return "\n".join(lines) + "\n"


def figure(cells):
    """For each index: every cell as a dot, the median as a bar."""
    rows = ratios(cells, "deviation")
    names = in_order(rows)
    width, left, right, step, top = 640, 150, 20, 34, 46
    highest = 100.0
    across = lambda value: left + (width - left - right) * math.log(min(value, highest)) / math.log(highest)
    bottom = top + step * len(names)
    style = "text{font:13px sans-serif;fill:#1f2933}.quiet{fill:#4b5665;font-size:12px}line{stroke:#cdd4dc}circle{fill:#0b57d0;fill-opacity:.35}.median{stroke:#8a1f6b;stroke-width:3}"
    out = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {bottom + 48}" width="{width}" height="{bottom + 48}" role="img" '
        f'aria-label="Mean expected deviation under each index against the best of the cell">',
        f"<style>{style}</style>",
        f'<rect width="{width}" height="{bottom + 48}" fill="#fff"/>',
        f'<text x="12" y="22">Mean expected deviation of six postures, {len(cells)} random cells</text>',
    ]
    for value in (1, 2, 5, 10, 20, 50, 100):
        x = across(value)
        label = f"{value}" if value < highest else "≥ 100"
        out.append(f'<line x1="{x:.1f}" y1="{top - 8}" x2="{x:.1f}" y2="{bottom - 6}"/><text class="quiet" x="{x:.1f}" y="{bottom + 12}" text-anchor="middle">{label}</text>')
    out.append(f'<text class="quiet" x="{(left + width - right) / 2:.0f}" y="{bottom + 34}" text-anchor="middle">times the best of the cell; bar: median</text>')
    dice = random.Random(1)
    for row, name in enumerate(names):
        y = top + step * (row + 0.4)
        out.append(f'<text x="{left - 14}" y="{y + 4:.1f}" text-anchor="end">{name}</text>')
        for value in rows[name]:
            out.append(f'<circle cx="{across(value):.1f}" cy="{y + dice.uniform(-9, 9):.1f}" r="2"/>')
        middle = across(statistics.median(rows[name]))
        out.append(f'<line class="median" x1="{middle:.1f}" y1="{y - 13:.1f}" x2="{middle:.1f}" y2="{y + 13:.1f}"/>')
    return "\n".join([*out, "</svg>"]) + "\n"


def main():
    """Calculates what is not kept yet, then prints the page."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--binary", required=True)
    parser.add_argument("--cells", type=int, default=200)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--keep", default="cells.jsonl")
    parser.add_argument("--figure", help="also draw the cells")
    parser.add_argument("--indices", default=",".join(INDICES), help="plans by these alone, for what the others leave open")
    args = parser.parse_args()
    INDICES[:] = args.indices.split(",")
    binary = str(Path(args.binary).resolve())
    listed = json.loads(subprocess.run([binary, "robots", "--json"], capture_output=True, text=True, check=True).stdout)
    robots = sorted(robot["key"] for robot in listed["result"]["robots"] if robot["joint_count"] == 6)
    keep = Path(args.keep)
    done = {}
    if keep.exists():
        done = {cell["seed"]: cell for cell in map(json.loads, keep.read_text().splitlines())}
    good = lambda: sum("values" in cell for cell in done.values())
    seed = 0
    with concurrent.futures.ThreadPoolExecutor(args.workers) as pool, keep.open("a") as file:
        while good() < args.cells:
            seeds = []
            while len(seeds) < min(8 * args.workers, args.cells - good()):
                seed += 1
                if seed not in done:
                    seeds.append(seed)
            for cell in pool.map(lambda own: one(binary, robots, own), seeds):
                done[cell["seed"]] = cell
                file.write(json.dumps(cell) + "\n")
                file.flush()
    cells = [done[own] for own in sorted(done) if "values" in done[own]][: args.cells]
    refused = sum("refused" in cell for own, cell in done.items() if own <= cells[-1]["seed"])
    print(page(cells, refused))
    if args.figure:
        Path(args.figure).write_text(figure(cells), encoding="utf-8")


if __name__ == "__main__":
    main()
