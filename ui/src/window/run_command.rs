//! What the commands of menus, keys and palette do.

use egui::ViewportCommand;
use pickglass::edit::Edit;
use pickglass::engine::LightChoice;

use super::app::App;
use super::asking::Next;
use super::cloth::sheet::Kind as SheetKind;
use super::machine_check::MachineCheck;
use super::panes::Pane;
use super::settings_form::SettingsForm;
use crate::command_table::{Command, Switch, ZoomCommand};

impl App {
    /// Lights the cloth by a preset.
    pub(super) fn set_light(&mut self, preset: &str) {
        self.preview.light = LightChoice::Preset(preset.to_owned());
    }

    /// Does a command.
    pub(super) fn run_command(&mut self, ctx: &egui::Context, command: Command) {
        if !self.situation().allows(command) {
            return;
        }
        match command {
            Command::New => self.leave_for(ctx, Next::New),
            Command::Open => self.leave_for(ctx, Next::Ask),
            Command::OpenPath => self.leave_for(ctx, Next::AskPath),
            Command::Start => self.leave_for(ctx, Next::Start),
            Command::Save => self.save(ctx, false),
            Command::SaveAs => self.save(ctx, true),
            Command::ExportStill => {
                if let (Some(session), Some(asked)) = (&self.session, self.preview.asked()) {
                    self.export.source = session.source.clone().or_else(|| session.path.clone());
                    let measured = self.preview.pane.measured();
                    self.export.ask(session.design(), asked.clone(), measured);
                }
            }
            Command::ExportVolume => {
                if let Some(session) = &self.session {
                    let selected = (self.draft.selection())
                        .map(|rect| [rect.end, rect.pick, rect.ends, rect.picks]);
                    let path = session.file_name("vdb");
                    let shown = self.preview.asked().cloned().unwrap_or_default();
                    self.volume.source = session.source.clone().or_else(|| session.path.clone());
                    self.volume.ask(session.design(), shown, selected, path);
                }
            }
            Command::ExportDraft => {
                if let Some(session) = &self.session {
                    let proposed = session.file_name("wif");
                    self.files.ask_export(ctx, proposed);
                }
            }
            Command::Print => {
                if let Some(session) = &self.session {
                    let proposed = session.file_name("pdf");
                    self.files.ask_print(ctx, proposed);
                }
            }
            // The close is asked about where every other close is.
            Command::Quit => ctx.send_viewport_cmd(ViewportCommand::Close),
            Command::Undo => self.step_back(),
            Command::Redo => self.rework(|session| session.document.redo()),
            Command::Theme => {
                let theme = match ctx.theme() {
                    egui::Theme::Dark => egui::Theme::Light,
                    egui::Theme::Light => egui::Theme::Dark,
                };
                ctx.set_theme(theme);
            }
            Command::Palette => self.palette.open(),
            Command::Settings => self.settings_form = Some(SettingsForm::new(&self.store)),
            Command::Shortcuts => self.show_shortcuts = true,
            Command::MachineCheck => self.machine_check = Some(MachineCheck::start(ctx)),
            Command::Show(pane) => self.layout.bring(pane),
            Command::ResetLayout => self.layout.reset(),
            Command::NextPane => {
                if self.draft.has_focus(ctx) {
                    self.preview.focus(ctx);
                } else {
                    self.draft.focus(ctx);
                }
            }
            Command::Zoom(command) if self.preview.in_use() => self.preview.zoom_as(command),
            Command::Zoom(command) => self.draft.zoom_as(command),
            Command::Cloth(command) => self.preview.run_command(command),
            Command::Switch(switch) => self.switch(switch),
            Command::Weave(command) => self.weave(ctx, command),
            Command::Arrange(arrangement) => {
                self.draft.show.arrangement = arrangement;
                self.settings.arrangement = arrangement;
                self.draft.zoom_as(ZoomCommand::Fit);
            }
            Command::Reference => self.files.ask_reference(ctx),
            Command::NextColourway => self.colourway_beside(1),
            Command::PreviousColourway => self.colourway_beside(-1),
            Command::Colourway(place) => self.use_colourway(usize::from(place) - 1),
            Command::ContactSheet => self.show_sheet(SheetKind::All),
            Command::SideBySide => self.show_sheet(SheetKind::Two),
            Command::Use(tool) => self.draft.take_tool(ctx, tool),
            Command::Glass => self.preview.pin_glass(),
            Command::SwapColours => {
                self.draft.yarns.swap(0, 1);
                self.draft.regions.swap(0, 1);
            }
        }
    }

    /// Weaves in the colourway so many places further by name, round the list.
    fn colourway_beside(&mut self, by: isize) {
        let Some(session) = &self.session else {
            return;
        };
        let order = session.document.design().colourway_order();
        let own = order.iter().position(|(_, place)| place.is_none());
        let at = own.unwrap_or(0) as isize + by;
        self.use_colourway(at.rem_euclid(order.len().max(1) as isize) as usize);
    }

    /// Weaves in the colourway of this place by name, from 0.
    fn use_colourway(&mut self, place: usize) {
        let Some(session) = &self.session else {
            return;
        };
        let order = session.document.design().colourway_order();
        if let Some((_, Some(colourway))) = order.get(place) {
            self.edit(Edit::UseColourway(*colourway));
        }
    }

    /// Shows the colourways in the cloth view, or the cloth alone again.
    fn show_sheet(&mut self, kind: SheetKind) {
        self.preview.toggle_sheet(kind);
        self.layout.bring(Pane::Cloth);
    }

    pub(super) fn step_back(&mut self) {
        self.draft.give_up();
        self.rework(|session| session.document.undo());
    }

    /// Turns something on that was off, or off.
    fn switch(&mut self, switch: Switch) {
        let (show, symmetry) = (&mut self.draft.show, &mut self.draft.symmetry);
        let reference = self.draft.reference.as_mut();
        let flag = match switch {
            Switch::Structure => &mut show.structure_alone,
            Switch::GridLines => &mut show.grid_lines,
            Switch::LongFloats => &mut show.long_floats,
            Switch::Ghosts => &mut show.ghosts,
            Switch::Navigator => &mut show.navigator,
            Switch::SymmetryAcross => &mut symmetry[0],
            Switch::SymmetryAlong => &mut symmetry[1],
            Switch::SymmetrySteps => &mut self.draft.steps.on,
            Switch::ReferenceShown => match reference {
                Some(reference) => &mut reference.shown,
                None => return,
            },
            Switch::ReferenceFit => match reference {
                Some(reference) => &mut reference.window_open,
                None => return,
            },
        };
        *flag = !*flag;
    }
}
