//! Everything of four postures: inputs, what the forward sweep leaves for the
//! reverse one, and results. Allocated once.

use super::lanes::{Lanes, Vec3, Vec6, ZERO, ZERO3, ZERO6};
use super::model::Model;

#[derive(Debug, Clone)]
pub(super) struct Batch {
    /// Controller angles.
    pub q: Vec<Lanes>,
    // Forward: kinematics and load.
    pub axes: Vec<Vec3>,
    pub origins: Vec<Vec3>,
    pub rotation: [Vec3; 3],
    pub position: Vec3,
    pub loading_point: Vec3,
    pub centroid: Vec3,
    pub tcp: Vec3,
    pub rope_length: Lanes,
    pub rope_direction: Vec3,
    pub force: Vec3,
    pub moment: Vec3,
    pub loading_columns: Vec<Vec3>,
    pub torque: Vec<Lanes>,
    // Forward: information.
    pub root: [Vec3; 3],
    pub centre_columns: Vec<Vec3>,
    pub columns: Vec<Vec6>,
    pub scratch: Vec<Vec6>,
    pub spring_loads: Vec<Lanes>,
    pub blocks: Vec<Vec6>,
    /// Lower triangle, row by row.
    pub information: Vec<Lanes>,
    // Forward: dexterity.
    pub tcp_columns: Vec<Vec3>,
    pub normalised: Vec<Vec6>,
    pub orthogonal: Vec<Vec6>,
    pub inverse: [Vec6; 6],
    pub trace: Lanes,
    pub inverse_trace: Lanes,
    // Forward: limits.
    pub penalty_weight: f64,
    pub penalty_guard: f64,
    pub multipliers: Vec<Lanes>,
    pub margins: Vec<Lanes>,
    pub penalty: Lanes,
    pub violation: Lanes,
    pub limit_force: Vec3,
    pub limit_moment: Vec3,
    /// Derivative of the penalty by a loading point that moves in the tool, and by the rope's length.
    pub loading_force: Vec3,
    pub rope_force: Vec3,
    pub wrist: Vec3,
    pub wrist_force: Vec3,
    // Forward: the scene's limits; derivatives of their penalty by θ, anchor and loading point (base axes).
    pub scene_gradient: Vec<Lanes>,
    pub scene_anchor: Vec3,
    pub scene_loading: Vec3,
    // Reverse.
    /// Derivative of the index by the information, springs × springs by columns.
    pub adjoint: Vec<Lanes>,
    pub dexterity_weight: Lanes,
    pub tcp_adjoint: Vec<Vec3>,
    pub axis_adjoint: Vec<Vec3>,
    pub centre_adjoint: Vec<Vec3>,
    pub moment_adjoint: Vec<Vec3>,
    pub torque_adjoint: Vec<Lanes>,
    pub spring_adjoint: Vec<Vec6>,
    pub load_adjoint: Vec<Lanes>,
    /// With respect to θ.
    pub gradient: Vec<Lanes>,
    /// With respect to the rope's anchor, base axes.
    pub anchor_gradient: Vec3,
    /// With respect to the loading point, base axes.
    pub loading_gradient: Vec3,
}

impl Batch {
    /// Room for `margins` margins of limits per posture.
    pub fn new(model: &Model, margins: usize) -> Self {
        let n = model.joints;
        let (lanes, vec3, vec6) = (vec![ZERO; n], vec![ZERO3; n], vec![ZERO6; n]);
        Batch {
            q: lanes.clone(),
            axes: vec3.clone(),
            origins: vec3.clone(),
            rotation: [ZERO3; 3],
            position: ZERO3,
            loading_point: ZERO3,
            centroid: ZERO3,
            tcp: ZERO3,
            rope_length: ZERO,
            rope_direction: ZERO3,
            force: ZERO3,
            moment: ZERO3,
            loading_columns: vec3.clone(),
            torque: lanes.clone(),
            root: [ZERO3; 3],
            centre_columns: vec3.clone(),
            columns: vec6.clone(),
            scratch: vec6.clone(),
            spring_loads: lanes.clone(),
            blocks: vec6.clone(),
            information: vec![ZERO; model.springs * (model.springs + 1) / 2],
            tcp_columns: vec3.clone(),
            normalised: vec6.clone(),
            orthogonal: vec6.clone(),
            inverse: [ZERO6; 6],
            trace: ZERO,
            inverse_trace: ZERO,
            penalty_weight: 1.0,
            penalty_guard: 0.0,
            multipliers: vec![ZERO; margins],
            margins: vec![ZERO; margins],
            penalty: ZERO,
            violation: ZERO,
            limit_force: ZERO3,
            limit_moment: ZERO3,
            loading_force: ZERO3,
            rope_force: ZERO3,
            wrist: ZERO3,
            wrist_force: ZERO3,
            scene_gradient: lanes.clone(),
            scene_anchor: ZERO3,
            scene_loading: ZERO3,
            adjoint: vec![ZERO; model.springs * model.springs],
            dexterity_weight: ZERO,
            tcp_adjoint: vec3.clone(),
            axis_adjoint: vec3.clone(),
            centre_adjoint: vec3.clone(),
            moment_adjoint: vec3,
            torque_adjoint: lanes.clone(),
            spring_adjoint: vec6,
            load_adjoint: lanes.clone(),
            gradient: lanes,
            anchor_gradient: ZERO3,
            loading_gradient: ZERO3,
        }
    }

    /// Adds the derivatives of the scene's penalty to those of a reverse sweep.
    pub fn add_scene(&mut self) {
        for (sum, slope) in self.gradient.iter_mut().zip(&self.scene_gradient) {
            *sum += *slope;
        }
        for axis in 0..3 {
            self.anchor_gradient[axis] += self.scene_anchor[axis];
            self.loading_gradient[axis] += self.scene_loading[axis];
        }
    }
}
