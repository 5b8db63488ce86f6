//! How the robot drives from posture to posture.

/// Share of the largest joint speeds that a measuring robot drives at, unless the cell says otherwise.
const SPEED_SHARE: f64 = 0.1;

/// What a cell says of the drive from posture to posture.
#[derive(Debug, Clone, PartialEq)]
pub struct RouteSettings {
    /// Largest speed of each joint \[rad/s\], where they are known.
    pub joint_speeds: Option<Vec<f64>>,
    /// Share of them that is driven at, above 0 and at most 1.
    pub speed_share: f64,
    /// Where the robot stands before and after, controller angles \[rad\]: a safe posture.
    pub start: Option<Vec<f64>>,
    /// Turn of each joint beyond a posture, to the side to which the load turns it, from which the posture is reached
    /// \[rad\]: takes up lost motion. `None` where postures are reached from wherever the robot comes.
    pub approach: Option<f64>,
    /// Whether the load stays on between postures; else each move is made without it.
    pub load_stays_on: bool,
}

impl Default for RouteSettings {
    fn default() -> Self {
        RouteSettings {
            joint_speeds: None,
            speed_share: SPEED_SHARE,
            start: None,
            approach: None,
            load_stays_on: false,
        }
    }
}
