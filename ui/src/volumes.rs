//! What is exported of a region of cloth, the scene for another renderer that goes beside
//! it, and what is said before it is written: alike on the command line and in the window.

use std::path::Path;

use pickglass::cloth::{ClothWindow, Part, PreparedCloth, Region};
use pickglass::design::Design;
use pickglass::engine::{self, StillError, StillRequest};
use pickglass::formats::volume::{Attachment, Plan, VolumeFormat, bytes_in_words};
use pickglass::formats::yarns::about_bytes;
use pickglass::volume::source::{Frame, VoxelSource};
use pickglass::yarn::tubes::{self, TubesError, YarnTube};

/// Pixels across the scene's picture.
const SCENE_WIDTH: u32 = 1280;

/// Voxels of a region, as fine as the cloth's own where no number is given, and what goes
/// beside their file, seen and lit as `request` says.
///
/// # Errors
/// When there is no such window or the request is not usable.
pub fn voxels<'c>(
    cloth: &'c PreparedCloth,
    (region, part, per_crossing): (Region, Part, Option<u32>),
    path: &Path,
    request: &StillRequest,
) -> anyhow::Result<(ClothWindow<'c>, Vec<Attachment>)> {
    cloth.check_level().map_err(anyhow::Error::msg)?;
    let window = ClothWindow::new(cloth.cloth(), region, part, per_crossing)?;
    let attached = scene_beside(path, &window.frame(), request)?;
    Ok((window, attached))
}

/// The yarns of a region.
///
/// # Errors
/// When it is empty or too large, or a yarn cannot be built.
pub fn yarns(design: &Design, region: &Region) -> Result<Vec<YarnTube>, TubesError> {
    let threads = |first: i64, count: u32| first..first.saturating_add(i64::from(count));
    tubes::tubes(
        design,
        threads(region.end, region.ends),
        threads(region.pick, region.picks),
    )
}

/// What goes beside a volume of this name and size: a `.vol`'s scene, with a picture of the
/// volume's own shape that is seen and lit as `request` says; nothing beside others.
///
/// # Errors
/// When the request is not usable.
fn scene_beside(
    path: &Path,
    frame: &Frame,
    request: &StillRequest,
) -> Result<Vec<Attachment>, StillError> {
    if VolumeFormat::of(path) != Some(VolumeFormat::Vol) {
        return Ok(Vec::new());
    }
    let shape = f64::from(frame.size.y) / f64::from(frame.size.x);
    let height = (f64::from(SCENE_WIDTH) * shape)
        .round()
        .clamp(1.0, 16_384.0);
    let request = StillRequest {
        width: SCENE_WIDTH,
        height: height as u32,
        ..request.clone()
    };
    engine::scene_files(path, frame, &request)
}

/// What writing voxels comes to.
pub fn voxels_in_words(plan: &Plan, frame: &Frame) -> String {
    let [x, y, z] = frame.size.to_array();
    format!(
        "{}{} in {} file{}: {x} × {y} × {z} voxels of {:.2} µm, about {:.1} s",
        if plan.exact { "" } else { "about " },
        bytes_in_words(plan.bytes()),
        plan.files.len(),
        if plan.files.len() == 1 { "" } else { "s" },
        frame.edge_mm * 1e3,
        plan.seconds,
    )
}

/// What writing yarns comes to.
pub fn yarns_in_words(tubes: &[YarnTube], path: &Path) -> String {
    let about = bytes_in_words(about_bytes(tubes, path));
    format!("about {about}: {} yarns", tubes.len())
}
