//! Figures as data and their SVG renderer.
//!
//! A [`Figure`] holds series, units and labels and nothing about pixels, so
//! that the numbers of a figure can be stored, compared and tested like any
//! other result. [`render_svg`] turns it into a picture for a paper or a page:
//! one legend per figure, the same colour for the same label everywhere, and
//! the same bytes for the same data.
//!
//! A [`scene::Scene`] is a cell at postures as data: a script shows it in three dimensions, and it has a drawing.
//!
//! [`summary`] is what a saved result says, as data: the command shows it in the terminal, [`report`] as a page.
//!
//! [`figure`] is generic: it knows nothing of stiffarm. The other modules turn
//! stiffarm's results into figures and tables.

mod cell;
pub mod figure;
pub mod identified;
mod level;
mod map;
mod order;
pub mod page;
pub mod paper;
mod part;
mod path;
mod path_components;
mod placement;
mod plan_page;
mod point_deflection;
pub mod report;
pub mod scene;
mod selection;
pub mod study;
pub mod summary;
pub mod validated;
mod zones;

pub use cell::{Full, cell_drawing, usual_posture};
pub use figure::csv::figure_csv;
pub use figure::drawing::Drawing;
pub use figure::layout::{Layout, Size};
pub use figure::svg::{
    ShownFigure, ShownPanel, render_drawing, render_drawing_with, render_svg, render_svg_with, series_colour,
    shown_drawing, shown_figure,
};
pub use figure::{Axis, Colour, Figure, Panel, Scale, Series, Style};
pub use map::{map_figure, map_table};

pub use path::{PathCurvePoint, compensation_figure, path_figure, prediction_figure};
pub use path_components::{PathShift, path_components_figure};
pub use placement::{placement_figure, placement_table};
pub use plan_page::plan_page;
pub use point_deflection::{PointDeflection, point_deflection_figure};
pub use selection::{
    CountPoint, Deviations, convergence_figure, correlation_figure, count_figure, deviation_by_noise_figure,
    dexterity_figure, expected_deviation_figure, price_figure, sensitivity_figure, singular_values_figure,
    worth_figure,
};
pub use zones::{zones_figure, zones_table};
