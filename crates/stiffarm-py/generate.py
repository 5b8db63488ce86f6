"""Makes what follows from other things: ``python generate.py`` writes both files, ``--check`` says whether they are current.

- ``python/stiffarm/_typed.py``: the keys of every result as properties, of the JSON Schemas that the command prints
  (``STIFFARM_COMMAND``, else ``stiffarm`` on the path);
- ``docs/python.md``: the API page, of the docstrings.
"""

from __future__ import annotations

import inspect
import json
import keyword
import os
import re
import subprocess
import sys
import textwrap
from pathlib import Path
from typing import Any

HERE = Path(__file__).resolve().parent
TYPED = HERE / "python" / "stiffarm" / "_typed.py"
PAGE = HERE.parents[1] / "docs" / "python.md"

#: Results by class, with the schemas of the commands that print them.
RESULTS = {
    "Checked": ["check"],
    "Chosen": ["select-candidates"],
    "Compensated": ["compensate"],
    "Curve": ["select-curve"],
    "Dropped": ["select-drop"],
    "Evaluated": ["evaluate"],
    "Identified": ["identify", "identify-clamped"],
    "Placement": ["map-place"],
    "Plan": ["select"],
    "Predicted": ["predict"],
    "Registered": ["register"],
    "Simulation": ["simulate", "simulate-elastic"],
    "SpaceFilling": ["select-space-filling"],
    "StiffnessMap": ["map"],
    "Validated": ["validate"],
}

WIDTH = 116

Schema = dict[str, Any]


def schema(name: str) -> Schema:
    """What a command's result holds."""
    program = os.environ.get("STIFFARM_COMMAND", "stiffarm")
    run = subprocess.run([program, "schema", f"result-{name}"], stdout=subprocess.PIPE, check=True, encoding="utf-8")
    found: Schema = json.loads(run.stdout)
    return found


class Types:
    """Classes of the parts of results: one for each definition, under the name of the schemas."""

    def __init__(self, schemas: dict[str, Schema], reserved: set[str]) -> None:
        self.reserved = reserved
        self.names: dict[tuple[str, str], str] = {}
        self.classes: dict[str, Schema] = {}
        for command, whole in schemas.items():
            root = whole["properties"]["result"]["$ref"].rsplit("/", 1)[1]
            for name in sorted(reached(whole, root) - {root}):
                part = whole["$defs"][name]
                if "properties" in part:
                    self._add(command, whole, name, part)

    def _add(self, command: str, whole: Schema, name: str, part: Schema) -> None:
        """Definitions of one name that say the same are one class."""
        text = json.dumps(closed(whole, name, set()), sort_keys=True)
        own = name
        known = {key: value for key, value in self.classes.items() if key == own or key.endswith(f"_{own}")}
        for key, value in known.items():
            if value["text"] == text:
                self.names[command, name] = key
                return
        if known:
            own = f"{''.join(word.capitalize() for word in command.split('-'))}_{name}"
        self.names[command, name] = own
        self.classes[own] = {"text": text, "part": part, "command": command, "whole": whole}

    def text(self) -> list[str]:
        """All classes, those that others use first or not: annotations are texts."""
        out: list[str] = []
        for name in sorted(self.classes):
            one = self.classes[name]
            out += ["", "", f"class {name}(Record):", *quoted(one["part"].get("description", name), 4), ""]
            out += ["    __slots__ = ()"]
            out += self.properties([(one["command"], one["whole"], one["part"])], self.reserved)
        return out

    def properties(self, parts: list[tuple[str, Schema, Schema]], reserved: set[str]) -> list[str]:
        """A property for each key."""
        kinds: dict[str, list[tuple[str, str]]] = {}
        said: dict[str, str] = {}
        for command, whole, part in parts:
            for key, value in part["properties"].items():
                kind = self.kind(command, whole, value, key)
                kinds.setdefault(key, [])
                if kind not in kinds[key]:
                    kinds[key].append(kind)
                said.setdefault(key, value.get("description", key))
        out: list[str] = []
        for key, found in kinds.items():
            if key in reserved or not key.isidentifier() or keyword.iskeyword(key):
                continue
            returned, made = found[0] if len(found) == 1 else ("Any", f'self._value("{key}")')
            out += ["", "    @property", f"    def {key}(self) -> {returned}:"]
            out += [*quoted(said[key], 8), f"        return {made}"]
        return out

    def kind(self, command: str, whole: Schema, value: Schema, key: str) -> tuple[str, str]:
        """Annotation of a key, and the expression that gives its value."""
        plain = {"number": "float", "integer": "int", "string": "str", "boolean": "bool"}
        options: list[Schema] = value.get("anyOf", [value])
        nullable = {"type": "null"} in options
        rest = [one for one in options if one != {"type": "null"}]
        one = rest[0] if len(rest) == 1 else {}
        types = one.get("type")
        if isinstance(types, list):
            nullable = nullable or "null" in types
            types = next(name for name in types if name != "null")
        none = " | None" if nullable else ""
        if "$ref" in one:
            target = one["$ref"].rsplit("/", 1)[1]
            part = whole["$defs"][target]
            if "properties" in part:
                name = self.names[command, target]
                return f"{name}{none}", f'self._{"maybe" if nullable else "one"}("{key}", {name})'
            if all(choice.get("type") == "string" for choice in part.get("oneOf", [part])):
                return f"str{none}", f'self._value("{key}")'
            return "Any", f'self._value("{key}")'
        if types in plain:
            return f"{plain[types]}{none}", f'self._value("{key}")'
        if types == "array":
            items = one.get("items", {})
            if items.get("type") in ("number", "integer") or is_matrix(items):
                return f"NDArray[Any]{none}", f'self._{"maybe_numbers" if nullable else "numbers"}("{key}")'
            target = items.get("$ref", "").rsplit("/", 1)[-1]
            if target and "properties" in whole["$defs"][target] and not nullable:
                name = self.names[command, target]
                return f"list[{name}]", f'self._many("{key}", {name})'
            if items.get("type") == "string":
                return f"list[str]{none}", f'self._value("{key}")'
        return "Any", f'self._value("{key}")'


def is_matrix(items: Schema) -> bool:
    """Whether rows are of one fixed length."""
    inner = items.get("items", {})
    fixed = items.get("minItems") is not None and items.get("minItems") == items.get("maxItems")
    return items.get("type") == "array" and fixed and inner.get("type") in ("number", "integer")


def reached(whole: Schema, name: str) -> set[str]:
    """Definitions that one refers to, and itself."""
    found, left = {name}, [name]
    while left:
        names = set(re.findall(r'"#/\$defs/([^"]+)"', json.dumps(whole["$defs"][left.pop()])))
        left += names - found
        found |= names
    return found


def closed(whole: Schema, name: str, seen: set[str]) -> Any:
    """A definition with all that it refers to."""
    if name in seen:
        return name
    part = whole["$defs"][name]
    names = sorted(set(re.findall(r'"#/\$defs/([^"]+)"', json.dumps(part))))
    return [part, {one: closed(whole, one, seen | {name}) for one in names}]


def sentence(text: str) -> str:
    """A description of a schema as a docstring has it."""
    text = text.replace("\\[", "[").replace("\\]", "]").replace("\\", "")
    text = re.sub(r"(?<!`)`([^`]+)`(?!`)", r"``\1``", text)
    return text.replace('"""', "'''")


def quoted(text: str, indent: int) -> list[str]:
    """A docstring."""
    pad = " " * indent
    blocks = [" ".join(block.split()) for block in sentence(text).strip().split("\n\n")]
    lines: list[str] = []
    for number, block in enumerate(blocks):
        lines += [""] if number else []
        lines += textwrap.wrap(block, WIDTH - indent - 6, break_long_words=False, break_on_hyphens=False)
    lines[0] = f'"""{lines[0]}'
    if len(lines) == 1:
        return [f'{pad}{lines[0]}"""']
    return [*(f"{pad}{line}" if line else "" for line in lines), f'{pad}"""']


def typed() -> str:
    """The text of ``_typed.py``."""
    from stiffarm import _result, results

    schemas = {name: schema(name) for names in RESULTS.values() for name in names}
    parts = {name for name in dir(_result.Record) if not name.startswith("__")}
    whole = {name for name in dir(_result.Result) if not name.startswith("__")}
    types = Types(schemas, parts)
    out = ['"""Keys of results, as the JSON Schemas of the command have them. Generated by ``generate.py``."""']
    out += ["", "from __future__ import annotations", "", "from typing import Any", ""]
    out += ["from numpy.typing import NDArray", "", "from ._result import Record"]
    out += types.text()
    for name, commands in RESULTS.items():
        roots = []
        for command in commands:
            target = schemas[command]["properties"]["result"]["$ref"].rsplit("/", 1)[1]
            roots.append((command, schemas[command], schemas[command]["$defs"][target]))
        written = {key for base in getattr(results, name).__mro__ for key in vars(base) if base.__module__ == results.__name__}
        out += ["", "", f"class {name}Keys(Record):", f'    """Keys of :class:`stiffarm.results.{name}`."""', ""]
        out += ["    __slots__ = ()", *types.properties(roots, whole | written)]
    return "\n".join(out) + "\n"


#: What stands on the page, in this order.
SECTIONS = {
    "Cell and robot": ["Cell", "tool", "rope", "weight", "wrench", "cases", "measured", "Robot", "Branch", "robots"],
    "Postures and tables": ["Postures", "Table"],
    "Plans": [
        "select",
        "space_filling",
        "drop",
        "curve",
        "certificate",
        "check",
        "evaluate",
        "indices",
        "index_names",
        "observation_matrix",
        "Objective",
    ],
    "From readings to stiffness": [
        "register",
        "identify",
        "diagnose",
        "validate",
        "simulate",
        "simulate_measurements",
        "coverage",
    ],
    "The arm at work": ["predict", "compensate", "map", "place"],
    "Results, errors, threads": ["Result", "Record", "StiffarmError", "StiffarmWarning", "set_threads"],
}


#: What would stand at many functions: arguments that `ONCE` explains.
REPEATED = {"cell: The cell.", "progress: Called as `progress(what, done, of)`; `True` shows a bar."}
ONCE = """\
Everywhere `cell` is the cell, and `progress` is called as `progress(what, done, of)`; `True` shows a bar.

[Figures](plots.md) and [campaigns](campaigns.md), grids of such calls, have pages of their own."""
RETURNED = """\
Classes of `stiffarm.results`, all of them a `Result`. `help(stiffarm.results.Plan)`, an editor and `stiffarm schema
result-select` say what each key is."""


def page() -> str:
    """The text of ``docs/python.md``."""
    import stiffarm
    from stiffarm import results

    out = ["# Python", "", "Made of the docstrings by `crates/stiffarm-py/generate.py`.", ""]
    out += [marked(inspect.getdoc(stiffarm) or ""), "", ONCE]
    for title, names in SECTIONS.items():
        out += ["", f"## {title}"]
        for name in names:
            out += described(name, getattr(stiffarm, name), 3)
    out += ["", "## What the functions return", "", RETURNED]
    for name in sorted(results.__all__):
        one = getattr(results, name)
        if isinstance(one, type) and issubclass(one, stiffarm.Result) and one is not stiffarm.Result:
            out += described(name, one, 3)
    known = {name for names in SECTIONS.values() for name in names} | {"__version__"}
    missing = {name for name in stiffarm.__all__ if not inspect.ismodule(getattr(stiffarm, name))} - known
    if missing:
        raise SystemExit(f"no section of the page has {sorted(missing)}")
    return "\n".join(out).rstrip() + "\n"


def described(name: str, one: Any, level: int) -> list[str]:
    """A function or a class with its members."""
    mark = "#" * level
    if not inspect.isclass(one):
        return ["", f"{mark} `{name}`", "", "```python", signature(name, one), "```", "", marked(inspect.getdoc(one) or "")]
    out = ["", f"{mark} `{name}`", "", marked(inspect.getdoc(one) or "")]
    if "__init__" in vars(one) and not issubclass(one, Exception) and inspect.getdoc(one.__init__):
        if not issubclass(one, dict) and name not in ("Record", "Result"):
            out += ["", "```python", signature(name, one), "```", "", marked(inspect.getdoc(one.__init__) or "")]
    keys: list[str] = []
    said: list[str] = []
    for base in one.__mro__:
        if base.__name__.endswith("Keys") or base is one or base.__name__ == "_WithPostures":
            for key, value in vars(base).items():
                if key.startswith("_") or key in keys or not isinstance(value, property):
                    continue
                keys.append(key)
                if base.__name__.endswith("Keys"):
                    continue
                kind = str(inspect.signature(value.fget).return_annotation) if value.fget else ""
                first = (inspect.getdoc(value) or "").split("\n\n")[0]
                said.append(f"- `{key}`: `{kind}`. {flat(first)}")
    out += ["", *said] if said else []
    generated = [f"`{key}`" for key in keys if not any(line.startswith(f"- `{key}`:") for line in said)]
    out += ["", f"Keys: {', '.join(generated)}."] if generated else []
    short: list[str] = []
    long: list[str] = []
    for key, value in vars(one).items():
        function = value.__func__ if isinstance(value, (classmethod, staticmethod)) else value
        if key.startswith("_") or not inspect.isfunction(function):
            continue
        dot = f"{name}.{key}" if isinstance(value, (classmethod, staticmethod)) else f".{key}"
        called, words = signature(dot, function), marked(inspect.getdoc(function) or "")
        if "\n" in called or "\n\n" in words:
            long += ["", f"{mark}# `{dot}`", "", "```python", called, "```", "", words]
        else:
            short.append(f"- `{called}`: {' '.join(words.split())}")
    return [*out, *([""] if short else []), *short, *long]


def signature(name: str, one: Any) -> str:
    """How it is called; types are an editor's to show."""
    found = inspect.signature(one)
    kept = [p for p in found.parameters.values() if p.name not in ("self", "cls")]
    words: list[str] = []
    for parameter in kept:
        if parameter.kind is parameter.KEYWORD_ONLY and "*" not in words:
            words.append("*")
        stars = {parameter.VAR_POSITIONAL: "*", parameter.VAR_KEYWORD: "**"}.get(parameter.kind, "")
        default = parameter.default
        shown = json.dumps(default) if isinstance(default, str) else repr(default)
        words.append(f"{stars}{parameter.name}{'' if default is parameter.empty else f'={shown}'}")
    end = "" if found.return_annotation is found.empty else f" -> {found.return_annotation}"
    text = f"{name}({', '.join(words)}){end}"
    return text if len(text) <= 100 else f"{name}(\n" + "".join(f"    {word},\n" for word in words) + f"){end}"


def flat(text: str) -> str:
    """One line of Markdown."""
    text = re.sub(r":(?:func|class|meth|attr):`~?(?:stiffarm\.)?([^`]+)`", r"`\1`", " ".join(text.split()))
    return text.replace("``", "`")


def marked(text: str) -> str:
    """A docstring as Markdown: its sections as lists."""
    out: list[str] = []
    lines = text.splitlines()
    number = 0
    while number < len(lines):
        line = lines[number]
        head = re.fullmatch(r"(Args|Returns|Raises|Attributes):", line)
        if head:
            title = {"Args": "Arguments", "Attributes": "Attributes"}.get(head[1], head[1])
            block = []
            number += 1
            while number < len(lines) and (not lines[number].strip() or lines[number].startswith("    ")):
                block.append(lines[number][4:])
                number += 1
            items = re.split(r"\n(?=\S)", "\n".join(block).strip()) if head[1] != "Returns" else ["\n".join(block)]
            items = [item for item in items if flat(item) not in REPEATED and not item.startswith("StiffarmError: ")]
            if not items:
                continue
            out += [f"**{title}**", ""]
            for item in items:
                name, colon, said = item.partition(": ")
                is_named = head[1] != "Returns" and bool(colon)
                out.append(f"- `{name}`: {flat(said)}" if is_named else f"- {flat(item)}")
            out.append("")
            continue
        if line.startswith(("    ", ">>> ")):
            code = []
            while number < len(lines) and (lines[number].strip() or lines[number + 1 :][:1] and lines[number + 1].startswith("    ")):
                code.append(lines[number])
                number += 1
            out += ["```python", *textwrap.dedent("\n".join(code)).splitlines(), "```"]
            continue
        out.append(re.sub(r"::$", ":", flat(line)) if line.strip() else "")
        number += 1
    return "\n".join(out).strip()


def main() -> None:
    """Writes both files, or says which are not current."""
    # What is checked is the package that is installed: a clean checkout has no extension module.
    if "--check" not in sys.argv[1:]:
        sys.path.insert(0, str(HERE / "python"))
    made = {TYPED: typed, PAGE: page}
    old = []
    for path, make in made.items():
        text = make()
        known = path.read_text(encoding="utf-8") if path.exists() else ""
        if "--check" in sys.argv[1:]:
            old += [path.name] if text != known else []
        else:
            path.write_text(text, encoding="utf-8", newline="\n")
    if old:
        raise SystemExit(f"not current: {', '.join(old)}; python crates/stiffarm-py/generate.py")


if __name__ == "__main__":
    main()
