//! Residuals as arrows at the measuring points, on the cell in 3D.

use crate::order::in_order;
use crate::scene::{Arrow, ArrowSet, Scene, SceneGroup, SceneOptions};
use crate::summary::Context;
use crate::summary::Section;
use stiffarm::Result;
use stiffarm::ask::identify::Identified;
use stiffarm::model::kinematics::Frames;
use stiffarm::model::load::Wrench;
use stiffarm::model::posture::Posture;

/// A posture in one load state with what is left at its points.
pub(in crate::summary) struct Residuals<'a> {
    pub posture: &'a str,
    /// Controller angles \[rad\].
    pub angles: &'a [f64],
    pub wrench: Option<[f64; 6]>,
    /// What is compared of the load states of a posture \[m\]: that with most is shown.
    pub size: f64,
    /// Measuring point, residual in base axes \[m\].
    pub at: Vec<(&'a str, [f64; 3])>,
}

/// The measured postures with their residuals.
pub(super) fn cell_section(context: &Context<'_>, identified: &Identified) -> Result<Option<Section>> {
    let identification = &identified.identification;
    let all = identification.postures.iter().map(|posture| Residuals {
        posture: &posture.posture,
        angles: &posture.angles,
        wrench: posture.wrench,
        size: posture.displacement_rms_m,
        at: posture.residuals.iter().map(|r| (r.point.as_str(), r.residual_m)).collect(),
    });
    let stiffness = identification.estimates.stiffness();
    residual_section(
        context,
        "measured",
        &all.collect::<Vec<_>>(),
        stiffness.as_deref(),
        ("Residuals", "what the fit leaves of each displacement", "that moves most"),
    )
}

/// A section with postures and arrows of one kind, and which of several load states is shown; `None` where the result
/// has no angles.
pub(in crate::summary) fn residual_section(
    context: &Context<'_>,
    group: &str,
    all: &[Residuals<'_>],
    stiffness: Option<&[f64]>,
    (label, explained, most): (&str, &str, &str),
) -> Result<Option<Section>> {
    if all.is_empty() || all.iter().any(|one| one.angles.is_empty()) {
        return Ok(None);
    }
    let names = in_order(all.iter().map(|one| one.posture));
    let mut shown: Vec<&Residuals<'_>> = Vec::with_capacity(names.len());
    for name in &names {
        let load_states = all.iter().filter(|one| one.posture == *name);
        shown.extend(load_states.max_by(|a, b| a.size.total_cmp(&b.size)));
    }
    let postures: Vec<Posture> =
        shown.iter().map(|one| Posture { name: one.posture.to_string(), q: one.angles.to_vec() }).collect();
    let wrenches: Option<Vec<Wrench>> = shown.iter().map(|one| one.wrench.map(Wrench::from_components)).collect();
    let wrenches = wrenches.unwrap_or_default();
    let groups = [SceneGroup { name: group, postures: &postures, wrenches: &wrenches }];
    let options = SceneOptions { stiffness, ..SceneOptions::default() };
    let arrows = context.cell.map_or_else(Vec::new, |cell| {
        let tool = &cell.setup.tool.measuring_points;
        let mut arrows = Vec::new();
        for (number, one) in shown.iter().enumerate() {
            // The scene itself says what is wrong with angles that do not fit.
            if one.angles.len() != cell.setup.robot.joint_count() {
                continue;
            }
            let frames = Frames::new(&cell.setup.robot, one.angles);
            for (point, vector) in &one.at {
                let measuring_point = tool.iter().find(|p| p.name == *point);
                arrows.extend(measuring_point.map(|measuring_point| Arrow {
                    group: 0,
                    posture: number,
                    name: (*point).to_string(),
                    at: frames.point(&measuring_point.position).into(),
                    vector: *vector,
                }));
            }
        }
        arrows
    });
    let scene = context.scene(&groups, &options)?;
    let arrows = (!arrows.is_empty()).then(|| ArrowSet { label: label.into(), arrows });
    let scene = scene.map(|scene| Scene { arrows, ..scene });
    let states = match all.len() > names.len() {
        true => format!(" Of several load states the one {most} is shown."),
        false => String::new(),
    };
    let text = format!(
        "The measured postures in their order. Arrows at the measuring points are {explained}, drawn much larger than \
         they are: arrows that point alike at all points of a posture are a shift that its points share, arrows \
         without order are noise.{states}"
    );
    let title = format!("{label} on the cell in 3D");
    Ok(Some(Section { title, ..context.scene_section(scene, &text) }))
}
