//! Drawings of any content are drawn as sound SVG.

use super::*;
use stiffarm_report::figure::drawing::{Drawing, KeyEntry, Label, Mark, Note, Sample, Shape, Tone, View};
use stiffarm_report::render_drawing;

const TONES: [Tone; 14] = [
    Tone::Body,
    Tone::Attached,
    Tone::Skeleton,
    Tone::Fixed,
    Tone::Ground,
    Tone::Bound,
    Tone::Pull,
    Tone::Ray,
    Tone::FaintRay,
    Tone::Target,
    Tone::Triad,
    Tone::Item(0),
    Tone::Item(41),
    Tone::Item(usize::MAX),
];

const SAMPLES: [Sample; 5] = [Sample::Area, Sample::Line, Sample::Arrow, Sample::Point, Sample::LineAndPoint];

/// Any bit pattern, and ordinary values often enough to reach the drawing.
fn value() -> impl Strategy<Value = f64> {
    prop_oneof![any::<u64>().prop_map(f64::from_bits), -10.0..10.0_f64, -10.0..10.0_f64, (0..6_u8).prop_map(f64::from),]
}

fn place() -> impl Strategy<Value = [f64; 2]> {
    [value(), value()]
}

fn mark() -> impl Strategy<Value = Mark> {
    let shape = prop_oneof![
        vec(place(), 0..8).prop_map(Shape::Area),
        vec(place(), 0..8).prop_map(Shape::Line),
        [place(), place()].prop_map(Shape::Arrow),
        place().prop_map(Shape::Point),
    ];
    (shape, 0..TONES.len(), any::<bool>())
        .prop_map(|(shape, tone, red)| Mark::new(shape, TONES[tone]).with_caution(red))
}

fn view() -> impl Strategy<Value = View> {
    let label = (place(), any::<bool>()).prop_map(|(at, caution)| Label {
        at,
        text: "a name".into(),
        caution,
        cluster: if caution { "names" } else { "" }.into(),
    });
    let parts = ([place(), place()], any::<bool>(), vec(mark(), 0..12), vec(label, 0..6));
    parts.prop_map(|(extent, axes, marks, labels)| View {
        title: "a view".into(),
        axes: axes.then(|| [Axis::linear("x", "mm"), Axis::linear("z", "mm")]),
        extent,
        marks,
        labels,
    })
}

fn drawing(views: Vec<View>, texts: &[String]) -> Drawing {
    let keys = texts.iter().enumerate();
    Drawing {
        id: "test".into(),
        title: texts.first().cloned().unwrap_or_default(),
        caption: "caption".into(),
        notes: texts.iter().map(Note::caution).collect(),
        views,
        key: keys
            .map(|(i, text)| KeyEntry {
                label: text.clone(),
                sample: SAMPLES[i % SAMPLES.len()],
                tone: TONES[i % TONES.len()],
                caution: i % 2 == 0,
            })
            .collect(),
    }
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 400,
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    #[test]
    fn any_values_give_a_sound_drawing(views in vec(view(), 0..5), count in 0..40_usize) {
        let texts: Vec<String> = (0..count).map(|i| format!("number {i} of these")).collect();
        let drawing = drawing(views, &texts);
        let svg = render_drawing(&drawing);
        check(&svg);
        prop_assert_eq!(svg, render_drawing(&drawing));
    }

    #[test]
    fn any_names_give_a_sound_drawing(texts in vec(any::<String>(), 6)) {
        prop_assert!(Document::parse(&render_drawing(&drawing(Vec::new(), &texts))).is_ok());
    }
}

#[test]
fn labels_of_a_very_narrow_view_are_not_cut_off() {
    for size in [5e-324, 7e-241, 1e-12, 1e-4, 1e-3, 1.0, 1e5, 1e8] {
        for part in [2e-9, 1e-8, 1e-7, 1.0] {
            let from = -1.234_567_8 * size;
            let narrow = [from, from + part * size];
            let view = View {
                title: "a view".into(),
                axes: Some([Axis::linear("x", "mm"), Axis::linear("z", "mm")]),
                extent: [narrow, narrow],
                marks: Vec::new(),
                labels: Vec::new(),
            };
            check(&render_drawing(&drawing(vec![view], &[])));
        }
    }
}
