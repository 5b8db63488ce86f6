//! Whose pendant shows the angles q.

use super::Robot;
use crate::error::{Code, Error, Result, did_you_mean};
use nalgebra::{DMatrix, Vector3};

/// Cosine beyond which two axes are parallel but for rounding.
const PARALLEL_COSINE: f64 = 1.0 - 1e-6;

/// The maker of a robot's controller.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Controller {
    /// ABB.
    Abb,
    /// COMAU.
    Comau,
    /// FANUC.
    Fanuc,
    /// KUKA.
    Kuka,
    /// Stäubli.
    Staubli,
    /// Universal Robots.
    Ur,
    /// Yaskawa (Motoman).
    Yaskawa,
    /// One that nothing more is known of here.
    Other,
}

impl Controller {
    /// All of them.
    pub const ALL: [Controller; 8] = [
        Controller::Abb,
        Controller::Comau,
        Controller::Fanuc,
        Controller::Kuka,
        Controller::Staubli,
        Controller::Ur,
        Controller::Yaskawa,
        Controller::Other,
    ];

    /// Its name in cell files and options.
    pub fn as_str(self) -> &'static str {
        match self {
            Controller::Abb => "abb",
            Controller::Comau => "comau",
            Controller::Fanuc => "fanuc",
            Controller::Kuka => "kuka",
            Controller::Staubli => "staubli",
            Controller::Ur => "ur",
            Controller::Yaskawa => "yaskawa",
            Controller::Other => "other",
        }
    }

    /// What its pendant calls an axis of the arm, counted from 0.
    pub fn axis_name(self, axis: usize) -> String {
        let letter = match self {
            Controller::Kuka => "A",
            Controller::Yaskawa => return ["S", "L", "U", "R", "B", "T", "E"][axis.min(6)].into(),
            Controller::Ur => {
                let names = ["Base", "Shoulder", "Elbow", "Wrist 1", "Wrist 2", "Wrist 3"];
                return names[axis.min(5)].into();
            }
            _ => "J",
        };
        format!("{letter}{}", axis + 1)
    }

    /// Its name for people.
    pub fn title(self) -> &'static str {
        match self {
            Controller::Abb => "ABB",
            Controller::Comau => "COMAU",
            Controller::Fanuc => "FANUC",
            Controller::Kuka => "KUKA",
            Controller::Staubli => "Stäubli",
            Controller::Ur => "Universal Robots",
            Controller::Yaskawa => "Yaskawa",
            Controller::Other => "another maker",
        }
    }

    /// Whether its pendants count joint 3 of arms with parallel axes 2 and 3 by the forearm's direction,
    /// which stays when joint 2 moves alone.
    pub fn couples_joint_3(self) -> bool {
        matches!(self, Controller::Fanuc | Controller::Comau)
    }

    /// Whether its pendants count heights from axis 2, not from the foot.
    pub fn counts_from_axis_2(self) -> bool {
        matches!(self, Controller::Fanuc | Controller::Staubli | Controller::Yaskawa)
    }

    /// The controller of this name.
    ///
    /// # Errors
    /// Unknown name; the hint has the nearest, or all.
    pub fn from_name(name: &str) -> Result<Self> {
        let names = Controller::ALL.map(Controller::as_str);
        let controller = Controller::ALL.into_iter().find(|c| c.as_str() == name);
        controller.ok_or_else(|| {
            let hint = did_you_mean(name, names).unwrap_or_else(|| format!("known controllers: {}", names.join(", ")));
            let message = format!("There is no controller \"{name}\".");
            Error::new(Code::UnknownName, message).hint(hint)
        })
    }

    /// That of a brand of the catalogue.
    pub(super) fn of_brand(brand: &str) -> Self {
        match brand {
            "ABB" => Controller::Abb,
            "Comau" => Controller::Comau,
            "FANUC" => Controller::Fanuc,
            "KUKA" => Controller::Kuka,
            "Stäubli" => Controller::Staubli,
            "Universal Robots" => Controller::Ur,
            "Yaskawa Motoman" => Controller::Yaskawa,
            _ => Controller::Other,
        }
    }

    /// The only maker whose name or models are words of a text, such as that of a robot description.
    pub fn named_in(text: &str) -> Option<Self> {
        let words = text.split(|c: char| !c.is_ascii_alphanumeric());
        let mut named = words.filter_map(|word| match word.to_ascii_lowercase().as_str() {
            "abb" => Some(Controller::Abb),
            "comau" => Some(Controller::Comau),
            "fanuc" => Some(Controller::Fanuc),
            "kuka" => Some(Controller::Kuka),
            "staubli" => Some(Controller::Staubli),
            "ur3" | "ur3e" | "ur5" | "ur5e" | "ur10" | "ur10e" | "ur16e" | "ur20" | "ur30" => Some(Controller::Ur),
            "motoman" | "yaskawa" => Some(Controller::Yaskawa),
            _ => None,
        });
        let first = named.next()?;
        named.all(|other| other == first).then_some(first)
    }
}

impl Robot {
    /// Says that the angles q are those that this controller shows.
    #[must_use]
    pub fn with_controller(mut self, controller: Controller) -> Self {
        self.origin.controller = Some(controller);
        self
    }

    /// The controller whose pendant shows the angles q: known for robots of the catalogue, and of
    /// others where somebody has said so.
    pub fn controller(&self) -> Option<Controller> {
        self.origin.controller
    }

    /// As [`controller`](Self::controller), for what leaves towards a controller or comes from it.
    ///
    /// # Errors
    /// Nothing says that the angles q are a controller's.
    pub fn known_controller(&self) -> Result<Controller> {
        self.controller().ok_or_else(|| {
            let message = "Nothing says that the angles of this cell are those that a controller shows. A robot \
                           description may count them otherwise: FANUC and COMAU couple joint 3 to joint 2.";
            Error::new(Code::MissingKey, message).key("robot.controller").hint(
                "hold a posture against the pendant (docs/robots.md), give theta_from_q where its angles differ, then \
                 write into [robot] whose it is: controller = \"abb\", \"comau\", \"fanuc\", \"kuka\", \"staubli\", \
                 \"ur\", \"yaskawa\" or \"other\"",
            )
        })
    }

    /// C of θ = offset + C q with which joint 3 keeps the forearm's direction while joint 2 moves
    /// alone, as pendants of FANUC and COMAU count it. `None` where axes 2 and 3 are not parallel, or
    /// where C couples joints already.
    pub fn level_forearm(&self) -> Option<DMatrix<f64>> {
        let coupling = self.coupling();
        let is_coupled =
            (0..coupling.nrows()).any(|i| (0..coupling.ncols()).any(|j| i != j && coupling[(i, j)] != 0.0));
        if self.joint_count() < 3 || is_coupled {
            return None;
        }
        let along = (self.joints()[2].placement.rotation * Vector3::z()).z;
        (along.abs() > PARALLEL_COSINE).then(|| {
            let mut level = coupling.clone();
            level[(2, 1)] = -along.signum() * coupling[(1, 1)];
            level
        })
    }
}
