//! Pictures of the same thing that stand side by side get the same axes.

use super::data::Coverage;
use super::scale::{Extent, Kind};
use crate::figure::{Axis, Figure, Panel};

/// Gives corresponding panels of several figures the same extents, so that what
/// stands side by side can be compared by eye. Panels whose axes do not mean the
/// same, and axes with names or with an extent of their own, stay as they are.
pub fn share_axes(figures: &mut [Figure]) {
    let counts = figures.iter().map(|figure| figure.panels.len());
    for place in 0..counts.min().unwrap_or(0) {
        let panels: Vec<&Panel> = figures.iter().map(|f| &f.panels[place]).collect();
        let covered: Vec<Coverage> = panels.iter().map(|panel| Coverage::of(panel)).collect();
        let bars = covered.iter().any(|covered| covered.bars);
        let x = shared(panels.iter().map(|p| &p.x), covered.iter().map(|c| &c.x), false);
        let y = shared(panels.iter().map(|p| &p.y), covered.iter().map(|c| &c.y), bars);
        for figure in figures.iter_mut() {
            let panel = &mut figure.panels[place];
            panel.x.range = x.or(panel.x.range);
            panel.y.range = y.or(panel.y.range);
        }
    }
}

/// The extent that fits all values, where the axes mean the same and fit their data.
fn shared<'a>(
    mut axes: impl Iterator<Item = &'a Axis>,
    values: impl Iterator<Item = &'a Vec<f64>>,
    bars: bool,
) -> Option<[f64; 2]> {
    let first = axes.next()?;
    if matches!(Kind::of(first), Kind::Category(_)) || first.range.is_some() {
        return None;
    }
    if !axes.all(|axis| axis == first) {
        return None;
    }
    let values: Vec<f64> = values.flatten().copied().collect();
    let extent = Extent::choose(first, &values, bars);
    (!values.is_empty()).then_some([extent.lo, extent.hi])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figure::{Series, Style};

    fn figure(unit: &str, style: Style, values: Vec<f64>) -> Figure {
        let x = (0..values.len()).map(|i| i as f64).collect();
        Figure::one(
            "f",
            "",
            "",
            Panel::new(
                "",
                Axis::categorical("joint", ["1", "2"]),
                Axis::linear("deviation", unit),
                vec![Series::new("s", style, x, values)],
            ),
        )
    }

    #[test]
    fn the_larger_values_decide_for_all() {
        let mut figures = [figure("%", Style::Bars, vec![1.0, 2.0]), figure("%", Style::Bars, vec![5.0, 10.0])];
        share_axes(&mut figures);
        for figure in &figures {
            // Bars stand on zero, and five hundredths are left above the highest.
            assert_eq!(figure.panels[0].y.range, Some([0.0, 10.5]));
            assert_eq!(figure.panels[0].x.range, None);
        }
    }

    #[test]
    fn axes_that_mean_something_else_stay() {
        let mut figures = [figure("%", Style::Points, vec![1.0, 2.0]), figure("mm", Style::Points, vec![5.0, 10.0])];
        let before = figures.clone();
        share_axes(&mut figures);
        assert_eq!(figures, before);
    }
}
