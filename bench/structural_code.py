#!/usr/bin/env python3
"""Make arms for bench/structural_arms.py with a structural code, OpenSees, instead of with the springs that stiffarm assumes.

An arm is a finite-element model here of 53 nodes: links as tapered tubes and boxes of iron and aluminium (3D elastic
beams), a bearing at every joint that tilts and shifts, four anchor bolts under the base, and a spring about each joint's
axis. Geometry is that of the default cell's robot; sizes are drawn around usual ones, the first arm has these.

The seven 6 x 6 compliances that structural_arms.py reads come out of it by unit loads, body by body. Nothing is written
unless the whole model, built in other postures, agrees with
- the joints' model, Eq. (7), d = J inv(K) J' F, where all else is stiff, and
- what the seven compliances predict, at 20 random postures under random forces,

both to 1e-9 of the largest deflection (`--tolerance`). In the table:

- joints alone, seven springs: largest difference in these two checks; at 1e6: the first with all else 1e6 times stiffer,
  where the others' share is what is left;
- asymmetry: of the compliances, before they are made symmetric;
- axes, tilt, shift (of bearings), links, base, and of the links two: share of the deflection of the loaded point along a
  random force, over 500 postures;
- 500 N: RMS deflection in corotational geometry, and its difference to the linear one and to the exact equilibrium of the
  seven springs.

`check` in FILE is the corotational answer, so that it differs from the linear one by the second order.

    pip install numpy==2.4.6 openseespylinux==3.7.1.2
    python3 bench/structural_code.py --arms 8 --seed 1 --output arms.json
"""

import argparse
import json
import math
import sys
from pathlib import Path

import numpy as np
from openseespylinux import opensees as ops

import elastic_truths as truths
from elastic_truths import ARCMINUTE, JOINTS, POINTS, STIFFNESS, frames, linear, postures, turns

# Modulus of elasticity and of shear [Pa].
IRON, ALUMINIUM = (1.7e11, 6.6e10), (7.0e10, 2.6e10)
TILT = np.array([4900, 4900, 2940, 1176, 931, 372]) / ARCMINUTE
RADIAL = np.array([3.0e9, 3.0e9, 2.0e9, 1.2e9, 1.0e9, 0.6e9])
BOLT_AXIAL, BOLT_SHEAR, BOLTS_AT = 4.0e8, 2.0e8, 0.3

# Where the bearings are, along the joints' axes from the origins of their frames [m]: in the base's column, beside the
# shoulder and the elbow, behind the elbow, in the fork of the wrist, behind the flange.
BEARINGS = np.array([-0.48, 0.12, 0.12, -1.09, 0.07, -0.09])

# Members of each body, base first, in its frame: from where, to where [m], elements, material, shape, and sizes at both
# ends [m]: (diameter, wall) of a tube, or (along `side`, across, wall) of a box with the direction `side`. Each begins
# where the one before ends, the first at the bearing; the last ends at the next bearing or the flange.
X, Y, Z = np.eye(3)
MEMBERS = [
    [((0, 0, 0.35), 3, IRON, (0.56, 0.025), (0.50, 0.025), None)],
    [
        ((0.05, 0, -0.30), 2, IRON, (0.50, 0.025), (0.46, 0.022), None),
        ((0.34, 0.06, -0.03), 3, IRON, (0.34, 0.42, 0.022), (0.28, 0.34, 0.022), Y),
        ((0.4, 0.12, 0), 1, IRON, (0.32, 0.025), (0.32, 0.025), None),
    ],
    [
        ((0, 0, 0.22), 1, IRON, (0.30, 0.02), (0.30, 0.02), None),
        ((1.175, 0, 0.22), 8, IRON, (0.17, 0.30, 0.014), (0.14, 0.22, 0.011), Z),
        ((1.175, 0, 0.12), 1, IRON, (0.24, 0.02), (0.24, 0.02), None),
    ],
    [
        ((0, 0, 0), 1, IRON, (0.24, 0.02), (0.24, 0.02), None),
        ((0.25, 0.08, 0), 2, IRON, (0.26, 0.30, 0.018), (0.26, 0.28, 0.018), Z),
        ((0.25, 0.354, 0), 2, IRON, (0.26, 0.016), (0.23, 0.016), None),
    ],
    [
        ((0, 0, -0.20), 7, ALUMINIUM, (0.26, 0.016), (0.20, 0.014), None),
        ((0, -0.09, -0.12), 1, ALUMINIUM, (0.19, 0.19, 0.025), (0.14, 0.17, 0.025), X),
        ((0, -0.09, 0), 1, ALUMINIUM, (0.16, 0.09, 0.022), (0.16, 0.09, 0.022), X),
        ((0, -0.07, 0), 1, ALUMINIUM, (0.13, 0.02), (0.13, 0.02), None),
    ],
    [
        ((0, 0.03, 0.03), 1, IRON, (0.12, 0.018), (0.12, 0.018), None),
        ((0, 0.14, 0), 2, IRON, (0.13, 0.015), (0.13, 0.015), None),
    ],
    [((0, 0, 0), 1, IRON, (0.13, 0.025), (0.13, 0.025), None)],
]

# Of the natural logarithms: what is drawn differs by this much (one sigma) from the usual size.
SPREAD = {"width": 0.08, "wall": 0.15, "tilt": 0.3, "shift": 0.3, "bolts": 0.3, "axes": 0.35}


class Arm:
    """Sizes of an arm. `stiffer` multiplies the stiffness of all but the joints' axes."""

    def __init__(self, rng=None):
        def about(what, count):
            drawn = np.zeros(count) if rng is None else np.clip(rng.standard_normal(count), -2, 2)
            return np.exp(SPREAD[what] * drawn)

        self.width, self.wall = about("width", JOINTS + 1), about("wall", JOINTS + 1)
        self.tilt, self.shift = TILT * about("tilt", JOINTS), RADIAL * about("shift", JOINTS)
        self.bolts = about("bolts", 1)[0]
        self.axes = STIFFNESS * about("axes", JOINTS)
        self.stiffer = 1.0


def section(sizes, is_box):
    """Area, and moments: polar, about the local y and the local z axis, which is `side` of a box."""
    if not is_box:
        outer, inner = sizes[0] / 2, sizes[0] / 2 - sizes[1]
        moment = math.pi / 4 * (outer**4 - inner**4)
        return math.pi * (outer**2 - inner**2), 2 * moment, moment, moment
    b, h, t = sizes
    # Bredt's formula along the middle of the wall.
    polar = 2 * t * (b - t) ** 2 * (h - t) ** 2 / (b + h - 2 * t)
    hollow = lambda along, across: (across * along**3 - (across - 2 * t) * (along - 2 * t) ** 3) / 12
    return b * h - (b - 2 * t) * (h - 2 * t), polar, hollow(b, h), hollow(h, b)


class Model:
    """The domain of OpenSees, which is a single one, filled anew."""

    def __init__(self, transform):
        ops.wipe()
        ops.model("basic", "-ndm", 3, "-ndf", 6)
        self.transform = transform
        self.nodes = self.beams = self.others = 0

    def node(self, place):
        self.nodes += 1
        ops.node(self.nodes, *map(float, place))
        return self.nodes

    def beam(self, first, last, material, properties, side):
        self.beams += 1
        ops.geomTransf(self.transform, self.beams, *map(float, side))
        area, polar, about_y, about_z = properties
        young, shear = material
        tag = 1000 + self.beams
        ops.element("elasticBeamColumn", tag, first, last, area, young, shear, polar, about_y, about_z, self.beams)

    def springs(self, first, last, stiffness, rotation):
        """Springs (directions 1 to 6) between nodes at the same place. Columns of `rotation` are their axes."""
        tags = []
        for k in stiffness.values():
            self.others += 1
            tags.append(self.others)
            ops.uniaxialMaterial("Elastic", self.others, float(k))
        axes = (*rotation[:, 0], *rotation[:, 1])
        ops.element("zeroLength", 5000 + self.others, first, last, "-mat", *tags, "-dir", *stiffness, "-orient", *axes)

    def solved(self, node, wrench):
        """Loads one node. Newton's later steps correct the rounding of the first where geometry is linear."""
        ops.timeSeries("Linear", 1)
        ops.pattern("Plain", 1, 1)
        ops.load(node, *map(float, wrench))
        ops.constraints("Plain")
        ops.numberer("RCM")
        ops.system("BandGeneral")
        ops.test("FixedNumIter", 3 if self.transform == "Linear" else 8)
        ops.algorithm("Newton")
        ops.integrator("LoadControl", 1.0)
        ops.analysis("Static")
        if ops.analyze(1) != 0:
            raise RuntimeError("no equilibrium found")


def body(model, arm, place, rotation, origin):
    """Beams of one body. Its first node, and its last."""
    put = lambda p: origin + rotation @ np.asarray(p, dtype=float)
    scale = np.array([arm.width[place], arm.wall[place]])
    start = np.array([0, 0, BEARINGS[place - 1]]) if place > 0 else np.zeros(3)
    first = last = model.node(put(start))
    if place == 0:
        # A cross of ribs, each to a bolt.
        for x, y in ((1, 1), (1, -1), (-1, -1), (-1, 1)):
            corner = put(BOLTS_AT * np.array([x, y, 0]))
            ground, foot = model.node(corner), model.node(corner)
            ops.fix(ground, *[1] * 6)
            bolt = {1: BOLT_SHEAR, 2: BOLT_SHEAR, 3: BOLT_AXIAL}
            model.springs(ground, foot, {d: k * arm.bolts * arm.stiffer for d, k in bolt.items()}, np.eye(3))
            rib = section(np.array([0.28, 0.25, 0.03]) * scale[[0, 0, 1]], True)
            model.beam(foot, first, [m * arm.stiffer for m in IRON], rib, rotation @ Z)
    for end, count, material, near, far, side in MEMBERS[place]:
        end, near, far = (np.array(v, dtype=float) for v in (end, near, far))
        is_box = side is not None
        if not is_box:
            # Any direction across a round tube.
            side = np.eye(3)[np.argmin(np.abs(end - start))]
        for i in range(count):
            middle = (near + (far - near) * (i + 0.5) / count) * (scale[[0, 0, 1]] if is_box else scale)
            node = model.node(put(start + (end - start) * (i + 1) / count))
            model.beam(last, node, [m * arm.stiffer for m in material], section(middle, is_box), rotation @ side)
            last = node
        start = end
    return first, last


def bearing(arm, joint):
    """Springs of a bearing beyond its axis, the local z."""
    radial, tilt = arm.shift[joint] * arm.stiffer, arm.tilt[joint] * arm.stiffer
    return {1: radial, 2: radial, 3: 1.5 * radial, 4: tilt, 5: tilt}


def whole(arm, q, transform="Linear", turned=None):
    """The model in a posture: the flange's node, and the nodes that carry the bearings. With `turned`, rotations of these
    nodes, the springs have the axes of the bent arm: zeroLength elements keep the axes they are given."""
    model = Model(transform)
    of_springs, _ = frames(q[None], np.zeros((1, JOINTS + 1, 6)), np.ones(JOINTS))
    carriers = []
    for place, (rotation, origin) in enumerate(of_springs):
        first, end = body(model, arm, place, rotation[0], origin[0])
        if place > 0:
            axes = rotation[0] if turned is None else turned[place - 1] @ rotation[0]
            model.springs(last, first, bearing(arm, place - 1) | {6: arm.axes[place - 1]}, axes)
            carriers.append(last)
        last = end
    return model, last, carriers


def lever(point):
    """Wrench about the origin from one about `point`, and by its transpose the twist there from that at the origin."""
    x, y, z = point
    matrix = np.eye(6)
    matrix[3:, :3] = [[0, -z, y], [z, 0, -x], [-y, x, 0]]
    return matrix


def flange_of(q):
    rotation, origin = frames(q[None], np.zeros((1, JOINTS + 1, 6)), np.ones(JOINTS))[1]
    return rotation[0], origin[0]


def linear_response(arm, q, force):
    """Displacements (4, 3) of the measuring points, to first order, under a force on the first."""
    model, flange, _ = whole(arm, q)
    levers = POINTS @ flange_of(q)[0].T
    model.solved(flange, lever(levers[0])[:, :3] @ force)
    moved = np.array(ops.nodeDisp(flange))
    return moved[:3] + np.cross(moved[3:], levers)


def corotational_response(arm, q, force):
    """The same in corotational geometry: the lever of the force and the axes of the bearings go with the arm."""
    rotation = flange_of(q)[0]
    turn, turned = np.eye(3), None
    levers = POINTS @ rotation.T
    for _ in range(5):
        model, flange, carriers = whole(arm, q, "Corotational", turned)
        model.solved(flange, lever(turn @ levers[0])[:, :3] @ force)
        moved = np.array(ops.nodeDisp(flange))
        turn = turns(moved[3:])
        turned = [turns(np.array(ops.nodeDisp(node))[3:]) for node in carriers]
    return moved[:3] + levers @ turn.T - levers


def compliance(arm, place):
    """Compliance of one body with the bearing that carries it, by unit loads at its end, and the shares of the bearing's
    tilt and of its shift. All about the origin of the body's frame."""
    parts = np.zeros((3, 6, 6))
    for i in range(6):
        model = Model("Linear")
        first, last = body(model, arm, place, np.eye(3), np.zeros(3))
        if place > 0:
            ground = model.node(ops.nodeCoord(first))
            ops.fix(ground, *[1] * 6)
            model.springs(ground, first, bearing(arm, place - 1), np.eye(3))
            # The joint does not turn: that is its own spring.
            ops.fix(first, 0, 0, 0, 0, 0, 1)
        end = np.linalg.inv(lever(ops.nodeCoord(last)))
        model.solved(last, end[:, i])
        parts[0, :, i] = end.T @ ops.nodeDisp(last)
        if place > 0:
            at = np.linalg.inv(lever(ops.nodeCoord(first))).T
            moved = np.array(ops.nodeDisp(first))
            parts[1, :, i] = at @ (moved * np.repeat([0, 1], 3))
            parts[2, :, i] = at @ (moved * np.repeat([1, 0], 3))
    asymmetry = np.abs(parts[0] - parts[0].T).max() / np.abs(parts[0]).max()
    return (parts + np.swapaxes(parts, 1, 2)) / 2, asymmetry


def predicted(springs, axes, q, force):
    """What seven springs (7, 6, 6) and the joints' axes do to first order (n, 4, 3)."""
    springs = springs.copy()
    springs[1:, 5, 5] += axes
    loaded = truths.unloaded(q, POINTS[:1])[:, 0]
    return linear(q, (springs, np.ones(JOINTS)), force, loaded, POINTS)[0]


def forces(rng, count, low, high):
    direction = rng.standard_normal((count, 3))
    return direction / np.linalg.norm(direction, axis=1)[:, None] * rng.uniform(low, high, (count, 1))


def apart(found, expected):
    """Largest difference at a posture over the largest deflection there, of all postures."""
    return float(np.max(np.abs(found - expected).max(axis=(1, 2)) / np.linalg.norm(expected, axis=2).max(axis=1)))


def responses(arm, q, force, stiffer=1.0, of=linear_response):
    arm.stiffer = stiffer
    found = np.array([of(arm, *load) for load in zip(q, force)])
    arm.stiffer = 1.0
    return found


def made(arm, seed, count=20):
    """The arm's entry of the file, and what was found of it."""
    parts, asymmetry = zip(*(compliance(arm, place) for place in range(JOINTS + 1)))
    springs, tilts, shifts = np.moveaxis(np.array(parts), 1, 0)
    rng = np.random.default_rng([seed, 1])
    q, force = postures(rng, count), forces(rng, count, 200, 1000)

    # A deflection is a sum of compliances, so that two stiffnesses of all else tell what joints alone do, without the
    # rounding of a nearly rigid model.
    joints = predicted(np.zeros_like(springs), 1 / arm.axes, q, force)
    at_1000, at_2000, at_million = (responses(arm, q, force, s) for s in (1e3, 2e3, 1e6))
    found = {"joints, all else 1e6 stiffer": apart(at_million, joints), "joints": apart(2 * at_2000 - at_1000, joints)}
    of_model = responses(arm, q, force)
    found["seven"] = apart(predicted(springs, 1 / arm.axes, q, force), of_model)
    found["asymmetry"] = max(asymmetry)

    # Along the force, at its point: there the parts' shares add up.
    at = postures(rng, 500), forces(rng, 500, 200, 1000)
    along = lambda part, axes=np.zeros(JOINTS): np.einsum("ni,ni->n", predicted(part, axes, *at)[:, 0], at[1])
    only = lambda part, place: part * (np.arange(JOINTS + 1) == place)[:, None, None]
    base = only(springs, 0)
    links = springs - tilts - shifts - base
    parts = [along(0 * springs, 1 / arm.axes), *map(along, (tilts, shifts, links, base, only(links, 2), only(links, 4)))]
    found["shares"] = [float(100 * part.sum() / along(springs, 1 / arm.axes).sum()) for part in parts]

    force *= 500 / np.linalg.norm(force, axis=1)[:, None]
    bent = responses(arm, q, force, of=corotational_response)
    rms = lambda v: 1e3 * math.sqrt(np.mean(np.sum(v**2, axis=2)))
    with_axes = springs.copy()
    with_axes[1:, 5, 5] += 1 / arm.axes
    exact = [truths.bent(p[None], (with_axes, np.zeros(JOINTS), np.ones(JOINTS)), f)[0] for p, f in zip(q, force)]
    exact = np.array(exact) - truths.unloaded(q, POINTS)
    found["order"] = [rms(bent), rms(bent - predicted(springs, 1 / arm.axes, q, force)), rms(bent - exact)]

    digits = lambda values, n: [float(f"{v:.{n}g}") for v in values]
    q, force = postures(rng, 8), np.round(forces(rng, 8, 200, 1000), 6)
    moved = 1e3 * responses(arm, q, force, of=corotational_response)
    check = [
        {"q_deg": p.tolist(), "force_n": f.tolist(), "displacement_mm": [digits(row, 7) for row in d]}
        for p, f, d in zip(q, force, moved)
    ]
    springs = [[digits(row, 12) for row in matrix] for matrix in springs]
    return {"springs_beyond_axes": springs, "joint_stiffness_nm_per_rad": digits(arm.axes, 12), "check": check}, found


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--arms", type=int, default=8, help="how many; the first has the usual sizes")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--tolerance", type=float, default=1e-9, help="of both checks, relative")
    parser.add_argument("--output", type=Path, required=True, metavar="FILE")
    args = parser.parse_args()
    heads = ["arm", "joints alone", "at 1e6", "seven springs", "asymmetry", "axes [%]", "tilt", "shift", "links", "base", "lower arm"]
    heads += ["forearm", "500 N [mm]", "less linear [mm]", "less seven springs [mm]"]
    print(f"OpenSees {ops.version()}\n\n| " + " | ".join(heads) + " |\n|" + "--|" * len(heads), flush=True)
    arms, sound = {}, True
    for i in range(args.arms):
        name = "usual" if i == 0 else f"arm_{i}"
        arm = Arm(np.random.default_rng([args.seed, 0, i]) if i else None)
        arms[name], found = made(arm, 1000 * args.seed + i)
        keys = ("joints", "joints, all else 1e6 stiffer", "seven", "asymmetry")
        cells = [f"{found[key]:.1e}" for key in keys]
        cells += [f"{v:.1f}" for v in found["shares"]] + [f"{v:.5f}" for v in found["order"]]
        print("| " + " | ".join([name, *cells]) + " |", flush=True)
        sound &= max(found["joints"], found["seven"]) <= args.tolerance
    if not sound:
        print(f"structural_code: an arm disagrees by more than {args.tolerance:g}; nothing written", file=sys.stderr)
        return 1
    args.output.write_text(json.dumps({"arms": arms}, separators=(",", ":")) + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
