//! A link, a shape of the tool, or something that stands in the cell.

use crate::model::kinematics::Frames;
use crate::model::robot::Robot;
use crate::model::shape::Solid;
use nalgebra::Isometry3;

/// What a part moves with.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Carrier {
    /// Nothing: it stands in the base frame.
    World,
    /// Joint i, counted from 1: it is given in that joint's frame after its turn.
    Link(usize),
    /// The flange.
    Flange,
}

impl Carrier {
    /// Number of joints, from the base, that move it.
    pub fn moved_by(self, joints: usize) -> usize {
        match self {
            Carrier::World => 0,
            Carrier::Link(i) => i,
            Carrier::Flange => joints,
        }
    }

    /// Its frame in the base frame \[m\].
    pub fn pose(self, frames: &Frames) -> Isometry3<f64> {
        match self {
            Carrier::World => Isometry3::identity(),
            Carrier::Link(i) => frames.links()[i - 1],
            Carrier::Flange => *frames.flange(),
        }
    }
}

/// Solids that move together under one name.
#[derive(Debug, Clone, PartialEq)]
pub struct Part {
    /// Name in messages: `base`, `link 3`, `spindle`, `table`.
    pub name: String,
    /// What it moves with.
    pub carrier: Carrier,
    /// Its solids in the carrier's frame \[m\].
    pub solids: Vec<Solid>,
}

impl Part {
    /// A part of these solids in the frame of `carrier` \[m\].
    pub fn new(name: impl Into<String>, carrier: Carrier, solids: Vec<Solid>) -> Self {
        Part { name: name.into(), carrier, solids }
    }

    /// The links of a robot that have capsules: `base`, `link 1`, `link 2`, ….
    pub fn of_links(robot: &Robot) -> Vec<Self> {
        let link = |link: usize| {
            let capsules = robot.link_capsules().iter().filter(move |c| c.link == link);
            capsules.map(|c| Solid::Capsule(c.capsule)).collect::<Vec<_>>()
        };
        let all = (0..=robot.joint_count()).map(|i| (i, link(i)));
        all.filter(|(_, solids)| !solids.is_empty())
            .map(|(i, solids)| match i {
                0 => Part::new(link_name(0), Carrier::World, solids),
                i => Part::new(link_name(i), Carrier::Link(i), solids),
            })
            .collect()
    }

    /// Names of links whose capsules may overlap though the links do not collide.
    pub fn ignored_links(robot: &Robot) -> Vec<(String, String)> {
        let has_capsules = |i: usize| robot.link_capsules().iter().any(|c| c.link == i);
        let pairs = robot.ignored_pairs().iter();
        pairs
            .filter(|(i, j)| has_capsules(*i) && has_capsules(*j))
            .map(|(i, j)| (link_name(*i), link_name(*j)))
            .collect()
    }

    pub(super) fn is_tool(&self) -> bool {
        self.carrier == Carrier::Flange
    }
}

fn link_name(link: usize) -> String {
    match link {
        0 => "base".to_string(),
        i => format!("link {i}"),
    }
}
