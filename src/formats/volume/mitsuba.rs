//! A scene for Mitsuba 3 round an exported `.vol`: our camera, light and path length as
//! an `.xml`, and a few lines of Python that render it.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use glam::Vec3;

use super::{Attachment, beside};
use crate::formats::exr::{self, ExrError};
use crate::scene::{Camera, Environment, EnvironmentImage, LightRig, Sky, luminance};
use crate::volume::source::Frame;

/// Rows of a sky: a third of a degree each, by which the horizon is blurred.
const SKY_ROWS: usize = 512;

/// What the scene shows.
#[derive(Debug, Clone, Copy)]
pub struct Scene<'s> {
    /// From where.
    pub camera: &'s Camera,
    /// What lights it; suns of some width become points.
    pub lights: &'s LightRig,
    /// Scatterings along a path after which it ends.
    pub max_order: u32,
    /// Scattering order from which paths play Russian roulette.
    pub roulette_order: u32,
    /// Whether the sky lights the cloth.
    pub sky: bool,
}

/// Why a volume has no scene.
#[derive(Debug, thiserror::Error)]
pub enum SceneError {
    /// A name that a scene cannot say.
    #[error("{}: its scene cannot name it: {why}; choose another name", path.display())]
    Name {
        /// The volume.
        path: PathBuf,
        /// What of the name.
        why: &'static str,
    },
    /// The sky cannot be encoded.
    #[error(transparent)]
    Sky(#[from] ExrError),
}

/// A file's name as the scene says it, if it can.
fn name_of(path: &Path) -> Result<String, SceneError> {
    let refused = |why| SceneError::Name {
        path: path.to_owned(),
        why,
    };
    let name = path.file_name().unwrap_or_default().to_str();
    let name = name.ok_or_else(|| refused("it is no Unicode"))?;
    if name.contains('$') {
        return Err(refused(
            "Mitsuba takes what stands behind a $ for a parameter",
        ));
    }
    let unsayable = |letter: char| letter.is_control() || matches!(letter, '\u{fffe}' | '\u{ffff}');
    if name.contains(unsayable) {
        return Err(refused("it has characters that XML has not"));
    }
    Ok(name.to_owned())
}

/// The files that stand beside `NAME.vol`: `NAME.xml`, `NAME.py`, and `NAME.sky.exr` where
/// the sky is not the same all round. The scene finds them and the volume beside itself,
/// wherever it is loaded from.
///
/// # Errors
/// When the sky cannot be encoded, or the scene cannot name the volume.
pub fn scene(path: &Path, frame: &Frame, scene: &Scene) -> Result<Vec<Attachment>, SceneError> {
    let (scene_path, sky_path) = (
        path.with_extension("xml"),
        beside(path, "sky").with_extension("exr"),
    );
    let names = Names {
        sigma: name_of(path)?,
        albedo: name_of(&beside(path, "albedo"))?,
        sggx: name_of(&beside(path, "sggx"))?,
        sky: name_of(&sky_path)?,
    };
    let sky = Surroundings::of(scene.lights);
    let mut files = vec![
        Attachment {
            bytes: xml(&names, frame, scene, &sky).into_bytes(),
            path: scene_path.clone(),
        },
        Attachment {
            path: path.with_extension("py"),
            bytes: python(&name_of(&scene_path)?).into_bytes(),
        },
    ];
    if let Surroundings::Picture { columns, radiance } = sky {
        let bytes = exr::encode_rgb(columns, SKY_ROWS, |x, y| {
            let (u, v) = (
                (x as f32 + 0.5) / columns as f32,
                (y as f32 + 0.5) / SKY_ROWS as f32,
            );
            radiance(EnvironmentImage::direction(u, v))
        })?;
        files.push(Attachment {
            path: sky_path,
            bytes,
        });
    }
    Ok(files)
}

/// The files that a scene names.
struct Names {
    sigma: String,
    albedo: String,
    sggx: String,
    sky: String,
}

/// Light from around, as Mitsuba knows it.
enum Surroundings<'s> {
    Dark,
    Constant(Vec3),
    Picture {
        columns: usize,
        radiance: Box<dyn Fn(Vec3) -> Vec3 + Sync + 's>,
    },
}

impl<'s> Surroundings<'s> {
    fn of(lights: &'s LightRig) -> Self {
        let turn = lights.sky_turn();
        match &lights.sky {
            Sky::Dark => Self::Dark,
            Sky::Dome(dome) if dome.zenith == dome.horizon && dome.zenith == dome.ground => {
                Self::Constant(dome.zenith)
            }
            Sky::Dome(dome) => Self::Picture {
                columns: 16,
                radiance: Box::new(move |towards| dome.radiance(towards * turn)),
            },
            Sky::Image(image) => Self::Picture {
                columns: 2 * SKY_ROWS,
                radiance: Box::new(move |towards| image.radiance(towards * turn)),
            },
        }
    }
}

fn rgb(v: Vec3) -> String {
    format!("{}, {}, {}", v.x, v.y, v.z)
}

fn xml(names: &Names, frame: &Frame, scene: &Scene, around: &Surroundings) -> String {
    let bounds = frame.bounds();
    let centre = (bounds.min + bounds.max) * 0.5;
    let half = (bounds.max - bounds.min) * 0.5;
    let mut text = String::from(
        "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n\
         <!-- A window of cloth from Pickglass, for Mitsuba 3.5.2 (lengths in mm).\n\
         \x20    From 3.6.0 to 3.9.1 Mitsuba samples SGGX wrongly for oblique directions.\n\
         \x20    Approximated: suns of some width are points, a graded sky is a picture of 512\n\
         \x20    rows, flyaway hairs are left out, and the cloth ends where the window does.\n\
         \x20    Not filtered: a point is the voxel that holds it, here and where Pickglass\n\
         \x20    renders the .vol. -->\n\
         <scene version=\"3.5.0\">\n  <!-- Files are those beside this one. -->\n  \
         <path value=\".\"/>\n  <default name=\"spp\" value=\"64\"/>\n",
    );
    // Writing to a string cannot fail.
    let _ = writeln!(
        text,
        "  <integrator type=\"volpath\">\n    <!-- Depth counts the light's end of a path too. -->\n    \
         <integer name=\"max_depth\" value=\"{}\"/>\n    <integer name=\"rr_depth\" value=\"{}\"/>\n  \
         </integrator>",
        i64::from(scene.max_order) + 1,
        scene.roulette_order.min(1 << 30),
    );
    text += &sensor(scene.camera);
    if scene.sky {
        match around {
            Surroundings::Dark => {}
            Surroundings::Constant(radiance) => {
                let _ = writeln!(
                    text,
                    "  <emitter type=\"constant\"><rgb name=\"radiance\" value=\"{}\"/></emitter>",
                    rgb(*radiance)
                );
            }
            Surroundings::Picture { .. } => {
                // A ray straight down would wrap round to the zenith: the sky leans a little.
                let _ = writeln!(
                    text,
                    "  <emitter type=\"envmap\">\n    <string name=\"filename\" value=\"{}\"/>\n    \
                     <transform name=\"to_world\"><rotate x=\"1\" angle=\"90.05\"/></transform>\n  \
                     </emitter>",
                    escaped(&names.sky)
                );
            }
        }
    }
    for sun in &scene.lights.suns {
        if luminance(sun.irradiance) <= 0.0 {
            continue;
        }
        let Vec3 { x, y, z } = -sun.towards;
        let _ = writeln!(
            text,
            "  <emitter type=\"directional\">\n    <vector name=\"direction\" x=\"{x}\" y=\"{y}\" \
             z=\"{z}\"/>\n    <rgb name=\"irradiance\" value=\"{}\"/>\n  </emitter>",
            rgb(sun.irradiance)
        );
    }
    let _ = writeln!(
        text,
        "  <shape type=\"cube\">\n    <transform name=\"to_world\">\n      \
         <scale x=\"{}\" y=\"{}\" z=\"{}\"/>\n      <translate x=\"{}\" y=\"{}\" z=\"{}\"/>\n    \
         </transform>\n    <bsdf type=\"null\"/>\n    \
         <medium type=\"heterogeneous\" name=\"interior\">\n      \
         <float name=\"scale\" value=\"1\"/>\n      \
         <boolean name=\"has_spectral_extinction\" value=\"false\"/>",
        half.x, half.y, half.z, centre.x, centre.y, centre.z,
    );
    text += &volume("sigma_t", &names.sigma, "      ");
    text += &volume("albedo", &names.albedo, "      ");
    text += "      <phase type=\"sggx\">\n";
    text += &volume("S", &names.sggx, "        ");
    text += "      </phase>\n    </medium>\n  </shape>\n</scene>\n";
    text
}

/// A grid of the medium. Trilinear filtering mixes the fibres of neighbouring voxels.
fn volume(name: &str, file: &str, indent: &str) -> String {
    let file = escaped(file);
    format!(
        "{indent}<volume name=\"{name}\" type=\"gridvolume\">\n\
         {indent}  <string name=\"filename\" value=\"{file}\"/>\n\
         {indent}  <string name=\"filter_type\" value=\"nearest\"/>\n\
         {indent}  <boolean name=\"raw\" value=\"true\"/>\n\
         {indent}  <boolean name=\"use_grid_bbox\" value=\"true\"/>\n\
         {indent}</volume>\n"
    )
}

fn sensor(camera: &Camera) -> String {
    let (width, height) = (camera.width(), camera.height());
    let [w, h] = [width, height].map(|side| side as f32);
    let middle = camera.ray(0.5 * w, 0.5 * h);
    let [left, right] = [0.0, w].map(|x| camera.ray(x, 0.5 * h).direction);
    let angle = left.angle_between(right).to_degrees();
    let perspective = angle > 1e-3;
    let (_, up) = camera.film_axes();
    let size = 0.5 * w / camera.pixels_per_mm();
    let (kind, field, scale) = if perspective {
        let field = format!(
            "    <float name=\"fov\" value=\"{angle}\"/>\n    <string name=\"fov_axis\" value=\"x\"/>\n"
        );
        ("perspective", field, String::new())
    } else {
        let scale = format!("      <scale x=\"{size}\" y=\"{size}\"/>\n");
        ("orthographic", String::new(), scale)
    };
    format!(
        "  <sensor type=\"{kind}\">\n{field}    <float name=\"near_clip\" value=\"0.001\"/>\n    \
         <float name=\"far_clip\" value=\"100000\"/>\n    <transform name=\"to_world\">\n{scale}      \
         <lookat origin=\"{}\" target=\"{}\" up=\"{}\"/>\n    </transform>\n    \
         <film type=\"hdrfilm\">\n      <integer name=\"width\" value=\"{width}\"/>\n      \
         <integer name=\"height\" value=\"{height}\"/>\n      \
         <string name=\"pixel_format\" value=\"rgb\"/>\n      <rfilter type=\"box\"/>\n    </film>\n    \
         <sampler type=\"independent\"><integer name=\"sample_count\" value=\"$spp\"/></sampler>\n  \
         </sensor>\n",
        rgb(middle.origin),
        rgb(camera.target()),
        rgb(up),
    )
}

fn python(xml: &str) -> String {
    let xml = python_text(xml);
    format!(
        "\"\"\"Renders the cloth beside this file: pip install mitsuba==3.5.2\"\"\"\n\
         import sys\nfrom pathlib import Path\n\nimport mitsuba as mi\n\n\
         # llvm_ad_rgb is faster where LLVM 14 or 15 is installed.\n\
         mi.set_variant(\"scalar_rgb\")\n\
         spp = sys.argv[1] if len(sys.argv) > 1 else \"64\"\n\
         here = Path(__file__).resolve()\n\
         scene = mi.load_file(str(here.with_name({xml})), spp=spp)\n\
         image = mi.render(scene)\n\
         mi.util.write_bitmap(str(here.with_suffix(\".exr\")), image)\n\
         mi.util.write_bitmap(str(here.with_suffix(\".png\")), image)\n"
    )
}

/// Text as Python writes it, in ASCII.
fn python_text(text: &str) -> String {
    let mut quoted = String::from("\"");
    for letter in text.chars() {
        // Writing to a string cannot fail.
        let _ = match (letter, u32::from(letter)) {
            ('"' | '\\', _) => write!(quoted, "\\{letter}"),
            (' '..='~', _) => write!(quoted, "{letter}"),
            (_, code @ 0..=0xffff) => write!(quoted, "\\u{code:04x}"),
            (_, code) => write!(quoted, "\\U{code:08x}"),
        };
    }
    quoted.push('"');
    quoted
}

/// Text as an attribute's value.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn python_reads_names_as_they_are() {
        assert_eq!(python_text("a\"b\\c.xml"), r#""a\"b\\c.xml""#);
        assert_eq!(
            python_text("\u{200b}\u{e9}\u{1f9f5}"),
            r#""\u200b\u00e9\U0001f9f5""#
        );
        assert_eq!(escaped("a<&\"b"), "a&lt;&amp;&quot;b");
    }

    #[test]
    fn names_that_a_scene_cannot_say_are_refused() {
        for name in ["a$spp.vol", "a\nb.vol", "a\u{1}.vol", "a\u{ffff}.vol"] {
            let refused = name_of(Path::new(name));
            assert!(refused.is_err(), "{name:?}");
        }
        assert!(name_of(Path::new("B \u{200b}&.VOL")).is_ok());
    }
}
