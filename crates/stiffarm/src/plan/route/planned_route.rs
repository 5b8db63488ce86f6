//! What a route is.

use crate::model::cell::LimitKind;
use serde::{Deserialize, Serialize};

/// How a route is looked for.
#[derive(Debug, Clone, Default)]
#[non_exhaustive]
pub struct RouteOptions {
    /// Keeps the postures in their order.
    pub keep_order: bool,
    /// Keeps their angles; else equivalent postures may stand in.
    pub keep_angles: bool,
    /// Looks for no equivalents with the wrist the other way round: they have the same axes, but an arm that gives
    /// way beyond them bends otherwise.
    pub keep_wrist: bool,
    /// Steps of which the plan's angles are whole multiples \[deg\], where they are.
    pub step_deg: Option<f64>,
    /// Seed of the random numbers.
    pub seed: u64,
}

/// Postures in measuring order with the moves between them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Route {
    /// For each stop the position of its posture in the plan.
    pub order: Vec<usize>,
    /// The stops, controller angles \[rad\]: the plan's postures or equivalents of them.
    #[serde(rename = "postures_deg", with = "crate::units::degrees")]
    #[cfg_attr(feature = "schema", schemars(with = "Vec<Vec<f64>>"))]
    pub postures: Vec<Vec<f64>>,
    /// Groups of stops that measure the same, also in different equivalents: what is measured more than once.
    pub repeats: Vec<Vec<usize>>,
    /// Stops whose angles differ from the plan's.
    pub turned: Vec<usize>,
    /// The moves: to each stop from the one before; with a start also from it and back to it.
    pub moves: Vec<RouteMove>,
    /// Time of all moves at the speed of the cell \[s\], without speeding up and slowing down; `None` where
    /// joint speeds are not known or a way is missing.
    pub travel_s: Option<f64>,
    /// Sum over all moves of the largest turn of a joint \[rad\].
    #[serde(rename = "turn_deg", with = "crate::units::degrees")]
    #[cfg_attr(feature = "schema", schemars(with = "f64"))]
    pub turn: f64,
    /// What moves are kept clear of.
    pub checked: Vec<LimitKind>,
    /// Whether no order is shorter; `None` where the order was given.
    pub shortest: Option<bool>,
}

/// One move of a route.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RouteMove {
    /// Stop it begins at; `None` is the start.
    pub from: Option<usize>,
    /// Stop it ends at; `None` is the start.
    pub to: Option<usize>,
    /// Via postures, controller angles \[rad\].
    #[serde(rename = "via_deg", with = "crate::units::degrees")]
    #[cfg_attr(feature = "schema", schemars(with = "Vec<Vec<f64>>"))]
    pub via: Vec<Vec<f64>>,
    /// Joints, counted from 0, that the last leg leaves on the side to which the load turns them: of a cell that has
    /// `[route] approach_deg`.
    pub approached: Vec<usize>,
    /// Whether the move, over its via postures, is free; `false` asks for a way of your own.
    pub free: bool,
    /// Time at the speed of the cell \[s\], where joint speeds are known.
    pub time_s: Option<f64>,
    /// Largest turn of a joint, summed over its legs \[rad\].
    #[serde(rename = "turn_deg", with = "crate::units::degrees")]
    #[cfg_attr(feature = "schema", schemars(with = "f64"))]
    pub turn: f64,
    /// What comes nearest on the way; `None` where there is nothing to touch.
    pub nearest: Option<NearestOnTheWay>,
}

/// What comes nearest on a move.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct NearestOnTheWay {
    /// Kind of limit.
    pub kind: LimitKind,
    /// What comes nearest: two shapes, a point.
    pub subject: String,
    /// Distance \[m\]: of shapes from each other, of a point from the limit. Never more than the truth: a bound that is
    /// proved, mostly to 0.01 mm.
    pub distance_m: f64,
}
