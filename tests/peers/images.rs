//! Our images in Pillow and tifffile: the same pixels as a pattern written down as text,
//! and not the same when one pixel is changed.

#![allow(clippy::unwrap_used, reason = "a test may fail")]

use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

use pickglass::design::{
    Design, Family, Fill, Grid, Region, Regions, Sett, Srgb, Structure, WeavePattern, Yarn, YarnId,
    YarnMaps,
};
use pickglass::formats::image::{Black, ImageContent};
use pickglass::formats::{SaveOptions, save};

/// The weave as it must look in the image: black = warp up, the last line is pick 1.
const WEAVE: &str = "\
##.#...#.#.
.####.....#
#...#.##..#
#.#.......#
##.......#.
";

/// Artwork as it must look, in the letters of [`COLOURS`].
const ARTWORK: &str = "\
aaabbbbccccca
abbbbbbbcccca
abdddddbbccaa
aaaaaadbbbbca
";

const COLOURS: [(char, Srgb); 4] = [
    ('a', Srgb(0x12, 0x34, 0x56)),
    ('b', Srgb(0xfe, 0xdc, 0x10)),
    ('c', Srgb(0xff, 0xff, 0xff)),
    ('d', Srgb(0x00, 0x00, 0x01)),
];

fn python() -> Option<PathBuf> {
    let named = std::env::var_os("PICKGLASS_PEERS_PYTHON").map(PathBuf::from);
    let made = Path::new(env!("CARGO_MANIFEST_DIR")).join("target/peers/bin/python");
    named.or(Some(made)).filter(|path| path.exists())
}

fn design(structure: Structure) -> Design {
    let yarns = vec![
        Yarn::new("a", Family::Cotton, Srgb(20, 30, 90)),
        Yarn::new("b", Family::Cotton, Srgb(240, 240, 235)),
    ];
    let maps = YarnMaps::plain(YarnId(0), YarnId(1));
    Design::new("peer", structure, yarns, maps, Sett::per_cm(24.0, 18.0)).unwrap()
}

fn artwork() -> Design {
    let rows: Vec<Vec<char>> = ARTWORK
        .lines()
        .rev()
        .map(|row| row.chars().collect())
        .collect();
    let map = Grid::from_fn(13, 4, |end, pick| {
        let letter = rows[pick as usize][end as usize];
        COLOURS.iter().position(|entry| entry.0 == letter).unwrap() as u16
    });
    let palette = COLOURS.iter().map(|&(letter, colour)| Region {
        locked: false,
        yarns: None,
        name: letter.into(),
        colour: Some(colour),
        fill: Fill::by_notation("plain").unwrap(),
        origin: (0, 0),
    });
    let regions = Regions::new(map.unwrap(), palette.collect(), None).unwrap();
    design(Structure::Regions(regions))
}

/// Rows of colours as the peer takes them.
fn as_colours(art: &str) -> String {
    let mut text = String::new();
    for row in art.lines() {
        for letter in row.chars() {
            let Srgb(red, green, blue) = COLOURS.iter().find(|entry| entry.0 == letter).unwrap().1;
            let _ = write!(text, "{red:02x}{green:02x}{blue:02x} ");
        }
        text.push('\n');
    }
    text
}

fn compare(
    python: &Path,
    folder: &Path,
    name: &str,
    pairs: &[(PathBuf, PathBuf)],
) -> (bool, String) {
    let list = folder.join(name);
    let mut text = String::new();
    for (image, pixels) in pairs {
        let _ = writeln!(text, "{}\t{}", image.display(), pixels.display());
    }
    std::fs::write(&list, text).unwrap();
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/peers/images.py");
    let output = Command::new(python)
        .arg(script)
        .arg("compare")
        .arg(&list)
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    println!("{said}{}", String::from_utf8_lossy(&output.stderr));
    (output.status.success(), said)
}

#[test]
fn pillow_and_tifffile_see_what_we_wrote() {
    let Some(python) = python() else {
        assert!(
            std::env::var_os("GOLDEN_REQUIRED").is_none(),
            "Pillow and tifffile are required: run tests/run.sh, or set PICKGLASS_PEERS_PYTHON"
        );
        println!(
            "not run: no Python with Pillow and tifffile; run tests/run.sh, or set \
             PICKGLASS_PEERS_PYTHON"
        );
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let weave = design(Structure::Pattern(WeavePattern::parse(WEAVE).unwrap()));
    let inverse: String = WEAVE
        .chars()
        .map(|c| match c {
            '#' => '.',
            '.' => '#',
            other => other,
        })
        .collect();
    std::fs::write(at("weave.txt"), WEAVE).unwrap();
    std::fs::write(at("inverse.txt"), inverse).unwrap();
    std::fs::write(at("artwork.txt"), as_colours(ARTWORK)).unwrap();
    std::fs::write(at("wrong weave.txt"), WEAVE.replacen("#.", "##", 1)).unwrap();
    let wrong = as_colours(ARTWORK).replacen("123456", "123457", 1);
    std::fs::write(at("wrong artwork.txt"), wrong).unwrap();

    let (mut right, mut controls) = (Vec::new(), Vec::new());
    for ending in ["png", "bmp", "tif", "gif"] {
        let files = [
            ("weave", &weave, ImageContent::Weave, Black::Warp),
            ("inverse", &weave, ImageContent::Weave, Black::Weft),
            ("artwork", &artwork(), ImageContent::Artwork, Black::Warp),
        ];
        for (name, design, content, black) in files {
            let image = at(&format!("{name}.{ending}"));
            let how = SaveOptions {
                content,
                black,
                ..SaveOptions::default()
            };
            save(design, &image, &how).unwrap();
            right.push((image.clone(), at(&format!("{name}.txt"))));
            if name != "inverse" {
                controls.push((image, at(&format!("wrong {name}.txt"))));
            }
        }
    }
    let (passed, said) = compare(&python, folder.path(), "right", &right);
    assert!(passed, "an image is read otherwise");
    // Twelve by Pillow, the three TIFFs by tifffile too; the weaves' PNG and TIFF have 1 bit.
    assert_eq!(
        said.lines().filter(|line| line.starts_with("same")).count(),
        15
    );
    assert!(
        said.lines()
            .any(|line| line.contains("\t1\t") && line.ends_with("weave.tif"))
    );
    let (passed, said) = compare(&python, folder.path(), "controls", &controls);
    assert!(!passed, "a changed pixel is not seen");
    assert!(
        said.lines().all(|line| line.starts_with("DIFFERS")),
        "{said}"
    );
}
