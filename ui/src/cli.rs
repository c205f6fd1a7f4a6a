//! The grammar of the command line. Others script it, so it only ever grows.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueHint};
use clap_complete::Shell;
use pickglass::design::{Family, Srgb};
use pickglass::exemplar::COARSEST_LEVEL;
use pickglass::render::{Backing, RenderSettings};
use pickglass::scene::{PRESET_NAMES, View};

use crate::help;
use crate::opened::DEFAULT_PRESET;
use crate::values::{self, PicturePath, SettArg, Size, Turned, VolumePath};
use crate::window::Restarts;
use pickglass::accuracy::{Axis, Effort};
use pickglass::cloth::Region;
use pickglass::engine::{Heading, LightChoice, RENDERERS};
use pickglass::formats::image::{Black, Convention, Corner, ImageAs, ImageContent, Key};
use pickglass::formats::{self, Format};
use pickglass::plan::{Budget, EffectChoice};
use pickglass::posterise::Fit;
use pickglass::synthesis::{Method, Seams};
use pickglass::text::shell_word;

/// Look closely at cloth that has not been woven yet.
#[derive(Debug, Parser)]
#[command(name = "pickglass", version, args_conflicts_with_subcommands = true, after_help = help::PROGRAM)]
pub struct Cli {
    #[command(subcommand)]
    pub command: Option<Command>,
    #[command(flatten)]
    pub window: WindowArgs,
}

/// What `pickglass` does when it is not given a command: opens the window.
#[derive(Debug, Args)]
pub struct WindowArgs {
    /// A design (.ron), a draft, loom or image file, or a preset's name
    #[arg(value_hint = ValueHint::FilePath)]
    pub design: Option<String>,
    #[command(flatten)]
    pub sett: SettArgs,
    #[command(flatten)]
    pub image: ImageArgs,
    /// Print one JSON object on standard output
    #[arg(long)]
    pub json: bool,
    /// Close the window after this many frames
    #[arg(long, hide = true, value_name = "N")]
    pub smoke_frames: Option<u32>,
    /// Lose the graphics device after this many frames
    #[arg(long, hide = true, value_name = "N")]
    pub smoke_lose_device: Option<u32>,
    /// Open this recovery copy
    #[arg(long, hide = true, value_name = "COPY", conflicts_with = "design")]
    pub recover: Option<PathBuf>,
    /// When the program started itself again, in seconds since 1970
    #[arg(long, hide = true, value_name = "SECONDS,…")]
    pub restarted: Option<Restarts>,
}

#[derive(Debug, Subcommand)]
pub enum Command {
    /// Floats, warnings and scale of a design
    Check(CheckArgs),
    /// Convert between draft, design and image formats
    Convert(ConvertArgs),
    /// Reduce a picture to a few colours and weave each of them
    Posterize(Box<PosterizeArgs>),
    /// Assign exemplar blocks and fix their edges; no picture
    Synthesize(SynthesizeArgs),
    /// Render a picture of the cloth
    Still(Box<StillArgs>),
    /// Say which effects a picture calls for, what each changes and what it costs
    Effects(Box<EffectsArgs>),
    /// Measure what each setting of each dial costs in time and how wrong it is
    Accuracy(Box<AccuracyArgs>),
    /// Try hard cases on this machine: does everything hold here as well?
    Selftest(SelftestArgs),
    /// The weave library: names, repeats and what they are for
    Weaves(WeavesArgs),
    /// Write a window of the cloth as voxels, or its yarns as geometry
    Volume(Box<VolumeArgs>),
    /// Print what a shell needs to complete command lines
    Completions(CompletionsArgs),
    /// Write man pages, one of each command
    Man(ManArgs),
}

#[derive(Debug, Args)]
pub struct CompletionsArgs {
    /// The shell
    pub shell: Shell,
}

#[derive(Debug, Args)]
pub struct ManArgs {
    /// The folder to write them into; made if it is not there
    pub folder: PathBuf,
}

#[derive(Debug, Args)]
#[command(after_help = help::WEAVES)]
pub struct WeavesArgs {
    /// A weave's name: draws its repeat; without it, lists all
    pub name: Option<String>,
    /// List only one family
    #[arg(long, value_name = "FAMILY", conflicts_with = "name")]
    pub family: Option<String>,
    /// Print one JSON object on standard output
    #[arg(long)]
    pub json: bool,
}

#[derive(Debug, Args)]
#[command(after_help = help::SELFTEST)]
pub struct SelftestArgs {
    /// Only these cases
    #[arg(value_name = "CASE", value_parser = values::hard_case())]
    pub cases: Vec<String>,
    /// Print one JSON object on standard output
    #[arg(long)]
    pub json: bool,
}

#[derive(Debug, Args)]
pub struct SettArgs {
    /// Ends per cm, and picks per cm where they differ
    #[arg(long, value_name = "E[xP]", value_parser = values::sett)]
    pub sett: Option<SettArg>,
}

/// How images and loom files are read, and which images say where the yarns lie.
#[derive(Debug, Args)]
#[command(next_help_heading = "Images and loom files")]
pub struct ImageArgs {
    /// What an image is [default: as its colours suggest]
    #[arg(long = "as", value_name = "KIND", value_parser = values::named::<ImageAs>())]
    pub what: Option<ImageAs>,
    /// Presets by maker: tc2, pointcarre and arahweave
    #[arg(long, value_name = "MAKER", value_parser = values::named::<Convention>())]
    pub convention: Option<Convention>,
    /// Which thread a black pixel puts on the face [default: warp]
    #[arg(long, value_name = "THREAD", value_parser = values::named::<Black>())]
    pub black: Option<Black>,
    /// The corner in which end 1 and pick 1 meet [default: bottom-left]
    #[arg(long, value_name = "CORNER", value_parser = values::named::<Corner>())]
    pub origin: Option<Corner>,
    /// Exchange left and right: Z becomes S
    #[arg(long)]
    pub mirror: bool,
    /// Tell regions and yarns apart by colour or by palette index [default: rgb]
    #[arg(long, value_name = "KEY", value_parser = values::named::<Key>())]
    pub key: Option<Key>,
    /// An image with the warp yarn of every crossing
    #[arg(long, value_name = "IMAGE")]
    pub warp_map: Option<PathBuf>,
    /// An image with the weft yarn of every crossing
    #[arg(long, value_name = "IMAGE")]
    pub weft_map: Option<PathBuf>,
    /// Loom files read or written are of cloth woven face down
    #[arg(long)]
    pub face_down: bool,
}

/// What is looked at and how it is read, as words of a command line.
pub fn source_words(argument: &str, sett: &SettArgs, image: &ImageArgs) -> Vec<String> {
    let mut words = vec![shell_word(argument).into_owned()];
    words.extend(sett.words());
    words.extend(image.words());
    words
}

impl SettArgs {
    /// The words that say the same.
    fn words(&self) -> Vec<String> {
        let sett = self.sett.iter();
        sett.map(|sett| format!("--sett {}x{}", sett.ends_per_cm, sett.picks_per_cm))
            .collect()
    }
}

impl ImageArgs {
    /// The words that say the same.
    fn words(&self) -> Vec<String> {
        fn word<T: Into<&'static str>>(flag: &str, value: Option<T>) -> Option<String> {
            value.map(|value| format!("{flag} {}", value.into()))
        }
        let file = |flag: &str, path: &Option<PathBuf>| {
            let path = path.as_ref()?.display().to_string();
            Some(format!("{flag} {}", shell_word(&path)))
        };
        let switch = |flag: &str, on: bool| on.then(|| flag.to_owned());
        let words = [
            word("--as", self.what),
            word("--convention", self.convention),
            word("--black", self.black),
            word("--origin", self.origin),
            switch("--mirror", self.mirror),
            word("--key", self.key),
            file("--warp-map", &self.warp_map),
            file("--weft-map", &self.weft_map),
            switch("--face-down", self.face_down),
        ];
        words.into_iter().flatten().collect()
    }
}

#[derive(Debug, Args)]
#[command(after_help = help::CHECK)]
pub struct CheckArgs {
    /// A design (.ron), a draft, loom or image file, or a preset's name
    #[arg(value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub design: String,
    #[command(flatten)]
    pub sett: SettArgs,
    #[command(flatten)]
    pub image: ImageArgs,
    /// Print one JSON object on standard output
    #[arg(long)]
    pub json: bool,
}

#[derive(Debug, Args)]
#[command(after_help = help::CONVERT)]
pub struct ConvertArgs {
    /// A design (.ron), a draft, loom or image file, or a preset's name
    #[arg(value_name = "IN", value_hint = ValueHint::FilePath)]
    pub input: String,
    #[arg(value_name = "OUT", help = written())]
    pub output: PathBuf,
    /// What an image that is written shows [default: as --as says, else the weave]
    #[arg(long, value_name = "KIND", value_parser = values::named::<ImageContent>())]
    pub write: Option<ImageContent>,
    /// Which thread black stands for in what is written [default: as --black says]
    #[arg(long, value_name = "THREAD", value_parser = values::named::<Black>())]
    pub out_black: Option<Black>,
    /// Where what is written starts to count [default: as --origin says]
    #[arg(long, value_name = "CORNER", value_parser = values::named::<Corner>())]
    pub out_origin: Option<Corner>,
    #[command(flatten)]
    pub sett: SettArgs,
    #[command(flatten)]
    pub loom: LoomArgs,
    #[command(flatten)]
    pub image: ImageArgs,
    /// Print one JSON object on standard output
    #[arg(long)]
    pub json: bool,
}

/// The loom that a .jc5 is for.
#[derive(Debug, Args)]
pub struct LoomArgs {
    /// Write into the hooks of this file of the loom (.jc5)
    #[arg(long, value_name = "TEMPLATE", conflicts_with = "loom")]
    pub like: Option<PathBuf>,
    /// Write for the hooks of a loom: a name, or a .ron file as in presets/looms
    #[arg(long, value_name = "PRESET")]
    pub loom: Option<String>,
}

#[derive(Debug, Args)]
#[command(after_help = help::POSTERIZE)]
pub struct PosterizeArgs {
    /// A picture: PNG, JPEG, BMP, TIFF or WebP
    pub image: PathBuf,
    /// The design to write (.ron)
    #[arg(short, long, value_name = "DESIGN")]
    pub output: PathBuf,
    /// Colours to reduce to
    #[arg(long, value_name = "N", default_value_t = 8, value_parser = clap::value_parser!(u16).range(2..=256))]
    pub colours: u16,
    /// Ends of the panel [default: from the picks and the picture, or 960]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub ends: Option<u32>,
    /// Picks of the panel [default: from the ends and the picture]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub picks: Option<u32>,
    /// Ends per inch
    #[arg(long, value_name = "N", default_value_t = 60.0, value_parser = values::per_inch)]
    pub epi: f64,
    /// Picks per inch [default: as the ends]
    #[arg(long, value_name = "N", value_parser = values::per_inch)]
    pub ppi: Option<f64>,
    /// How the picture is brought to the panel's shape
    #[arg(long, default_value_t = Fit::Crop, value_parser = values::named::<Fit>())]
    pub fit: Fit,
    /// Dither between the colours
    #[arg(long)]
    pub dither: bool,
    /// Merge patches of fewer crossings into their neighbours [default: 6, or 0 if dithered]
    #[arg(long, value_name = "N")]
    pub speck: Option<u32>,
    /// Bind floats between regions that are longer than this, in crossings
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(2..))]
    pub bind: Option<u32>,
    /// Give every region yarns of its own colour, which no loom can do
    #[arg(long)]
    pub preview_only: bool,
    /// What the yarns are made of
    #[arg(long, value_name = "FAMILY", default_value = "silk")]
    pub family: Family,
    /// Colour of the warp, as #rrggbb [default: chosen from the picture]
    #[arg(long, value_name = "COLOUR", requires = "weft")]
    pub warp: Option<Srgb>,
    /// Colour of the weft, as #rrggbb
    #[arg(long, value_name = "COLOUR", requires = "warp")]
    pub weft: Option<Srgb>,
    /// A design posterised before, whose yarns, weaves and corrections stay
    #[arg(long, value_name = "DESIGN")]
    pub keep: Option<PathBuf>,
    /// Print one JSON object on standard output
    #[arg(long)]
    pub json: bool,
}

#[derive(Debug, Args)]
#[command(after_help = help::SYNTHESIZE)]
pub struct SynthesizeArgs {
    /// A design (.ron), a draft, loom or image file, or a preset's name
    #[arg(value_hint = ValueHint::FilePath)]
    pub design: String,
    /// How blocks are assigned to crossings
    #[arg(long, default_value_t = Method::Dp, value_parser = values::named::<Method>())]
    pub method: Method,
    /// What is brought together at seams
    #[arg(long, default_value_t = Seams::default(), value_parser = values::named::<Seams>())]
    pub seams: Seams,
    /// How finely a membrane closes seams; 0 leaves all of them open
    #[arg(long, value_name = "R", default_value_t = 15)]
    pub rank: u32,
    /// Seed of the patch shifts
    #[arg(long, value_name = "S", default_value_t = 0)]
    pub seed: u64,
    #[command(flatten)]
    pub sett: SettArgs,
    #[command(flatten)]
    pub image: ImageArgs,
    /// Print one JSON object on standard output
    #[arg(long)]
    pub json: bool,
}

/// The formats that are written, for the help.
fn written() -> String {
    let endings = formats::endings_in_words(Format::is_written, " or ");
    format!("The file to write; its ending chooses the format ({endings})")
}

/// The engines that there are, for the help.
fn renderers() -> String {
    let rows = RENDERERS.iter();
    let rows = rows.map(|row| format!("{} ({})", row.name, row.about));
    let rows: Vec<String> = rows.collect();
    format!("What draws the picture: auto, {}", rows.join(", "))
}

/// What picture is taken.
#[derive(Debug, Args)]
pub struct PictureArgs {
    /// Width and height in pixels
    #[arg(long, value_name = "WxH", default_value = "1280x720", value_parser = values::size)]
    pub size: Size,
    #[arg(long, value_name = "N", help = format!("Paths per pixel [default: {}]", RenderSettings::default().spp), value_parser = values::spp)]
    pub spp: Option<u32>,
    /// Where the eye is
    #[arg(long, default_value = "face", value_parser = values::named::<View>())]
    pub view: View,
    /// The eye's own direction over that side, degrees from the right and above the cloth
    #[arg(long, value_name = "AZIMUTH,ELEVATION", allow_hyphen_values = true, value_parser = values::heading)]
    pub eye: Option<Heading>,
    /// Turn the cloth by 180° as it lies: end 1 at the right, pick 1 at the top
    #[arg(long)]
    pub turned: bool,
    /// The point of the cloth in the picture's middle, in mm [default: the design's middle]
    #[arg(long, value_name = "X,Y", allow_hyphen_values = true, value_parser = values::point)]
    pub centre: Option<[f32; 2]>,
    /// Width of cloth the picture shows, in mm [default: the view's own]
    #[arg(long, value_name = "WIDTH", value_parser = values::positive)]
    pub mm: Option<f64>,
    /// A light's name, the direction of a sun as 135,40, or an equirectangular environment
    /// (.exr)
    #[arg(long, value_name = "PRESET|DIRECTION|EXR", default_value = PRESET_NAMES[0], value_parser = values::light)]
    pub light: LightChoice,
    /// Exposure in stops
    #[arg(long, value_name = "EV", default_value_t = 0.0, allow_negative_numbers = true, value_parser = values::finite)]
    pub exposure: f64,
    /// What lies behind the cloth [default: self; none behind a volume]
    #[arg(long, value_parser = values::named::<Backing>())]
    pub backing: Option<Backing>,
    #[arg(long, value_name = "NAME", default_value = "auto", help = renderers())]
    pub renderer: String,
    /// auto, all or none, then +name and -name, separated by commas
    #[arg(long, value_name = "auto|all|none|±name", default_value = "auto", allow_hyphen_values = true, value_parser = values::effects)]
    pub effects: EffectChoice,
    /// Seed of the patch shifts and of the paths
    #[arg(long, value_name = "S", default_value_t = 0)]
    pub seed: u64,
    /// Set one dial of one approximation, e.g. order=8; may be repeated
    #[arg(long = "set", value_name = "dial=value", value_parser = values::dial)]
    pub dials: Vec<Turned>,
}

#[derive(Debug, Args)]
#[command(after_help = help::still())]
#[group(id = "stop", multiple = false, args = ["spp", "seconds", "error", "budget"])]
pub struct StillArgs {
    /// A design (.ron), a draft, loom or image file, a preset's name or a volume (.vol, .nrrd,
    /// .nhdr, .mhd, .mha)
    #[arg(value_hint = ValueHint::FilePath)]
    pub design: String,
    /// The picture to write, .png or .exr
    #[arg(short, long, value_name = "OUT", value_parser = values::picture_path)]
    pub output: PicturePath,
    #[command(flatten)]
    pub picture: PictureArgs,
    /// End after this long, with all that it takes
    #[arg(long, value_name = "S", value_parser = values::positive)]
    pub seconds: Option<f64>,
    /// Refine until the relative error is this small, e.g. 0.02 or 2%
    #[arg(long, value_name = "E", value_parser = values::fraction)]
    pub error: Option<f64>,
    /// Choose how often light is scattered by so many seconds or so little error, as 20s or
    /// 2%, and say beforehand what the picture will come to
    #[arg(long, value_name = "TIME|ERROR", conflicts_with = "tolerance")]
    pub budget: Option<Budget>,
    /// Choose all dials by what accuracy measured there of this picture, as ΔE too (dE1); spp
    /// and dials of the picture are as they were measured
    #[arg(long, value_name = "FOLDER", requires = "budget", value_hint = ValueHint::DirPath)]
    pub curves: Option<PathBuf>,
    /// Leave out what changes 95 of 100 blocks of pixels by less, all of it together, as 1%
    #[arg(long, value_name = "T", value_parser = values::fraction)]
    pub tolerance: Option<f64>,
    /// Edge of a voxel along x, in mm, of a volume whose file does not say it or says it wrong
    #[arg(long, value_name = "MM", value_parser = values::positive)]
    pub voxel: Option<f64>,
    /// A colourway of the design, or all of them side by side ("all", .png; --size is each)
    #[arg(long, value_name = "C")]
    pub colourway: Option<String>,
    #[command(flatten)]
    pub sett: SettArgs,
    #[command(flatten)]
    pub image: ImageArgs,
    /// Print one JSON object on standard output
    #[arg(long)]
    pub json: bool,
}

#[derive(Debug, Args)]
#[command(after_help = help::EFFECTS)]
pub struct EffectsArgs {
    /// A design (.ron), a draft, loom or image file, or a preset's name
    #[arg(value_hint = ValueHint::FilePath, default_value = DEFAULT_PRESET)]
    pub design: String,
    /// Leave out what changes 95 of 100 blocks of pixels by less, all of it together
    #[arg(long, value_name = "T", default_value = "1%", value_parser = values::fraction)]
    pub tolerance: f64,
    #[command(flatten)]
    pub picture: PictureArgs,
    /// A colourway of the design
    #[arg(long, value_name = "C")]
    pub colourway: Option<String>,
    #[command(flatten)]
    pub sett: SettArgs,
    #[command(flatten)]
    pub image: ImageArgs,
    /// Print one JSON object on standard output
    #[arg(long)]
    pub json: bool,
}

#[derive(Debug, Args)]
#[command(after_help = help::ACCURACY)]
pub struct AccuracyArgs {
    /// A design (.ron), a draft, loom or image file, or a preset's name
    #[arg(value_hint = ValueHint::FilePath, default_value = DEFAULT_PRESET)]
    pub design: String,
    /// The folder to write into, and to go on from; made if it is not there
    #[arg(short, long, value_name = "FOLDER", value_hint = ValueHint::DirPath)]
    pub output: PathBuf,
    /// What is measured, by name and separated by commas [default: what matters most to this
    /// design]
    #[arg(long, value_name = "NAME,…", value_delimiter = ',', value_parser = values::axis)]
    pub dials: Vec<Axis>,
    /// How much is measured
    #[arg(long, default_value_t = Effort::Default, value_parser = values::named::<Effort>())]
    pub extent: Effort,
    #[command(flatten)]
    pub picture: PictureArgs,
    /// A colourway of the design
    #[arg(long, value_name = "C")]
    pub colourway: Option<String>,
    #[command(flatten)]
    pub sett: SettArgs,
    #[command(flatten)]
    pub image: ImageArgs,
    /// Print one JSON object on standard output
    #[arg(long)]
    pub json: bool,
}

#[derive(Debug, Args)]
#[command(after_help = help::VOLUME)]
pub struct VolumeArgs {
    /// A design (.ron), a draft (.wif) or a preset's name
    #[arg(value_hint = ValueHint::FilePath)]
    pub design: String,
    /// The file to write: voxels as .vol, .vdb, .nrrd, .mhd or .tif, yarns as .obj or .glb
    #[arg(short, long, value_name = "OUT", value_parser = values::volume_path)]
    pub output: VolumePath,
    /// First end, first pick, ends and picks [default: one repeat]
    #[arg(long, value_name = "x,y,w,h", allow_hyphen_values = true, value_parser = values::region)]
    pub region: Option<Region>,
    /// Voxels along a crossing's shorter side [default: as fine as the cloth's own]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1024))]
    pub voxels_per_crossing: Option<u32>,
    /// Voxel level of the cloth: each halves the resolution
    #[arg(long, value_name = "L", default_value_t = 0, value_parser = clap::value_parser!(u32).range(0..=i64::from(COARSEST_LEVEL)))]
    pub level: u32,
    /// Only what lies above the mid plane
    #[arg(long)]
    pub face: bool,
    /// Where the eye is in the scene beside a .vol
    #[arg(long, default_value = "face", value_parser = values::named::<View>())]
    pub view: View,
    /// The light of that scene: a name, or an equirectangular environment (.exr)
    #[arg(long, value_name = "PRESET|EXR", default_value = PRESET_NAMES[0], value_parser = values::light)]
    pub light: LightChoice,
    /// Seed of the patch shifts
    #[arg(long, value_name = "S", default_value_t = 0)]
    pub seed: u64,
    #[command(flatten)]
    pub sett: SettArgs,
    #[command(flatten)]
    pub image: ImageArgs,
    /// Print one JSON object on standard output
    #[arg(long)]
    pub json: bool,
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_grammar_is_sound() {
        Cli::command().debug_assert();
    }

    #[test]
    fn a_still_takes_every_flag() {
        let line = "pickglass still twill -o a.png --size 64x32 --seconds 2 --view back --mm 5 \
                    --light sun --exposure -1 --backing black --renderer cpu --effects none,+hairs \
                    --seed 3 --set rank=4 --sett 24x20 --eye 90,30 --turned --centre -1,2 --json";
        let cli = Cli::try_parse_from(line.split_whitespace()).expect("a right command line");
        let Some(Command::Still(still)) = cli.command else {
            panic!("not a still")
        };
        assert_eq!(
            (still.picture.size.width, still.picture.size.height),
            (64, 32)
        );
        assert_eq!(still.sett.sett.map(|s| s.picks_per_cm), Some(20.0));
        assert_eq!(still.picture.dials.len(), 1);
    }

    #[test]
    fn posterizing_takes_every_flag_and_refuses_what_cannot_be() {
        let parse = |line: &str| Cli::try_parse_from(line.split_whitespace());
        let line = "pickglass posterize a.png -o a.ron --colours 6 --ends 960 --picks 1600 \
                    --epi 60 --ppi 100 --fit pad --dither --speck 4 --bind 9 --preview-only \
                    --family silk --warp #102030 --weft #f0e0d0 --keep b.ron --json";
        let cli = parse(line).expect("a right command line");
        let Some(Command::Posterize(args)) = cli.command else {
            panic!("not posterize")
        };
        assert_eq!(
            (args.colours, args.ends, args.ppi),
            (6, Some(960), Some(100.0))
        );
        assert_eq!(args.warp, Some(Srgb(0x10, 0x20, 0x30)));
        for wrong in [
            "--colours 1",
            "--colours 257",
            "--ends 0",
            "--epi nan",
            "--epi 0",
            "--fit bend",
            "--warp #102030",
            "--family hemp",
        ] {
            let line = format!("pickglass posterize a.png -o a.ron {wrong}");
            assert_eq!(parse(&line).expect_err(wrong).exit_code(), 2);
        }
    }

    #[test]
    fn a_volume_takes_every_flag() {
        let line = "pickglass volume twill -o a.vdb --region -2,3,4,5 --voxels-per-crossing 16 \
                    --level 1 --face --view oblique --light sun --seed 3 --sett 24 --json";
        let cli = Cli::try_parse_from(line.split_whitespace()).expect("a right command line");
        let Some(Command::Volume(volume)) = cli.command else {
            panic!("not a volume")
        };
        assert_eq!(volume.region.map(|region| region.end), Some(-2));
        assert_eq!((volume.voxels_per_crossing, volume.level), (Some(16), 1));
        for wrong in [
            "-o a.xyz",
            "-o a.vol --region 0,0,0,1",
            "-o a.vol --voxels-per-crossing 0",
            "-o a.vol --level 5",
        ] {
            let line = format!("pickglass volume twill {wrong}");
            let error = Cli::try_parse_from(line.split_whitespace()).expect_err("wrong usage");
            assert_eq!(error.exit_code(), 2, "{wrong}");
        }
    }

    #[test]
    fn a_program_that_starts_itself_again_is_understood() {
        let line = "pickglass --restarted 1763800000,1763800007 --recover /r/a.recovery";
        let cli = Cli::try_parse_from(line.split_whitespace()).expect("a right command line");
        let restarts = cli.window.restarted.expect("times");
        assert_eq!(restarts.to_string(), "1763800000,1763800007");
        for wrong in ["--restarted now", "--recover /r/a.recovery twill"] {
            let line = format!("pickglass {wrong}");
            let error = Cli::try_parse_from(line.split_whitespace()).expect_err("wrong usage");
            assert_eq!(error.exit_code(), 2, "{wrong}");
        }
    }

    #[test]
    fn two_ways_to_stop_are_wrong_usage() {
        let line = "pickglass still twill -o a.png --spp 4 --seconds 2";
        let error = Cli::try_parse_from(line.split_whitespace()).expect_err("exclusive");
        assert_eq!(error.exit_code(), 2);
    }
}
