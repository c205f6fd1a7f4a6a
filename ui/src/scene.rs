//! The scene for another renderer that goes beside a volume.

use std::path::Path;

use pickglass::formats::volume::{Attachment, VolumeFormat};
use pickglass::still::{self, StillError, StillRequest};
use pickglass::volume::source::Frame;

/// Pixels across the scene's picture.
const WIDTH: u32 = 1280;

/// What goes beside a volume of this name and size: a `.vol`'s scene, with a picture of the
/// volume's own shape that is seen and lit as `request` says; nothing beside others.
///
/// # Errors
/// When the request is not usable.
pub fn beside(
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
