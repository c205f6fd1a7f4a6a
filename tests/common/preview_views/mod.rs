//! The views in which the preview's first minute is judged, and how: the mean difference
//! in colour (ΔE₀₀) between what is shown and a stored reference, both averaged over
//! squares of 4 × 4 pixels in linear light. Unblurred, differences would measure noise.

use std::path::PathBuf;
use std::sync::Arc;

use glam::Vec3;
use pickglass::design::{Design, Structure, WeavePattern};
use pickglass::engine::{StillRequest, usual_width_mm};
use pickglass::film::tone::decode_srgb;
use pickglass::presets;
use pickglass::render::Backing;

/// Size of the pictures.
pub const SIZE: [u32; 2] = [320, 240];
/// The middle of them, of which references are stored: a mean over its squares is as good.
pub const CROP: [u32; 2] = [160, 120];
/// Pixels along a side of the squares that are averaged.
pub const SQUARE: usize = 4;

/// A picture that is asked for.
#[derive(Clone)]
pub struct PreviewView {
    /// As its reference's file is named.
    pub name: String,
    pub design: Arc<Design>,
    pub drawdown: Arc<WeavePattern>,
    pub still: StillRequest,
}

/// A design as it is opened, then looked at from another distance, then edited.
pub struct Visit {
    pub open: PreviewView,
    pub zoom: PreviewView,
    pub edit: PreviewView,
}

/// Presets, and how much wider the second view is.
const VISITS: [(&str, f32); 6] = [
    ("herringbone", 0.4),
    ("denim", 2.5),
    ("silk-satin", 0.4),
    ("damask", 2.5),
    ("default", 0.4),
    ("twills-9", 2.5),
];

/// The six designs.
pub fn visits() -> Vec<Visit> {
    VISITS.map(|(preset, wider)| visit(preset, wider)).into()
}

fn visit(preset: &'static str, wider: f32) -> Visit {
    let design = presets::design(preset).expect("there").expect("sound");
    let drawdown = Arc::new(design.weave());
    let design = Arc::new(design);
    let still = StillRequest {
        width: SIZE[0],
        height: SIZE[1],
        backing: Backing::Itself,
        ..StillRequest::default()
    };
    let width = usual_width_mm(still.view, &design);
    let centre = [
        0.5 * design.end_positions().repeat_mm() as f32,
        0.5 * design.pick_positions().repeat_mm() as f32,
    ];
    let view = |name: &str, width_mm: f32| PreviewView {
        name: format!("{preset}-{name}"),
        design: Arc::clone(&design),
        drawdown: Arc::clone(&drawdown),
        still: StillRequest {
            width_mm: Some(width_mm),
            centre_mm: Some(centre),
            ..still.clone()
        },
    };
    let (open, zoom) = (view("open", width), view("zoom", width * wider));
    let mut edited = WeavePattern::clone(&drawdown);
    let (end, pick) = (edited.ends() / 2, edited.picks() / 2);
    edited.set(end, pick, !edited.get(end, pick));
    let changed = Design::clone(&design)
        .with_structure(Structure::Pattern(edited.clone()))
        .expect("a design");
    let edit = PreviewView {
        name: format!("{preset}-edit"),
        design: Arc::new(changed),
        drawdown: Arc::new(edited),
        ..zoom.clone()
    };
    Visit { open, zoom, edit }
}

/// Where a view's reference lies.
pub fn reference_file(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
        .ancestors()
        .find(|folder| folder.join("tests/pictures/preview").is_dir())
        .expect("the folder of references")
        .join(format!("tests/pictures/preview/{name}.png"))
}

/// The reference of a view, square by square; `None` where none is stored.
#[allow(dead_code, reason = "whoever makes them does not read them")]
pub fn reference(name: &str) -> Option<Vec<Vec3>> {
    let picture = image::open(reference_file(name)).ok()?.to_rgb16();
    let linear = |value: u16| decode_srgb(f32::from(value) / 65535.0);
    Some(
        (picture.pixels())
            .map(|pixel| Vec3::from_array(pixel.0.map(linear)))
            .collect(),
    )
}

/// Linear light of each square of a picture's middle, row by row, of display values over a
/// grey surround.
pub fn squares(width: usize, pixels: &[[f32; 4]]) -> Vec<Vec3> {
    let height = pixels.len() / width;
    let [across, down] = CROP.map(|side| side as usize / SQUARE);
    let left = (width - across * SQUARE) / 2;
    let top = (height - down * SQUARE) / 2;
    let mut sums = vec![Vec3::ZERO; across * down];
    for (at, &[r, g, b, alpha]) in pixels.iter().enumerate() {
        let (x, y) = (
            (at % width).wrapping_sub(left),
            (at / width).wrapping_sub(top),
        );
        let (x, y) = (x / SQUARE, y / SQUARE);
        if x < across && y < down {
            let light = Vec3::new(decode_srgb(r), decode_srgb(g), decode_srgb(b));
            sums[y * across + x] += light * alpha + Vec3::splat(0.2 * (1.0 - alpha));
        }
    }
    let share = 1.0 / (SQUARE * SQUARE) as f32;
    sums.into_iter().map(|sum| sum * share).collect()
}
