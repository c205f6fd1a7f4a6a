//! Yarns as geometry, out: Wavefront `.obj` (with an `.mtl`) and binary glTF `.glb`.
//!
//! Each thread is an object of its own: a closed tube and its centre curve, with the
//! yarn's colour as material. OBJ is in mm, x along the picks, y along the ends, z out of
//! the face; glTF is in metres with the face up, as its readers expect.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use glam::Vec3;
use serde_json::{Value, json};

use crate::atomic::{Pending, WriteError};
use crate::design::{Design, Direction, YarnId};
use crate::job::{Cancelled, Job};
use crate::yarn::tubes::{ROUND, YarnTube};

/// Yarns that could not be written.
#[derive(Debug, thiserror::Error)]
pub enum YarnsError {
    /// The owner cancelled the work.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// A file could not be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// A name whose ending is not a format.
    #[error("{}: yarns are written as .obj or .glb; end the name in one of them", .0.display())]
    Ending(PathBuf),
    /// More than a `.glb` can hold.
    #[error("{}: {bytes} bytes are more than a .glb holds (4 GB); choose a smaller region", path.display())]
    TooLarge {
        /// The file.
        path: PathBuf,
        /// Its bytes.
        bytes: u64,
    },
}

/// Whether a name is one of [`write()`]'s.
pub fn is_yarns(path: &Path) -> bool {
    ending(path).is_some()
}

/// About how many bytes [`write()`] will write; 0 for a name that is none of its own.
pub fn about_bytes(tubes: &[YarnTube], path: &Path) -> u64 {
    match ending(path) {
        Some(Ending::Glb) => tubes.iter().flat_map(parts).sum(),
        Some(Ending::Obj) => {
            let points: u64 = tubes.iter().map(|tube| tube.skin.len() as u64).sum();
            let digits = u64::from(points.max(1).ilog10()) + 1;
            // A line of a point, and those of two triangles: an index at each corner.
            points * (37 + 2 * (2 + 3 * (1 + digits)))
        }
        None => 0,
    }
}

#[derive(Clone, Copy)]
enum Ending {
    Obj,
    Glb,
}

fn ending(path: &Path) -> Option<Ending> {
    let ending = path.extension()?.to_str()?.to_ascii_lowercase();
    match ending.as_str() {
        "obj" => Some(Ending::Obj),
        "glb" => Some(Ending::Glb),
        _ => None,
    }
}

/// Writes tubes of a design's yarns; all files or none. Gives the files with their bytes.
///
/// # Errors
/// [`YarnsError`]; nothing is then left behind.
pub fn write(
    design: &Design,
    tubes: &[YarnTube],
    path: &Path,
    job: &Job,
) -> Result<Vec<(PathBuf, u64)>, YarnsError> {
    match ending(path) {
        Some(Ending::Obj) => write_obj(design, tubes, path, job),
        Some(Ending::Glb) => write_glb(design, tubes, path, job),
        None => Err(YarnsError::Ending(path.to_owned())),
    }
}

/// The files that [`write()`] makes.
pub fn files(path: &Path) -> Vec<PathBuf> {
    let beside = matches!(ending(path), Some(Ending::Obj)).then(|| materials(path));
    std::iter::once(path.to_owned()).chain(beside).collect()
}

/// The colours beside an `.obj`.
fn materials(path: &Path) -> PathBuf {
    path.with_extension("mtl")
}

/// Fills a file through a buffer and says how long it became.
fn filled(
    path: &Path,
    fill: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<(Pending, u64), YarnsError> {
    let mut pending = Pending::create(path)?;
    let mut buffer = io::BufWriter::new(pending.file());
    let done = fill(&mut buffer).and_then(|()| buffer.flush());
    drop(buffer);
    let length = done.and_then(|()| pending.file().metadata());
    let length = length.map_err(|error| pending.failed(error))?.len();
    Ok((pending, length))
}

/// A thread by its number in the design's file, which counts from 1.
fn thread_name(tube: &YarnTube) -> String {
    let number = tube.thread + 1;
    match tube.direction {
        Direction::Warp => format!("end_{number}"),
        Direction::Weft => format!("pick_{number}"),
    }
}

/// Linear RGB of a yarn.
fn colour(design: &Design, yarn: YarnId) -> Vec3 {
    design.yarn(yarn).colour.to_linear()
}

fn write_obj(
    design: &Design,
    tubes: &[YarnTube],
    path: &Path,
    job: &Job,
) -> Result<Vec<(PathBuf, u64)>, YarnsError> {
    let materials = materials(path);
    let (library, library_bytes) = filled(&materials, |out| {
        for (number, yarn) in design.yarns().iter().enumerate() {
            let Vec3 { x, y, z } = yarn.colour.to_linear();
            // Readers take the numbers as linear.
            writeln!(
                out,
                "newmtl yarn_{number}\nKd {x} {y} {z}\nKs 0 0 0\nillum 1\n"
            )?;
        }
        Ok(())
    })?;
    let mut cancelled = Ok(());
    let (object, object_bytes) = filled(path, |out| {
        let name = materials.file_name().unwrap_or_default().to_string_lossy();
        writeln!(
            out,
            "# Pickglass: yarns of a window of cloth, mm\nmtllib {name}"
        )?;
        let mut first = 1;
        for (done, tube) in tubes.iter().enumerate() {
            cancelled = job.check();
            if cancelled.is_err() {
                break;
            }
            job.report("yarns", done as f32 / tubes.len() as f32);
            writeln!(out, "o {}\nusemtl yarn_{}", thread_name(tube), tube.yarn.0)?;
            for Vec3 { x, y, z } in tube.skin.iter().chain(&tube.centre) {
                writeln!(out, "v {x} {y} {z}")?;
            }
            for [a, b, c] in tube.triangles() {
                writeln!(out, "f {} {} {}", a + first, b + first, c + first)?;
            }
            write!(out, "l")?;
            let centre = first + tube.skin.len() as u32;
            for place in 0..tube.centre.len() as u32 {
                write!(out, " {}", centre + place)?;
            }
            writeln!(out)?;
            first = centre + tube.centre.len() as u32;
        }
        Ok(())
    })?;
    cancelled?;
    library.commit()?;
    object.commit()?;
    Ok(vec![
        (path.to_owned(), object_bytes),
        (materials, library_bytes),
    ])
}

/// Bytes of the numbers of a tube: points, normals, centres, triangles.
fn parts(tube: &YarnTube) -> [u64; 4] {
    let (points, sections) = (tube.skin.len() as u64, tube.centre.len() as u64);
    let triangles = (sections.saturating_sub(1)) * ROUND as u64 * 2 + (ROUND as u64 - 2) * 2;
    [points * 12, points * 12, sections * 12, triangles * 12]
}

fn write_glb(
    design: &Design,
    tubes: &[YarnTube],
    path: &Path,
    job: &Job,
) -> Result<Vec<(PathBuf, u64)>, YarnsError> {
    let binary: u64 = tubes.iter().flat_map(parts).sum();
    let mut text = document(design, tubes, binary).to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let total = 12 + 8 + text.len() as u64 + 8 + binary;
    let Ok(total_bytes) = u32::try_from(total) else {
        return Err(YarnsError::TooLarge {
            path: path.to_owned(),
            bytes: total,
        });
    };
    let mut cancelled = Ok(());
    let (file, bytes) = filled(path, |out| {
        out.write_all(b"glTF")?;
        for number in [2, total_bytes, text.len() as u32] {
            out.write_all(&number.to_le_bytes())?;
        }
        out.write_all(b"JSON")?;
        out.write_all(&text)?;
        out.write_all(&(binary as u32).to_le_bytes())?;
        out.write_all(b"BIN\0")?;
        for (done, tube) in tubes.iter().enumerate() {
            cancelled = job.check();
            if cancelled.is_err() {
                break;
            }
            job.report("yarns", done as f32 / tubes.len() as f32);
            let normals = tube.normals();
            for value in (tube.skin.iter().chain(&normals).chain(&tube.centre))
                .flat_map(|point| point.to_array())
            {
                out.write_all(&value.to_le_bytes())?;
            }
            for index in tube.triangles().into_iter().flatten() {
                out.write_all(&index.to_le_bytes())?;
            }
        }
        Ok(())
    })?;
    cancelled?;
    file.commit()?;
    Ok(vec![(path.to_owned(), bytes)])
}

/// The JSON of a `.glb`.
fn document(design: &Design, tubes: &[YarnTube], binary: u64) -> Value {
    let (mut views, mut accessors) = (Vec::new(), Vec::new());
    let (mut meshes, mut nodes) = (Vec::new(), Vec::new());
    let mut at = 0;
    for tube in tubes {
        let lengths = parts(tube);
        let first = accessors.len();
        for (part, length) in lengths.into_iter().enumerate() {
            // 34962: vertices, 34963: indices.
            let target = if part == 3 { 34_963 } else { 34_962 };
            accessors.push(match part {
                0 => vectors(views.len(), &tube.skin, true),
                1 => vectors(views.len(), &tube.skin, false),
                2 => vectors(views.len(), &tube.centre, true),
                _ => json!({
                    "bufferView": views.len(), "componentType": 5125,
                    "count": length / 4, "type": "SCALAR",
                }),
            });
            views.push(json!({
                "buffer": 0, "byteOffset": at, "byteLength": length, "target": target,
            }));
            at += length;
        }
        let material = tube.yarn.0;
        let name = thread_name(tube);
        nodes.push(json!({ "mesh": meshes.len(), "name": name }));
        meshes.push(json!({
            "name": name,
            "primitives": [
                {
                    "attributes": { "POSITION": first, "NORMAL": first + 1 },
                    "indices": first + 3, "material": material, "mode": 4,
                },
                { "attributes": { "POSITION": first + 2 }, "material": material, "mode": 3 },
            ],
        }));
    }
    let children: Vec<usize> = (0..nodes.len()).collect();
    let half = std::f64::consts::FRAC_1_SQRT_2;
    nodes.push(json!({
        "name": design.name, "children": children,
        "rotation": [-half, 0.0, 0.0, half], "scale": [0.001, 0.001, 0.001],
    }));
    let materials: Vec<Value> = (0..design.yarns().len())
        .map(|number| {
            let Vec3 { x, y, z } = colour(design, YarnId(number as u16));
            json!({
                "name": design.yarns()[number].name,
                "pbrMetallicRoughness": {
                    "baseColorFactor": [x, y, z, 1.0],
                    "metallicFactor": 0.0, "roughnessFactor": 0.9,
                },
            })
        })
        .collect();
    json!({
        "asset": { "version": "2.0", "generator": "Pickglass" },
        "scene": 0,
        "scenes": [{ "nodes": [nodes.len() - 1] }],
        "nodes": nodes,
        "meshes": meshes,
        "materials": materials,
        "accessors": accessors,
        "bufferViews": views,
        "buffers": [{ "byteLength": binary }],
    })
}

/// An accessor of vectors; places say how far they reach.
fn vectors(view: usize, points: &[Vec3], places: bool) -> Value {
    let mut accessor = json!({
        "bufferView": view, "componentType": 5126, "count": points.len(), "type": "VEC3",
    });
    if places {
        let low = points.iter().copied().fold(Vec3::INFINITY, Vec3::min);
        let high = points.iter().copied().fold(Vec3::NEG_INFINITY, Vec3::max);
        accessor["min"] = json!(low.to_array());
        accessor["max"] = json!(high.to_array());
    }
    accessor
}
