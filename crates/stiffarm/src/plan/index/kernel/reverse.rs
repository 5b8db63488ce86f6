//! The derivative of a function of information, k(J_N) and limits with respect
//! to the angles of four postures, by one sweep backwards.

use super::batch::Batch;
use super::lanes::{Lanes, Vec3, Vec6, ZERO, ZERO3, ZERO6, add, cross, dot, dot6, scale, six, sub, three};
use super::model::{KernelLoad, Model};

/// Fills `batch.gradient` (with respect to θ) from `batch.adjoint`,
/// `batch.dexterity_weight` and the penalty of the limits.
#[inline(always)]
pub(super) fn reverse(model: &Model, batch: &mut Batch, n: usize) {
    batch.gradient[..n].fill(ZERO);
    batch.axis_adjoint[..n].fill(ZERO3);
    batch.anchor_gradient = ZERO3;
    batch.loading_gradient = ZERO3;
    if let Some(inverse_length) = model.inverse_length {
        let weight = batch.dexterity_weight;
        super::dexterity::adjoint(batch, n, inverse_length, weight);
        add_column_gradient(
            &batch.axes[..n],
            &batch.tcp_columns[..n],
            &batch.tcp_adjoint[..n],
            &mut batch.gradient[..n],
        );
    }
    if model.has_information {
        // Equal numbers let the compiler unroll.
        if model.springs == n { information(model, batch, n, n) } else { information(model, batch, n, model.springs) }
    }
    add_axis_gradient(&batch.axes[..n], &batch.axis_adjoint[..n], &mut batch.gradient[..n]);
    if model.limit_count > 0 {
        super::limits::add_gradient(batch, n);
        // The rope's length changes with both of its ends; a loading point that
        // moves in the tool takes its own limits along.
        batch.anchor_gradient = sub(batch.anchor_gradient, batch.rope_force);
        batch.loading_gradient = add(batch.loading_gradient, batch.loading_force);
    }
}

/// Through d⟨A, G⟩ = 2⟨B A, dB⟩, columns and loads of `count` springs.
#[inline(always)]
fn information(model: &Model, batch: &mut Batch, n: usize, count: usize) {
    let blocks = &batch.blocks[..count];
    let adjoint = &batch.adjoint[..count * count];
    // Adjoints of the springs' columns and loads.
    let column_adjoint = &mut batch.scratch[..n];
    let torque_adjoint = &mut batch.torque_adjoint[..n];
    for s in 0..count {
        let mut x = ZERO6;
        for t in 0..count {
            let factor = adjoint[s * count + t];
            x = six!(|r| x[r] + blocks[t][r] * factor);
        }
        let x: Vec6 = six!(|r| x[r] + x[r]);
        torque_adjoint[s] = dot6(&batch.columns[s], &x) * model.compliance[s];
        column_adjoint[s] = six!(|r| x[r] * batch.spring_loads[s]);
    }
    if let Some(mixing) = &model.mixing {
        let springs = &mut batch.spring_adjoint[..n];
        springs.copy_from_slice(column_adjoint);
        let loads = &mut batch.load_adjoint[..n];
        loads.copy_from_slice(torque_adjoint);
        for i in 0..n {
            let (mut column, mut load) = (ZERO6, ZERO);
            for s in 0..count {
                let factor = mixing[(i, s)];
                column = six!(|r| column[r] + springs[s][r] * factor);
                load += loads[s] * factor;
            }
            column_adjoint[i] = column;
            torque_adjoint[i] = load;
        }
    }
    // Rows 0–2 are √m' times the columns at the centroid; rows 3–5 turn an
    // axis into the frame of the tool: d(Rᵀ z_i) = Rᵀ(z_i × z_k) for k > i.
    let root = batch.root;
    let axes = &batch.axes[..n];
    for i in 0..n {
        let a: [Lanes; 6] = column_adjoint[i];
        batch.centre_adjoint[i] = three!(|r| a[r] * model.root_count);
        batch.moment_adjoint[i] = three!(|r| root[0][r] * a[3] + root[1][r] * a[4] + root[2][r] * a[5]);
    }
    add_column_gradient(axes, &batch.centre_columns[..n], &batch.centre_adjoint[..n], &mut batch.gradient[..n]);
    let mut behind = ZERO3;
    for k in 0..n {
        batch.gradient[k] += dot(&axes[k], &behind);
        behind = add(behind, cross(&batch.moment_adjoint[k], &axes[k]));
    }
    torques(model, batch, n);
}

/// Through Γ_i = c_i · F + z_i · M at the loading point.
#[inline(always)]
fn torques(model: &Model, batch: &mut Batch, n: usize) {
    let axes = &batch.axes[..n];
    let columns = &batch.loading_columns[..n];
    let torque_adjoint = &batch.torque_adjoint[..n];
    let force = batch.force;
    // Σ_{i<k} Γ̄_i F × z_i and Σ_{i≥k} Γ̄_i c_i × F.
    let mut axis_sum = ZERO3;
    for k in 0..n {
        batch.gradient[k] += dot(&columns[k], &cross(&force, &axis_sum));
        axis_sum = add(axis_sum, scale(axes[k], torque_adjoint[k]));
    }
    let mut column_sum = ZERO3;
    for k in (0..n).rev() {
        column_sum = add(column_sum, scale(columns[k], torque_adjoint[k]));
        batch.gradient[k] += dot(&axes[k], &cross(&column_sum, &force));
    }
    // A moved loading point changes Γ_i by z_i × δ · F.
    let by_point = cross(&force, &axis_sum);
    batch.loading_gradient = add(batch.loading_gradient, by_point);
    match &model.load {
        KernelLoad::Rope { magnitude, .. } => {
            // dF = (G/ℓ)(I − u uᵀ)(dP2 − dP1).
            let u = batch.rope_direction;
            let across: Vec3 = sub(column_sum, scale(u, dot(&u, &column_sum)));
            let length = batch.rope_length.max(Lanes::splat(f64::MIN_POSITIVE));
            let by_anchor = scale(across, Lanes::splat(*magnitude) / length);
            for k in 0..n {
                batch.gradient[k] -= dot(&columns[k], &by_anchor);
            }
            batch.anchor_gradient = add(batch.anchor_gradient, by_anchor);
            batch.loading_gradient = sub(batch.loading_gradient, by_anchor);
        }
        KernelLoad::Base { .. } => moments(batch, n),
        KernelLoad::Tool { .. } => {
            moments(batch, n);
            let turn = add(cross(&force, &column_sum), cross(&batch.moment, &axis_sum));
            for k in 0..n {
                batch.gradient[k] += dot(&batch.axes[k], &turn);
            }
        }
    }
}

/// The axes' share z_i · M of the torques.
#[inline(always)]
fn moments(batch: &mut Batch, n: usize) {
    for i in 0..n {
        let by_axis = scale(batch.moment, batch.torque_adjoint[i]);
        batch.axis_adjoint[i] = add(batch.axis_adjoint[i], by_axis);
    }
}

/// Derivative of Σ a_i · c_i: for each k, z_k · Σ_{i≥k} c_i × a_i + c_k · Σ_{i<k} a_i × z_i.
#[inline(always)]
fn add_column_gradient(axes: &[Vec3], columns: &[Vec3], adjoints: &[Vec3], gradient: &mut [Lanes]) {
    let n = axes.len();
    let mut behind = ZERO3;
    for k in 0..n {
        gradient[k] += dot(&columns[k], &behind);
        behind = add(behind, cross(&adjoints[k], &axes[k]));
    }
    let mut ahead = ZERO3;
    for k in (0..n).rev() {
        ahead = add(ahead, cross(&columns[k], &adjoints[k]));
        gradient[k] += dot(&axes[k], &ahead);
    }
}

/// Derivative of Σ a_i · z_i: for each k, z_k · Σ_{i>k} z_i × a_i.
#[inline(always)]
fn add_axis_gradient(axes: &[Vec3], adjoints: &[Vec3], gradient: &mut [Lanes]) {
    let mut ahead = ZERO3;
    for k in (0..axes.len()).rev() {
        gradient[k] += dot(&axes[k], &ahead);
        ahead = add(ahead, cross(&axes[k], &adjoints[k]));
    }
}
