//! An OpenEXR picture as the light from around.
//!
//! The first part that has R, G and B (or a grey Y) is read; of all its channels only these
//! and A are unpacked, block by block. The display window is the whole sphere; where the
//! data window does not reach there is no light.

use std::io::{Cursor, Read};
use std::path::Path;

use exr::meta::attribute::{EnvironmentMap, Text};
use exr::meta::header::Header;
use exr::meta::{BlockDescription, MetaData};
use exr::prelude::{Compression, ReadChannels, ReadLayers, ReadSpecificChannel, Vec2};
use glam::Vec3;

use super::ExrError;
use crate::formats::field_table::{Field, Handling, Table};
use crate::memory;
use crate::scene::EnvironmentImage;

/// The fields of an environment. The order of lines in the file (`lineOrder`) places no
/// pixel: each block says where it belongs.
pub const FIELDS: Table = Table {
    format: "exr",
    fields: &[
        Field::new("envmap", Handling::Refused, "cube"),
        Field::new("channels", Handling::Refused, "Y BY RY"),
        Field::new("dataWindow", Handling::Honoured, "1 0 4 1"),
        Field::new("displayWindow", Handling::Honoured, "0 0 7 3"),
        Field::new(
            "chromaticities",
            Handling::Warned,
            "0.68 0.32 0.265 0.69 0.15 0.06",
        ),
        Field::new("pixelAspectRatio", Handling::Warned, "2"),
        Field::new("multiView", Handling::Warned, "left right"),
        Field::new("parts", Handling::Warned, "2"),
        Field::new("alpha", Handling::Warned, "0.5"),
    ],
};

/// An environment that was read.
#[derive(Debug, Clone, PartialEq)]
pub struct Environment {
    /// The picture.
    pub image: EnvironmentImage,
    /// One line each.
    pub warnings: Vec<String>,
}

/// The most pixels of an environment.
const MOST_PIXELS: u64 = 64 << 20;
/// The largest file that is opened.
const MOST_BYTES: u64 = 1 << 30;
/// How every OpenEXR file begins.
const MAGIC: [u8; 4] = [0x76, 0x2f, 0x31, 0x01];

/// Primaries and white of linear sRGB (Rec. 709, D65) in x and y.
const REC_709: [f32; 8] = [0.64, 0.33, 0.3, 0.6, 0.15, 0.06, 0.3127, 0.329];
/// A difference in x or y that is rounding.
const ROUNDING: f32 = 0.003;

/// Reads an equirectangular environment.
///
/// # Errors
/// [`ExrError`] for what cannot be read, is no environment, or takes too much memory.
pub fn read_environment(path: &Path) -> Result<Environment, ExrError> {
    let bytes = read_bytes(path)?;
    let damaged = |error: exr::error::Error| ExrError::Damaged {
        path: path.to_owned(),
        problem: (error.to_string().split_whitespace().collect::<Vec<_>>()).join(" "),
    };
    let meta = MetaData::read_from_buffered(Cursor::new(&bytes), false).map_err(damaged)?;
    let (header, colour) = (meta.headers.iter())
        .find_map(|header| Some((header, Colour::of(header)?)))
        .ok_or_else(|| no_colour(path, &meta))?;
    check(path, header, bytes.len() as u64)?;
    let mut warnings = remarks(header);
    let parts = meta.headers.len();
    if parts > 1 {
        warnings.push(format!(
            "only the first fitting of its {parts} parts is read"
        ));
    }
    let canvas = colour.read(&bytes, Canvas::of(header)).map_err(damaged)?;
    if canvas.clear > 0 {
        warnings.push(format!(
            "its alpha is below 1 in {} pixels: what would shine through there is taken as dark",
            canvas.clear
        ));
    }
    let image = EnvironmentImage::new(canvas.width, canvas.height, canvas.pixels);
    let image = image.map_err(|error| ExrError::Damaged {
        path: path.to_owned(),
        problem: error.to_string(),
    })?;
    let file = path.display();
    let warnings = warnings
        .iter()
        .map(|line| format!("{file}: {line}"))
        .collect();
    Ok(Environment { image, warnings })
}

/// The bytes of a file that begins as an OpenEXR picture, if they are not too many.
fn read_bytes(path: &Path) -> Result<Vec<u8>, ExrError> {
    let unreadable = |source| ExrError::File {
        path: path.to_owned(),
        source,
    };
    let mut file = std::fs::File::open(path).map_err(unreadable)?;
    let length = file.metadata().map_or(0, |about| about.len());
    let mut bytes = Vec::new();
    // What is no picture may have no end.
    let start = file
        .by_ref()
        .take(MAGIC.len() as u64)
        .read_to_end(&mut bytes);
    start.map_err(unreadable)?;
    if bytes != MAGIC {
        return Err(ExrError::Damaged {
            path: path.to_owned(),
            problem: "it does not begin as an OpenEXR picture".to_owned(),
        });
    }
    if length <= MOST_BYTES {
        memory::ask(length, || path.display().to_string())?;
        file.take(MOST_BYTES)
            .read_to_end(&mut bytes)
            .map_err(unreadable)?;
    }
    if length > MOST_BYTES || bytes.len() as u64 > MOST_BYTES {
        return Err(unsuitable(
            path,
            format!("the file is larger than {}", memory::size(MOST_BYTES)),
            "scale the environment down",
        ));
    }
    Ok(bytes)
}

fn unsuitable(path: &Path, problem: String, remedy: &'static str) -> ExrError {
    ExrError::Unsuitable {
        path: path.to_owned(),
        problem,
        remedy,
    }
}

fn no_colour(path: &Path, meta: &MetaData) -> ExrError {
    let names = meta.headers.iter().flat_map(|header| &header.channels.list);
    let mut names: Vec<String> = names.map(|channel| channel.name.to_string()).collect();
    let more = names.len() > 8;
    names.truncate(8);
    unsuitable(
        path,
        format!(
            "no R, G and B among its channels ({}{})",
            names.join(", "),
            if more { ", …" } else { "" }
        ),
        "save the environment as an RGB picture",
    )
}

/// Refuses what is no environment, is too large, or cannot be in a file of `length` bytes,
/// before memory is asked for.
fn check(path: &Path, header: &Header, length: u64) -> Result<(), ExrError> {
    if header.deep {
        let problem = "it holds deep samples".to_owned();
        return Err(unsuitable(path, problem, "save the environment flattened"));
    }
    if header.own_attributes.environment_map == Some(EnvironmentMap::Cube) {
        let problem = "its envmap attribute says that it shows the sides of a cube".to_owned();
        return Err(unsuitable(
            path,
            problem,
            "save the environment in latitude and longitude (equirectangular)",
        ));
    }
    let size = |size: Vec2<usize>| size.x() as u64 * size.y() as u64;
    let window = header.shared_attributes.display_window.size;
    let pixels = size(window).max(size(header.layer_size));
    if pixels > MOST_PIXELS {
        let problem = format!(
            "{}x{} is more than 64 megapixels",
            header.layer_size.x().max(window.x()),
            header.layer_size.y().max(window.y())
        );
        return Err(unsuitable(path, problem, "scale the environment down"));
    }
    let per_pixel = header.channels.bytes_per_pixel as u64;
    let unpacked = size(header.layer_size).saturating_mul(per_pixel);
    if unpacked / most_per_byte(header.compression) > length {
        return Err(ExrError::Damaged {
            path: path.to_owned(),
            problem: format!(
                "{}x{} pixels in {} channels are declared, but its {length} bytes cannot hold them",
                header.layer_size.x(),
                header.layer_size.y(),
                header.channels.list.len()
            ),
        });
    }
    let block = match header.blocks {
        BlockDescription::ScanLines => {
            header.layer_size.x() as u64 * header.compression.scan_lines_per_block() as u64
        }
        BlockDescription::Tiles(tiles) => size(tiles.tile_size),
    };
    // A block is unpacked and put in order.
    let needed = EnvironmentImage::bytes(pixels)
        .saturating_add(block.saturating_mul(3 * per_pixel))
        .saturating_add(length);
    Ok(memory::ask(needed, || path.display().to_string())?)
}

/// Bytes that a byte of a compression can stand for at best, rounded up.
fn most_per_byte(compression: Compression) -> u64 {
    match compression {
        Compression::Uncompressed => 1,
        Compression::RLE => 128,
        Compression::B44 | Compression::B44A => 32,
        // Deflate does not better than 1032 to 1; PXR24 leaves out a byte of four.
        Compression::ZIP1 | Compression::ZIP16 | Compression::PXR24 => 1400,
        Compression::PIZ => 1 << 12,
        _ => 1 << 20,
    }
}

/// What of a header is not followed.
fn remarks(header: &Header) -> Vec<String> {
    let mut warnings = Vec::new();
    let (shared, own) = (&header.shared_attributes, &header.own_attributes);
    if let Some(said) = shared.chromaticities {
        let said = [said.red, said.green, said.blue, said.white].map(|Vec2(x, y)| [x, y]);
        let off = said.as_flattened().iter().zip(REC_709);
        if off
            .into_iter()
            .any(|(said, usual)| !((said - usual).abs() <= ROUNDING))
        {
            warnings.push(
                "its chromaticities are not those of sRGB and are not followed: convert it to \
                 linear sRGB for true colours"
                    .to_owned(),
            );
        }
    }
    if !((shared.pixel_aspect - 1.0).abs() <= 0.01) {
        warnings.push(format!(
            "its pixelAspectRatio of {} is not followed: the picture is taken as the whole sphere",
            shared.pixel_aspect
        ));
    }
    if own
        .multi_view_names
        .as_ref()
        .is_some_and(|views| views.len() > 1)
    {
        warnings.push("it holds several views (multiView): the first is read".to_owned());
    }
    warnings
}

/// The channels that make the colour.
enum Colour {
    Rgb([Text; 3]),
    Grey(Text),
}

impl Colour {
    /// `None` where a part has none, or luminance with coarser chroma (Y, RY, BY).
    fn of(header: &Header) -> Option<Self> {
        let find = |name: &str| {
            let mut list = header.channels.list.iter();
            list.find(|channel| channel.name.eq_case_insensitive(name))
                .filter(|channel| channel.sampling == Vec2(1, 1))
                .map(|channel| channel.name.clone())
        };
        match (find("R"), find("G"), find("B"), find("Y")) {
            (Some(r), Some(g), Some(b), _) => Some(Self::Rgb([r, g, b])),
            (None, None, None, Some(grey)) => {
                let list = header.channels.list.iter();
                let chroma =
                    |name: &Text| name.eq_case_insensitive("RY") || name.eq_case_insensitive("BY");
                let plain = !list.map(|channel| &channel.name).any(chroma);
                plain.then_some(Self::Grey(grey))
            }
            _ => None,
        }
    }

    fn read(self, bytes: &[u8], canvas: Canvas) -> exr::error::Result<Canvas> {
        let bytes = Cursor::new(bytes);
        let levels = exr::prelude::read()
            .no_deep_data()
            .largest_resolution_level();
        Ok(match self {
            Self::Rgb([r, g, b]) => {
                levels
                    .specific_channels()
                    .required(r)
                    .required(g)
                    .required(b)
                    .optional("A", 1.0f32)
                    .collect_pixels(
                        |_, _| canvas.blank(),
                        |canvas: &mut Canvas, at, (r, g, b, a): (f32, f32, f32, f32)| {
                            canvas.put(at, Vec3::new(r, g, b), a);
                        },
                    )
                    .first_valid_layer()
                    .all_attributes()
                    .from_buffered(bytes)?
                    .layer_data
                    .channel_data
                    .pixels
            }
            Self::Grey(y) => {
                levels
                    .specific_channels()
                    .required(y)
                    .optional("A", 1.0f32)
                    .collect_pixels(
                        |_, _| canvas.blank(),
                        |canvas: &mut Canvas, at, (y, a): (f32, f32)| {
                            canvas.put(at, Vec3::splat(y), a);
                        },
                    )
                    .first_valid_layer()
                    .all_attributes()
                    .from_buffered(bytes)?
                    .layer_data
                    .channel_data
                    .pixels
            }
        })
    }
}

/// The display window's pixels.
struct Canvas {
    width: usize,
    height: usize,
    /// Where the data window's first pixel lies in the display window.
    place: [i64; 2],
    pixels: Vec<Vec3>,
    /// Pixels whose alpha is below 1.
    clear: u64,
}

impl Canvas {
    /// Of no pixels yet.
    fn of(header: &Header) -> Self {
        let window = header.shared_attributes.display_window;
        let data = header.own_attributes.layer_position;
        let apart = |data: i32, window: i32| i64::from(data) - i64::from(window);
        Self {
            width: window.size.x(),
            height: window.size.y(),
            place: [
                apart(data.x(), window.position.x()),
                apart(data.y(), window.position.y()),
            ],
            pixels: Vec::new(),
            clear: 0,
        }
    }

    /// One of the same size with all its pixels.
    fn blank(&self) -> Self {
        Self {
            pixels: vec![Vec3::ZERO; self.width * self.height],
            width: self.width,
            height: self.height,
            place: self.place,
            clear: 0,
        }
    }

    fn put(&mut self, Vec2(x, y): Vec2<usize>, colour: Vec3, alpha: f32) {
        let inside = |at: usize, first: i64, size: usize| {
            usize::try_from(at as i64 + first)
                .ok()
                .filter(|&at| at < size)
        };
        let (x, y) = (
            inside(x, self.place[0], self.width),
            inside(y, self.place[1], self.height),
        );
        if let (Some(x), Some(y)) = (x, y) {
            self.pixels[y * self.width + x] = colour;
            self.clear += u64::from(alpha < 1.0);
        }
    }
}
