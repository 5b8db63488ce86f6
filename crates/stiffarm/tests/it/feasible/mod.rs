//! Random cells with obstacles, tracker, rope and torque limits: every posture that is chosen meets every
//! constraint as a second, plain reading of the cell's numbers sees it, and where none is found there is
//! next to none.
//!
//! `cargo run --release -p stiffarm --example feasible_cells -- 1000` runs as many as it is told.

pub mod arm;
pub mod cases;
pub mod checker;
pub mod compare;
pub mod distance;
pub mod routes;
pub mod run;
pub mod text;

#[test]
fn chosen_postures_meet_every_constraint() {
    use crate::common::runs::runs;
    use run::End;
    let count = runs(10);
    let mut chosen = 0;
    for number in 0..count {
        let (mode, index, end) = run::run(number);
        if let End::Fault(what) = &end {
            panic!("cell {number}, {mode:?}, {index:?}: {what}");
        }
        chosen += u64::from(matches!(end, End::Postures(_)));
    }
    // Cells that allow nothing must not crowd out the others.
    assert!(2 * chosen > count, "{chosen} of {count}");
}
