//! A picture about to be taken: camera, light and plan of a request.

use std::ops::Range;

use glam::{Vec2, Vec3};

use super::StillError;
use super::developing::Developing;
use super::request::{LightChoice, StillRequest, Stop};
use crate::design::{Design, Positions};
use crate::film::{Denoise, Pixel, Tone};
use crate::formats::exr;
use crate::limits;
use crate::memory;
use crate::plan::Plan;
use crate::scene::{Bounds, Camera, LightRig, Pose, View};

/// Degrees across the picture where the eye has a direction of its own.
const FIELD_OF_VIEW: f32 = 30.0;

/// A picture about to be taken.
pub struct Shot<'r> {
    /// What is asked for.
    pub request: &'r StillRequest,
    /// The light, read once.
    pub lights: LightRig,
    /// What is simulated.
    pub plan: Plan,
}

impl<'r> Shot<'r> {
    /// Reads the light; `plan` says what is simulated.
    ///
    /// # Errors
    /// When the picture would be too large, or the light is not usable.
    pub fn new(request: &'r StillRequest, plan: Plan) -> Result<Self, StillError> {
        ask_for_picture(request.width, request.height)?;
        Ok(Self {
            lights: lights(&request.light, request.pose())?,
            plan,
            request,
        })
    }

    /// How its film is shown.
    pub(super) fn developing(&self) -> Developing {
        Developing {
            tone: Tone {
                exposure: self.request.exposure_ev,
            },
            denoise: self.plan.showing.denoise,
        }
    }
}

/// Width of cloth a view shows when none is asked for, mm.
pub fn usual_width_mm(view: View, design: &Design) -> f32 {
    let pitch = design
        .sett()
        .ends
        .mean_pitch_mm()
        .max(design.sett().picks.mean_pitch_mm());
    match view {
        View::Close => pitch * 9.0,
        View::Oblique | View::Grazing => pitch * 24.0,
        View::Face | View::Back => (pitch * design.ends() as f32).clamp(pitch * 24.0, pitch * 72.0),
    }
}

/// The middle of a picture at its own scale, at most so many pixels across and down. A slanting
/// view of it is the same view of less cloth.
pub fn middle(design: &Design, request: &StillRequest, most: [u32; 2]) -> StillRequest {
    let (width, height) = (request.width.min(most[0]), request.height.min(most[1]));
    let whole = request.width_mm;
    let whole = whole.unwrap_or_else(|| usual_width_mm(request.view, design));
    StillRequest {
        width,
        height,
        width_mm: Some(whole * width as f32 / request.width as f32),
        stop: Stop::default(),
        ..request.clone()
    }
}

/// The light on a cloth that lies like this: it stays with the viewer.
pub(super) fn lights(choice: &LightChoice, pose: Pose) -> Result<LightRig, StillError> {
    let rig = match choice {
        LightChoice::Preset(name) => LightRig::preset(name)?,
        LightChoice::Sun(heading) => LightRig::sun(heading.azimuth, heading.elevation)?,
        LightChoice::Environment(path) => {
            let read = exr::read_environment(path)?;
            let mut rig = LightRig::from_image(&path.display().to_string(), read.image)?;
            rig.warnings.extend(read.warnings);
            rig
        }
    };
    Ok(rig.on(pose))
}

/// Positions are counted from a multiple of this, mm: so near to it, 32 bits tell places a
/// hundredth of a fibre apart.
const NEAR_MM: f64 = 1000.0;

/// The point of the cloth in the middle of a picture of a design, mm.
fn looked_at(design: &Design, request: &StillRequest) -> [f64; 2] {
    let half = |positions: Positions| f64::from(0.5 * positions.repeat_mm() as f32);
    match request.centre_mm {
        Some(centre) => centre.map(f64::from),
        None => [half(design.end_positions()), half(design.pick_positions())],
    }
}

/// The place that the positions of a picture of a design are counted from, by its cloth as by
/// its [`camera`], mm: the first crossing, unless that is far away.
pub(super) fn origin(design: &Design, request: &StillRequest) -> [f64; 2] {
    looked_at(design, request).map(|mm| match mm {
        near if near.abs() <= NEAR_MM => 0.0,
        far => (far / NEAR_MM).round() * NEAR_MM,
    })
}

/// The camera of a picture of a design, with positions counted from its [`origin`].
pub(super) fn camera(design: &Design, request: &StillRequest) -> Result<Camera, StillError> {
    let (at, origin) = (looked_at(design, request), origin(design, request));
    let [x, y] = [0, 1].map(|axis| (at[axis] - origin[axis]) as f32);
    let usual = usual_width_mm(request.view, design);
    camera_at(request, Vec3::new(x, y, 0.0), usual)
}

/// Where a picture of `request` lies on one of `before`, the same cloth seen from the same
/// side without perspective: its upper left corner in pixels of that one, and how many of
/// those a pixel is. `None` where the two are not such views.
pub fn place_on(
    design: &Design,
    before: &StillRequest,
    request: &StillRequest,
) -> Option<([f32; 2], f32)> {
    if !(before.is_straight() && request.is_straight() && before.view == request.view) {
        return None;
    }
    let cameras = [camera(design, before).ok()?, camera(design, request).ok()?];
    let origins = [origin(design, before), origin(design, request)];
    let moved = [0, 1].map(|axis| (origins[1][axis] - origins[0][axis]) as f32);
    let at = |camera: &Camera, x: f32, y: f32| camera.ray(x, y).origin.truncate();
    let [before, request] = cameras;
    let corner = at(&before, 0.0, 0.0);
    let (across, down) = (
        at(&before, 1.0, 0.0) - corner,
        at(&before, 0.0, 1.0) - corner,
    );
    let offset = at(&request, 0.0, 0.0) - corner + Vec2::from_array(moved);
    let step = at(&request, 1.0, 0.0) - at(&request, 0.0, 0.0);
    let pixels = |vector: glam::Vec2, along: glam::Vec2| vector.dot(along) / along.length_squared();
    let scale = pixels(step, across);
    let place = [pixels(offset, across), pixels(offset, down)];
    let sound = scale > 0.0 && scale.is_finite() && place.iter().all(|at| at.is_finite());
    sound.then_some((place, scale))
}

/// The camera of a request that looks at `target` and shows `usual` mm where the request
/// does not say.
fn camera_at(request: &StillRequest, target: Vec3, usual: f32) -> Result<Camera, StillError> {
    let (width, height) = (request.width, request.height);
    if !limits::PICTURE_SIDE.contains(&width) || !limits::PICTURE_SIDE.contains(&height) {
        return Err(StillError::Size(width, height));
    }
    let width_mm = request.width_mm.unwrap_or(usual);
    if !limits::PICTURE_MM.contains(&width_mm) {
        return Err(StillError::Width(width_mm));
    }
    if let Some([x, y]) = request.centre_mm
        && ![x, y].iter().all(|mm| limits::CENTRE_MM.contains(mm))
    {
        return Err(StillError::Centre(x, y));
    }
    let camera = match request.eye {
        None => request.view.camera(target, width_mm, width, height),
        Some(heading) => {
            let from = heading.towards();
            let from = from * request.view.pose(false).turn();
            Camera::perspective(
                target,
                from,
                Vec3::Y,
                FIELD_OF_VIEW,
                width_mm,
                width,
                height,
            )
        }
    };
    Ok(match request.turned {
        true => camera.turned(),
        false => camera,
    })
}

/// The camera of a request over a box: its middle and its width, unless the request says.
pub(super) fn camera_over(bounds: Bounds, request: &StillRequest) -> Result<Camera, StillError> {
    let middle = (bounds.min + bounds.max) * 0.5;
    let [x, y] = request.centre_mm.unwrap_or([middle.x, middle.y]);
    camera_at(
        request,
        Vec3::new(x, y, middle.z),
        bounds.max.x - bounds.min.x,
    )
}

/// Bytes a pixel of a picture that is shown and written: colours, samples, encoded bytes.
pub(super) const SHOWN_BYTES: u64 = 40;

/// Asks for the memory that a picture takes from film to file.
///
/// # Errors
/// [`StillError::Memory`].
pub(super) fn ask_for_picture(width: u32, height: u32) -> Result<(), StillError> {
    let pixel = size_of::<Pixel>() as u64 + Denoise::BYTES + SHOWN_BYTES;
    let pixels = u64::from(width) * u64::from(height);
    memory::ask(pixels.saturating_mul(pixel), || {
        format!("a picture of {width} × {height} pixels")
    })?;
    Ok(())
}

/// The stretch of cloth that a camera sees most of, mm in x and y.
pub(super) fn in_view(camera: &Camera, request: &StillRequest) -> (Range<f32>, Range<f32>) {
    // A slanting view reaches further.
    let reach = match (request.eye, request.view) {
        (Some(eye), _) => (0.8 / eye.towards().z).min(2.5),
        (None, View::Face | View::Back | View::Close) => 0.6,
        (None, View::Oblique) => 1.2,
        (None, View::Grazing) => 2.5,
    };
    let target = camera.target();
    let across = reach * camera.width() as f32 / camera.pixels_per_mm();
    let along = reach * camera.height() as f32 / camera.pixels_per_mm();
    (
        target.x - across..target.x + across,
        target.y - along..target.y + along,
    )
}
