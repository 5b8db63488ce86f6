//! Subsets and orders of a few numbers, and of axes.

use nalgebra::Matrix3;

/// Most numbers that are put in every order, not only exchanged by twos.
const ALL_ORDERS: usize = 4;

/// Number of sets of `size` of `count`, or as many as a number holds.
pub fn choose(count: u64, size: u64) -> u64 {
    if size > count {
        return 0;
    }
    let all = (0..size.min(count - size))
        .fold(1_u128, |product, i| product.saturating_mul(u128::from(count - i)) / u128::from(i + 1));
    u64::try_from(all).unwrap_or(u64::MAX)
}

/// Set number `rank` of `size` numbers, ascending, in the order in which all sets
/// of smaller numbers come first.
pub fn set(mut rank: u64, size: u64) -> Vec<usize> {
    let mut out = Vec::new();
    for size in (1..=size).rev() {
        // The largest c with choose(c, size) ≤ rank.
        let (mut low, mut high) = (size - 1, size);
        while choose(high, size) <= rank {
            high *= 2;
        }
        while low + 1 < high {
            let middle = u64::midpoint(low, high);
            *if choose(middle, size) <= rank { &mut low } else { &mut high } = middle;
        }
        rank -= choose(low, size);
        out.push(low as usize);
    }
    out.reverse();
    out
}

/// The next subset in lexicographic order; false after the last.
pub fn next_subset(subset: &mut [usize], of: usize) -> bool {
    let count = subset.len();
    let Some(at) = (0..count).rev().find(|i| subset[*i] + count - i < of) else {
        return false;
    };
    subset[at] += 1;
    for i in at + 1..count {
        subset[i] = subset[i - 1] + 1;
    }
    true
}

/// All orders of `count` numbers but the natural one.
pub fn orders(count: usize) -> Vec<Vec<usize>> {
    let mut all: Vec<Vec<usize>> = vec![Vec::new()];
    for _ in 0..count {
        let mut longer = Vec::new();
        for start in &all {
            for i in (0..count).filter(|i| !start.contains(i)) {
                longer.push([&start[..], &[i]].concat());
            }
        }
        all = longer;
    }
    // The first is the natural one.
    all.split_off(1)
}

/// Orders in which `count` labels can be mixed up: all exchanges of two first, then, of few
/// labels, every other order. `order[a]` is what the label `a` really belongs to.
pub fn exchanges_first(count: usize) -> Vec<Vec<usize>> {
    let natural: Vec<usize> = (0..count).collect();
    let mut out = Vec::new();
    for b in 0..count {
        for a in 0..b {
            let mut order = natural.clone();
            order.swap(a, b);
            out.push(order);
        }
    }
    if count <= ALL_ORDERS {
        let others = orders(count).into_iter();
        let others: Vec<_> = others.filter(|order| !out.contains(order)).collect();
        out.extend(others);
    }
    out
}

/// All signed exchanges of three axes: 24 turns and as many with a mirror.
pub fn signed_axes() -> impl Iterator<Item = Matrix3<f64>> {
    const ORDERS: [[usize; 3]; 6] = [[0, 1, 2], [1, 0, 2], [2, 1, 0], [0, 2, 1], [1, 2, 0], [2, 0, 1]];
    ORDERS.into_iter().flat_map(|order| {
        (0..8_u32).map(move |signs| {
            let sign = |i: usize| if signs >> i & 1 == 1 { -1.0 } else { 1.0 };
            Matrix3::from_fn(|i, j| if order[i] == j { sign(i) } else { 0.0 })
        })
    })
}
