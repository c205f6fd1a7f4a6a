//! The layouts of the draft: draft and cloth turned by 180° or not, with every thread under
//! the number that its file gives it, and everything at the pointer going where it points.

use std::path::Path;

use egui::{Event, Key, Modifiers, PointerButton, Pos2};
use egui_kittest::kittest::Queryable;
use miniz_oxide::inflate::decompress_to_vec_zlib;
use pickglass::design::{Design, Draft, Lifting, Structure, WeavePattern};
use pickglass::edit::Rect;
use pickglass::formats::{self, LoadOptions};

use super::files::type_path;
use super::pictures::renderer;
use super::{Window, build, builder, open, says, wait_for};
use crate::command_table::{Command, DraftLayout, Tool, Toward, WeaveCommand};
use crate::opened::Opened;
use crate::window::laid::Laid;
use crate::window::session::Session;

const LAYOUTS: [DraftLayout; 3] = [
    DraftLayout::Us,
    DraftLayout::Scandinavian,
    DraftLayout::Jacquard,
];

/// A straight draw on four shafts, one shaft a pick: end 1 on shaft 1, pick 1 lifts it.
fn straight_draw() -> Opened {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/cases/11/straight-draw.wif");
    Opened::file(path).expect("the case's file")
}

fn run_command(window: &mut Window, command: Command) {
    let ctx = window.ctx.clone();
    window.state_mut().run_command(&ctx, command);
    window.run_steps(3);
}

fn laid_out(opened: Opened, layout: DraftLayout) -> Window {
    let mut window = open(builder(), Some(opened));
    window.state_mut().preview.freeze();
    window.run_steps(2);
    run_command(&mut window, Command::Arrange(layout));
    window
}

/// A drawdown of 8 × 8 crossings, all weft up but for end 1 at pick 1.
fn one_crossing() -> Opened {
    let pattern = WeavePattern::from_fn(8, 8, |end, pick| end == 0 && pick == 0);
    let blank = crate::window::session::blank().expect("a design");
    let design = Design::clone(&blank.design).with_structure(Structure::Pattern(pattern));
    Opened {
        design: std::sync::Arc::new(design.expect("a design")),
        ..blank
    }
}

fn drawdown(window: &Window) -> WeavePattern {
    let document = window.state().document().expect("open");
    WeavePattern::clone(document.drawdown())
}

fn place(window: &Window, cell: (i64, i64)) -> Pos2 {
    window.state().draft.place_of(cell)
}

fn hover(window: &mut Window, at: Pos2) {
    window.event(Event::PointerMoved(at));
    window.run_steps(3);
}

fn drag(window: &mut Window, from: Pos2, to: Pos2) {
    let button = |pos, pressed| Event::PointerButton {
        pos,
        button: PointerButton::Primary,
        pressed,
        modifiers: Modifiers::NONE,
    };
    window.event(Event::PointerMoved(from));
    window.step();
    window.event(button(from, true));
    window.step();
    window.event(Event::PointerMoved(to));
    window.step();
    window.event(button(to, false));
    window.run_steps(2);
}

/// Numbers on the first page of a PDF, with their places.
fn numbers(pdf: &[u8]) -> Vec<(f32, f32, u32)> {
    let find = |from: usize, what: &[u8]| {
        let found = pdf[from..].windows(what.len()).position(|at| at == what);
        found.map(|at| from + at)
    };
    let begin = find(0, b"\nstream\n").expect("a page") + 8;
    let end = find(begin, b"endstream").expect("its end");
    let content = decompress_to_vec_zlib(&pdf[begin..end]).expect("deflated");
    let content = String::from_utf8_lossy(&content).into_owned();
    let lines: Vec<&str> = content.lines().collect();
    let shown = |pair: &[&str]| {
        let text = pair[1].strip_prefix('(')?.strip_suffix(") Tj")?;
        let mut place = pair[0].strip_suffix(" Td")?.split(' ');
        let mut number = || place.next()?.parse::<f32>().ok();
        Some((number()?, number()?, text.parse().ok()?))
    };
    lines.windows(2).filter_map(shown).collect()
}

fn draft(design: &Design) -> &Draft {
    match design.structure() {
        Structure::Draft(draft) => draft,
        other => panic!("{other:?}"),
    }
}

#[test]
fn case_11_window_paper_and_file_name_the_same_thread_in_every_layout() {
    let folder = tempfile::tempdir().expect("a folder");
    for layout in LAYOUTS {
        let mut window = laid_out(straight_draw(), layout);
        let [pdf, wif] =
            ["pdf", "wif"].map(|ending| folder.path().join(format!("{layout:?}.{ending}")));
        // The window: the file's end 1 is up at its pick 1, and end 3 is not.
        for (end, words) in [
            (0, "end 1 · pick 1 · colour 1 over colour 2"),
            (2, "end 3 · pick 1 · colour 2 over colour 1"),
        ] {
            let at = place(&window, (end, 0));
            hover(&mut window, at);
            assert!(says(&window, words), "{layout:?}: not {words}");
        }
        // Where they lie: end 1 at the right and pick 1 at the top, or neither.
        let (first, last) = (place(&window, (0, 0)), place(&window, (7, 7)));
        let turned = layout == DraftLayout::Us;
        assert_eq!(first.x > last.x, turned, "{layout:?}");
        assert_eq!(first.y < last.y, turned, "{layout:?}");
        assert_eq!(window.state().preview.turned, turned);
        assert_eq!(
            window.state().preview.asked().expect("asked").turned,
            turned
        );
        if layout != DraftLayout::Jacquard {
            // End 1 hangs on shaft 1, right under it.
            let heddle = window.state().draft.threading_place((0, 0));
            assert!((heddle.x - first.x).abs() < 0.1);
            assert_eq!(heddle.y < first.y, turned, "above or below");
        }
        // On paper.
        window.key_press_modifiers(Modifiers::COMMAND, Key::P);
        type_path(&mut window, &pdf.display().to_string(), "Print");
        wait_for(&mut window, "the pages", |window| says(window, "Wrote "));
        let printed = numbers(&std::fs::read(&pdf).expect("read"));
        let low = printed.iter().map(|text| text.1).fold(f32::MAX, f32::min);
        let near = |a: f32, b: f32| (a - b).abs() < 0.1;
        let ends: Vec<_> = printed.iter().filter(|text| near(text.1, low)).collect();
        assert_eq!(ends.len(), 3, "1, 4 and 8");
        let read = straight_draw().design;
        for &&(x, y, end) in &ends {
            // Numbers of threads are smaller than those in the cells.
            let above = |text: &&(f32, f32, u32)| (text.0 - x).abs() < 2.0 && text.1 > y + 1.0;
            let shaft = printed.iter().find(above).expect("a shaft").2;
            let known = draft(&read).threading().row(end as usize - 1);
            assert_eq!(known, [shaft as u16 - 1], "{layout:?}: end {end}");
        }
        let x_of = |end: u32| ends.iter().find(|text| text.2 == end).expect("printed").0;
        assert_eq!(x_of(1) > x_of(8), turned, "{layout:?}: printed as shown");
        // In the file that is written.
        window.key_press_modifiers(Modifiers::COMMAND.plus(Modifiers::SHIFT), Key::E);
        type_path(&mut window, &wif.display().to_string(), "Export");
        wait_for(&mut window, "the draft", |_| wif.exists());
        wait_for(&mut window, "its end", |window| {
            !window.state().files.is_writing()
        });
        let written = formats::load(&wif, &LoadOptions::default())
            .expect("read")
            .design;
        let (a, b) = (draft(&written), draft(&read));
        assert_eq!(a.threading(), b.threading(), "{layout:?}");
        let lifts = |draft: &Draft| match draft.lifting() {
            Lifting::Treadled { treadling, .. } => treadling.clone(),
            other => panic!("{other:?}"),
        };
        assert_eq!(lifts(a), lifts(b), "{layout:?}");
    }
}

#[test]
fn case_11_places_and_crossings_are_inverse_in_every_layout() {
    for layout in LAYOUTS {
        let mut window = laid_out(straight_draw(), layout);
        for (end, pick) in [(0, 0), (7, 0), (0, 7), (5, 2), (-1, 3), (8, -2)] {
            let at = place(&window, (end, pick));
            let draft = &window.state().draft;
            assert_eq!(draft.crossing_at(at), (end, pick), "{layout:?}");
            if draft.drawdown_rect().contains(at) {
                hover(&mut window, at);
                assert_eq!(window.state().hover, Some((end, pick)), "{layout:?}");
            }
        }
        // The pointer on the cloth means the crossing that lies there.
        let pane = window.get_by_label_contains("Cloth of ").rect();
        let laid = Laid::of(window.state().document().expect("open"), None);
        // Not in the middle, where it says that the cloth is not drawn.
        for (end, pick) in [(1, -3), (6, 11)] {
            let view = window.state().preview.cloth_view().expect("a view");
            let [left, low, right, high] = laid.crossing_mm(end, pick);
            let at = view.to_screen(pane, [(left + right) / 2.0, (low + high) / 2.0]);
            hover(&mut window, at);
            assert_eq!(window.state().hover, Some((end, pick)), "{layout:?}");
            let words = format!("end {} · pick {} · ", end + 1, pick.rem_euclid(8) + 1);
            assert!(says(&window, &words), "{layout:?}: not {words}");
        }
    }
}

#[test]
fn case_11_painting_selecting_and_arrows_go_where_they_point_in_every_layout() {
    for layout in LAYOUTS {
        let mut window = laid_out(one_crossing(), layout);
        let (from, to) = (place(&window, (2, 3)), place(&window, (5, 3)));
        drag(&mut window, from, to);
        let expected = WeavePattern::from_fn(8, 8, |end, pick| {
            (end == 0 && pick == 0) || (pick == 3 && (2..=5).contains(&end))
        });
        assert_eq!(drawdown(&window), expected, "{layout:?}");

        run_command(&mut window, Command::Use(Tool::Select));
        let (from, to) = (place(&window, (1, 1)), place(&window, (3, 4)));
        drag(&mut window, from, to);
        let selected = Rect {
            end: 1,
            pick: 1,
            ends: 3,
            picks: 4,
        };
        assert_eq!(
            window.state().draft.selection(),
            Some(selected),
            "{layout:?}"
        );

        // What was copied is put where the pointer is.
        run_command(&mut window, Command::Weave(WeaveCommand::Copy));
        run_command(&mut window, Command::Use(Tool::Stamp));
        let at = place(&window, (4, 4));
        drag(&mut window, at, at);
        // Of the copy the crossings (2, 3) and (3, 3), counted from (1, 1).
        assert!(
            drawdown(&window).get(5, 6) && drawdown(&window).get(6, 6),
            "{layout:?}"
        );

        // Arrows go as they point, whichever way the numbers run.
        window.state().draft.focus(&window.ctx.clone());
        // The pointer elsewhere, and the keyboard's cursor in its place.
        hover(&mut window, Pos2::new(2.0, 2.0));
        window.key_press(Key::ArrowRight);
        window.run_steps(2);
        for (key, [right, up]) in [
            (Key::ArrowRight, [1.0, 0.0]),
            (Key::ArrowUp, [0.0, 1.0]),
            (Key::ArrowLeft, [-1.0, 0.0]),
            (Key::ArrowDown, [0.0, -1.0]),
        ] {
            let before = place(&window, window.state().hover.expect("a cursor"));
            window.key_press(key);
            window.run_steps(2);
            let after = place(&window, window.state().hover.expect("a cursor"));
            let by = (after - before) / (window.state().draft.cell() as f32);
            assert!(
                (by.x - right).abs() < 0.1 && (by.y + up).abs() < 0.1,
                "{layout:?} {key:?}"
            );
        }
    }
}

#[test]
fn case_11_rolling_goes_where_it_says_in_every_layout() {
    for layout in LAYOUTS {
        for (toward, [right, up]) in [
            (Toward::Right, [1.0, 0.0]),
            (Toward::Left, [-1.0, 0.0]),
            (Toward::Up, [0.0, 1.0]),
            (Toward::Down, [0.0, -1.0]),
        ] {
            let mut window = laid_out(one_crossing(), layout);
            let size = window.state().draft.cell() as f32;
            let beside = place(&window, (0, 0)) + egui::vec2(right, -up) * size;
            let (end, pick) = window.state().draft.crossing_at(beside);
            run_command(&mut window, Command::Weave(WeaveCommand::Roll(toward)));
            let [end, pick] = [end, pick].map(|at| at.rem_euclid(8) as u32);
            assert!(drawdown(&window).get(end, pick), "{layout:?} {toward:?}");
        }
    }
}

#[test]
fn case_11_a_z_twill_is_drawn_as_one_in_every_layout() {
    for layout in LAYOUTS {
        let Some(renderer) = renderer("a Z twill in every layout") else {
            return;
        };
        // One end in four is up, the next one at the next pick: lines rise to the right.
        let z = straight_draw();
        let s = Opened {
            design: {
                let mirrored = z.design.weave().mirrored();
                let design = Design::clone(&z.design);
                let design = design.with_structure(Structure::Pattern(mirrored));
                std::sync::Arc::new(design.expect("a design"))
            },
            ..straight_draw()
        };
        let mut window = open(builder().renderer(renderer), Some(z));
        for (opened, rises_right) in [(straight_draw(), true), (s, false)] {
            let session = Session::of(&opened);
            window.state_mut().take_design(&opened, session);
            window.state_mut().preview.freeze();
            window.run_steps(2);
            run_command(&mut window, Command::Arrange(layout));
            hover(&mut window, Pos2::new(2.0, 2.0));
            let picture = window.render().expect("a picture");
            let size = window.state().draft.cell() as f32;
            let [a, b] = [(0, 0), (7, 7)].map(|cell| place(&window, cell));
            let corner = Pos2::new(a.x.min(b.x), a.y.max(b.y));
            // Column from the left, row from below, as they are seen.
            let red = |column: i32, row: i32| {
                let at = corner + egui::vec2(column as f32, -row as f32) * size;
                let pixel = picture.get_pixel(at.x as u32, at.y as u32).0;
                pixel[0] > pixel[2]
            };
            let along = |step: i32| {
                (0..7)
                    .all(|column| (1..7).all(|row| red(column, row) == red(column + 1, row + step)))
            };
            assert_eq!(
                (along(1), along(-1)),
                (rises_right, !rises_right),
                "{layout:?}"
            );
        }
    }
}

#[test]
fn figured_cloth_lies_as_its_picture_does_and_the_chosen_layout_stays_chosen() {
    let mut window = build(builder(), Some("damask"));
    window.state_mut().preview.freeze();
    window.run_steps(2);
    let arrangement = |window: &Window| window.state().draft.show.arrangement;
    assert_eq!(arrangement(&window), DraftLayout::Jacquard);
    assert!(!window.state().preview.turned);
    assert_eq!(window.state().settings.arrangement, DraftLayout::Us);
    // The next draft is laid out as the person likes it.
    let draft = straight_draw();
    let session = Session::of(&draft);
    window.state_mut().take_design(&draft, session);
    window.run_steps(2);
    assert_eq!(arrangement(&window), DraftLayout::Us);
    assert!(window.state().preview.turned);
    // A drawdown that no shaft loom weaves counts as figured, a small one does not.
    let pattern = |ends: u32| {
        let pattern = WeavePattern::from_fn(ends, ends, |end, pick| end < pick);
        let design = Design::clone(&draft.design).with_structure(Structure::Pattern(pattern));
        Session::unsaved(design.expect("a design"), None)
    };
    assert!(pattern(64).is_figured() && !pattern(16).is_figured());
}
