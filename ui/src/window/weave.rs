//! The commands that change the weave, and those of the clipboard.

use pickglass::design::{Direction, WeavePattern};
use pickglass::edit::{Cells, Clip, Edit, Rect};

use super::app::App;
use super::forms::Form;
use crate::command_table::{DraftLayout, Tool, Toward, WeaveCommand};

impl App {
    /// Commands that change the weave, and those of the clipboard.
    pub(super) fn weave(&mut self, ctx: &egui::Context, command: WeaveCommand) {
        let Some(session) = &self.session else {
            return;
        };
        let document = &session.document;
        let design = document.design();
        let (ends, picks) = (design.ends(), design.picks());
        let selection = self.draft.selection();
        let selected = selection.map(|rect| Cells::of_rect(ends, picks, rect));
        use WeaveCommand as Do;
        let edit = match command {
            Do::SelectAll => {
                let (end, pick) = (0, 0);
                self.draft.select(Some(Rect {
                    end,
                    pick,
                    ends,
                    picks,
                }));
                return;
            }
            Do::Deselect => {
                self.draft.select(None);
                return;
            }
            Do::Copy | Do::Cut => {
                let clip = selected
                    .as_ref()
                    .and_then(|cells| Clip::copy(document, cells));
                let Some(clip) = clip else { return };
                ctx.copy_text(clip_text(clip.weave()));
                self.draft.copy(clip);
                match (command, selected) {
                    (Do::Cut, Some(cells)) => Edit::Paint {
                        cells,
                        warp_up: false,
                    },
                    _ => return,
                }
            }
            Do::Paste => {
                self.paste(ctx);
                return;
            }
            Do::Clear => match selected {
                Some(cells) => Edit::Paint {
                    cells,
                    warp_up: false,
                },
                None => return,
            },
            Do::Invert => match selected {
                Some(cells) => Edit::Flip(cells),
                None => Edit::Invert,
            },
            Do::MirrorAcross => Edit::Mirror(Direction::Warp),
            Do::MirrorAlong => Edit::Mirror(Direction::Weft),
            Do::TurnHalf => Edit::Rotate(2),
            Do::TurnQuarter => Edit::Rotate(1),
            Do::Roll(toward) => {
                // As it is seen: of a turned cloth the next end lies at the left.
                let way = if self.draft.turned() { -1 } else { 1 };
                let (ends, picks) = match toward {
                    Toward::Left => (-way, 0),
                    Toward::Right => (way, 0),
                    Toward::Up => (0, way),
                    Toward::Down => (0, -way),
                };
                Edit::Roll { ends, picks }
            }
            Do::Resize => return self.asking.fill_in(Form::size(design)),
            Do::Repeat => return self.asking.fill_in(Form::repeat(design)),
            Do::StampWeave => {
                return self.asking.fill_in(Form::Stamp("2/2 twill".to_owned()));
            }
            Do::FillSelection => match (selected, selection, self.draft.clip()) {
                (Some(cells), Some(rect), Some(clip)) => {
                    clip.stamp(cells, (rect.end.into(), rect.pick.into()))
                }
                _ => {
                    let what = "Select crossings (S), and copy or choose a weave to fill with.";
                    return self.warn(what, "The design is as it was.");
                }
            },
            Do::Words => return self.asking.fill_in(Form::words(design)),
            Do::Loom => {
                match Form::loom(design) {
                    Some(form) => self.asking.fill_in(form),
                    None => self.warn(
                        "This design has no shafts: derive the draft first.",
                        "The design is as it was.",
                    ),
                }
                return;
            }
            Do::CropToSelection => match selection {
                Some(rect) => Edit::Crop(rect),
                None => return,
            },
            Do::Repeat2 => Edit::Tile {
                across: 2,
                along: 2,
            },
            Do::RepeatMore => return self.asking.fill_in(Form::Tile([2, 2])),
            Do::ClearCorrections => {
                Edit::ClearCorrections(selected.unwrap_or_else(|| Cells::all(ends, picks)))
            }
            Do::DeriveDraft => {
                if self.draft.show.arrangement == DraftLayout::Jacquard {
                    self.draft.show.arrangement = match self.settings.arrangement {
                        DraftLayout::Jacquard => DraftLayout::Us,
                        chosen => chosen,
                    };
                }
                Edit::DeriveDraft { after: None }
            }
            Do::BecomeJacquard => Edit::BecomeJacquard { then: None },
        };
        self.edit(edit);
    }

    /// Takes the stamp in hand: what was copied here, or a weave that another program put
    /// into the clipboard as text.
    pub(super) fn paste(&mut self, ctx: &egui::Context) {
        let text = ctx.input(|input| {
            input.events.iter().find_map(|event| match event {
                egui::Event::Paste(text) => Some(text.clone()),
                _ => None,
            })
        });
        let own = self.draft.clip().map(|clip| clip_text(clip.weave()));
        if let Some(text) = text.filter(|text| Some(text.trim()) != own.as_deref().map(str::trim))
            && let Ok(weave) = WeavePattern::parse(&text)
        {
            self.draft.copy(Clip::of_weave(&weave));
        }
        if self.draft.clip().is_none() {
            self.warn(
                "Nothing was copied: select crossings (S) and copy them.",
                "",
            );
            return;
        }
        self.draft.take_tool(ctx, Tool::Stamp);
    }
}

/// A weave as text, for other programs: `#` = warp up, the last line is pick 0. What is too
/// large for a text is named instead.
fn clip_text(weave: &WeavePattern) -> String {
    const MOST: u64 = 1 << 18;
    let (ends, picks) = (weave.ends(), weave.picks());
    if u64::from(ends) * u64::from(picks) > MOST {
        return format!("{ends} × {picks} crossings");
    }
    weave.to_string()
}
