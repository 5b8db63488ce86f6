//! What `coverage` says: how often the intervals held the truth, joint by joint.

use super::{Context, DataTable, Number, Quantity, Summarise, Summary, Text};
use stiffarm::Result;
use stiffarm::ask::coverage::CoverageOptions;
use stiffarm::estimate::coverage::Coverage;
use stiffarm::findings::visible;

/// A share of many experiments.
const SHARE: Quantity = Quantity::PERCENT.digits(3);
/// Standard errors away from what is promised where chance no longer explains it.
const FAR: f64 = 3.0;

impl Summarise<CoverageOptions> for Coverage {
    fn summary(&self, options: &CoverageOptions, context: &Context<'_>) -> Result<Summary> {
        let coverage = self;
        let promised = options.fit.confidence;
        let off = (coverage.coverage - promised) / coverage.standard_error.max(f64::MIN_POSITIVE);
        let what_was_done = Text::new(format!(
            "{} experiments were simulated with the cell\u{2019}s noise alone and identified, the truth being the \
             cell\u{2019}s prior.",
            coverage.experiments
        ));
        let conclusion = Text::new("The intervals held the truth in ")
            .number(Number::new(coverage.coverage).of(SHARE))
            .words(" (standard error ")
            .number(Number::new(coverage.standard_error).of(Quantity::PERCENT))
            .words(") of all these joints and experiments; they promise ")
            .number(Number::computed(promised).of(SHARE))
            .words(".");
        let next_step = match off {
            off if off < -FAR => {
                "They are too narrow for this plan: choose another estimator, or measure more postures."
            }
            off if off > FAR => "They are wider than they need to be, which is safe.",
            _ => "They keep what they promise, as far as noise alone is concerned.",
        };
        let joint = |j: usize| &coverage.joints[j];
        let share = |share: f64| (share > 0.0).then(|| Number::new(share));
        let names = coverage.joints.iter().map(|j| visible(&j.name).into_owned());
        let key = DataTable::of("How often the interval of each joint held its stiffness", "joint", names)
            .numbers("held", SHARE, |j| Some(Number::new(joint(j).coverage)))
            .numbers("mean half width", Quantity::PERCENT, |j| Some(Number::new(joint(j).relative_half_width)))
            .numbers("only a lower end", Quantity::PERCENT, |j| share(joint(j).open_above))
            .numbers("no interval", Quantity::PERCENT, |j| share(joint(j).without_interval));
        Ok(context.summary(
            coverage.findings.clone(),
            "Coverage of the intervals",
            [what_was_done, conclusion, next_step.into()],
            Some(key),
            Vec::new(),
        ))
    }
}
