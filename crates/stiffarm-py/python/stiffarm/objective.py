"""An index as a function of all controller angles, with its gradient: for optimisers of one's own."""

from __future__ import annotations

import importlib
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _native_cell, _stiffarm
from ._checks import count as count_of
from ._checks import number, text
from ._errors import StiffarmError
from ._inputs import PosturesLike
from .cell import Cell
from .postures import Postures

_LARGER_IS_BETTER = {name: larger for name, _, larger, *_ in _stiffarm.index_names()}


class Objective:
    """An index of groups of one size: value and gradient by all controller angles.

    Angles are of shape (postures, joints), or flat, posture by posture [rad], within two turns; gradients have the shape
    of the angles [1/rad]. A call takes microseconds; an objective is not to be shared among threads.

    SciPy takes it as it is::

        objective = Objective(cell, "expected_error", postures=6)
        scipy.optimize.minimize(objective.log_and_gradient, start.ravel(), jac=True, bounds=objective.bounds)

    The limits of the cell (floor, box, shapes, beams) are not part of the value; its bounds of the angles are in
    :attr:`bounds`.
    """

    def __init__(
        self,
        cell: Cell,
        index: str = "expected_error",
        *,
        postures: int = 6,
        given: PosturesLike | None = None,
    ) -> None:
        """Prepares an index for groups of so many postures, beside given ones that stay.

        Raises:
            StiffarmError: An unknown index; a cell without what it needs.
        """
        if not isinstance(cell, Cell):
            raise _native_cell.no_cell(cell, "cell")
        count = count_of(postures, "postures")
        own = np.zeros((0, cell.joint_count)) if given is None else Postures.of(given).angles
        self._native = _stiffarm.Objective(cell._native, text(index, "index"), count, np.ascontiguousarray(own))
        self.cell = cell
        self.index = self._native.index
        self.postures = count
        self._given = np.array(own)

    @property
    def shape(self) -> tuple[int, int]:
        """(postures, joints)."""
        return self.postures, self.cell.joint_count

    @property
    def bounds(self) -> list[tuple[float, float]]:
        """Bounds of the flat angles [rad], as SciPy takes them."""
        return [(float(low), float(high)) for low, high in self.cell.bounds] * self.postures

    def __call__(self, angles: ArrayLike) -> float:
        """The index; infinite where it does not exist, zero for one of which larger is better.

        Raises:
            StiffarmError: Angles of the wrong number or not finite.
        """
        return self._native.value(_flat(angles))

    def value_and_gradient(self, angles: ArrayLike) -> tuple[float, NDArray[np.float64]]:
        """The index and its gradient.

        Where several postures or joints share the largest value, and where singular values coalesce, the gradient is
        that of one of them.

        Raises:
            StiffarmError: Angles of the wrong number or not finite.
        """
        q = _flat(angles)
        value = self._native.value(q)
        _, gradient = self._native.log_and_gradient(q)
        sign = -1.0 if _LARGER_IS_BETTER[self.index] else 1.0
        return value, (sign * value * gradient).reshape(np.shape(angles))

    def gradient(self, angles: ArrayLike) -> NDArray[np.float64]:
        """The gradient of :meth:`value_and_gradient`."""
        return self.value_and_gradient(angles)[1]

    def log_and_gradient(self, angles: ArrayLike) -> tuple[float, NDArray[np.float64]]:
        """What searches minimise: ln of the index, of its reciprocal where larger is better; and its gradient.

        Raises:
            StiffarmError: Angles of the wrong number or not finite.
        """
        value, gradient = self._native.log_and_gradient(_flat(angles))
        return value, gradient.reshape(np.shape(angles))

    def smoothed(self, angles: ArrayLike, sharpness: float) -> tuple[float, NDArray[np.float64]]:
        """As :meth:`log_and_gradient` of a smooth function: maxima become log-sum-exp, off by at most ln(n)/sharpness.

        Raises:
            StiffarmError: Angles of the wrong number or not finite, a sharpness that is not above zero.
        """
        value, _, gradient = self._native.smoothed(_flat(angles), number(sharpness, "sharpness"))
        return value, gradient.reshape(np.shape(angles))

    def __reduce__(self) -> tuple[Any, ...]:
        given = self._given if len(self._given) else None
        return _again, (self.cell, self.index, self.postures, given)

    def __repr__(self) -> str:
        return f"<Objective {self.index!r} of {self.postures} postures of {self.cell.name!r}>"


def _flat(angles: ArrayLike) -> NDArray[np.float64]:
    try:
        return np.ascontiguousarray(angles, dtype=np.float64).reshape(-1)
    except (TypeError, ValueError) as error:
        raise StiffarmError(f"Angles must be numbers: {error}.", "wrong-type") from None


def _again(cell: Cell, index: str, postures: int, given: Any) -> Objective:
    return Objective(cell, index, postures=postures, given=given)


def for_jax(objective: Objective) -> Any:
    """The logarithm of the index as a function of JAX, differentiable once (``jax.pure_callback``).

    The function takes angles of :attr:`Objective.shape`, or flat, in 64-bit numbers (``jax_enable_x64``).
    """
    jax: Any = importlib.import_module("jax")
    jnp: Any = importlib.import_module("jax.numpy")

    def both(angles: Any) -> tuple[Any, Any]:
        value, gradient = objective.log_and_gradient(np.asarray(angles))
        return np.float64(value), np.asarray(gradient, dtype=np.float64)

    def callback(angles: Any) -> Any:
        shapes = (jax.ShapeDtypeStruct((), jnp.float64), jax.ShapeDtypeStruct(angles.shape, jnp.float64))
        return jax.pure_callback(both, shapes, angles, vmap_method="sequential")

    def value(angles: Any) -> Any:
        return callback(angles)[0]

    log_index: Any = jax.custom_vjp(value)

    def forward(angles: Any) -> Any:
        return callback(angles)

    def backward(gradient: Any, sensitivity: Any) -> Any:
        return (sensitivity * gradient,)

    log_index.defvjp(forward, backward)
    return log_index


def for_casadi(objective: Objective, name: str = "log_index") -> Any:
    """The logarithm of the index as a ``casadi.Callback`` of the flat angles, with its Jacobian.

    Keep a reference to it as long as expressions use it, as CasADi asks of callbacks.
    """
    casadi: Any = importlib.import_module("casadi")
    size = objective.postures * objective.cell.joint_count

    class Jacobian(casadi.Callback):  # type: ignore[misc]
        def __init__(self, name: str) -> None:
            casadi.Callback.__init__(self)
            self.construct(name, {})

        def get_n_in(self) -> int:
            return 2

        def get_n_out(self) -> int:
            return 1

        def get_sparsity_in(self, i: int) -> Any:
            return casadi.Sparsity.dense(size if i == 0 else 1, 1)

        def get_sparsity_out(self, _: int) -> Any:
            return casadi.Sparsity.dense(1, size)

        def eval(self, arguments: Any) -> Any:
            _, gradient = objective.log_and_gradient(np.array(arguments[0]).reshape(-1))
            return [casadi.DM(gradient.reshape(1, -1))]

    class Value(casadi.Callback):  # type: ignore[misc]
        def __init__(self, name: str) -> None:
            casadi.Callback.__init__(self)
            self._jacobian: Any = None
            self.construct(name, {})

        def get_n_in(self) -> int:
            return 1

        def get_n_out(self) -> int:
            return 1

        def get_sparsity_in(self, _: int) -> Any:
            return casadi.Sparsity.dense(size, 1)

        def eval(self, arguments: Any) -> Any:
            value, _ = objective.log_and_gradient(np.array(arguments[0]).reshape(-1))
            return [value]

        def has_jacobian(self) -> bool:
            return True

        def get_jacobian(self, name: str, *_: Any) -> Any:
            self._jacobian = Jacobian(name)
            return self._jacobian

    return Value(name)
