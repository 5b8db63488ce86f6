//! What `study --measured` says: which postures and which model predict a measured robot.

use super::tables::data_table;
use crate::study::{measured_figure, measured_table};
use crate::summary::{Block, Context, DataTable, Number, Quantity, Section, Summarise, Summary, Text, with_stopped};
use stiffarm::Result;
use stiffarm::estimate::elastic::ElasticChoice;
use stiffarm::findings::{Severity, visible};
use stiffarm::study::{Choice, MeasuredStudy};

impl<O> Summarise<O> for MeasuredStudy {
    fn summary(&self, _options: &O, context: &Context<'_>) -> Result<Summary> {
        let study = self;
        let what_was_done = Text::new(format!(
            "{} measured postures of {} were split {} times into a pool of {} and {} to be predicted; postures were \
         chosen from the pool by chance and by index, and predicted the others.",
            study.posture_count,
            visible(&study.robot),
            study.split_count,
            study.pool_count,
            study.posture_count - study.pool_count
        ));
        let mm = |length: f64| Number::new(length).of(Quantity::LENGTH);
        let fewest = study.options.counts.iter().copied().min().unwrap_or(0);
        let has_mean = |i: &usize| study.choices[*i].mean_m.is_finite();
        let mean = |i: &usize| study.choices[*i].mean_m;
        let of_fewest = (0..study.choices.len())
            .filter(|i| study.choices[*i].postures == fewest)
            .filter(|i| study.choices[*i].choice != Choice::Pool)
            .filter(has_mean);
        let best = of_fewest.min_by(|a, b| mean(a).total_cmp(&mean(b)));
        let whole = (0..study.choices.len()).find(|i| {
            let way = &study.choices[*i];
            way.choice == Choice::Pool && way.model == ElasticChoice::Axes
        });
        let conclusion = match best {
            None => Text::new("No choice of postures predicts the others."),
            Some(i) => {
                let way = &study.choices[i];
                let mut text = Text::new(format!(
                    "With {fewest} postures, those chosen by {} with the {} predict best: the others are missed by ",
                    in_words(way.choice),
                    way.model.in_words()
                ))
                .number(mm(way.mean_m))
                .words(" ")
                .number(mm(way.standard_error_m).plus_minus());
                if let Some(whole) = whole.filter(has_mean) {
                    text = text
                        .words(format!(
                            ", all {} of the pool with the joint axes alone miss them by ",
                            study.pool_count
                        ))
                        .number(mm(study.choices[whole].mean_m));
                }
                text.words(" (RMS of a component).")
            }
        };
        let next_step = match best.map(|i| &study.choices[i]) {
            Some(way) => {
                let text = Text::new("For the next robot of this kind choose postures with ");
                let text = match way.choice {
                    Choice::Index(index) => {
                        text.code(format!("stiffarm select --index {}", in_words(Choice::Index(index))))
                    }
                    _ => text.code("stiffarm select"),
                };
                match way.model {
                    ElasticChoice::Mixed => {
                        text.words(", and identify as ever: more than the joint axes gives way here.")
                    }
                    _ => text.words(", and identify with ").code("--elastic axes").words("."),
                }
            }
            None => Text::new("Measure more postures: these do not determine every joint in any split."),
        };
        let notes = study.findings.iter().filter(|f| f.severity == Severity::Note);
        let notes: Vec<Text> = notes.map(|f| Text::from(f.sentence.as_str())).collect();
        let how = Text::new("The measured displacements have an RMS of ")
        .number(Number::new(study.displacement_rms_m).of(Quantity::LENGTH))
        .words(
            ". An index knows angles and wrenches but no reading. Joint stiffness, or the mixed model with its sizes, \
             is identified from the chosen postures alone and predicts the others. The index prediction takes the \
             pool's own postures for the work to be done. Splits share postures: standard errors are those of the mean \
             over splits, not over robots.",
        );
        let mut blocks = vec![Block::Figure(measured_figure(study)), Block::Text(how)];
        if !notes.is_empty() {
            blocks.push(Block::List(notes));
        }
        let sections = vec![
            Section::new("choices", "Ways to choose postures", blocks),
            Section::new("table", "All ways with both models", vec![Block::Table(data_table(&measured_table(study)))]),
        ];
        let heading = format!("Choosing postures on measured readings: {}", visible(&study.cell));
        let is_stopped = study.split_count < study.options.splits;
        let findings = with_stopped(context, study.findings.clone(), is_stopped, &[]);
        let verdict = [what_was_done, conclusion, next_step];
        let mut summary = context.summary(findings, heading, verdict, Some(key(study)), sections);
        // The notes are all told above.
        summary.findings.retain(|f| f.severity > Severity::Note);
        Ok(summary)
    }
}

/// Every way to choose, with both models side by side.
fn key(study: &MeasuredStudy) -> DataTable {
    let all = study.choices.iter();
    let rows: Vec<_> = all.filter(|c| c.model == ElasticChoice::Axes).collect();
    let place = |row: usize, model: ElasticChoice| {
        let way = rows[row];
        let mut all = study.choices.iter();
        all.find(|c| (c.postures, c.choice, c.model) == (way.postures, way.choice, model))
    };
    let mm = |length: f64| Number::new(length).of(Quantity::LENGTH.bare());
    let mut table = DataTable::of(
        "RMS error of a displacement component at the postures outside the pool, ± its standard error, and share \
         of the splits in which the choice predicts better than chance",
        "postures, chosen by",
        rows.iter().map(|way| format!("{}, {}", way.postures, in_words(way.choice))),
    );
    let models = [ElasticChoice::Axes, ElasticChoice::Mixed];
    for model in models {
        table = table.words(format!("{} [mm]", model.in_words()), |row| match place(row, model) {
            Some(way) => Text::from(mm(way.mean_m)).words(" ").number(mm(way.standard_error_m).plus_minus()),
            None => Text::default(),
        });
    }
    for model in models {
        let heading = format!("better than chance, {}", model.in_words());
        table = table.numbers(&heading, Quantity::PERCENT.digits(3), |row| {
            place(row, model)?.better_than_random.map(Number::new)
        });
    }
    table
}

/// A way to choose in a sentence.
fn in_words(choice: Choice) -> String {
    match choice {
        Choice::Random => "chance".to_string(),
        Choice::Index(index) => index.as_str().replace('_', "-"),
        Choice::Pool => "whole pool".to_string(),
    }
}
