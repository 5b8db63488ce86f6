//! A face in a PDF: the glyphs that are used, their widths, and the text that they stand for.

use pdf_writer::types::{CidFontType, FontFlags, SystemInfo, UnicodeCmap};
use pdf_writer::{Filter, Finish, Name, Pdf, Rect, Ref, Str};
use resvg::usvg::fontdb::{Database, ID};
use std::collections::BTreeMap;
use stiffarm::{Code, Error, Result};
use subsetter::GlyphRemapper;
use ttf_parser::{Face, GlyphId, RawFace, Tag, name_id};

/// Compression as of zlib's usual level.
const LEVEL: u8 = 6;

const SYSTEM: SystemInfo = SystemInfo {
    registry: Str(b"Adobe"),
    ordering: Str(b"Identity"),
    supplement: 0,
};
/// Objects of a face in the file.
const OBJECTS: i32 = 5;
/// Most letters of a name that come from the font.
const NAME_LENGTH: usize = 60;

/// A face of which a subset goes into the file.
pub(super) struct Embedded {
    id: ID,
    data: Vec<u8>,
    index: u32,
    units_per_em: u16,
    subset: GlyphRemapper,
    /// Advance of each glyph in font units.
    advances: BTreeMap<u16, u16>,
    /// What each glyph of the subset stands for.
    texts: BTreeMap<u16, String>,
}

impl Embedded {
    /// # Errors
    /// The face cannot be read.
    pub fn new(database: &Database, id: ID) -> Result<Self> {
        let read = database.with_face_data(id, |data, index| (data.to_vec(), index));
        let (data, index) = read.ok_or_else(unreadable)?;
        let units_per_em = face(&data, index)?.units_per_em();
        Ok(Embedded {
            id,
            data,
            index,
            units_per_em,
            subset: GlyphRemapper::new(),
            advances: BTreeMap::new(),
            texts: BTreeMap::new(),
        })
    }

    pub fn id(&self) -> ID {
        self.id
    }

    pub fn units_per_em(&self) -> f32 {
        f32::from(self.units_per_em)
    }

    /// The code of a glyph in the file.
    pub fn code(&mut self, glyph: u16, text: &str) -> u16 {
        let code = self.subset.remap(glyph);
        self.texts.entry(code).or_insert_with(|| text.to_owned());
        code
    }

    /// How far the next glyph is \[font units\].
    pub fn advance(&mut self, glyph: u16) -> f32 {
        let (data, index) = (&self.data, self.index);
        let advance = self.advances.entry(glyph).or_insert_with(|| {
            let advance = face(data, index).map(|face| face.glyph_hor_advance(GlyphId(glyph)));
            advance.ok().flatten().unwrap_or(0)
        });
        f32::from(*advance)
    }

    /// Numbers of the objects of a face; the first names the face.
    pub fn references(next: &mut Ref) -> Ref {
        let first = *next;
        *next = Ref::new(first.get() + OBJECTS);
        first
    }

    /// Writes the face as the objects from `first` on.
    ///
    /// # Errors
    /// The face cannot be read.
    pub fn write(&self, pdf: &mut Pdf, first: Ref) -> Result<()> {
        let [cid, descriptor, cmap, file] =
            [1, 2, 3, 4].map(|offset| Ref::new(first.get() + offset));
        let face = face(&self.data, self.index)?;
        let subset =
            subsetter::subset(&self.data, self.index, &self.subset).map_err(|_| unreadable())?;
        // Of OpenType with PostScript outlines these alone.
        let outlines = RawFace::parse(&subset, 0).ok();
        let postscript = outlines.and_then(|raw| raw.table(Tag::from_bytes(b"CFF ")));
        let name = self.name(&face);
        let full = match postscript {
            Some(_) => format!("{name}-Identity-H"),
            None => name.clone(),
        };
        pdf.type0_font(first)
            .base_font(Name(full.as_bytes()))
            .encoding_predefined(Name(b"Identity-H"))
            .descendant_font(cid)
            .to_unicode(cmap);

        let thousandths = |value: f32| (value * 1000.0 / self.units_per_em()).round();
        let mut font = pdf.cid_font(cid);
        font.subtype(match postscript {
            Some(_) => CidFontType::Type0,
            None => CidFontType::Type2,
        });
        font.base_font(Name(name.as_bytes()))
            .system_info(SYSTEM)
            .font_descriptor(descriptor)
            .default_width(0.0);
        if postscript.is_none() {
            font.cid_to_gid_map_predefined(Name(b"Identity"));
        }
        let widths = self.subset.remapped_gids().map(|glyph| {
            let advance = face.glyph_hor_advance(GlyphId(glyph)).unwrap_or(0);
            thousandths(f32::from(advance))
        });
        font.widths().consecutive(0, widths);
        font.finish();

        let bounds = face.global_bounding_box();
        let ascent = f32::from(face.ascender());
        let mut flags = FontFlags::SYMBOLIC;
        flags.set(FontFlags::FIXED_PITCH, face.is_monospaced());
        flags.set(FontFlags::ITALIC, face.is_italic());
        let mut described = pdf.font_descriptor(descriptor);
        described
            .name(Name(name.as_bytes()))
            .flags(flags)
            .bbox(Rect::new(
                thousandths(f32::from(bounds.x_min)),
                thousandths(f32::from(bounds.y_min)),
                thousandths(f32::from(bounds.x_max)),
                thousandths(f32::from(bounds.y_max)),
            ))
            .italic_angle(face.italic_angle())
            .ascent(thousandths(ascent))
            .descent(thousandths(f32::from(face.descender())))
            .cap_height(thousandths(face.capital_height().map_or(ascent, f32::from)))
            // The file must state it, and viewers that have the outlines do not use it.
            .stem_v(80.0);
        match postscript {
            Some(_) => described.font_file3(file),
            None => described.font_file2(file),
        };
        described.finish();

        let mut texts = UnicodeCmap::new(Name(b"Texts"), SYSTEM);
        for (code, text) in self.texts.iter().filter(|(_, text)| !text.is_empty()) {
            texts.pair_with_multiple(*code, text.chars());
        }
        pdf.cmap(cmap, &texts.finish());

        let data = compressed(postscript.unwrap_or(&subset));
        let mut stream = pdf.stream(file, &data);
        stream.filter(Filter::FlateDecode);
        match postscript {
            Some(_) => stream.pair(Name(b"Subtype"), Name(b"CIDFontType0C")),
            None => stream.pair(Name(b"Length1"), i32::try_from(subset.len()).unwrap_or(0)),
        };
        stream.finish();
        Ok(())
    }

    /// The name of the face after six letters that tell its subset.
    fn name(&self, face: &Face<'_>) -> String {
        let names = face.names().into_iter();
        let mut postscript = names.filter(|name| name.name_id == name_id::POST_SCRIPT_NAME);
        let own = postscript
            .find_map(|name| name.to_string())
            .unwrap_or_default();
        let is_letter = |c: &char| c.is_ascii_alphanumeric() || *c == '-';
        let own: String = own.chars().filter(is_letter).take(NAME_LENGTH).collect();
        // FNV-1a of the glyphs.
        let mut hash = 0xcbf2_9ce4_8422_2325_u64;
        for byte in self.subset.remapped_gids().flat_map(u16::to_le_bytes) {
            hash = (hash ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3);
        }
        let letters = (0..6).map(|place| {
            let letter = (hash / 26_u64.pow(place) % 26) as u8;
            char::from(b'A' + letter)
        });
        format!("{}+{own}", letters.collect::<String>())
    }
}

fn face(data: &[u8], index: u32) -> Result<Face<'_>> {
    Face::parse(data, index).map_err(|_| unreadable())
}

fn unreadable() -> Error {
    Error::new(Code::Unsupported, "The font cannot be read.").hint("choose another font")
}

pub(super) fn compressed(bytes: &[u8]) -> Vec<u8> {
    miniz_oxide::deflate::compress_to_vec_zlib(bytes, LEVEL)
}
