"""Indices and their gradients for optimisers of one's own; what they are is compared in the library's tests."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.optimize

import stiffarm

INDICES = list(stiffarm.index_names())


@pytest.fixture(scope="module")
def cell() -> stiffarm.Cell:
    """Bounds only: no floor, no column, no rope that is too short."""
    return stiffarm.Cell.built_in("comau-reference")


@pytest.fixture(scope="module")
def full() -> stiffarm.Cell:
    """A cell with tasks and a prior."""
    return stiffarm.Cell.built_in("comau")


def drawn(cell: stiffarm.Cell, count: int, seed: int) -> np.ndarray:
    """Angles within the bounds, well inside."""
    low, high = cell.bounds.T
    return low + (high - low) * np.random.default_rng(seed).uniform(0.1, 0.9, (count, cell.joint_count))


@pytest.mark.parametrize("index", INDICES)
def test_log_and_value(full: stiffarm.Cell, index: str) -> None:
    """The logarithm, the value and the indices of `indices` are of one number."""
    objective = stiffarm.Objective(full, index, postures=4)
    q = drawn(full, 4, 11)
    value, gradient = objective.value_and_gradient(q)
    assert gradient.shape == q.shape == objective.shape
    log, log_gradient = objective.log_and_gradient(q)
    assert value == objective(q) == pytest.approx(stiffarm.indices(full, q, [index])[index], rel=1e-9)
    sign = 1 if np.isclose(np.exp(log), value, rtol=1e-12) else -1
    assert np.exp(sign * log) == pytest.approx(value, rel=1e-12)
    assert np.allclose(gradient, sign * value * log_gradient, rtol=1e-12, atol=0)
    flat, flat_gradient = objective.log_and_gradient(q.ravel())
    assert flat == log and np.array_equal(flat_gradient, log_gradient.ravel())
    assert np.array_equal(objective.gradient(q), gradient)


def test_smoothed(full: stiffarm.Cell) -> None:
    """Off by at most ln(n)/sharpness, and differentiable where the maximum is not."""
    objective = stiffarm.Objective(full, "worst_joint", postures=4)
    q = drawn(full, 4, 3)
    exact, _ = objective.log_and_gradient(q)
    for sharpness in (10.0, 100.0, 1000.0):
        smooth, gradient = objective.smoothed(q, sharpness)
        assert abs(smooth - exact) <= np.log(6) / sharpness + 1e-12
        step = 1e-5 * np.eye(q.size)[7].reshape(q.shape)
        difference = (objective.smoothed(q + step, sharpness)[0] - objective.smoothed(q - step, sharpness)[0]) / 2e-5
        assert gradient[1, 1] == pytest.approx(difference, rel=1e-4, abs=1e-7)


def test_beside_given_postures(cell: stiffarm.Cell) -> None:
    """What the index is of both together."""
    group = stiffarm.Postures(drawn(cell, 4, 1))
    more = drawn(cell, 2, 2)
    objective = stiffarm.Objective(cell, "expected_error", postures=2, given=group)
    together = stiffarm.indices(cell, np.vstack([group.angles, more]), ["expected_error"])
    assert objective(more) == pytest.approx(together["expected_error"], rel=1e-12)


def test_many_groups_are_those_of_evaluate(full: stiffarm.Cell) -> None:
    # `evaluate` reads angles as a posture file has them: in degrees.
    degrees = [np.degrees(drawn(full, 5, seed)).round(2) for seed in range(40)]
    groups = np.stack([stiffarm.Postures(one, degrees=True).angles for one in degrees])
    many = stiffarm.indices(full, groups, INDICES)
    evaluated = stiffarm.evaluate(full, {str(i): group for i, group in enumerate(groups)}).to_dict()["groups"]
    for i, group in enumerate(evaluated):
        values = group.get("evaluation", group)["indices"]
        for name in INDICES:
            expected = np.nan if values[name] is None else values[name]
            assert many[name][i] == pytest.approx(expected, rel=1e-9, nan_ok=True), (i, name)
    one = stiffarm.indices(full, groups[3], INDICES)
    assert all(one[name] == many[name][3] for name in INDICES)
    assert stiffarm.indices(full, degrees, ["d"], degrees=True)["d"] == pytest.approx(many["d"], rel=1e-9)
    assert set(stiffarm.indices(full, groups[0])) == set(INDICES) - {"prediction"}


def test_observation_matrix(cell: stiffarm.Cell) -> None:
    """Ψ k⁻¹ are the displacements: the expected error follows from it alone."""
    q = drawn(cell, 6, 5)
    psi = stiffarm.observation_matrix(cell, q)
    assert psi.shape == (3 * len(cell.measuring_points) * 6, 6)
    assert stiffarm.observation_matrix(cell, q, rotation_length=0.773).shape == (2 * psi.shape[0], 6)
    assert cell.prior_stiffness is not None
    covariance = np.linalg.inv(psi.T @ psi) * cell.noise_std**2
    relative = np.sqrt(np.diag(covariance)) * cell.prior_stiffness
    expected = stiffarm.indices(cell, q, ["worst_joint"])["worst_joint"]
    assert expected == pytest.approx(relative.max(), rel=1e-9)


def test_scipy_reaches_our_optimum(cell: stiffarm.Cell) -> None:
    """L-BFGS-B on our gradients from several starts, against the search of `select`, on the same cell."""
    count, index = 3, "expected_error"
    plan = stiffarm.select(cell, count, index=index, rounds=30, angle_step_deg=0, no_certificate=True)
    objective = stiffarm.Objective(cell, index, postures=count)
    low, high = np.array(objective.bounds).T
    random_numbers = np.random.default_rng(2)
    inside = {"jac": True, "method": "L-BFGS-B", "bounds": objective.bounds}
    ends = []
    for _ in range(40):
        start = random_numbers.uniform(low, high)
        minimum = scipy.optimize.minimize(objective.log_and_gradient, start, options={"maxiter": 200}, **inside)
        ends.append((minimum.fun, minimum.x))
    # The best three once more, each searched about in steps of random size.
    values = []
    for number, (_, at) in enumerate(sorted(ends, key=lambda end: end[0])[:3]):
        minimum = scipy.optimize.basinhopping(
            objective.log_and_gradient,
            at,
            niter=60,
            stepsize=1.0,
            T=0.02,
            minimizer_kwargs={**inside, "options": {"maxiter": 300}},
            rng=number,
        )
        fine = {"maxiter": 3000, "maxfun": 20_000, "maxcor": 40, "ftol": 0.0, "gtol": 1e-10}
        at = scipy.optimize.minimize(objective.log_and_gradient, minimum.x, options=fine, **inside).x
        assert (at >= low).all() and (at <= high).all()
        values.append(objective(at))
    best = min(values)
    assert best <= plan.value * (1 + 1e-6)


def test_names_say_what_is_calculated() -> None:
    assert "over √postures" in stiffarm.index_names()["o1"]
