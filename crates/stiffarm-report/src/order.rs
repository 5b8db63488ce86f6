//! Lists in order.

/// Places of categories: 0, 1, …
pub(crate) fn places(count: usize) -> Vec<f64> {
    (0..count).map(|i| i as f64).collect()
}

/// Each value once, in the order in which they first appear.
pub(crate) fn in_order<T: PartialEq>(values: impl IntoIterator<Item = T>) -> Vec<T> {
    let mut out = Vec::new();
    for value in values {
        if !out.contains(&value) {
            out.push(value);
        }
    }
    out
}
