"""The novel index compiled by JAX, with reverse-mode gradients, in double precision."""

import jax

jax.config.update("jax_enable_x64", True)

import jax.numpy as jnp
import numpy as np


def make_parts(cell):
    """(Gram matrix of Psi's rows, ln k(J_N)) of one posture, as a traceable function of q."""
    alpha, a, d, offset = (tuple(column) for column in cell.rows.T)
    points = np.vstack([cell.loading_point, cell.measuring_points])

    def parts(q):
        theta = cell.coupling @ q + np.array(offset)
        sin, cos = jnp.sin(theta), jnp.cos(theta)
        rotation, position = jnp.eye(3), jnp.zeros(3)
        axes, origins = [], []
        for i in range(cell.joints):
            sa, ca = np.sin(alpha[i]), np.cos(alpha[i])
            position = position + rotation[:, 0] * a[i]
            # Rx(alpha) Rz(theta), column by column.
            x, y, z = (
                rotation[:, 0],
                ca * rotation[:, 1] + sa * rotation[:, 2],
                (ca * rotation[:, 2] - sa * rotation[:, 1]),
            )
            rotation = jnp.stack([cos[i] * x + sin[i] * y, cos[i] * y - sin[i] * x, z], axis=1)
            position = position + z * d[i]
            axes.append(z)
            origins.append(position)
        z, o = jnp.stack(axes), jnp.stack(origins)
        p = points @ rotation.T + position
        # Linear columns of J at every point: points x joints x 3.
        linear = jnp.cross(z[None], p[:, None] - o[None])
        rope = cell.anchor - p[0]
        force = cell.magnitude * rope / jnp.sqrt(jnp.sum(rope**2))
        torque = linear[0] @ force  # Eq. (4)
        psi = linear[1:] * torque[None, :, None]  # Eq. (9)
        gram = jnp.einsum("mix,mjx->ij", psi, psi)
        normalised = jnp.concatenate([linear[1] / cell.length, z], axis=1)  # Eq. (20), transposed
        inverse = jnp.linalg.inv(normalised)
        square = jnp.sum(normalised**2) * jnp.sum(inverse**2)  # Eq. (21)
        return gram, 0.5 * jnp.log(square) - np.log(cell.joints)

    return parts


class JaxIndex:
    """Index function of a cell; compiled for one group, and for batches of groups."""

    def __init__(self, cell):
        parts = jax.vmap(make_parts(cell))
        joints = cell.joints

        def spectrum(x):
            gram, log_dexterity = parts(x.reshape(-1, joints))
            return jnp.linalg.eigvalsh(gram.sum(axis=0)), log_dexterity

        def exact(x):
            values, log_dexterity = spectrum(x)
            return 0.5 * jnp.log(values[-1] / values[0]) + log_dexterity.max()

        def smoothed(x, sharpness):
            # Log-sum-exp for the three maxima: largest k(J_N), largest and (reciprocal) smallest
            # eigenvalue. The exact index comes along for the record.
            values, log_dexterity = spectrum(x)
            log_values = jnp.log(values)
            soft = lambda v: jax.nn.logsumexp(sharpness * v) / sharpness
            value = 0.5 * (soft(log_values) + soft(-log_values)) + soft(log_dexterity)
            return value, 0.5 * (log_values[-1] - log_values[0]) + log_dexterity.max()

        def components(x):
            values, log_dexterity = spectrum(x)
            condition = 0.5 * jnp.log(values[-1] / values[0])
            return jnp.concatenate([condition[None], log_dexterity])

        self._components = jax.jit(lambda x: (components(x), jax.jacrev(components)(x)))
        self._spectrum = jax.jit(spectrum)
        self._value = jax.jit(exact)
        self._gradient = jax.jit(jax.value_and_grad(exact))
        self._smoothed = jax.jit(jax.value_and_grad(smoothed, has_aux=True))
        self._values = jax.jit(jax.vmap(exact))
        self._gradients = jax.jit(jax.vmap(jax.value_and_grad(exact)))

    def evaluate(self, x):
        """(ln cond(Psi), ln k(J_N) per posture) of a flat group [rad]."""
        values, log_dexterity = self._spectrum(x)
        return 0.5 * np.log(values[-1] / values[0]), np.asarray(log_dexterity)

    def value(self, x):
        """ln of the novel index of a flat group [rad]."""
        return float(self._value(x))

    def value_and_gradient(self, x):
        """ln of the novel index and its gradient, as SciPy wants them."""
        value, gradient = self._gradient(x)
        return float(value), np.asarray(gradient)

    def smoothed(self, x, sharpness):
        """Smoothed ln index, its gradient, and the exact ln index."""
        (value, exact), gradient = self._smoothed(x, sharpness)
        return float(value), np.asarray(gradient), float(exact)

    def components(self, x):
        """ln cond(Psi) and ln k(J_N) per posture, and their Jacobian."""
        values, jacobian = self._components(x)
        return np.asarray(values), np.asarray(jacobian)

    def values(self, x):
        """ln of the novel index of many groups, groups x all angles."""
        return np.asarray(self._values(x))

    def values_and_gradients(self, x):
        """The same with gradients, groups x all angles."""
        value, gradient = self._gradients(x)
        return np.asarray(value), np.asarray(gradient)
