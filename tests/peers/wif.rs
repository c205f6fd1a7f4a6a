//! Written WIFs in another reader, one that knows only the rules of WIF 1.1: the same
//! drawdown and the same colours, and another for a file that was changed.

#![allow(clippy::unwrap_used, reason = "a test may fail")]

use std::path::Path;
use std::process::Command;

use pickglass::design::Design;
use pickglass::formats::{LoadOptions, load, wif};
use pickglass::presets;

/// Designs of every kind: presets, and drafts of every format.
fn designs() -> Vec<(String, Design)> {
    let mut found: Vec<(String, Design)> = presets::names()
        .map(|name| (name.to_owned(), presets::design(name).unwrap().unwrap()))
        .collect();
    let fixtures = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures");
    for folder in [fixtures.clone(), fixtures.join("looms")] {
        let mut paths: Vec<_> = std::fs::read_dir(folder)
            .unwrap()
            .map(|entry| entry.unwrap().path())
            .filter(|path| path.is_file())
            .collect();
        paths.sort();
        for path in paths {
            if let Ok(imported) = load(&path, &LoadOptions::default()) {
                let name = path.file_name().unwrap().to_string_lossy();
                found.push((name.replace('.', "-"), imported.design));
            }
        }
    }
    assert!(found.len() > 30);
    found
}

/// What the other reader should say of a design, over the cloth's whole repeat.
fn expected(design: &Design) -> String {
    let (ends, picks) = design.cloth_repeat();
    let (ends, picks) = (ends as i64, picks as i64);
    let weave = design.weave();
    let mut text = String::new();
    for pick in (0..picks).rev() {
        let mark = |end| {
            if weave.get_wrapped(end, pick) {
                '#'
            } else {
                '.'
            }
        };
        text.extend((0..ends).map(mark));
        text.push('\n');
    }
    let maps = design.maps();
    let colour = |yarn| design.yarn(yarn).colour.to_string().replace('#', "");
    let warp: Vec<String> = (0..ends).map(|end| colour(maps.warp(end, 0))).collect();
    let weft: Vec<String> = (0..picks).map(|pick| colour(maps.weft(0, pick))).collect();
    text + &warp.join(" ") + "\n" + &weft.join(" ") + "\n"
}

#[test]
fn another_reader_sees_the_same_cloth() {
    let folder = tempfile::tempdir().unwrap();
    let put = |name: &str, text: &str| {
        std::fs::write(folder.path().join(name).with_extension("wif"), text).unwrap();
    };
    let designs = designs();
    for (name, design) in &designs {
        let text = wif::write(design).unwrap().text;
        put(name, &text);
        // The other shed, and another first colour (which a few drafts do not use).
        let turned = match text.contains("Rising Shed=true") {
            true => text.replace("Rising Shed=true", "Rising Shed=false"),
            false => text.replace("Rising Shed=false", "Rising Shed=true"),
        };
        put(&format!("{name}-turned"), &turned);
        let table = text.find("[COLOR TABLE]\n1=").unwrap() + "[COLOR TABLE]\n1=".len();
        let end = table + text[table..].find('\n').unwrap();
        let mut painted = text.clone();
        painted.replace_range(table..end, "1,2,3");
        put(&format!("{name}-painted"), &painted);
    }
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/peers/wif.py");
    let Ok(output) = Command::new("python3")
        .arg(script)
        .arg(folder.path())
        .output()
    else {
        let required = std::env::var("GOLDEN_REQUIRED").is_ok_and(|value| value == "1");
        assert!(!required, "python3 is required: install it");
        println!("not run: no python3");
        return;
    };
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{said}");
    let read = |name: &str| {
        let path = folder.path().join(name).with_extension("txt");
        std::fs::read_to_string(path).unwrap()
    };
    let mut painted = 0;
    for (name, design) in &designs {
        let cloth = expected(design);
        assert!(read(name) == cloth, "{name}:\n{cloth}\n{}", read(name));
        // Negative controls: the other face, and a colour that is in use.
        assert!(read(&format!("{name}-turned")) != cloth, "{name}");
        painted += usize::from(read(&format!("{name}-painted")) != cloth);
    }
    assert!(
        painted * 2 > designs.len(),
        "{painted} of {}",
        designs.len()
    );
}
