//! One figure of every kind, with made-up numbers.

use std::f64::consts::TAU;
use stiffarm_report::{Axis, Figure, Panel, PathCurvePoint, Series, Style, path_figure};

const GROUPS: [&str; 4] = ["Group 1", "Group 2 (classical)", "Group 3 (novel)", "scaled"];

/// All of them.
pub fn all() -> Vec<Figure> {
    vec![noise(), joints(), postures(), points(), spread(), maps(), awkward(), path()]
}

/// Deflection along a long path, before and after compensation.
fn path() -> Figure {
    let points: Vec<PathCurvePoint> = (0..5000)
        .map(|i| {
            let along_m = 3e-4 * i as f64;
            let deflection_m = 4e-4 + 2e-4 * (6.0 * along_m).sin() + 2e-5 * wobble(i);
            PathCurvePoint {
                along_m,
                deflection_m,
                half_width_m: Some(0.08 * deflection_m),
                left_m: Some(0.02 * deflection_m),
            }
        })
        .collect();
    path_figure(&points, Some(0.95))
}

/// A value between −1 and 1 that looks random and is the same every time.
fn wobble(seed: usize) -> f64 {
    (seed as f64 * 12.9898).sin() * 43758.5453 % 1.0
}

fn panel(title: impl Into<String>, x: Axis, y: Axis, series: Vec<Series>) -> Panel {
    Panel { title: title.into(), x, y, series, equal_aspect: false }
}

fn figure(id: &str, title: &str, caption: &str, columns: usize, panels: Vec<Panel>) -> Figure {
    Figure { id: id.into(), title: title.into(), caption: caption.into(), columns, panels }
}

/// Heat maps with a linear and a logarithmic colour bar, some cells without a value.
fn maps() -> Figure {
    let places = || (0..30).flat_map(|r| (0..40).map(move |c| (f64::from(c), f64::from(r))));
    let map = |title: &str, axis: Axis, value: fn(f64, f64) -> f64| {
        let values = places().map(|(x, y)| value(x, y)).collect();
        let (x, y) = places().unzip();
        let series = Series::new("no value", Style::Map, x, y).with_colour(axis, values);
        panel(
            title,
            Axis::linear("joint 2", "deg").with_range(-0.5, 39.5),
            Axis::linear("joint 3", "deg").with_range(-0.5, 29.5),
            vec![series],
        )
    };
    let hill = |x: f64, y: f64| {
        if x + y < 12.0 { f64::NAN } else { (-((x - 25.0).powi(2) + (y - 12.0).powi(2)) / 150.0).exp() }
    };
    let rates = |x: f64, y: f64| {
        if x - y > 32.0 { f64::NAN } else { 10f64.powf((x / 9.0).sin() + y / 10.0) }
    };
    figure(
        "maps",
        "Maps",
        "Dark is low, bright is high.",
        2,
        vec![
            map("linear", Axis::linear("dexterity", ""), hill),
            map("logarithmic", Axis::log("deviation", "%"), rates),
        ],
    )
}

/// Lines with error bars and theory on logarithmic axes, one panel per joint.
fn noise() -> Figure {
    let levels: Vec<f64> = (1..=6).map(f64::from).collect();
    let panels = (1..=6_usize)
        .map(|joint| {
            let mut series = Vec::new();
            for (g, name) in GROUPS.iter().enumerate() {
                let size = 0.02 * joint as f64 * [9.0, 4.0, 1.6, 0.8][g];
                let theory: Vec<f64> = levels.iter().map(|l| size * l.powf(1.4)).collect();
                let y: Vec<f64> = theory
                    .iter()
                    .enumerate()
                    .map(|(i, v)| v * (1.0 + 0.15 * wobble(100 * joint + 10 * g + i)))
                    .collect();
                let error = y.iter().map(|v| 0.25 * v).collect();
                series.push(Series::new(*name, Style::Line, levels.clone(), y).with_error(error));
                series.push(Series::new(format!("{name}, theory"), Style::Dashed, levels.clone(), theory));
            }
            panel(
                format!("Joint {joint}"),
                Axis::linear("noise level", ""),
                Axis::log("mean deviation", "%").with_range(0.01, 30.0),
                series,
            )
        })
        .collect();
    figure(
        "noise",
        "Deviation of the identified joint stiffness against measurement noise",
        "Mean deviation over 200 trials; bars show one standard deviation.",
        3,
        panels,
    )
}

/// Grouped bars on a logarithmic axis.
fn joints() -> Figure {
    let series = GROUPS
        .iter()
        .enumerate()
        .map(|(g, name)| {
            let y: Vec<f64> = (0..6)
                .map(|j| [3.0, 1.5, 0.4, 0.2][g] * 10_f64.powf(0.4 * j as f64 + 0.3 * wobble(g + 9 * j)))
                .collect();
            let error = y.iter().map(|v| 0.3 * v).collect();
            let x = (0..6).map(f64::from).collect();
            Series::new(*name, Style::Bars, x, y).with_error(error)
        })
        .collect();
    figure(
        "joints",
        "Deviation per joint and posture group",
        "Every group uses 15 postures.",
        1,
        vec![panel(
            "",
            Axis::categorical("joint", (1..=6).map(|j| j.to_string())),
            Axis::log("deviation", "%"),
            series,
        )],
    )
}

/// Arms in two views with equal units on both axes.
fn postures() -> Figure {
    let mut side = vec![
        Series::new("floor", Style::Outline, vec![-0.6, 2.9], vec![0.0, 0.0]),
        Series::new(
            "limits of the measuring volume",
            Style::Outline,
            vec![1.0, 2.6, 2.6, 1.0, 1.0],
            vec![0.4, 0.4, 1.9, 1.9, 0.4],
        ),
    ];
    let mut top = vec![Series::new(
        "limits of the measuring volume",
        Style::Outline,
        vec![1.0, 2.6, 2.6, 1.0, 1.0],
        vec![-0.9, -0.9, 0.9, 0.9, -0.9],
    )];
    for p in 0..6_usize {
        let turn = 0.25 * (p as f64 - 2.5);
        let (mut r, mut z, mut lean) = (0.35, 0.75, 1.2 - 0.11 * p as f64);
        let (mut rs, mut zs) = (vec![0.0, 0.0, r], vec![0.0, 0.4, z]);
        for (length, bend) in [(1.1, 0.0), (1.0, -1.0 - 0.09 * p as f64), (0.25, -0.7)] {
            lean += bend;
            r += length * lean.cos();
            z += length * lean.sin();
            rs.push(r);
            zs.push(z);
        }
        let name = format!("Posture {}", p + 1);
        let along = |f: fn(f64) -> f64| rs.iter().map(|r| r * f(turn)).collect::<Vec<f64>>();
        side.push(Series::new(name.clone(), Style::Path, along(f64::cos), zs));
        top.push(Series::new(name, Style::Path, along(f64::cos), along(f64::sin)));
    }
    let anchor = |height| Series::new("rope anchor", Style::Landmark, vec![2.4], vec![height]);
    side.push(anchor(0.1));
    top.push(anchor(-0.5));
    let view = |title: &str, vertical: &str, series| Panel {
        equal_aspect: true,
        ..panel(title, Axis::linear("x", "m"), Axis::linear(vertical, "m"), series)
    };
    figure(
        "postures",
        "Measuring postures",
        "Side and top view of the six postures.",
        2,
        vec![view("Side view", "z", side), view("Top view", "y", top)],
    )
}

/// Lines over named places, with values beyond a validity limit.
fn points() -> Figure {
    let names: Vec<String> = (1..=3).flat_map(|row| (1..=4).map(move |column| format!("{row}-{column}"))).collect();
    let x: Vec<f64> = (0..12).map(f64::from).collect();
    let panels = ["Force along x", "Force along y", "Force along z"]
        .iter()
        .enumerate()
        .map(|(k, title)| {
            let mut series: Vec<Series> = GROUPS
                .iter()
                .enumerate()
                .map(|(g, name)| {
                    let y = (0..12)
                        .map(|i| {
                            let wave = (TAU * i as f64 / 12.0 + k as f64).sin();
                            0.35 + 0.12 * wave + 0.05 * g as f64 + 0.02 * wobble(i + 31 * g)
                        })
                        .collect();
                    Series::new(*name, Style::Line, x.clone(), y)
                })
                .collect();
            series.push(Series::new(
                "Group 1, beyond the linear range",
                Style::Hollow,
                vec![3.0, 7.0],
                vec![0.62, 0.66],
            ));
            panel(
                *title,
                Axis::categorical("measuring point", names.clone()),
                Axis::linear("predicted displacement", "mm").with_range(0.0, 0.7),
                series,
            )
        })
        .collect();
    figure("points", "Predicted displacement at the measuring points", "One line per posture group.", 3, panels)
}

/// Box plots side by side on a logarithmic axis.
fn spread() -> Figure {
    let names = ["5 postures", "10 postures", "15 postures", "20 postures", "30 postures"];
    let series = [("Group 1", 6.0), ("Group 3 (novel)", 1.5)]
        .iter()
        .enumerate()
        .map(|(s, (name, size))| {
            let (mut x, mut y) = (Vec::new(), Vec::new());
            for c in 0..5_usize {
                for i in 0..60 {
                    let z: f64 = (0..4).map(|k| wobble(1 + i + 61 * (c + 5 * (s + 2 * k)))).sum();
                    x.push(c as f64);
                    y.push(size / (1.0 + c as f64).sqrt() * (0.6 * z).exp());
                }
            }
            Series::new(*name, Style::Box, x, y)
        })
        .collect();
    figure(
        "spread",
        "Spread of the deviation over repeated trials",
        "Quartiles, median and 5–95 % whiskers of 60 trials.",
        1,
        vec![panel("", Axis::categorical("number of postures", names), Axis::log("deviation", "%"), series)],
    )
}

/// Values and texts that are hard to draw.
fn awkward() -> Figure {
    let x: Vec<f64> = (0..8).map(f64::from).collect();
    figure(
        "awkward",
        "Missing values, long names & \"<special>\" characters",
        "",
        2,
        vec![
            panel(
                "Non-positive values on a logarithmic axis",
                Axis::linear("sample", ""),
                Axis::log("stiffness", "N m/rad"),
                vec![
                    Series::new("measured", Style::Line, x.clone(), vec![2e5, 3e5, -1.0, 5e5, f64::NAN, 9e5, 4e6, 3e6])
                        .with_error(vec![1e5, 2.9e5, 0.0, 6e5, 0.0, 1e5, 1e6, f64::INFINITY]),
                ],
            ),
            panel("Nothing measured yet", Axis::linear("time", "s"), Axis::linear("force", "N"), vec![]),
            panel(
                "Long category names",
                Axis::categorical(
                    "",
                    [
                        "base rotation about the vertical axis",
                        "shoulder",
                        "elbow",
                        "forearm rotation",
                        "wrist bend",
                        "flange rotation with the tool attached",
                    ],
                ),
                Axis::linear("compliance", "rad/(N m)"),
                vec![Series::new(
                    "identified",
                    Style::Bars,
                    x[..6].to_vec(),
                    vec![2e-7, 3.5e-7, 4e-7, -1.2e-7, 2e-6, 1.4e-6],
                )],
            ),
            panel(
                "A fixed range and a single value",
                Axis::log("frequency", "Hz").with_range(8.0, 4000.0),
                Axis::linear("receptance magnitude measured at the tool centre point", "µm/N").with_range(0.0, 1.0),
                vec![Series::new("peak", Style::Points, vec![120.0, 300.0, 9000.0], vec![0.5, 2.0, 0.1])],
            ),
        ],
    )
}
