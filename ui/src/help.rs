//! What the help says after the options of a command; the man pages and `ui/docs/commands.md`
//! say it too. Its paragraphs are Markdown that reads as plain text.

use pickglass::plan::{DIALS, Effect};

/// Of all commands.
pub const PROGRAM: &str = "\
DESIGN is a .ron design, a draft, loom or image file, or a preset's name. Drafts rarely say
their sett, which decides the scale of everything: --sett says it.

Progress goes to standard error when that is a terminal. The exit status is 0, 1 (it could not
be done) or 2 (wrong usage); an error is one line with the thing, the place and the remedy. An
option that has nothing to say where it is given is refused by name. Files are replaced whole or
not at all, links are followed, and a file that a command reads is never written over.";

/// What `check --json` says.
pub const CHECK: &str = "\
What a mill checks: floats, ties, take-up, heddles, yarn needed, repeat.

With --json: ends, picks, shafts, longest_float{warp_face, warp_back, weft_face, weft_back},
seam_floats, weavable, yarns, warnings[]; longest_float_mm, heddles[], take_up{warp, weft,
balance}, yarn_per_metre[], grams_per_m2, repeat_cm, loose_layer, obstacles[], colourways[] …";

/// What `weaves --json` says.
pub const WEAVES: &str = "\
With --json: weaves[]{name, also, family, notation, ends, picks, use, drawdown, colours,
preview_only}.";

/// What `convert --json` says.
pub const CONVERT: &str = "\
What the format that is written has no place for is said, one line each.

With --json: written, lost[].";

/// What `posterize --json` says.
pub const POSTERIZE: &str = "\
Each colour becomes a weave of one warp and one weft that shows its lightness.

With --json: written, ends, picks, colours[], coverage[], expected_delta_e[], weaves[] …";

/// What `synthesize --json` says.
pub const SYNTHESIZE: &str = "\
Says how well the blocks meet; makes no picture.

With --json: crossings, seconds{…, total}, bytes, consistency{sum, max}, continuity{before,
after, max}, seam_rms{before, after}, kinks_degrees{before, after}.";

/// What `effects` says.
pub const EFFECTS: &str = "\
Says of each effect whether the picture calls for it, why, what leaving it out changes and which
share of the tracing it takes, measured on blocks of 8 × 8 pixels scattered over the picture. Left
out is only what a bound says of that it is within the tolerance; `still --tolerance` does the same.

With --json: effects[]{name, on, by, reason, bound, change, cost}, blocks, tolerance, left_out,
saved, order, seconds, options (of a still that leaves the same out).";

/// What `accuracy` writes and how it goes on.
pub const ACCURACY: &str = "\
Writes accuracy.md to read, accuracy.json, and of everything that is measured a plot (NAME.png,
NAME.svg) and the pictures of its settings side by side (NAME-pictures.png). Each setting's time
is that of the whole picture that the options ask for, once its cloth is made, or of the synthesis
where that is what is set; its error is measured on a piece of the picture. Where it is
interrupted, the same command goes on from what is there; what was measured of something else is
not written over.

With --json: dials[]{name, unit, reference, current, knee, settings[]{value, seconds,
seconds_interval, processor_seconds, error, error_interval, delta_e, ssim, measured}}, design,
picture, spp, machine{system, threads} …";

/// What becomes of a case that does not hold, and what `selftest --json` says.
pub const SELFTEST: &str = "\
Cases of designs and views are tried with every renderer. Where a case does not hold the exit
status is 1.

With --json: cases[]{name, about, ok, seen, seconds}.";

/// What a volume is, and what `volume --json` says.
pub const VOLUME: &str = "\
The bytes are said before anything is made.

With --json: voxels, bytes, files[], size, voxel_mm, origin_mm, planned{bytes, exact, seconds},
seconds; for yarns also yarns.";

/// How a still ends and what it leaves out, its dials, and what `still --json` says.
pub fn still() -> String {
    let effects = Effect::ALL.iter().map(|effect| {
        let about = effect.about().trim_end_matches('.');
        format!("* {}: {about}", effect.name())
    });
    let dials = DIALS.iter().map(|dial| {
        let (name, about, values) = (dial.name, dial.about, dial.values);
        format!("* {name}: {about}; {values}")
    });
    let [effects, dials] = [effects.collect::<Vec<_>>(), dials.collect()];
    format!(
        "\
--seconds bounds the whole command, with making the cloth, denoising and writing; where the
exemplars alone take longer, that is said and the picture gets one pass. --budget does the same, or
ends at an error, and chooses for how many scatterings light is followed: time for more paths
against light that is missing. Nothing is left out of a picture that nobody allowed: --tolerance
does. --error is the relative
error √mean(Var/(mean²+0.01²)) over the pixels, before any denoising. Ctrl-C ends a still with
the picture so far (interrupted), a second one at once.

Behind the cloth lies more of it, so that it has no pinholes; --backing says otherwise. Nothing
lies behind a volume.

A PNG's text Settings is the command line that makes it again, path for path; pictures from the
window that are not of a saved design say DESIGN in its place.

Effects:

{}

Dials for --set, each with the values that it takes from crude to reference:

{}

With --json: renderer, width, height, spp, seconds{{…, total}}, paths_per_second, error,
invalid_samples, majorant_violations, capped_walks, invalid_rays, effects[], level, light_error
(of a coarse level; null: not measured), interrupted; with --tolerance, needs{{…}} as of effects;
with --budget, promise{{seconds, error, bias, spp, order}}, or with --curves promise{{seconds, error,
bias, delta_e, spp, settings}}; with --colourway all, one sheet of every
colourway: colourways[]{{name, x, y, width, height, recoloured}}.",
        effects.join("\n"),
        dials.join("\n")
    )
}
