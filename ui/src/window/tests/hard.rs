//! What must not cost anybody work: a lost device, a stroke that is never ended, a full
//! disk, damaged files.

use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, channel};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use egui::{Event, Key, Modifiers, PointerButton};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use pickglass::design::{
    Design, Family, Srgb, Structure, WeavePattern, Yarn, YarnId, YarnMaps, usual_sett,
};
use pickglass::edit::{Document, recovery};

use super::files::{invert, modified, type_path};
use super::pictures::render_state;
use super::{Window, builder, open, options, says, shows, wait_for};
use crate::opened::Opened;
use crate::window::action::Action;
use crate::window::app::{App, AppOptions};
use crate::window::autosave::{Autosave, RecoveryFolder, Rescued};
use crate::window::layout::Layout;
use crate::window::lost::Restarts;
use crate::window::session::{Session, blank};
use crate::window::settings::{Settings, SettingsFile};

/// A window whose copies are in a folder.
fn start(folder: &Path, design: Option<&str>) -> Window {
    let opened = design.map(|name| Opened::preset(name).expect("a preset"));
    let options = AppOptions {
        recovery: RecoveryFolder::at(folder.to_owned()),
        ..options()
    };
    let mut window: Window =
        builder().build_eframe(|cc| App::new(&cc.egui_ctx, opened, options).expect("a worker"));
    window.state_mut().preview.freeze();
    window.run_steps(2);
    window
}

/// What a thread tells, within a time that no machine needs.
fn told<T>(told: &Receiver<T>) -> T {
    told.recv_timeout(Duration::from_secs(120))
        .expect("an answer")
}

#[test]
fn a_lost_device_has_the_work_written_and_opened_again() {
    let Some(state) = render_state("a lost device") else {
        return;
    };
    let folder = tempfile::tempdir().expect("a folder");
    let mut window = start(folder.path(), Some("oxford"));
    let lost = Arc::new(AtomicBool::new(false));
    let (tell, answer) = channel();
    let then = move |rescued| {
        let _ = tell.send(rescued);
    };
    let watched = Arc::clone(&lost);
    window
        .state_mut()
        .watch(&state.device, watched, Arc::new(then));
    invert(&mut window);
    let document = window.state().document().expect("open");
    let changed = Arc::clone(document.drawdown());
    window.run_steps(10);
    assert!(!lost.load(Ordering::SeqCst) && answer.try_recv().is_err());

    state.device.destroy();
    wait_for(&mut window, "the loss", |_| lost.load(Ordering::SeqCst));
    let Rescued::Copy(copy) = told(&answer) else {
        panic!("no copy")
    };
    let recovered = recovery::load(&copy).expect("whole");
    assert_eq!(recovered.design.weave(), *changed);
    assert_eq!(recovered.lost, None);

    // The next start is on it, though the first window is still there.
    let mut again = start(folder.path(), None);
    let ctx = again.ctx.clone();
    let restarts: Restarts = "1763800000".parse().expect("a time");
    again.state_mut().begin_with(&ctx, Some(copy), &restarts);
    wait_for(&mut again, "the work", |window| {
        shows(window, "Drawdown of Oxford")
    });
    wait_for(&mut again, "the message", |window| {
        says(window, "The graphics device was lost")
    });
    let document = again.state().document().expect("open");
    assert_eq!(*document.drawdown(), changed);
    assert!(modified(&again));
}

#[test]
fn a_rescue_writes_what_is_in_no_file_and_nothing_else() {
    let folder = tempfile::tempdir().expect("a folder");
    let ctx = egui::Context::default();
    let rescue = |folder: RecoveryFolder, session: Option<&Session>| {
        let mut autosave = Autosave::new(&ctx, folder);
        autosave.note(session);
        let (tell, answer) = channel();
        let rescuer = autosave.rescuer().expect("a thread");
        rescuer.rescue(Arc::new(move |rescued| {
            let _ = tell.send(rescued);
        }));
        told(&answer)
    };
    let at = || RecoveryFolder::at(folder.path().to_owned());
    let design = || Design::clone(&blank().expect("a design").design);
    assert_eq!(rescue(at(), None), Rescued::Nothing);

    let file = folder.path().join("cloth.ron");
    let mut session = Session {
        document: Document::new(design()),
        path: Some(file.clone()),
        source: None,
    };
    assert_eq!(rescue(at(), Some(&session)), Rescued::File(file.clone()));
    let copies = || {
        let listing = recovery::list(folder.path());
        listing.found.len() + listing.damaged.len()
    };
    assert_eq!(copies(), 0);
    // Once changed, the file is not all of it.
    let edit = pickglass::edit::Edit::Rename("other".to_owned());
    session.document.apply(edit).expect("an edit");
    let Rescued::Copy(copy) = rescue(at(), Some(&session)) else {
        panic!("no copy")
    };
    let recovered = recovery::load(&copy).expect("whole").design;
    assert_eq!(&recovered, session.document.design().as_ref());
    let known = recovery::describe(&copy).expect("a head");
    assert_eq!(known.original, Some(file));

    // Where nothing can be written, that is said.
    let blocked = folder.path().join("blocked");
    std::fs::write(&blocked, b"").expect("written");
    for nowhere in [RecoveryFolder::at(blocked), RecoveryFolder::default()] {
        let rescued = rescue(nowhere, Some(&session));
        assert!(matches!(rescued, Rescued::Failed(_)), "{rescued:?}");
    }
}

#[test]
fn a_window_that_breaks_leaves_all_of_the_work() {
    for breaks in [false, true] {
        let folder = tempfile::tempdir().expect("a folder");
        let copies = RecoveryFolder::at(folder.path().to_owned());
        let design = Design::clone(&blank().expect("a design").design);
        let session = Session::unsaved(design, None);
        let work = session.design();
        let window = std::thread::spawn(move || {
            let autosave = Autosave::new(&egui::Context::default(), copies);
            autosave.note(Some(&session));
            if breaks {
                // As a panic, without its message.
                std::panic::resume_unwind(Box::new("broken"));
            }
            drop(autosave);
        });
        assert_eq!(window.join().is_err(), breaks);
        let found = recovery::list(folder.path()).found;
        assert_eq!(found.len(), usize::from(breaks));
        for copy in found {
            let recovered = recovery::load(&copy.path).expect("whole");
            assert_eq!(&recovered.design, work.as_ref());
        }
    }
}

#[test]
fn a_stroke_that_is_never_ended_is_copied_all_the_same() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut window = start(folder.path(), Some("damask"));
    window.state_mut().autosave.without_waiting();
    let up = |window: &Window| {
        let document = window.state().document().expect("open");
        document.drawdown().get(2, 2)
    };
    let before = up(&window);
    let button = if before {
        PointerButton::Secondary
    } else {
        PointerButton::Primary
    };
    let at = window.state().draft.place_of((2, 2));
    window.event(Event::PointerMoved(at));
    window.step();
    window.event(Event::PointerButton {
        pos: at,
        button,
        pressed: true,
        modifiers: Modifiers::NONE,
    });
    window.run_steps(2);
    assert_ne!(up(&window), before);
    let copied = |folder: &Path| {
        let entries = std::fs::read_dir(folder).expect("a folder").flatten();
        let mut paths = entries.map(|entry| entry.path());
        let copy = paths.find(|path| path.extension().is_some_and(|is| is == "recovery"))?;
        Some(recovery::load(&copy).expect("whole").design)
    };
    wait_for(&mut window, "the copy", |_| copied(folder.path()).is_some());
    let document = window.state().document().expect("open");
    assert!(document.in_gesture(), "the button is still down");
    let copy = copied(folder.path()).expect("a copy");
    assert_eq!(copy.weave(), **document.drawdown());
}

/// A weave that no coding makes small.
fn noise() -> Opened {
    let weave = WeavePattern::from_fn(640, 640, |end, pick| {
        let mixed = (end ^ pick.rotate_left(16)).wrapping_mul(0x9e37_79b9);
        (mixed ^ mixed >> 15).wrapping_mul(0x85eb_ca6b) >> 31 == 1
    });
    let yarns = vec![
        Yarn::new("navy", Family::Cotton, Srgb(38, 52, 94)),
        Yarn::new("cream", Family::Cotton, Srgb(236, 226, 203)),
    ];
    let maps = YarnMaps::plain(YarnId(0), YarnId(1));
    let sett = usual_sett(&yarns, &maps);
    let design = Design::new("noise", Structure::Pattern(weave), yarns, maps, sett);
    Opened {
        design: Arc::new(design.expect("a design")),
        warnings: Vec::new(),
        path: None,
    }
}

/// The full name of a test of this file.
fn name_of(test: &str) -> String {
    let module = module_path!().split_once("::").map_or("", |(_, path)| path);
    format!("{module}::{test}")
}

#[cfg(unix)]
#[test]
fn a_full_disk_at_save_keeps_the_old_file_and_says_so() {
    const FOLDER: &str = "PICKGLASS_TEST_FULL_DISK";
    if let Some(folder) = std::env::var_os(FOLDER) {
        return save_on_a_full_disk(Path::new(&folder));
    }
    // No file may grow beyond 16 kB in a process of its own.
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("mine.ron");
    std::fs::write(&path, "kept").expect("written");
    let test = name_of("a_full_disk_at_save_keeps_the_old_file_and_says_so");
    let output = std::process::Command::new("sh")
        .args(["-c", "trap '' XFSZ; ulimit -f 32; exec \"$0\" \"$@\""])
        .arg(std::env::current_exe().expect("a program"))
        .args(["--exact", test.as_str(), "--nocapture"])
        .env(FOLDER, folder.path())
        .output()
        .expect("a shell starts");
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    let errors = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{said}{errors}");
    assert!(said.contains("1 passed"), "the test was not found: {said}");
    assert_eq!(std::fs::read(&path).expect("read"), b"kept");
    let left = std::fs::read_dir(folder.path()).expect("a folder").count();
    assert_eq!(left, 1, "half a file was left");
}

#[cfg(unix)]
fn save_on_a_full_disk(folder: &Path) {
    let path = folder.join("mine.ron");
    let mut window = open(builder(), Some(noise()));
    window.state_mut().preview.freeze();
    window.run_steps(2);
    invert(&mut window);
    window.key_press_modifiers(Modifiers::COMMAND, Key::S);
    type_path(&mut window, &path.display().to_string(), "Save");
    wait_for(&mut window, "the warning", |window| {
        shows(window, "Write over it")
    });
    window.get_by_label("Write over it").click();
    wait_for(&mut window, "the message", |window| says(window, "Error"));
    assert!(says(&window, "mine.ron"));
    assert!(says(&window, "The earlier file is as it was"));
    assert!(modified(&window) && shows(&window, "Drawdown of noise"));
}

#[test]
fn a_damaged_settings_file_never_stops_the_start() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("window.ron");
    let file = SettingsFile::at(path.clone());
    let settings = Settings {
        layout: Some(Layout::default().kept()),
        recent: vec!["/designs/a.ron".into(), "/designs/b.wif".into()],
        mm_per_point: Some(0.2),
        ..Settings::default()
    };
    file.write(&settings).expect("written");
    let whole = std::fs::read_to_string(&path).expect("read");
    let mut harness = Harness::builder().with_size([960.0, 640.0]).build_ui_state(
        |ui, layout: &mut Layout| {
            layout.show(ui, &mut |ui, pane| {
                ui.label(pane.title());
            });
        },
        Layout::default(),
    );
    let (mut damaged, mut taken) = (0, 0);
    let mut read = |bytes: &[u8]| {
        std::fs::write(&path, bytes).expect("written");
        let (mut settings, wrong) = file.read();
        match wrong {
            Some(line) => {
                assert!(line.contains("damaged") && !line.contains('\n'), "{line}");
                damaged += 1;
            }
            // What can be read can be shown.
            None => {
                *harness.state_mut() = Layout::from_kept(settings.layout.take());
                harness.step();
                taken += 1;
            }
        }
    };
    read(whole.as_bytes());
    for length in 0..whole.trim_end().len() {
        read(&whole.as_bytes()[..length]);
    }
    for place in 0..whole.len() {
        let mut flipped = whole.clone().into_bytes();
        flipped[place] ^= 1 << (place % 8);
        read(&flipped);
    }
    for share in ["-1.0", "0.0", "inf", "NaN", "1e38"] {
        let hostile = whole.replace("0.7", share);
        assert_ne!(hostile, whole);
        read(hostile.as_bytes());
    }
    read("(".repeat(100_000).as_bytes());
    read(&[0xff; 9]);
    // Every cut is noticed, and some flips change a value only.
    assert!(
        damaged >= whole.trim_end().len() && taken > 1,
        "{damaged} {taken}"
    );
}

#[test]
fn the_window_starts_beside_damaged_files_and_says_so() {
    let folder = tempfile::tempdir().expect("a folder");
    let copy = folder.path().join("design-x.recovery");
    std::fs::write(&copy, b"pickglass recovery 1\n and then nothing").expect("written");
    let settings = folder.path().join("window.ron");
    std::fs::write(&settings, "(light: maybe").expect("written");
    let options = AppOptions {
        recovery: RecoveryFolder::at(folder.path().to_owned()),
        settings: SettingsFile::at(settings),
        ..options()
    };
    let mut window: Window =
        builder().build_eframe(|cc| App::new(&cc.egui_ctx, None, options).expect("a worker"));
    wait_for(&mut window, "both messages", |window| {
        says(window, "the settings are damaged") && says(window, "design-x.recovery")
    });
    assert!(shows(&window, "New"));
    // Being told to open it is no different.
    let ctx = window.ctx.clone();
    window
        .state_mut()
        .begin_with(&ctx, Some(copy), &Restarts::default());
    window.run_steps(3);
    assert!(says(&window, "Error") && window.state().document().is_none());
}

#[test]
fn the_scale_of_the_screen_is_kept() {
    let folder = tempfile::tempdir().expect("a folder");
    let settings = SettingsFile::at(folder.path().join("window.ron"));
    let start = || -> Window {
        let options = AppOptions {
            settings: settings.clone(),
            ..options()
        };
        builder().build_eframe(|cc| App::new(&cc.egui_ctx, None, options).expect("a worker"))
    };
    let mut window = start();
    let usual = window.state().preview.mm_per_point;
    let ctx = window.ctx.clone();
    let found = vec![Action::Calibrated(0.2)];
    window.state_mut().act(&ctx, found);
    drop(window);
    let kept = start().state().preview.mm_per_point;
    assert!((kept - 0.2).abs() < 1e-6 && (usual - kept).abs() > 1e-3);
    // A scale that no screen has is not taken.
    for nonsense in [f32::NAN, f32::INFINITY, -0.2, 0.0, 1e-30, 4.0] {
        let wrong = Settings {
            mm_per_point: Some(nonsense),
            ..Settings::default()
        };
        settings.write(&wrong).expect("written");
        let taken = start().state().preview.mm_per_point;
        assert!((taken - usual).abs() < 1e-9, "{nonsense} {taken}");
    }
}

#[test]
fn whoever_asks_for_a_rescue_after_the_end_waits_for_nothing() {
    let ctx = egui::Context::default();
    let mut autosave = Autosave::new(&ctx, RecoveryFolder::default());
    let rescuer = autosave.rescuer().expect("a thread");
    autosave.finish();
    let called = Arc::new(Mutex::new(false));
    let told = Arc::clone(&called);
    rescuer.rescue(Arc::new(move |_| {
        if let Ok(mut told) = told.lock() {
            *told = true;
        }
    }));
    drop(autosave);
    assert!(called.lock().is_ok_and(|called| !*called));
}
