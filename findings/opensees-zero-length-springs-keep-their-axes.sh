#!/usr/bin/env bash
# OpenSees 3.7.1 (openseespylinux 3.7.1.2): springs of a zeroLength element keep the axes they are given with -orient,
# also between beams in corotational geometry. A joint so modelled does not turn with the arm.
#
# A beam along x on a hinge about z carries a slider along the beam: a zeroLength element, 1 N/m along its local x and
# stiff in all else. A moment turns hinge and beam by 90 degrees, so that the beam is along y. Then 0.1 N pull at the
# slider along x, across the beam. A slider that follows the beam would hold; it goes 0.1 m along x, and holds along y.
# Whoever takes the second order of an arm from such a model builds it again with the axes of the bent arm
# (bench/structural_code.py does). Linear geometry has no such question.
#
# The manual says that -orient is in global coordinates, and nothing of what happens to it as the nodes turn.
#
# Seen, in m: end of the beam at (0, 1); the slider moves by (0.1, 0) under the pull along x, by (0, 0) under that along y
#
# Needs Python 3 with venv on x86-64 Linux, and PyPI; installs into a temporary folder.
set -euo pipefail

version=3.7.1.2
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install -q --disable-pip-version-check "openseespylinux==$version" >"$folder/pip.log" 2>&1 || { cat "$folder/pip.log"; exit 2; }

cat >"$folder/slider.py" <<'PYTHON'
import math

from openseespylinux import opensees as ops


def slider(force):
    ops.wipe()
    ops.model("basic", "-ndm", 3, "-ndf", 6)
    for tag, x in ((1, 0.0), (2, 0.0), (3, 1.0), (4, 1.0)):
        ops.node(tag, x, 0.0, 0.0)
    ops.fix(1, *[1] * 6)
    ops.uniaxialMaterial("Elastic", 1, 1.0)
    ops.uniaxialMaterial("Elastic", 2, 1e6)
    x_and_y = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0)
    ops.element("zeroLength", 1, 1, 2, "-mat", 2, 2, 2, 2, 2, 1, "-dir", 1, 2, 3, 4, 5, 6, "-orient", *x_and_y)
    ops.geomTransf("Corotational", 1, 0.0, 0.0, 1.0)
    ops.element("elasticBeamColumn", 2, 2, 3, 1.0, 1e6, 1e6, 1.0, 1.0, 1.0, 1)
    ops.element("zeroLength", 3, 3, 4, "-mat", 1, 2, 2, 2, 2, 2, "-dir", 1, 2, 3, 4, 5, 6, "-orient", *x_and_y)
    ops.timeSeries("Linear", 1)
    ops.constraints("Plain")
    ops.numberer("Plain")
    ops.system("FullGeneral")
    ops.test("NormUnbalance", 1e-7, 100)
    ops.algorithm("Newton")
    # First the moment alone; then the force on the slider, and what holds the beam upright against it.
    moment, pull = (0.0,) * 5 + (math.pi / 2,), (*force, 0.0, 0.0, 0.0, 0.0)
    for stage, loads in enumerate((((2, moment),), ((2, (0.0,) * 5 + (force[0],)), (4, pull))), 1):
        ops.pattern("Plain", stage, 1)
        for node, load in loads:
            ops.load(node, *load)
        ops.integrator("LoadControl", 0.05)
        ops.analysis("Static")
        if ops.analyze(20) != 0:
            raise SystemExit("no equilibrium found")
        ops.loadConst("-time", 0.0)
    end, moved = ops.nodeDisp(3), ops.nodeDisp(4)
    return 1 + end[0], end[1], moved[0] - end[0], moved[1] - end[1]


for name, force in (("x", (0.1, 0.0)), ("y", (0.0, 0.1))):
    x, y, across, along = (abs(round(v, 3)) for v in slider(force))
    print(f"pull along {name}: beam's end at ({x:.3f}, {y:.3f}), slider moves by ({across:.3f}, {along:.3f})")
print(f"OpenSees {ops.version()}")
PYTHON
"$folder/venv/bin/python" "$folder/slider.py" 2>"$folder/errors.txt" | tee "$folder/seen.txt" || { cat "$folder/errors.txt"; exit 1; }
cat >"$folder/expected.txt" <<'TEXT'
pull along x: beam's end at (0.000, 1.000), slider moves by (0.100, 0.000)
pull along y: beam's end at (0.000, 1.000), slider moves by (0.000, 0.000)
OpenSees 3.7.1
TEXT
diff "$folder/expected.txt" "$folder/seen.txt" || { echo "changed: expected the lines marked <"; exit 1; }
echo "ok: zeroLength springs of openseespylinux $version keep their axes where a corotational beam turns them by 90 degrees"
