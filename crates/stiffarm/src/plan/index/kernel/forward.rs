//! From the controller angles of four postures to their information, k(J_N)
//! and margins, with everything the reverse sweep needs.

use super::batch::Batch;
use super::lanes::{
    Lanes, Vec3, Vec6, ZERO, ZERO3, ZERO6, add, cross, dot, dot6, rotate, scale, sin_cos, six, sub, three,
};
use super::model::{KernelLoad, Model};

/// Everything that is wanted of a batch, `n` joints.
#[inline(always)]
pub(super) fn forward(model: &Model, batch: &mut Batch, n: usize) {
    frames(model, batch, n);
    points_and_load(model, batch, n);
    if model.has_information {
        // Equal numbers let the compiler unroll.
        if model.springs == n { information(model, batch, n, n) } else { information(model, batch, n, model.springs) }
    }
    if let Some(inverse_length) = model.inverse_length {
        super::dexterity::forward(batch, n, inverse_length);
    }
    if model.limit_count > 0 {
        super::limits::forward(model, batch);
    }
}

/// Axes and origins of the joints, and the last joint's frame.
#[inline(always)]
fn frames(model: &Model, batch: &mut Batch, n: usize) {
    let one = Lanes::splat(1.0);
    let mut rotation: [Vec3; 3] = three!(|c| three!(|r| if r == c { one } else { ZERO }));
    let mut origin = ZERO3;
    let (axes, origins) = (&mut batch.axes[..n], &mut batch.origins[..n]);
    let (placements, q) = (&model.placements[..n], &batch.q[..n]);
    for i in 0..n {
        let mut theta = Lanes::splat(model.offset[i]);
        for (j, factor) in &model.coupling[i] {
            theta += q[*j] * *factor;
        }
        let placement = &placements[i];
        origin = add(origin, rotate(&rotation, &placement.shift));
        // Zeros of the placement (twists about one axis) cost nothing.
        let mut placed = [ZERO3; 3];
        for (c, column) in placed.iter_mut().enumerate() {
            for k in 0..3 {
                let factor = placement.rotation[k][c];
                if factor != 0.0 {
                    *column = three!(|r| column[r] + rotation[k][r] * factor);
                }
            }
        }
        let (sin, cos) = sin_cos(theta);
        rotation = [
            three!(|r| placed[0][r] * cos + placed[1][r] * sin),
            three!(|r| placed[1][r] * cos - placed[0][r] * sin),
            placed[2],
        ];
        axes[i] = placed[2];
        origins[i] = origin;
    }
    batch.rotation = rotation;
    batch.position = origin;
}

/// Points of the tool, the load's wrench and the joint torques.
#[inline(always)]
fn points_and_load(model: &Model, batch: &mut Batch, n: usize) {
    let rotation = batch.rotation;
    let position = batch.position;
    batch.loading_point = add(position, rotate(&rotation, &model.loading_point));
    batch.centroid = add(position, rotate(&rotation, &model.centroid));
    batch.tcp = add(position, rotate(&rotation, &model.measuring_points[0]));
    match &model.load {
        KernelLoad::Rope { anchor, magnitude } => {
            // F = G (P2 − P1)/‖P2 − P1‖, Section IV.A.
            let rope: Vec3 = three!(|i| Lanes::splat(anchor[i]) - batch.loading_point[i]);
            let length = dot(&rope, &rope).sqrt();
            batch.rope_length = length;
            // A rope of no length pulls nowhere, as in the load itself.
            let inverse = Lanes::splat(1.0) / length.max(Lanes::splat(f64::MIN_POSITIVE));
            batch.rope_direction = scale(rope, inverse);
            batch.force = scale(batch.rope_direction, Lanes::splat(*magnitude));
            batch.moment = ZERO3;
        }
        KernelLoad::Base { force, moment } => {
            batch.force = force.map(Lanes::splat);
            batch.moment = moment.map(Lanes::splat);
        }
        KernelLoad::Tool { force, moment } => {
            batch.force = rotate(&rotation, force);
            batch.moment = rotate(&rotation, moment);
        }
    }
    let (axes, origins) = (&batch.axes[..n], &batch.origins[..n]);
    let columns = &mut batch.loading_columns[..n];
    let torque = &mut batch.torque[..n];
    for i in 0..n {
        columns[i] = cross(&axes[i], &sub(batch.loading_point, origins[i]));
        // Γ = (J^f)ᵀ W, Eq. (4).
        torque[i] = dot(&columns[i], &batch.force) + dot(&axes[i], &batch.moment);
    }
}

/// ΨᵀPΨ of each posture in units of the compliances, `springs` × `springs`.
///
/// All measuring points together count as their centroid, √(m(1 − ρm)) times,
/// and their second moments: Σ_a (z_j × r_aj)·(z_k × r_ak) = m c̄_j·c̄_k + z_jᵀ S z_k
/// with c̄ the columns at the centroid and S = Σ (|d|² I − d dᵀ). So six rows
/// stand for 3m, whatever the number of points.
#[inline(always)]
fn information(model: &Model, batch: &mut Batch, n: usize, springs: usize) {
    // Columns of (R·S^½)ᵀ: rows of the moments' root in base axes.
    let root: [Vec3; 3] = three!(|i| {
        three!(|r| {
            batch.rotation[0][r] * model.root_moments[0][i]
                + batch.rotation[1][r] * model.root_moments[1][i]
                + batch.rotation[2][r] * model.root_moments[2][i]
        })
    });
    batch.root = root;
    let (axes, origins) = (&batch.axes[..n], &batch.origins[..n]);
    let centre = &mut batch.centre_columns[..n];
    let columns = &mut batch.columns[..n];
    for i in 0..n {
        let column = cross(&axes[i], &sub(batch.centroid, origins[i]));
        centre[i] = column;
        columns[i] = [
            column[0] * model.root_count,
            column[1] * model.root_count,
            column[2] * model.root_count,
            dot(&root[0], &axes[i]),
            dot(&root[1], &axes[i]),
            dot(&root[2], &axes[i]),
        ];
    }
    let loads = &mut batch.spring_loads[..n];
    loads.copy_from_slice(&batch.torque[..n]);
    if let Some(mixing) = &model.mixing {
        // Columns J E⁻¹ and loads E⁻ᵀ Γ of the springs.
        let joints = &mut batch.scratch[..n];
        joints.copy_from_slice(columns);
        for s in 0..springs {
            let (mut column, mut load) = (ZERO6, ZERO);
            for i in 0..n {
                let factor = mixing[(i, s)];
                column = six!(|r| column[r] + joints[i][r] * factor);
                load += batch.torque[i] * factor;
            }
            columns[s] = column;
            loads[s] = load;
        }
    }
    let blocks = &mut batch.blocks[..springs];
    for s in 0..springs {
        // Ψ_ij = J^m_ij Γ_j, Eq. (11).
        loads[s] = loads[s] * model.compliance[s];
        blocks[s] = six!(|r| columns[s][r] * loads[s]);
    }
    let packed = &mut batch.information[..springs * (springs + 1) / 2];
    let mut at = 0;
    for s in 0..springs {
        let column: Vec6 = blocks[s];
        for t in 0..=s {
            packed[at] = dot6(&column, &blocks[t]);
            at += 1;
        }
    }
}
