//! Which derivatives of margins are wanted, and where they go.

/// Derivatives of margins with respect to θ, those that are wanted.
#[derive(Debug, Default)]
pub struct Slopes<'a> {
    /// A row for each margin, n long; rows that are not wanted keep what they hold.
    pub rows: &'a mut [f64],
    /// Which margins' are wanted; none where it is empty.
    pub wanted: &'a [bool],
}

impl<'a> Slopes<'a> {
    /// Those of the first `count` margins of an arm of `n` joints, and the others.
    pub(super) fn split_at(self, count: usize, n: usize) -> (Self, Self) {
        let count = count.min(self.wanted.len());
        let (rows, other_rows) = self.rows.split_at_mut(count * n);
        let (wanted, other) = self.wanted.split_at(count);
        let others = Slopes { rows: other_rows, wanted: other };
        (Slopes { rows, wanted }, others)
    }

    /// The row of a margin whose derivative is wanted.
    pub(super) fn row(&mut self, margin: usize, n: usize) -> Option<&mut [f64]> {
        let is_wanted = self.wanted.get(margin) == Some(&true);
        is_wanted.then(|| &mut self.rows[margin * n..(margin + 1) * n])
    }
}
