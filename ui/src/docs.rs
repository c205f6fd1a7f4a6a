//! The documents under `ui/docs/` that the program says itself, and the pictures in them. Each
//! is compared with what stands there; `PICKGLASS_DOCS=write` in the environment writes them
//! anew.

use std::fmt::Write;
use std::path::Path;

use clap::{CommandFactory, Parser};
use pickglass::limits;

use crate::cli::Cli;
use crate::command_table;

/// A picture of the gallery: its file in `tests/pictures`, what it shows, and the commands that
/// make it, of which the last is the still. `F` stands for [`FRAME`].
type Shown = (&'static str, &'static str, &'static [&'static str]);

/// What `F` stands for.
const FRAME: &str = "--size 720x480 --seconds 60 --backing none";

const GALLERY: &[Shown] = &[
    (
        "glen-check",
        "A shaft draft: glen check, worsted wool",
        &["still default -o glen-check.png F --mm 12"],
    ),
    (
        "herringbone",
        "Herringbone",
        &["still herringbone -o herringbone.png F --mm 9"],
    ),
    (
        "twills-9",
        "All twills on nine ends, 1/8 to 8/1",
        &["still twills-9 -o twills-9.png F --mm 34"],
    ),
    (
        "wavy-twill",
        "A wavy twill on 96 × 96",
        &["still wavy-twill -o wavy-twill.png F --mm 23"],
    ),
    (
        "damask-left",
        "One colour, 1/15 and 15/1 satin; light from the left",
        &["still damask -o damask-left.png F --mm 18 --light raking-left --exposure -1"],
    ),
    (
        "damask-top",
        "The same with the light turned by 90°",
        &["still damask -o damask-top.png F --mm 18 --light raking-top --exposure -1"],
    ),
    (
        "twill-satin",
        "1/7 twill against 7/1 satin, two colours",
        &["still twill-satin -o twill-satin.png F --mm 36"],
    ),
    ("denim", "Denim", &["still denim -o denim.png F --mm 10"]),
    (
        "tweed",
        "Wool tweed through a lens",
        &["still tweed -o tweed.png F --view close"],
    ),
    (
        "silk-satin",
        "Silk satin through a lens",
        &["still silk-satin -o silk-satin.png F --view close"],
    ),
    (
        "astronaut",
        "A photograph (Eileen Collins, NASA, public domain) in six weaves of one warp and one \
         weft, 960 × 1600",
        &[
            "posterize astronaut.png -o astronaut.ron --colours 6 --ends 960 --picks 1600 --epi 60 \
             --ppi 100",
            "still astronaut.ron -o cloth.png --size 480x480 --seconds 60 --backing none --mm 406",
        ],
    ),
];

/// The pictures of the window, which `tests/window/tour.py` makes.
const WINDOW: &[(&str, &str)] = &[
    (
        "window-draft",
        "A herringbone with the draft derived from it",
    ),
    (
        "window-posterise",
        "A photograph (Eileen Collins, NASA, public domain) as regions of weaves",
    ),
    (
        "window-glass",
        "The pick glass on a glen check, with the cut along the pick under it",
    ),
    (
        "window-accuracy",
        "What accuracy costs of a denim, and the dials for a budget of five seconds",
    ),
];

fn gallery() -> String {
    let mut text = format!(
        "# Gallery\n\nEach was made by the command under it, from a design that is built in; `F` \
         stands for\n`{FRAME}`.\n"
    );
    for (file, title, commands) in GALLERY {
        let _ = write!(
            text,
            "\n## {title}\n\n![{title}](../../tests/pictures/{file}.png)\n\n"
        );
        for command in *commands {
            let _ = writeln!(text, "    pickglass {command}");
        }
    }
    text += "\n# The window\n\nOn a screen of 1280 × 800; `python3 tests/window/tour.py \
             target/release/pickglass tests/pictures`\nmakes them again.\n";
    for (file, title) in WINDOW {
        let _ = write!(
            text,
            "\n## {title}\n\n![{title}](../../tests/pictures/{file}.png)\n"
        );
    }
    text
}

fn keys() -> String {
    format!(
        "# Keys\n\n`F1` shows this table in the window, `Ctrl+K` finds commands by a few letters.\n\n{}",
        command_table::markdown()
    )
}

fn commands() -> String {
    let options = clap_markdown::MarkdownOptions::new()
        .title("Commands".to_owned())
        .show_footer(false);
    let command = Cli::command().disable_help_subcommand(true);
    let text = clap_markdown::help_markdown_command_custom(&command, &options);
    text.trim_end().to_owned() + "\n"
}

fn limits() -> String {
    let mut text = String::from(
        "# Limits\n\nEvery door has the same: files, the command line and the window.\n\n\
         | of | from, to or at most |\n|---|---|\n",
    );
    for (what, limit) in limits::table() {
        let _ = writeln!(text, "| {what} | {limit} |");
    }
    text
}

/// All of them, by name.
fn all() -> [(&'static str, String); 4] {
    [
        ("gallery.md", gallery()),
        ("keys.md", keys()),
        ("commands.md", commands()),
        ("limits.md", limits()),
    ]
}

/// The first line in which a document differs from what it should say; `None` = it does not.
fn stale(stands: &str, should: &str) -> Option<String> {
    let (mut stands, mut should) = (stands.lines(), should.lines());
    for number in 1.. {
        let (here, wanted) = (stands.next(), should.next());
        if here != wanted {
            return Some(format!("line {number} says {here:?}, not {wanted:?}"));
        }
        here?;
    }
    None
}

#[test]
fn documents_say_what_the_program_does() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs");
    let writes = std::env::var_os("PICKGLASS_DOCS").is_some_and(|word| word == "write");
    for (name, should) in all() {
        let path = folder.join(name);
        if writes {
            std::fs::write(&path, &should).expect("written");
        }
        let stands = std::fs::read_to_string(&path).unwrap_or_default();
        if let Some(difference) = stale(&stands, &should) {
            panic!(
                "ui/docs/{name}: {difference}: PICKGLASS_DOCS=write cargo test --release \
                 --workspace --bin pickglass documents_say"
            );
        }
        // The control: a line more or less, or another one, is found.
        assert!(stale(&format!("{should}\nmore"), &should).is_some());
        assert!(
            stale(
                should.trim_end().rsplit_once('\n').expect("lines").0,
                &should
            )
            .is_some()
        );
        assert!(stale(&should.replacen('a', "b", 1), &should).is_some());
    }
}

#[test]
fn pictures_are_there_and_made_by_commands_that_are_understood() {
    let pictures = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/pictures");
    for (file, _, commands) in GALLERY {
        assert!(pictures.join(format!("{file}.png")).is_file(), "{file}");
        for command in *commands {
            let line = format!(
                "pickglass {}",
                command.replace(" F ", &format!(" {FRAME} "))
            );
            Cli::try_parse_from(line.split_whitespace()).expect(command);
        }
    }
    for (file, _) in WINDOW {
        assert!(pictures.join(format!("{file}.png")).is_file(), "{file}");
    }
}

#[test]
fn links_of_the_documents_point_somewhere() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let mut found = 0;
    for name in [
        "README.md",
        "CONTRIBUTING.md",
        "ui/docs/guide.md",
        "ui/docs/gallery.md",
    ] {
        let text = std::fs::read_to_string(root.join(name)).expect(name);
        let folder = root.join(name);
        for link in text.split("](").skip(1) {
            let link = link.split(')').next().unwrap_or_default();
            if link.starts_with("http") || link.starts_with('#') {
                continue;
            }
            found += 1;
            let target = folder.parent().expect("a folder").join(link);
            assert!(target.exists(), "{name}: {link} is not there");
        }
    }
    assert!(found > 20, "{found} links were looked at");
}
