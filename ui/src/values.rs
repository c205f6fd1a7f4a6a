//! Values of the command line: each parser says what it expected.

use std::path::PathBuf;

use clap::builder::{PossibleValuesParser, TypedValueParser};
use pickglass::cloth::Region;
use pickglass::formats::volume::VolumeFormat;
use pickglass::formats::yarns;
use pickglass::limits;
use pickglass::render::Backing;
use pickglass::scene::{PRESET_NAMES, View};

use pickglass::formats::image::{Black, Convention, Corner, ImageAs, ImageContent, Key};
use pickglass::still::{EffectBase, EffectChoice, LARGEST_SIDE, LightChoice};

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

/// One dial of one approximation, by name.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Dial {
    pub name: String,
    pub value: String,
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
    let wrong = || format!("expected WIDTHxHEIGHT in pixels, each 1 to {LARGEST_SIDE}");
    let (width, height) = text.split_once(['x', 'X', '×']).ok_or_else(wrong)?;
    let side = |part: &str| {
        part.trim()
            .parse::<u32>()
            .ok()
            .filter(|n| (1..=LARGEST_SIDE).contains(n))
            .ok_or_else(wrong)
    };
    Ok(Size {
        width: side(width)?,
        height: side(height)?,
    })
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

/// A light's name, or the path of an environment image.
pub fn light(text: &str) -> Result<LightChoice, String> {
    if PRESET_NAMES.contains(&text) {
        return Ok(LightChoice::Preset(text.to_owned()));
    }
    let path = PathBuf::from(text);
    match path.extension() {
        Some(ending) if ending.eq_ignore_ascii_case("exr") => Ok(LightChoice::Environment(path)),
        _ => Err(format!(
            "expected one of {} or a file that ends in .exr",
            PRESET_NAMES.join(", ")
        )),
    }
}

/// A view's name.
pub fn view() -> impl TypedValueParser<Value = View> {
    PossibleValuesParser::new(View::ALL.map(View::name))
        .map(|name| View::from_name(&name).unwrap_or_default())
}

/// What lies behind the cloth.
pub fn backing() -> impl TypedValueParser<Value = Backing> {
    PossibleValuesParser::new(["none", "white", "black", "self"]).map(|name| match name.as_str() {
        "white" => Backing::White,
        "black" => Backing::Black,
        "self" => Backing::Itself,
        _ => Backing::None,
    })
}

/// One of a few names, each standing for a value.
fn one_of<T: Copy + Send + Sync + 'static, const N: usize>(
    names: [(&'static str, T); N],
) -> impl TypedValueParser<Value = T> {
    PossibleValuesParser::new(names.map(|(name, _)| name)).map(move |found| {
        let known = names.iter().find(|(name, _)| *name == found);
        // The parser before has let only these names through.
        known.unwrap_or(&names[0]).1
    })
}

/// What an image is.
pub fn image_as() -> impl TypedValueParser<Value = ImageAs> {
    one_of([
        ("weave", ImageAs::Weave),
        ("artwork", ImageAs::Artwork),
        ("warp", ImageAs::Warp),
        ("weft", ImageAs::Weft),
        ("picture", ImageAs::Picture),
    ])
}

/// What an image shows.
pub fn content() -> impl TypedValueParser<Value = ImageContent> {
    one_of([
        ("weave", ImageContent::Weave),
        ("artwork", ImageContent::Artwork),
        ("warp", ImageContent::Warp),
        ("weft", ImageContent::Weft),
    ])
}

/// Which thread black stands for.
pub fn black() -> impl TypedValueParser<Value = Black> {
    one_of([("warp", Black::Warp), ("weft", Black::Weft)])
}

/// A corner of an image.
pub fn corner() -> impl TypedValueParser<Value = Corner> {
    one_of([
        ("bottom-left", Corner::BottomLeft),
        ("bottom-right", Corner::BottomRight),
        ("top-left", Corner::TopLeft),
        ("top-right", Corner::TopRight),
    ])
}

/// What tells colours apart.
pub fn key() -> impl TypedValueParser<Value = Key> {
    one_of([("rgb", Key::Rgb), ("index", Key::Index)])
}

/// A maker's habits.
pub fn convention() -> impl TypedValueParser<Value = Convention> {
    one_of(Convention::ALL.map(|convention| (convention.name(), convention)))
}

/// `dial=value`.
pub fn dial(text: &str) -> Result<Dial, String> {
    match text.split_once('=') {
        Some((name, value)) if !name.trim().is_empty() && !value.trim().is_empty() => Ok(Dial {
            name: name.trim().to_owned(),
            value: value.trim().to_owned(),
        }),
        _ => Err("expected dial=value, as rank=15".to_owned()),
    }
}

/// `auto`, `all`, `none`, then `+name` and `-name`, separated by commas.
pub fn effects(text: &str) -> Result<EffectChoice, String> {
    let wrong =
        || "expected auto, all or none, then +name or -name, separated by commas".to_owned();
    let mut choice = EffectChoice::default();
    for (place, part) in text.split(',').map(str::trim).enumerate() {
        match part {
            "auto" | "all" | "none" if place > 0 => return Err(wrong()),
            "auto" => choice.base = EffectBase::Auto,
            "all" => choice.base = EffectBase::All,
            "none" => choice.base = EffectBase::None,
            _ => {
                let (on, name) = match part.split_at_checked(1) {
                    Some(("+", name)) => (true, name),
                    Some(("-", name)) => (false, name),
                    _ => return Err(wrong()),
                };
                if name.is_empty() {
                    return Err(wrong());
                }
                choice.changes.push((name.to_owned(), on));
            }
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
    fn effects_start_with_a_base() {
        let choice = effects("none,+hairs,-sky").expect("right");
        assert_eq!(choice.base, EffectBase::None);
        assert_eq!(
            choice.changes,
            [("hairs".to_owned(), true), ("sky".to_owned(), false)]
        );
        assert_eq!(effects("-hairs").expect("right").base, EffectBase::Auto);
        for wrong in ["", "hairs", "+", "+hairs,all"] {
            assert!(effects(wrong).is_err(), "{wrong}");
        }
    }
}
