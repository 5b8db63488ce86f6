//! Exchange: groups from a list of candidates, improved by swapping one posture at a time
//! for the best candidate (Fedorov 1972, after Mitchell's variants).

/// Judges groups that differ in one posture.
pub(super) trait Judge {
    /// Fixes all postures of a group but one.
    fn hold(&mut self, rest: &[usize]);
    /// ln of the index (of its reciprocal for O1 to O5) of those held and `candidate`,
    /// infinite where it does not exist.
    fn with(&mut self, candidate: usize) -> f64;
}

/// How to exchange.
pub(super) struct Exchange<'a> {
    /// Most passes over all postures of a group.
    pub passes: usize,
    /// Improvement of ln(index) below which a swap is not worth it.
    pub least: f64,
    /// Whether a candidate may stand in a group twice.
    pub repeats: bool,
    /// When to stop.
    pub stop: &'a (dyn Fn() -> bool + Sync),
}

impl Exchange<'_> {
    /// Swaps postures of `group` for `candidates` as long as that lowers the index;
    /// returns ln of the index, infinite where none was found.
    pub fn run(&self, judge: &mut impl Judge, group: &mut [usize], candidates: &[usize]) -> f64 {
        let mut value = f64::INFINITY;
        let mut rest = Vec::with_capacity(group.len());
        for _ in 0..self.passes {
            let mut swapped = false;
            for p in 0..group.len() {
                if (self.stop)() {
                    return value;
                }
                rest.clear();
                rest.extend((0..group.len()).filter(|o| *o != p).map(|o| group[o]));
                judge.hold(&rest);
                let mut best = (judge.with(group[p]), group[p]);
                for candidate in candidates {
                    if !self.repeats && rest.contains(candidate) {
                        continue;
                    }
                    let other = judge.with(*candidate);
                    if other < best.0 - self.least {
                        best = (other, *candidate);
                    }
                }
                swapped |= best.1 != group[p];
                (value, group[p]) = best;
            }
            if !swapped {
                break;
            }
        }
        value
    }
}
