//! Round tick positions and their labels.

use super::scale::{Extent, Kind};
use super::text;

/// A labelled position on a numeric axis.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Tick {
    pub value: f64,
    pub text: String,
    /// Raised part of a label such as `10` with exponent `-4`.
    pub exponent: Option<String>,
}

impl Tick {
    fn plain(value: f64, text: String) -> Self {
        Self { value, text: minus(text), exponent: None }
    }

    pub(super) fn width(&self, size: f64) -> f64 {
        text::width(&self.text, size) + self.exponent.as_ref().map_or(0.0, |e| text::width(e, 0.75 * size))
    }
}

/// Ticks of a numeric axis, at most about `most` of them.
pub(super) fn ticks(extent: &Extent, most: usize) -> Vec<Tick> {
    match extent.kind {
        Kind::Linear => linear(extent, most),
        Kind::Log => log(extent, most),
        Kind::Category(_) => Vec::new(),
    }
}

/// Unlabelled positions between the decades of a logarithmic axis.
pub(super) fn minor(extent: &Extent) -> Vec<f64> {
    if extent.kind != Kind::Log || (extent.hi / extent.lo).log10() > 8.0 {
        return Vec::new();
    }
    let (first, last) = decades(extent);
    (first - 1..=last)
        .flat_map(|k| (2..10).map(move |m| f64::from(m) * power(k)))
        .filter(|v| *v >= extent.lo && *v <= extent.hi)
        .collect()
}

fn linear(extent: &Extent, most: usize) -> Vec<Tick> {
    let raw = (extent.hi - extent.lo) / most.max(1) as f64;
    let magnitude = power(raw.log10().floor() as i32);
    let step = match raw / magnitude {
        r if r <= 1.0 + 1e-9 => magnitude,
        r if r <= 2.0 + 1e-9 => 2.0 * magnitude,
        r if r <= 5.0 + 1e-9 => 5.0 * magnitude,
        _ => 10.0 * magnitude,
    };
    let first = (extent.lo / step - 1e-9).ceil() as i64;
    let last = (extent.hi / step + 1e-9).floor() as i64;
    let values: Vec<f64> = (first..=last).map(|i| i as f64 * step).collect();
    linear_labels(&values, step)
}

fn linear_labels(values: &[f64], step: f64) -> Vec<Tick> {
    let largest = values.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    let order = (step * (1.0 + 1e-9)).log10().floor() as i32;
    let top = (largest * (1.0 + 1e-9)).log10().floor();
    if largest == 0.0 || ((1e-3..1e6).contains(&largest) && order >= -6) {
        let decimals = (-order).max(0) as usize;
        return values.iter().map(|v| Tick::plain(*v, format!("{v:.decimals$}"))).collect();
    }
    let top = top as i32;
    let decimals = (top - order).max(0) as usize;
    values
        .iter()
        .map(|v| {
            if *v == 0.0 {
                return Tick::plain(0.0, "0".into());
            }
            let mantissa = v / power(top);
            Tick {
                value: *v, text: minus(format!("{mantissa:.decimals$}×10")), exponent: Some(minus(top.to_string()))
            }
        })
        .collect()
}

fn log(extent: &Extent, most: usize) -> Vec<Tick> {
    let (first, last) = decades(extent);
    let short = (extent.hi / extent.lo).log10() < 2.0;
    let mut marks: Vec<(i32, i32)> = if short {
        (first - 1..=last).flat_map(|k| [1, 2, 5].map(|m| (m, k))).collect()
    } else {
        let stride = ((last - first) as usize / most.max(1) + 1) as i32;
        // Multiples of the stride, so that 10⁰ is among the labels if shown.
        (first..=last).filter(|k| k.rem_euclid(stride) == 0).map(|k| (1, k)).collect()
    };
    let slack = 1.0 + 1e-9;
    marks.retain(|(m, k)| {
        let v = f64::from(*m) * power(*k);
        v * slack >= extent.lo && v <= extent.hi * slack
    });
    if marks.len() > most && marks.iter().filter(|(m, _)| *m == 1).count() > 1 {
        marks.retain(|(m, _)| *m == 1);
    }
    if marks.len() < 2 {
        return linear(extent, most);
    }
    // One notation per axis: powers as soon as one label would be long.
    let powers = marks.iter().any(|(_, k)| !(-3..4).contains(k));
    marks
        .into_iter()
        .map(|(m, k)| {
            let value = f64::from(m) * power(k);
            if !powers {
                let decimals = (-k).max(0) as usize;
                return Tick::plain(value, format!("{value:.decimals$}"));
            }
            Tick {
                value,
                text: if m == 1 { "10".into() } else { format!("{m}×10") },
                exponent: Some(minus(k.to_string())),
            }
        })
        .collect()
}

/// First and last whole power of ten inside an extent.
fn decades(extent: &Extent) -> (i32, i32) {
    ((extent.lo.log10() - 1e-9).ceil() as i32, (extent.hi.log10() + 1e-9).floor() as i32)
}

fn power(k: i32) -> f64 {
    10_f64.powi(k)
}

/// A typographic minus sign; the hyphen is easily overlooked in print.
fn minus(text: String) -> String {
    let zero = text.trim_start_matches('-').chars().all(|c| c == '0' || c == '.');
    if zero { text.trim_start_matches('-').to_owned() } else { text.replace('-', "−") }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texts(kind: Kind, lo: f64, hi: f64, most: usize) -> Vec<String> {
        ticks(&Extent { kind, lo, hi }, most)
            .into_iter()
            .map(|t| t.text + &t.exponent.map(|e| format!("^{e}")).unwrap_or_default())
            .collect()
    }

    #[test]
    fn linear_steps_are_one_two_or_five() {
        assert_eq!(texts(Kind::Linear, 0.0, 10.0, 5), ["0", "2", "4", "6", "8", "10"]);
        assert_eq!(texts(Kind::Linear, -0.12, 0.11, 5), ["−0.10", "−0.05", "0.00", "0.05", "0.10"]);
        assert_eq!(texts(Kind::Linear, 0.75, 6.25, 6), ["1", "2", "3", "4", "5", "6"]);
        assert_eq!(texts(Kind::Linear, 0.0, 2.1e6, 4), ["0", "1×10^6", "2×10^6"]);
    }

    #[test]
    fn log_ticks_are_decades() {
        assert_eq!(texts(Kind::Log, 0.02, 300.0, 8), ["0.1", "1", "10", "100"]);
        assert_eq!(texts(Kind::Log, 1e2, 1e6, 8), ["10^2", "10^3", "10^4", "10^5", "10^6"]);
        assert_eq!(texts(Kind::Log, 1e-4, 1e-2, 8), ["10^−4", "10^−3", "10^−2"]);
    }

    #[test]
    fn short_log_axes_add_two_and_five() {
        assert_eq!(texts(Kind::Log, 0.5, 20.0, 8), ["0.5", "1", "2", "5", "10", "20"]);
        assert_eq!(texts(Kind::Log, 1e4, 5e4, 8), ["10^4", "2×10^4", "5×10^4"]);
        // Less than a step between two marks: linear ticks.
        assert_eq!(texts(Kind::Log, 3.1, 4.1, 5), ["3.2", "3.4", "3.6", "3.8", "4.0"]);
    }

    #[test]
    fn long_log_axes_skip_decades() {
        let shown = texts(Kind::Log, 1e-100, 1e100, 6);
        assert!(shown.len() <= 7 && shown.contains(&"10^0".to_owned()), "{shown:?}");
    }

    #[test]
    fn minor_ticks_only_where_they_can_be_told_apart() {
        let kind = Kind::Log;
        let short = Extent { kind, lo: 1.0, hi: 100.0 };
        assert_eq!(minor(&short).len(), 16);
        let long = Extent { kind, lo: 1e-9, hi: 1e9 };
        assert!(minor(&long).is_empty());
    }
}
