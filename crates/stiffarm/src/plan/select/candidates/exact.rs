//! Branch and bound over the groups of a list.

use super::LEAST_IMPROVEMENT;
use super::judge::Bounded;
use super::tangent::Tangent;
use crate::numerics::arrangements::choose;
use crate::numerics::control::Control;
use crate::numerics::order::order_by_number;

/// The best group, and what is known of all others.
pub(super) struct BestGroup {
    /// ln of the index.
    pub(super) value: f64,
    /// Ascending.
    pub(super) chosen: Vec<usize>,
    /// True when no other group is better.
    pub(super) exact: bool,
    /// Lower bound on ln of the index of all groups.
    pub(super) bound: Option<f64>,
    /// Groups compared.
    pub(super) compared: u64,
}

struct Tree<'a, J> {
    judge: &'a mut J,
    tangent: Option<&'a Tangent>,
    /// Candidates in the order of branching: largest scores first.
    order: Vec<usize>,
    count: usize,
    control: Control<'a>,
    left: u64,
    complete: bool,
}

/// Compares the groups that the tangent does not rule out, as far as that is affordable.
pub(super) fn branch_and_bound<J: Bounded>(
    judge: &mut J,
    tangent: Option<Tangent>,
    count: usize,
    of: usize,
    affordable: u64,
    control: Control<'_>,
    incumbent: &mut BestGroup,
) {
    let tangent = tangent.as_ref();
    incumbent.bound = tangent.map(|tangent| tangent.bound_of(count));
    if tangent.is_none() && choose(of as u64, count as u64) > affordable {
        return;
    }
    let order = match tangent {
        Some(tangent) => order_by_number(of, |i| -tangent.scores[i]),
        None => (0..of).collect(),
    };
    let mut tree = Tree { judge, tangent, order, count, control, left: affordable, complete: true };
    tree.branch(&mut Vec::with_capacity(count), 0, 0.0, incumbent);
    incumbent.exact = tree.complete && incumbent.value.is_finite();
    incumbent.compared = affordable - tree.left;
}

impl<J: Bounded> Tree<'_, J> {
    /// All groups that go on from `chosen` with candidates from position `from` on;
    /// `sum` are the scores of those chosen.
    fn branch(&mut self, chosen: &mut Vec<usize>, from: usize, sum: f64, incumbent: &mut BestGroup) {
        let missing = self.count - chosen.len();
        if missing == 1 {
            self.judge.hold(chosen);
        }
        for at in from..=self.order.len() - missing {
            // Scores fall along the order: what follows cannot sum to more.
            if let Some(tangent) = self.tangent {
                let next = self.order[at..at + missing].iter();
                let most = sum + next.map(|c| tangent.scores[*c]).sum::<f64>();
                if tangent.bound(most) >= incumbent.value - LEAST_IMPROVEMENT {
                    return;
                }
            }
            if self.left == 0 || (missing == 1 && self.control.stopped()) {
                self.complete = false;
                return;
            }
            let candidate = self.order[at];
            if missing == 1 {
                self.left -= 1;
                let value = self.judge.with(candidate);
                if value < incumbent.value - LEAST_IMPROVEMENT {
                    incumbent.value = value;
                    incumbent.chosen = chosen.iter().copied().chain([candidate]).collect();
                    incumbent.chosen.sort_unstable();
                }
                continue;
            }
            let score = self.tangent.map_or(0.0, |tangent| tangent.scores[candidate]);
            chosen.push(candidate);
            self.branch(chosen, at + 1, sum + score, incumbent);
            chosen.pop();
            if !self.complete {
                return;
            }
        }
    }
}
