//! Statistics of a sample of numbers.

/// Arithmetic mean; NaN-free for non-empty finite input.
pub(crate) fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Standard error of the mean; zero for a single value.
pub(crate) fn standard_error(values: &[f64]) -> f64 {
    if values.len() < 2 {
        return 0.0;
    }
    let m = mean(values);
    let sum: f64 = values.iter().map(|v| (v - m).powi(2)).sum();
    (sum / (values.len() - 1) as f64 / values.len() as f64).sqrt()
}

/// Median; the mean of the two middle values for an even count.
pub(crate) fn median(values: &[f64]) -> f64 {
    quantile_of(values, 0.5)
}

/// Quantile by linear interpolation between order statistics.
pub(crate) fn quantile_of(values: &[f64], p: f64) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let at = p * (sorted.len() - 1) as f64;
    let (low, high) = (at.floor() as usize, at.ceil() as usize);
    sorted[low] + (sorted[high] - sorted[low]) * (at - low as f64)
}
