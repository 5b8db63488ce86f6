//! Pictures as PNG.

use super::Fonts;
use png::{BitDepth, ColorType, Compression, Encoder, FilterType, PixelDimensions, Unit};
use resvg::tiny_skia::{Color, Pixmap, Transform};
use stiffarm::{Code, Error, Result};

/// Most pixels of a picture; each takes seven bytes while the file is made.
const MOST_PIXELS: f64 = 80e6;
/// Pixels of an SVG per inch.
const CSS_DPI: f64 = 96.0;

/// A picture of this crate as PNG with `dpi` pixels per inch, on white. The file
/// says how large it is on paper.
///
/// # Errors
/// The picture has more than 80 million pixels, or is no SVG.
pub fn to_png(svg: &str, dpi: f64, fonts: &Fonts) -> Result<Vec<u8>> {
    let tree = fonts.read(svg)?;
    let (width, height) = (
        f64::from(tree.size().width()),
        f64::from(tree.size().height()),
    );
    let scale = dpi / CSS_DPI;
    let [columns, rows] = [width, height].map(|length| (length * scale).round().max(1.0));
    let pixmap = (columns * rows <= MOST_PIXELS)
        .then(|| Pixmap::new(columns as u32, rows as u32))
        .flatten();
    let Some(mut pixmap) = pixmap else {
        let message = format!("A picture of {columns} × {rows} pixels is too large.");
        return Err(Error::new(Code::InvalidValue, message)
            .hint("state fewer dots per inch, or write PDF, which is sharp at every size"));
    };
    pixmap.fill(Color::WHITE);
    // Whole pixels: the picture is stretched by less than one.
    let stretched = Transform::from_scale((columns / width) as f32, (rows / height) as f32);
    resvg::render(&tree, stretched, &mut pixmap.as_mut());
    encoded(&pixmap, dpi).map_err(|error| {
        Error::new(
            Code::Internal,
            format!("The picture cannot be made: {error}."),
        )
    })
}

/// The pixels, which are opaque, without opacity.
fn encoded(pixmap: &Pixmap, dpi: f64) -> std::result::Result<Vec<u8>, png::EncodingError> {
    let per_metre = (dpi / 0.0254).round() as u32;
    let mut bytes = Vec::new();
    let mut encoder = Encoder::new(&mut bytes, pixmap.width(), pixmap.height());
    encoder.set_color(ColorType::Rgb);
    encoder.set_depth(BitDepth::Eight);
    // Few colours and large areas of one: a fifth of the size of what filters and quick compression give.
    encoder.set_compression(Compression::Default);
    encoder.set_filter(FilterType::NoFilter);
    encoder.set_pixel_dims(Some(PixelDimensions {
        xppu: per_metre,
        yppu: per_metre,
        unit: Unit::Meter,
    }));
    let mut colours = Vec::with_capacity(pixmap.data().len() / 4 * 3);
    for pixel in pixmap.data().chunks_exact(4) {
        colours.extend_from_slice(&pixel[..3]);
    }
    encoder.write_header()?.write_image_data(&colours)?;
    Ok(bytes)
}
