//! MetaImage: a text head `.mhd` beside a `.raw` of voxels, x fastest. Read are also `.mha`,
//! which have the voxels behind the head.

use std::path::{Path, PathBuf};

use super::axes::{Lie, RESAMPLE};
use super::dense::{Channel, Layer};
use super::fields::{Field, Scalar, Start, Wrong, numbers};
use super::read::{beginning, damaged, length_of};
use super::{VolumeFileError, beside, units};
use crate::atomic::folder_of;
use crate::formats::field_table::{Field as Row, Handling, Table};
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

/// What changes size, place, scale, order, direction or density.
pub const FIELDS: Table = Table {
    format: "mhd",
    fields: &[
        Row::new("NDims", Handling::Refused, "4"),
        Row::new("DimSize", Handling::Honoured, "3 4 2"),
        Row::new("ElementType", Handling::Honoured, "MET_INT"),
        Row::new("ElementType", Handling::Refused, "MET_STRING"),
        Row::new("ElementNumberOfChannels", Handling::Refused, "2"),
        Row::new("ElementSpacing", Handling::Honoured, "0.3 0.2 0.1"),
        Row::new("ElementSpacing", Handling::Warned, "nan nan nan"),
        Row::new("ElementSize", Handling::Honoured, "0.3 0.2 0.1"),
        Row::new("Offset", Handling::Honoured, "1 2 3"),
        Row::new("Position", Handling::Honoured, "1 2 3"),
        Row::new("Origin", Handling::Honoured, "1 2 3"),
        Row::new("TransformMatrix", Handling::Honoured, "-1 0 0 0 1 0 0 0 1"),
        Row::new("Orientation", Handling::Honoured, "0 1 0 1 0 0 0 0 1"),
        Row::new("Rotation", Handling::Honoured, "1 0 0 0 1 0 0 0 -1"),
        Row::new(
            "TransformMatrix",
            Handling::Refused,
            "0.866 0.5 0 -0.5 0.866 0 0 0 1",
        ),
        Row::new("Orientation", Handling::Refused, "2 0 0 0 1 0 0 0 1"),
        Row::new("Rotation", Handling::Refused, "1 0 0 1"),
        Row::new("CenterOfRotation", Handling::Warned, "1 0 0"),
        Row::new("AnatomicalOrientation", Handling::Warned, "LAI"),
        Row::new("DistanceUnits", Handling::Honoured, "um"),
        Row::new("DistanceUnits", Handling::Warned, "ell"),
        Row::new("HeaderSize", Handling::Honoured, "4"),
        Row::new("HeaderSize", Handling::Honoured, "-1"),
        Row::new("HeaderSize", Handling::Refused, "-2"),
        Row::new("HeaderSizesPerSlice", Handling::Refused, "4 4"),
        Row::new("BinaryData", Handling::Refused, "False"),
        Row::new("BinaryDataByteOrderMSB", Handling::Honoured, "True"),
        Row::new("ElementByteOrderMSB", Handling::Honoured, "True"),
        Row::new("CompressedData", Handling::Refused, "True"),
        Row::new("ElementToIntensityFunctionSlope", Handling::Refused, "2"),
        Row::new("ElementToIntensityFunctionOffset", Handling::Refused, "1"),
        Row::new("Color", Handling::Warned, "1 0 0 1"),
        Row::new("ElementDataFile", Handling::Honoured, "other.raw"),
        Row::new("ElementDataFile", Handling::Honoured, "LOCAL"),
        Row::new("ElementDataFile", Handling::Refused, "LIST"),
        Row::new("ElementDataFile", Handling::Refused, "layer%02d.raw 0 1 1"),
    ],
};

/// How an axis that was not turned runs in a body: from right, front and below. Others are
/// only other names, where the matrix says how the axes lie.
const USUAL_BODY: [&str; 4] = ["RAI", "???", "", "Unknown"];

/// The fields of a head that matter.
#[derive(Default)]
struct Head {
    size: Option<[u32; 3]>,
    scalar: Option<Scalar>,
    components: Option<u32>,
    spacing: Option<[f64; 3]>,
    element: Option<[f64; 3]>,
    origin: Option<[f64; 3]>,
    matrix: Option<(String, [f64; 9])>,
    body: Option<String>,
    unit: Option<String>,
    skip: i64,
    big_endian: bool,
    voxels: Option<String>,
    warnings: Vec<String>,
    /// The fields that stood there already, by what they say.
    seen: Vec<(&'static str, String, String)>,
}

/// Names of one field.
const SAME: [(&str, &[&str]); 3] = [
    ("place", &["Offset", "Position", "Origin"]),
    ("turn", &["TransformMatrix", "Rotation", "Orientation"]),
    ("order", &["BinaryDataByteOrderMSB", "ElementByteOrderMSB"]),
];

/// What a head says, and the file its voxels are in.
pub(super) fn field(path: &Path) -> Result<Field, VolumeFileError> {
    let wrong = |wrong: Wrong| damaged(path, wrong.what, wrong.remedy);
    let start = beginning(path)?;
    let (head, end) = Head::of(&start).map_err(wrong)?;
    let name = (head.voxels.as_deref())
        .ok_or_else(|| Wrong::new("it has no ElementDataFile", "name the file of the voxels"));
    let name = name.map_err(wrong)?;
    let local = name.eq_ignore_ascii_case("LOCAL");
    let raw = if local {
        path.to_owned()
    } else {
        folder_of(path).join(name)
    };
    let listed = name.get(..4).is_some_and(|start| start == "LIST");
    if listed || (name.contains('%') && !raw.exists()) {
        return Err(wrong(Wrong::new(
            format!("its ElementDataFile is {name:.60}: not one file"),
            "put all layers into one .raw, one behind the other",
        )));
    }
    let begin = match head.skip {
        -1 => Start::Last,
        0 if local => Start::At(end as u64),
        skip => Start::At(u64::try_from(skip).unwrap_or(0)),
    };
    let length = length_of(&raw)?;
    let field = head.understood(raw, begin).map_err(wrong)?;
    field.checked(length)
}

impl Head {
    /// The head at the start of a file, and where it ends.
    fn of(start: &[u8]) -> Result<(Self, usize), Wrong> {
        let mut head = Self::default();
        let mut place = 0;
        for line in start.split_inclusive(|&byte| byte == b'\n') {
            place += line.len();
            let text = String::from_utf8_lossy(line);
            if let Some((key, value)) = text.split_once('=') {
                let (key, value) = (key.trim(), value.trim());
                head.once(key, value)?;
                head.take(key, value)?;
                if key == "ElementDataFile" && value.eq_ignore_ascii_case("LOCAL") {
                    break;
                }
            }
        }
        Ok((head, place))
    }

    /// Refuses a field that was given before, by this name or another, and said other things.
    fn once(&mut self, key: &str, value: &str) -> Result<(), Wrong> {
        let same = SAME.iter().find(|(_, names)| names.contains(&key));
        let mut known = FIELDS.fields.iter().map(|field| field.name);
        let meaning = same.map(|(meaning, _)| *meaning);
        let Some(meaning) = meaning.or_else(|| known.find(|&name| name == key)) else {
            return Ok(());
        };
        if let Some((_, name, before)) = self.seen.iter().find(|seen| seen.0 == meaning)
            && before != value
        {
            return Err(Wrong::new(
                format!("its {name} is {before:.60}, and its {key} is {value:.60}"),
                "leave the right one",
            ));
        }
        (self.seen).push((meaning, key.to_owned(), value.to_owned()));
        Ok(())
    }

    fn take(&mut self, key: &str, value: &str) -> Result<(), Wrong> {
        let wrong = |remedy| Wrong::new(format!("its {key} is {value:.80}"), remedy);
        let three = || {
            let found = numbers(value).and_then(|all| <[f64; 3]>::try_from(all).ok());
            found.ok_or_else(|| wrong("give three numbers"))
        };
        let truth = || match value
            .chars()
            .next()
            .map(|letter| letter.to_ascii_lowercase())
        {
            Some('t' | '1') => Ok(true),
            Some('f' | '0') => Ok(false),
            _ => Err(wrong("give True or False")),
        };
        match key {
            "NDims" if value != "3" => return Err(wrong("give a volume of three axes")),
            "DimSize" => {
                let sides: Option<Vec<u32>> = value
                    .split_whitespace()
                    .map(|side| side.parse().ok())
                    .collect();
                let sides = sides.and_then(|sides| <[u32; 3]>::try_from(sides).ok());
                self.size = Some(sides.ok_or_else(|| wrong("give the voxels along three axes"))?);
            }
            "ElementType" => {
                let remedy = "give whole numbers of 8 to 32 bits, MET_FLOAT or MET_DOUBLE";
                self.scalar = Some(Scalar::of_meta_image(value).ok_or_else(|| wrong(remedy))?);
            }
            "ElementNumberOfChannels" => {
                let channels = value
                    .parse()
                    .ok()
                    .filter(|channels| [1, 3, 6].contains(channels));
                self.components =
                    Some(channels.ok_or_else(|| wrong("give 1, 3 or 6 numbers a voxel"))?);
            }
            "ElementSpacing" => self.spacing = Some(three()?),
            "ElementSize" => self.element = Some(three()?),
            "Offset" | "Origin" | "Position" => {
                let place = Some(three()?).filter(|place| place.iter().all(|x| x.is_finite()));
                self.origin = Some(place.ok_or_else(|| wrong("give three finite numbers"))?);
            }
            "TransformMatrix" | "Rotation" | "Orientation" => {
                let matrix = numbers(value).and_then(|all| <[f64; 9]>::try_from(all).ok());
                let matrix = matrix.ok_or_else(|| wrong("give nine numbers"))?;
                self.matrix = Some((key.to_owned(), matrix));
            }
            "DistanceUnits" => self.unit = Some(value.to_owned()),
            "BinaryDataByteOrderMSB" | "ElementByteOrderMSB" => self.big_endian = truth()?,
            "ElementDataFile" => self.voxels = Some(value.to_owned()),
            _ => return self.take_odd(key, value, truth),
        }
        Ok(())
    }

    /// Fields that are followed only where they say what is usual.
    fn take_odd(
        &mut self,
        key: &str,
        value: &str,
        truth: impl Fn() -> Result<bool, Wrong>,
    ) -> Result<(), Wrong> {
        let wrong = |remedy| Wrong::new(format!("its {key} is {value:.80}"), remedy);
        let all = |usual: f64| numbers(value).is_some_and(|all| all.iter().all(|&x| x == usual));
        match key {
            "HeaderSize" => {
                let skip = value.parse().ok().filter(|&skip: &i64| skip >= -1);
                let remedy = "give how many bytes stand before the voxels, or -1 where nothing \
                              stands behind them";
                self.skip = skip.ok_or_else(|| wrong(remedy))?;
            }
            "HeaderSizesPerSlice" if !all(0.0) => {
                return Err(wrong("write the voxels without heads between the layers"));
            }
            "BinaryData" if !truth()? => return Err(wrong("write the voxels as binary numbers")),
            "CompressedData" if truth()? => return Err(wrong("write the voxels uncompressed")),
            "ElementToIntensityFunctionSlope" if !all(1.0) => {
                return Err(wrong("multiply the voxels by it and leave it out"));
            }
            "ElementToIntensityFunctionOffset" if !all(0.0) => {
                return Err(wrong("add it to the voxels and leave it out"));
            }
            "AnatomicalOrientation" => self.body = Some(value.to_owned()),
            "CenterOfRotation" if !all(0.0) => self.warnings.push(format!(
                "its CenterOfRotation is {value:.60}: not followed; Offset is taken as the \
                 centre of the first voxel"
            )),
            "Color" if !all(1.0) => self.warnings.push(format!(
                "its Color is {value:.60}: not followed; the albedo of a volume is a file beside it"
            )),
            _ => {}
        }
        Ok(())
    }

    /// What the head says of voxels that begin somewhere in a file.
    fn understood(self, path: PathBuf, start: Start) -> Result<Field, Wrong> {
        let absent = |what: &str| Wrong::new(format!("it has no {what}"), "give a whole MetaImage");
        let size = self.size.ok_or_else(|| absent("DimSize"))?;
        let scalar = self.scalar.ok_or_else(|| absent("ElementType"))?;
        let mut warnings = self.warnings;
        let sound = |edges: &[f64; 3]| edges.iter().all(|edge| edge.is_finite() && *edge != 0.0);
        let given = self.spacing.filter(sound).or(self.element.filter(sound));
        if let (Some(spacing), Some(element)) = (self.spacing, self.element)
            && spacing != element
        {
            warnings.push(
                "its ElementSize is not its ElementSpacing: taking voxels without gaps between \
                 them"
                    .to_owned(),
            );
        }
        let edges = given.unwrap_or([1.0; 3]);
        let unscaled = (given.is_none()).then(|| {
            "its ElementSpacing does not say how large a voxel is: taking 1 mm".to_owned()
        });
        let unit = self.unit.unwrap_or_default();
        let mm = units::mm(&unit).unwrap_or(1.0);
        if units::mm(&unit).is_none() && !units::is_none(&unit) {
            warnings.push(format!(
                "its DistanceUnits {unit:.40} are no length that is known: taking mm; --voxel \
                 gives the edge of a voxel in mm"
            ));
        }
        if let Some(body) = self
            .body
            .filter(|body| !USUAL_BODY.contains(&body.as_str()))
            && self.matrix.is_none()
        {
            warnings.push(format!(
                "its AnatomicalOrientation is {body:.20} and it has no TransformMatrix: taking \
                 its axes as x, y and z"
            ));
        }
        let (name, rows) = self.matrix.unwrap_or_else(|| {
            let straight = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
            (String::new(), straight)
        });
        // Row after row: where the first, the second and the third axis of the file point.
        let steps = [0, 1, 2].map(|axis| [0, 1, 2].map(|k| rows[3 * axis + k] * edges[axis] * mm));
        let unit_rows =
            (rows.chunks(3)).all(|row| (row.iter().map(|x| x * x).sum::<f64>() - 1.0).abs() < 1e-3);
        let origin = self.origin.map(|origin| origin.map(|x| x * mm));
        let lie = Lie::new(size, steps, origin).filter(|_| unit_rows);
        let lie = lie.ok_or_else(|| {
            Wrong::new(
                format!("its {name} turns its axes against x, y and z, or stretches them"),
                RESAMPLE,
            )
        })?;
        Ok(Field {
            path,
            lie,
            components: self.components.unwrap_or(1),
            by_rows: false,
            scalar,
            big_endian: self.big_endian,
            start,
            unscaled,
            warnings,
        })
    }
}
