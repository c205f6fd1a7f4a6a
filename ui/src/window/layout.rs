//! Where the panes lie: the draft and the cloth side by side, tabs below them; what the
//! person moved is kept in the settings, and a layout that is not whole is not taken.

use std::collections::HashSet;

use egui::{Id, Ui, WidgetText};
use egui_tiles::{Behavior, Container, Linear, LinearDir, Tile, TileId, Tiles, Tree, UiResponse};
use serde::{Deserialize, Serialize};

use super::panes::Pane;
use super::{dividers, focus};
use crate::tokens;

/// Raised whenever the panes change so that an older layout would mislead.
const VERSION: u32 = 1;
/// The most tiles a kept layout may have: far more than any person makes.
const MOST_TILES: usize = 64;
/// Shares of the height for the views and for the tabs below them.
const SHARES: [f32; 2] = [0.7, 0.3];

/// A layout as it is written into the settings.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct KeptLayout {
    version: u32,
    tree: Tree<Pane>,
}

/// The layout in use.
pub struct Layout {
    tree: Tree<Pane>,
}

impl Default for Layout {
    fn default() -> Self {
        Self { tree: usual() }
    }
}

impl Layout {
    /// The kept layout, or the usual one where that is of another version or not whole.
    pub fn from_kept(kept: Option<KeptLayout>) -> Self {
        match kept {
            Some(mut kept) if kept.version == VERSION && whole(&kept.tree) => {
                kept.tree.set_height(f32::INFINITY);
                kept.tree.set_width(f32::INFINITY);
                Self { tree: kept.tree }
            }
            _ => Self::default(),
        }
    }

    /// What to write into the settings.
    pub fn kept(&self) -> KeptLayout {
        KeptLayout {
            version: VERSION,
            tree: self.tree.clone(),
        }
    }

    /// Back to the usual layout.
    pub fn reset(&mut self) {
        self.tree = usual();
    }

    /// Brings a pane to the front of its tabs.
    pub fn bring(&mut self, pane: Pane) {
        self.tree
            .make_active(|_, tile| matches!(tile, Tile::Pane(found) if *found == pane));
    }

    /// Lays the panes out and shows each by `show`.
    pub fn show(&mut self, ui: &mut Ui, show: &mut dyn FnMut(&mut Ui, Pane)) {
        self.tree.ui(&mut Shown { show }, ui);
        dividers::show(ui, &mut self.tree);
    }
}

/// The usual layout.
fn usual() -> Tree<Pane> {
    let mut tiles = Tiles::default();
    let [draft, cloth] = [Pane::Draft, Pane::Cloth].map(|pane| tiles.insert_pane(pane));
    let views = tiles.insert_horizontal_tile(vec![draft, cloth]);
    let below: Vec<TileId> = (Pane::ALL.into_iter())
        .filter(|pane| !matches!(pane, Pane::Draft | Pane::Cloth))
        .map(|pane| tiles.insert_pane(pane))
        .collect();
    let tabs = tiles.insert_tab_tile(below);
    let mut column = Linear::new(LinearDir::Vertical, vec![views, tabs]);
    column.shares.set_share(views, SHARES[0]);
    column.shares.set_share(tabs, SHARES[1]);
    let root = tiles.insert_container(Container::Linear(column));
    Tree::new(Id::unique("panes"), root, tiles)
}

/// Whether every pane is there once, under one root, and nothing else is.
fn whole(tree: &Tree<Pane>) -> bool {
    let mut found = Vec::new();
    let mut seen = HashSet::new();
    let mut next: Vec<TileId> = tree.root.into_iter().collect();
    while let Some(id) = next.pop() {
        // A tile met twice is a loop, or a tile with two parents; a hidden one is lost.
        if !seen.insert(id) || seen.len() > MOST_TILES || !tree.is_visible(id) {
            return false;
        }
        match tree.tiles.get(id) {
            Some(Tile::Pane(pane)) => found.push(*pane),
            Some(Tile::Container(container)) if sound(container) => {
                next.extend(container.children_vec());
            }
            Some(Tile::Container(_)) => return false,
            None => return false,
        }
    }
    found.len() == Pane::ALL.len() && Pane::ALL.iter().all(|pane| found.contains(pane))
}

/// Whether every part of a container has some room.
fn sound(container: &Container) -> bool {
    let some = |share: &f32| (1e-6..=1e6).contains(share);
    match container {
        Container::Linear(linear) => linear.shares.iter().all(|(_, share)| some(share)),
        Container::Grid(grid) => grid.col_shares.iter().chain(&grid.row_shares).all(some),
        Container::Tabs(_) => true,
    }
}

struct Shown<'s> {
    show: &'s mut dyn FnMut(&mut Ui, Pane),
}

impl Behavior<Pane> for Shown<'_> {
    fn pane_ui(&mut self, ui: &mut Ui, _tile: TileId, pane: &mut Pane) -> UiResponse {
        (self.show)(ui, *pane);
        UiResponse::None
    }

    fn tab_title_for_pane(&mut self, pane: &Pane) -> WidgetText {
        pane.title().into()
    }

    fn on_tab_button(
        &mut self,
        _tiles: &mut Tiles<Pane>,
        _tile: TileId,
        tab: egui::Response,
    ) -> egui::Response {
        if tab.has_focus() {
            let painter = tab.ctx.layer_painter(tab.layer_id);
            focus::ring(&painter, tab.rect, &tokens::Palette::of(tab.ctx.theme()));
        }
        tab
    }

    fn tab_outline_stroke(
        &self,
        visuals: &egui::Visuals,
        _tiles: &Tiles<Pane>,
        _tile: TileId,
        state: &egui_tiles::TabState,
    ) -> egui::Stroke {
        match state.active {
            true => visuals.widgets.noninteractive.bg_stroke,
            false => egui::Stroke::NONE,
        }
    }

    fn gap_width(&self, _style: &egui::Style) -> f32 {
        tokens::GRID
    }

    /// Panes by their tabs. What would move all tabs at once lies behind them, without a
    /// name, where Tab comes to it.
    fn is_tile_draggable(&self, tiles: &Tiles<Pane>, tile: TileId) -> bool {
        matches!(tiles.get(tile), Some(Tile::Pane(_)))
    }

    /// By dividers of our own, which have names and hear keys.
    fn is_container_resizable(&self, _tiles: &Tiles<Pane>, _tile: TileId) -> bool {
        false
    }

    fn min_size(&self) -> f32 {
        tokens::SMALLEST_PANE
    }

    fn tab_bar_height(&self, _style: &egui::Style) -> f32 {
        7.0 * tokens::GRID
    }

    fn simplification_options(&self) -> egui_tiles::SimplificationOptions {
        egui_tiles::SimplificationOptions {
            all_panes_must_have_tabs: false,
            ..Default::default()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_usual_layout_is_whole_and_a_damaged_one_is_not_taken() {
        assert!(whole(&usual()));
        let mut without_log = usual();
        let log = without_log.tiles.find_pane(&Pane::Log).expect("a log");
        without_log.remove_recursively(log);
        assert!(!whole(&without_log));

        let mut looped = usual();
        let (root, views) = (
            looped.root.expect("a root"),
            looped.tiles.find_pane(&Pane::Draft),
        );
        let views = looped
            .tiles
            .parent_of(views.expect("a draft"))
            .expect("views");
        if let Some(Tile::Container(container)) = looped.tiles.get_mut(views) {
            container.add_child(root);
        }
        assert!(!whole(&looped));
    }

    #[test]
    fn a_kept_layout_comes_back_and_one_of_another_version_does_not() {
        let mut layout = Layout::default();
        layout.bring(Pane::Log);
        let text = ron::to_string(&layout.kept()).expect("written");
        let mut kept: KeptLayout = ron::from_str(&text).expect("read");
        assert!(Layout::from_kept(Some(kept.clone())).tree == layout.tree);
        kept.version += 1;
        assert!(Layout::from_kept(Some(kept)).tree != layout.tree);
        assert!(Layout::from_kept(None).tree == usual());
    }
}
