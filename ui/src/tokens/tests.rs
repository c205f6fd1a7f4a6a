//! Whether all that is to be read can be read, worked out from the tokens (WCAG 2.2, 1.4.3
//! and 1.4.11).

use egui::{Rgba, Theme};

use super::*;

/// Least contrast of text, and of what is no text.
const TEXT: f32 = 4.5;
const SIGN: f32 = 3.0;

/// Relative luminance of an opaque colour.
fn luminance(colour: Color32) -> f32 {
    let linear = Rgba::from(colour);
    0.2126 * linear.r() + 0.7152 * linear.g() + 0.0722 * linear.b()
}

fn contrast(a: Color32, b: Color32) -> f32 {
    let (a, b) = (luminance(a), luminance(b));
    (a.max(b) + 0.05) / (a.min(b) + 0.05)
}

/// A premultiplied colour laid over an opaque one, as the screen does it.
fn over(top: Color32, ground: Color32) -> Color32 {
    let left = 1.0 - f32::from(top.a()) / 255.0;
    let mix = |top: u8, ground: u8| (f32::from(top) + left * f32::from(ground)).round() as u8;
    Color32::from_rgb(
        mix(top.r(), ground.r()),
        mix(top.g(), ground.g()),
        mix(top.b(), ground.b()),
    )
}

/// Every text of the window with every ground it stands on.
fn texts(theme: Theme) -> Vec<(&'static str, Color32, Color32)> {
    let palette = Palette::of(theme);
    let visuals = visuals(theme, palette);
    let mut pairs = Vec::new();
    for (ground, plane) in [
        ("field", palette.deep),
        ("panel", palette.panel),
        ("raised", palette.raised),
    ] {
        pairs.extend([
            (ground, palette.text, plane),
            (ground, palette.quiet, plane),
            (ground, palette.warning, plane),
            (ground, palette.error, plane),
        ]);
    }
    // Keys in a menu are quiet, under the pointer and where their row is chosen too.
    pairs.extend([
        ("under the pointer", palette.text, palette.lit),
        ("under the pointer", palette.quiet, palette.lit),
        ("chosen", palette.on_chosen, palette.chosen),
        ("chosen", palette.quiet, palette.chosen),
        ("chosen tool", Color32::WHITE, ACCENT),
    ]);
    // The bar of the tabs, as egui_tiles makes it.
    let tabs = match theme {
        Theme::Dark => visuals.extreme_bg_color,
        Theme::Light => (Rgba::from(visuals.panel_fill) * Rgba::from_gray(0.8)).into(),
    };
    pairs.push(("tab", visuals.widgets.noninteractive.text_color(), tabs));
    let open = visuals.widgets.active.text_color();
    pairs.push(("open tab", open, visuals.panel_fill));
    // The number of the end or pick under the crosshair.
    let ruler = over(CROSSHAIR, palette.panel);
    pairs.push(("ruler", palette.text, ruler));
    // Buttons over the cloth fade, and the darkest and the lightest cloth shows through.
    for under in [0, 64, 119, 192, 255].map(Color32::from_gray) {
        let [text, plate] =
            [palette.text, palette.raised].map(|colour| over(colour.gamma_multiply(FADED), under));
        pairs.push(("over the cloth", text, plate));
    }
    pairs
}

/// The pairs that cannot be read.
fn unreadable<'p>(
    pairs: &'p [(&'static str, Color32, Color32)],
    least: f32,
) -> Vec<&'p (&'static str, Color32, Color32)> {
    let fails = |(_, text, ground): &&(&str, Color32, Color32)| contrast(*text, *ground) < least;
    pairs.iter().filter(fails).collect()
}

#[test]
fn contrast_is_that_of_the_recommendation() {
    let black_on_white = contrast(Color32::BLACK, Color32::WHITE);
    assert!((black_on_white - 21.0).abs() < 1e-3, "{black_on_white}");
    // The two greys either side of the limit on white that the literature names.
    assert!(contrast(Color32::from_gray(118), Color32::WHITE) >= TEXT);
    assert!(contrast(Color32::from_gray(119), Color32::WHITE) < TEXT);
    let red = contrast(Color32::from_rgb(255, 0, 0), Color32::WHITE);
    assert!((red - 3.998).abs() < 0.01, "{red}");
    let half = over(
        Color32::from_rgba_unmultiplied(255, 255, 255, 128),
        Color32::BLACK,
    );
    assert!((i32::from(half.r()) - 128).abs() <= 1, "{half:?}");
}

#[test]
fn text_can_be_read_on_every_ground_it_stands_on() {
    for theme in [Theme::Dark, Theme::Light] {
        let pairs = texts(theme);
        let failing = unreadable(&pairs, TEXT);
        assert!(failing.is_empty(), "{theme:?} {failing:?}");
    }
}

#[test]
fn text_that_cannot_be_read_is_noticed() {
    for theme in [Theme::Dark, Theme::Light] {
        let palette = Palette::of(theme);
        // Hairlines are no ground for text, and half-transparent text is none.
        let wrong = [
            ("line", palette.quiet, palette.line),
            (
                "half",
                over(palette.quiet.gamma_multiply(0.5), palette.panel),
                palette.panel,
            ),
        ];
        assert_eq!(unreadable(&wrong, TEXT).len(), wrong.len(), "{theme:?}");
    }
}

#[test]
fn marks_and_the_focus_are_seen() {
    for theme in [Theme::Dark, Theme::Light] {
        let palette = Palette::of(theme);
        assert!(contrast(palette.ink, palette.paper) >= TEXT);
        for plane in [
            palette.deep,
            palette.panel,
            palette.raised,
            palette.lit,
            palette.chosen,
        ] {
            let ratio = contrast(palette.focus, plane);
            assert!(ratio >= SIGN, "{theme:?} {plane:?} {ratio}");
        }
        // Over a picture the frame is two lines, so that one is seen on any ground.
        for ground in (0..=255).map(Color32::from_gray) {
            let seen = contrast(palette.focus, ground).max(contrast(palette.focus_edge, ground));
            assert!(seen >= SIGN, "{theme:?} {ground:?} {seen}");
        }
        // One line alone is not.
        let mut grounds = (0..=255).map(Color32::from_gray);
        assert!(grounds.any(|ground| contrast(palette.focus, ground) < SIGN));
        for plane in [palette.deep, palette.panel] {
            assert!(contrast(ACCENT, plane) >= SIGN, "{theme:?} {plane:?}");
        }
    }
}

#[test]
fn greys_are_neutral() {
    for theme in [Theme::Dark, Theme::Light] {
        let palette = Palette::of(theme);
        for grey in [
            palette.deep,
            palette.panel,
            palette.raised,
            palette.lit,
            palette.line,
            palette.text,
            palette.quiet,
            SURROUND,
        ] {
            assert!(grey.r() == grey.g() && grey.g() == grey.b());
        }
    }
}
