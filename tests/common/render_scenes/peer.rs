//! Hands a dense grid and a view of it to the peer renderer.
#![allow(dead_code, reason = "each test file uses its own part")]

use std::fs;
use std::path::{Path, PathBuf};

use glam::{UVec3, Vec3};
use pickglass::film::Film;
use pickglass::render::RenderSettings;
use pickglass::scene::{Bounds, luminance};
use pickglass::volume::{DenseGrid, sggx_matrix};

/// A perspective view and light that both renderers understand.
#[derive(Clone, Copy)]
pub struct PeerView {
    pub target: Vec3,
    /// Target to camera.
    pub from: Vec3,
    pub field_of_view: f32,
    pub width_mm: f32,
    pub width: u32,
    pub height: u32,
    pub towards_sun: Vec3,
    pub sun: f32,
    pub sky: f32,
}

impl PeerView {
    pub fn camera(&self) -> pickglass::scene::Camera {
        pickglass::scene::Camera::perspective(
            self.target,
            self.from,
            Vec3::Y,
            self.field_of_view,
            self.width_mm,
            self.width,
            self.height,
        )
    }

    pub fn lights(&self) -> pickglass::scene::LightRig {
        use pickglass::scene::{Dome, LightRig, Sky};
        let mut rig: LightRig = super::lone_sun(self.towards_sun, self.sun);
        rig.sky = Sky::Dome(Dome::uniform(Vec3::splat(self.sky)));
        rig
    }
}

fn write_floats(path: &Path, values: impl Iterator<Item = f32>) {
    let bytes: Vec<u8> = values.flat_map(f32::to_le_bytes).collect();
    fs::write(path, bytes).expect("the folder is writable");
}

/// Writes the grid as raw little-endian f32 (x fastest, channels interleaved) and the
/// view as JSON.
pub fn write_scene(
    folder: &Path,
    grid: &DenseGrid,
    bounds: Bounds,
    view: &PeerView,
    settings: &RenderSettings,
) {
    let size = grid.size();
    let cells = || {
        (0..size.z).flat_map(move |z| {
            (0..size.y).flat_map(move |y| (0..size.x).map(move |x| UVec3::new(x, y, z)))
        })
    };
    write_floats(
        &folder.join("sigma.f32"),
        cells().map(|c| grid.cell(c).sigma),
    );
    write_floats(
        &folder.join("albedo.f32"),
        cells().flat_map(|c| grid.optics(grid.cell(c).optics).albedo.to_array()),
    );
    write_floats(
        &folder.join("sggx.f32"),
        cells().flat_map(|c| {
            let voxel = grid.cell(c);
            let s = sggx_matrix(voxel.direction, voxel.alpha);
            [
                s.x_axis.x, s.y_axis.y, s.z_axis.z, s.x_axis.y, s.x_axis.z, s.y_axis.z,
            ]
        }),
    );
    let distance = view.width_mm * 0.5 / (view.field_of_view * 0.5).to_radians().tan();
    let eye = view.target + view.from.normalize_or(Vec3::Z) * distance;
    let list = |v: Vec3| format!("[{}, {}, {}]", v.x, v.y, v.z);
    let json = format!(
        "{{\"size\": [{}, {}, {}], \"min\": {}, \"max\": {}, \"eye\": {}, \"target\": {},\n \
         \"fov\": {}, \"width\": {}, \"height\": {}, \"towards_sun\": {}, \"sun\": {}, \"sky\": {},\n \
         \"max_order\": {}, \"roulette_order\": {}}}\n",
        size.x,
        size.y,
        size.z,
        list(bounds.min),
        list(bounds.max),
        list(eye),
        list(view.target),
        view.field_of_view,
        view.width,
        view.height,
        list(view.towards_sun),
        view.sun,
        view.sky,
        settings.max_order,
        settings.roulette_order,
    );
    fs::write(folder.join("scene.json"), json).expect("the folder is writable");
}

/// Writes mean RGB and the variance of the mean luminance of a film.
pub fn write_film(folder: &Path, name: &str, film: &Film) {
    write_floats(
        &folder.join(format!("{name}-mean.f32")),
        film.pixels().iter().flat_map(|p| p.mean().to_array()),
    );
    write_floats(
        &folder.join(format!("{name}-variance.f32")),
        film.pixels().iter().map(|p| p.variance() as f32),
    );
}

/// The Python that has mitsuba 3.5.2: `PICKGLASS_MITSUBA_PYTHON`, or the environment that
/// `tests/run.sh` makes.
pub fn python() -> Option<PathBuf> {
    let named = std::env::var_os("PICKGLASS_MITSUBA_PYTHON").map(PathBuf::from);
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let made = root.join("target/peers/mitsuba/bin/python");
    named.or(Some(made)).filter(|path| path.exists())
}

/// The peer's script.
pub fn script() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/peers/mitsuba.py")
}

/// Mean squared relative difference of a film to a reference, in luminance: of all pixels,
/// and of all but the worst thousandth.
pub fn relative_mse(film: &Film, reference: &Film) -> [f64; 2] {
    let pairs = film.pixels().iter().zip(reference.pixels());
    let mut squares: Vec<f64> = pairs
        .map(|(a, b)| {
            let (a, b) = (luminance(a.mean()), luminance(b.mean()));
            f64::from((a - b) * (a - b) / (b * b + 1e-4))
        })
        .collect();
    squares.sort_by(f64::total_cmp);
    let mean = |squares: &[f64]| squares.iter().sum::<f64>() / squares.len().max(1) as f64;
    [
        mean(&squares),
        mean(&squares[..squares.len() - squares.len() / 1000]),
    ]
}
