//! Slips: what people type, name or exchange wrongly, each a value that says what undoes it, what speaks against it
//! beforehand and what it is called. Checks propose slips and say what undoing each leaves; [`settle`] decides.

use super::frame::{rms, state_pairs};
use super::sheet::{Sheet, State};
use super::units::Unit;
use super::{ALIKE_MISFIT_RATIO, BELIEVED_RATIO, Cause, FITTED_RATIO, Suspicion, Work, rigid, tool, words};
use crate::findings::each_once;
use crate::model::cell::Cell;
use crate::model::load::Load;
use crate::numerics::order::sort_by_number;
use crate::units::rad_to_deg;
use nalgebra::{Isometry3, Matrix3};

/// Posture and state of a row.
pub(super) type StateIndex = (usize, usize);

/// What undoes a slip: in rows of the table, then in the cell.
#[derive(Debug, Clone)]
pub(super) enum Undo {
    /// The tracker's axes are mirrored; this turns them back.
    Mirror(Matrix3<f64>),
    /// Points labelled in another order: `order[a]` is where the reading labelled `a` was taken.
    Order(Vec<usize>),
    /// One reading is left out.
    Stray(usize),
    /// A joint's angle has an offset \[rad\].
    Offset(usize, f64),
    /// A joint's angle as written, and as it is \[rad\].
    Angle(usize, [f64; 2]),
    /// Taken at the angles of another posture, by the row that stands for it \[rad\].
    AnglesOf(StateIndex, Vec<f64>),
    /// Likewise, and the other's rows belong here.
    Exchange(StateIndex, Vec<f64>),
    /// Load cases named in another order.
    Cases(Vec<usize>),
    /// Forces alone are this many times what is typed.
    Forces(f64),
    /// What the cause says is in another unit, in rows or in the cell.
    Times(Cause, Unit),
    /// These joints turn the other way, and perhaps axis 3 follows axis 2 by another factor.
    Chain(Vec<usize>, Option<f64>),
    /// The Denavit–Hartenberg rows are meant in the other convention.
    Convention,
    /// The measuring points sit elsewhere on the flange.
    Tool(Isometry3<f64>),
}

/// One slip.
#[derive(Debug, Clone)]
pub(super) struct Slip {
    pub undo: Undo,
    /// The rows it is in; `None`: all, or the cell.
    pub at: Option<Vec<StateIndex>>,
    /// What speaks against it beforehand: slips that it takes at once, or how rare it is (logarithm).
    pub cost: f64,
}

impl Slip {
    /// A slip throughout.
    pub fn new(undo: Undo) -> Self {
        let cost = match &undo {
            // It explains two postures.
            Undo::Exchange(..) => 0.0,
            Undo::Order(order) => moved(order).count() as f64 - 1.0,
            Undo::Chain(signs, coupling) => signs.len() as f64 + f64::from(coupling.is_some()),
            // A number is fitted, but where it is the one written with the other sign.
            Undo::Angle(_, [written, likely]) if *likely == -written => 1.0,
            Undo::Angle(..) | Undo::Offset(..) => 2.0,
            Undo::Tool(_) => 6.0,
            Undo::Times(cause, unit) if !matches!(cause, Cause::Radians | Cause::Degrees) => unit.rare,
            _ => 1.0,
        };
        let at = None;
        Slip { undo, at, cost }
    }

    /// The slip in these rows alone.
    pub fn at(self, at: &[StateIndex]) -> Self {
        Slip { at: Some(at.to_vec()), ..self }
    }

    /// True where a number was sought that suits the readings.
    fn is_fitted(&self) -> bool {
        matches!(self.undo, Undo::Angle(..) | Undo::Offset(..)) && self.cost > 1.0
    }

    /// Undoes the slip.
    pub fn undo(&self, work: &mut Work) {
        let setup = &mut work.cell.setup;
        match &self.undo {
            Undo::Chain(signs, factor) => {
                let mut coupling = setup.robot.coupling().clone();
                if let Some(factor) = factor {
                    coupling[(2, 1)] = *factor;
                }
                for j in signs {
                    coupling.column_mut(*j).neg_mut();
                }
                // A chain that cannot be built stays as it was, and explains nothing.
                if let Ok(robot) = setup.robot.clone().with_coupling(coupling) {
                    setup.robot = robot;
                }
            }
            Undo::Convention => {
                if let Some(robot) = setup.robot.in_other_convention() {
                    setup.robot = robot;
                }
            }
            Undo::Tool(motion) => {
                for point in &mut setup.tool.measuring_points {
                    point.position = rigid::moved(motion, &point.position);
                }
            }
            Undo::Times(Cause::ToolUnits, unit) => {
                for point in &mut setup.tool.measuring_points {
                    point.position *= unit.factor;
                }
            }
            Undo::Times(Cause::AnchorUnits, unit) => scale_anchors(&mut setup.load, unit.factor),
            Undo::Times(Cause::LoadingPointUnits, unit) => setup.tool.loading_point *= unit.factor,
            Undo::Times(Cause::PriorUnits, unit) => {
                for k in work.cell.prior.iter_mut().flatten() {
                    *k *= unit.factor;
                }
            }
            Undo::AnglesOf(of, _) | Undo::Exchange(of, _) if !self.is_whole(&work.sheet) => {
                // A row is not at home among other angles than its posture's: it changes place, or nothing is known of
                // it.
                for at in self.at.iter().flatten() {
                    if let Undo::Exchange(..) = self.undo {
                        work.sheet.exchange(*at, *of);
                    } else {
                        work.sheet.at_mut(*at).points.fill(None);
                    }
                }
            }
            _ => {
                let Work { cell, sheet, .. } = work;
                if let (Undo::Exchange(of, _), Some([place, ..])) = (&self.undo, self.at.as_deref()) {
                    let q = sheet.at(*place).q.clone();
                    for state in &mut sheet.postures[of.0].states {
                        state.q.clone_from(&q);
                    }
                }
                for (p, posture) in sheet.postures.iter_mut().enumerate() {
                    for (s, state) in posture.states.iter_mut().enumerate() {
                        if self.at.as_ref().is_none_or(|at| at.contains(&(p, s))) {
                            self.undo_in(state, cell);
                        }
                    }
                }
            }
        }
    }

    /// True where it is in all rows of its posture.
    fn is_whole(&self, sheet: &Sheet) -> bool {
        let at = self.at.as_deref().unwrap_or_default();
        at.first().is_some_and(|(p, _)| at.len() == sheet.postures[*p].states.len())
    }

    /// Undoes the slip in one row.
    pub fn undo_in(&self, state: &mut State, cell: &Cell) {
        match &self.undo {
            Undo::Mirror(undo) => state.each_position(|p| *p = undo * *p),
            Undo::Order(order) => state.relabel(order),
            Undo::Stray(a) => {
                state.points[*a] = None;
                state.doubtful.clear();
            }
            Undo::Offset(j, offset) => state.q[*j] += offset,
            Undo::Angle(j, [written, likely]) => state.q[*j] += likely - written,
            Undo::AnglesOf(_, q) | Undo::Exchange(_, q) => state.q.clone_from(q),
            Undo::Cases(order) => {
                let cases = cell.setup.load.cases();
                if let Some(c) = cases.iter().position(|case| case.is_of(&state.name)) {
                    let rest = &state.name[cases[c].name.len()..];
                    state.name = format!("{}{rest}", cases[order[c]].name);
                }
            }
            Undo::Forces(factor) => state.wrench.iter_mut().for_each(|w| w.force *= *factor),
            Undo::Times(cause, Unit { factor, .. }) => match cause {
                Cause::Radians | Cause::Degrees => state.q.iter_mut().for_each(|q| *q *= factor),
                Cause::LoadUnits | Cause::LoadEntry => {
                    state.load = state.load.map(|l| l * factor);
                    if let Some(wrench) = &mut state.wrench {
                        wrench.force *= *factor;
                        wrench.moment *= *factor;
                    }
                }
                Cause::MomentUnits => state.wrench.iter_mut().for_each(|w| w.moment *= *factor),
                // Displacements are positions from an origin.
                Cause::DisplacementUnits => state.each_position(|p| *p *= *factor),
                // The factor is that of what is read to what is meant.
                Cause::Units => state.each_position(|p| *p /= *factor),
                _ => {}
            },
            Undo::Chain(..) | Undo::Convention | Undo::Tool(_) => {}
        }
    }

    /// Misfit of one row with the slip undone in it; `None` without readings.
    pub fn left(&self, work: &Work, transform: &Isometry3<f64>, at: StateIndex) -> Option<f64> {
        let mut state = work.sheet.at(at).clone();
        self.undo_in(&mut state, &work.cell);
        let pairs = state_pairs(&state.points, &work.predicted(&state.q));
        (!pairs.is_empty()).then(|| rms(transform, &pairs))
    }

    /// What is said of it, without misfits.
    pub fn suspicion(&self, work: &Work) -> Suspicion {
        let with = |cause, joints: &[usize], angles: &[f64]| {
            let mut out = Suspicion::new(cause).joints(&work.cell, joints);
            out.angles_deg = angles.iter().map(|a| rad_to_deg(*a)).collect();
            out
        };
        let mut out = match &self.undo {
            Undo::Mirror(_) => Suspicion::new(Cause::MirroredFrame),
            Undo::Convention => Suspicion::new(Cause::DhConvention),
            Undo::Tool(motion) => tool::suspicion(motion),
            Undo::Order(order) => {
                Suspicion::new(Cause::ExchangedPoints).points(moved(order).map(|a| work.point_name(a)))
            }
            Undo::Stray(a) => {
                let at = self.at.as_deref().unwrap_or_default();
                let mut out = Suspicion::new(match at.len() {
                    1 => Cause::StrayReading,
                    _ => Cause::MovedReflector,
                });
                let lines = at.iter().flat_map(|at| &work.sheet.at(*at).lines[*a]);
                out.lines = lines.copied().collect();
                out.points([work.point_name(*a)])
            }
            Undo::Chain(signs, None) => with(Cause::JointSign, signs, &[]),
            Undo::Chain(signs, factor) => Suspicion { factor: *factor, ..with(Cause::Coupling, signs, &[]) },
            Undo::Offset(j, offset) => with(Cause::JointOffset, &[*j], &[*offset]),
            Undo::Angle(j, angles) if self.is_fitted() => with(Cause::MistypedAngle, &[*j], angles),
            Undo::Angle(j, angles) => with(Cause::AngleSign, &[*j], angles),
            Undo::AnglesOf(..) => Suspicion::new(Cause::OtherPosture),
            Undo::Exchange(..) => Suspicion::new(Cause::ExchangedPostures),
            Undo::Cases(order) => {
                let cases = work.setup().load.cases();
                let mut out = Suspicion::new(Cause::ExchangedLoadCases);
                out.states = moved(order).map(|c| cases[c].name.clone()).collect();
                out
            }
            Undo::Forces(factor) => Suspicion { factor: Some(*factor), ..Suspicion::new(Cause::LoadUnits) },
            Undo::Times(cause, unit) => {
                // The place of the arm says angles without a factor.
                let has_factor = work.is_displacements || !matches!(cause, Cause::Radians | Cause::Degrees);
                Suspicion { factor: has_factor.then_some(unit.factor), ..Suspicion::new(*cause) }
            }
        };
        if let Some(at) = &self.at {
            out = name_states(work, out, at);
        }
        if let Undo::AnglesOf((k, _), _) | Undo::Exchange((k, _), _) = self.undo {
            out = out.posture(&work.sheet.postures[k].name);
            let is_before = self.at.iter().flatten().all(|(p, _)| k < *p);
            if is_before && out.cause == Cause::ExchangedPostures {
                out.postures.reverse();
            }
        }
        out
    }
}

/// Adds the names of postures, and of the state where it is always the same.
pub(super) fn name_states(work: &Work, mut to: Suspicion, at: &[(usize, usize)]) -> Suspicion {
    for &(p, s) in at {
        let posture = &work.sheet.postures[p];
        if !to.postures.contains(&posture.name) {
            to.postures.push(posture.name.clone());
        }
        let state = &posture.states[s].name;
        let whole = (0..posture.states.len()).all(|other| at.contains(&(p, other)));
        if !whole && !to.states.contains(state) {
            to.states.push(state.clone());
        }
    }
    to
}

/// What an order moves.
fn moved(order: &[usize]) -> impl Iterator<Item = usize> {
    (0..order.len()).filter(|i| order[*i] != *i)
}

fn scale_anchors(load: &mut Load, factor: f64) {
    match load {
        Load::Rope { anchor, .. } => *anchor *= factor,
        Load::Cases(cases) => {
            for case in cases {
                scale_anchors(&mut case.load, factor);
            }
        }
        _ => {}
    }
}

/// What undoing a slip must do for it to be believed, and which slips explain alike.
pub(super) struct Rule {
    /// Largest misfit that is left.
    pub most: f64,
    /// The best misfit times the first and plus the second of these is alike.
    pub alike: [f64; 2],
    /// How much more may speak against a slip that is named beside the likeliest.
    pub beside: f64,
}

impl Rule {
    /// Where points are held against the kinematic model: believed by a fifth of `before`, and `most` at most.
    pub fn of_places(work: &Work, before: f64, most: f64) -> Self {
        Rule {
            most: most.min(before / BELIEVED_RATIO),
            alike: [ALIKE_MISFIT_RATIO, FITTED_RATIO * work.sheet.typical_std()],
            beside: 0.0,
        }
    }
}

/// What was settled on.
#[derive(Debug, Clone)]
pub(super) struct SettledSlip {
    pub slip: Slip,
    /// What undoing it leaves.
    pub after: f64,
    /// Slips that explain alike, the likeliest first.
    pub others: Vec<Slip>,
}

/// The likeliest of the slips that explain alike; beside each stands what undoing it leaves. `None` where no slip is
/// believed.
pub(super) fn settle(tried: impl IntoIterator<Item = (Slip, Option<f64>)>, rule: &Rule) -> Option<SettledSlip> {
    let believed = tried.into_iter().filter_map(|(slip, after)| {
        let after = after.filter(|after| *after <= rule.most)?;
        Some((slip, after))
    });
    let mut believed: Vec<(Slip, f64)> = believed.collect();
    let weighed = |(slip, after): &(Slip, f64)| match slip.is_fitted() {
        true => after * FITTED_RATIO,
        false => *after,
    };
    let best = believed.iter().map(weighed).reduce(f64::min)?;
    believed.retain(|one| weighed(one) <= rule.alike[0] * best + rule.alike[1]);
    sort_by_number(&mut believed, |(_, after)| *after);
    sort_by_number(&mut believed, |(slip, _)| slip.cost);
    let mut all = believed.into_iter();
    let (slip, after) = all.next()?;
    let others = all.map(|(other, _)| other);
    let others = others.filter(|other| other.cost <= slip.cost + rule.beside);
    Some(SettledSlip { others: others.collect(), slip, after })
}

impl SettledSlip {
    /// What is said of it: the likeliest slip, and the others in words.
    pub fn suspicion(&self, work: &Work) -> Suspicion {
        let phrase = |slip: &Slip| words::cause(&work.cell, &slip.suspicion(work));
        let mut out = self.slip.suspicion(work);
        let likeliest = phrase(&self.slip);
        let others = self.others.iter().map(phrase);
        // The sign of an angle is tried both as it stands and as fitted.
        let others: Vec<String> = others.filter(|other| *other != likeliest).collect();
        out.alternatives = each_once(&others);
        out.certain = out.alternatives.is_empty();
        out
    }
}
