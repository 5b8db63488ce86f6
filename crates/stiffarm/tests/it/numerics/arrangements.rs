//! Subsets and orders are all there, each once.

use stiffarm::internals::arrangements::{choose, exchanges_first, next_subset, orders, set};
use stiffarm::plan::select::drop_evaluations;

#[test]
fn sets_come_in_order_and_once() {
    for (count, size) in [(7, 2), (9, 3)] {
        let all: Vec<Vec<usize>> = (0..choose(count, size)).map(|i| set(i, size)).collect();
        for (i, one) in all.iter().enumerate() {
            assert!(one.windows(2).all(|w| w[0] < w[1]), "{one:?}");
            assert!(one.iter().all(|x| *x < count as usize));
            assert!(all[..i].iter().all(|other| other != one));
        }
    }
    assert_eq!(set(choose(5000, 3) - 1, 3), [4997, 4998, 4999]);
}

#[test]
fn subsets_are_all_visited_once() {
    for (of, count) in [(5, 1), (5, 2), (6, 3), (4, 4)] {
        let mut subset: Vec<usize> = (0..count).collect();
        let mut seen = vec![subset.clone()];
        while next_subset(&mut subset, of) {
            seen.push(subset.clone());
        }
        assert_eq!(seen.len() as u64, choose(of as u64, count as u64), "{count} of {of}");
        seen.dedup();
        assert_eq!(seen.len() as u64, choose(of as u64, count as u64));
    }
    // Too many are dropped one after the other.
    assert_eq!(drop_evaluations(60, 30), (31..=60).sum::<usize>());
}

#[test]
fn orders_are_the_exchanges_first_and_then_the_rest() {
    let four = exchanges_first(4);
    assert_eq!(four.len(), 23);
    assert_eq!(four[0], [1, 0, 2, 3]);
    let moved = |order: &[usize]| (0..4).filter(|i| order[*i] != *i).count();
    assert!(four[..6].iter().all(|o| moved(o) == 2));
    assert!(four[6..].iter().all(|o| moved(o) > 2));
    assert_eq!(exchanges_first(5).len(), 10);
}

#[test]
fn orders_are_all_but_the_natural_one() {
    assert_eq!(orders(2), [[1, 0]]);
    let three = orders(3);
    assert_eq!(three.len(), 5);
    assert!(!three.contains(&vec![0, 1, 2]));
}
