//! Feeds of a path, and the loads that follow from them or from a log, are the same in every language.

use super::{Check, cell_with, read, read_with};
use crate::common::set_ups::path_point;
use nalgebra::{Vector3, Vector6};
use proptest::prelude::*;
use stiffarm::model::cell::Cell;
use stiffarm::model::load_log::{CountedBy, LoadLog, Recorded};
use stiffarm::model::path::{PathPoint, PathTarget};
use stiffarm::model::process::ForceAxes;
use stiffarm_files::table::{read_log, read_path, write_path};

/// What the head of a table of points over the workpiece says.
const POINTS: &str = "x_mm,y_mm,z_mm,axis_x,axis_y,axis_z";

/// Feeds of the points \[mm/min\], to 1e-9; those without one are NaN.
fn feeds(points: &[PathPoint]) -> Vec<f64> {
    let feeds = points.iter().map(|point| point.feed.unwrap_or(f64::NAN) * 60e3);
    feeds.map(|feed| (feed * 1e9).round() / 1e9).collect()
}

#[test]
fn every_language_gives_its_feeds() -> Check {
    const JOINTS: &str = "[9E9,9E9,9E9,9E9,9E9,9E9]";
    let rapid = |points: &[(&str, &str)]| {
        let moves = points
            .iter()
            .map(|(x, speed)| format!("MoveL [[{x},0,0],[0,1,0,0],[0,0,0,0],{JOINTS}],{speed},z1,tool0;\n"));
        format!("VAR speeddata vCut:=[2.5,500,5000,1000];\n{}", moves.collect::<String>())
    };
    let listing = |moves: &str| {
        let point = |n: i32| {
            format!(
                "P[{n}]{{\n GP1:\n UF : 1, UT : 1,\n X = {}.0 mm, Y = 0.0 mm, Z = 0.0 mm,\n W = 180.0 deg, P = 0.0 deg, R = 0.0 deg\n}};\n",
                n - 1
            )
        };
        format!("/PROG A\n/MN\n{moves}/POS\n{}/END\n", (1..=4).map(point).collect::<String>())
    };
    let programs: [(&str, String); 13] = [
        (
            "a.cls",
            "UNITS/MM\nFEDRAT/MMPM,600.0\nGOTO/0,0,0\nGOTO/1,0,0\nFEDRAT / 150.0 , MMPM $$ slow\nGOTO/2,0,0\n\
             FEDRAT/MMPR,0.2\nGOTO/3,0,0\n"
                .into(),
        ),
        // Feeds per turn of the spindle, in either order with its speed.
        (
            "a2.cls",
            "UNITS/MM\nFEDRAT/MMPR,0.1\nSPINDL/RPM,6000,CLW\nGOTO/0,0,0\nGOTO/1,0,0\nSPINDL/1500,RPM\nSPINDL/ON\n\
             GOTO/2,0,0\nSPINDL/SFM,300\nGOTO/3,0,0\n"
                .into(),
        ),
        (
            "b2.apt",
            "UNITS/INCH\nSPINDL/6000\nFEDRAT/0.003937007874015748,IPR\nGOTO/0,0,0\nGOTO/0.01,0,0\n\
             FEDRAT/0.0009842519685039370,PERREV\nGOTO/0.02,0,0\nFEDRAT/INVERS,9\nGOTO/0.03,0,0\n"
                .into(),
        ),
        (
            "i2.nc",
            "G90 G70 G95 F0.003937007874015748 S6000 M3\nG1 X0 Y0 Z0\nX1\nS1=1500 X2\nG96 S300 X3\n".into(),
        ),
        (
            "j2.nc",
            "G90 S6000 G95 F0.1\nG1 X0 Y0 Z0\nX1\nS1500 X2\nS#100 X3\n".into(),
        ),
        (
            "b.apt",
            "UNITS/INCH\nFEDRAT/23.622047244094488\nGOTO/0,0,0\nGOTO/0.01,0,0\nFEDRAT/5.905511811023622,IPM\nGOTO/0.02,0,0\n\
             FEDRAT/0.1,PERREV\nGOTO/0.03,0,0\n"
                .into(),
        ),
        (
            "c.nc",
            "G90 G1 F600 X0 Y0 Z0\nX1\nF150 X2\nG1 F#101 X3\n".into(),
        ),
        (
            "d.nc",
            "G90 G94 F600\nG1 X0 Y0 Z0\nX1\nG93 F150 X2\nX3\n".into(),
        ),
        (
            "e.src",
            "$VEL.CP=0.01\nLIN {X 0,Y 0,Z 0,A 0,B 0,C 180}\nLIN {X 1}\nSLIN {X 2} WITH $VEL.CP = 25e-4\n\
             $VEL.CP = vcut\nLIN {X 3}\n"
                .into(),
        ),
        (
            "f.mod",
            rapid(&[("0", "v10"), ("1", "[1E1,500,5000,1000]"), ("2", "vCut"), ("3", "vmax")]),
        ),
        (
            "g.ls",
            listing(
                " 1:L P[1] 10mm/sec FINE ;\n 2:L P[2:b] 60cm/min CNT10 ;\n 3:L P[3] 2.5mm/sec FINE ;\n 4:L P[4] 12deg/sec FINE ;\n",
            ),
        ),
        (
            "h.script",
            "movel(p[0,0,0,3.14,0,0], a=0.5, v=0.01)\nmovel(p[0.001,0,0,3.14,0,0], 0.5, 0.01, 0, 0)\n\
             movel(p[0.002,0,0,3.14,0,0], v=0.0025) # v=9\nmovel(p[0.003,0,0,3.14,0,0], a=1, v=1, t=3)\n"
                .into(),
        ),
        (
            "i.nc",
            "G90 G70 F23.622047244094488\nG1 X0 Y0 Z0\nX1\nF5.905511811023622 X2\nG95 F0.2 X3\n".into(),
        ),
    ];
    for (name, text) in programs {
        let points = read(name, &text)?.points;
        let ends: Vec<&PathPoint> = points.iter().filter(|point| !point.rapid).collect();
        // Points on the way have the feed of the move that they are on.
        let mut by_line: Vec<PathPoint> = Vec::new();
        for point in ends {
            match by_line.last_mut() {
                Some(last) if last.line == point.line => {
                    assert_eq!(last.feed, point.feed, "{name}");
                    *last = point.clone();
                }
                _ => by_line.push(point.clone()),
            }
        }
        let rates = feeds(&by_line);
        assert_eq!(rates[..3], [600.0, 600.0, 150.0], "{name}");
        assert!(rates[3].is_nan(), "{name}: {rates:?}");
    }
    Ok(())
}

#[test]
fn an_inverse_time_is_that_of_the_whole_move() -> Check {
    // A quarter of a circle of 10 mm in a tenth of a minute, and a helix that rises by 3 mm.
    let text = "G90 G93 G1 F2 X10 Y0 Z0\nG3 F10 X0 Y10 I-10 J0\nG3 F10 X-10 Y0 Z3 I0 J-10\nG0 X0 Y0 Z9\n";
    let points = read("a.nc", text)?.points;
    let quarter = 5.0 * std::f64::consts::PI;
    let feed = |line: usize| {
        let of_line = points.iter().filter(|point| point.line == Some(line));
        let feeds: Vec<f64> = of_line.filter_map(|point| Some(point.feed? * 60e3)).collect();
        assert!(feeds.windows(2).all(|pair| pair[0] == pair[1]));
        feeds.first().copied()
    };
    assert_eq!(feed(1), None, "the way to the first point is not known");
    assert!((feed(2).unwrap_or_default() - 10.0 * quarter).abs() < 1e-9);
    assert!((feed(3).unwrap_or_default() - 10.0 * quarter.hypot(3.0)).abs() < 1e-9);
    assert_eq!(feed(4), None);
    Ok(())
}

const CUT: &str = "[work.milling]\nteeth = 2\ndiameter_mm = 12\naxial_depth_mm = 3\nradial_depth_mm = 6\n\
    direction = 'up'\nk_tc_n_per_mm2 = 800\nk_rc_n_per_mm2 = 240\nk_te_n_per_mm = 12\nk_ae_n_per_mm = 2\n";

fn loads(cell: &Cell, points: &[PathPoint]) -> stiffarm::Result<Vec<[f64; 6]>> {
    let process = cell.work.process.as_ref().map(|process| process.load());
    let loads = points.iter().map(|point| {
        let load = point.load_by(process.as_ref())?.unwrap();
        let both = load.force.iter().chain(&load.moment);
        Ok(Vector6::from_iterator(both.copied()).into())
    });
    loads.collect()
}

#[test]
fn the_load_of_a_cut_follows_from_the_feed() -> Check {
    let at_speed = cell_with(&format!("{CUT}spindle_rpm = 6000\n"));
    let rows = "0,0,0,0,0,-1,600\n1,0,0,0,0,-1,1200\n2,0,0,0,0,-1,2400\n";
    let table = format!("{POINTS},feed_mm_per_min\n{rows}");
    let points = read_path(table.as_bytes(), "a.csv", &at_speed, None)?.points;
    let by_point = loads(&at_speed, &points)?;
    // 6000/min with two teeth: 0.05, 0.1, 0.2 mm a tooth.
    for (load, chip) in by_point.iter().zip(["0.05", "0.1", "0.2"]) {
        let fixed = cell_with(&format!("{CUT}feed_per_tooth_mm = {chip}\n"));
        for (component, expected) in load.iter().zip(loads(&fixed, &points[..1])?[0]) {
            assert!((component - expected).abs() < 1e-12 * 100.0, "{component} {expected}");
        }
    }
    // A feature has its own spindle, and a point without feed stops it with its line.
    let cut = CUT.replace("work.milling", "work.feature.milling");
    let featured = cell_with(&format!("[[work.feature]]\nname = 'A'\n{cut}spindle_rpm = 6000\n"));
    let table =
        format!("{POINTS},feed,feature\n0,0,0,0,0,-1,10,A\n1,0,0,0,0,-1,,A\n").replace("feed,", "feed_mm_per_s,");
    let mut points = read_path(table.as_bytes(), "a.csv", &featured, None)?.points;
    let error = featured.work.put_on(&mut points).unwrap_err();
    assert_eq!(error.place().line, Some(3), "{error}");
    let load = points[0].load.unwrap();
    assert!((Vector3::from_column_slice(&by_point[0][..3]) - load.force).norm() < 1e-9);
    Ok(())
}

#[test]
fn feeds_of_a_table_stay() -> Check {
    let cell = cell_with("");
    let table = format!("point,{POINTS},feed_in_per_min\na,0,0,0,0,0,-1,\nb,1,0,0,0,0,-1,12.5\n");
    let read = read_path(table.as_bytes(), "a.csv", &cell, None)?;
    assert_eq!(read.points[0].feed, None);
    assert_eq!(read.points[1].feed, Some(12.5 * 25.4e-3 / 60.0));
    assert_eq!(write_path(&read.format, &read.points)?, table);
    for wrong in ["0", "-3", "1e9"] {
        let slip = table.replace("12.5", wrong);
        let error = read_path(slip.as_bytes(), "a.csv", &cell, None).unwrap_err();
        assert_eq!(error.place().line, Some(3), "{error}");
    }
    Ok(())
}

fn straight(places_mm: &[f64]) -> Vec<PathPoint> {
    let point = |(i, x): (usize, &f64)| {
        let target = PathTarget::Axis { position: Vector3::new(x / 1e3, 0.0, 0.0), axis: -Vector3::z_axis() };
        PathPoint { line: Some(i + 2), ..path_point(i + 1, target) }
    };
    places_mm.iter().enumerate().map(point).collect()
}

fn force_of(points: &[PathPoint]) -> Vec<f64> {
    points.iter().map(|point| point.load.unwrap().force.x).collect()
}

#[test]
fn a_log_gives_each_point_the_mean_around_it() -> Check {
    let cell = cell_with("");
    // 0 N up to 10 mm, then up to 100 N at 20 mm, and down again.
    let log = "along_mm,fx_n,fy_n,fz_n,mx_nm,my_nm,mz_nm\n0,0,1,0,0,0,0.5\n10,0,1,0,0,0,0.5\n20,100,1,0,0,0,0.5\n30,0,1,0,0,0,0.5\n";
    let log = read_log(log.as_bytes(), "log.csv", &cell, Some(ForceAxes::Tool))?;
    let mut points = straight(&[0.0, 10.0, 20.0, 30.0]);
    let findings = log.put_on(&cell, &mut points)?;
    // A quarter of the peak is within half the way, three quarters around it.
    let forces = force_of(&points).into_iter().zip([0.0, 12.5, 75.0, 25.0]);
    forces.for_each(|(force, expected)| assert!((force - expected).abs() < 1e-9));
    let load = points[2].load.unwrap();
    assert_eq!((load.axes, load.force.y), (ForceAxes::Tool, 1.0));
    assert!((load.moment.z - 0.5).abs() < 1e-15);
    assert_eq!(findings.len(), 1);
    // Points beside a rapid move do not share its air.
    let mut points = straight(&[0.0, 10.0, 20.0, 30.0]);
    points[2].rapid = true;
    points[2].load = Some(load);
    log.put_on(&cell, &mut points)?;
    assert_eq!(force_of(&points)[..2], [0.0, 0.0]);
    assert_eq!(points[2].load, Some(load), "its own load stays");
    Ok(())
}

#[test]
fn a_power_scales_the_force_and_time_counts_at_the_feed() -> Check {
    let force = "[work.force]\nforce_n = [-200, 40, 0]\naxes = 'path'\npower_w = 900\nidle_power_w = 100\n";
    let cell = cell_with(force);
    let log = read_log(b"time_s,power_kw\n0,0.1\n1,0.5\n2,0.9\n", "log.csv", &cell, None)?;
    let mut points = straight(&[0.0, 10.0, 15.0, 20.0]);
    // 10 mm in a second, then 5 mm in half a second.
    points.iter_mut().for_each(|point| point.feed = Some(0.01));
    let findings = log.put_on(&cell, &mut points)?;
    // The share is linear in time, so that its mean is that of the middle of each part.
    let shares = [0.125, 0.4375, 0.75, 0.9375];
    for (point, share) in points.iter().zip(shares) {
        let load = point.load.unwrap();
        assert!((load.force - Vector3::new(-200.0, 40.0, 0.0) * share).norm() < 1e-9, "{load:?}");
    }
    assert_eq!(findings.len(), 1);
    // A rapid move before the first cut takes no time of the log; one within needs its feed.
    let mut points = straight(&[-500.0, 0.0, 10.0, 20.0]);
    (points[0].rapid, points[1].rapid) = (true, true);
    points[2..].iter_mut().for_each(|point| point.feed = Some(0.01));
    log.put_on(&cell, &mut points)?;
    let last = points[3].load.unwrap().force.x;
    assert!((last + 200.0 * 0.875).abs() < 1e-9, "{last}");
    // Nor does one behind the last.
    points.extend(straight(&[500.0]));
    (points[4].rapid, points[3].load) = (true, None);
    log.put_on(&cell, &mut points)?;
    assert_eq!(points[3].load.unwrap().force.x, last);
    (points[3].rapid, points[3].feed, points[4].rapid) = (true, None, false);
    let error = log.put_on(&cell, &mut points).unwrap_err();
    assert_eq!(error.place().line, Some(5));
    Ok(())
}

#[test]
fn slips_of_logs() {
    let cell = cell_with("[work.force]\nforce_n = [-200, 40, 0]\naxes = 'path'\n");
    let slips = [
        ("fx_n,fy_n,fz_n\n1,2,3\n", Some(ForceAxes::Base)),
        ("along_mm,time_s,power_w\n0,0,1\n1,1,1\n", None),
        ("along_mm,fx_n,fy_n,fz_n\n0,1,2,3\n9,1,2,3\n", None),
        ("along_mm,fx_n,power_w\n0,1,2\n9,1,2\n", None),
        ("along_mm,fx_n,fy_n\n0,1,2\n9,1,2\n", Some(ForceAxes::Base)),
        ("along_mm\n0\n9\n", None),
        ("along_mm,power_w\n0,1\n2,1\n1,1\n", None),
        ("along_mm,power_w\n0,1\n2,x\n", None),
        ("along_mm,power_w\n0,1\n", None),
        ("along,power_w\n0,1\n", None),
        // These are no slips of the file: of the log beside the path, or the cell.
        ("along_mm,power_w\n0,1\n20,1\n", None),
        ("along_mm,power_w\n0,1\n12,1\n", None),
        ("along_mm,power_w\n5,1\n20,1\n", None),
        ("time_s,power_w\n0,1\n20,1\n", None),
    ];
    let mut shown = String::new();
    for (text, axes) in slips {
        let read = read_log(text.as_bytes(), "log.csv", &cell, axes);
        let put = read.and_then(|log| log.put_on(&cell, &mut straight(&[0.0, 10.0, 20.0])));
        shown += &format!("{text:?}\n{}\n", put.unwrap_err());
    }
    let force = "[work.force]\nforce_n = [1, 2, 3]\naxes = 'base'\n";
    let keys = [
        (force, "power_w = -5"),
        (force, "power_w = 50\nidle_power_w = 60"),
        (force, "idle_power_w = 60"),
        (CUT, ""),
        (CUT, "feed_per_tooth_mm = 0.1\nspindle_rpm = 6000"),
        (CUT, "spindle_rpm = 0"),
    ];
    for (table, keys) in keys {
        let text = format!(
            "format = 1\nrobot.catalogue = 'kuka-kr500-r2800-2'\nload = {{ kind = 'measured' }}\n\
            tool = {{ loading_point_mm = [200, 0, 250], measuring_point = [{{ name = '1', position_mm = [0, 0, 300] }}] }}\n{table}{keys}\n"
        );
        let error = stiffarm_files::cell::parse_cell(&text, "cell.toml").unwrap_err();
        shown += &format!("{keys:?}\n{error}\n");
    }
    insta::assert_snapshot!(shown);
}

proptest! {
    /// What the points take of a log is all of it: the means times their parts are the log's integral, here by
    /// the trapezoidal rule over all its corners and the ends of the parts.
    #[test]
    fn a_log_is_shared_out_whole(
        steps in proptest::collection::vec(0.0..9.0f64, 2..12),
        rows in proptest::collection::vec((0.0..5.0f64, -300.0..300.0f64), 2..40),
    ) {
        let cell = cell_with("");
        let mut x = 0.0;
        let places: Vec<f64> = [0.0].into_iter().chain(steps.iter().map(|step| { x += step; x })).collect();
        let whole: f64 = rows.iter().skip(1).map(|(step, _)| step).sum();
        prop_assume!(x > 1e-3 && whole > 1e-3);
        let mut at = 0.0;
        let (stations, values): (Vec<f64>, Vec<Vector6<f64>>) = rows.iter().enumerate().map(|(i, (step, value))| {
            at += if i == 0 { 0.0 } else { step / whole * x / 1e3 };
            (at, Vector6::new(*value, 0.0, 0.0, 0.0, 0.0, 0.0))
        }).unzip();
        let integral: f64 = stations.windows(2).zip(values.windows(2))
            .map(|(s, v)| 0.5 * (s[1] - s[0]) * (v[0][0] + v[1][0])).sum();
        let log = LoadLog::new(CountedBy::Length, Recorded::Loads(ForceAxes::Base), stations, values);
        let mut points = straight(&places);
        log.put_on(&cell, &mut points).unwrap();
        let part = |i: usize| {
            let from = if i == 0 { places[0] } else { 0.5 * (places[i - 1] + places[i]) };
            let to = if i + 1 == places.len() {
                places[i]
            } else {
                0.5 * (places[i] + places[i + 1])
            };
            (to - from) / 1e3
        };
        let shared: f64 = force_of(&points).iter().enumerate().map(|(i, force)| force * part(i)).sum();
        prop_assert!((shared - integral).abs() < 1e-9 * 300.0 * (1.0 + x), "{shared} {integral}");
    }
}

#[test]
fn programs_and_their_loads_are_read_together() -> Check {
    let cell = cell_with("");
    let mut points = read_with("a.nc", "G90 G0 X0 Y0 Z5\nG1 F600 Z0\nX40\nG0 Z5\n", &cell)?.points;
    // Way: 5 mm down, 40 mm along, 5 mm up.
    let log = "along_mm,fx_n,fy_n,fz_n\n0,0,0,0\n5,0,0,0\n5,-80,0,0\n45,-80,0,0\n45,0,0,0\n50,0,0,0\n";
    let log = read_log(log.as_bytes(), "log.csv", &cell, Some(ForceAxes::Path))?;
    log.put_on(&cell, &mut points)?;
    let at = |line: usize| points.iter().rfind(|point| point.line == Some(line)).unwrap();
    assert!((at(3).load.unwrap().force.x + 80.0).abs() < 1e-9);
    assert_eq!(at(4).load.unwrap().force.x, 0.0, "a rapid move carries no load");
    assert!(at(2).load.unwrap().force.x > -80.0, "half of what is around it is the plunge");
    Ok(())
}
