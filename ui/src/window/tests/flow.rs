//! The whole way of a design, each part as a person goes it: from a WIF or a photograph to
//! files, by pointer, keys and accessible labels.

use std::path::Path;

use egui::accesskit::Role;
use egui::{Event, Key, Modifiers, PointerButton, Pos2};
use egui_kittest::kittest::{NodeT, Queryable};
use pickglass::design::{Design, Regions, Srgb, Structure};

use super::opening::open_by_path;
use super::{TABBY, Window, build, builder, says, shows, wait_for};

/// A tall window, in which every pane shows all it has.
fn window(design: Option<&str>) -> Window {
    let mut window = build(builder().with_size([1280.0, 1600.0]), design);
    window.state_mut().preview.freeze();
    window.step();
    window
}

fn design(window: &Window) -> &Design {
    window.state().document().expect("a document").design()
}

fn up(window: &Window, end: u32, pick: u32) -> bool {
    let document = window.state().document().expect("a document");
    document.drawdown().get(end, pick)
}

/// Does a command as the palette offers it.
fn command(window: &mut Window, typed: &str) {
    window.key_press_modifiers(Modifiers::COMMAND, Key::K);
    window.run_steps(3);
    window.get_by_label("Command to find").type_text(typed);
    window.run_steps(3);
    window.key_press(Key::Enter);
    window.run_steps(3);
}

/// A stroke of the pencil through crossings.
fn stroke(window: &mut Window, cells: &[(i64, i64)]) {
    let places: Vec<Pos2> = (cells.iter())
        .map(|&cell| window.state().draft.place_of(cell))
        .collect();
    let button = |at: Pos2, pressed: bool| Event::PointerButton {
        pos: at,
        button: PointerButton::Primary,
        pressed,
        modifiers: Modifiers::NONE,
    };
    window.event(Event::PointerMoved(places[0]));
    window.step();
    window.event(button(places[0], true));
    window.step();
    for place in &places[1..] {
        window.event(Event::PointerMoved(*place));
        window.step();
    }
    window.event(button(places[places.len() - 1], false));
    window.run_steps(3);
}

/// Types a number into a field.
fn type_number(window: &mut Window, field: &str, number: &str) {
    window
        .get_by_role_and_label(Role::SpinButton, field)
        .focus();
    window.run_steps(3);
    window.key_press_modifiers(Modifiers::COMMAND, Key::A);
    window.run_steps(2);
    window.event(Event::Text(number.to_owned()));
    window.run_steps(2);
    window.key_press(Key::Enter);
    window.run_steps(3);
}

/// Types a text into a field in place of what is there.
fn type_text(window: &mut Window, field: &str, text: &str) {
    window.get_by_role_and_label(Role::TextInput, field).focus();
    window.run_steps(2);
    window.key_press_modifiers(Modifiers::COMMAND, Key::A);
    window.run_steps(2);
    window.event(Event::Text(text.to_owned()));
    window.run_steps(2);
}

#[test]
fn a_wif_is_opened_a_float_painted_and_taken_back() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("tabby.wif");
    std::fs::write(&path, TABBY).expect("written");
    let mut window = window(None);
    open_by_path(&mut window, &path.display().to_string());
    wait_for(&mut window, "the draft", |window| {
        says(window, "Drawdown of ")
    });
    command(&mut window, "become a jacquard");
    let before: Vec<bool> = (0..4).map(|end| up(&window, end, 1)).collect();
    assert!(before.contains(&false), "nothing to paint in plain weave");
    stroke(&mut window, &[(0, 1), (3, 1)]);
    assert!((0..4).all(|end| up(&window, end, 1)), "a float of the warp");
    let entries = window.state().document().expect("open").position();
    assert_eq!(entries, 2, "a stroke is one entry");
    window.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    window.run_steps(2);
    let after: Vec<bool> = (0..4).map(|end| up(&window, end, 1)).collect();
    assert_eq!(after, before);
}

/// A picture in which a sky, a hill and a sun fade into themselves, as a photograph's do.
fn write_photograph(path: &Path) {
    let picture = image::RgbImage::from_fn(96, 64, |x, y| {
        let fade = (x / 12) as u8;
        let sun = (x as i32 - 70).pow(2) + (y as i32 - 16).pow(2) < 120;
        match (sun, y > 36 + x / 8) {
            (true, _) => image::Rgb([240, 220 - fade, 90 + fade]),
            (_, true) => image::Rgb([50 + fade, 80 + fade, 40]),
            _ => image::Rgb([120 + fade, 160 + fade, 210]),
        }
    });
    picture.save(path).expect("a picture");
}

fn regions(window: &Window) -> &Regions {
    match design(window).structure() {
        Structure::Regions(regions) => regions,
        _ => panic!("no regions"),
    }
}

#[test]
fn a_photograph_becomes_three_weaves_and_one_is_reassigned() {
    let folder = tempfile::tempdir().expect("a folder");
    let photograph = folder.path().join("sun.png");
    write_photograph(&photograph);
    let mut window = window(Some("oxford"));
    let per_cm = design(&window).sett().ends.per_cm;
    command(&mut window, "show posterising");
    type_text(&mut window, "Picture", &photograph.display().to_string());
    window.key_press(Key::Enter);
    wait_for(&mut window, "its settings", |window| {
        window
            .query_by_role_and_label(Role::Slider, "Colours")
            .is_some()
    });
    type_number(&mut window, "Ends", "72");
    window
        .get_by_role_and_label(Role::Slider, "Colours")
        .focus();
    window.run_steps(2);
    // From the usual eight down to three, and no further: not two.
    for _ in 0..5 {
        window.key_press(Key::ArrowLeft);
        window.run_steps(2);
    }
    wait_for(&mut window, "the map of three colours", |window| {
        window.state().panes.posterised() == Some((72, 3))
    });
    window.get_by_label("Make it the design").click_accesskit();
    wait_for(&mut window, "its regions", |window| {
        shows(window, "3 regions")
    });
    assert_eq!(design(&window).ends(), 72);
    let sett = design(&window).sett();
    assert!((sett.ends.per_cm - per_cm).abs() < 0.01, "the cloth's sett");
    assert!(design(&window).weavable());

    let (map, fills) = {
        let regions = regions(&window);
        let fills: Vec<_> = (regions.palette().iter())
            .map(|region| region.fill.clone())
            .collect();
        (regions.map().clone(), fills)
    };
    let first = format!("Weave of {}", regions(&window).palette()[0].name);
    window.get_by_label_contains(&first).click_accesskit();
    window.run_steps(4);
    type_text(&mut window, "Find a weave", "basket");
    window.run_steps(3);
    (window.get_all_by_label_contains("basket"))
        .find(|node| node.accesskit_node().role() == Role::Button)
        .expect("a basket weave")
        .click();
    window.run_steps(4);
    let after = regions(&window);
    assert!(after.palette()[0].fill != fills[0], "another weave");
    for (region, fill) in after.palette().iter().zip(&fills).skip(1) {
        assert!(region.fill == *fill, "{} changed too", region.name);
    }
    assert!(*after.map() == map, "the outlines stay");
    window.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    window.run_steps(3);
    assert!(regions(&window).palette()[0].fill == fills[0]);
}

#[test]
fn colourways_are_switched_by_key_all_round() {
    let mut window = window(Some("herringbone"));
    let colours = |window: &Window| -> Vec<Srgb> {
        let yarns = design(window).yarns();
        yarns.iter().map(|yarn| yarn.colour).collect()
    };
    let own = colours(&window);
    let count = design(&window).colourways().len();
    assert!(count > 1, "a preset with colourways");
    let structure = window.state().document().expect("open").drawdown().clone();
    let mut seen = vec![own.clone()];
    for _ in 0..count {
        window.key_press(Key::Period);
        window.run_steps(2);
        let now = colours(&window);
        assert!(!seen.contains(&now), "each once");
        seen.push(now);
    }
    window.key_press(Key::Period);
    window.run_steps(2);
    assert_eq!(colours(&window), own, "after the last comes the first");
    let document = window.state().document().expect("open");
    assert_eq!(*document.drawdown(), structure);

    command(&mut window, "show colourways");
    window
        .get_by_label_contains("Use colourway night")
        .click_accesskit();
    window.run_steps(3);
    assert_eq!(design(&window).colourway, "night");
    window.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    window.run_steps(2);
    assert_eq!(colours(&window), own);
}

#[test]
fn a_volume_says_its_bytes_before_it_is_written() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("corner.nrrd");
    let mut window = window(Some("oxford"));
    command(&mut window, "export volume");
    type_number(&mut window, "Ends", "3");
    type_number(&mut window, "Picks", "2");
    type_number(&mut window, "Voxels a crossing", "8");
    type_text(&mut window, "File", &path.display().to_string());
    assert!(!shows(&window, "Write"), "the bytes come first");
    window.get_by_label("Count the bytes").click();
    wait_for(&mut window, "the bytes", |window| shows(window, "Write"));
    assert!(says(&window, " voxels of "));
    // Another window has other bytes.
    type_number(&mut window, "Picks", "4");
    assert!(!shows(&window, "Write"));
    window.get_by_label("Count the bytes").click();
    wait_for(&mut window, "the bytes", |window| shows(window, "Write"));
    assert!(!path.exists());
    window.get_by_label("Write").click();
    wait_for(&mut window, "the file", |window| says(window, "Wrote "));
    let bytes = std::fs::read(&path).expect("a file");
    assert!(bytes.starts_with(b"NRRD"));
    // Voxels are cubes of the shorter pitch over eight, and four picks are more than three.
    let head = String::from_utf8_lossy(&bytes[..bytes.len().min(2000)]).into_owned();
    let sizes: Vec<usize> = (head.lines())
        .find_map(|line| line.strip_prefix("sizes:"))
        .expect("sizes")
        .split_whitespace()
        .map(|size| size.parse().expect("a number"))
        .collect();
    let [.., x, y, z] = sizes[..] else {
        panic!("{sizes:?}");
    };
    assert!(x >= 24 && y >= 32 && z > 4, "{sizes:?}");
}

/// Voxels of a `.vol` along x, y and z.
fn vol_size(path: &std::path::Path) -> [i32; 3] {
    let bytes = std::fs::read(path).expect("a file");
    assert!(bytes.starts_with(b"VOL\x03"));
    [8, 12, 16].map(|at| {
        let four = bytes[at..at + 4].try_into().expect("four bytes");
        i32::from_le_bytes(four)
    })
}

#[test]
fn yarns_the_face_alone_and_coarse_levels_are_exported_as_well() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut window = window(Some("oxford"));
    // Shows the form, fills it in, counts and writes.
    let export = |window: &mut Window, name: &str, level: &str, part: &str| {
        let path = folder.path().join(name);
        command(window, "export volume");
        type_number(window, "Ends", "3");
        type_number(window, "Picks", "2");
        type_number(window, "Level: each is half as fine", level);
        window.get_by_label(part).click();
        window.run_steps(3);
        type_text(window, "File", &path.display().to_string());
        window.get_by_label("Count the bytes").click();
        wait_for(window, "the bytes", |window| shows(window, "Write"));
        let yarns = name.ends_with(".glb");
        assert_eq!(says(window, ": 5 yarns"), yarns);
        assert_eq!(says(window, " voxels of "), !yarns);
        window.get_by_label("Write").click();
        let wrote = format!("Wrote {}", path.display());
        wait_for(window, "the file", |window| says(window, &wrote));
        path
    };
    let tubes = export(&mut window, "yarns.glb", "0", "whole");
    assert!(std::fs::read(tubes).expect("a file").starts_with(b"glTF"));
    let sizes = [("whole", "0"), ("face alone", "0"), ("whole", "2")].map(|(part, level)| {
        let name = format!("{}{level}.vol", part.replace(' ', "-"));
        let path = export(&mut window, &name, level, part);
        // With a scene that names it.
        let scene = std::fs::read_to_string(path.with_extension("xml")).expect("a scene");
        assert!(scene.contains(&name) && path.with_extension("py").exists());
        vol_size(&path)
    });
    let [whole, face, coarse] = sizes;
    assert!(whole[2] > face[2] && whole[..2] == face[..2], "{sizes:?}");
    assert!((0..3).all(|axis| coarse[axis] < whole[axis]), "{sizes:?}");
}

/// The mean of red less blue over the picture of the cloth.
fn warmth(window: &Window) -> Option<f64> {
    let shown = window.state().preview.pane.shown.as_ref()?;
    let pixels = &shown.image.pixels;
    let sum: f64 = (pixels.iter())
        .map(|pixel| f64::from(pixel.r()) - f64::from(pixel.b()))
        .sum();
    Some(sum / pixels.len().max(1) as f64)
}

#[test]
fn the_cloth_follows_a_stroke_and_its_undoing() {
    // A blue warp and a white weft: a pick that goes under makes the cloth bluer.
    let mut window = build(builder(), Some("oxford"));
    wait_for(&mut window, "a full picture", |window| {
        window.state().preview.has_full_picture()
    });
    let before = warmth(&window).expect("a picture");
    stroke(&mut window, &[(0, 0), (3, 0)]);
    wait_for(&mut window, "a bluer cloth", |window| {
        warmth(window).is_some_and(|now| now < before - 10.0)
    });
    window.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    wait_for(&mut window, "the cloth as it was", |window| {
        warmth(window).is_some_and(|now| now > before - 5.0)
    });
}
