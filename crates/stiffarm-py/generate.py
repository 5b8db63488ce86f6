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
            if items.get("type") in ("number", "integer") or is_matrix(items):
                return f"NDArray[Any]{none}"
            target = items.get("$ref", "").rsplit("/", 1)[-1]
            if target and "properties" in whole["$defs"][target] and not nullable:
                return f"list[{self.names[command, target]}]"
            if items.get("type") == "string":
                return f"list[str]{none}"
        return "Any"


def root(whole: Schema) -> str:
    """Name of the definition of the result itself."""
    return str(whole["properties"]["result"]["$ref"].rsplit("/", 1)[1])


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


def quoted(text: str, indent: int) -> list[str]:
    """A docstring."""
    text = text.replace("\\[", "[").replace("\\]", "]").replace("\\", "").replace('"""', "'''")
    blocks = [" ".join(block.split()) for block in re.sub(r"(?<!`)`([^`]+)`(?!`)", r"``\1``", text).strip().split("\n\n")]
    wrapped = "\n\n".join(textwrap.fill(block, 110 - indent) for block in blocks)
    return textwrap.indent(f'"""{wrapped}"""', " " * indent).splitlines()


def keys() -> str:
    """The text of ``_keys.pyi``."""
    schemas = {name: printed("schema", f"result-{name}") for names in RESULTS.values() for name in names}
    own, base = members("results.py"), members("_result.py")
    base["Record"] |= set(dir(Mapping))
    types = Types(schemas)
    out = ["from typing import Any", "", "from numpy.typing import NDArray", "", "from ._result import Record"]
    out += types.text(base["Record"])
    for name, commands in RESULTS.items():
        parts = [(command, schemas[command], schemas[command]["$defs"][root(schemas[command])]) for command in commands]
        written = base["Record"] | base["Result"] | own[name] | own["_WithPostures"]
        out += types.written(f"{name}Keys", parts, written)
    return "\n".join(out) + "\n"


def functions() -> str:
    """The text of ``commands.pyi``."""
    out = ["import os", "from collections.abc import Callable, Sequence", "from typing import Any", ""]
    out += ["from numpy.typing import ArrayLike", "", "from ._inputs import PosturesLike, Progress, TableLike"]
    out += ["from ._result import Result", f"from .results import {', '.join(RESULTS)}", "from .cell import Cell", ""]
    out += ["def names() -> list[str]: ..."]
    for spec in printed("docs", "commands"):
        name = spec["name"]
        found = [one for one, schemas in RESULTS.items() if any(s == name or s.startswith(f"{name}-") for s in schemas)]
        returned = "dict[str, Any]" if name == "schema" else " | ".join(found) or "Result"
        places = [one for one in spec["arguments"] if one["option"] is None]
        places += [one for one in spec["arguments"] if one["short"]]
        options = [one for one in spec["arguments"] if one not in places]
        words: list[str] = []
        for one in places:
            open_ = bool(words and words[-1].endswith("= ..."))
            words.append(parameter(one, open_ or not one["required"]))
        words += ["*", *[parameter(one, True) for one in options]]
        tables = [one for one in spec["arguments"] if one["kind"] == "input" and one["name"] not in ("cell", "stiffness")]
        words += ["degrees: bool = ..."] * bool(tables)
        words += ["accept: Callable[[Any], Any] | None = ..."] * (name == "select")
        words += ["progress: Progress = ..."]
        out += ["", f"def {name}(", *[f"    {word}," for word in words], f") -> {returned}:"]
        out += [*quoted(f"{spec['about']}.", 4)]
    return "\n".join(out) + "\n"


def parameter(argument: Schema, is_optional: bool) -> str:
    """An argument with its type."""
    name, kind = argument["name"], KINDS[argument["kind"]]
    kind = "Cell | str | os.PathLike[str]" if name == "cell" and not argument["several"] else kind
    if argument["kind"] == "text" and not argument["choices"]:
        kind = "str | os.PathLike[str] | float | Sequence[float]"
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
