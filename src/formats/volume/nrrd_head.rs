//! The fields of an NRRD head, and what they say of where the voxels lie.

use super::fields::{Scalar, Wrong, numbers};
use super::units;
use crate::formats::field_table::{Field, Handling, Table};

/// What changes size, place, scale, order, direction or density.
pub const FIELDS: Table = Table {
    format: "nrrd",
    fields: &[
        Field::new("dimension", Handling::Refused, "4"),
        Field::new("type", Handling::Honoured, "int"),
        Field::new("type", Handling::Refused, "block"),
        Field::new("sizes", Handling::Honoured, "3 4 2"),
        Field::new("encoding", Handling::Refused, "gzip"),
        Field::new("endian", Handling::Honoured, "big"),
        Field::new("endian", Handling::Refused, "middle"),
        Field::new("line skip", Handling::Honoured, "1"),
        Field::new("byte skip", Handling::Honoured, "4"),
        Field::new("byte skip", Handling::Honoured, "-1"),
        Field::new("byte skip", Handling::Refused, "-2"),
        Field::new("data file", Handling::Honoured, "other.raw"),
        Field::new("data file", Handling::Refused, "LIST"),
        Field::new("data file", Handling::Refused, "layer%02d.raw 0 1 1"),
        Field::new("spacings", Handling::Honoured, "0.3 0.2 0.1"),
        Field::new("spacings", Handling::Honoured, "-0.1 0.2 0.3"),
        Field::new("spacings", Handling::Warned, "nan nan nan"),
        Field::new("thicknesses", Handling::Warned, "0.05 0.2 0.3"),
        Field::new("axis mins", Handling::Honoured, "1 2 3"),
        Field::new("axis maxs", Handling::Honoured, "4 3 2"),
        Field::new("centerings", Handling::Honoured, "node node node"),
        Field::new("units", Handling::Honoured, "\"um\" \"um\" \"um\""),
        Field::new("units", Handling::Warned, "\"furlong\" \"mm\" \"mm\""),
        Field::new("kinds", Handling::Refused, "domain domain vector"),
        Field::new("kinds", Handling::Refused, "domain domain time"),
        Field::new(
            "kinds",
            Handling::Honoured,
            "3D-symmetric-matrix domain domain domain",
        ),
        Field::new("space", Handling::Refused, "left-anterior-superior"),
        Field::new("space dimension", Handling::Refused, "2"),
        Field::new(
            "space directions",
            Handling::Honoured,
            "(0,0.2,0) (-0.1,0,0) (0,0,0.3)",
        ),
        Field::new(
            "space directions",
            Handling::Refused,
            "(0.1,0.1,0) (-0.1,0.1,0) (0,0,0.1)",
        ),
        Field::new("space origin", Handling::Honoured, "(1,2,3)"),
        Field::new("space units", Handling::Honoured, "\"cm\" \"cm\" \"cm\""),
        Field::new("space units", Handling::Warned, "\"ell\" \"mm\" \"mm\""),
        Field::new(
            "measurement frame",
            Handling::Refused,
            "(0,1,0) (1,0,0) (0,0,1)",
        ),
        Field::new("sample units", Handling::Warned, "1/cm"),
        Field::new("old min", Handling::Warned, "0.5"),
        Field::new("old max", Handling::Warned, "20"),
    ],
};

/// Spaces whose axes are a right hand's: what they are called in a body is nothing to cloth.
const RIGHT_HANDED: [&str; 7] = [
    "right-anterior-superior",
    "ras",
    "left-posterior-superior",
    "lps",
    "scanner-xyz",
    "3d-right-handed",
    "",
];

/// Kinds of an axis along which voxels lie.
const SPATIAL: [&str; 4] = ["domain", "space", "???", "none"];
/// Kinds of an axis along which the numbers of a voxel lie, in an order that does not matter
/// or that is ours.
const WITHIN: [&str; 11] = [
    "???",
    "none",
    "stub",
    "scalar",
    "list",
    "vector",
    "rgb-color",
    "3-color",
    "3-vector",
    "point",
    "covariant-vector",
];
/// The kind of a symmetric matrix by rows.
const MATRIX: &str = "3d-symmetric-matrix";

/// The fields of a head that matter.
#[derive(Default)]
pub(super) struct Head {
    pub scalar: Option<Scalar>,
    pub dimension: Option<u64>,
    pub sizes: Vec<u32>,
    /// `None`: it is not said.
    pub big_endian: Option<bool>,
    pub data_file: Option<String>,
    pub line_skip: u64,
    pub byte_skip: i64,
    spacings: Vec<f64>,
    thicknesses: Vec<f64>,
    mins: Vec<f64>,
    maxs: Vec<f64>,
    centerings: Vec<String>,
    units: Vec<String>,
    kinds: Vec<String>,
    directions: Vec<Option<Vec<f64>>>,
    origin: Option<[f64; 3]>,
    space_units: Vec<String>,
    sample_units: String,
    old: Vec<String>,
    /// Names of the fields that stood there already.
    seen: Vec<String>,
}

/// Where the voxels lie.
pub(super) struct Scale {
    /// From a voxel to the next along each axis, mm.
    pub steps: [[f64; 3]; 3],
    /// Centre of the first, mm.
    pub origin: Option<[f64; 3]>,
    /// Why the size of a voxel is not known.
    pub unknown: Option<String>,
}

impl Head {
    /// The head at the start of a file, and where it ends, if it does.
    pub fn of(start: &[u8]) -> Result<(Self, Option<usize>), Wrong> {
        if !start.starts_with(b"NRRD000") {
            return Err(Wrong::new(
                "it does not begin with NRRD000",
                "give an NRRD of raw encoding",
            ));
        }
        let mut head = Self::default();
        let mut place = 0;
        for line in start.split_inclusive(|&byte| byte == b'\n') {
            place += line.len();
            let text = String::from_utf8_lossy(line);
            let text = text.trim();
            if text.is_empty() && line.ends_with(b"\n") {
                return Ok((head, Some(place)));
            }
            if text.starts_with('#') {
                continue;
            }
            if let Some((key, value)) = text.split_once(':')
                && !value.starts_with('=')
            {
                let name = key.to_ascii_lowercase().replace(' ', "");
                if head.seen.contains(&name) {
                    return Err(Wrong::new(
                        format!("its field {key:.40} stands there twice"),
                        "leave the right one",
                    ));
                }
                head.take(&name, value.trim())?;
                head.seen.push(name);
            }
        }
        Ok((head, None))
    }

    fn take(&mut self, key: &str, value: &str) -> Result<(), Wrong> {
        let number_list = |field: &str| {
            let remedy = "give a number for each axis, or NaN where it is not known";
            numbers(value).ok_or_else(|| Wrong::new(format!("its {field} are {value:.60}"), remedy))
        };
        match key {
            "type" => {
                let scalar = Scalar::of_nrrd(value);
                let remedy = "give whole numbers of 8 to 32 bits, float or double";
                let found =
                    scalar.ok_or_else(|| Wrong::new(format!("its type is {value:.40}"), remedy));
                self.scalar = Some(found?);
            }
            "dimension" => self.dimension = Some(value.parse().unwrap_or(0)),
            "sizes" => {
                let sizes: Result<Vec<u32>, _> = value.split_whitespace().map(str::parse).collect();
                let remedy = "give the voxels along each axis";
                self.sizes =
                    sizes.map_err(|_| Wrong::new(format!("its sizes are {value:.60}"), remedy))?;
            }
            "encoding" if !value.eq_ignore_ascii_case("raw") => {
                return Err(Wrong::new(
                    format!("its encoding is {value:.40}"),
                    "write it again of raw encoding (unu save -f nrrd -e raw)",
                ));
            }
            "endian" => {
                self.big_endian = Some(match value.to_ascii_lowercase().as_str() {
                    "big" => true,
                    "little" => false,
                    _ => {
                        let what = format!("its endian is {value:.40}");
                        return Err(Wrong::new(what, "give big or little"));
                    }
                });
            }
            "lineskip" => {
                let remedy = "give how many lines stand before the voxels";
                let skip = value.parse();
                self.line_skip =
                    skip.map_err(|_| Wrong::new(format!("its line skip is {value:.40}"), remedy))?;
            }
            "byteskip" => {
                let skip = value.parse::<i64>().ok().filter(|&skip| skip >= -1);
                let remedy = "give how many bytes stand before the voxels, or -1 where nothing stands behind them";
                self.byte_skip = skip
                    .ok_or_else(|| Wrong::new(format!("its byte skip is {value:.40}"), remedy))?;
            }
            "datafile" => self.take_data_file(value)?,
            "spacings" => self.spacings = number_list("spacings")?,
            "thicknesses" => self.thicknesses = number_list("thicknesses")?,
            "axismins" => self.mins = number_list("axis mins")?,
            "axismaxs" => self.maxs = number_list("axis maxs")?,
            "centers" | "centerings" => self.centerings = words(value),
            "units" => self.units = quoted(value),
            "kinds" => self.kinds = words(value),
            _ => return self.take_space(key, value),
        }
        Ok(())
    }

    /// Fields of the space around the voxels, and of what their numbers mean.
    fn take_space(&mut self, key: &str, value: &str) -> Result<(), Wrong> {
        let vectors = |field: &str| {
            let remedy = "give a vector of three numbers for each axis, as (0.1,0,0)";
            vectors(value).ok_or_else(|| Wrong::new(format!("its {field} is {value:.80}"), remedy))
        };
        match key {
            "space" if !RIGHT_HANDED.contains(&value.to_ascii_lowercase().as_str()) => {
                return Err(Wrong::new(
                    format!("its space is {value:.40}, which is not known to be right-handed"),
                    "turn it over to right-anterior-superior or left-posterior-superior, or an S \
                     twist becomes Z",
                ));
            }
            "spacedimension" if value != "3" => {
                return Err(Wrong::new(
                    format!("its space dimension is {value:.20}"),
                    "give a volume in a space of three",
                ));
            }
            "spacedirections" => self.directions = vectors("space directions")?,
            "spaceorigin" => {
                let origin = vectors("space origin")?;
                self.origin = match origin.as_slice() {
                    [Some(origin)] => <[f64; 3]>::try_from(origin.as_slice()).ok(),
                    _ => None,
                };
                if self.origin.is_none() {
                    return Err(Wrong::new(
                        format!("its space origin is {value:.60}"),
                        "give one vector of three numbers, as (0,0,0)",
                    ));
                }
            }
            "spaceunits" => self.space_units = quoted(value),
            "measurementframe" => {
                let straight: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
                let frame = vectors("measurement frame")?;
                let same = frame.len() == 3
                    && (frame.iter().zip(straight))
                        .all(|(found, wanted)| found.as_deref() == Some(&wanted[..]));
                if !same {
                    return Err(Wrong::new(
                        format!("its measurement frame is {value:.80}"),
                        "turn the matrices of its voxels into x, y and z, and leave the frame out",
                    ));
                }
            }
            "sampleunits" => self.sample_units = value.trim_matches('"').to_owned(),
            "oldmin" => self.old.push(format!("old min, {value:.20},")),
            "oldmax" => self.old.push(format!("old max, {value:.20},")),
            _ => {}
        }
        Ok(())
    }

    fn take_data_file(&mut self, value: &str) -> Result<(), Wrong> {
        let several = value.starts_with("LIST") || value.contains('%');
        if several || value.is_empty() {
            return Err(Wrong::new(
                format!("its data file is {value:.60}: not one file"),
                "put all layers into one file, one behind the other",
            ));
        }
        self.data_file = Some(value.to_owned());
        Ok(())
    }

    /// Whether the numbers of a voxel are a symmetric matrix by rows; refuses axes of
    /// another kind or order.
    pub fn kinds(&self, axes: usize) -> Result<bool, Wrong> {
        if self.kinds.is_empty() {
            return Ok(false);
        }
        let within = &self.kinds[..axes.saturating_sub(3).min(self.kinds.len())];
        let sound = |kind: &String| WITHIN.contains(&kind.as_str()) || kind == MATRIX;
        let spatial = |kind: &String| SPATIAL.contains(&kind.as_str());
        let placed = self.kinds.iter().skip(within.len());
        if self.kinds.len() != axes || !within.iter().all(sound) || !placed.clone().all(spatial) {
            return Err(Wrong::new(
                format!("its kinds are {:.80}", self.kinds.join(" ")),
                "give three axes of voxels, before them at most one with the numbers of a voxel \
                 (unu permute): linear RGB, or a symmetric matrix",
            ));
        }
        Ok(within.iter().any(|kind| kind == MATRIX))
    }

    /// Where the voxels lie.
    pub fn scale(
        &self,
        axes: usize,
        size: [u32; 3],
        warnings: &mut Vec<String>,
    ) -> Result<Scale, Wrong> {
        let first = axes - 3;
        let of_space = lengths("space units", &self.space_units, 3, 0, warnings);
        // Some programs name the unit of each axis beside its direction.
        let by_axis = !self.directions.is_empty() && !self.units.is_empty();
        let space = match by_axis {
            true if self.space_units.is_empty() => {
                lengths("units", &self.units, axes, first, warnings)
            }
            true => {
                if lengths("units", &self.units, axes, first, warnings) != of_space {
                    warnings.push("its units are not its space units, which are taken".to_owned());
                }
                of_space
            }
            false => of_space,
        };
        let mut origin = self
            .origin
            .filter(|origin| origin.iter().all(|x| x.is_finite()));
        if let Some(origin) = &mut origin {
            (0..3).for_each(|k| origin[k] *= space[k]);
        }
        if !self.directions.is_empty() {
            let steps = self.step_vectors(axes, space)?;
            self.remark_beside_directions(first, warnings);
            return Ok(Scale {
                steps,
                origin,
                unknown: None,
            });
        }
        let units = lengths("units", &self.units, axes, first, warnings);
        let mut steps = [[0.0; 3]; 3];
        let mut unknown = [false; 3];
        for k in 0..3 {
            let at = |list: &[f64]| list.get(first + k).copied().filter(|x| x.is_finite());
            let (spacing, min, max) = (at(&self.spacings), at(&self.mins), at(&self.maxs));
            let node = (self.centerings.get(first + k)).is_some_and(|kind| kind == "node");
            let gaps = f64::from(size[k]) - f64::from(u8::from(node));
            let between = min.zip(max).map(|(min, max)| (max - min) / gaps);
            let step = spacing
                .or(between)
                .filter(|step| step.is_finite() && *step != 0.0);
            unknown[k] = step.is_none();
            let step = step.unwrap_or(1.0) * units[k];
            steps[k][k] = step;
            if let Some(min) = min {
                let edge = if node { 0.0 } else { 0.5 * step };
                origin.get_or_insert([0.0; 3])[k] = min * units[k] + edge;
            }
            if let (Some(spacing), Some(between)) = (spacing, between)
                && !((spacing - between).abs() <= 0.01 * spacing.abs())
            {
                warnings.push(
                    "its axis maxs do not agree with its spacings, which are taken".to_owned(),
                );
            }
        }
        let unknown = fill_unknown(&mut steps, unknown);
        Ok(Scale {
            steps,
            origin,
            unknown,
        })
    }

    /// Says which fields are not followed for the space directions beside them.
    fn remark_beside_directions(&self, first: usize, warnings: &mut Vec<String>) {
        let long = |vector: &[f64]| vector.iter().map(|x| x * x).sum::<f64>().sqrt();
        let other =
            (self.spacings.iter().zip(&self.directions).skip(first)).any(|(spacing, direction)| {
                let edge = direction.as_deref().map_or(f64::NAN, long);
                spacing.is_finite() && !((spacing.abs() / edge - 1.0).abs() <= 1e-3)
            });
        let given = |list: &[f64]| list.iter().any(|number| number.is_finite());
        let fields = [
            ("spacings", other),
            ("axis mins", given(&self.mins)),
            ("axis maxs", given(&self.maxs)),
        ];
        for (field, stands) in fields {
            if stands {
                warnings.push(format!(
                    "its {field} stand beside space directions, which are taken"
                ));
            }
        }
    }

    /// The space directions of the axes along which voxels lie, mm.
    fn step_vectors(&self, axes: usize, space: [f64; 3]) -> Result<[[f64; 3]; 3], Wrong> {
        let first = axes - 3;
        let (within, placed) = self.directions.split_at(first.min(self.directions.len()));
        let mut steps = [[0.0; 3]; 3];
        let complete = placed.len() == 3 && within.iter().all(Option::is_none);
        let vectors = placed.iter().flatten().filter(|vector| vector.len() == 3);
        if !complete || vectors.clone().count() != 3 {
            return Err(Wrong::new(
                "its space directions are not none for the numbers of a voxel, then three vectors",
                "put the axis of the numbers of a voxel first (unu permute), in a space of three",
            ));
        }
        for (step, vector) in steps.iter_mut().zip(vectors) {
            for k in 0..3 {
                step[k] = vector[k] * space[k];
            }
        }
        Ok(steps)
    }

    /// Says which fields were not followed.
    pub fn remarks(&self, warnings: &mut Vec<String>) {
        let axes = self.thicknesses.len();
        let differs = (self.thicknesses.iter().enumerate()).any(|(axis, thickness)| {
            let spacing = self.spacings.get(axis).copied().unwrap_or(f64::NAN);
            axis + 3 >= axes && thickness.is_finite() && (thickness / spacing - 1.0).abs() > 1e-3
        });
        if differs {
            warnings.push(
                "its thicknesses are not its spacings: taking voxels without gaps between them"
                    .to_owned(),
            );
        }
        if !["", "1/mm", "mm^-1", "???"].contains(&self.sample_units.as_str()) {
            warnings.push(format!(
                "its sample units are {:.40}: taking its numbers as 1/mm",
                self.sample_units
            ));
        }
        for old in &self.old {
            warnings.push(format!(
                "its {old} says that its numbers stand for others: taking them as they are (unu \
                 unquantize makes them again)"
            ));
        }
    }
}

/// Gives axes of no known spacing that of another axis, else 1 mm; says so.
fn fill_unknown(steps: &mut [[f64; 3]; 3], unknown: [bool; 3]) -> Option<String> {
    let known = (0..3).find(|&k| !unknown[k]);
    let instead = known.map_or(1.0, |k| steps[k][k].abs());
    for k in (0..3).filter(|&k| unknown[k]) {
        steps[k][k] = instead;
    }
    unknown
        .contains(&true)
        .then(|| format!("its spacings do not say how large a voxel is: taking {instead} mm"))
}

/// Millimetres of the units of three axes, the first of which is the `first` of `count`.
fn lengths(
    field: &str,
    units: &[String],
    count: usize,
    first: usize,
    warnings: &mut Vec<String>,
) -> [f64; 3] {
    let mut lengths = [1.0; 3];
    let mut strange = Vec::new();
    for (k, length) in lengths.iter_mut().enumerate() {
        // Some programs leave out the axes that have no length.
        let skipped = if units.len() == count { first } else { 0 };
        let Some(unit) = units.get(skipped + k) else {
            continue;
        };
        match units::mm(unit) {
            Some(mm) => *length = mm,
            None if units::is_none(unit) => {}
            None => strange.push(unit.as_str()),
        }
    }
    if !strange.is_empty() {
        strange.dedup();
        let strange = strange.join(", ");
        warnings.push(format!(
            "its {field} {strange:.60} are no length that is known: taking mm; --voxel gives the \
             edge of a voxel in mm"
        ));
    }
    lengths
}

fn words(value: &str) -> Vec<String> {
    let words = value.split_whitespace();
    words
        .map(|word| word.trim_matches('"').to_ascii_lowercase())
        .collect()
}

/// Texts between quotes; words, where there are none.
fn quoted(value: &str) -> Vec<String> {
    if !value.contains('"') {
        return value.split_whitespace().map(str::to_owned).collect();
    }
    let between = value.split('"').skip(1).step_by(2);
    between.map(|text| text.trim().to_owned()).collect()
}

/// Vectors in brackets, and `none` for axes that have none.
fn vectors(value: &str) -> Option<Vec<Option<Vec<f64>>>> {
    let mut vectors = Vec::new();
    let mut rest = value.trim();
    while !rest.is_empty() {
        if let Some(open) = rest.strip_prefix('(') {
            let (inside, behind) = open.split_once(')')?;
            let vector: Option<Vec<f64>> = (inside.split(','))
                .map(|number| number.trim().parse().ok())
                .collect();
            vectors.push(Some(vector?));
            rest = behind.trim_start();
        } else {
            let end = rest.find(char::is_whitespace).unwrap_or(rest.len());
            let (word, behind) = rest.split_at(end);
            if !word.eq_ignore_ascii_case("none") {
                return None;
            }
            vectors.push(None);
            rest = behind.trim_start();
        }
    }
    Some(vectors)
}
