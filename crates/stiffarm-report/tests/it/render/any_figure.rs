//! Figures of any content are drawn as sound SVG.

use super::*;

/// Any bit pattern, and ordinary values often enough to reach the drawing.
fn value() -> impl Strategy<Value = f64> {
    prop_oneof![any::<u64>().prop_map(f64::from_bits), -10.0..10.0_f64, (0..6_u8).prop_map(f64::from),]
}

fn axis() -> impl Strategy<Value = Axis> {
    (any::<bool>(), 0..5_usize, option::of([value(), value()]), any::<bool>(), any::<bool>()).prop_map(
        |(log, categories, range, named, from_zero)| Axis {
            label: "quantity".into(),
            unit: "unit".into(),
            scale: if log { Scale::Log } else { Scale::Linear },
            categories: if named { (0..categories).map(|c| format!("place number {c}")).collect() } else { Vec::new() },
            range,
            from_zero,
        },
    )
}

fn series() -> impl Strategy<Value = Series> {
    (
        0..STYLES.len(),
        0..4_u8,
        vec(value(), 0..12),
        vec(value(), 0..12),
        vec(value(), 0..12),
        option::of((axis(), vec(value(), 0..12))),
    )
        .prop_map(|(style, label, x, y, error, colour)| {
            let series = Series::new(format!("label {label}"), STYLES[style], x, y).with_error(error);
            match colour {
                Some((axis, values)) => series.with_colour(axis, values),
                None => series,
            }
        })
}

fn any_figure() -> impl Strategy<Value = Figure> {
    let panels = (axis(), axis(), vec(series(), 0..5), any::<bool>()).prop_map(|(x, y, series, equal_aspect)| Panel {
        title: "a title".into(),
        x,
        y,
        series,
        equal_aspect,
    });
    (any::<usize>(), 0..5_usize, vec(panels, 0..5))
        .prop_map(|(wild, tame, panels)| Figure { columns: if wild % 2 == 0 { wild } else { tame }, ..figure(panels) })
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 400,
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    #[test]
    fn any_values_give_a_sound_picture(f in any_figure()) {
        let svg = render_svg(&f);
        check(&svg);
        prop_assert_eq!(svg, render_svg(&f));
    }

    #[test]
    fn any_texts_give_a_sound_picture(texts in vec(any::<String>(), 8)) {
        let mut p = panel(
            Axis::categorical(&texts[0], [&texts[1], &texts[2]]),
            Axis::linear(&texts[3], &texts[4]),
            vec![Series::new(&texts[5], Style::Line, vec![0.0, 1.0], vec![1.0, 2.0])],
        );
        p.title.clone_from(&texts[6]);
        let mut f = figure(vec![p]);
        f.title.clone_from(&texts[7]);
        f.id.clone_from(&texts[7]);
        f.caption.clone_from(&texts[7]);
        let svg = render_svg(&f);
        prop_assert!(Document::parse(&svg).is_ok());
        prop_assert!(series_colour(&texts[5]).starts_with('#'));
    }
}
