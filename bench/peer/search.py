"""Searches with SciPy under a time budget, with the best index against time on record."""

import time

import numpy as np
from scipy import optimize

# ln(index) given to an optimiser where the index does not exist.
NO_INDEX = 100.0
# Difference step [rad]; SciPy's 1.5e-8 drowns in the rounding of ln cond(Psi).
STEP = 1e-7
# Stages of the log-sum-exp treatment: coarse first, then close to the maximum itself.
SHARPNESS = (10.0, 100.0, 1000.0)
LBFGSB = {"maxiter": 1000, "maxfun": 5000}


class TimeUp(Exception):
    """The budget is spent, or the user interrupted."""


class Recorder:
    """Counts evaluations and keeps the best group inside the bounds with its time."""

    def __init__(self, cell, start, seconds):
        self.joints = cell.joints
        self.lower, self.upper = cell.group_bounds()
        self.start, self.deadline = start, start + seconds
        self.values = self.gradients = self.starts = 0
        self.best, self.best_x, self.trace = np.inf, None, []
        self.interrupted = False

    def check(self):
        """Ends the search when the time is up."""
        if self.interrupted or time.monotonic() >= self.deadline:
            raise TimeUp

    def offer(self, x, value):
        """Notes ln(index) of a group; an optimiser gets the returned, always finite, number."""
        if not np.isfinite(value):
            return NO_INDEX
        inside = np.all((x >= self.lower) & (x <= self.upper))
        if value < self.best and inside:
            self.best, self.best_x = value, np.array(x)
            self.trace.append(
                {
                    "seconds": time.monotonic() - self.start,
                    "values": self.values,
                    "gradients": self.gradients,
                    "value": float(np.exp(value)),
                }
            )
        return value

    def result(self):
        """What the parent process records."""
        return {
            "trace": self.trace,
            "values": self.values,
            "gradients": self.gradients,
            "starts": self.starts,
            "seconds": min(time.monotonic(), self.deadline) - self.start,
            "best": float(np.exp(self.best)) if self.best_x is not None else None,
            "best_group_deg": None
            if self.best_x is None
            else np.degrees(self.best_x).reshape(-1, self.joints).tolist(),
        }


def many_starts(cell, recorder, generator, minimise):
    """Minimises from random groups until the time is up."""
    lower, upper = cell.group_bounds()
    while True:
        recorder.check()
        recorder.starts += 1
        minimise(cell.random_group(generator), optimize.Bounds(lower, upper))


def slsqp_differences(cell, recorder, generator, value):
    """SLSQP with SciPy's own forward differences, as fmincon does it."""

    def objective(x):
        recorder.check()
        recorder.values += 1
        return recorder.offer(x, value(x))

    def minimise(x, bounds):
        optimize.minimize(
            objective,
            x,
            method="SLSQP",
            bounds=bounds,
            options={"maxiter": 400, "ftol": 1e-9, "eps": STEP},
        )

    many_starts(cell, recorder, generator, minimise)


def slsqp_batched_differences(cell, recorder, generator, value, value_and_differences):
    """SLSQP with all forward differences in one NumPy call."""

    def objective(x):
        recorder.check()
        recorder.values += 1
        return recorder.offer(x, value(x))

    def gradient(x):
        recorder.check()
        recorder.gradients += 1
        return np.nan_to_num(value_and_differences(x, STEP)[1])

    def minimise(x, bounds):
        optimize.minimize(
            objective,
            x,
            jac=gradient,
            method="SLSQP",
            bounds=bounds,
            options={"maxiter": 400, "ftol": 1e-9},
        )

    many_starts(cell, recorder, generator, minimise)


def lbfgsb(cell, recorder, generator, value_and_gradient):
    """L-BFGS-B on the index as it is, kinks and all."""

    def objective(x):
        recorder.check()
        recorder.gradients += 1
        value, gradient = value_and_gradient(x)
        return recorder.offer(x, value), np.nan_to_num(gradient)

    def minimise(x, bounds):
        optimize.minimize(objective, x, jac=True, method="L-BFGS-B", bounds=bounds, options=LBFGSB)

    many_starts(cell, recorder, generator, minimise)


def smoothed_objective(recorder, smoothed):
    """Objective of the log-sum-exp treatment; the exact index goes on record."""

    def objective(x, sharpness):
        recorder.check()
        recorder.gradients += 1
        value, gradient, exact = smoothed(x, sharpness)
        recorder.offer(x, exact)
        return (value if np.isfinite(value) else NO_INDEX), np.nan_to_num(gradient)

    return objective


def lbfgsb_smoothed(cell, recorder, generator, smoothed):
    """L-BFGS-B on the log-sum-exp index, sharper in stages."""
    objective = smoothed_objective(recorder, smoothed)

    def minimise(x, bounds):
        for sharpness in SHARPNESS:
            x = optimize.minimize(
                objective,
                x,
                args=(sharpness,),
                jac=True,
                method="L-BFGS-B",
                bounds=bounds,
                options=LBFGSB,
            ).x

    many_starts(cell, recorder, generator, minimise)


def epigraph(cell, recorder, generator, components):
    """SLSQP on the epigraph form, as fminimax does it: min t + ln cond(Psi), ln k(J_N)_i <= t.

    `components(x)` gives ln cond(Psi), ln k(J_N) per posture, and their Jacobian.
    """
    last = {"x": None}

    def at(x):
        # SciPy asks for objective, constraints and derivatives one by one at the same point.
        if last["x"] is None or not np.array_equal(x, last["x"]):
            recorder.check()
            recorder.gradients += 1
            values, jacobian = components(x)
            recorder.offer(x, values[0] + values[1:].max())
            last.update(
                x=np.array(x),
                values=np.nan_to_num(values, nan=NO_INDEX, posinf=NO_INDEX),
                jacobian=np.nan_to_num(jacobian),
            )
        return last["values"], last["jacobian"]

    def objective(y):
        values, jacobian = at(y[:-1])
        return values[0] + y[-1], np.append(jacobian[0], 1.0)

    def margin_gradient(y):
        jacobian = at(y[:-1])[1][1:]
        return np.hstack([-jacobian, np.ones((len(jacobian), 1))])

    constraint = {
        "type": "ineq",
        "fun": lambda y: y[-1] - at(y[:-1])[0][1:],
        "jac": margin_gradient,
    }

    def minimise(x, bounds):
        # k(J_N) >= 1, so that t >= 0.
        bounds = optimize.Bounds(np.append(bounds.lb, 0.0), np.append(bounds.ub, np.inf))
        optimize.minimize(
            objective,
            np.append(x, at(x)[0][1:].max()),
            jac=True,
            method="SLSQP",
            bounds=bounds,
            constraints=[constraint],
            options={"maxiter": 400, "ftol": 1e-9},
        )

    many_starts(cell, recorder, generator, minimise)


def differential_evolution(cell, recorder, generator, values, smoothed):
    """Differential evolution, a generation per call, for 90 % of the time; then a polish.

    SciPy polishes with differences once it has converged, which it does not in the time given;
    here L-BFGS-B with JAX's gradients does it.
    """
    lower, upper = cell.group_bounds()
    bounds = optimize.Bounds(lower, upper)
    until = recorder.start + 0.9 * (recorder.deadline - recorder.start)

    def population(x):
        recorder.check()
        groups = np.ascontiguousarray(np.atleast_2d(x.T))
        recorder.values += len(groups)
        found = np.asarray(values(groups))
        found = np.where(np.isfinite(found), found, NO_INDEX)
        least = int(found.argmin())
        recorder.offer(groups[least], found[least])
        return found

    polish = smoothed_objective(recorder, smoothed)
    while True:
        recorder.starts += 1
        x = optimize.differential_evolution(
            population,
            bounds,
            maxiter=10**9,
            tol=0.0,
            polish=False,
            vectorized=True,
            updating="deferred",
            rng=generator,
            callback=lambda intermediate_result: time.monotonic() >= until,
        ).x
        for sharpness in SHARPNESS:
            x = optimize.minimize(
                polish,
                x,
                args=(sharpness,),
                jac=True,
                method="L-BFGS-B",
                bounds=bounds,
                options=LBFGSB,
            ).x


def dual_annealing(cell, recorder, generator, value, gradient):
    """Dual annealing with L-BFGS-B and JAX's gradients as its local search."""
    bounds = list(zip(*cell.group_bounds(), strict=True))

    def objective(x):
        recorder.check()
        recorder.values += 1
        return recorder.offer(x, value(x))

    def slope(x):
        recorder.check()
        recorder.gradients += 1
        return np.nan_to_num(gradient(x)[1])

    while True:
        recorder.starts += 1
        optimize.dual_annealing(
            objective,
            bounds,
            maxiter=10**9,
            maxfun=10**12,
            rng=generator,
            minimizer_kwargs={
                "method": "L-BFGS-B",
                "jac": slope,
                "bounds": bounds,
            },
        )
