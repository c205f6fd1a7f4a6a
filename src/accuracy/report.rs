//! What was measured as files: `accuracy.json` to go on from, `accuracy.md` to read, a plot of
//! each dial, and the pictures of its settings side by side.

use std::fmt::Write as _;
use std::path::Path;

use super::AccuracyError;
use super::curve::{Accuracy, Curve, Point, Trial};
use super::digits::number;
use super::measuring::Crops;
use super::plot::{self, Plot};
use crate::atomic;
use crate::film::Picture;
use crate::formats::png::{self, Depth, Metadata};

/// The file that is gone on from.
const DATA: &str = "accuracy.json";
/// The file to read.
const TEXT: &str = "accuracy.md";
/// What the plot of all dials is called.
const FRONT: &str = "together";
/// Largest file that is gone on from, bytes.
const MOST_BYTES: u64 = 1 << 24;
/// Pixels between two pictures of a strip.
const BETWEEN: usize = 4;

/// What was measured before in `folder`; `None` where there is nothing that is understood.
pub fn read(folder: &Path) -> Option<Accuracy> {
    let path = folder.join(DATA);
    let size = std::fs::metadata(&path).ok()?.len();
    let text = (size <= MOST_BYTES).then(|| std::fs::read(&path).ok())??;
    serde_json::from_slice(&text).ok()
}

/// Writes what was measured into `folder`, which is there; `crops` are the settings of the last
/// dial. Each file is whole or as it was.
///
/// # Errors
/// When one of them cannot be written.
pub fn write(folder: &Path, accuracy: &Accuracy, crops: &Crops) -> Result<(), AccuracyError> {
    let front = accuracy.front();
    if front.len() > 1 {
        plot::write(folder, FRONT, &Plot::of_front(&front, accuracy))?;
    }
    if let Some(curve) = accuracy.dials.last() {
        plot::write(folder, &curve.name, &Plot::of_curve(curve))?;
        if let Some(strip) = strip(crops) {
            let path = folder.join(strip_name(curve));
            png::write(&path, &strip, Depth::Eight, &Metadata::default())?;
        }
    }
    atomic::write(&folder.join(TEXT), markdown(accuracy).as_bytes())?;
    let data = serde_json::to_vec_pretty(accuracy).unwrap_or_default();
    atomic::write(&folder.join(DATA), &data)?;
    Ok(())
}

fn strip_name(curve: &Curve) -> String {
    format!("{}-pictures.png", curve.name)
}

/// Pictures of one size side by side; none where there are none.
fn strip(crops: &Crops) -> Option<Picture> {
    let first = crops.first()?;
    let (width, height) = (first.width as usize, first.height as usize);
    let whole = crops.len() * (width + BETWEEN) - BETWEEN;
    let mut pixels = vec![[1.0; 4]; whole * height];
    for (number, crop) in crops.iter().enumerate() {
        let left = number * (width + BETWEEN);
        for (row, from) in crop.pixels.chunks_exact(width).enumerate() {
            pixels[row * whole + left..][..width].copy_from_slice(from);
        }
    }
    Some(Picture {
        width: whole as u32,
        height: height as u32,
        pixels,
    })
}

/// What was measured as text.
pub fn markdown(accuracy: &Accuracy) -> String {
    let mut text = format!(
        "# What accuracy costs: {}\n\nThe times are of the picture `{}` on {} with {} threads, \
         once its cloth is made (those of the synthesis are of that alone): the median of several, \
         in brackets its 95 % confidence interval, of fewer than six their range. Errors are of the \
         middle {} × {} pixels, {:.3} mm wide, and their intervals of that piece. ΔE₀₀ and SSIM are \
         as seen from 30 cm, against the setting that the others are measured against; where what \
         is shown is measured, against what the traced picture converges to, whose own noise is in \
         them.\n",
        accuracy.design,
        accuracy.picture,
        accuracy.machine.system,
        accuracy.machine.threads,
        accuracy.piece[0],
        accuracy.piece[1],
        accuracy.piece_mm,
    );
    for curve in &accuracy.dials {
        section(&mut text, curve);
    }
    together(&mut text, accuracy);
    text
}

/// Rows of the front that are told.
const ROWS: usize = 12;

/// All dials together.
fn together(text: &mut String, accuracy: &Accuracy) {
    let front = accuracy.front();
    if front.len() < 2 {
        return;
    }
    let _ = write!(
        text,
        "\n## All together\n\nThe settings that no other beats in time and error, if what each \
         dial does were to add.\n\n![all together]({FRONT}.svg)\n\n\
         | time, s | error | settings |\n|--:|--:|---|\n"
    );
    let step = front.len().div_ceil(ROWS).max(1);
    let last = front.len() - 1;
    let told = front.iter().enumerate();
    for (_, choice) in told.filter(|(at, _)| at % step == 0 || *at == last) {
        let _ = writeln!(
            text,
            "| {} | {} | {} |",
            number(choice.seconds),
            number(choice.error),
            options(&choice.settings)
        );
    }
    if accuracy.trials.is_empty() {
        return;
    }
    let within = |said: f64, so: f64| (said / so).ln().abs() <= 1.25f64.ln();
    let count = |holds: &dyn Fn(&Trial) -> bool| {
        let trials = accuracy.trials.iter();
        trials.filter(|trial| holds(trial)).count()
    };
    let times = count(&|trial| within(trial.predicted_seconds, trial.seconds));
    let errors = count(&|trial| within(trial.predicted_error, trial.error));
    let _ = write!(
        text,
        "\nHow far they add, on {} settings at random that are not said to take much longer, with \
         their paths and filtering as they are: {times} times and {errors} errors are within a \
         quarter of what the curves say.\n\n| settings | time said, s | time, s | error said | error |\n\
         |---|--:|--:|--:|--:|\n",
        accuracy.trials.len()
    );
    for trial in &accuracy.trials {
        let _ = writeln!(
            text,
            "| {} | {} | {} | {} | {} |",
            options(&trial.settings),
            number(trial.predicted_seconds),
            number(trial.seconds),
            number(trial.predicted_error),
            number(trial.error),
        );
    }
}

fn options(settings: &[(String, String)]) -> String {
    let words = settings
        .iter()
        .map(|(name, value)| format!("{name}={value}"));
    words.collect::<Vec<_>>().join(" ")
}

fn section(text: &mut String, curve: &Curve) {
    let name = &curve.name;
    let knee = match &curve.knee {
        Some(knee) => format!(" After **{knee}** more time brings little."),
        None => String::new(),
    };
    let _ = write!(
        text,
        "\n## {name}\n\n{}. Error: {}, {}. Now {}, reference {}.{knee}\n\n![{name}]({name}.svg)\n\n\
         ![{name}, setting by setting]({})\n\n\
         | setting | time, s | of processors, s | error | ΔE₀₀ | SSIM | |\n\
         |---|--:|--:|--:|--:|--:|---|\n",
        curve.about,
        curve.measure.about(),
        curve.unit,
        curve.current,
        curve.reference,
        strip_name(curve),
    );
    for point in &curve.settings {
        let _ = writeln!(text, "{}", row(curve, point));
    }
}

fn row(curve: &Curve, point: &Point) -> String {
    let maybe = |value: Option<f64>, digits: usize| {
        value.map_or_else(String::new, |value| format!("{value:.digits$}"))
    };
    let between = |value: f64, [low, high]: [f64; 2]| match low < high {
        true => format!("{} ({} to {})", number(value), number(low), number(high)),
        false => number(value),
    };
    let ends = point.error_interval.unwrap_or([point.error; 2]);
    let error = between(point.error, ends);
    let paths = point.paths.map(|paths| format!("error at {paths} paths"));
    let marks = [
        (point.value == curve.current, "now"),
        (Some(&point.value) == curve.knee.as_ref(), "knee"),
        (!point.measured, "predicted"),
    ];
    let marks = marks.iter().filter(|mark| mark.0).map(|mark| mark.1);
    let marks: Vec<&str> = marks.chain(paths.as_deref()).collect();
    format!(
        "| {} | {} | {} | {error} | {} | {} | {} |",
        point.value,
        between(point.seconds, point.seconds_interval),
        point.processor_seconds.map_or_else(String::new, number),
        maybe(point.delta_e, 2),
        maybe(point.ssim, 3),
        marks.join(", "),
    )
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;
    use crate::accuracy::Estimate;
    use crate::accuracy::curve::Machine;
    use crate::plan::Measure;

    fn accuracy() -> Accuracy {
        let point = |value: &str, seconds: f64, error: f64| {
            let error = Estimate {
                value: error,
                low: 0.9 * error,
                high: 1.1 * error,
            };
            Point::new(value, Estimate::exact(seconds), error)
        };
        let mut curve = Curve {
            name: "order".to_owned(),
            about: "scatterings".to_owned(),
            measure: Measure::Bias,
            unit: "relative RMSE".to_owned(),
            reference: "64".to_owned(),
            current: "8".to_owned(),
            knee: None,
            settings: vec![
                point("1", 1.0, 0.5),
                point("8", 2.0, 0.02),
                point("64", 9.0, 0.0),
            ],
        };
        curve.settings[1].delta_e = Some(0.514);
        curve.find_knee();
        Accuracy {
            key: "k".to_owned(),
            design: "denim".to_owned(),
            picture: "--size 640x480".to_owned(),
            spp: 8,
            machine: Machine {
                system: "linux".to_owned(),
                threads: 2,
            },
            piece: [160, 120],
            piece_mm: 3.0,
            dials: vec![curve],
            trials: Vec::new(),
            chosen: Vec::new(),
        }
    }

    #[test]
    fn what_was_written_is_read_and_gone_on_from() {
        let folder = tempfile::tempdir().unwrap();
        assert_eq!(read(folder.path()), None);
        let crop = Picture {
            width: 4,
            height: 2,
            pixels: vec![[0.5; 4]; 8],
        };
        let measured = accuracy();
        write(folder.path(), &measured, &vec![crop; 3]).unwrap();
        assert_eq!(read(folder.path()), Some(measured));
        for name in [
            "accuracy.md",
            "order.svg",
            "order.png",
            "order-pictures.png",
        ] {
            assert!(folder.path().join(name).is_file(), "{name}");
        }
        let strip = image::open(folder.path().join("order-pictures.png")).unwrap();
        assert_eq!((strip.width(), strip.height()), (20, 2));
        std::fs::write(folder.path().join(DATA), "{").unwrap();
        assert_eq!(read(folder.path()), None);
    }

    #[test]
    fn the_text_says_what_it_is_of_and_marks_settings() {
        let text = markdown(&accuracy());
        assert!(
            text.contains("| 8 | 2.00 |  | 0.0200 (0.0180 to 0.0220) | 0.51 |  | now, knee |"),
            "{text}"
        );
        assert!(text.contains("`--size 640x480`") && text.contains("After **8**"));
    }
}
