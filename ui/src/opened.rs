//! A design that was opened: where it came from and what was remarked on.

use std::io::Read as _;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use pickglass::design::{Design, Sett};
use pickglass::formats::image::{ImageAs, ImageContent, ImageReading};
use pickglass::formats::jc5::{Hooks, Loom};
use pickglass::formats::{self, Imported, LoadOptions, MapFiles, SaveOptions, jc5};
use pickglass::presets;

use crate::cli::{ConvertArgs, ImageArgs, SettArgs};

/// The preset that is shown when nothing is asked for.
pub const DEFAULT_PRESET: &str = "default";

/// A design with the remarks made while reading it.
#[derive(Clone)]
pub struct Opened {
    pub design: Arc<Design>,
    pub warnings: Vec<String>,
    /// The file it is from; `None` = it came with the program.
    pub path: Option<PathBuf>,
}

impl Opened {
    /// Opens a design argument, with the yarns of images where they are given. A preset's
    /// name wins; `./twill` is a file all the same.
    pub fn argument(argument: &str, sett: &SettArgs, image: &ImageArgs) -> anyhow::Result<Self> {
        let options = LoadOptions {
            sett: sett
                .sett
                .map(|sett| (sett.ends_per_cm as f32, sett.picks_per_cm as f32)),
            image: reading(image),
            face_down: image.face_down,
            ..LoadOptions::default()
        };
        let mut path = None;
        let imported = match presets::design(argument) {
            Some(design) => {
                let mut design = design?;
                if let Some((ends, picks)) = options.sett {
                    design = design.with_sett(Sett::per_cm(ends, picks))?;
                }
                Imported {
                    design,
                    warnings: Vec::new(),
                }
            }
            None if !argument.contains(['.', '/', '\\']) && !Path::new(argument).exists() => {
                return Err(no_such_preset(argument));
            }
            None => {
                path = Some(PathBuf::from(argument));
                formats::load(Path::new(argument), &options)?
            }
        };
        let files = MapFiles {
            warp: image.warp_map.clone(),
            weft: image.weft_map.clone(),
        };
        let Imported {
            design,
            mut warnings,
        } = formats::with_map_files(imported, &files, &options)?;
        for warning in warnings
            .iter_mut()
            .filter(|warning| *warning == jc5::FACE_UP)
        {
            warning.push_str(", with --face-down");
        }
        Ok(Self::new(design, warnings, path))
    }

    /// The files that a design argument and its flags name.
    pub fn inputs<'a>(argument: &'a str, image: &'a ImageArgs) -> Vec<&'a Path> {
        let design = (presets::design(argument).is_none()).then_some(Path::new(argument));
        let maps = [&image.warp_map, &image.weft_map];
        (design.into_iter())
            .chain(maps.into_iter().flatten().map(PathBuf::as_path))
            .collect()
    }

    /// Opens a preset by name.
    pub fn preset(name: &str) -> anyhow::Result<Self> {
        match presets::design(name) {
            Some(design) => Ok(Self::new(design?, Vec::new(), None)),
            None => Err(no_such_preset(name)),
        }
    }

    /// Opens a file.
    pub fn file(path: PathBuf) -> anyhow::Result<Self> {
        Self::read(path, &LoadOptions::default())
    }

    /// Opens a file of which the person knows more than it says.
    pub fn read(path: PathBuf, options: &LoadOptions) -> anyhow::Result<Self> {
        let Imported { design, warnings } = formats::load(&path, options)?;
        Ok(Self::new(design, warnings, Some(path)))
    }

    fn new(mut design: Design, mut warnings: Vec<String>, path: Option<PathBuf>) -> Self {
        warnings.extend(design.too_thick().iter().map(ToString::to_string));
        if design.name.trim().is_empty() {
            design.name = "untitled".to_owned();
        }
        Self {
            design: Arc::new(design),
            warnings,
            path,
        }
    }

    /// What the designer calls it.
    pub fn name(&self) -> &str {
        &self.design.name
    }

    /// Size of one repeat of the weave, mm.
    pub fn size_mm(&self) -> [f32; 2] {
        let (ends, picks) = (self.design.ends(), self.design.picks());
        [
            self.design.end_positions().start(i64::from(ends)) as f32,
            self.design.pick_positions().start(i64::from(picks)) as f32,
        ]
    }
}

/// How the flags say that images are read: a maker's habits, then what is said apart.
fn reading(flags: &ImageArgs) -> ImageReading {
    let habits = flags
        .convention
        .map_or_else(ImageReading::default, |maker| maker.reading());
    ImageReading {
        what: flags.what.or(habits.what),
        black: flags.black.unwrap_or(habits.black),
        corner: flags.origin.unwrap_or(habits.corner),
        mirror: flags.mirror,
        key: flags.key.unwrap_or(habits.key),
    }
}

/// How the flags of a conversion say that images are written: as they are read, unless
/// something is said apart.
pub fn writing(args: &ConvertArgs) -> SaveOptions {
    let read = reading(&args.image);
    SaveOptions {
        content: args.write.unwrap_or(match args.image.what {
            Some(ImageAs::Artwork) => ImageContent::Artwork,
            Some(ImageAs::Warp) => ImageContent::Warp,
            Some(ImageAs::Weft) => ImageContent::Weft,
            Some(ImageAs::Weave | ImageAs::Picture) | None => ImageContent::Weave,
        }),
        black: args.out_black.unwrap_or(read.black),
        corner: args
            .out_origin
            .or(args.image.origin)
            .or(args.image.convention.map(|maker| maker.reading().corner)),
        loom: loom(args),
    }
}

/// The loom that cards are written for, where one is stated.
fn loom(args: &ConvertArgs) -> Option<Loom> {
    let hooks = match (&args.loom.like, &args.loom.loom) {
        (Some(file), _) => Hooks::Like(file.clone()),
        (None, Some(name)) => Hooks::Named(name.clone()),
        (None, None) => return None,
    };
    Some(Loom {
        hooks,
        face_down: args.image.face_down,
    })
}

/// The first bytes of a file, by which its kind is known; none where it cannot be read.
pub fn head(path: &Path) -> Vec<u8> {
    let mut head = Vec::new();
    // A pipe would wait for its other end.
    if path.is_file()
        && let Ok(file) = std::fs::File::open(path)
        && file.take(64).read_to_end(&mut head).is_err()
    {
        head.clear();
    }
    head
}

fn no_such_preset(name: &str) -> anyhow::Error {
    let known: Vec<_> = presets::names().collect();
    anyhow::anyhow!(
        "{name}: no file and no preset is called this: give a design, draft, loom or image file, or one of {}",
        known.join(", ")
    )
}
