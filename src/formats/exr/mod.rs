//! OpenEXR: linear light and its layers out, environments in.
//!
//! A still is one part of 32-bit channels, losslessly compressed: `R G B A` (linear
//! sRGB, premultiplied, never denoised), `albedo.R/G/B`, `normal.X/Y/Z` (cloth space),
//! `depth.Z` (mm), `yarn.ID` (unsigned; 4294967295 = nothing) and `variance.Y` (of the
//! pixel's mean luminance). Films of equal runs are files of equal bytes. `environment`
//! reads the light of a picture, `header` puts a header's attributes in order.

mod environment;
mod header;

pub use environment::{Environment, FIELDS, read_environment};

use std::io::Cursor;
use std::path::{Path, PathBuf};

use exr::meta::attribute::{AttributeValue, Text};
use exr::prelude::{
    AnyChannel, AnyChannels, Compression, Encoding, FlatSamples, Image, ImageAttributes, Layer,
    LayerAttributes, LineOrder, SpecificChannels, WritableImage,
};
use glam::Vec3;

use crate::atomic;
use crate::film::Film;
use crate::memory::TooMuch;

/// Channel value of `yarn.ID` where nothing was met.
pub const NO_YARN: u32 = u32::MAX;

/// Why an EXR could not be read or written.
#[derive(Debug, thiserror::Error)]
pub enum ExrError {
    /// The file could not be written.
    #[error(transparent)]
    Write(#[from] atomic::WriteError),
    /// The codec refused.
    #[error("exr: {0}; check that the file is a complete OpenEXR picture")]
    Codec(#[from] exr::error::Error),
    /// A file could not be read.
    #[error("{path}: {source}; check the path and that you may read it", path = path.display())]
    File {
        /// Where.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// A file that is no sound OpenEXR picture.
    #[error(
        "{path}: {problem}; check that the file is a complete OpenEXR picture",
        path = path.display()
    )]
    Damaged {
        /// Where.
        path: PathBuf,
        /// What is wrong.
        problem: String,
    },
    /// A picture that is no environment.
    #[error("{path}: {problem}; {remedy}", path = path.display())]
    Unsuitable {
        /// Where.
        path: PathBuf,
        /// What is wrong.
        problem: String,
        /// What to do about it.
        remedy: &'static str,
    },
    /// A picture that takes more memory than there is.
    #[error(transparent)]
    Memory(#[from] TooMuch),
}

/// Encodes a film into the bytes of an EXR file. `texts` become string attributes;
/// `pixels_per_mm` the attribute `pixelsPerMillimetre`.
pub fn encode(
    film: &Film,
    pixels_per_mm: f32,
    texts: &[(String, String)],
) -> Result<Vec<u8>, ExrError> {
    let size = (film.width() as usize, film.height() as usize);
    let mut attributes = LayerAttributes::named("still");
    for (keyword, text) in texts {
        attributes.other.insert(
            Text::new_or_none(keyword).unwrap_or_default(),
            AttributeValue::Text(
                text.as_str()
                    .chars()
                    .filter(char::is_ascii)
                    .collect::<String>()
                    .as_str()
                    .into(),
            ),
        );
    }
    attributes.other.insert(
        "pixelsPerMillimetre".into(),
        AttributeValue::F32(pixels_per_mm),
    );
    let encoding = Encoding {
        compression: Compression::ZIP16,
        line_order: LineOrder::Increasing,
        ..Encoding::SMALL_LOSSLESS
    };
    let layer = Layer::new(size, attributes, encoding, channels(film));
    let mut image = Image::from_layer(layer);
    image.attributes = ImageAttributes::with_size(size);
    let mut bytes = Cursor::new(Vec::new());
    image.write().to_buffered(&mut bytes)?;
    Ok(header::in_order(bytes.into_inner()))
}

/// Encodes a linear RGB picture of `width`×`height` pixels, top row first, into the bytes
/// of an EXR file.
///
/// # Errors
/// When the codec refuses.
pub fn encode_rgb(
    width: usize,
    height: usize,
    pixel: impl Fn(usize, usize) -> Vec3 + Sync,
) -> Result<Vec<u8>, ExrError> {
    let channels = SpecificChannels::rgb(|at: exr::math::Vec2<usize>| {
        let Vec3 { x, y, z } = pixel(at.x(), at.y());
        (x, y, z)
    });
    let layer = Layer::new(
        (width, height),
        LayerAttributes::named("sky"),
        Encoding::SMALL_LOSSLESS,
        channels,
    );
    let mut bytes = Cursor::new(Vec::new());
    Image::from_layer(layer).write().to_buffered(&mut bytes)?;
    Ok(header::in_order(bytes.into_inner()))
}

/// Writes a film as an EXR file, whole or not at all.
pub fn write(
    path: &Path,
    film: &Film,
    pixels_per_mm: f32,
    texts: &[(String, String)],
) -> Result<(), ExrError> {
    let bytes = encode(film, pixels_per_mm, texts)?;
    Ok(atomic::write(path, &bytes)?)
}

fn channels(film: &Film) -> AnyChannels<FlatSamples> {
    let pixels = film.pixels();
    let float = |name: &str, value: &dyn Fn(&crate::film::Pixel) -> f32| {
        AnyChannel::new(name, FlatSamples::F32(pixels.iter().map(value).collect()))
    };
    let mut list = vec![
        float("R", &|p| p.mean().x),
        float("G", &|p| p.mean().y),
        float("B", &|p| p.mean().z),
        float("A", &|p| p.alpha()),
        float("albedo.R", &|p| p.albedo().x),
        float("albedo.G", &|p| p.albedo().y),
        float("albedo.B", &|p| p.albedo().z),
        float("normal.X", &|p| p.normal().x),
        float("normal.Y", &|p| p.normal().y),
        float("normal.Z", &|p| p.normal().z),
        float("depth.Z", &|p| p.depth()),
        float("variance.Y", &|p| p.variance() as f32),
    ];
    let yarns = pixels.iter().map(|p| p.optics().unwrap_or(NO_YARN));
    list.push(AnyChannel::new(
        "yarn.ID",
        FlatSamples::U32(yarns.collect()),
    ));
    AnyChannels::sort(list.into_iter().collect())
}
