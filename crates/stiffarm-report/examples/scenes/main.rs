//! Writes pages with nothing but a cell in three dimensions.
//!
//! ```text
//! cargo run -p stiffarm-report --example scenes -- target/scenes
//! ```

use std::{env, error::Error, fs, path::PathBuf};
use stiffarm::Cell;
use stiffarm::model::load::Wrench;
use stiffarm::model::observation::PostureTerms;
use stiffarm::model::posture::{Posture, PostureGroup};
use stiffarm_report::scene::{
    Arrow, Ellipsoid, Scene, SceneGroup, SceneOptions, ScenePath, VIEWER_SCRIPT, VIEWER_STYLE,
    scene, scene_html,
};
use stiffarm_report::{Full, cell_drawing, render_drawing};

type Done<T> = Result<T, Box<dyn Error>>;

fn main() -> Done<()> {
    let folder = env::args_os()
        .nth(1)
        .map_or_else(|| PathBuf::from("target/scenes"), PathBuf::from);
    fs::create_dir_all(&folder)?;
    let toml = |name: &str, text: &str| stiffarm_files::cell::parse_cell(text, name);
    let kr210 = toml("kr210.toml", include_str!("kr210.toml"))?;
    let panda = toml("panda.toml", include_str!("panda.toml"))?;
    let pages = [
        ("comau", comau()?),
        ("kr210", random(kr210, 2, 8)?),
        ("fanuc", fanuc()?),
        ("panda", random(panda, 2, 6)?),
        (
            "many",
            random(stiffarm_files::builtin::cell("comau-shapes")?, 10, 50)?,
        ),
    ];
    for (name, (cell, postures, shown)) in pages {
        let picture = render_drawing(&cell_drawing(&cell, &postures, Full::Number(0))?);
        let page = page(
            &cell.name,
            &scene_html(&shown, "cell", &cell.name, &picture),
        );
        let bytes = serde_json::to_string(&shown)?.len();
        println!(
            "{name}: data {} KB, page {} KB",
            bytes / 1000,
            page.len() / 1000
        );
        fs::write(folder.join(format!("{name}.html")), page)?;
    }
    Ok(())
}

/// Its cell, some of its postures for the picture that stands still, and the scene.
type Shown = (Cell, Vec<Posture>, Scene);

/// Validation postures, and spread ones with a path, arrows and an ellipsoid.
fn comau() -> Done<Shown> {
    let cell = stiffarm_files::builtin::cell("comau-shapes")?;
    let spread = spread(&cell, "Group 1", 6, 0);
    let validation = cell.validation.clone();
    let groups = [
        SceneGroup::new("Group 1", &spread.postures),
        SceneGroup::new("validation", &validation),
    ];
    let options = SceneOptions::default();
    let plain = scene(&cell, &groups, &options)?;
    let terms = PostureTerms::new(&cell.setup, &spread.postures[0].q, None)?;
    let arrows = terms.measuring_points().iter().enumerate();
    let arrows = arrows.map(|(i, at)| Arrow {
        group: 0,
        posture: 0,
        name: (i + 1).to_string(),
        at: (*at).into(),
        vector: [8e-6 * (i as f64).cos(), 6e-6, -5e-6 * i as f64],
    });
    let ellipsoid = Ellipsoid {
        group: 0,
        posture: 0,
        centre: (*terms.loading_point()).into(),
        axes: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        half: [1.4, 0.8, 0.5],
        text: "compliance 1.4, 0.8, 0.5 µm/N along its axes".into(),
    };
    let share = |i: usize| i as f64 / 40.0;
    let path = ScenePath {
        name: "contour".into(),
        points: (0..=40)
            .map(|i| [1.5, -0.6 + 1.2 * share(i), 0.7])
            .collect(),
        deflection: (0..=40)
            .map(|i| [0.0, 0.0, -2e-4 - 3e-4 * share(i)])
            .collect(),
        correction: (0..=40)
            .map(|i| [0.0, 0.0, 2e-4 + 3e-4 * share(i)])
            .collect(),
        size: (0..=40).map(|i| 0.2 + 0.3 * share(i)).collect(),
        label: "Deflection".into(),
        unit: "mm".into(),
        range: [0.2, 0.5],
        names: Vec::new(),
    };
    let shown = plain
        .with_path(path)
        .with_arrows("Residuals", arrows.collect())
        .with_ellipsoids(vec![ellipsoid]);
    Ok((cell, spread.postures, shown))
}

/// A measured load, with a stiffness handed in.
fn fanuc() -> Done<Shown> {
    let cell = stiffarm_files::builtin::cell("fanuc-r2000ic")?;
    let group = spread(&cell, "measured", 8, 0);
    let wrenches: Vec<Wrench> = (0..8)
        .map(|i| Wrench::force([300.0, 60.0 * f64::from(i) - 200.0, -700.0]))
        .collect();
    let groups = [SceneGroup {
        name: "measured",
        postures: &group.postures,
        wrenches: &wrenches,
    }];
    let options = SceneOptions {
        stiffness: Some(&[2e6, 2e6, 2e6, 4e5, 4e5, 3e5]),
        ..SceneOptions::default()
    };
    let shown = scene(&cell, &groups, &options)?;
    Ok((cell, group.postures, shown))
}

fn random(cell: Cell, count: usize, size: usize) -> Done<Shown> {
    let groups: Vec<PostureGroup> = (0..count)
        .map(|g| spread(&cell, &format!("Group {}", g + 1), size, g * size))
        .collect();
    let shown: Vec<SceneGroup<'_>> = groups
        .iter()
        .map(|g| SceneGroup::new(&g.name, &g.postures))
        .collect();
    let shown = scene(&cell, &shown, &SceneOptions::default())?;
    let postures = groups[0].postures.clone();
    Ok((cell, postures, shown))
}

/// Postures that spread over the bounds, those that meet the limits where there are enough of them.
fn spread(cell: &Cell, name: &str, count: usize, from: usize) -> PostureGroup {
    let steps = [
        0.618_034, 0.754_878, 0.569_840, 0.819_173, 0.430_160, 0.281_198, 0.347_296,
    ];
    let angle = |i: usize| -> Vec<f64> {
        let bounds = cell.bounds.iter().zip(steps);
        bounds
            .map(|([a, b], step)| a + (b - a) * ((0.5 + (i + 1) as f64 * step) % 1.0))
            .collect()
    };
    let mut margins = cell.posture_margins().ok();
    let mut meets = |q: &Vec<f64>| {
        let named = margins.as_mut().and_then(|margins| margins.named(q).ok());
        named.is_some_and(|all| !all.iter().any(|margin| margin.is_violated()))
    };
    let tried = (from * 100..(from + count) * 100).map(angle);
    let good: Vec<Vec<f64>> = tried.filter(|q| meets(q)).take(count).collect();
    let rest = (from..from + count - good.len()).map(angle);
    PostureGroup::from_angles(name, good.into_iter().chain(rest))
}

fn page(title: &str, scene: &str) -> String {
    format!(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<title>{title}</title>\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<style>\n\
         body {{ margin: 0; padding: 1rem; font-family: system-ui, sans-serif; background: #fff; color: #1b232d; }}\n\
         @media (prefers-color-scheme: dark) {{ body {{ background: #101418; color: #e8edf3; }} }}\n\
         h1 {{ font-size: 1.2rem; margin: 0 0 0.6rem; }}\nmain {{ max-width: 80rem; margin: auto; }}\n{VIEWER_STYLE}</style>\n\
         </head>\n<body>\n<main>\n<h1>{title}</h1>\n{scene}</main>\n<script>{VIEWER_SCRIPT}</script>\n</body>\n</html>\n"
    )
}
