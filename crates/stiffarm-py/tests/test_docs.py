"""Docstrings: everything public has one with all its arguments. ``--doctest-modules`` runs their examples."""

from __future__ import annotations

import inspect

import stiffarm


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
