"""The novel index with Jacobians from Pinocchio.

Pinocchio gives the joint axes of one posture; Psi, k(J_N) and the condition number are NumPy's,
as in index_numpy.
"""

import numpy as np
import pinocchio as pin

from .index_numpy import log_condition, posture_parts


class PinocchioIndex:
    """Index function of a cell on a Pinocchio model made from its Denavit-Hartenberg rows."""

    def __init__(self, cell):
        self.cell = cell
        self.joints = cell.joints
        self.coupling = cell.coupling
        self.offset = cell.rows[:, 3].copy()
        self.model, self.frame_ids = build_model(cell)
        self.data = self.model.createData()

    def axes(self, q):
        """Directions and points of the joint axes, and the tool points, base frame."""
        model, data, count = self.model, self.data, len(q)
        jacobians = np.empty((count, 6, self.joints))
        points = np.empty((count, len(self.frame_ids), 3))
        theta = q @ self.coupling.T + self.offset
        for p in range(count):
            # World Jacobians of all joints and, with them, every placement.
            jacobians[p] = pin.computeJointJacobians(model, data, theta[p])
            pin.updateFramePlacements(model, data)
            for i, frame in enumerate(self.frame_ids):
                points[p, i] = data.oMf[frame].translation
        return jacobians, points

    def parts(self, q):
        """Gram matrix of the rows of Psi and ln k(J_N) of each posture."""
        jacobians, points = self.axes(q)
        return posture_parts_from_world(self.cell, jacobians, points)

    def evaluate(self, x):
        """(ln cond(Psi), ln k(J_N) per posture) of a flat group [rad]."""
        gram, log_dexterity = self.parts(x.reshape(-1, self.joints))
        return log_condition(gram.sum(axis=0)), log_dexterity

    def value(self, x):
        """ln of the novel index of a flat group [rad]."""
        condition, log_dexterity = self.evaluate(x)
        return float(condition + log_dexterity.max())


def build_model(cell):
    """A Pinocchio model of the chain with one frame per tool point, loading point first."""
    model = pin.Model()
    joint, after = 0, pin.SE3.Identity()
    for i, (alpha, a, d, _) in enumerate(cell.rows):
        # Rx(alpha) Tx(a) before the joint turns, Tz(d) after it.
        before = pin.SE3(pin.utils.rotate("x", alpha), np.zeros(3)) * pin.SE3(
            np.eye(3), np.array([a, 0.0, 0.0])
        )
        joint = model.addJoint(joint, pin.JointModelRZ(), after * before, f"joint{i + 1}")
        after = pin.SE3(np.eye(3), np.array([0.0, 0.0, d]))
    frame_ids = []
    for i, point in enumerate(np.vstack([cell.loading_point, cell.measuring_points])):
        placement = after * pin.SE3(np.eye(3), point)
        frame = pin.Frame(f"point{i}", joint, 0, placement, pin.FrameType.OP_FRAME)
        frame_ids.append(model.addFrame(frame))
    return model, frame_ids


def posture_parts_from_world(cell, jacobians, points):
    """As posture_parts, from Jacobians at the world's origin (postures x 6 x joints).

    A revolute column there is [o x z; z]; the point z x (o x z) of the axis nearest to the
    origin serves as its point.
    """
    linear = jacobians[:, :3].transpose(0, 2, 1)
    z = jacobians[:, 3:].transpose(0, 2, 1)
    origin = np.cross(z, linear)
    return posture_parts(cell, z, origin, points)
