//! Poses and postures as people read them.

use super::Job;
use crate::finding::wrapped_line;
use crate::input::Line;
use crate::numbers::coarse_mm;
use crate::screen::{columns, wrapped};
use crate::table::{Align, Table, title};
use nalgebra::Isometry3;
use stiffarm::ask::pose::{BranchPosture, NamedPosture, Pose, PoseFrame, PoseSolutions, Poses};
use stiffarm::findings::Finding;
use stiffarm::model::pose::Convention;
use stiffarm::units::{rad_to_deg, roll_pitch_yaw};

impl Job<'_> {
    /// First lines of both tables.
    fn heading(&self, findings: &[Finding]) -> String {
        let mut out = self.named.line();
        for finding in findings {
            out += &(wrapped_line(finding) + "\n");
        }
        out += &format!("orientation: {} ({})\n", self.request.convention.describe(), self.request.convention.as_str());
        let base = self.request.frame_in(self.cell());
        let frame = match self.request.frame {
            PoseFrame::Cell => "the cell's base frame".to_string(),
            PoseFrame::Controller if self.request.height_left_out(self.cell()).is_some() => {
                "the cell's base frame; the pendant counts z from axis 2".to_string()
            }
            PoseFrame::Controller if base == Isometry3::identity() => {
                "the controller's base frame, which is the cell's".to_string()
            }
            PoseFrame::Controller => {
                let p: Vec<String> = base.translation.vector.iter().map(|v| coarse_mm(*v)).collect();
                let turns = roll_pitch_yaw(&base.rotation).map(|angle| fixed(rad_to_deg(angle), 1));
                let turned = if base.rotation.angle() > 1e-9 {
                    format!(", turned by {} deg about x, y, z", turns.join(", "))
                } else {
                    String::new()
                };
                format!("the controller's base frame, ({}) mm in the cell's{turned}", p.join(", "))
            }
        };
        out + &wrapped(&format!("frame: {frame}"), columns()) + "\n"
    }

    pub(super) fn table_of_poses(&self, result: &Poses) -> String {
        let mut out = self.heading(&result.findings);
        let tip = self.cell().work.tip(&self.cell().setup.tool).translation.vector;
        let tip: Vec<String> = tip.iter().map(|v| coarse_mm(*v)).collect();
        out += &title("Flange");
        out += &self.poses(result.postures.iter().map(|p| (&p.posture.name, &p.flange)));
        out += &title(&format!("Tool tip, ({}) mm in flange axes", tip.join(", ")));
        out += &self.poses(result.postures.iter().map(|p| (&p.posture.name, &p.tip)));
        let described: Vec<&NamedPosture> = result.postures.iter().map(|p| &p.posture).collect();
        out + &configurations(&described, None)
    }

    fn poses<'p>(&self, poses: impl Iterator<Item = (&'p String, &'p Pose)>) -> String {
        if self.request.convention == Convention::Matrix {
            return matrices(poses);
        }
        let shown = self.request.convention.columns().iter();
        let angles = shown.map(|column| match column.rsplit_once('_') {
            Some((name, unit)) => format!("{name} [{unit}]"),
            None => (*column).to_string(),
        });
        let position = ["posture", "x [mm]", "y [mm]", "z [mm]"].map(String::from);
        let mut table = Table::new(position.into_iter().chain(angles));
        let decimals: usize = match self.request.convention {
            Convention::Abb => 6,
            Convention::Ur => 5,
            _ => 4,
        };
        for (name, pose) in poses {
            let position = pose.position_mm.iter().map(|v| fixed(*v, 3));
            let orientation = pose.orientation.iter().map(|v| fixed(*v, decimals));
            let numbers = position.chain(orientation);
            table.row(std::iter::once(name.clone()).chain(numbers));
        }
        table.to_string()
    }

    pub(super) fn table_of_postures(&self, result: &PoseSolutions) -> String {
        let mut out = self.heading(&result.findings);
        out += &format!("inverse kinematics: {}\n", result.method);
        // One of each branch, with how many there are: the others have its name with a point.
        let mut shown: Vec<&BranchPosture> = Vec::new();
        let mut turns: Vec<usize> = Vec::new();
        for pose in &result.poses {
            let mut last = None;
            for posture in &pose.postures {
                match turns.last_mut() {
                    Some(count) if last == Some(posture.branch) => *count += 1,
                    _ => {
                        shown.push(posture);
                        turns.push(1);
                    }
                }
                last = Some(posture.branch);
            }
        }
        if shown.is_empty() {
            return out;
        }
        out += &title("Postures [deg]");
        let joints = 1..=self.cell().setup.robot.joint_count();
        let headings = joints.map(|j| format!("q{j}"));
        let mut table = Table::new(std::iter::once("posture".to_string()).chain(headings));
        for posture in &shown {
            let angles = posture.posture.q_deg.iter().map(|q| fixed(*q, 3));
            table.row(std::iter::once(posture.posture.name.clone()).chain(angles));
        }
        out += &table.to_string();
        let described: Vec<&NamedPosture> = shown.iter().map(|p| &p.posture).collect();
        out += &configurations(&described, Some(&turns));
        for posture in shown.iter().filter(|p| p.is_singular) {
            let said =
                format!("note: {}: singular: where angles are free it stands for all of them", posture.posture.name);
            out += &(wrapped(&said, columns()) + "\n");
        }
        if turns.iter().any(|count| *count > 1) {
            let said = "turns: postures that differ by full turns of joints alone; --output and --json have them all";
            out += &(wrapped(said, columns()) + "\n");
        }
        out
    }
}

/// Configurations, KUKA's Status and Turn, and how many postures differ by
/// full turns; nothing where nothing of it is known.
fn configurations(postures: &[&NamedPosture], turns: Option<&[usize]>) -> String {
    let words = postures.iter().any(|p| p.configuration.is_some());
    let kuka = postures.iter().any(|p| p.kuka_status.is_some());
    if !words && turns.is_none() {
        return String::new();
    }
    let mut headings = vec!["posture"];
    headings.extend(words.then_some("configuration"));
    headings.extend(kuka.then_some(["S", "T"]).into_iter().flatten());
    headings.extend(turns.map(|_| "turns"));
    let mut table = Table::new(headings);
    if words {
        table.align(1, Align::Left);
    }
    for (i, posture) in postures.iter().enumerate() {
        let mut row = vec![posture.name.clone()];
        if words {
            let words = posture.configuration.map(|c| c.words());
            row.push(words.unwrap_or_default());
        }
        if kuka {
            let bits = [
                posture.kuka_status.map(|s| format!("{s} (B{s:03b})")),
                posture.kuka_turn.map(|t| format!("{t} (B{t:06b})")),
            ];
            row.extend(bits.map(Option::unwrap_or_default));
        }
        row.extend(turns.map(|turns| turns[i].to_string()));
        table.row(row);
    }
    title("Configuration") + &table.to_string()
}

/// Matrices in three rows each, their last column the position.
fn matrices<'p>(poses: impl Iterator<Item = (&'p String, &'p Pose)>) -> String {
    let mut table = Table::new(["posture", "axis", "x axis", "y axis", "z axis", "position [mm]"]);
    table.align(1, Align::Left);
    for (name, pose) in poses {
        for (i, axis) in ["x", "y", "z"].into_iter().enumerate() {
            let row = pose.orientation.iter().skip(3 * i).take(3);
            let mut fields = vec![if i == 0 { name.clone() } else { String::new() }];
            fields.push(axis.to_string());
            fields.extend(row.map(|v| fixed(*v, 6)));
            fields.push(fixed(pose.position_mm[i], 3));
            table.row(fields);
        }
    }
    table.to_string()
}

/// With so many decimals, never −0.
fn fixed(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    match text.strip_prefix('-') {
        Some(rest) if rest.chars().all(|c| "0.".contains(c)) => rest.to_string(),
        _ => text,
    }
}
