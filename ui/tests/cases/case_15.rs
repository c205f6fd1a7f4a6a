//! The inputs of tests/cases/15, each with what is wanted of it, and their neighbours.

use super::program::{Place, Said};

/// The program under a limit of address space, in KiB.
#[cfg(target_os = "linux")]
fn limited(place: &Place, kib: u64, arguments: &[&str]) -> Said {
    let program = env!("CARGO_BIN_EXE_pickglass");
    let script = format!("ulimit -v {kib}; exec \"$0\" \"$@\"");
    let output = std::process::Command::new("bash")
        .args(["-c", &script, program])
        .args(arguments)
        .current_dir(place.path("."))
        .env("PICKGLASS_CACHE", place.path("cache"))
        .env_remove("PICKGLASS_MEMORY")
        .output();
    Said::of(output.expect("bash runs"))
}

#[cfg(target_os = "linux")]
#[test]
fn thick_yarns_are_taken_to_touch_in_little_memory() {
    let place = Place::of("15");
    for name in ["thick-yarn.ron", "thick-yarn-10mm.ron"] {
        let line = [
            "still", name, "-o", "o.png", "--size", "24x16", "--spp", "8",
        ];
        let said = limited(
            &place,
            4 << 20,
            &[&line[..], &["--set", "level=3"]].concat(),
        )
        .done();
        let told = said.err.matches("they are taken to touch").count();
        assert_eq!(told, 1, "{said:?}");
    }
}

#[test]
fn thick_yarns_are_an_obstacle_and_weigh_what_touching_ones_do() {
    let place = Place::of("15");
    for name in ["thick-yarn.ron", "thick-yarn-10mm.ron"] {
        let said = place.run(&["check", name, "--json"]).done();
        let report = said.json();
        assert_eq!(report["weavable"], false);
        let obstacle = report["obstacles"][0].as_str().expect("an obstacle");
        assert!(obstacle.contains("they are taken to touch"), "{obstacle}");
        let warnings = report["warnings"].as_array().expect("warnings");
        let told = warnings.iter().filter(|text| *text == obstacle).count();
        assert_eq!(told, 1, "{warnings:?}");
        // 0.5 mm of cotton at 0.88 g/cm³ is 173 tex; 20 ends and picks a cm of it weigh
        // 2 · 2000 · 0.173 g a square metre, and take-up adds to that.
        let grams = report["grams_per_m2"].as_f64().expect("grams");
        assert!((691.0..1100.0).contains(&grams), "{grams}");
        let said = place.run(&["check", name]).done();
        assert!(!said.out.contains("a loom can weave it"), "{}", said.out);
    }
}

#[test]
fn a_dense_cloth_is_no_obstacle() {
    // A third wider than their pitch: threads flatten, as in any satin of many ends.
    let place = Place::of("15");
    let text = std::fs::read_to_string(place.path("thick-yarn.ron")).expect("the design");
    let dense = text.replace("Some(100)", "Some(0.66)");
    assert_ne!(text, dense);
    std::fs::write(place.path("dense.ron"), dense).expect("a design");
    let report = place.run(&["check", "dense.ron", "--json"]).done().json();
    assert_eq!(report["weavable"], true);
}
