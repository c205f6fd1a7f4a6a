//! The film: threads, sums, error and its interval, orders, layers in files.

use std::sync::atomic::{AtomicU32, Ordering};

use crate::render_scenes::{lone_sun, shoot, silk_satin, wool_twill};
use glam::{UVec3, Vec3};
use pickglass::film::error::DARK;
use pickglass::film::{Film, FirstHit, Picture, Pixel, Sample, Tone};
use pickglass::formats::exr;
use pickglass::formats::png::{self, Depth, Metadata};
use pickglass::job::Job;
use pickglass::random::Random;
use pickglass::render::{
    Backing, Collision, Counters, RenderSettings, Scatterer, order_histogram, render,
};
use pickglass::scene::{Bounds, Dome, LightRig, PRESET_NAMES, Ray, Sky, View};
use pickglass::volume::{DenseGrid, GridVoxel, Optics, Taps};

fn in_threads<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .expect("threads")
        .install(work)
}

#[test]
fn one_thread_and_two_give_the_same_bits_in_any_passes() {
    let scene = silk_satin(5);
    let grid = scene.grid(Taps::StochasticTrilinear);
    let camera = View::Close.camera(scene.bounds().max * 0.5, 0.4, 45, 37);
    let lights = LightRig::preset("studio").expect("a preset");
    let with = |threads, pass_spp| {
        let settings = RenderSettings {
            spp: 12,
            pass_spp,
            ..RenderSettings::default()
        };
        let outcome = in_threads(threads, || shoot(&grid, &camera, &lights, &settings));
        (outcome.film, outcome.counters)
    };
    let one = with(1, 4);
    assert!(one == with(2, 4), "threads change the picture");
    assert!(one == with(5, 1), "passes change the picture");
    // Negative control: another seed is another picture.
    let other = RenderSettings {
        spp: 12,
        seed: 1,
        ..RenderSettings::default()
    };
    assert!(one.0 != shoot(&grid, &camera, &lights, &other).film);
}

#[test]
fn sums_keep_their_digits_after_a_million_samples() {
    let mut pixel = Pixel::default();
    let first = FirstHit {
        albedo: Vec3::new(0.1, 0.7, 0.3),
        normal: Vec3::new(0.6, 0.0, 0.8),
        depth: 123.4,
        optics: 3,
    };
    let sample = Sample {
        radiance: Vec3::new(0.1, 1000.0, 1e-6),
        alpha: 0.1,
        first: Some(first),
    };
    for index in 0..1_000_000 {
        assert!(pixel.add(index, &sample));
    }
    assert_eq!(pixel.mean(), sample.radiance);
    assert_eq!(pixel.alpha(), 0.1);
    assert_eq!(pixel.albedo(), first.albedo);
    assert!((pixel.normal() - first.normal).length() < 1e-6);
    assert_eq!(pixel.depth(), first.depth);
    // Negative control: a sum in 32 bits is off by more than a half per cent.
    let short = (0..1_000_000).fold(0.0f32, |sum, _| sum + 0.1) / 1e6;
    assert!((short / 0.1 - 1.0).abs() > 5e-3, "{short}");
    assert!(pixel.variance() < 1e-12 * pixel.luminance().powi(2));
}

#[test]
fn poisoned_samples_are_left_out() {
    let mut pixel = Pixel::default();
    for value in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        let sample = Sample {
            radiance: Vec3::new(0.5, value, 0.5),
            ..Sample::default()
        };
        assert!(!pixel.add(0, &sample));
    }
    assert_eq!(pixel, Pixel::default());
    assert_eq!(pixel.mean(), Vec3::ZERO);
}

/// The interval must hold the true error about as often as it says.
#[test]
fn the_error_interval_covers_the_true_error() {
    let scene = wool_twill(4);
    let grid = scene.grid(Taps::Nearest);
    let camera = scene.face_camera(0.8, 24, 24);
    let lights = LightRig::preset("day").expect("a preset");
    let spp = 32;
    let settings = |seed, spp| RenderSettings {
        seed,
        spp,
        pass_spp: 64,
        ..RenderSettings::default()
    };
    // The truth: variance of one sample and mean, from a run 40 times as long.
    let long = shoot(&grid, &camera, &lights, &settings(1 << 40, 40 * spp)).film;
    let relative = |pixel: &Pixel| {
        let of_one = pixel.variance() * f64::from(pixel.samples());
        of_one / f64::from(spp) / (pixel.luminance().powi(2) + DARK * DARK)
    };
    let n = long.pixels().len() as f64;
    let truth = (long.pixels().iter().map(relative).sum::<f64>() / n).sqrt();
    let runs = 50;
    let mut covered = 0;
    let mut mean = 0.0;
    for seed in 0..runs {
        let estimate = shoot(&grid, &camera, &lights, &settings(seed, spp)).error;
        covered += u32::from(estimate.low <= truth && truth <= estimate.high);
        mean += estimate.error / f64::from(runs as u32);
    }
    println!("true error {truth:.5}, mean estimate {mean:.5}, covered {covered} of {runs}");
    assert!((mean / truth - 1.0).abs() < 0.05);
    assert!(covered >= 42, "covered {covered} of {runs}");
}

#[test]
fn error_and_deadline_and_cancel_stop_the_work() {
    let scene = silk_satin(4);
    let grid = scene.grid(Taps::Nearest);
    let camera = scene.face_camera(0.8, 32, 32);
    let lights = LightRig::preset("day").expect("a preset");
    let endless = RenderSettings {
        spp: u32::MAX,
        pass_spp: 8,
        ..RenderSettings::default()
    };
    let rough = RenderSettings {
        error: 0.2,
        ..endless.clone()
    };
    let outcome = shoot(&grid, &camera, &lights, &rough);
    assert!(outcome.error.error < 0.2 && outcome.spp < 10_000);

    let soon = std::time::Instant::now() + std::time::Duration::from_millis(200);
    let job = Job::new().with_deadline(soon);
    let outcome = render(&grid, &camera, &lights, &endless, &job, &mut |_, _| {});
    let outcome = outcome.expect("a deadline is no cancel");
    assert!(outcome.spp >= 1 && outcome.seconds < 5.0);

    let job = Job::new();
    let stop = job.clone();
    let outcome = render(
        &grid,
        &camera,
        &lights,
        &endless,
        &job,
        &mut |_, progress| {
            if progress.spp > 4 {
                stop.cancel();
            }
        },
    );
    assert!(outcome.is_err());
}

/// A scatterer whose owner cancels the job at its first ray, and that counts rays.
struct Impatient {
    job: Job,
    rays: AtomicU32,
}

impl Scatterer for Impatient {
    fn bounds(&self) -> Bounds {
        Bounds {
            min: Vec3::splat(-1.0),
            max: Vec3::splat(1.0),
        }
    }

    fn collide(&self, _: &Ray, _: f32, _: &mut Random, _: &mut Counters) -> Option<Collision> {
        self.job.cancel();
        self.rays.fetch_add(1, Ordering::Relaxed);
        None
    }

    fn transmittance(&self, _: &Ray, _: f32, _: f32, _: &mut Random, _: &mut Counters) -> f32 {
        1.0
    }

    fn albedo(&self, _: u32) -> Vec3 {
        Vec3::ONE
    }
}

/// A row of dense cloth takes a second: a newer picture must not wait for it.
#[test]
fn a_cancel_is_heard_within_a_pixel() {
    let job = Job::new();
    let scene = Impatient {
        job: job.clone(),
        rays: AtomicU32::new(0),
    };
    let middle = Vec3::ZERO;
    let camera = View::Face.camera(middle, 1.0, 400, 8);
    let lights = LightRig::preset("day").expect("a preset");
    let settings = RenderSettings {
        spp: 1,
        ..RenderSettings::default()
    };
    let rendered = in_threads(2, || {
        render(&scene, &camera, &lights, &settings, &job, &mut |_, _| {})
    });
    assert!(rendered.is_err());
    let rays = scene.rays.load(Ordering::Relaxed);
    assert!((1..=2).contains(&rays), "{rays} rays of 3200");
}

/// A white diffuser under every preset has luminance 1: that of the white backing over
/// its albedo.
#[test]
fn presets_expose_a_white_diffuser_to_one() {
    let bounds = Bounds {
        min: Vec3::splat(-1.0),
        max: Vec3::splat(1.0),
    };
    let optics = vec![Optics {
        albedo: Vec3::ONE,
        alpha: 1.0,
    }];
    let empty = |_| GridVoxel::EMPTY;
    let grid =
        DenseGrid::from_fn(UVec3::splat(2), bounds, optics, Taps::Nearest, empty).expect("sound");
    for preset in PRESET_NAMES {
        let lights = LightRig::preset(preset).expect("a preset");
        for view in [View::Face, View::Back] {
            let lights = lights.on(view.pose(false));
            let settings = RenderSettings {
                spp: 400,
                backing: Backing::White,
                ..RenderSettings::default()
            };
            let camera = view.camera(Vec3::ZERO, 0.5, 8, 8);
            let film = shoot(&grid, &camera, &lights, &settings).film;
            let mean = film.pixels().iter().map(Pixel::luminance).sum::<f64>() / 64.0 / 0.95;
            assert!(
                (mean - 1.0).abs() < 0.02,
                "{preset} {}: {mean}",
                view.name()
            );
        }
    }
    assert!(LightRig::preset("candle").is_err());
}

#[test]
fn backings_shine_through_and_self_is_opaque() {
    let scene = silk_satin(8);
    let grid = scene.grid(Taps::Nearest);
    let camera = scene.face_camera(0.6, 32, 32);
    let lights = LightRig::preset("overcast").expect("a preset");
    let mean = |backing| {
        let settings = RenderSettings {
            spp: 64,
            backing,
            backing_slide_mm: [0.0, 0.0],
            ..RenderSettings::default()
        };
        let film = shoot(&grid, &camera, &lights, &settings).film;
        let n = film.pixels().len() as f64;
        let light = film.pixels().iter().map(Pixel::luminance).sum::<f64>() / n;
        let alpha = film
            .pixels()
            .iter()
            .map(|p| f64::from(p.alpha()))
            .sum::<f64>()
            / n;
        (light, alpha)
    };
    let (none, alpha_none) = mean(Backing::None);
    let (black, alpha_black) = mean(Backing::Black);
    let (white, alpha_white) = mean(Backing::White);
    let (itself, alpha_itself) = mean(Backing::Itself);
    println!(
        "none {none} {alpha_none}, black {black}, white {white}, self {itself} {alpha_itself}"
    );
    assert!(alpha_none < 1.0 && alpha_black == 1.0 && alpha_white == 1.0);
    assert!(black <= none + 0.01 && black < itself && itself < white);
    assert!(alpha_itself > alpha_none);
}

/// Σ p_n ωⁿ of one run is what a run with that albedo gives.
#[test]
fn orders_predict_every_albedo() {
    let bounds = Bounds {
        min: Vec3::new(-1.0, -1.0, -0.2),
        max: Vec3::new(1.0, 1.0, 0.2),
    };
    let slab = |albedo: f32| {
        let optics = vec![Optics {
            albedo: Vec3::splat(albedo),
            alpha: 0.3,
        }];
        DenseGrid::from_fn(UVec3::new(20, 20, 4), bounds, optics, Taps::Nearest, |_| {
            GridVoxel {
                sigma: 10.0,
                direction: Vec3::Y,
                optics: 0,
            }
        })
        .expect("sound")
    };
    let lights = LightRig::preset("day").expect("a preset");
    let settings = RenderSettings {
        spp: 64,
        max_order: 200,
        roulette_order: 200,
        ..RenderSettings::default()
    };
    let camera = View::Face.camera(Vec3::ZERO, 0.1, 16, 16);
    let down = |_: &mut pickglass::random::Random| Ray {
        origin: Vec3::new(0.0, 0.0, 5.0),
        direction: Vec3::NEG_Z,
    };
    let job = Job::new();
    let white = slab(1.0);
    let orders = order_histogram(&white, &lights, &settings, 12_000, &job, &down).expect("runs");
    let one_of = |threads| {
        in_threads(threads, || {
            order_histogram(&white, &lights, &settings, 2000, &job, &down).expect("runs")
        })
    };
    assert!(one_of(1) == one_of(2), "threads change the orders");
    for albedo in [0.2, 0.6, 0.9, 0.99] {
        let film = shoot(&slab(albedo), &camera, &lights, &settings).film;
        let n = film.pixels().len() as f64;
        let mean = film.pixels().iter().map(Pixel::luminance).sum::<f64>() / n;
        let error = film
            .pixels()
            .iter()
            .map(Pixel::variance)
            .sum::<f64>()
            .sqrt()
            / n;
        let predicted = orders.luminance(f64::from(albedo));
        // The prediction is about twice as uncertain.
        let margin = 9.0 * error + 0.01 * mean;
        println!("ω {albedo}: {mean:.4} ± {error:.4}, predicted {predicted:.4}");
        assert!((mean - predicted).abs() < margin);
    }
}

fn small_film() -> (Film, f32) {
    let scene = silk_satin(5);
    let grid = scene.grid(Taps::Nearest);
    let camera = View::Oblique.camera(scene.bounds().max * 0.5, 1.2, 40, 30);
    let lights = lone_sun(Vec3::new(-1.0, 1.0, 2.0), 3.0);
    let settings = RenderSettings {
        spp: 8,
        ..RenderSettings::default()
    };
    let outcome = shoot(&grid, &camera, &lights, &settings);
    (outcome.film, camera.pixels_per_mm())
}

#[test]
fn exr_gives_back_every_layer() {
    let (film, per_mm) = small_film();
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("still.exr");
    let texts = [("designHash".to_owned(), "abc".to_owned())];
    exr::write(&path, &film, per_mm, &texts).expect("written");
    let image = ::exr::prelude::read_all_flat_layers_from_file(&path).expect("read");
    let layer = &image.layer_data[0];
    assert_eq!(layer.size.x(), 40);
    assert_eq!(layer.size.y(), 30);
    let channel = |name: &str| -> Vec<f32> {
        let list = &layer.channel_data.list;
        let found = list.iter().find(|c| c.name.to_string() == name);
        found.expect(name).sample_data.values_as_f32().collect()
    };
    let names: Vec<String> = layer
        .channel_data
        .list
        .iter()
        .map(|c| c.name.to_string())
        .collect();
    assert_eq!(names.len(), 13, "{names:?}");
    for (k, pixel) in film.pixels().iter().enumerate() {
        assert_eq!(channel_at(&channel, "R", k), pixel.mean().x);
        if k % 97 == 0 {
            assert_eq!(channel_at(&channel, "A", k), pixel.alpha());
            assert_eq!(channel_at(&channel, "albedo.G", k), pixel.albedo().y);
            assert_eq!(channel_at(&channel, "normal.Z", k), pixel.normal().z);
            assert_eq!(channel_at(&channel, "depth.Z", k), pixel.depth());
            assert_eq!(
                channel_at(&channel, "variance.Y", k),
                pixel.variance() as f32
            );
            let yarn = pixel.optics().unwrap_or(exr::NO_YARN) as f32;
            assert_eq!(channel_at(&channel, "yarn.ID", k), yarn);
        }
    }
    let other = &layer.attributes.other;
    assert_eq!(
        other.get(&::exr::meta::attribute::Text::from("pixelsPerMillimetre")),
        Some(&::exr::meta::attribute::AttributeValue::F32(per_mm))
    );
    // And as an environment.
    let environment = exr::read_environment(&path).expect("read");
    assert!(LightRig::from_image("still", environment.image).is_ok());
    std::fs::write(&path, b"nonsense").expect("written");
    assert!(exr::read_environment(&path).is_err());
    assert!(exr::read_environment(&folder.path().join("none.exr")).is_err());
}

/// Each encoding keeps its attributes in a table with an order of its own.
#[test]
fn equal_films_are_files_of_equal_bytes() {
    let (film, per_mm) = small_film();
    let texts: Vec<(String, String)> = ["Software", "Title", "Design", "Settings", "Host", "View"]
        .map(|key| (key.to_owned(), format!("of {key}")))
        .to_vec();
    let once = exr::encode(&film, per_mm, &texts).expect("encodes");
    for _ in 0..8 {
        assert!(once == exr::encode(&film, per_mm, &texts).expect("encodes"));
    }
    // Their order means nothing: the file is read as before.
    let meta = ::exr::meta::MetaData::read_from_buffered(once.as_slice(), true).expect("a header");
    let other = &meta.headers[0].own_attributes.other;
    assert_eq!(other.len(), texts.len() + 1);
    // Negative control: another text is another file.
    assert!(once != exr::encode(&film, per_mm, &texts[1..]).expect("encodes"));
}

fn channel_at(channel: &dyn Fn(&str) -> Vec<f32>, name: &str, k: usize) -> f32 {
    channel(name)[k]
}

#[test]
fn png_keeps_pixels_scale_and_text() {
    let (film, per_mm) = small_film();
    let picture = Tone::default().picture(&film);
    let metadata = Metadata {
        pixels_per_mm: Some(per_mm),
        texts: vec![
            ("Settings".to_owned(), "spp 8".to_owned()),
            ("Title".to_owned(), "тканина".to_owned()),
        ],
    };
    for depth in [Depth::Eight, Depth::Sixteen] {
        let bytes = png::encode(&picture, depth, &metadata).expect("encodes");
        let decoder = ::png::Decoder::new(std::io::Cursor::new(&bytes));
        let mut reader = decoder.read_info().expect("a header");
        let dims = reader.info().pixel_dims.expect("a scale");
        assert_eq!(dims.xppu, (per_mm * 1000.0).round() as u32);
        assert_eq!(reader.info().uncompressed_latin1_text[0].text, "spp 8");
        assert_eq!(
            reader.info().utf8_text[0].get_text().expect("text"),
            "тканина"
        );
        assert!(reader.info().srgb.is_some());
        let mut samples = vec![0; reader.output_buffer_size().expect("a size")];
        reader.next_frame(&mut samples).expect("pixels");
        for (k, pixel) in picture.pixels.iter().enumerate() {
            for c in 0..4 {
                let (value, step) = match depth {
                    Depth::Eight => (f32::from(samples[4 * k + c]) / 255.0, 1.0 / 255.0),
                    Depth::Sixteen => {
                        let at = 8 * k + 2 * c;
                        let value = u16::from_be_bytes([samples[at], samples[at + 1]]);
                        (f32::from(value) / 65535.0, 1.0 / 65535.0)
                    }
                };
                assert!((value - pixel[c]).abs() <= step);
            }
        }
    }
    let wrong = Picture {
        width: 3,
        height: 3,
        pixels: vec![[0.0; 4]; 8],
    };
    assert!(png::encode(&wrong, Depth::Eight, &Metadata::default()).is_err());
}

#[test]
fn an_environment_picture_of_a_dome_lights_like_the_dome() {
    let dome = Dome {
        zenith: Vec3::ONE,
        horizon: Vec3::splat(0.3),
        ground: Vec3::splat(0.1),
    };
    let (width, height) = (128, 64);
    let pixels = (0..width * height)
        .map(|k| {
            let u = ((k % width) as f32 + 0.5) / width as f32;
            let v = ((k / width) as f32 + 0.5) / height as f32;
            let towards = pickglass::scene::EnvironmentImage::direction(u, v);
            pickglass::scene::Environment::radiance(&dome, towards)
        })
        .collect();
    let image = pickglass::scene::EnvironmentImage::new(width, height, pixels).expect("sound");
    let scene = wool_twill(4);
    let grid = scene.grid(Taps::Nearest);
    let camera = scene.face_camera(0.7, 32, 32);
    let settings = RenderSettings {
        spp: 128,
        ..RenderSettings::default()
    };
    let light = |sky| {
        let film = shoot(
            &grid,
            &camera,
            &LightRig::new("sky", Vec::new(), sky),
            &settings,
        )
        .film;
        let n = film.pixels().len() as f64;
        let mean = film.pixels().iter().map(Pixel::luminance).sum::<f64>() / n;
        (
            mean,
            film.pixels().iter().map(Pixel::variance).sum::<f64>() / n / n,
        )
    };
    let (a, va) = light(Sky::Dome(dome));
    let (b, vb) = light(Sky::Image(image.into()));
    let error = (va + vb).sqrt();
    assert!((a - b).abs() < 5.0 * error + 0.002 * a, "{a} {b} ± {error}");
}
