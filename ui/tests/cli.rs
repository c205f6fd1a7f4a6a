//! The program from outside: results, exit codes and the one line of an error.

use std::path::Path;
use std::process::{Command, Output, Stdio};

fn pickglass(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_pickglass"))
        .args(arguments)
        .current_dir(folder)
        .env_remove("DISPLAY")
        .env_remove("WAYLAND_DISPLAY")
        .env_remove("WAYLAND_SOCKET")
        .env_remove("RUST_LOG")
        .output()
        .expect("the program starts")
}

fn json(output: &Output) -> serde_json::Value {
    let text = String::from_utf8_lossy(&output.stdout);
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    assert_eq!(text.trim_end().lines().count(), 1, "one object: {text}");
    serde_json::from_str(&text).expect("an object")
}

fn has_keys(value: &serde_json::Value, keys: &[&str]) {
    for key in keys {
        let pointer = format!("/{}", key.replace('.', "/"));
        assert!(value.pointer(&pointer).is_some(), "no {key} in {value}");
    }
}

/// The error's one line.
fn refused(output: &Output, code: i32) -> String {
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(code), "{text}");
    assert!(output.stdout.is_empty(), "nothing on standard output");
    text
}

#[test]
fn check_has_the_keys_that_scripts_rely_on() {
    let folder = tempfile::tempdir().expect("a folder");
    let report = json(&pickglass(
        folder.path(),
        &["check", "silk-satin", "--json"],
    ));
    has_keys(
        &report,
        &[
            "ends",
            "picks",
            "shafts",
            "longest_float.warp_face",
            "longest_float.warp_back",
            "longest_float.weft_face",
            "longest_float.weft_back",
            "seam_floats",
            "weavable",
            "yarns",
            "warnings",
        ],
    );
    assert_eq!(report["longest_float"]["warp_face"], 7);
}

#[test]
fn check_says_what_a_mill_asks() {
    let folder = tempfile::tempdir().expect("a folder");
    let report = json(&pickglass(folder.path(), &["check", "denim", "--json"]));
    has_keys(
        &report,
        &[
            "heddles",
            "lifts",
            "longest_float_mm.warp_face",
            "longest_float_inside.weft_back",
            "unbound_ends",
            "unbound_picks",
            "loose_layer",
            "take_up.warp.mean",
            "take_up.weft.jammed",
            "take_up.balance",
            "obstacles",
            "yarn_per_metre",
            "grams_per_m2",
            "repeat_cm",
            "cloth_repeat_cm",
            "colourways",
        ],
    );
    assert_eq!(report["heddles"], serde_json::json!([1, 1, 1, 1]));
    assert_eq!(report["weavable"], true);
    // Four picks at 21 per cm.
    let height = report["repeat_cm"][1].as_f64().expect("a number");
    assert!((height - 4.0 / 21.0).abs() < 1e-5);
    let text = pickglass(folder.path(), &["check", "denim"]);
    let text = String::from_utf8_lossy(&text.stdout).into_owned();
    for word in ["take-up", "heddles", "g/m²", "a loom can weave it"] {
        assert!(text.contains(word), "no {word} in {text}");
    }
}

#[test]
fn hard_cases_are_tried_by_name() {
    let folder = tempfile::tempdir().expect("a folder");
    let two = ["selftest", "threads", "rays-that-are-none"];
    let said = pickglass(folder.path(), &two);
    assert!(said.status.success(), "{said:?}");
    let said = String::from_utf8_lossy(&said.stdout).into_owned();
    assert_eq!(
        said.lines().filter(|line| line.starts_with("ok ")).count(),
        2
    );
    assert!(said.contains("2 of 2 hold"), "{said}");
    let report = json(&pickglass(
        folder.path(),
        &["selftest", "threads", "--json"],
    ));
    has_keys(
        &report,
        &[
            "cases.0.name",
            "cases.0.about",
            "cases.0.ok",
            "cases.0.seen",
            "cases.0.seconds",
        ],
    );
    assert_eq!(report["cases"].as_array().expect("cases").len(), 1);
    assert_eq!(report["cases"][0]["ok"], true);
    let text = refused(&pickglass(folder.path(), &["selftest", "glow"]), 2);
    assert!(text.contains("glow"), "{text}");
}

#[test]
fn the_weave_library_is_listed_and_drawn() {
    let folder = tempfile::tempdir().expect("a folder");
    let all = json(&pickglass(folder.path(), &["weaves", "--json"]));
    let weaves = all["weaves"].as_array().expect("a list");
    assert!(weaves.len() >= 60);
    let family = json(&pickglass(
        folder.path(),
        &["weaves", "--family", "crepe", "--json"],
    ));
    let some = family["weaves"].as_array().expect("a list");
    assert!(!some.is_empty() && some.len() < weaves.len());
    let one = json(&pickglass(
        folder.path(),
        &["weaves", "houndstooth", "--json"],
    ));
    has_keys(
        &one["weaves"][0],
        &[
            "name",
            "family",
            "notation",
            "ends",
            "picks",
            "use",
            "drawdown",
            "colours.warp",
        ],
    );
    assert_eq!(one["weaves"][0]["colours"]["warp"], "DDDDLLLL");
    let drawn = pickglass(folder.path(), &["weaves", "3/1 broken twill"]);
    let drawn = String::from_utf8_lossy(&drawn.stdout).into_owned();
    assert!(drawn.ends_with("###.\n.###\n##.#\n#.##\n"), "{drawn}");
    refused(&pickglass(folder.path(), &["weaves", "tweedledum"]), 1);
    let text = refused(&pickglass(folder.path(), &["weaves", "--family", "x"]), 1);
    assert!(
        text.contains("honeycomb") || text.contains("texture"),
        "{text}"
    );
}

#[test]
fn colourways_are_chosen_by_name_or_shown_together() {
    let folder = tempfile::tempdir().expect("a folder");
    let still = |extra: &[&str]| {
        let mut line = vec!["still", "herringbone", "--size", "20x12", "--spp", "1"];
        line.extend_from_slice(extra);
        pickglass(folder.path(), &line)
    };
    let one = json(&still(&["-o", "a.png", "--colourway", "night", "--json"]));
    assert_eq!(one["width"], 20);
    let sheet = json(&still(&["-o", "b.png", "--colourway", "all", "--json"]));
    let places = sheet["colourways"].as_array().expect("a list");
    assert_eq!(places.len(), 4);
    assert_eq!(places[1]["name"], "night");
    assert_eq!(places[1]["recoloured"], true);
    let picture = image::open(folder.path().join("b.png")).expect("a picture");
    assert_eq!(
        u64::from(picture.width()),
        sheet["width"].as_u64().expect("a number")
    );
    let unknown = refused(&still(&["-o", "c.png", "--colourway", "spring"]), 1);
    assert!(unknown.contains("night, autumn, granite"), "{unknown}");
    refused(&still(&["-o", "c.exr", "--colourway", "all"]), 1);
}

#[test]
fn the_sett_decides_the_scale() {
    let folder = tempfile::tempdir().expect("a folder");
    let report = json(&pickglass(
        folder.path(),
        &["check", "oxford", "--sett", "20x10", "--json"],
    ));
    assert!((report["width_mm"].as_f64().expect("a number") - 2.0).abs() < 1e-4);
    assert!((report["height_mm"].as_f64().expect("a number") - 2.0).abs() < 1e-4);
    assert_eq!(report["sett_assumed"], false);
}

#[test]
fn synthesize_has_the_keys_that_scripts_rely_on() {
    let folder = tempfile::tempdir().expect("a folder");
    let report = json(&pickglass(
        folder.path(),
        &["synthesize", "oxford", "--json"],
    ));
    has_keys(
        &report,
        &[
            "crossings",
            "seconds.total",
            "bytes",
            "consistency.sum",
            "consistency.max",
            "continuity.before",
            "continuity.after",
            "continuity.max",
            "seam_rms.before",
            "seam_rms.after",
        ],
    );
}

#[test]
fn a_still_is_written_and_reported() {
    let folder = tempfile::tempdir().expect("a folder");
    let line = [
        "still", "oxford", "-o", "a.png", "--size", "40x24", "--spp", "2", "--json",
    ];
    let report = json(&pickglass(folder.path(), &line));
    has_keys(
        &report,
        &[
            "renderer",
            "width",
            "height",
            "spp",
            "seconds.total",
            "paths_per_second",
            "error",
            "invalid_samples",
            "majorant_violations",
            "capped_walks",
            "invalid_rays",
            "effects",
            "level",
            "light_error",
        ],
    );
    assert_eq!(report["spp"], 2);
    let picture = image::open(folder.path().join("a.png")).expect("a picture");
    assert_eq!((picture.width(), picture.height()), (40, 24));
    let names: Vec<_> = std::fs::read_dir(folder.path())
        .expect("a folder")
        .collect();
    assert_eq!(names.len(), 1, "nothing but the picture: {names:?}");
}

#[test]
fn a_coarse_still_says_how_far_its_light_is_off() {
    let folder = tempfile::tempdir().expect("a folder");
    let still = |level: &str, more: &[&str]| {
        let level = format!("level={level}");
        let line = ["still", "oxford", "-o", "a.png", "--size", "16x16"];
        let rest = ["--spp", "1", "--set", &level];
        pickglass(folder.path(), &[&line[..], &rest, more].concat())
    };
    let said = |level| String::from_utf8_lossy(&still(level, &[]).stdout).into_owned();
    assert!(said("3").contains(", level 3: light ±"), "{}", said("3"));
    assert!(!said("0").contains("level"), "{}", said("0"));
    let report = json(&still("3", &["--json"]));
    let error = report["light_error"].as_f64().expect("measured");
    assert!(report["level"] == 3 && (0.001..0.03).contains(&error));
}

#[test]
fn a_loom_file_is_written_for_a_loom_and_read_again() {
    let folder = tempfile::tempdir().expect("a folder");
    let run = |line: &[&str]| pickglass(folder.path(), line);
    let loom = ["convert", "silk-satin", "a.jc5", "--loom", "staubli-5120"];
    let report = json(&run(&[&loom[..], &["--json"]].concat()));
    has_keys(&report, &["written", "lost"]);
    let first = std::fs::read(folder.path().join("a.jc5")).expect("a file");
    let check = json(&run(&["check", "a.jc5", "--json"]));
    assert_eq!(check["ends"], 4800);
    assert_eq!(check["shafts"], 8);
    // Its own hooks, unchanged: the same bytes.
    json(&run(&[
        "convert", "a.jc5", "b.jc5", "--like", "a.jc5", "--json",
    ]));
    let again = std::fs::read(folder.path().join("b.jc5")).expect("a file");
    assert!(first == again);
    json(&run(&[
        &loom[..2],
        &["c.jc5", "--like", "a.jc5", "--face-down", "--json"],
    ]
    .concat()));
    let down = std::fs::read(folder.path().join("c.jc5")).expect("a file");
    assert!(down.len() == first.len() && down != first);
    for line in [
        &["convert", "silk-satin", "d.jc5"][..],
        &["convert", "silk-satin", "d.jc5", "--loom", "nobody"],
        &["convert", "silk-satin", "d.jc5", "--like", "absent.jc5"],
        &["convert", "silk-satin", "d.wif", "--like", "a.jc5"],
    ] {
        let text = refused(&run(line), 1);
        assert_eq!(text.trim_end().lines().count(), 1, "{line:?}: {text}");
        assert!(text.matches([':', ';']).count() >= 2, "{text}");
    }
    let both = ["convert", "x", "d.jc5", "--like", "a.jc5", "--loom", "b"];
    refused(&run(&both), 2);
}

#[test]
fn a_weave_goes_out_as_an_image_and_back() {
    let folder = tempfile::tempdir().expect("a folder");
    let run = |arguments: &[&str]| json(&pickglass(folder.path(), arguments));
    let floats = |file: &str| run(&["check", file, "--json"])["longest_float"].clone();
    let own = floats("wavy-twill");
    for file in ["a.png", "a.bmp", "a.tif", "a.gif", "a.wif", "a.ron"] {
        let report = run(&["convert", "wavy-twill", file, "--json"]);
        has_keys(&report, &["written", "lost"]);
        let lost = report["lost"].as_array().expect("a list");
        assert_eq!(lost.is_empty(), file.ends_with("ron"), "{file}: {lost:?}");
        assert_eq!(floats(file), own, "{file}");
    }
    // Black for the weft and read for the warp: face and back change places.
    run(&[
        "convert",
        "twill-satin",
        "b.tif",
        "--out-black",
        "weft",
        "--json",
    ]);
    let (face, turned) = (floats("twill-satin"), floats("b.tif"));
    assert_eq!(face["warp_face"], turned["weft_face"]);
    let told = run(&["check", "b.tif", "--black", "weft", "--json"]);
    assert_eq!(told["longest_float"], face);
}

#[test]
fn artwork_and_yarn_images_make_one_design() {
    let folder = tempfile::tempdir().expect("a folder");
    let run = |arguments: &[&str]| json(&pickglass(folder.path(), arguments));
    for (side, file) in [
        ("warp", "warp.bmp"),
        ("weft", "weft.tif"),
        ("weave", "weave.png"),
    ] {
        run(&["convert", "tweed", file, "--write", side, "--json"]);
    }
    let line = [
        "convert",
        "weave.png",
        "all.ron",
        "--warp-map",
        "warp.bmp",
        "--weft-map",
        "weft.tif",
        "--json",
    ];
    run(&line);
    let (all, weave) = (
        run(&["check", "all.ron", "--json"]),
        run(&["check", "weave.png", "--json"]),
    );
    assert_eq!(all["longest_float"], weave["longest_float"]);
    assert_eq!(all["weavable"], true);
    let line = ["convert", "denim", "x.ron", "--warp-map", "warp.bmp"];
    let text = refused(&pickglass(folder.path(), &line), 1);
    assert!(
        text.contains("warp.bmp") && text.contains("the size of"),
        "{text}"
    );
}

#[test]
fn errors_are_one_line_and_exit_1() {
    let folder = tempfile::tempdir().expect("a folder");
    for line in [
        &["check", "absent.wif"][..],
        &["still", "oxford", "-o", "absent/a.png"],
        &["still", "oxford", "-o", "a.png", "--renderer", "gpu"],
        &["still", "oxford", "-o", "a.png", "--renderer", "lumislice"],
        &["still", "oxford", "-o", "a.png", "--colourway", "autumn"],
        &["still", "oxford", "-o", "a.png", "--colourway", "all"],
        &["convert", "oxford", "out.unknown"],
    ] {
        let text = refused(&pickglass(folder.path(), line), 1);
        assert_eq!(text.trim_end().lines().count(), 1, "{line:?}: {text}");
        assert!(text.starts_with("pickglass: "), "{text}");
        assert!(
            text.matches([':', ';']).count() >= 2,
            "thing, place, remedy: {text}"
        );
    }
}

#[test]
fn work_that_no_window_can_show_is_named_and_left_alone() {
    let folder = tempfile::tempdir().expect("a folder");
    let copy = folder.path().join("design-1.recovery");
    std::fs::write(&copy, "work").expect("written");
    let output = pickglass(folder.path(), &["--recover", "design-1.recovery"]);
    let line = refused(&output, 1);
    assert!(
        line.contains("design-1.recovery") && line.contains("no display"),
        "{line}"
    );
    assert_eq!(line.trim_end().lines().count(), 1, "{line}");
    assert_eq!(std::fs::read(&copy).expect("read"), b"work");
    assert!(!folder.path().join("cloth.png").exists());
}

#[test]
fn wrong_usage_exits_2() {
    let folder = tempfile::tempdir().expect("a folder");
    for line in [
        &["still", "oxford"][..],
        &["still", "oxford", "-o", "a.jpg"],
        &["still", "oxford", "-o", "a.png", "--size", "0x1"],
        &["still", "oxford", "-o", "a.png", "--spp", "0"],
        &[
            "still",
            "oxford",
            "-o",
            "a.png",
            "--spp",
            "1",
            "--seconds",
            "1",
        ],
        &["still", "oxford", "-o", "a.png", "--view", "above"],
        &["still", "oxford", "-o", "a.png", "--light", "candle"],
        &["still", "oxford", "-o", "a.png", "--set", "level=9"],
        &["still", "oxford", "-o", "a.png", "--set", "glow=1"],
        &["still", "oxford", "-o", "a.png", "--effects", "+glow"],
        &["still", "oxford", "-o", "a.png", "--eye", "90,0"],
        &["check", "oxford", "--sett", "zero"],
        &["check", "oxford", "--as", "painting"],
        &["check", "oxford", "--origin", "middle"],
        &["check"],
        &["check", "oxford", "--unknown"],
    ] {
        refused(&pickglass(folder.path(), line), 2);
    }
}

#[test]
fn accuracy_is_measured_into_a_folder_and_gone_on_from() {
    let folder = tempfile::tempdir().expect("a folder");
    let measured = |dials: &str, more: &[&str]| {
        let line = ["accuracy", "oxford", "-o", "made/here", "--dials", dials];
        let small = ["--size", "24x16", "--spp", "2", "--extent", "quick"];
        pickglass(folder.path(), &[&line[..], &small, more].concat())
    };
    let names = |report: &serde_json::Value| -> Vec<String> {
        let dials = report["dials"].as_array().expect("dials");
        dials
            .iter()
            .map(|dial| dial["name"].as_str().expect("a name").to_owned())
            .collect()
    };
    let first = json(&measured("pass-spp,method", &["--json"]));
    assert_eq!(names(&first), ["pass-spp", "method"]);
    has_keys(
        &first,
        &[
            "design",
            "picture",
            "machine.threads",
            "dials.0.unit",
            "dials.0.reference",
            "dials.0.current",
            "dials.0.settings.0.value",
            "dials.0.settings.0.seconds",
            "dials.0.settings.0.seconds_interval",
            "dials.0.settings.0.error",
            "dials.0.settings.0.error_interval",
        ],
    );
    let at = |name: &str| folder.path().join("made/here").join(name);
    let written = ["accuracy.json", "accuracy.md", "method.svg", "method.png"];
    for name in written.iter().chain(&["method-pictures.png"]) {
        assert!(at(name).is_file(), "{name}");
    }
    // What is there is not measured again: its times are the same to the last digit.
    let more = json(&measured("method,png-bits", &["--json"]));
    assert_eq!(names(&more), ["pass-spp", "method", "png-bits"]);
    assert_eq!(more["dials"][0], first["dials"][0]);
    let lines = measured("method", &[]);
    let said = String::from_utf8_lossy(&lines.stdout);
    assert!(
        said.contains("accuracy.md") && said.contains("method: "),
        "{said}"
    );
    // What was measured of another picture is not written over.
    let kept = std::fs::read(at("accuracy.json")).expect("a file");
    let line = refused(&measured("method", &["--mm", "3"]), 1);
    assert!(
        line.contains("accuracy.json") && line.contains("another folder"),
        "{line}"
    );
    assert_eq!(std::fs::read(at("accuracy.json")).expect("a file"), kept);
    for (dials, code, said) in [("glow", 2, "glow"), ("backing-layers", 1, "backing-layers")] {
        let line = refused(&measured(dials, &["--backing", "white"]), code);
        assert!(line.contains(said), "{line}");
    }
}

#[test]
fn measured_curves_choose_dials_by_a_budget() {
    let folder = tempfile::tempdir().expect("a folder");
    let small = ["oxford", "--size", "24x16"];
    let run = |command: &[&str], more: &[&str]| {
        pickglass(folder.path(), &[command, &small, more].concat())
    };
    let dials = ["--dials", "order,spp", "--extent", "quick", "--spp", "4"];
    let measured = json(&run(
        &["accuracy", "-o", "curves"],
        &[&dials[..], &["--json"]].concat(),
    ));
    assert_eq!(measured["spp"], 4);
    let still = ["still", "-o", "a.png", "--curves", "curves"];
    let made = json(&run(&still, &["--budget", "2s", "--json"]));
    has_keys(
        &made,
        &[
            "promise.seconds",
            "promise.error",
            "promise.bias",
            "promise.delta_e",
            "promise.spp",
            "promise.settings.order",
            "promise.settings.spp",
        ],
    );
    assert!(made["promise"]["seconds"].as_f64().expect("seconds") <= 2.0);
    // More error takes fewer paths, and a colour difference is a budget as well.
    let paths = |budget: &str| {
        let made = json(&run(&still, &["--budget", budget, "--json"]));
        made["promise"]["spp"].as_u64().expect("paths")
    };
    assert!(paths("90%") < paths("30%"));
    assert!(paths("dE20") <= paths("dE4"));
    // Another picture, no curves, and what no curve says.
    let other = refused(&run(&still, &["--budget", "2s", "--mm", "3"]), 1);
    assert!(
        other.contains("curves") && other.contains("Oxford"),
        "{other}"
    );
    let none = run(
        &["still", "-o", "a.png", "--curves", "none"],
        &["--budget", "2s"],
    );
    assert!(refused(&none, 1).contains("nothing was measured"));
    let good = refused(&run(&still, &["--budget", "0.001%"]), 1);
    assert!(good.contains("--budget 0.001 %"), "{good}");
    refused(&run(&still, &[]), 2);
    let seen = refused(&run(&["still", "-o", "a.png"], &["--budget", "dE1"]), 1);
    assert!(seen.contains("--curves"), "{seen}");
}

#[test]
fn what_a_picture_calls_for_is_said_and_a_budget_is_promised() {
    let folder = tempfile::tempdir().expect("a folder");
    let small = ["silk-satin", "--size", "48x32", "--mm", "4"];
    let run = |command: &[&str], more: &[&str]| {
        pickglass(folder.path(), &[command, &small, more].concat())
    };
    let effects = json(&run(&["effects"], &["--light", "sun", "--json"]));
    has_keys(
        &effects,
        &[
            "blocks",
            "tolerance",
            "left_out",
            "saved",
            "order",
            "seconds",
            "options",
            "effects.0.name",
            "effects.0.on",
            "effects.0.by",
            "effects.0.reason",
        ],
    );
    let of = |report: &serde_json::Value, name: &str| {
        let all = report["effects"].as_array().expect("effects").clone();
        let found = all.into_iter().find(|effect| effect["name"] == name);
        found.expect("an effect")
    };
    assert_eq!(of(&effects, "hairs")["on"], false);
    assert!(of(&effects, "shadows")["cost"].is_number());
    // A still that leaves the same out says so, and its options make it without looking.
    let still = ["still", "-o", "a.png"];
    let made = json(&run(
        &still,
        &[
            "--light",
            "sun",
            "--spp",
            "1",
            "--tolerance",
            "1%",
            "--json",
        ],
    ));
    assert_eq!(of(&made, "sky")["by"], "scene");
    assert_eq!(made["needs"]["order"], effects["order"]);
    let options = made["needs"]["options"].as_str().expect("options");
    assert!(
        options.contains("-sky") && options.contains("--set order="),
        "{options}"
    );
    let promised = json(&run(&still, &["--budget", "1s", "--json"]));
    has_keys(
        &promised,
        &["promise.seconds", "promise.error", "promise.order"],
    );
    for wrong in [
        &["--budget", "2"][..],
        &["--budget", "1%", "--tolerance", "1%"],
        &["--budget", "1%", "--spp", "2"],
        &["--tolerance", "0"],
    ] {
        refused(&run(&still, wrong), 2);
    }
    for idle in [
        &["--tolerance", "1%", "--renderer", "sight"][..],
        &["--budget", "1%", "--renderer", "sight"],
        &["--budget", "1%", "--colourway", "all"],
    ] {
        let line = refused(&run(&still, idle), 1);
        assert!(line.contains(idle[0]), "{line}");
    }
}

#[test]
fn options_that_others_leave_nothing_to_say_are_refused_by_name() {
    let folder = tempfile::tempdir().expect("a folder");
    let still = |file: &str, more: &[&str]| {
        let line = ["still", "oxford", "-o", file, "--size", "8x8", "--spp", "1"];
        pickglass(
            folder.path(),
            &[&line[..], &["--set", "level=4"], more].concat(),
        )
    };
    let idle: [(&str, &[&str], &str); 11] = [
        ("a.png", &["--set", "level=3"], "--set level"),
        (
            "a.png",
            &["--set", "rank=3", "--effects", "-edge-fixing"],
            "--set rank",
        ),
        (
            "a.png",
            &["--set", "rank=3", "--set", "seams=crowns"],
            "--set rank",
        ),
        (
            "a.png",
            &["--set", "rank=0", "--set", "seams=crowns"],
            "--set seams",
        ),
        (
            "a.png",
            &["--set", "order=3", "--effects", "none"],
            "--set order",
        ),
        (
            "a.png",
            &["--set", "backing-layers=3", "--backing", "white"],
            "--set backing-layers",
        ),
        ("a.png", &["--effects", "+sky,-sky"], "--effects"),
        ("a.exr", &["--set", "png-bits=16"], "--set png-bits"),
        ("a.exr", &["--set", "denoise=on"], "--set denoise"),
        ("a.exr", &["--exposure", "1"], "--exposure"),
        ("a.exr", &["--voxel", "1"], "--voxel"),
    ];
    for (file, more, named) in idle {
        let line = refused(&still(file, more), 1);
        assert!(line.contains(named), "{more:?}: {line}");
        assert_eq!(line.trim_end().lines().count(), 1, "{line}");
        assert!(!folder.path().join(file).exists());
    }
    let line = [
        "still",
        "oxford",
        "-o",
        "a.png",
        "--size",
        "8x8",
        "--renderer",
        "sight",
    ];
    for (more, named) in [
        (&["--set", "order=3"][..], "--set order"),
        (&["--effects", "+hairs"], "--effects +hairs"),
        (&["--effects", "-sky"], "--effects -sky"),
        (&["--effects", "all"], "--effects all"),
        (&["--effects", "none"], "--effects none"),
        (&["--seconds", "1"], "--seconds"),
    ] {
        let said = refused(&pickglass(folder.path(), &[&line[..], more].concat()), 1);
        assert!(said.contains(named) && said.contains("sight"), "{said}");
    }
    // Each of them has something to say elsewhere.
    for (file, more) in [
        ("a.png", &["--set", "rank=3"][..]),
        ("a.png", &["--set", "seams=crowns"]),
        ("a.png", &["--set", "backing-layers=3", "--backing", "self"]),
        ("a.png", &["--set", "png-bits=16", "--exposure", "1"]),
        ("a.exr", &["--set", "denoise=off"]),
    ] {
        assert!(still(file, more).status.success(), "{more:?}");
    }
}

/// The text that a PNG has under a key.
fn png_text(file: &Path, key: &str) -> String {
    let bytes = std::fs::read(file).expect("a picture");
    let mut rest = &bytes[8..];
    while let Some((length, chunk)) = rest.split_first_chunk::<4>() {
        let (data, after) = chunk[4..].split_at(u32::from_be_bytes(*length) as usize);
        if let Some(text) = data.strip_prefix(format!("{key}\0").as_bytes()) {
            let text = String::from_utf8_lossy(text);
            return text.trim_start_matches('\0').to_owned();
        }
        rest = &after[4..];
    }
    panic!("{} says nothing of {key}", file.display())
}

#[test]
fn a_picture_says_how_it_is_made_again() {
    let folder = tempfile::tempdir().expect("a folder");
    let run = |line: &[&str]| assert!(pickglass(folder.path(), line).status.success(), "{line:?}");
    run(&["convert", "damask", "my cloth's.ron"]);
    let voxels = ["volume", "oxford", "-o", "a.nrrd", "--level", "3"];
    run(&[&voxels[..], &["--voxels-per-crossing", "6"]].concat());
    let cloth = [
        "still",
        "my cloth's.ron",
        "-o",
        "a.png",
        "--size",
        "40x30",
        "--seconds",
        "0.1",
        "--view",
        "back",
        "--eye",
        "200,50",
        "--centre",
        "-1,0.5",
        "--mm",
        "3.3",
        "--light",
        "135,40",
        "--effects",
        "auto,-hairs",
        "--set",
        "level=3",
        "--set",
        "order=8",
        "--exposure",
        "0.5",
        "--seed",
        "5",
        "--turned",
        "--sett",
        "20x18",
        "--backing",
        "white",
    ];
    let grid = [
        "still",
        "a.nrrd",
        "-o",
        "a.png",
        "--size",
        "24x20",
        "--spp",
        "3",
        "--voxel",
        "0.05",
        "--effects",
        "+tap",
        "--light",
        "studio",
        "--set",
        "png-bits=16",
    ];
    let sight = [
        "still",
        "damask",
        "-o",
        "a.png",
        "--size",
        "40x30",
        "--renderer",
        "sight",
        "--view",
        "back",
    ];
    let plain = [
        "still", "oxford", "-o", "a.png", "--size", "20x20", "--error", "50%",
    ];
    for line in [&cloth[..], &grid, &plain, &sight] {
        run(line);
        let said = png_text(&folder.path().join("a.png"), "Settings");
        let again = |said: &str| {
            let program = env!("CARGO_BIN_EXE_pickglass");
            let said = said.replacen("pickglass", &format!("'{program}'"), 1);
            let made = Command::new("sh")
                .args(["-c", &said.replace("OUT.png", "b.png")])
                .current_dir(folder.path())
                .output()
                .expect("a shell");
            let error = String::from_utf8_lossy(&made.stderr);
            assert!(made.status.success(), "{said}: {error}");
            image::open(folder.path().join("b.png")).expect("a picture")
        };
        let first = image::open(folder.path().join("a.png")).expect("a picture");
        assert!(first == again(&said), "{said}");
        let other = said.replace(" --seed ", " --seed 7");
        // First sight is no matter of chance.
        let chance = line != &sight[..];
        assert!(
            said != other && chance == (first != again(&other)),
            "{other}"
        );
    }
}

#[test]
fn a_closed_pipe_is_not_a_panic() {
    let mut child = Command::new(env!("CARGO_BIN_EXE_pickglass"))
        .args(["check", "oxford"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    drop(child.stdout.take());
    let output = child.wait_with_output().expect("it ends");
    assert!(output.status.success());
    assert!(
        output.stderr.is_empty(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
}

/// Runs the program where no file may grow beyond `kilobytes`: as on a disk that fills up
/// midway.
#[cfg(unix)]
fn on_a_full_disk(folder: &Path, kilobytes: u32, arguments: &[&str]) -> Output {
    let cache = tempfile::tempdir().expect("a folder");
    let script = format!(
        "trap '' XFSZ; ulimit -f {}; exec \"$0\" \"$@\"",
        2 * kilobytes
    );
    Command::new("sh")
        .args(["-c", &script, env!("CARGO_BIN_EXE_pickglass")])
        .args(arguments)
        .current_dir(folder)
        .env("PICKGLASS_CACHE", cache.path())
        .output()
        .expect("a shell starts")
}

#[cfg(unix)]
#[test]
fn a_volume_that_meets_a_full_disk_leaves_nothing_behind() {
    for ending in ["vol", "vdb", "nrrd", "mhd", "tif"] {
        let folder = tempfile::tempdir().expect("a folder");
        let name = format!("cloth.{ending}");
        let volume = [
            "volume",
            "oxford",
            "-o",
            &name,
            "--region",
            "0,0,4,4",
            "--voxels-per-crossing",
            "24",
        ];
        std::fs::write(folder.path().join(&name), "kept").expect("written");
        let output = on_a_full_disk(folder.path(), 64, &volume);
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{said}");
        let line = said.lines().last().unwrap_or_default();
        assert!(line.contains("cloth") && line.contains("; "), "{line}");
        let left: Vec<_> = std::fs::read_dir(folder.path())
            .expect("listed")
            .flatten()
            .map(|entry| entry.file_name())
            .collect();
        assert_eq!(left, [name.as_str()], "{ending}");
        let kept = std::fs::read(folder.path().join(&name)).expect("read");
        assert_eq!(kept, b"kept", "{ending}: an earlier file stays");
        // With room it is written.
        let output = on_a_full_disk(folder.path(), 1 << 20, &volume);
        assert!(output.status.success(), "{ending}");
        let written = std::fs::metadata(folder.path().join(&name)).expect("there");
        assert!(written.len() > 4, "{ending}");
    }
}
