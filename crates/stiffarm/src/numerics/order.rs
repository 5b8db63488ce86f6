//! Sorting by a number, and orders by it.

/// Sorts by a number, smallest first and as [`f64::total_cmp`] has it; equal ones stay as they stand. The numbers alone
/// are sorted, one function for all types: compiled anew for each, sorting was a fifteenth of the library.
pub(crate) fn sort_by_number<T>(items: &mut [T], number: impl FnMut(&T) -> f64) {
    let numbers: Vec<f64> = items.iter().map(number).collect();
    let mut from = ascending(&numbers);
    for start in 0..items.len() {
        // What stands at `from[to]` goes to `to`, around a cycle.
        let mut to = start;
        while from[to] != start {
            items.swap(to, from[to]);
            to = std::mem::replace(&mut from[to], to);
        }
        from[to] = to;
    }
}

/// The numbers below `count` in the order of what `number` has for each, as [`sort_by_number`] puts them.
pub(crate) fn order_by_number(count: usize, number: impl FnMut(usize) -> f64) -> Vec<usize> {
    let numbers: Vec<f64> = (0..count).map(number).collect();
    ascending(&numbers)
}

/// The places of the numbers, smallest first.
pub(crate) fn ascending(numbers: &[f64]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..numbers.len()).collect();
    order.sort_by(|a, b| numbers[*a].total_cmp(&numbers[*b]));
    order
}
