//! Which values of a series can be drawn on given axes.

use super::scale::Kind;
use crate::figure::{Panel, Series, Style};

/// A drawable point in axis units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Datum {
    pub x: f64,
    pub y: f64,
    /// Ends of the error bar; both `y` for none, infinite above for an open one.
    pub ends: [f64; 2],
}

/// The ends of an error bar, `None` where they are no numbers.
fn ends_of(series: &Series, i: usize, y: f64) -> Option<[f64; 2]> {
    let is_number = |value: &f64| Kind::Linear.accepts(*value);
    match series.interval.get(i) {
        Some([None, _]) => Some([y; 2]),
        Some([Some(low), None]) => is_number(low).then_some([*low, f64::INFINITY]),
        Some([Some(low), Some(high)]) => {
            let both = is_number(low) && is_number(high) && low <= high;
            both.then_some([*low, *high])
        }
        None => {
            let error = series.error.get(i).copied().unwrap_or(0.0);
            let usable = is_number(&error) && error >= 0.0;
            usable.then_some([y - error, y + error])
        }
    }
}

/// The points of a series in order, `None` where one cannot be drawn (so that
/// a line has a gap there instead of a false connection), and how many values
/// are lost.
pub(super) fn points(series: &Series, x: Kind, y: Kind) -> (Vec<Option<Datum>>, usize) {
    let unpaired = series.x.len().abs_diff(series.y.len());
    let mut lost = unpaired;
    let points = series
        .x
        .iter()
        .zip(&series.y)
        .enumerate()
        .map(|(i, (&px, &py))| {
            if !x.accepts(px) || !y.accepts(py) {
                lost += 1;
                return None;
            }
            let ends = ends_of(series, i, py);
            lost += usize::from(ends.is_none());
            Some(Datum { x: px, y: py, ends: ends.unwrap_or([py; 2]) })
        })
        .collect();
    (points, lost)
}

/// The samples of a box series by position, positions ascending.
pub(super) fn samples(points: &[Option<Datum>]) -> Vec<(f64, Vec<f64>)> {
    let mut groups: Vec<(f64, Vec<f64>)> = Vec::new();
    let mut sorted: Vec<Datum> = points.iter().flatten().copied().collect();
    sorted.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    for d in sorted {
        match groups.last_mut() {
            Some((x, values)) if *x == d.x => values.push(d.y),
            _ => groups.push((d.x, vec![d.y])),
        }
    }
    groups
}

/// Quantile of ascending values by linear interpolation.
pub(super) fn quantile(sorted: &[f64], p: f64) -> f64 {
    let Some(last) = sorted.len().checked_sub(1) else {
        return 0.0;
    };
    let place = p * last as f64;
    let below = (place.floor() as usize).min(last);
    let above = (below + 1).min(last);
    let t = place - below as f64;
    sorted[below] * (1.0 - t) + sorted[above] * t
}

/// Everything the extents of a panel have to cover.
pub(super) struct Coverage {
    pub x: Vec<f64>,
    pub y: Vec<f64>,
    /// Values that cannot be drawn.
    pub lost: usize,
    pub bars: bool,
}

impl Coverage {
    pub(super) fn of(panel: &Panel) -> Self {
        let (kx, ky) = (Kind::of(&panel.x), Kind::of(&panel.y));
        let mut out =
            Self { x: Vec::new(), y: Vec::new(), lost: 0, bars: panel.series.iter().any(|s| s.style == Style::Bars) };
        for series in &panel.series {
            let (points, lost) = points(series, kx, ky);
            out.lost += lost;
            for d in points.into_iter().flatten() {
                out.x.push(d.x);
                out.y.push(d.y);
                let [low, high] = d.ends;
                // On a logarithmic axis a bar that reaches towards zero would
                // take up the whole panel; it is cut at the frame instead.
                let far = ky == Kind::Log && low < 0.2 * d.y;
                let too_far = ky == Kind::Log && high > 20.0 * d.y;
                for (end, wanted) in [(low, !far), (high, !too_far)] {
                    if wanted && ky.accepts(end) {
                        out.y.push(end);
                    }
                }
            }
            // Bars and boxes on a numeric axis need room beside their centre.
            if matches!(series.style, Style::Bars | Style::Box) && kx == Kind::Linear {
                let (lo, hi) = ends(&out.x);
                let pad = if hi > lo { 0.08 * (hi - lo) } else { 0.0 };
                if lo <= hi && kx.accepts(lo - pad) && kx.accepts(hi + pad) {
                    out.x.extend([lo - pad, hi + pad]);
                }
            }
        }
        out
    }
}

fn ends(values: &[f64]) -> (f64, f64) {
    values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), v| (lo.min(*v), hi.max(*v)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figure::Axis;

    #[test]
    fn undrawable_values_are_counted() {
        let series =
            Series::new("s", Style::Line, vec![1.0, 2.0, f64::NAN, 4.0, 5.0], vec![1.0, -1.0, 1.0, f64::INFINITY])
                .with_error(vec![f64::NAN, 0.1]);
        let (drawable, lost) = points(&series, Kind::Linear, Kind::Log);
        assert_eq!(drawable.len(), 4);
        assert_eq!(drawable.iter().flatten().count(), 1);
        assert_eq!(lost, 5);
    }

    #[test]
    fn quantiles_interpolate() {
        let values = [1.0, 2.0, 3.0, 4.0, 5.0];
        assert_eq!(quantile(&values, 0.5), 3.0);
        assert!((quantile(&values, 0.05) - 1.2).abs() < 1e-12);
        assert_eq!(quantile(&[7.0], 0.95), 7.0);
        assert_eq!(quantile(&[], 0.5), 0.0);
    }

    #[test]
    fn a_long_error_bar_does_not_stretch_a_log_axis() {
        let panel = Panel::new(
            "",
            Axis::default(),
            Axis::log("", ""),
            vec![Series::new("s", Style::Line, vec![1.0, 2.0], vec![10.0, 20.0]).with_error(vec![9.999, 5.0])],
        );
        let covered = Coverage::of(&panel);
        assert_eq!(covered.lost, 0);
        assert_eq!(ends(&covered.y).0, 10.0);
    }
}
