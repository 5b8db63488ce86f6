"""Writes the types of what is made when the package runs: ``python generate.py FOLDER``, for a wheel.

- ``_keys.pyi``: the keys of every result, of the JSON Schemas that the command prints;
- ``commands.pyi``: the functions of the commands, of what the command says of its command line.

``STIFFARM_COMMAND`` names the command of the same state, else ``stiffarm`` on the path.
"""

from __future__ import annotations

import ast
import json
import keyword
import os
import re
import subprocess
import sys
import textwrap
from collections.abc import Mapping
from pathlib import Path
from typing import Any

PACKAGE = Path(__file__).resolve().parent / "python" / "stiffarm"

#: Results by class, with the schemas of the commands that print them.
RESULTS = {
    "Checked": ["check"],
    "Chosen": ["select-candidates"],
    "Compensated": ["compensate"],
    "Coverage": ["coverage"],
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
#: Results of commands that answer several questions: the argument that asks for it, and what it is then.
MODES = {
    "Chosen": ("candidates", "TableLike | PosturesLike"),
    "Curve": ("curve", "Literal[True]"),
    "Dropped": ("drop", "int | Literal[True]"),
    "Placement": ("place", "TableLike | PosturesLike"),
    "SpaceFilling": ("space_filling", "Literal[True]"),
}
#: Types of arguments.
KINDS = {
    "flag": "bool",
    "input": "TableLike | PosturesLike",
    "number": "float",
    "numbers": "ArrayLike",
    "path": "str | os.PathLike[str]",
    "text": "str",
    "whole": "int",
}

Schema = dict[str, Any]


def printed(*words: str) -> Any:
    """What the command prints, as JSON."""
    program = os.environ.get("STIFFARM_COMMAND", "stiffarm")
    run = subprocess.run([program, *words], stdout=subprocess.PIPE, check=True, encoding="utf-8")
    return json.loads(run.stdout)


def members(file: str) -> dict[str, set[str]]:
    """Names that each class of a module defines itself."""
    classes = [node for node in ast.parse((PACKAGE / file).read_text(encoding="utf-8")).body if isinstance(node, ast.ClassDef)]
    found: dict[str, set[str]] = {}
    for one in classes:
        found[one.name] = {node.name for node in one.body if isinstance(node, ast.FunctionDef)}
        annotated = [node.target for node in one.body if isinstance(node, ast.AnnAssign)]
        found[one.name] |= {target.id for target in annotated if isinstance(target, ast.Name)}
    return found


class Types:
    """Classes of the parts of results: one for each definition, under the name of the schemas."""

    def __init__(self, schemas: dict[str, Schema]) -> None:
        self.names: dict[tuple[str, str], str] = {}
        self.classes: dict[str, Schema] = {}
        for command, whole in schemas.items():
            for name in sorted(reached(whole, root(whole)) - {root(whole)}):
                if "properties" in whole["$defs"][name]:
                    self._add(command, whole, name)

    def _add(self, command: str, whole: Schema, name: str) -> None:
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
        self.classes[own] = {"text": text, "part": whole["$defs"][name], "command": command, "whole": whole}

    def text(self, reserved: set[str]) -> list[str]:
        """All classes, in the order of their names."""
        out: list[str] = []
        for name, one in sorted(self.classes.items()):
            out += self.written(name, [(one["command"], one["whole"], one["part"])], reserved)
        return out

    def written(self, name: str, parts: list[tuple[str, Schema, Schema]], reserved: set[str]) -> list[str]:
        """A class with a property for each key."""
        kinds: dict[str, list[str]] = {}
        said: dict[str, str] = {}
        for command, whole, part in parts:
            for key, value in part["properties"].items():
                kinds.setdefault(key, []).append(self.kind(command, whole, value))
                said.setdefault(key, value.get("description", key))
        out = ["", f"class {name}(Record):", *quoted(parts[0][2].get("description", name), 4)]
        for key, found in kinds.items():
            if key in reserved or not key.isidentifier() or keyword.iskeyword(key):
                continue
            returned = found[0] if len(set(found)) == 1 else "Any"
            out += ["    @property", f"    def {key}(self) -> {returned}:", *quoted(said[key], 8)]
        return out

    def kind(self, command: str, whole: Schema, value: Schema) -> str:
        """Type of the value of a key."""
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
                return self.names[command, target] + none
            is_word = all(choice.get("type") == "string" for choice in part.get("oneOf", [part]))
            return f"str{none}" if is_word else "Any"
        if types in plain:
            return plain[types] + none
        if types == "array":
            items = one.get("items", {})
            if is_numeric(one):
                return f"NDArray[Any]{none}"
            target = items.get("$ref", "").rsplit("/", 1)[-1]
            if target and "properties" in whole["$defs"][target]:
                return f"list[{self.names[command, target]}]{none}"
            if items.get("type") in ("string", "boolean"):
                return f"list[{plain[items['type']]}]{none}"
        return "Any"


def root(whole: Schema) -> str:
    """Name of the definition of the result itself."""
    return str(whole["properties"]["result"]["$ref"].rsplit("/", 1)[1])


def is_numeric(value: Schema) -> bool:
    """Numbers, some of which may be ``null``, or rows of as many each: an array."""
    types = value.get("type")
    types = set(types if isinstance(types, list) else [types]) - {"null"}
    if types == {"array"}:
        inside = [*value.get("prefixItems", []), *([value["items"]] if "items" in value else [])]
        rows = [one for one in inside if one.get("type") == "array"]
        even = all(one.get("minItems") is not None and one.get("minItems") == one.get("maxItems") for one in rows)
        return bool(inside) and even and all(map(is_numeric, inside))
    return bool(types) and types <= {"number", "integer"}


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


def quoted(text: str, indent: int) -> list[str]:
    """A docstring."""
    text = text.replace("\\[", "[").replace("\\]", "]").replace("\\", "").replace('"""', "'''")
    blocks = [" ".join(block.split()) for block in re.sub(r"(?<!`)`([^`]+)`(?!`)", r"``\1``", text).strip().split("\n\n")]
    wrapped = "\n\n".join(textwrap.fill(block, 110 - indent) for block in blocks)
    return textwrap.indent(f'"""{wrapped}"""', " " * indent).splitlines()


def keys() -> str:
    """The text of ``_keys.pyi``."""
    schemas = {name: printed("schema", f"result-{name}") for names in RESULTS.values() for name in names}
    own, base = members("results.py"), members("_record.py") | members("_result.py")
    base["Record"] |= set(dir(Mapping))
    types = Types(schemas)
    out = ["from typing import Any", "", "from numpy.typing import NDArray", "", "from ._record import Record"]
    out += types.text(base["Record"])
    for name, commands in RESULTS.items():
        parts = [(command, schemas[command], schemas[command]["$defs"][root(schemas[command])]) for command in commands]
        written = base["Record"] | base["Result"] | own[name] | own["_WithPostures"]
        out += types.written(f"{name}Keys", parts, written)
    return "\n".join(out) + "\n"


def functions() -> str:
    """The text of ``commands.pyi``."""
    out = ["import os", "from collections.abc import Callable, Sequence", "from typing import Any, Literal, overload", ""]
    out += ["import numpy as np", "from numpy.typing import ArrayLike, NDArray", "", "from ._inputs import PosturesLike, Progress, TableLike"]
    out += ["from ._result import Result", f"from .results import {', '.join(RESULTS)}", "from .cell import Cell", ""]
    out += ["def names() -> list[str]: ..."]
    for spec in printed("docs", "commands"):
        name = spec["name"]
        found = [one for one, schemas in RESULTS.items() if any(s == name or s.startswith(f"{name}-") for s in schemas)]
        asked = {MODES[one][0]: one for one in found if one in MODES}
        [returned] = [one for one in found if one not in MODES] or ["dict[str, Any]" if name == "schema" else "Result"]
        for mode in [*asked, None]:
            out += ["", *["@overload"] * bool(asked), *signature(spec, asked.get(mode or "", returned), mode, set(asked))]
            out += [*quoted(f"{spec['about']}.", 4)]
    return "\n".join(out) + "\n"


def signature(spec: Schema, returned: str, mode: str | None, modes: set[str]) -> list[str]:
    """A function as it is called in one mode: the argument that asks for it is required, those of others are not given."""

    def typed(argument: Schema, is_optional: bool) -> str:
        name = argument["name"]
        if name == mode:
            return f"{name}: {MODES[returned][1]}"
        if name in modes:
            return f"{name}: {'Literal[False]' if argument['kind'] == 'flag' else 'None'} = ..."
        return parameter(argument, is_optional)

    places = [one for one in spec["arguments"] if one["option"] is None]
    places += [one for one in spec["arguments"] if one["short"]]
    options = [one for one in spec["arguments"] if one not in places]
    words: list[str] = []
    for one in places:
        open_ = bool(words and words[-1].endswith("= ..."))
        words.append(typed(one, open_ or not one["required"]))
    words += ["*", *[typed(one, True) for one in options]]
    tables = [one for one in spec["arguments"] if one["kind"] == "input" and one["name"] not in ("cell", "stiffness")]
    words += ["degrees: bool = ..."] * bool(tables)
    words += ["accept: Callable[[NDArray[np.float64]], bool | np.bool_] | None = ..."] * (spec["name"] == "select")
    words += ["progress: Progress = ..."]
    return [f"def {spec['name']}(", *[f"    {word}," for word in words], f") -> {returned}:"]


def parameter(argument: Schema, is_optional: bool) -> str:
    """An argument with its type."""
    name, kind = argument["name"], KINDS[argument["kind"]]
    kind = "Cell | str | os.PathLike[str]" if name == "cell" else kind
    if argument["kind"] == "text":
        kind = f"Literal[{', '.join(map(repr, argument['choices']))}]" if argument["choices"] else "str | float | Sequence[float]"
    kind += f" | Sequence[{kind}]" if argument["several"] else ""
    kind += " | bool" if argument["bare"] else ""
    none = "" if argument["kind"] == "flag" else " | None"
    return f"{name}: {kind}{none} = ..." if is_optional else f"{name}: {kind}"


def main() -> None:
    """Writes both files into the folder that the command line names."""
    folder = Path(sys.argv[1])
    for name, make in (("_keys.pyi", keys), ("commands.pyi", functions)):
        (folder / name).write_text(make(), encoding="utf-8", newline="\n")


if __name__ == "__main__":
    main()
