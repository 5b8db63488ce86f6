//! A load that a search moves gives the values of the moved cell, and derivatives of differences.

use crate::common::differences::assert_gradient;
use crate::common::prelude::*;
use stiffarm::plan::characteristic_length::with_characteristic_length;

#[test]
fn derivatives_by_anchor_and_loading_point_are_those_of_differences() {
    let mut cell = with_characteristic_length(builtin::cell("comau").unwrap()).unwrap();
    // A base off the origin, so that axes are not mistaken for each other.
    let base =
        Isometry3::from_parts(Translation3::new(0.2, -0.1, 0.3), UnitQuaternion::from_euler_angles(0.2, -0.3, 0.4));
    cell.setup.robot = cell.setup.robot.with_base(&base);
    let q: Vec<f64> = (0..24).map(|i| (0.9 * i as f64).sin()).collect();
    let (anchor, point) = (*rope_anchor(&mut cell), cell.setup.tool.loading_point);
    let start = [anchor.as_slice(), point.as_slice()].concat();
    for index in [Index::ExpectedError, Index::Novel, Index::DropOne] {
        let mut function = IndexFunction::new(&cell, index, 4).unwrap();
        let mut slope = vec![0.0; q.len()];
        let mut at = |load: &[f64]| {
            function.set_anchor([load[0], load[1], load[2]]);
            function.set_loading_point([load[3], load[4], load[5]]);
            let value = function.smoothed(&q, 20.0, &mut slope).objective;
            let (by_anchor, by_point) = function.load_gradient();
            (value, [by_anchor, by_point].concat())
        };
        let (_, gradient) = at(&start);
        let value = |load: &[f64]| at(load).0;
        assert_gradient(index.as_str(), &gradient, &start, value, 2e-4, 1e-7);
    }
}

#[test]
fn a_moved_load_is_that_of_the_moved_cell() {
    let mut cell = default_cell();
    *rope_force(&mut cell) = 700.0;
    let (anchor, point) = ([1.3, 0.2, 0.4], [0.1, 0.2, 0.25]);
    let q: Vec<f64> = (0..18).map(|i| (0.7 * i as f64).sin()).collect();
    let mut function = IndexFunction::new(&cell, Index::D, 3).unwrap();
    function.set_anchor(anchor);
    function.set_loading_point(point);
    *rope_anchor(&mut cell) = anchor.into();
    cell.setup.tool.loading_point = point.into();
    let direct = IndexFunction::new(&cell, Index::D, 3).unwrap().value(&q);
    assert!((function.value(&q) - direct).abs() < 1e-12);
}
