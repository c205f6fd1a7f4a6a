//! NRRD: a text head, an empty line, raw voxels x fastest. Files written here say
//! spacing and origin in mm, and what their components are.
//!
//! Read are attached files of raw encoding with three spatial axes, the components (if
//! any) first: what this module, Teem, ITK and Slicer write uncompressed.

use std::path::Path;

use super::dense::{Channel, Layer};
use super::fields::{Field, Scalar, numbers, placed};
use super::read::damaged;
use super::{VolumeFileError, beside};
use crate::volume::source::Frame;

/// Longest text head that is looked for.
pub(super) const LONGEST_HEAD: usize = 1 << 16;

/// The files of a volume.
pub(super) fn layers(frame: &Frame, path: &Path) -> Result<Vec<Layer>, VolumeFileError> {
    let layer = |path, channel, content: &str| Layer {
        path,
        channel,
        head: head(frame, channel, content),
        tail: Vec::new(),
        header: None,
    };
    Ok(vec![
        layer(
            path.to_owned(),
            Channel::Sigma,
            "extinction across the fibres, 1/mm",
        ),
        layer(
            beside(path, "albedo"),
            Channel::Albedo,
            "single-scattering albedo, linear RGB",
        ),
        layer(
            beside(path, "sggx"),
            Channel::Sggx,
            "SGGX matrix of the fibres: xx yy zz xy xz yz",
        ),
        layer(
            beside(path, "yarn"),
            Channel::Yarn,
            "yarn of the design, -1 = none",
        ),
    ])
}

fn head(frame: &Frame, channel: Channel, content: &str) -> Vec<u8> {
    let [nx, ny, nz] = frame.size.to_array();
    let edge = frame.edge_mm;
    // The origin is the centre of the first voxel.
    let [x, y, z] = (frame.origin_mm + 0.5 * edge).to_array();
    let components = channel.components();
    let (first_size, first_none, first_kind) = match components {
        1 => (String::new(), "", ""),
        n => (format!("{n} "), "none ", "vector "),
    };
    let dimension = if components == 1 { 3 } else { 4 };
    let scalar = if channel == Channel::Yarn {
        "int16"
    } else {
        "float"
    };
    format!(
        "NRRD0005\n# Pickglass {version}: a window of woven cloth\ncontent: {content}\n\
         type: {scalar}\ndimension: {dimension}\nspace dimension: 3\n\
         sizes: {first_size}{nx} {ny} {nz}\n\
         space directions: {first_none}({edge},0,0) (0,{edge},0) (0,0,{edge})\n\
         kinds: {first_kind}domain domain domain\nendian: little\nencoding: raw\n\
         space units: \"mm\" \"mm\" \"mm\"\nspace origin: ({x},{y},{z})\n\n",
        version = env!("CARGO_PKG_VERSION"),
    )
    .into_bytes()
}

/// What the head of a file of `length` bytes says; `start` is its beginning.
pub(super) fn field(start: &[u8], length: u64, path: &Path) -> Result<Field, VolumeFileError> {
    let wrong = |what: String| damaged(path, what, "give an attached NRRD of raw encoding");
    if !start.starts_with(b"NRRD000") {
        return Err(wrong("it does not begin with NRRD000".to_owned()));
    }
    let end = start
        .windows(2)
        .position(|two| two == b"\n\n")
        .map(|at| at + 2);
    let end = end.or_else(|| {
        start
            .windows(4)
            .position(|four| four == b"\r\n\r\n")
            .map(|at| at + 4)
    });
    let end = end.ok_or_else(|| wrong("no empty line ends its head".to_owned()))?;
    let text = String::from_utf8_lossy(&start[..end]);
    let mut head = Head::default();
    for line in text.lines().skip(1).filter(|line| !line.starts_with('#')) {
        if let Some((key, value)) = line.split_once(": ") {
            head.take(&key.trim().to_ascii_lowercase(), value.trim())
                .map_err(wrong)?;
        }
    }
    let scalar = head
        .scalar
        .ok_or_else(|| wrong("it has no type".to_owned()))?;
    let (components, size) = match *head.sizes {
        [x, y, z] => (1, [x, y, z]),
        [c, x, y, z] => (c, [x, y, z]),
        _ => return Err(wrong(format!("its sizes are {:?}, not 3 or 4", head.sizes))),
    };
    let edges = head.edges.unwrap_or([1.0; 3]);
    let origin = head.origin.unwrap_or(edges.map(|edge| 0.5 * edge));
    Field {
        path: path.to_owned(),
        size: size.into(),
        bounds: placed(size, edges, origin),
        components,
        scalar,
        big_endian: head.big_endian,
        offset: end as u64,
    }
    .checked(length)
}

#[derive(Default)]
struct Head {
    scalar: Option<Scalar>,
    sizes: Vec<u32>,
    edges: Option<[f64; 3]>,
    origin: Option<[f64; 3]>,
    big_endian: bool,
}

impl Head {
    fn take(&mut self, key: &str, value: &str) -> Result<(), String> {
        match key {
            "type" => {
                let scalar = Scalar::of_nrrd(value);
                self.scalar = Some(scalar.ok_or_else(|| format!("its type is {value:.40}"))?);
            }
            "sizes" => {
                let sizes: Result<Vec<u32>, _> = value.split_whitespace().map(str::parse).collect();
                self.sizes = sizes.map_err(|_| format!("its sizes are {value:.60}"))?;
            }
            "encoding" if value != "raw" => return Err(format!("its encoding is {value:.40}")),
            "data file" | "datafile" => return Err("its voxels are in another file".to_owned()),
            "endian" => self.big_endian = value == "big",
            "line skip" | "byte skip" if value != "0" => return Err(format!("it has a {key}")),
            "spacings" => {
                let last: Vec<f64> = numbers(value).rev().take(3).collect();
                if let [z, y, x] = *last {
                    self.edges = Some([x, y, z]);
                }
            }
            "space directions" => {
                let all: Vec<f64> = numbers(value).collect();
                let [xx, xy, xz, yx, yy, yz, zx, zy, zz] = *all else {
                    return Err("its space directions are not three vectors".to_owned());
                };
                let crooked = [xy, xz, yx, yz, zx, zy].iter().any(|&side| side != 0.0);
                if crooked || !([xx, yy, zz].iter().all(|&edge| edge > 0.0)) {
                    return Err("its axes are turned against x, y and z".to_owned());
                }
                self.edges = Some([xx, yy, zz]);
            }
            "space origin" => {
                let all: Vec<f64> = numbers(value).collect();
                if let [x, y, z] = *all {
                    self.origin = Some([x, y, z]);
                }
            }
            _ => {}
        }
        Ok(())
    }
}
