//! Values of an index with its gradients.
//!
//! Smooth part + components. An index is exp(smooth + max of components). The
//! optimiser sees the components as constraints of an epigraph variable and
//! never differentiates a max().

/// ln of an index at one group, split into a smooth part and components.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Minimax {
    /// Smooth part; infinite where the index does not exist.
    pub smooth: f64,
    /// The same without the smoothing of coalescing singular values
    /// ([`set_sharpness`](super::IndexFunction::set_sharpness)); equal to `smooth` without smoothing.
    pub exact: f64,
    /// Its gradient with respect to all q, posture by posture \[1/rad\].
    pub smooth_gradient: Vec<f64>,
    /// Components; the index is `exp(smooth + max(components))`, and
    /// `exp(smooth)` without components.
    pub components: Vec<f64>,
    /// Gradients of the components, row by row \[1/rad\].
    pub component_gradients: Vec<f64>,
}

impl Minimax {
    /// ln of the index (of its reciprocal for O1 to O5).
    pub fn value(&self) -> f64 {
        let largest = self.components.iter().copied().reduce(f64::max);
        self.exact + largest.unwrap_or(0.0)
    }

    /// The value with the gradient \[1/rad\] of the first of the largest components; zeros where it is infinite.
    pub(super) fn value_and_gradient(self) -> (f64, Vec<f64>) {
        let value = self.value();
        let mut gradient = self.smooth_gradient;
        let components = self.components.iter().enumerate();
        let largest = components.reduce(|a, b| if b.1 > a.1 { b } else { a });
        if let (Some((at, _)), true) = (largest, value.is_finite()) {
            let size = gradient.len();
            let largest_gradient = &self.component_gradients[at * size..(at + 1) * size];
            gradient.iter_mut().zip(largest_gradient).for_each(|(g, slope)| *g += slope);
        }
        (value, gradient)
    }
}

/// ln of an index at one group, as one smooth function and exactly.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Smoothed {
    /// Smoothed value, plus the penalty of the limits where they are watched.
    pub objective: f64,
    /// The index itself: no smoothing, no penalty.
    pub exact: f64,
}

/// ln(Σ exp(p·(component − largest)))/p with p = `sharpness`: what the smoothed maximum
/// lies above the `largest` component; `weights` become the components' shares in its
/// derivative.
pub(super) fn log_sum(components: &[f64], largest: f64, sharpness: f64, weights: &mut [f64]) -> f64 {
    let mut sum = 0.0;
    for (weight, component) in weights.iter_mut().zip(components) {
        // Weights that count for nothing are zero, not slow tiny numbers.
        let exponent = sharpness * (component - largest);
        *weight = if exponent < -40.0 { 0.0 } else { exponent.exp() };
        sum += *weight;
    }
    for weight in weights.iter_mut() {
        *weight /= sum;
    }
    sum.ln() / sharpness
}
