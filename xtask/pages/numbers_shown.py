"""Numbers on a page against the results that it was made from: `data-value` is a number of one of them, and the text shows
it times `data-factor`."""

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

COLLECT = """() => [...document.querySelectorAll('[data-value]')].map(e => {
    const copy = e.cloneNode(true);
    for (const s of copy.querySelectorAll('sup')) s.textContent = `^{${s.textContent}}`;
    return {value: e.dataset.value, factor: e.dataset.factor ?? '1', text: copy.textContent};
})"""


def check(page, results, least):
    """Compares them all; the text says how many there were."""
    shown = page.evaluate(COLLECT)
    if len(shown) < least:
        raise Finding(f"{len(shown)} numbers with data-value, fewer than {least}")
    there = {number for result in results for number in numbers(result)}
    problems = [why for s in shown if (why := problem(s, there))]
    if problems:
        raise Finding(f"{len(problems)} of {len(shown)}: " + "; ".join(problems[:4]))
    return f"{len(shown)} numbers"


def problem(shown, there):
    """Why a shown number is none of those that are there; None where it is one."""
    text = shown["text"].strip()
    if shown["value"] == "null":
        return None if text in NOTHING or not re.search(r"\d", text) else f"shows {text!r}, null in the result"
    try:
        value, factor = float(shown["value"]), float(shown["factor"])
    except (TypeError, ValueError):
        return f"data-value {shown['value']!r}, data-factor {shown['factor']!r}"
    if value not in there:
        return f"data-value {shown['value']} is in no result"
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


def numbers(value):
    """All numbers of a result."""
    if isinstance(value, dict):
        value = list(value.values())
    if isinstance(value, list):
        for one in value:
            yield from numbers(one)
    elif isinstance(value, (int, float)) and not isinstance(value, bool):
        yield float(value)
