//! NRRD: a text head, an empty line, raw voxels x fastest. Files written here say
//! spacing and origin in mm, and what their components are.
//!
//! Read are files of raw encoding with three spatial axes, the components (if any) first,
//! the voxels behind the head or in one file beside it: what this module, Teem, ITK and
//! Slicer write uncompressed. `nrrd_head` reads the head; here it is made sense of.

use std::path::Path;

use super::axes::{Lie, RESAMPLE};
use super::dense::{Channel, Layer};
use super::fields::{Field, Start, Wrong};
use super::nrrd_head::Head;
use super::read::{beginning, behind_lines, damaged, length_of};
use super::{VolumeFileError, beside};
use crate::atomic::folder_of;
use crate::volume::source::Frame;

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

/// What the head of a file says, and the file its voxels are in.
pub(super) fn field(path: &Path) -> Result<Field, VolumeFileError> {
    let wrong = |wrong: Wrong| damaged(path, wrong.what, wrong.remedy);
    let start = beginning(path)?;
    let (head, end) = Head::of(&start).map_err(wrong)?;
    let field = understood(path, &head).map_err(wrong)?;
    let (voxels, attached) = match &head.data_file {
        None => {
            let end = end.ok_or_else(|| {
                wrong(Wrong::new(
                    "no empty line ends its head",
                    "it was cut off: copy it again",
                ))
            })?;
            (path.to_owned(), end as u64)
        }
        Some(name) => (folder_of(path).join(name), 0),
    };
    let begin = match skipped(&voxels, attached, &head)? {
        Some(begin) => begin,
        None => {
            let what = format!("its line skip of {} is more than it has", head.line_skip);
            return Err(wrong(Wrong::new(what, "give the lines before the voxels")));
        }
    };
    let length = length_of(&voxels)?;
    Field {
        path: voxels,
        start: begin,
        ..field
    }
    .checked(length)
}

/// Where the voxels begin: behind so many lines, then so many bytes. `None` where there are
/// not so many lines.
fn skipped(voxels: &Path, attached: u64, head: &Head) -> Result<Option<Start>, VolumeFileError> {
    if head.byte_skip == -1 {
        return Ok(Some(Start::Last));
    }
    let behind = behind_lines(voxels, attached, head.line_skip)?;
    let skip = u64::try_from(head.byte_skip).unwrap_or(0);
    Ok(behind.map(|behind| Start::At(behind.saturating_add(skip))))
}

/// What the head says, but for where the voxels are.
fn understood(path: &Path, head: &Head) -> Result<Field, Wrong> {
    let absent = |what: &str| Wrong::new(format!("it has no {what}"), "give a whole NRRD");
    let scalar = head.scalar.ok_or_else(|| absent("type"))?;
    let (components, size) = match *head.sizes {
        [] => return Err(absent("sizes")),
        [x, y, z] => (1, [x, y, z]),
        [c, x, y, z] => (c, [x, y, z]),
        _ => {
            let what = format!("its sizes are {} numbers", head.sizes.len());
            return Err(Wrong::new(
                what,
                "give three axes, or four of which the first counts the numbers of a voxel",
            ));
        }
    };
    let axes = head.sizes.len();
    if head
        .dimension
        .is_some_and(|dimension| dimension != axes as u64)
    {
        let what = format!("its dimension is not that of its {axes} sizes");
        return Err(Wrong::new(
            what,
            "give a dimension of as many axes as sizes",
        ));
    }
    let by_rows = head.kinds(axes)?;
    let mut warnings = Vec::new();
    let scale = head.scale(axes, size, &mut warnings)?;
    let lie = Lie::new(size, scale.steps, scale.origin).ok_or_else(|| {
        Wrong::new(
            "its space directions are turned against x, y and z",
            RESAMPLE,
        )
    })?;
    head.remarks(&mut warnings);
    if head.big_endian.is_none() && scalar.bytes() > 1 {
        warnings.push("it does not say its endian: taking little".to_owned());
    }
    Ok(Field {
        path: path.to_owned(),
        lie,
        components,
        by_rows,
        scalar,
        big_endian: head.big_endian.unwrap_or(false),
        start: Start::Last,
        unscaled: scale.unknown,
        warnings,
    })
}
