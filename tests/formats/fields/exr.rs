//! OpenEXR environments, made field by field.

use super::{Outcome, Twins, Walker};
use ::exr::image::FlatImage;
use ::exr::meta::attribute::{Chromaticities, EnvironmentMap};
use ::exr::prelude::{
    AnyChannel, AnyChannels, Encoding, FlatSamples, ImageAttributes, IntegerBounds, Layer,
    LayerAttributes, Vec2, WritableImage,
};
use pickglass::formats::exr::read_environment;
use pickglass::formats::field_table::Field;
use std::path::{Path, PathBuf};

pub fn walkers() -> Vec<Walker> {
    vec![Walker {
        format: "exr",
        twins,
        read,
        named: false,
    }]
}

fn read(path: &Path) -> Outcome {
    match read_environment(path) {
        Ok(read) => Ok((format!("{:?}", read.image), read.warnings)),
        Err(error) => Err(error.to_string()),
    }
}

const SIZE: (usize, usize) = (4, 2);

struct File {
    size: (usize, usize),
    window: IntegerBounds,
    channels: Vec<(&'static str, f32)>,
    own: LayerAttributes,
    chromaticities: Option<Chromaticities>,
    aspect: f32,
    parts: usize,
}

impl File {
    fn new() -> Self {
        Self {
            size: SIZE,
            window: IntegerBounds::from_dimensions(SIZE),
            channels: vec![("R", 0.5), ("G", 0.25), ("B", 2.0)],
            own: LayerAttributes::named("sky"),
            chromaticities: None,
            aspect: 1.0,
            parts: 1,
        }
    }

    fn write(&self, path: PathBuf) -> PathBuf {
        let count = self.size.0 * self.size.1;
        let channels = || -> AnyChannels<FlatSamples> {
            let list = self.channels.iter().map(|&(name, value)| {
                let samples = (0..count).map(|k| value / (1.0 + k as f32));
                let samples = match name {
                    "A" => FlatSamples::F32(vec![value; count]),
                    _ => FlatSamples::F32(samples.collect()),
                };
                AnyChannel::new(name, samples)
            });
            AnyChannels::sort(list.collect())
        };
        let mut attributes = ImageAttributes::new(self.window);
        attributes.pixel_aspect = self.aspect;
        attributes.chromaticities = self.chromaticities;
        let layers = (0..self.parts)
            .map(|part| {
                let mut own = self.own.clone();
                own.layer_name = Some(format!("part {part}").as_str().into());
                Layer::new(self.size, own, Encoding::UNCOMPRESSED, channels())
            })
            .collect();
        let image = FlatImage {
            attributes,
            layer_data: layers,
        };
        image.write().to_file(&path).expect("written");
        path
    }
}

fn twins(folder: &Path, field: &Field, _: &str) -> Twins {
    let (mut with, mut without) = (File::new(), File::new());
    match field.name {
        "envmap" => with.own.environment_map = Some(EnvironmentMap::Cube),
        "channels" => with.channels = vec![("Y", 0.5), ("RY", 0.1), ("BY", 0.2)],
        "dataWindow" => {
            (with.size, without.size) = ((3, 1), (3, 1));
            with.own.layer_position = Vec2(1, 1);
        }
        "displayWindow" => with.window = IntegerBounds::from_dimensions((8, 4)),
        "chromaticities" => {
            with.chromaticities = Some(Chromaticities {
                red: Vec2(0.68, 0.32),
                green: Vec2(0.265, 0.69),
                blue: Vec2(0.15, 0.06),
                white: Vec2(0.3127, 0.329),
            });
        }
        "pixelAspectRatio" => with.aspect = 2.0,
        "multiView" => {
            with.own.multi_view_names = Some(vec!["left".into(), "right".into()]);
        }
        "parts" => with.parts = 2,
        "alpha" => {
            with.channels.push(("A", 0.5));
            without.channels.push(("A", 1.0));
        }
        other => panic!("no file for {other}"),
    }
    Twins {
        with: with.write(folder.join("with.exr")),
        without: without.write(folder.join("without.exr")),
    }
}
