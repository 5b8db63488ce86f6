"""A constraint of one's own on the postures that are chosen."""

import numpy as np
import pytest

import stiffarm


def away(q: np.ndarray) -> bool:
    """The wrist turned away from a cabinet, which no limit of a cell can say."""
    return float(np.sin(q[3] + q[5])) > 0.25


def test_every_posture_of_the_plan_is_accepted_as_it_is_written() -> None:
    cell = stiffarm.Cell.built_in("comau")
    asked = []

    def accept(q: np.ndarray) -> bool:
        asked.append(q.shape)
        return away(q)

    own = stiffarm.select(cell, postures=6, rounds=2, no_certificate=True, accept=accept)
    free = stiffarm.select(cell, postures=6, rounds=2, no_certificate=True)
    assert all(away(q) for q in own.postures.angles)
    assert not all(away(q) for q in free.postures.angles)
    assert own.value > free.value
    assert asked and set(asked) == {(6,)}
    again = stiffarm.select(cell, postures=6, rounds=2, no_certificate=True, accept=away)
    assert again.to_json() == own.to_json()


def test_what_the_constraint_raises_is_raised_and_ends_the_search() -> None:
    cell = stiffarm.Cell.built_in("comau")

    def accept(q: np.ndarray) -> bool:
        raise LookupError("the planner does not answer")

    with pytest.raises(LookupError, match="does not answer"):
        stiffarm.select(cell, postures=4, accept=accept)


def test_a_constraint_that_accepts_nothing_is_named() -> None:
    cell = stiffarm.Cell.built_in("comau")
    with pytest.raises(stiffarm.StiffarmError, match="None of") as error:
        stiffarm.select(cell, postures=4, accept=lambda q: False)
    assert error.value.place["key"] == "accept"
    with pytest.raises(stiffarm.StiffarmError, match="From an initial group"):
        stiffarm.select(cell, from_="builtin:comau-group1", accept=away)
