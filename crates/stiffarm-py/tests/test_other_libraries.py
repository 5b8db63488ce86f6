"""Robots of other libraries agree with ours, and ours with theirs."""

import os
from pathlib import Path

import numpy as np
import pytest

import stiffarm

#: A robot without round numbers: oblique axes, offsets, a fixed flange.
OBLIQUE = """<robot name="oblique">
<link name="base"/><link name="a"/><link name="b"/><link name="c"/><link name="d"/><link name="e"/><link name="f"/>
<link name="tool0"/>
<joint name="j1" type="revolute"><parent link="base"/><child link="a"/><origin xyz="0.01 -0.02 0.4" rpy="0.1 0.02 -0.3"/>
<axis xyz="0.1 0.2 1"/><limit lower="-2.9" upper="2.9" effort="0" velocity="0"/></joint>
<joint name="j2" type="revolute"><parent link="a"/><child link="b"/><origin xyz="0.31 0 0.35" rpy="0 0.3 0.2"/>
<axis xyz="0 1 0.05"/><limit lower="-1.5" upper="2.2" effort="0" velocity="0"/></joint>
<joint name="j3" type="revolute"><parent link="b"/><child link="c"/><origin xyz="0.02 0.03 1.1" rpy="0 0 0"/>
<axis xyz="0 1 0.0501"/><limit lower="-2.5" upper="2.5" effort="0" velocity="0"/></joint>
<joint name="j4" type="continuous"><parent link="c"/><child link="d"/><origin xyz="0.6 0 0.1" rpy="1 0 0"/><axis xyz="1 0 0"/></joint>
<joint name="j5" type="revolute"><parent link="d"/><child link="e"/><origin xyz="0.5 0 0" rpy="0 0 0"/>
<axis xyz="0 1 0"/><limit lower="-2" upper="2" effort="0" velocity="0"/></joint>
<joint name="j6" type="revolute"><parent link="e"/><child link="f"/><origin xyz="0.2 0 0" rpy="0 0 0"/>
<axis xyz="1 0 0"/><limit lower="-6" upper="6" effort="0" velocity="0"/></joint>
<joint name="fixed" type="fixed"><parent link="f"/><child link="tool0"/><origin xyz="0.1 0.02 0" rpy="0 1.5707963267948966 0.4"/></joint>
</robot>"""


def urdfs(tmp_path: Path) -> list[tuple[Path, str]]:
    """Our own URDF, and those of the reference data where they are at hand: with the frame that is the flange."""
    oblique = tmp_path / "oblique.urdf"
    oblique.write_text(OBLIQUE)
    robots = [(oblique, "tool0")]
    reference = os.environ.get("STIFFARM_REFERENCE_DATA")
    if reference:
        folder = Path(reference) / "robots" / "urdf"
        robots += [(folder / "ur10e.urdf", "tool0"), (folder / "kuka_kr210_r2700_2.urdf", "tool0")]
        robots = [(path, frame) for path, frame in robots if path.exists()]
    return robots


def worst(ours: stiffarm.Robot, pose, jacobian, limits: np.ndarray) -> float:
    """Largest difference of poses and Jacobians over random postures [m, rad]."""
    rng = np.random.default_rng(1)
    difference = 0.0
    for _ in range(50):
        q = rng.uniform(limits[:, 0], limits[:, 1])
        difference = max(difference, np.abs(ours.pose(q) - pose(q)).max())
        difference = max(difference, np.abs(ours.jacobian(q) - jacobian(q)).max())
    return difference


def test_poses_and_jacobians_are_those_of_pinocchio(tmp_path: Path) -> None:
    pin = pytest.importorskip("pinocchio")
    for path, frame in urdfs(tmp_path):
        model = pin.buildModelFromUrdf(str(path))
        data = model.createData()
        which = model.getFrameId(frame)

        def angles(q: np.ndarray, model=model) -> np.ndarray:
            out = pin.neutral(model)
            for joint in range(1, model.njoints):
                axis, value = model.joints[joint], q[joint - 1]
                at = axis.idx_q
                out[at : at + axis.nq] = value if axis.nq == 1 else (np.cos(value), np.sin(value))
            return out

        def pose(q: np.ndarray, model=model, data=data, which=which, angles=angles) -> np.ndarray:
            pin.framesForwardKinematics(model, data, angles(q))
            return np.array(data.oMf[which].homogeneous)

        def jacobian(q: np.ndarray, model=model, data=data, which=which, angles=angles) -> np.ndarray:
            axes = pin.ReferenceFrame.LOCAL_WORLD_ALIGNED
            return np.array(pin.computeFrameJacobian(model, data, angles(q), which, axes))

        of_file = stiffarm.Robot.urdf(path, tip=frame)
        of_model = stiffarm.Robot.of_pinocchio(model, frame)
        limits = of_file.limits
        assert worst(of_file, pose, jacobian, limits) < 1e-12, path.name
        assert worst(of_model, pose, jacobian, limits) < 1e-12, path.name
        assert of_model.joint_names == [str(name) for name in model.names[1:]]
        # Of a file they are the degrees that its digits mean.
        assert np.allclose(of_model.limits, limits, atol=np.deg2rad(0.006))


def test_a_model_of_pinocchio_without_the_frame_or_with_a_slide_is_refused() -> None:
    pin = pytest.importorskip("pinocchio")
    text = OBLIQUE.replace('name="j5" type="revolute"', 'name="j5" type="prismatic"')
    with pytest.raises(stiffarm.StiffarmError, match="j5") as error:
        stiffarm.Robot.of_pinocchio(pin.buildModelFromXML(text), "tool0")
    assert error.value.code == "unsupported"
    with pytest.raises(stiffarm.StiffarmError, match="no frame") as error:
        stiffarm.Robot.of_pinocchio(pin.buildModelFromXML(OBLIQUE), "nowhere")
    assert error.value.hint is not None and "tool0" in error.value.hint


@pytest.mark.filterwarnings("ignore")
def test_poses_and_jacobians_are_those_of_the_robotics_toolbox() -> None:
    toolbox = pytest.importorskip("roboticstoolbox")
    for robot in (toolbox.models.DH.Puma560(), toolbox.models.DH.KR5(), toolbox.models.DH.UR10()):
        ours = stiffarm.Robot.of_toolbox(robot)
        limits = np.clip(ours.limits, -np.pi, np.pi)
        difference = worst(ours, lambda q, r=robot: r.fkine(q).A, lambda q, r=robot: r.jacob0(q), limits)
        assert difference < 1e-12, robot.name
        assert ours.joint_count == robot.n


def test_jax_and_casadi_differentiate_an_index() -> None:
    cell = stiffarm.Cell.built_in("comau")
    objective = stiffarm.Objective(cell, "expected_error", postures=4)
    q = np.random.default_rng(3).uniform(*cell.bounds.T, (4, 6))
    value, gradient = objective.log_and_gradient(q)
    missing = []
    try:
        import jax
    except ImportError:
        missing.append("jax")
    else:
        from stiffarm.objective import for_jax

        jax.config.update("jax_enable_x64", True)
        function = for_jax(objective)
        assert float(function(q)) == value
        twice = jax.jit(jax.value_and_grad(lambda q: 2.0 * function(q)))
        doubled, slope = twice(q)
        assert float(doubled) == pytest.approx(2 * value, rel=1e-15)
        assert np.allclose(slope, 2 * gradient, rtol=1e-14, atol=0)
    try:
        import casadi
    except ImportError:
        missing.append("casadi")
    else:
        from stiffarm.objective import for_casadi

        callback = for_casadi(objective)
        x = casadi.MX.sym("x", q.size)
        slope_of = casadi.Function("slope", [x], [casadi.gradient(3.0 * callback(x), x)])
        assert float(callback(q.ravel())) == value
        assert np.allclose(np.array(slope_of(q.ravel())).ravel(), 3 * gradient.ravel(), rtol=1e-14, atol=0)
    if missing:
        pytest.skip(f"{' and '.join(missing)} not installed; the other one passed" if len(missing) < 2 else "neither installed")
