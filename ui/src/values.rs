//! Values of the command line: each parser says what it expected.

use std::fmt;
use std::path::PathBuf;
use std::str::FromStr;

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use pickglass::accuracy::Axis;
use pickglass::cloth::Region;
use pickglass::formats::volume::VolumeFormat;
use pickglass::formats::yarns;
use pickglass::limits;
use pickglass::plan::{self, Dial, Effect, EffectBase, EffectChoice, Settings};
use pickglass::scene::PRESET_NAMES;
use pickglass::selftest::CASES;
use strum::{EnumMessage, VariantArray};

use pickglass::engine::{Heading, LightChoice};

/// Threads per cm, along both directions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SettArg {
    pub ends_per_cm: f64,
    pub picks_per_cm: f64,
}

/// Width and height of a picture in pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Size {
    pub width: u32,
    pub height: u32,
}

/// A picture's file; the ending is known to be one that can be written.
#[derive(Debug, Clone)]
pub struct PicturePath(pub PathBuf);

/// A volume's file; the ending is known to be one that can be written.
#[derive(Debug, Clone)]
pub struct VolumePath(pub PathBuf);

/// One dial of one approximation, and a value that it takes.
#[derive(Clone)]
pub struct Turned {
    pub dial: &'static Dial,
    pub value: String,
}

impl fmt::Debug for Turned {
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(to, "{}={}", self.dial.name, self.value)
    }
}

/// `E` or `ExP`, threads per cm.
pub fn sett(text: &str) -> Result<SettArg, String> {
    let (ends, picks) = text.split_once(['x', 'X', '×']).unwrap_or((text, text));
    let threads = |part: &str| {
        part.trim()
            .parse::<f64>()
            .ok()
            .filter(|n| limits::can_be_woven(10.0 / *n as f32))
            .ok_or_else(|| {
                let range = limits::in_words(&limits::SETT_PER_CM);
                format!("expected threads per cm, {range}, as 24 or 24x20")
            })
    };
    Ok(SettArg {
        ends_per_cm: threads(ends)?,
        picks_per_cm: threads(picks)?,
    })
}

/// Threads per inch.
pub fn per_inch(text: &str) -> Result<f64, String> {
    finite(text)
        .ok()
        .filter(|n| limits::can_be_woven(25.4 / *n as f32))
        .ok_or_else(|| {
            let range = limits::in_words(&limits::sett_per_inch());
            format!("expected threads per inch, {range}")
        })
}

/// `WxH` in pixels.
pub fn size(text: &str) -> Result<Size, String> {
    let wrong = || {
        let range = limits::whole(&limits::PICTURE_SIDE);
        format!("expected WIDTHxHEIGHT in pixels, each {range}")
    };
    let (width, height) = text.split_once(['x', 'X', '×']).ok_or_else(wrong)?;
    let side = |part: &str| {
        part.trim()
            .parse::<u32>()
            .ok()
            .filter(|n| limits::PICTURE_SIDE.contains(n))
            .ok_or_else(wrong)
    };
    Ok(Size {
        width: side(width)?,
        height: side(height)?,
    })
}

/// Paths a pixel.
pub fn spp(text: &str) -> Result<u32, String> {
    let known = text.trim().parse().ok();
    known
        .filter(|spp| limits::STILL_SPP.contains(spp))
        .ok_or_else(|| format!("expected {}", limits::whole(&limits::STILL_SPP)))
}

/// A finite number.
pub fn finite(text: &str) -> Result<f64, String> {
    text.trim()
        .parse::<f64>()
        .ok()
        .filter(|n| n.is_finite())
        .ok_or_else(|| "expected a number".to_owned())
}

/// A finite number above zero.
pub fn positive(text: &str) -> Result<f64, String> {
    finite(text)
        .ok()
        .filter(|n| *n > 0.0)
        .ok_or_else(|| "expected a number above 0".to_owned())
}

/// A share above 0 and at most 1, plain or in per cent.
pub fn fraction(text: &str) -> Result<f64, String> {
    let (number, scale) = match text.trim().strip_suffix('%') {
        Some(number) => (number, 0.01),
        None => (text, 1.0),
    };
    positive(number)
        .ok()
        .map(|n| n * scale)
        .filter(|n| *n <= 1.0)
        .ok_or_else(|| "expected a share above 0 and at most 1, as 0.02 or 2%".to_owned())
}

/// What can be measured, by name.
pub fn axis(text: &str) -> Result<Axis, String> {
    Axis::named(text.trim()).map_err(|error| error.to_string())
}

/// A picture's path, `.png` or `.exr`.
pub fn picture_path(text: &str) -> Result<PicturePath, String> {
    let path = PathBuf::from(text);
    let ending = path
        .extension()
        .map(|ending| ending.to_string_lossy().to_ascii_lowercase());
    match ending.as_deref() {
        Some("png" | "exr") => Ok(PicturePath(path)),
        _ => Err("expected a file that ends in .png or .exr".to_owned()),
    }
}

/// The path of voxels or of yarns.
pub fn volume_path(text: &str) -> Result<VolumePath, String> {
    let path = PathBuf::from(text);
    if VolumeFormat::of(&path).is_some() || yarns::is_yarns(&path) {
        return Ok(VolumePath(path));
    }
    Err("expected a file that ends in .vol, .vdb, .nrrd, .mhd, .tif, .obj or .glb".to_owned())
}

/// `x,y,w,h`: first end, first pick, ends, picks.
pub fn region(text: &str) -> Result<Region, String> {
    let wrong = || "expected first end, first pick, ends and picks, as 0,0,8,8".to_owned();
    let parts: Vec<&str> = text.split(',').map(str::trim).collect();
    let [x, y, w, h] = parts[..] else {
        return Err(wrong());
    };
    let first = |part: &str| part.parse::<i64>().map_err(|_| wrong());
    let count = |part: &str| {
        part.parse::<u32>()
            .ok()
            .filter(|&n| n > 0)
            .ok_or_else(wrong)
    };
    Ok(Region {
        end: first(x)?,
        pick: first(y)?,
        ends: count(w)?,
        picks: count(h)?,
    })
}

/// `azimuth,elevation` in degrees.
pub fn heading(text: &str) -> Result<Heading, String> {
    let wrong = || {
        "expected degrees from the right counter-clockwise and above the cloth (1 to 90), as \
         135,40"
            .to_owned()
    };
    let (azimuth, elevation) = text.split_once(',').ok_or_else(wrong)?;
    let degrees = |part: &str| part.trim().parse::<i16>().map_err(|_| wrong());
    let heading = Heading {
        azimuth: degrees(azimuth)?,
        elevation: degrees(elevation)?,
    };
    let known = (1..=90).contains(&heading.elevation) && (-360..=360).contains(&heading.azimuth);
    known.then_some(heading).ok_or_else(wrong)
}

/// `x,y` in mm.
pub fn point(text: &str) -> Result<[f32; 2], String> {
    let wrong = || "expected a point of the cloth in mm, as 2.5,4".to_owned();
    let (x, y) = text.split_once(',').ok_or_else(wrong)?;
    let mm = |part: &str| finite(part).map(|mm| mm as f32).map_err(|_| wrong());
    Ok([mm(x)?, mm(y)?])
}

/// A light's name, a direction or the path of an environment image.
pub fn light(text: &str) -> Result<LightChoice, String> {
    if PRESET_NAMES.contains(&text) {
        return Ok(LightChoice::Preset(text.to_owned()));
    }
    if let Ok(heading) = heading(text) {
        return Ok(LightChoice::Sun(heading));
    }
    let path = PathBuf::from(text);
    match path.extension() {
        Some(ending) if ending.eq_ignore_ascii_case("exr") => Ok(LightChoice::Environment(path)),
        _ => Err(format!(
            "expected one of {}, a direction as 135,40, or a file that ends in .exr",
            PRESET_NAMES.join(", ")
        )),
    }
}

/// One of the names of an enum of the library; the help says what each is.
pub fn named<T>() -> impl TypedValueParser<Value = T>
where
    T: VariantArray + EnumMessage + FromStr + Copy + Into<&'static str> + Send + Sync + 'static,
{
    let values = T::VARIANTS.iter().map(|value| {
        let about = value.get_documentation().unwrap_or_default();
        let about = about.split_whitespace().collect::<Vec<_>>().join(" ");
        let name: &'static str = (*value).into();
        PossibleValue::new(name).help(about.trim_end_matches('.').to_owned())
    });
    // The parser before has let only these names through.
    PossibleValuesParser::new(values.collect::<Vec<_>>())
        .map(|name| name.parse().unwrap_or(T::VARIANTS[0]))
}

/// The name of a hard case; the help says what each tries.
pub fn hard_case() -> PossibleValuesParser {
    let values = CASES
        .iter()
        .map(|case| PossibleValue::new(case.name).help(case.about));
    PossibleValuesParser::new(values.collect::<Vec<_>>())
}

/// `dial=value`.
pub fn dial(text: &str) -> Result<Turned, String> {
    let Some((name, value)) = text.split_once('=') else {
        return Err("expected dial=value, as order=8".to_owned());
    };
    let (name, value) = (name.trim(), value.trim().to_owned());
    let dial = plan::dial(name).map_err(|error| error.to_string())?;
    let mut tried = Settings::default();
    (dial.turn(&mut tried, &value)).map_err(|error| error.to_string())?;
    Ok(Turned { dial, value })
}

/// `auto`, `all`, `none`, then `+name` and `-name`, separated by commas.
pub fn effects(text: &str) -> Result<EffectChoice, String> {
    let wrong =
        || "expected auto, all or none, then +name or -name, separated by commas".to_owned();
    let mut choice = EffectChoice::default();
    for (place, part) in text.split(',').map(str::trim).enumerate() {
        match (part.parse::<EffectBase>(), part.split_at_checked(1)) {
            (Ok(base), _) if place == 0 => choice.base = base,
            (Err(_), Some((sign @ ("+" | "-"), name))) if !name.is_empty() => {
                let effect = name.parse::<Effect>().map_err(|error| error.to_string())?;
                choice.changes.push((effect, sign == "+"));
            }
            _ => return Err(wrong()),
        }
    }
    Ok(choice)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sett_is_one_number_or_two() {
        assert_eq!(sett("24").map(|s| s.picks_per_cm), Ok(24.0));
        assert_eq!(sett("24x20.5").map(|s| s.picks_per_cm), Ok(20.5));
        for wrong in ["", "x", "24x", "-1", "nan", "inf", "0", "1e9"] {
            assert!(sett(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn size_is_bounded() {
        assert_eq!(size("8x9").map(|s| s.width * s.height), Ok(72));
        for wrong in ["8", "0x8", "8x-1", "99999x1", "x"] {
            assert!(size(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn a_region_is_four_numbers() {
        let region = region("-3, 4,5,6").expect("right");
        assert_eq!(
            (region.end, region.pick, region.ends, region.picks),
            (-3, 4, 5, 6)
        );
        for wrong in [
            "",
            "1,2,3",
            "0,0,0,1",
            "0,0,1,-1",
            "0,0,1,1,1",
            "a,0,1,1",
            "0,0,9e9,1",
        ] {
            assert!(super::region(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn an_error_may_be_in_per_cent() {
        assert_eq!(fraction("2%"), Ok(0.02));
        assert_eq!(fraction("0.02"), Ok(0.02));
        assert!(fraction("2").is_err() && fraction("0").is_err() && fraction("nan").is_err());
    }

    #[test]
    fn directions_and_points_are_two_numbers() {
        let light = light("135,40").expect("a sun");
        assert_eq!(light, LightChoice::Sun(heading("135, 40").expect("right")));
        assert_eq!(point("-2.5,4"), Ok([-2.5, 4.0]));
        for wrong in ["", "1", "1,0", "1,91", "400,5", "a,b", "nan,3"] {
            assert!(heading(wrong).is_err(), "{wrong}");
        }
        assert!(point("1").is_err() && point("nan,1").is_err());
    }

    #[test]
    fn dials_are_known_by_name_and_value() {
        let turned = dial("rank = 4").expect("right");
        assert_eq!(format!("{turned:?}"), "rank=4");
        for (wrong, says) in [
            ("rank", "expected dial=value"),
            ("rank=none", "give 0 to 1000"),
            ("glow=1", "the dials are"),
        ] {
            let error = dial(wrong).expect_err(wrong);
            assert!(error.contains(says), "{error}");
        }
    }

    #[test]
    fn effects_start_with_a_base() {
        let choice = effects("none,+hairs,-sky").expect("right");
        assert_eq!(choice.base, EffectBase::None);
        assert_eq!(
            choice.changes,
            [(Effect::Hairs, true), (Effect::Sky, false)]
        );
        assert_eq!(effects("-hairs").expect("right").base, EffectBase::Auto);
        for wrong in ["", "hairs", "+", "+hairs,all", "+glow"] {
            assert!(effects(wrong).is_err(), "{wrong}");
        }
    }
}
