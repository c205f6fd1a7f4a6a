//! What an export says before it writes, and the scene for another renderer that goes
//! beside a volume: alike on the command line and in the window.

use std::path::Path;

use pickglass::formats::volume::{Attachment, Plan, VolumeFormat, bytes_in_words};
use pickglass::formats::yarns;
use pickglass::still::{self, StillError, StillRequest};
use pickglass::volume::source::Frame;
use pickglass::yarn::tubes::YarnTube;

/// Pixels across the scene's picture.
const WIDTH: u32 = 1280;

/// What goes beside a volume of this name and size: a `.vol`'s scene, with a picture of the
/// volume's own shape that is seen and lit as `request` says; nothing beside others.
///
/// # Errors
/// When the request is not usable.
pub fn scene_beside(
    path: &Path,
    frame: &Frame,
    request: &StillRequest,
) -> Result<Vec<Attachment>, StillError> {
    if VolumeFormat::of(path) != Some(VolumeFormat::Vol) {
        return Ok(Vec::new());
    }
    let shape = f64::from(frame.size.y) / f64::from(frame.size.x);
    let height = (f64::from(WIDTH) * shape).round().clamp(1.0, 16_384.0);
    let request = StillRequest {
        width: WIDTH,
        height: height as u32,
        ..request.clone()
    };
    still::scene_files(path, frame, &request)
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
    let about = bytes_in_words(yarns::about_bytes(tubes, path));
    format!("about {about}: {} yarns", tubes.len())
}
