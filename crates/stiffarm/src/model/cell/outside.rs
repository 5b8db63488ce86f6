//! Postures that leave the bounds and limits of a cell, in words.

use super::{Cell, LimitMargin};
use crate::findings::{Finding, codes};
use crate::model::load::Load;
use crate::model::posture::Posture;
use crate::units::rad_to_sentence_deg;

/// Remarks after which no more postures are looked at.
const MOST_REMARKS: usize = 1000;

impl Cell {
    /// The remarks about postures outside bounds or limits as findings.
    pub fn posture_findings(&self, postures: &[Posture]) -> Vec<Finding> {
        let remarks = self.posture_remarks(postures).into_iter();
        let findings = remarks.map(|remark| {
            let mut sentence = remark.replacen("posture", "Posture", 1);
            sentence.push('.');
            Finding::caution(codes::POSTURE_OUTSIDE, "postures", sentence)
        });
        findings.collect()
    }

    /// Where postures leave the cell's bounds or limits, one sentence each; of very many the first ones and how many
    /// postures were not looked at any more.
    pub fn posture_remarks(&self, postures: &[Posture]) -> Vec<String> {
        let mut remarks = Vec::new();
        let has_load = self.setup.load != Load::Measured;
        let mut margins = self.posture_margins().ok().filter(|_| has_load);
        for (number, posture) in postures.iter().enumerate() {
            if remarks.len() >= MOST_REMARKS {
                remarks.push(format!(
                    "posture {} and those after it, {} in all, were not compared with bounds and limits: too many are \
                     outside",
                    posture.name,
                    postures.len() - number
                ));
                break;
            }
            for (j, angle) in self.outside_bounds(&posture.q) {
                let [low, high] = self.bounds[j].map(rad_to_sentence_deg);
                remarks.push(format!(
                    "posture {}: {} at {}° lies outside the cell's bounds, {low}° to {high}°",
                    posture.name,
                    self.setup.robot.joints()[j].name,
                    rad_to_sentence_deg(angle)
                ));
            }
            let smallest = margins.as_mut().map(|margins| margins.smallest(&posture.q));
            let smallest = smallest.and_then(|margin| margin.unwrap_or(None));
            if let Some(margin) = smallest.filter(LimitMargin::is_violated) {
                remarks.push(format!("posture {} {}", posture.name, margin.violation()));
            }
        }
        remarks
    }
}
