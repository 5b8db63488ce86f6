"""The novel index in NumPy, vectorised over postures and groups.

ln(index) = max_i ln k(J_N)_i + ln cond(Psi). The logarithm makes a sum of the product and is kind
to every optimiser; all peers minimise it.
"""

import numpy as np


class NumpyIndex:
    """Index function of a cell; its arrays are made once."""

    def __init__(self, cell):
        alpha, _, _, self.offset = cell.rows.T
        self.cell = cell
        self.joints = cell.joints
        self.coupling_t = cell.coupling.T.copy()
        self.a, self.d = cell.rows[:, 1], cell.rows[:, 2]
        self.sin_alpha, self.cos_alpha = np.sin(alpha), np.cos(alpha)
        # Loading point first, then the measuring points.
        self.points = np.vstack([cell.loading_point, cell.measuring_points])

    def link_transforms(self, q):
        """Rx(alpha) Tx(a) Rz(theta) Tz(d) of each joint: postures x joints x 4 x 4."""
        theta = q @ self.coupling_t + self.offset
        sin, cos = np.sin(theta), np.cos(theta)
        link = np.zeros((*theta.shape, 4, 4))
        link[..., 0, 0] = cos
        link[..., 0, 1] = -sin
        link[..., 0, 3] = self.a
        link[..., 1, 0] = sin * self.cos_alpha
        link[..., 1, 1] = cos * self.cos_alpha
        link[..., 1, 2] = -self.sin_alpha
        link[..., 1, 3] = -self.sin_alpha * self.d
        link[..., 2, 0] = sin * self.sin_alpha
        link[..., 2, 1] = cos * self.sin_alpha
        link[..., 2, 2] = self.cos_alpha
        link[..., 2, 3] = self.cos_alpha * self.d
        link[..., 3, 3] = 1.0
        return link

    def axes(self, q):
        """Directions and points of the joint axes, and the five tool points, base frame.

        postures x joints x 3 twice, postures x points x 3.
        """
        frames = self.link_transforms(q)
        for i in range(1, self.joints):
            np.matmul(frames[:, i - 1], frames[:, i], out=frames[:, i])
        flange = frames[:, -1]
        points = self.points @ flange[:, :3, :3].transpose(0, 2, 1) + flange[:, None, :3, 3]
        return frames[..., :3, 2], frames[..., :3, 3], points

    def parts(self, q):
        """Gram matrix of the rows of Psi and ln k(J_N) of each posture; q is postures x joints."""
        return posture_parts(self.cell, *self.axes(q))

    def evaluate(self, x):
        """(ln cond(Psi), ln k(J_N) per posture) of a flat group [rad]."""
        gram, log_dexterity = self.parts(x.reshape(-1, self.joints))
        return log_condition(gram.sum(axis=0)), log_dexterity

    def value(self, x):
        """ln of the novel index of a flat group [rad]."""
        condition, log_dexterity = self.evaluate(x)
        return float(condition + log_dexterity.max())

    def values(self, x):
        """The same for many groups at once, groups x all angles."""
        gram, log_dexterity = self.parts(x.reshape(-1, self.joints))
        groups = len(x)
        gram = gram.reshape(groups, -1, self.joints, self.joints).sum(axis=1)
        return log_condition(gram) + log_dexterity.reshape(groups, -1).max(axis=1)

    def value_and_differences(self, x, step=1e-7):
        """Value and forward differences, every perturbed group in one pass.

        A difference moves one angle and so one posture: 36 perturbed postures and the 6 given
        ones hold all that 37 groups need, the other Gram matrices stay.
        """
        q = x.reshape(-1, self.joints)
        count, n = q.shape
        moved = q[:, None, :] + step * np.eye(n)  # postures x angle moved x joints
        gram, log_dexterity = self.parts(np.concatenate([q, moved.reshape(-1, n)]))
        base, changed = gram[:count], gram[count:].reshape(count, n, n, n)
        total = base.sum(axis=0)
        condition = log_condition(
            np.concatenate([total[None], (total - base[:, None] + changed).reshape(-1, n, n)])
        )
        # Maximum over the postures, of which one has moved.
        dexterity = np.broadcast_to(log_dexterity[:count], (count, n, count)).copy()
        at = np.arange(count)
        dexterity[at, :, at] = log_dexterity[count:].reshape(count, n)
        value = condition[0] + log_dexterity[:count].max()
        perturbed = condition[1:] + dexterity.max(axis=2).ravel()
        return float(value), (perturbed - value) / step


def cross(a, b):
    """Cross product along the last axis; numpy.cross costs twice as much on arrays this small."""
    out = np.empty(np.broadcast_shapes(a.shape, b.shape))
    ax, ay, az = a[..., 0], a[..., 1], a[..., 2]
    bx, by, bz = b[..., 0], b[..., 1], b[..., 2]
    out[..., 0] = ay * bz - az * by
    out[..., 1] = az * bx - ax * bz
    out[..., 2] = ax * by - ay * bx
    return out


def posture_parts(cell, z, o, points):
    """Gram matrix of Psi's rows and ln k(J_N) of each posture, from axes and tool points.

    z, o: postures x joints x 3; points: postures x (1 + measuring points) x 3, loading point first.
    """
    postures, joints = z.shape[:2]
    # Linear columns of J at every point: postures x points x joints x 3.
    linear = cross(z[:, None], points[:, :, None] - o[:, None])
    # Rope load, Section IV.A.
    rope = cell.anchor - points[:, 0]
    force = rope * (cell.magnitude / np.sqrt((rope * rope).sum(axis=1, keepdims=True)))
    torque = linear[:, 0] @ force[:, :, None]  # Eq. (4), postures x joints x 1
    # Psi_ij = J_ij Gamma_j, Eq. (9); rows along the last axis.
    psi = (linear[:, 1:] * torque[:, None]).transpose(0, 2, 1, 3).reshape(postures, joints, -1)
    gram = psi @ psi.transpose(0, 2, 1)
    # J_N transposed, Eq. (20), at measuring point 1.
    normalised = np.concatenate([linear[:, 1] / cell.length, z], axis=2)
    try:
        inverse = np.linalg.inv(normalised)
    except np.linalg.LinAlgError:
        # An exactly singular posture somewhere: k(J_N) is infinite there, pinv keeps it huge.
        inverse = np.linalg.pinv(normalised, rcond=0.0)
    # Eq. (21): squared Frobenius norms are the traces.
    square = (normalised**2).sum(axis=(1, 2)) * (inverse**2).sum(axis=(1, 2))
    return gram, 0.5 * np.log(square) - np.log(joints)


def log_condition(gram):
    """ln cond of Psi from its Gram matrix; infinite where Psi has no full rank in rounding."""
    values = np.linalg.eigvalsh(gram)
    least = np.maximum(values[..., 0], 1e-16 * values[..., -1])
    return 0.5 * np.log(values[..., -1] / least)
