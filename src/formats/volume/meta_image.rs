//! MetaImage: a text head `.mhd` beside a `.raw` of voxels, x fastest.

use std::path::{Path, PathBuf};

use super::dense::{Channel, Layer};
use super::fields::{Field, Scalar, numbers, placed};
use super::read::damaged;
use super::{VolumeFileError, beside};
use crate::formats::atomic::folder_of;
use crate::volume::source::Frame;

/// The files of a volume.
pub(super) fn layers(frame: &Frame, path: &Path) -> Result<Vec<Layer>, VolumeFileError> {
    let layer = |path: PathBuf, channel| {
        let raw = path.with_extension("raw");
        Layer {
            head: Vec::new(),
            tail: Vec::new(),
            header: Some((path, head(frame, channel, &raw))),
            path: raw,
            channel,
        }
    };
    Ok(vec![
        layer(path.to_owned(), Channel::Sigma),
        layer(beside(path, "albedo"), Channel::Albedo),
        layer(beside(path, "sggx"), Channel::Sggx),
        layer(beside(path, "yarn"), Channel::Yarn),
    ])
}

fn head(frame: &Frame, channel: Channel, raw: &Path) -> Vec<u8> {
    let [nx, ny, nz] = frame.size.to_array();
    let edge = frame.edge_mm;
    let [x, y, z] = (frame.origin_mm + 0.5 * edge).to_array();
    let scalar = if channel == Channel::Yarn {
        "MET_SHORT"
    } else {
        "MET_FLOAT"
    };
    let comment = match channel {
        Channel::Albedo => "single-scattering albedo, linear RGB",
        Channel::Sggx => "SGGX matrix of the fibres: Sxx Syy Szz Sxy Sxz Syz",
        Channel::Yarn => "yarn of the design, -1 = none",
        _ => "extinction across the fibres, 1/mm",
    };
    format!(
        "ObjectType = Image\nNDims = 3\nComment = {comment}; lengths in mm\nBinaryData = True\n\
         BinaryDataByteOrderMSB = False\nCompressedData = False\n\
         TransformMatrix = 1 0 0 0 1 0 0 0 1\nOffset = {x} {y} {z}\nCenterOfRotation = 0 0 0\n\
         DistanceUnits = mm\nElementSpacing = {edge} {edge} {edge}\nDimSize = {nx} {ny} {nz}\n\
         ElementNumberOfChannels = {components}\nElementType = {scalar}\n\
         ElementDataFile = {raw}\n",
        components = channel.components(),
        raw = raw.file_name().unwrap_or_default().to_string_lossy(),
    )
    .into_bytes()
}

/// What a head says, and the file its voxels are in.
pub(super) fn field(start: &[u8], path: &Path) -> Result<Field, VolumeFileError> {
    let wrong = |what: String| {
        damaged(
            path,
            what,
            "give a MetaImage head of uncompressed voxels in a .raw beside it",
        )
    };
    let text = std::str::from_utf8(start).map_err(|_| wrong("its head is no text".to_owned()))?;
    let (mut size, mut scalar, mut data) = (None, None, None);
    let (mut edges, mut origin) = ([1.0; 3], None);
    let (mut components, mut big_endian) = (1, false);
    for line in text.lines() {
        let Some((key, value)) = line.split_once('=') else {
            continue;
        };
        let value = value.trim();
        let three = || {
            let all: Vec<f64> = numbers(value).collect();
            <[f64; 3]>::try_from(all).ok()
        };
        match key.trim() {
            "NDims" if value != "3" => return Err(wrong(format!("it has {value:.20} axes"))),
            "DimSize" => {
                let all: Result<Vec<u32>, _> = value.split_whitespace().map(str::parse).collect();
                let sides = all.ok().and_then(|all| <[u32; 3]>::try_from(all).ok());
                size = Some(sides.ok_or_else(|| wrong(format!("its DimSize is {value:.60}")))?);
            }
            "ElementType" => {
                let found = Scalar::of_meta_image(value);
                scalar = Some(found.ok_or_else(|| wrong(format!("its type is {value:.40}")))?);
            }
            "ElementNumberOfChannels" => components = value.parse().unwrap_or(0),
            "ElementSpacing" => edges = three().unwrap_or(edges),
            "Offset" | "Origin" | "Position" => origin = three(),
            "BinaryDataByteOrderMSB" | "ElementByteOrderMSB" => {
                big_endian = value.eq_ignore_ascii_case("true");
            }
            "CompressedData" if value.eq_ignore_ascii_case("true") => {
                return Err(wrong("its voxels are compressed".to_owned()));
            }
            "ElementDataFile" => data = Some(value.to_owned()),
            _ => {}
        }
    }
    let size = size.ok_or_else(|| wrong("it has no DimSize".to_owned()))?;
    let scalar = scalar.ok_or_else(|| wrong("it has no ElementType".to_owned()))?;
    let data = data.ok_or_else(|| wrong("it has no ElementDataFile".to_owned()))?;
    if data == "LOCAL" || data == "LIST" || data.contains(['/', '\\']) {
        return Err(wrong(format!("its voxels are in {data:.60}")));
    }
    let raw = folder_of(path).join(&data);
    let length = std::fs::metadata(&raw).map_err(|source| VolumeFileError::Unreadable {
        path: raw.clone(),
        source,
    })?;
    Field {
        path: raw,
        size: size.into(),
        bounds: placed(size, edges, origin.unwrap_or(edges.map(|edge| 0.5 * edge))),
        components,
        scalar,
        big_endian,
        offset: 0,
    }
    .checked(length.len())
}
