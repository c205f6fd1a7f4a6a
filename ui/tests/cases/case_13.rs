//! The inputs of tests/cases/13, each with what is wanted of it, and their neighbours.

use crate::program::Place;
use serde_json::Value;

/// Mean and root mean square of ΔE over the cloth, and the pair of yarns.
fn posterised(place: &Place, arguments: &[&str]) -> ([f64; 2], Value) {
    let mut all = vec!["posterize"];
    all.extend(arguments);
    all.extend(["-o", "a.ron", "--json"]);
    let report = place.run(&all).done().json();
    let list = |name: &str| -> Vec<f64> {
        let list = report[name].as_array().expect(name);
        list.iter()
            .map(|value| value.as_f64().expect(name))
            .collect()
    };
    let (coverage, off) = (list("coverage"), list("expected_delta_e"));
    let sum = |of: &dyn Fn(f64) -> f64| -> f64 {
        coverage
            .iter()
            .zip(&off)
            .map(|(share, &off)| share * of(off))
            .sum()
    };
    ([sum(&|off| off), sum(&|off| off * off).sqrt()], report)
}

#[test]
fn case_13_the_proposed_pair_is_no_worse_than_simple_ones() {
    let place = Place::of("13");
    let four = ["--colours", "4"];
    for (name, size, pairs) in [
        (
            "quarters.jpg",
            &four[..],
            [["#191975", "#f3eee2"], ["#1c1b1d", "#fdfcfd"]],
        ),
        (
            "quarters.png",
            &four[..],
            [["#191975", "#f3eee2"], ["#1c1b1d", "#fdfcfd"]],
        ),
        (
            "flat4.png",
            &["--ends", "60", "--picks", "60"][..],
            [["#1c1b1d", "#fdfcfd"], ["#1c1b1d", "#f3eee2"]],
        ),
    ] {
        let arguments: Vec<&str> = [name].iter().chain(size).copied().collect();
        let ([mean, rms], report) = posterised(&place, &arguments);
        println!("{name}: mean {mean:.2}, rms {rms:.2}: {report}");
        // What the pair of the same picture as PNG once came to.
        if name.starts_with("quarters") {
            assert!(mean < 24.9 && rms < 29.2, "{name}: {mean} {rms}");
        }
        for [warp, weft] in pairs {
            let mut given = arguments.clone();
            given.extend(["--warp", warp, "--weft", weft]);
            let ([other_mean, other_rms], _) = posterised(&place, &given);
            println!("  {warp} {weft}: mean {other_mean:.2}, rms {other_rms:.2}");
            // What is least is their sum: neither is bought with much of the other.
            assert!(
                mean + rms <= other_mean + other_rms + 0.1,
                "{name} {warp} {weft}: {mean} {rms} {other_mean} {other_rms}"
            );
        }
    }
}

/// Grain of ±1 in the picture does not turn white cloth green.
#[test]
fn case_13_jpeg_and_png_of_a_picture_are_woven_alike() {
    let place = Place::of("13");
    let pair = |name: &str| {
        let ([mean, _], report) = posterised(&place, &[name, "--colours", "4"]);
        (mean, report["expected"].clone(), report)
    };
    let (jpeg, _, report) = pair("quarters.jpg");
    let (png, ..) = pair("quarters.png");
    assert!((jpeg - png).abs() < 1.0, "{jpeg} {png}");
    // The lightest colour is white, and shows itself nearly so.
    let off = report["expected_delta_e"]
        .as_array()
        .expect("a list")
        .last()
        .cloned();
    assert!(off.as_ref().and_then(Value::as_f64) < Some(12.0), "{off:?}");
}
