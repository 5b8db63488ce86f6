//! How much room the labels of a panel need at a given size of its plot area.

use super::data::Coverage;
use super::scale::{Extent, Kind};
use super::text;
use super::ticks::{self, Tick};
use crate::figure::{Axis, Colour, Panel, Style};

/// Font size of tick labels and the legend.
pub(super) const SMALL: f64 = 12.0;
/// Font size of axis labels and panel titles.
pub(super) const NORMAL: f64 = 13.0;
/// Line height in units of the font size.
pub(super) const LEADING: f64 = 1.2;
/// Distance between the frame and tick labels.
pub(super) const TICK_GAP: f64 = 7.0;
/// Distance between tick labels and the axis label.
const LABEL_GAP: f64 = 5.0;
/// Distance between the frame and the panel title.
pub(super) const TITLE_GAP: f64 = 7.0;
/// Angle of category names that do not fit side by side.
pub(super) const SLANT: f64 = 45.0;
/// Distance between the plot area and the colour bar, and the bar's width.
pub(super) const BAR_GAP: f64 = 9.0;
pub(super) const BAR: f64 = 11.0;

/// Names along the horizontal axis.
pub(super) struct Names {
    /// The lines of every category's name.
    pub lines: Vec<Vec<String>>,
    pub slanted: bool,
    /// Every how many categories is named.
    pub every: usize,
}

/// Extents, ticks and label lines of one panel, and the room they need on
/// each side of the plot area.
pub(super) struct Plan {
    pub x: Extent,
    pub y: Extent,
    pub x_ticks: Vec<Tick>,
    pub y_ticks: Vec<Tick>,
    pub x_names: Names,
    pub y_names: Vec<String>,
    pub colour: Option<ColourPlan>,
    pub title: Vec<String>,
    pub x_label: Vec<String>,
    pub y_label: Vec<String>,
    pub left: f64,
    pub right: f64,
    pub top: f64,
    pub bottom: f64,
    /// Values that cannot be drawn.
    pub lost: usize,
    pub empty: bool,
}

/// The colour bar of a panel with a map.
pub(super) struct ColourPlan {
    pub extent: Extent,
    pub ticks: Vec<Tick>,
    pub label: Vec<String>,
    /// Whether the lower end is the bright one.
    pub small_is_bright: bool,
    /// Room of the widest tick label.
    tick_width: f64,
}

impl ColourPlan {
    /// The colours of the panel's first map that has values.
    fn colours(panel: &Panel) -> Option<&Colour> {
        let mut maps = panel.series.iter().filter(|s| s.style == Style::Map);
        maps.find_map(|s| s.colour.as_ref())
    }

    /// What their bar reaches over.
    pub(super) fn extent_of(panel: &Panel) -> Option<Extent> {
        let colour = Self::colours(panel)?;
        let kind = Kind::of(&colour.axis);
        let shown = colour.values.iter().copied().filter(|v| kind.accepts(*v));
        Some(Extent::choose(&colour.axis, &shown.collect::<Vec<_>>(), false))
    }

    /// Their bar at this height.
    fn of(panel: &Panel, height: f64) -> Option<Self> {
        let (colour, extent) = (Self::colours(panel)?, Self::extent_of(panel)?);
        let ticks = ticks::ticks(&extent, (height / 30.0).max(2.0) as usize);
        Some(Self {
            extent,
            small_is_bright: colour.small_is_bright,
            label: text::wrap(&colour.axis.heading(), NORMAL, height + 16.0, 3),
            tick_width: ticks.iter().map(|t| t.width(SMALL)).fold(0.0, f64::max),
            ticks,
        })
    }

    /// Distance of the baseline of label line `i` from the plot area.
    pub(super) fn baseline(&self, i: usize) -> f64 {
        let ticks = BAR_GAP + BAR + TICK_GAP + self.tick_width;
        ticks + LABEL_GAP + (i as f64 + 0.8) * NORMAL * LEADING
    }

    /// Room to the right of the plot area.
    fn room(&self) -> f64 {
        match self.label.len() {
            0 => BAR_GAP + BAR + TICK_GAP + self.tick_width,
            lines => self.baseline(lines - 1) + 0.2 * NORMAL * LEADING,
        }
    }
}

/// Which axis labels of a panel are drawn; a label that the neighbour repeats
/// is left to the neighbour.
#[derive(Clone, Copy)]
pub(super) struct Shown {
    pub x_label: bool,
    pub y_label: bool,
}

/// The extents before they are adapted to the shape of the plot area.
pub(super) fn natural(panel: &Panel) -> (Extent, Extent, Coverage) {
    let covered = Coverage::of(panel);
    let x = Extent::choose(&panel.x, &covered.x, false);
    let y = Extent::choose(&panel.y, &covered.y, covered.bars);
    (x, y, covered)
}

/// Whether equal units on both axes are asked for and possible.
fn equal(panel: &Panel) -> bool {
    panel.equal_aspect && Kind::of(&panel.x) == Kind::Linear && Kind::of(&panel.y) == Kind::Linear
}

/// Height of the plot area that suits its width.
pub(super) fn suitable_height(panel: &Panel, width: f64, usual: f64) -> f64 {
    if !equal(panel) {
        return usual;
    }
    let (x, y, _) = natural(panel);
    let ratio = (y.hi - y.lo) / (x.hi - x.lo);
    // A map must not end in the middle of its panel.
    let has_map = panel.series.iter().any(|s| s.style == Style::Map);
    let [low, high] = if has_map { [0.25, 2.0] } else { [0.5, 1.2] };
    width * ratio.clamp(low, high)
}

impl Plan {
    pub(super) fn new(panel: &Panel, shown: Shown, width: f64, height: f64) -> Self {
        let (mut x, mut y, covered) = natural(panel);
        if equal(panel) {
            let per_x = (x.hi - x.lo) / width;
            let per_y = (y.hi - y.lo) / height;
            x = x.widened(per_y / per_x);
            y = y.widened(per_x / per_y);
        }
        let x_ticks = x_ticks(&x, width);
        let y_ticks = ticks::ticks(&y, (height / 30.0).max(2.0) as usize);
        let x_names = names(&panel.x.categories, width);
        let y_names = column_names(&panel.y, height);
        let title = text::wrap(&panel.title, text::BOLD * NORMAL, width + 20.0, 3);
        let heading = |axis: &Axis, shown: bool, room: f64| {
            if shown { text::wrap(&axis.heading(), NORMAL, room, 3) } else { Vec::new() }
        };
        let x_label = heading(&panel.x, shown.x_label, width + 20.0);
        let y_label = heading(&panel.y, shown.y_label, height + 16.0);

        let block = |lines: &[String]| lines.len() as f64 * NORMAL * LEADING;
        let gap = |lines: &[String]| if lines.is_empty() { 0.0 } else { LABEL_GAP };
        let y_width = y_ticks
            .iter()
            .map(|t| t.width(SMALL))
            .chain(y_names.iter().map(|n| text::width(n, SMALL)))
            .fold(0.0, f64::max);
        let (x_tick_height, overhang_left, overhang_right) = x_room(&x, &x_ticks, &x_names, width);
        let colour = ColourPlan::of(panel, height);
        let bar = colour.as_ref().map_or(0.0, ColourPlan::room);
        let left = TICK_GAP + y_width + gap(&y_label) + block(&y_label);
        let half_line = 0.5 * SMALL;
        Self {
            left: left.max(overhang_left),
            right: overhang_right.max(bar).max(2.0),
            top: if title.is_empty() { half_line } else { block(&title) + TITLE_GAP },
            bottom: x_tick_height + gap(&x_label) + block(&x_label),
            lost: covered.lost,
            empty: covered.x.is_empty(),
            x,
            y,
            x_ticks,
            y_ticks,
            x_names,
            y_names,
            colour,
            title,
            x_label,
            y_label,
        }
    }
}

/// Whether the panel shows bars or boxes, which stand between the boundaries
/// of their category rather than on a grid line.
pub(super) fn has_areas(panel: &Panel) -> bool {
    panel.series.iter().any(|s| matches!(s.style, Style::Bars | Style::Box))
}

/// As many ticks as fit side by side.
fn x_ticks(extent: &Extent, width: f64) -> Vec<Tick> {
    let mut most = (width / 36.0).max(2.0) as usize;
    loop {
        let candidates = ticks::ticks(extent, most);
        let fits = candidates.windows(2).all(|pair| {
            let distance = (extent.fraction(pair[1].value) - extent.fraction(pair[0].value)) * width;
            distance >= 0.5 * (pair[0].width(SMALL) + pair[1].width(SMALL)) + 7.0
        });
        if fits || most <= 1 {
            return candidates;
        }
        most -= 1;
    }
}

/// Category names in one line, in several, or slanted, whichever fits first.
fn names(categories: &[String], width: f64) -> Names {
    let step = width / categories.len().max(1) as f64;
    let room = step - 4.0;
    let whole =
        |limit: f64| -> Vec<Vec<String>> { categories.iter().map(|c| vec![text::shorten(c, SMALL, limit)]).collect() };
    let fits = |t: &str| text::width(t, SMALL) <= room;
    let flat = |lines| Names { lines, slanted: false, every: 1 };
    if categories.iter().all(|c| fits(c)) {
        return flat(whole(f64::INFINITY));
    }
    if categories.iter().all(|c| c.split_whitespace().all(fits) && text::wrap(c, SMALL, room, 4).len() <= 3) {
        return flat(categories.iter().map(|c| text::wrap(c, SMALL, room, 3)).collect());
    }
    // Two slanted lines per name if they fit between the neighbours.
    let two = step * SLANT.to_radians().sin() >= 2.0 * SMALL * LEADING;
    let lines = if two { categories.iter().map(|c| text::wrap(c, SMALL, 140.0, 2)).collect() } else { whole(190.0) };
    Names { lines, slanted: true, every: (SMALL * LEADING / step).ceil().max(1.0) as usize }
}

/// Names along a vertical category axis; left out where they would overlap.
fn column_names(axis: &Axis, height: f64) -> Vec<String> {
    let step = height / axis.categories.len().max(1) as f64;
    let every = (SMALL * LEADING / step).ceil().max(1.0) as usize;
    axis.categories
        .iter()
        .enumerate()
        .map(|(i, c)| match i % every {
            0 => text::shorten(c, SMALL, 150.0),
            _ => String::new(),
        })
        .collect()
}

/// Height of the horizontal tick labels and how far they reach beyond the
/// left and right end of the plot area.
fn x_room(extent: &Extent, ticks: &[Tick], names: &Names, width: f64) -> (f64, f64, f64) {
    let (mut height, mut left, mut right) = (SMALL * LEADING, 0.0_f64, 0.0_f64);
    for tick in ticks {
        let at = extent.fraction(tick.value) * width;
        let half = 0.5 * tick.width(SMALL);
        left = left.max(half - at);
        right = right.max(at + half - width);
    }
    let most_lines = names.lines.iter().map(Vec::len).max().unwrap_or(1);
    height = height.max(most_lines as f64 * SMALL * LEADING);
    if names.slanted {
        let lean = SLANT.to_radians();
        for (i, lines) in names.lines.iter().enumerate().step_by(names.every) {
            let long = lines.iter().map(|l| text::width(l, SMALL)).fold(0.0, f64::max);
            let at = extent.fraction(i as f64) * width;
            left = left.max(long * lean.cos() + SMALL - at);
            height = height.max(long * lean.sin() + 0.6 * SMALL);
        }
    }
    (TICK_GAP + height, left, right)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figure::Series;

    #[test]
    fn equal_aspect_gives_equal_units() {
        let series = Series::new("s", Style::Path, vec![0.0, 3.0], vec![-1.0, 0.5]);
        let panel = Panel {
            title: String::new(),
            x: Axis::linear("x", "m"),
            y: Axis::linear("z", "m").with_range(-2.0, 2.0),
            series: vec![series],
            equal_aspect: true,
        };
        let shown = Shown { x_label: true, y_label: true };
        for (width, height) in [(300.0, 200.0), (100.0, 400.0)] {
            let plan = Plan::new(&panel, shown, width, height);
            let per_x = (plan.x.hi - plan.x.lo) / width;
            let per_y = (plan.y.hi - plan.y.lo) / height;
            assert!((per_x / per_y - 1.0).abs() < 1e-12);
            assert!(plan.x.lo <= 0.0 && plan.x.hi >= 3.0 && plan.y.lo <= -2.0);
        }
    }

    #[test]
    fn names_take_the_first_form_that_fits() {
        let list = |names: &[&str]| names.iter().map(|n| (*n).to_owned()).collect::<Vec<_>>();
        let short = names(&list(&["1", "2", "3"]), 200.0);
        assert!(!short.slanted && short.lines[0].len() == 1);
        let wrapped = names(&list(&["first place", "second place"]), 120.0);
        assert!(!wrapped.slanted && wrapped.lines[0].len() == 2);
        let slanted = names(&list(&["rotation"; 6]), 200.0);
        assert!(slanted.slanted && slanted.every == 1);
        let thinned = names(&list(&["rotation"; 60]), 200.0);
        assert!(thinned.slanted && thinned.every > 1);
    }
}
