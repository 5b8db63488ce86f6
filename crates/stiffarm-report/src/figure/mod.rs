//! What a figure shows: panels, axes and series as plain data, and how it is
//! drawn.
//!
//! The types carry no drawing decisions beyond the kind of mark, so the same
//! value can be rendered, written as JSON next to the picture, or checked in a
//! test.
//!
//! This module and everything below it is generic: it knows nothing of robots
//! and uses neither the crate `stiffarm` nor any other module of this crate, so
//! that it could be a crate of its own. A test (`tests/it/generic.rs`) reads
//! the sources and fails where they do.

pub mod csv;
pub mod drawing;
pub mod layout;
pub mod svg;

use serde::{Deserialize, Deserializer, Serialize};

/// A grid of panels with one title, one caption and one legend.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Figure {
    /// Short stable name, used for file names and links.
    pub id: String,
    /// Heading drawn above the panels.
    pub title: String,
    /// What the reader should take from the figure. It becomes the
    /// description of the picture for assistive technology and is printed by
    /// the page that embeds the figure, not drawn into the picture.
    pub caption: String,
    /// Panels per row; 0 counts as 1, and more than there are panels as their
    /// number.
    pub columns: usize,
    /// The panels, row by row.
    pub panels: Vec<Panel>,
}

/// One pair of axes and the series drawn on it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Panel {
    /// Heading of the panel; may be empty.
    pub title: String,
    /// Horizontal axis.
    pub x: Axis,
    /// Vertical axis.
    pub y: Axis,
    /// The data, drawn in order within each kind of mark.
    pub series: Vec<Series>,
    /// Draw one unit equally long on both axes. Needs two linear axes without
    /// categories and is ignored otherwise. The ranges are widened to fill
    /// the panel.
    #[serde(default)]
    pub equal_aspect: bool,
}

impl Figure {
    /// A figure of one panel.
    pub fn one(id: impl Into<String>, title: impl Into<String>, caption: impl Into<String>, panel: Panel) -> Self {
        Figure { id: id.into(), title: title.into(), caption: caption.into(), columns: 1, panels: vec![panel] }
    }
}

impl Panel {
    /// A panel that is as tall and wide as there is room.
    pub fn new(title: impl Into<String>, x: Axis, y: Axis, series: Vec<Series>) -> Self {
        Panel { title: title.into(), x, y, series, equal_aspect: false }
    }
}

/// An axis: its label, unit, scale and extent.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Axis {
    /// Name of the quantity.
    pub label: String,
    /// Unit, drawn in brackets after the label; empty for none.
    #[serde(default)]
    pub unit: String,
    /// Linear or logarithmic.
    #[serde(default)]
    pub scale: Scale,
    /// Category names; empty for a numeric axis. Category `i` (from 0) lies
    /// at coordinate `i`; scale and range do not apply.
    #[serde(default)]
    pub categories: Vec<String>,
    /// Fixed extent in either order, or `None` to fit the data. An extent the
    /// axis cannot show (empty, not finite, not positive on a logarithmic
    /// axis) counts as `None`.
    #[serde(default)]
    pub range: Option<[f64; 2]>,
    /// A linear axis that fits its data begins at zero, so that lengths can be
    /// compared; one with values on both sides shows zero.
    #[serde(default, skip_serializing_if = "is_false")]
    pub from_zero: bool,
}

/// How values are spread along an axis.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Scale {
    /// Equal steps for equal differences.
    #[default]
    Linear,
    /// Equal steps for equal ratios (base 10).
    Log,
}

/// One set of values that shares a label and a kind of mark.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Series {
    /// Legend text; it also decides the colour (see
    /// [`series_colour`](svg::series_colour)). Empty for no legend entry.
    pub label: String,
    /// Kind of mark.
    pub style: Style,
    /// Horizontal coordinates, or category indices.
    #[serde(deserialize_with = "null_as_nan")]
    pub x: Vec<f64>,
    /// Vertical coordinates.
    #[serde(deserialize_with = "null_as_nan")]
    pub y: Vec<f64>,
    /// Half lengths of symmetric vertical error bars, one per point (0 for
    /// none), or empty. Half widths of a [`Style::Band`].
    #[serde(default, deserialize_with = "null_as_nan")]
    pub error: Vec<f64>,
    /// Ends of error bars that reach farther to one side, one pair per point, or empty; they count instead of
    /// `error`. Without an upper end the bar is open and has an arrow; without a lower one there is none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub interval: Vec<[Option<f64>; 2]>,
    /// Values of a [`Style::Map`], and the axis of its colour bar.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub colour: Option<Colour>,
}

/// Values shown as colour.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Colour {
    /// Axis of the colour bar. A panel has one bar: its first map's.
    pub axis: Axis,
    /// One value per point; one that the axis cannot show is a missing one.
    #[serde(deserialize_with = "null_as_nan")]
    pub values: Vec<f64>,
    /// Small values are bright, not large ones: where small is good beside maps
    /// of which large is.
    #[serde(default, skip_serializing_if = "is_false")]
    pub small_is_bright: bool,
}

/// Kind of mark a series is drawn with.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Style {
    /// Solid line with markers.
    Line,
    /// Solid line without markers, for many points.
    Curve,
    /// Dashed line without markers, e.g. theory next to a simulation.
    Dashed,
    /// Filled markers without a line.
    Points,
    /// Bars, side by side for several series; squares on a logarithmic axis, which has no zero to stand on.
    Bars,
    /// Box and whiskers over the samples that share an `x`: quartiles,
    /// median, whiskers from the 5 % to the 95 % quantile, and every sample
    /// as a faint point. Side by side for several series.
    Box,
    /// Thin grey polyline: floor, workspace limit and other surroundings.
    Outline,
    /// Thick polyline with a dot at every vertex: the links of a robot arm.
    Path,
    /// Hollow markers without a line, e.g. values beyond a validity limit.
    Hollow,
    /// Heat map: every point is the centre of a cell that reaches half-way to
    /// its neighbours and has the colour of its value. Cells without a value
    /// are hatched; the series' label is their legend entry. The maps of a panel
    /// share one grid, and each has a grey of its own.
    Map,
    /// Area between y − error and y + error around a curve without a line, e.g.
    /// how sure it is.
    Band,
    /// Dark grey squares with a cross: fixed things among the surroundings, such
    /// as an anchor. No data are drawn with this marker.
    Landmark,
    /// Short straight pieces, from each even point to the one after it: axes
    /// drawn on a map.
    Strokes,
}

impl Axis {
    /// A linear axis that fits its data.
    pub fn linear(label: impl Into<String>, unit: impl Into<String>) -> Self {
        Self { label: label.into(), unit: unit.into(), ..Self::default() }
    }

    /// A logarithmic axis that fits its data.
    pub fn log(label: impl Into<String>, unit: impl Into<String>) -> Self {
        Self { scale: Scale::Log, ..Self::linear(label, unit) }
    }

    /// An axis with one place per name.
    pub fn categorical<S: Into<String>>(label: impl Into<String>, categories: impl IntoIterator<Item = S>) -> Self {
        Self { categories: categories.into_iter().map(Into::into).collect(), ..Self::linear(label, "") }
    }

    /// The same axis with a fixed extent.
    pub fn with_range(mut self, from: f64, to: f64) -> Self {
        self.range = Some([from, to]);
        self
    }

    /// The same axis, from zero on.
    pub fn from_zero(mut self) -> Self {
        self.from_zero = true;
        self
    }

    /// Label and unit as drawn: `label [unit]`.
    pub fn heading(&self) -> String {
        match (self.label.is_empty(), self.unit.is_empty()) {
            (_, true) => self.label.clone(),
            (true, false) => format!("[{}]", self.unit),
            (false, false) => format!("{} [{}]", self.label, self.unit),
        }
    }
}

impl Series {
    /// A series without error bars.
    pub fn new(label: impl Into<String>, style: Style, x: Vec<f64>, y: Vec<f64>) -> Self {
        Self { label: label.into(), style, x, y, error: Vec::new(), interval: Vec::new(), colour: None }
    }

    /// The same series with symmetric error bars.
    pub fn with_error(mut self, error: Vec<f64>) -> Self {
        self.error = error;
        self
    }

    /// The same series with error bars between these ends.
    pub fn with_interval(mut self, interval: Vec<[Option<f64>; 2]>) -> Self {
        self.interval = interval;
        self
    }

    /// The same series with values shown as colour.
    pub fn with_colour(mut self, axis: Axis, values: Vec<f64>) -> Self {
        self.colour = Some(Colour { axis, values, small_is_bright: false });
        self
    }

    /// The same series, small values bright if `yes`.
    pub fn with_small_bright(mut self, yes: bool) -> Self {
        if let Some(colour) = &mut self.colour {
            colour.small_is_bright = yes;
        }
        self
    }
}

/// What a written figure leaves out.
fn is_false(value: &bool) -> bool {
    !value
}

/// JSON has no way to write a value that is not finite; such values are
/// written as `null` and have to come back as "no value", not as an error.
fn null_as_nan<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<f64>, D::Error> {
    let values = Vec::<Option<f64>>::deserialize(deserializer)?;
    Ok(values.into_iter().map(|v| v.unwrap_or(f64::NAN)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn heading_joins_label_and_unit() {
        assert_eq!(Axis::linear("force", "N").heading(), "force [N]");
        assert_eq!(Axis::linear("joint", "").heading(), "joint");
        assert_eq!(Axis::linear("", "mm").heading(), "[mm]");
        assert_eq!(Axis::default().heading(), "");
    }

    #[test]
    fn json_round_trip_keeps_missing_values_missing() {
        let figure = Figure {
            id: "a".into(),
            title: "A".into(),
            caption: String::new(),
            columns: 1,
            panels: vec![Panel {
                title: String::new(),
                x: Axis::linear("x", "m").with_range(0.0, 1.0),
                y: Axis::log("y", ""),
                series: vec![Series::new("s", Style::Line, vec![0.0, 1.0], vec![f64::NAN, 2.5])],
                equal_aspect: false,
            }],
        };
        let text = serde_json::to_string(&figure).expect("figures are plain data");
        let back: Figure = serde_json::from_str(&text).expect("what was written can be read");
        assert_eq!(back.panels[0].x, figure.panels[0].x);
        assert!(back.panels[0].series[0].y[0].is_nan());
        assert_eq!(back.panels[0].series[0].y[1], 2.5);
    }
}
