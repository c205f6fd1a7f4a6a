//! The embedded designs: what each is, and that it is cloth.
//!
//! Each preset is described here once more, by formula; the embedded document must say the
//! same. With `PICKGLASS_WRITE_PRESETS=1` the documents are written anew instead.

#![allow(clippy::unwrap_used, reason = "a test may fail")]

use std::path::Path;

use pickglass::design::{
    Colourway, Design, Family, Fill, Filled, Grid, Region, Regions, Sett, Srgb, Structure, Yarn,
    YarnId, YarnMap, YarnMaps, floats,
};
use pickglass::formats::ron;
use pickglass::{atomic, presets};

fn colour(text: &str) -> Srgb {
    text.parse().unwrap()
}

fn yarn(name: &str, family: Family, hex: &str, tex: f32) -> Yarn {
    Yarn::new(name, family, colour(hex)).with_tex(tex)
}

fn woven(notation: &str) -> Structure {
    Structure::Weave(Filled::once(notation).unwrap())
}

/// Threads of each yarn in turn.
fn order(runs: &[(u16, usize)]) -> Vec<YarnId> {
    runs.iter()
        .flat_map(|&(yarn, count)| std::iter::repeat_n(YarnId(yarn), count))
        .collect()
}

fn design(
    name: &str,
    note: &str,
    structure: Structure,
    yarns: Vec<Yarn>,
    maps: YarnMaps,
    sett: (f32, f32),
) -> Design {
    let sett = Sett::per_cm(sett.0, sett.1);
    let mut design = Design::new(name, structure, yarns, maps, sett).unwrap();
    design.notes = note.to_owned();
    design
}

fn two(warp: Yarn, weft: Yarn) -> (Vec<Yarn>, YarnMaps) {
    (vec![warp, weft], YarnMaps::plain(YarnId(0), YarnId(1)))
}

fn regions(size: (u32, u32), fills: &[(&str, &str)], map: impl Fn(u32, u32) -> u16) -> Structure {
    let map = Grid::from_fn(size.0, size.1, map).unwrap();
    let palette = fills
        .iter()
        .map(|&(name, notation)| Region::new(name, Fill::by_notation(notation).unwrap()));
    Structure::Regions(Regions::new(map, palette.collect(), None).unwrap())
}

/// Glen check: houndstooth by fours beside guard checks by twos, and a blue overcheck.
fn glen_check() -> Design {
    let wool = |name, hex| yarn(name, Family::Wool, hex, 41.7);
    let yarns = vec![
        wool("charcoal", "#2b2d33"),
        wool("ecru", "#e4dac6"),
        wool("sky", "#5b8fc4"),
    ];
    let mut threads = Vec::new();
    for _ in 0..4 {
        threads.extend(order(&[(0, 4), (1, 4)]));
    }
    for _ in 0..8 {
        threads.extend(order(&[(0, 2), (1, 2)]));
    }
    // The overcheck runs through the middle of the small checks.
    threads[46..48].fill(YarnId(2));
    let maps = YarnMaps::orders(threads.clone(), threads);
    let note = "Glen check on 2/2 twill in worsted wool, with a blue overcheck.";
    design(
        "Glen check",
        note,
        woven("2/2 twill"),
        yarns,
        maps,
        (28.0, 26.0),
    )
}

fn herringbone() -> Design {
    let (yarns, maps) = two(
        yarn("black", Family::Cotton, "#1a1a1c", 29.5),
        yarn("green", Family::Cotton, "#7fae4a", 29.5),
    );
    let note = "Herringbone, after Zhao 2012, Figure 11a.";
    let weave = woven("2/2 herringbone 12");
    let colourway = |name: &str, warp: (&str, &str), weft: (&str, &str)| Colourway {
        name: name.to_owned(),
        yarns: vec![
            yarn(warp.0, Family::Cotton, warp.1, 29.5),
            yarn(weft.0, Family::Cotton, weft.1, 29.5),
        ],
    };
    let colourways = vec![
        colourway("night", ("navy", "#1d2a4d"), ("cream", "#efe6d2")),
        colourway("autumn", ("umber", "#4a2f1f"), ("rust", "#b5562b")),
        colourway("granite", ("charcoal", "#2f3133"), ("ash", "#b7b8b4")),
    ];
    design("Herringbone", note, weave, yarns, maps, (42.0, 38.0))
        .with_colourways(colourways)
        .unwrap()
}

fn twills_9() -> Design {
    let names: Vec<(String, String)> = (1..9)
        .map(|over| format!("{over}/{}", 9 - over))
        .map(|ratio| (ratio.clone(), format!("{ratio} twill")))
        .collect();
    let fills: Vec<(&str, &str)> = names
        .iter()
        .map(|(a, b)| (a.as_str(), b.as_str()))
        .collect();
    let (yarns, maps) = two(
        yarn("black", Family::Cotton, "#1a1a1c", 29.5),
        yarn("green", Family::Cotton, "#7fae4a", 29.5),
    );
    let weave = regions((8 * 36, 144), &fills, |end, _| (end / 36) as u16);
    let note = "All twills on nine ends side by side, after Zhao 2012, Figure 11b.";
    design(
        "Twills on nine ends",
        note,
        weave,
        yarns,
        maps,
        (42.0, 38.0),
    )
}

fn wavy_twill() -> Design {
    let (yarns, maps) = two(
        yarn("petrol", Family::Cotton, "#12505c", 29.5),
        yarn("sand", Family::Cotton, "#e0c9a0", 29.5),
    );
    let note = "Wavy twill of 96 by 96, after Zhao 2012, Figure 13a.";
    let weave = woven("wavy 4/4 twill 96");
    design("Wavy twill", note, weave, yarns, maps, (42.0, 38.0))
}

fn damask() -> Design {
    let (yarns, maps) = two(
        yarn("warp", Family::Silk, "#c9b78e", 9.3),
        yarn("weft", Family::Silk, "#c9b78e", 9.3),
    );
    let fills = [("weft satin", "1/15 satin"), ("warp satin", "15/1 satin")];
    let weave = regions((192, 192), &fills, |end, pick| {
        u16::from((end / 96) == (pick / 96))
    });
    let note = "Blocks of 1/15 and 15/1 satin in one colour, after Zhao 2012, Figure 13b.";
    design("Damask", note, weave, yarns, maps, (80.0, 72.0))
}

/// Ogee and palmette: which side of the figure's outlines a point is on. Coordinates are
/// −1..1 across and along one half-dropped figure.
fn in_figure(x: f32, y: f32) -> bool {
    use std::f32::consts::PI;
    // The ogee: two mirrored curves from tip to tip, a band with an inner line.
    let half_width = 0.5 + 0.36 * (PI * y).cos() - 0.06 * (2.0 * PI * y).cos();
    let from_edge = half_width - x.abs();
    let band = from_edge.abs() < 0.055 || (from_edge - 0.13).abs() < 0.018;
    // The palmette: petals round a centre a little below the middle, drawn out upwards.
    let (u, v) = (1.25 * x, 0.82 * (y + 0.08));
    let radius = u.hypot(v);
    let angle = u.atan2(v);
    let petals = 0.33 + 0.11 * (7.0 * angle).cos().abs().sqrt() + 0.07 * angle.cos();
    let veins = (7.0 * angle).sin().abs() < 0.16 && radius > 0.16 && radius < petals - 0.05;
    let ring = (radius - 0.125).abs() < 0.022;
    let flower = radius < petals && !veins && !ring;
    // Two leaves at the foot, and a bud on the tip.
    let leaf = |side: f32| {
        let (u, v) = (side * x - 0.19, y + 0.58);
        let along = (u * 0.55 + v * 0.84) / 0.2;
        let across = (u * 0.84 - v * 0.55) / 0.065;
        along * along + across * across < 1.0 && across.abs() > 0.12
    };
    let bud = (x / 0.07).powi(2) + ((y - 0.66) / 0.13).powi(2) < 1.0;
    let stem = x.abs() < 0.022 && (-0.8..-0.4).contains(&y);
    band || flower || leaf(1.0) || leaf(-1.0) || bud || stem
}

fn twill_satin() -> Design {
    let size = (320u32, 512u32);
    let (yarns, maps) = two(
        yarn("red", Family::Silk, "#8e1b2a", 9.3),
        yarn("gold", Family::Silk, "#d9a63a", 12.0),
    );
    let fills = [("ground", "7/1 satin move 3"), ("figure", "1/7 twill")];
    let weave = regions(size, &fills, |end, pick| {
        // Centre of the crossing, in −1..1 of the figure it is in; figures in the second
        // rank stand half a repeat further both ways.
        let x = (end as f32 + 0.5) / size.0 as f32 * 2.0 - 1.0;
        let y = (pick as f32 + 0.5) / size.1 as f32 * 2.0 - 1.0;
        let second = |value: f32| {
            if value < 0.0 {
                value + 1.0
            } else {
                value - 1.0
            }
        };
        u16::from(in_figure(x, y) || in_figure(second(x), second(y)))
    });
    let note = "Ogees of 1/7 twill on 7/1 satin in two colours, after Zhao 2012, Figure 13c.";
    design("Twill and satin", note, weave, yarns, maps, (80.0, 64.0))
}

fn denim() -> Design {
    let (yarns, maps) = two(
        yarn("indigo", Family::Cotton, "#26385f", 84.0),
        yarn("white", Family::Cotton, "#eceae2", 84.0),
    );
    let note = "Right-hand denim: indigo warp over three white picks.";
    design("Denim", note, woven("3/1 twill"), yarns, maps, (26.0, 21.0))
}

fn tweed() -> Design {
    let wool = |name, hex| yarn(name, Family::Wool, hex, 130.0);
    let yarns = vec![
        wool("peat", "#4a3a2c"),
        wool("heather", "#7a5f6e"),
        wool("oatmeal", "#cdbfa2"),
        wool("moss", "#6b6a3c"),
    ];
    let warp = order(&[(0, 6), (1, 1), (0, 5), (3, 2), (0, 6), (2, 1), (0, 3)]);
    let weft = order(&[(2, 7), (3, 1), (2, 4), (1, 1), (2, 3)]);
    let maps = YarnMaps::orders(warp, weft);
    let note = "Woollen tweed on 2/2 herringbone, peat warp and oatmeal weft with flecks.";
    let weave = woven("2/2 herringbone 12");
    design("Tweed", note, weave, yarns, maps, (15.0, 14.0))
}

fn linen_plain() -> Design {
    let (yarns, maps) = two(
        yarn("flax", Family::Linen, "#c9bb9c", 38.5),
        yarn("half-bleached", Family::Linen, "#dfd6c2", 38.5),
    );
    let note = "Plain linen.";
    design("Linen", note, woven("plain"), yarns, maps, (33.0, 32.0))
}

fn silk_satin() -> Design {
    let (yarns, maps) = two(
        yarn("warp", Family::Silk, "#3d6f8e", 9.3),
        yarn("weft", Family::Silk, "#3d6f8e", 9.3),
    );
    let note = "Warp satin of eight ends.";
    let weave = woven("7/1 satin move 3");
    design("Silk satin", note, weave, yarns, maps, (90.0, 70.0))
}

fn oxford() -> Design {
    let (yarns, maps) = two(
        yarn("blue", Family::Cotton, "#5f86b8", 14.8),
        yarn("white", Family::Cotton, "#f2f1ec", 24.6),
    );
    let note = "Oxford shirting: fine ends in pairs over single heavier picks.";
    let weave = woven("2/2 weft rib");
    design("Oxford", note, weave, yarns, maps, (56.0, 40.0))
}

fn recipe(name: &str) -> Design {
    match name {
        "default" => glen_check(),
        "herringbone" => herringbone(),
        "twills-9" => twills_9(),
        "wavy-twill" => wavy_twill(),
        "damask" => damask(),
        "twill-satin" => twill_satin(),
        "denim" => denim(),
        "tweed" => tweed(),
        "linen-plain" => linen_plain(),
        "silk-satin" => silk_satin(),
        "oxford" => oxford(),
        other => panic!("no recipe for {other}"),
    }
}

#[test]
fn embedded_designs_are_what_their_recipes_say() {
    let write = std::env::var("PICKGLASS_WRITE_PRESETS").is_ok_and(|value| value == "1");
    for name in presets::names() {
        let expected = recipe(name);
        if write {
            let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("presets/designs");
            let text = ron::write(&expected).unwrap();
            assert!(text.len() < 40_000, "{name} has {} bytes", text.len());
            atomic::write(&folder.join(format!("{name}.ron")), text.as_bytes()).unwrap();
            continue;
        }
        let embedded = presets::design(name).unwrap().unwrap();
        assert!(embedded == expected, "{name} differs: write it anew");
    }
    assert!(presets::design("no such design").is_none());
}

/// Diameter over pitch of every yarn, in both directions.
fn covers(design: &Design) -> Vec<f32> {
    let maps = design.maps();
    let side = |map: &YarnMap, pitch: f32| {
        let order = map.order().unwrap().to_vec();
        order
            .into_iter()
            .map(move |id| design.yarn(id).diameter() / pitch)
            .collect::<Vec<_>>()
    };
    let mut all = side(&maps.warp, design.sett().end_pitch_mm());
    all.extend(side(&maps.weft, design.sett().pick_pitch_mm()));
    all
}

#[test]
fn embedded_designs_are_cloth_and_not_baskets() {
    for name in presets::names() {
        let design = presets::design(name).unwrap().unwrap();
        assert!(design.weavable(), "{name}");
        for cover in covers(&design) {
            assert!((0.7..=1.0).contains(&cover), "{name}: cover {cover}");
        }
        let found = floats(&design.weave());
        assert!(found.unbound_ends.is_empty() && found.unbound_picks.is_empty());
        // No float that would snag: 5 mm.
        let longest = found.longest;
        let ends = longest.weft_face.max(longest.weft_back) as f32;
        let picks = longest.warp_face.max(longest.warp_back) as f32;
        assert!(ends * design.sett().end_pitch_mm() < 5.0, "{name}");
        assert!(picks * design.sett().pick_pitch_mm() < 5.0, "{name}");
    }
    // A thin yarn at the same sett is not cloth: the measure can fail.
    let denim = presets::design("denim").unwrap().unwrap();
    let thin = vec![yarn("thin", Family::Cotton, "#000000", 10.0); 2];
    let thin = denim
        .clone()
        .with_yarns(thin, denim.maps().clone())
        .unwrap();
    assert!(covers(&thin).iter().all(|&cover| cover < 0.7));
}

#[test]
fn the_damask_shows_warp_and_weft_in_equal_blocks() {
    let weave = presets::design("damask").unwrap().unwrap().weave();
    let up = weave.count_warp_up();
    assert_eq!(up, 192 * 192 / 2);
    assert!(weave.get(40, 41) != weave.get(140, 41) || weave.get(40, 42) != weave.get(140, 42));
}
