"""Docstrings: their examples run, and everything public has one with all its arguments."""

from __future__ import annotations

import doctest
import importlib
import inspect
import pkgutil

import pytest

import stiffarm

OPTIONAL = {"stiffarm.campaign", "stiffarm.plot"}
MODULES = [one.name for one in pkgutil.iter_modules(stiffarm.__path__, "stiffarm.") if one.name not in OPTIONAL]


@pytest.mark.parametrize("name", MODULES)
def test_examples(name: str) -> None:
    module = importlib.import_module(name)
    found = doctest.testmod(module, optionflags=doctest.NORMALIZE_WHITESPACE | doctest.ELLIPSIS)
    assert found.failed == 0


def test_the_main_functions_have_examples() -> None:
    for name in ("indices", "observation_matrix", "Cell", "Postures"):
        assert ">>> " in (inspect.getdoc(getattr(stiffarm, name)) or ""), name


def test_everything_public_is_documented() -> None:
    for name in stiffarm.__all__:
        one = getattr(stiffarm, name)
        if not inspect.isroutine(one) and not inspect.isclass(one):
            continue
        text = inspect.getdoc(one)
        assert text, name
        if inspect.isfunction(one) and "Args:" in text:
            for parameter in inspect.signature(one).parameters.values():
                if parameter.kind is not parameter.VAR_KEYWORD:
                    assert f"{parameter.name}: " in text or f"``{parameter.name}``" in text, f"{name}: {parameter.name}"
        if inspect.isclass(one):
            for key, member in vars(one).items():
                if not key.startswith("_") and (callable(member) or isinstance(member, (property, classmethod))):
                    assert inspect.getdoc(member), f"{name}.{key}"
