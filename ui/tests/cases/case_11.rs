//! The inputs of tests/cases/11, each with what is wanted of it, and their neighbours: a
//! thread's number is the file's, in whatever is read of it or written.

use super::program::Place;

/// The entries of a section of a WIF.
fn section(wif: &str, name: &str) -> Vec<(u32, String)> {
    let lines = wif.lines().map(str::trim);
    let inside = lines.skip_while(|line| !line.eq_ignore_ascii_case(&format!("[{name}]")));
    inside
        .skip(1)
        .take_while(|line| !line.starts_with('['))
        .filter_map(|line| line.split_once('='))
        .filter_map(|(thread, on)| Some((thread.trim().parse().ok()?, on.trim().to_owned())))
        .collect()
}

/// Whether the warp is up at an end and a pick, from 1, as a picture of the weave shows it:
/// black is warp up, and the lowest row pick 1.
fn up(place: &Place, picture: &str, end: u32, pick: u32) -> bool {
    let picture = image::open(place.path(picture))
        .expect("a picture")
        .to_luma8();
    picture.get_pixel(end - 1, picture.height() - pick).0[0] == 0
}

#[test]
fn the_written_draft_and_picture_name_the_same_threads() {
    let place = Place::of("11");
    place
        .run(&["convert", "straight-draw.wif", "out.wif"])
        .done();
    let [before, after] = ["straight-draw.wif", "out.wif"]
        .map(|name| std::fs::read_to_string(place.path(name)).expect("read"));
    for name in ["THREADING", "TREADLING"] {
        let rows = section(&before, name);
        assert_eq!(rows.len(), 8);
        assert_eq!(section(&after, name), rows, "{name}");
    }
    place
        .run(&[
            "convert",
            "straight-draw.wif",
            "weave.png",
            "--write",
            "weave",
        ])
        .done();
    for (end, pick) in (1..=8).flat_map(|end| (1..=8).map(move |pick| (end, pick))) {
        // Shaft and treadle are those of the file: a straight draw, one shaft at a time.
        let expected = (end - 1) % 4 == (pick - 1) % 4;
        assert_eq!(up(&place, "weave.png", end, pick), expected, "{end} {pick}");
    }
}

#[test]
fn check_names_the_thread_as_the_file_does() {
    let place = Place::of("11");
    let text = std::fs::read_to_string(place.path("straight-draw.wif")).expect("read");
    // End 3 hangs on no shaft: it lies below every pick.
    let loose = text.replacen("[THREADING]\n1=1\n2=2\n3=3\n", "[THREADING]\n1=1\n2=2\n", 1);
    assert_ne!(loose, text);
    std::fs::write(place.path("loose.wif"), loose).expect("written");
    let said = place.run(&["check", "loose.wif", "--json"]).done().json();
    assert_eq!(said["unbound_ends"], serde_json::json!([3]));
    let words = said["obstacles"].to_string();
    assert!(words.contains("end 3 first"), "{words}");
    // The same file as a picture of its weave: column 3 has no black.
    place
        .run(&["convert", "loose.wif", "loose.png", "--write", "weave"])
        .done();
    assert!((1..=8).all(|pick| !up(&place, "loose.png", 3, pick)));
    assert!(up(&place, "loose.png", 4, 4));
    // What is well bound names none.
    let said = place.run(&["check", "straight-draw.wif", "--json"]).done();
    assert_eq!(said.json()["unbound_ends"], serde_json::json!([]));
}
