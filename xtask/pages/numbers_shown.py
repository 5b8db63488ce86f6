"""Numbers on a page against the result that it was made from: `data-path` is a JSON Pointer into the result,
`data-value` the number there, and the text shows that number times `data-factor`."""

import math
import re

from finding import Finding

MINUS = "\u2212"
SPACES = re.compile("[\u2009\u202f\u00a0\u200a\u2007 '](?=\\d)")
RAISED = str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹⁻⁺", "0123456789-+")
NUMBER = re.compile(
    r"(?P<mantissa>-?\d+(?:\.\d+)?)(?:e(?P<exponent>[-+]?\d+)|\s*[×·]\s*10(?:\^\{(?P<sup>[^}]*)\}|(?P<raised>[⁻⁺]?[⁰¹²³⁴-⁹]+)))?"
)
NOTHING = ("", "–", "—", "-", MINUS, "null", "n/a")

COLLECT = """() => [...document.querySelectorAll('[data-path]')].map(e => {
    const copy = e.cloneNode(true);
    for (const s of copy.querySelectorAll('sup')) s.textContent = `^{${s.textContent}}`;
    return {path: e.dataset.path, value: e.dataset.value ?? null, factor: e.dataset.factor ?? '1',
            text: copy.textContent, result: Number(e.closest('[data-result]')?.dataset.result ?? 0)};
})"""


def check(page, results, least):
    """Compares them all; the text says how many there were."""
    shown = page.evaluate(COLLECT)
    if len(shown) < least:
        raise Finding(f"{len(shown)} numbers with data-path, fewer than {least}")
    problems = [f"{s['path']}: {why}" for s in shown if (why := problem(s, results))]
    if problems:
        raise Finding(f"{len(problems)} of {len(shown)}: " + "; ".join(problems[:4]))
    without = [i for i in range(len(results)) if not any(s["result"] == i for s in shown)]
    if without:
        raise Finding(f"no number of result {without[0]}")
    return f"{len(shown)} numbers"


def problem(shown, results):
    """Why a shown number is not the one of the result; None where it is."""
    if not 0 <= shown["result"] < len(results):
        return f"there is no result {shown['result']}"
    try:
        wanted = pointed(results[shown["result"]], shown["path"])
    except (KeyError, IndexError, ValueError, TypeError):
        return "points at nothing in the result"
    text = shown["text"].strip()
    if wanted is None:
        if shown["value"] != "null":
            return f"data-value {shown['value']}, null in the result"
        return None if text in NOTHING or not re.search(r"\d", text) else f"shows {text!r}, null in the result"
    if isinstance(wanted, bool) or not isinstance(wanted, (int, float)):
        return f"{wanted!r} in the result is no number"
    try:
        value, factor = float(shown["value"]), float(shown["factor"])
    except (TypeError, ValueError):
        return f"data-value {shown['value']!r}, data-factor {shown['factor']!r}"
    if value != float(wanted):
        return f"data-value {shown['value']}, {wanted!r} in the result"
    read = number(text)
    if read is None:
        return f"shows {text!r}, which is no number"
    seen, half = read
    if not abs(seen - value * factor) <= half * (1 + 1e-6) + 4 * math.ulp(seen):
        return f"shows {text!r}, and the result says {value * factor!r}"
    return None


def number(text):
    """The number that a text begins with, and half a unit of its last digit; None where there is none."""
    plain = text.strip().replace(MINUS, "-").lstrip("±+").strip()
    found = NUMBER.match(SPACES.sub("", plain))
    if not found:
        return None
    mantissa = found["mantissa"]
    power = found["exponent"] or found["sup"] or (found["raised"] or "").translate(RAISED) or "0"
    scale = 10.0 ** int(power.replace(MINUS, "-"))
    decimals = len(mantissa.partition(".")[2])
    return float(mantissa) * scale, 0.5 * 10.0**-decimals * scale


def pointed(result, path):
    """What a JSON Pointer points at."""
    if not path.startswith("/"):
        raise ValueError(path)
    for word in path[1:].split("/"):
        word = word.replace("~1", "/").replace("~0", "~")
        result = result[int(word)] if isinstance(result, list) else result[word]
    return result
