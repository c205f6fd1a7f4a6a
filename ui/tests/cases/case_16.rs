//! The inputs of tests/cases/16: no text of a file reaches the terminal raw.

use std::path::Path;

use crate::program::{Place, Said};

/// Signs that no line of the program holds, but the line break at its end.
fn hidden(text: &str) -> Vec<char> {
    let bidirectional = ['\u{61c}', '\u{200e}', '\u{200f}'];
    let is_hidden = |sign: &char| {
        (sign.is_control() && *sign != '\n')
            || ('\u{200b}'..='\u{200f}').contains(sign)
            || ('\u{2028}'..='\u{202e}').contains(sign)
            || ('\u{2060}'..='\u{206f}').contains(sign)
            || bidirectional.contains(sign)
            || *sign == '\u{feff}'
    };
    text.chars().filter(is_hidden).collect()
}

/// Everything that can be wrong in a text.
const EVIL: &str =
    "e\u{1b}]0;pwn\u{7}\u{1b}[2J\u{9b}31m\u{202e}\u{2066}\u{200b}\u{feff}\u{2028}\0x";

fn clean(said: &Said, what: &str) {
    for text in [&said.out, &said.err] {
        assert_eq!(hidden(text), Vec::<char>::new(), "{what}: {text:?}");
    }
}

/// Every line on standard error begins as those of the program do, and one says why.
fn refused_in_one_line(said: &Said) -> bool {
    let begins = |with: &[&str]| {
        let known = said
            .err
            .lines()
            .filter(|line| with.iter().any(|word| line.starts_with(word)));
        known.count()
    };
    said.out.is_empty()
        && begins(&["pickglass: "]) == 1
        && begins(&["pickglass: ", "warning: ", "["]) == said.err.lines().count()
}

#[test]
fn the_test_finds_what_it_looks_for() {
    for sign in EVIL.chars().filter(|sign| !sign.is_ascii_graphic()) {
        assert_eq!(hidden(&sign.to_string()), [sign]);
    }
}

#[test]
fn titles_and_field_texts_are_written_out() {
    let place = Place::of("16");
    let said = place.run(&["check", "ctl.wif"]).done();
    clean(&said, "ctl.wif");
    assert!(
        said.out.starts_with("A\\u{1b}]0;pwn\\u{7}\\u{1b}[2JB\n"),
        "{}",
        said.out
    );
    assert!(said.out.contains("Units=\\u{1b}[31mInches"), "{}", said.out);
    let said = place.run(&["check", "esc.ron"]).done();
    clean(&said, "esc.ron");
    assert!(
        said.out.contains("\\u{202e}name\\nsecond line\n"),
        "{}",
        said.out
    );
    assert!(
        said.out.contains("  y\\u{1b}[31mred\\n)</text>"),
        "{}",
        said.out
    );
}

#[test]
fn json_has_escapes_of_its_own() {
    let place = Place::of("16");
    let report = place.run(&["check", "esc.ron", "--json"]).done().json();
    let name = "evil\u{1b}]0;pwned\u{7}\u{1b}[2J\u{202e}name\nsecond line";
    assert_eq!(report["name"], name);
}

/// Writes files whose names and texts are hostile; gives the names.
fn hostile(place: &Place, evil: &str) -> Vec<String> {
    let wif = |broken: bool| {
        let units = if broken { "x" } else { "2" };
        format!(
            "[WIF]\nVersion=1.1\nSource Program={evil}\n[TEXT]\nTitle={evil}\n[WEAVING]\n\
             Shafts={units}\nTreadles=2\nRising Shed={evil}\n[WARP]\nThreads=2\nUnits={evil}\n\
             Spacing=0.1\n[WEFT]\nThreads=2\n[THREADING]\n1=1\n2=2\n{evil}\n{evil}=1\n[TIEUP]\n1=1\n\
             2=2\n[TREADLING]\n1=1\n2=2\n[{evil}]\nx={evil}\n"
        )
    };
    let quoted = evil.escape_default();
    let ron = |notation: &str| {
        format!(
            "(pickglass: 1, design: (name: \"{quoted}\", notes: \"{quoted}\", ends: 4, picks: 4, \
             structure: Weave(Notation(\"{notation}\")), yarns: [(name: \"{quoted}\", \
             colour: \"#808080\", family: \"cotton\", surface_share: 0.05)], warp: Order(\"0\"), \
             weft: Order(\"0\"), sett: (ends_per_cm: 20, picks_per_cm: 20), colourways: [(name: \
             \"{quoted}\", yarns: [(name: \"{quoted}\", colour: \"#208080\", family: \"cotton\", \
             surface_share: 0.05)])]))"
        )
    };
    let dtx =
        format!("@@StartDTX\n@@Threading\n1 2\n@@Tieup\n01\n10\n@@Treadling\n1 {evil}\n@@EndDTX\n");
    let dbw = format!("@dbw3:file\n\\data{{\n\\fields{{\n\\einzug{{\ndata==zz{evil}\n}}\n}}\n}}\n");
    let nrrd = format!("NRRD0004\ntype: {evil}\ndimension: 3\nsizes: 1 1 1\nencoding: raw\n\nx");
    let mhd =
        format!("ObjectType = Image\nNDims = 3\nDimSize = {evil}\nElementDataFile = {evil}\n");
    // Zero bytes cannot stand in the name of a file.
    let name = format!("{}\n2", evil.replace(['\0', '/'], ""));
    let files = [
        (format!("{name}.wif"), wif(false)),
        (format!("{name} broken.wif"), wif(true)),
        (format!("{name}.ron"), ron("2/2 twill")),
        (format!("{name} broken.ron"), ron(&quoted.to_string())),
        (
            format!("{name} cut.ron"),
            ron("2/2 twill")[..120].to_owned(),
        ),
        (format!("{name}.dtx"), dtx),
        (format!("{name}.dbw"), dbw),
        (format!("{name}.nrrd"), nrrd),
        (format!("{name}.mhd"), mhd),
        (format!("{name}.png"), evil.to_owned()),
        (format!("{name}.jc5"), format!("\u{81}{evil}")),
    ];
    for (name, text) in &files {
        std::fs::write(place.path(name), text).expect("written");
    }
    let mut names: Vec<String> = files.into_iter().map(|file| file.0).collect();
    names.push(format!("{name} absent.wif"));
    names
}

/// Every command over every file.
fn runs(names: &[String]) -> Vec<Vec<String>> {
    let mut all = Vec::new();
    for (number, name) in names.iter().enumerate() {
        let stem = name.rsplit_once('.').expect("an ending").0;
        let out = |ending: &str| format!("{stem} {number}.{ending}");
        let still = [
            "--size",
            "4x4",
            "--spp",
            "1",
            "--set",
            "level=4",
            "--effects",
            "none",
        ];
        let owned = |parts: &[&str]| parts.iter().map(|part| (*part).to_owned()).collect();
        let picture = out("png");
        let mut render: Vec<String> = owned(&["still", name, "-o", &picture]);
        render.extend(owned(&still));
        all.extend([
            owned(&["check", name]),
            owned(&["convert", name, &out("wif")]),
            owned(&["convert", name, &out("ron")]),
            owned(&["convert", name, &out("gif")]),
            owned(&["convert", name, &out("xyz")]),
            owned(&["convert", name, &out("jc5")]),
            owned(&["convert", name, &format!("{stem}/a.wif")]),
            owned(&[
                "posterize",
                name,
                "-o",
                &out("ron"),
                "--ends",
                "4",
                "--picks",
                "4",
            ]),
            render,
            owned(&["volume", name, "-o", &out("obj"), "--region", "0,0,1,1"]),
            owned(&["weaves", name]),
            owned(&["weaves", "--family", name]),
            owned(&[name, "--smoke-frames", "0", "--recover", name]),
        ]);
        // What the command line itself refuses quotes the argument.
        all.push(owned(&["still", "twill", "-o", name]));
        all.push(owned(&["still", name, "-o", &picture, "--colourway", stem]));
        all.push(owned(&["check", name, "--sett", stem]));
    }
    all
}

#[test]
fn every_command_writes_hidden_signs_out_a_line_a_thing() {
    let place = Place::of("16");
    let all = runs(&hostile(&place, EVIL));
    let mut spoke = 0;
    for arguments in &all {
        let list: Vec<&str> = arguments.iter().map(String::as_str).collect();
        let output = place.command(&list).env("RUST_LOG", "warn").output();
        let said = Said::of(output.expect("it starts"));
        let shown = format!("{arguments:?}");
        clean(&said, &shown);
        if said.code == Some(1) {
            assert!(refused_in_one_line(&said), "{shown}: {said:?}");
        }
        spoke += usize::from(said.out.contains("\\u{1b}") || said.err.contains("\\u{1b}"));
    }
    assert!(spoke * 2 > all.len(), "{spoke} of {}", all.len());
}

#[test]
fn synthesis_and_volumes_write_hidden_signs_out() {
    let place = Place::of("16");
    clean(&place.run(&["synthesize", "esc.ron"]).done(), "synthesize");
    let name = "v\u{1b}[2J\u{202e}.obj";
    let arguments = ["volume", "esc.ron", "-o", name, "--region", "0,0,1,1"];
    let said = place.run(&arguments).done();
    clean(&said, "volume");
    assert!(
        said.out.contains("v\\u{1b}[2J\\u{202e}.obj"),
        "{}",
        said.out
    );
    assert!(Path::new(&place.path(name)).exists());
}
