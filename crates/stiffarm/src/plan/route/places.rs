//! Places the robot may stand at, and what the moves between them cost.

/// Least gain that counts \[s\].
pub const LEAST_GAIN: f64 = 1e-9;

/// What is to be put in order: places the robot may stand at, and what a move between two costs.
pub struct Places {
    /// Which posture each place belongs to.
    pub posture: Vec<usize>,
    /// Number of postures.
    pub count: usize,
    /// Cost from place to place, symmetric.
    pub cost: Vec<Vec<f64>>,
    /// Cost from the start to each place and back, where there is a start.
    pub start: Option<Vec<f64>>,
}

impl Places {
    /// Cost of an order, from start to start where there is one.
    pub fn length(&self, order: &[usize]) -> f64 {
        let moves = order.windows(2).map(|pair| self.cost[pair[0]][pair[1]]);
        let ends = [order.first(), order.last()];
        let ends = ends.into_iter().flatten().map(|place| self.end(*place));
        moves.sum::<f64>() + ends.sum::<f64>()
    }

    /// Cost of a move between the start, or nowhere, and a place.
    pub fn end(&self, place: usize) -> f64 {
        self.start.as_ref().map_or(0.0, |start| start[place])
    }

    /// The places of each posture.
    pub fn of_postures(&self) -> Vec<Vec<usize>> {
        let mut equivalents = vec![Vec::new(); self.count];
        for (place, posture) in self.posture.iter().enumerate() {
            equivalents[*posture].push(place);
        }
        equivalents
    }
}
