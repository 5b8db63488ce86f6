//! The cell's own load turns when the arm gives way, whichever way its wrench
//! comes: held against a fixed-point iteration written for these tests.

use crate::common::prelude::*;
use stiffarm::estimate::diagnose::second_order_shares;
use stiffarm::work::predict::LoadPoint;

/// A point of the deflected arm less the same of the unloaded one, by
/// θ ← θ₀ + K⁻¹ J(θ)ᵀ W(θ), `wrench` from the frames and the loading point.
fn by_iteration(
    cell: &Cell,
    q: &[f64],
    point: &Vector3<f64>,
    wrench: impl Fn(&Frames, &Vector3<f64>) -> Wrench,
) -> Vector3<f64> {
    let robot = &cell.setup.robot;
    let stiffness = cell.require_prior().unwrap();
    let back = robot.coupling().clone().try_inverse().unwrap();
    let before = Frames::new(robot, q);
    let mut frames = before.clone();
    for _ in 0..100 {
        let at = frames.point(&cell.setup.tool.loading_point);
        let w = wrench(&frames, &at);
        let w = Vector6::new(w.force.x, w.force.y, w.force.z, w.moment.x, w.moment.y, w.moment.z);
        let torque = frames.jacobian(&at).transpose() * w;
        let give = DVector::from_fn(6, |j, _| torque[j] / stiffness[j]);
        // The controller's angles at which the joints stand there.
        let moved = DVector::from_column_slice(q) + &back * give;
        frames = Frames::new(robot, moved.as_slice());
    }
    frames.point(point) - before.point(point)
}

fn rope(cell: &Cell, force: f64) -> impl Fn(&Frames, &Vector3<f64>) -> Wrench + use<> {
    let Load::Rope { anchor, .. } = cell.setup.load else {
        panic!("the reference cell has a rope");
    };
    move |_, at| Wrench::force((anchor - at).normalize() * force)
}

fn rope_wrench(cell: &Cell, q: &[f64], factor: f64) -> Wrench {
    let terms = PostureTerms::new(&cell.setup, q, None).unwrap();
    Wrench { force: terms.wrench().force * factor, moment: terms.wrench().moment * factor }
}

fn state(q: &[f64], wrench: Option<Wrench>) -> MeasuredPosture {
    let posture = numbered([q.to_vec()]).remove(0);
    MeasuredPosture { wrench, ..MeasuredPosture::new(posture, Vec::new()) }
}

#[test]
fn a_load_state_of_the_rope_pulls_towards_the_anchor() {
    let cell = reference_cell();
    let stiffness = cell.require_prior().unwrap();
    let mut matters = 0.0_f64;
    for q in group1() {
        for factor in [0.5, 1.0, -0.2] {
            let wrench = rope_wrench(&cell, &q, factor);
            let measured = state(&q, Some(wrench));
            let ours = calculated_displacements(&cell, &measured, stiffness, Model::Equilibrium).unwrap();
            let pull = rope(&cell, cell.setup.load.size().unwrap() * factor);
            for (point, ours) in cell.setup.tool.measuring_points.iter().zip(&ours) {
                let exact = by_iteration(&cell, &q, &point.position, &pull);
                assert!((exact - ours).norm() < 1e-12, "{exact} {ours}");
                let fixed = by_iteration(&cell, &q, &point.position, |_, _| wrench);
                matters = matters.max((exact - fixed).norm());
            }
            // What `identify` says of the linear model.
            let shares = second_order_shares(&cell, &[measured], stiffness).unwrap();
            let terms = PostureTerms::new(&cell.setup, &q, Some(&wrench)).unwrap();
            let compliance = compliance_of(stiffness);
            let linear = terms.block(&cell.setup.robot) * compliance;
            let differences = cell.setup.tool.measuring_points.iter().enumerate();
            let largest = differences
                .map(|(a, p)| {
                    let exact = by_iteration(&cell, &q, &p.position, &pull);
                    (exact - linear.fixed_rows::<3>(3 * a)).norm()
                })
                .fold(0.0, f64::max);
            assert!((shares[0].linearisation_m - largest).abs() < 1e-12);
        }
    }
    assert!(matters > 5e-7, "the rope's turn is worth seeing: {matters}");
}

#[test]
fn a_prediction_under_the_cells_load_follows_it() {
    let mut cell = reference_cell();
    let mut matters = 0.0_f64;
    for tool_axes in [false, true] {
        if tool_axes {
            cell.setup.load = Load::Constant {
                wrench: Wrench { force: Vector3::new(200.0, -300.0, 500.0), moment: Vector3::new(20.0, 30.0, -40.0) },
                axes: Axes::Tool,
            };
        }
        let predictor = prior(&cell);
        let tip = cell.work.tip(&cell.setup.tool).translation.vector;
        for q in group1() {
            let posture = LoadedPosture::new("1", q.clone(), rope_wrench(&cell, &q, 1.0));
            let options = with(|o: &mut PredictOptions| o.load_at = LoadPoint::LoadingPoint);
            let prediction =
                predict(&cell, &predictor, std::slice::from_ref(&posture), &options, Control::default()).unwrap();
            let load = cell.setup.load.clone();
            let exact = by_iteration(&cell, &q, &tip, |frames, at| load.wrench(frames, at).unwrap());
            let ours = Vector3::from(prediction.points[0].shift_m);
            assert!((exact - ours).norm() < 1e-12, "{exact} {ours}");
            let fixed = by_iteration(&cell, &q, &tip, |_, _| posture.wrench);
            matters = matters.max((exact - fixed).norm());
        }
    }
    assert!(matters > 5e-7, "{matters}");
}

#[test]
fn a_measured_wrench_keeps_its_direction() {
    let cell = reference_cell();
    let stiffness = cell.require_prior().unwrap();
    for q in group1() {
        // As a sensor has it: a little off the rope's line.
        let mut wrench = rope_wrench(&cell, &q, 1.0);
        wrench.force += Vector3::new(0.3, -0.2, 0.1);
        let measured = state(&q, Some(wrench));
        let ours = calculated_displacements(&cell, &measured, stiffness, Model::Equilibrium).unwrap();
        for (point, ours) in cell.setup.tool.measuring_points.iter().zip(&ours) {
            let exact = by_iteration(&cell, &q, &point.position, |_, _| wrench);
            assert!((exact - ours).norm() < 1e-12, "{exact} {ours}");
        }
    }
}
