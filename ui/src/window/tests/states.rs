//! Every state of the window that a person may meet, drawn at both sizes and in both
//! themes. Where `PICKGLASS_PICTURES` names a folder, the pictures are kept there, for
//! somebody to look at.

use std::path::{Path, PathBuf};

use egui_kittest::kittest::Queryable;
use pickglass::edit::recovery::Found;
use pickglass::edit::{Cells, Edit};

use super::files::type_path;
use super::opening::open_by_path;
use super::pictures::renderer;
use super::{Window, builder, open, says, wait_for};
use crate::command_table::{ClothCommand, Command, DraftLayout, Switch, WeaveCommand};
use crate::opened::Opened;
use crate::window::Pane;
use crate::window::session::blank;
use crate::window::toasts::Grade;

/// What a person does to get into a state.
type Way = fn(&mut Window, &Path);

/// By name: what is open (`None` = nothing, `""` = a new design), and what is done then.
const STATES: [(&str, Option<&str>, Way); 30] = [
    ("start", None, |window, _| {
        wait_for(window, "the thumbnails", |window| {
            window.state().start.is_drawn()
        });
    }),
    ("start with work", None, |window, folder| {
        let app = window.state_mut();
        app.settings.recent = vec![folder.join("shawl.wif"), PathBuf::from("/gone/scarf.ron")];
        let time = std::time::SystemTime::now() - std::time::Duration::from_secs(4000);
        app.autosave.found = vec![Found {
            path: folder.join("copy.recovery"),
            name: "Overshot honeysuckle".to_owned(),
            original: Some(folder.join("honeysuckle.ron")),
            time,
        }];
    }),
    ("blank", Some(""), |_, _| {}),
    ("blank scandinavian", Some(""), |window, _| {
        run_command(window, Command::Arrange(DraftLayout::Scandinavian));
        run_command(window, Command::Switch(Switch::LongFloats));
    }),
    ("draft", Some("default"), |window, _| {
        run_command(window, Command::Switch(Switch::Navigator));
    }),
    ("structure", Some("herringbone"), |window, _| {
        run_command(window, Command::Switch(Switch::Structure));
        run_command(window, Command::Weave(WeaveCommand::SelectAll));
    }),
    ("jacquard", Some("damask"), |window, _| {
        run_command(window, Command::Switch(Switch::Navigator));
    }),
    ("palette", Some("oxford"), |window, _| {
        run_command(window, Command::Palette);
    }),
    ("shortcuts", Some("oxford"), |window, _| {
        run_command(window, Command::Shortcuts);
    }),
    ("repeat", Some("oxford"), |window, _| {
        run_command(window, Command::Weave(WeaveCommand::Repeat));
    }),
    ("resize", Some("oxford"), |window, _| {
        run_command(window, Command::Weave(WeaveCommand::Resize));
    }),
    ("loom", Some(""), |window, _| {
        run_command(window, Command::Weave(WeaveCommand::Loom));
    }),
    ("words", Some("oxford"), |window, _| {
        run_command(window, Command::Weave(WeaveCommand::Words));
    }),
    ("stamp", Some("oxford"), |window, _| {
        run_command(window, Command::Weave(WeaveCommand::StampWeave));
    }),
    ("unsaved", Some("oxford"), |window, _| {
        run_command(window, Command::Weave(WeaveCommand::Invert));
        run_command(window, Command::New);
    }),
    ("refused", Some(""), |window, _| {
        let cells = Cells::of(16, 16, [(0, 0), (1, 0)]);
        window.state_mut().edit(Edit::Flip(cells));
    }),
    ("still", Some("oxford"), |window, _| {
        run_command(window, Command::ExportStill);
    }),
    ("volume", Some("oxford"), |window, _| {
        run_command(window, Command::ExportVolume);
    }),
    ("settings", Some("oxford"), |window, _| {
        run_command(window, Command::Settings);
    }),
    ("path with a mistake", Some("oxford"), |window, _| {
        open_by_path(window, "/absent/folder/of/a/weaver/shawl.wif");
        wait_for(window, "what is wrong", |window| says(window, "Error: "));
    }),
    ("print", Some("oxford"), |window, _| {
        run_command(window, Command::Print);
    }),
    ("draft as image", Some("oxford"), |window, folder| {
        run_command(window, Command::ExportDraft);
        let path = folder.join("oxford.png");
        type_path(window, &path.display().to_string(), "Export");
    }),
    ("import", Some("oxford"), |window, folder| {
        let path = folder.join("point paper.png");
        let image = image::GrayImage::from_fn(24, 16, |x, y| {
            image::Luma([if (x + y) % 8 < 3 || x % 6 == y % 5 {
                0
            } else {
                255
            }])
        });
        image.save(&path).expect("written");
        open_by_path(window, &path.display().to_string());
        wait_for(window, "the preview", |window| says(window, "24 ends × 16"));
    }),
    ("messages", Some("oxford"), |window, _| {
        let app = window.state_mut();
        app.say(Grade::Done, "Wrote /home/w/shawl.png", "");
        let (what, kept) = (
            "/home/w/shawl.ron: no room is left on the disk: free some, or save elsewhere.",
            "The file is as it was.",
        );
        app.say(Grade::Warning, "The draft repeats after 4 picks.", "");
        app.say(Grade::Error, what, kept);
        app.layout.bring(Pane::Log);
    }),
    ("posterise", Some("oxford"), |window, folder| {
        let path = folder.join("picture.png");
        let image = image::RgbImage::from_fn(96, 64, |x, y| {
            image::Rgb([(2 * x) as u8, (3 * y) as u8, ((x * y) % 251) as u8])
        });
        image.save(&path).expect("written");
        let ctx = window.ctx.clone();
        let app = window.state_mut();
        app.panes.read_picture(&ctx, &path);
        app.layout.bring(Pane::Posterise);
        wait_for(window, "the map", |window| {
            says(window, "Make it the design")
        });
    }),
    ("yarns", Some("tweed"), |window, _| {
        run_command(window, Command::Show(Pane::Yarns));
        let first = {
            let document = window.state().document().expect("open");
            document.design().yarns()[0].name.clone()
        };
        let named = window.get_all_by_label(&first);
        named.last().expect("its name").click();
    }),
    ("regions", Some("twill-satin"), |window, _| {
        run_command(window, Command::Show(Pane::Posterise));
    }),
    ("cloth", Some("oxford"), |window, _| {
        draw_cloth(window);
    }),
    ("compared", Some("oxford"), |window, _| {
        draw_cloth(window);
        window.get_by_label("Keep").click();
        window.run_steps(2);
        run_command(window, Command::Cloth(ClothCommand::TurnOver));
        window.run_steps(3);
    }),
    ("contact sheet", Some("herringbone"), |window, _| {
        window.state_mut().preview.pause();
        run_command(window, Command::ContactSheet);
        wait_for(window, "the colourways", |window| {
            window.state().preview.sheet_is_drawn()
        });
    }),
];

fn run_command(window: &mut Window, command: Command) {
    let ctx = window.ctx.clone();
    window.state_mut().run_command(&ctx, command);
    window.run_steps(3);
}

/// Has the cloth drawn, once.
fn draw_cloth(window: &mut Window) {
    if window.state().preview.paused {
        run_command(window, Command::Cloth(ClothCommand::Pause));
    }
    wait_for(window, "the cloth", |window| {
        window.state().preview.pane.shown.is_some()
    });
    window.state_mut().preview.pause();
}

#[test]
fn every_state_draws_itself_at_every_size_in_both_themes() {
    let keep = std::env::var_os("PICKGLASS_PICTURES").map(PathBuf::from);
    let folder = tempfile::tempdir().expect("a folder");
    for (place, (theme, word)) in [(egui::Theme::Dark, "dark"), (egui::Theme::Light, "light")]
        .into_iter()
        .enumerate()
    {
        for (which, size) in [[1024.0, 640.0], [2560.0, 1440.0]].into_iter().enumerate() {
            for (number, (name, design, way)) in STATES.into_iter().enumerate() {
                // Nobody looks: each is drawn in one of the four ways at least.
                if keep.is_none() && number % 4 != 2 * place + which {
                    continue;
                }
                let Some(renderer) = renderer("pictures of states") else {
                    return;
                };
                let builder = builder()
                    .with_size(size)
                    .with_theme(theme)
                    .renderer(renderer);
                let opened = match design {
                    Some("") => Some(blank().expect("a design")),
                    Some(preset) => Some(Opened::preset(preset).expect("a preset")),
                    None => None,
                };
                let mut window = open(builder, opened);
                window.state_mut().preview.freeze();
                window.run_steps(5);
                way(&mut window, folder.path());
                // Thumbnails and the navigator are drawn on threads.
                std::thread::sleep(std::time::Duration::from_millis(300));
                window.run_steps(5);
                let picture = window.render().expect("a picture");
                let first = picture.get_pixel(2, 2);
                let other = picture.pixels().filter(|pixel| *pixel != first).count();
                assert!(other > 10_000, "{name} {word}: nothing is drawn");
                if let Some(keep) = &keep {
                    let file = format!("{name} {word} {}.png", size[0]);
                    let _ = picture.save(keep.join(file));
                }
            }
        }
    }
}
