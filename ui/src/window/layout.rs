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
    /// The kept layout, with the panes that there were not yet when it was kept; or the usual
    /// one where that is of another version or damaged.
    pub fn from_kept(kept: Option<KeptLayout>) -> Self {
        let kept = kept.filter(|kept| kept.version == VERSION);
        match kept.and_then(|kept| completed(kept.tree)) {
            Some(mut tree) => {
                tree.set_height(f32::INFINITY);
                tree.set_width(f32::INFINITY);
                Self { tree }
            }
            None => Self::default(),
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

/// The same with the panes that are not in it, as tabs beside others; `None` = damaged.
fn completed(mut tree: Tree<Pane>) -> Option<Tree<Pane>> {
    let (found, root) = (sound_panes(&tree)?, tree.root?);
    let missing = Pane::ALL.iter().filter(|pane| !found.contains(pane));
    let added: Vec<TileId> = missing.map(|pane| tree.tiles.insert_pane(*pane)).collect();
    if added.is_empty() {
        return Some(tree);
    }
    let tabs = (tree.tiles.iter())
        .filter(|(_, tile)| matches!(tile, Tile::Container(Container::Tabs(_))))
        .map(|(id, _)| *id)
        .min_by_key(|id| id.0);
    match tabs.and_then(|id| tree.tiles.get_mut(id)) {
        Some(Tile::Container(tabs)) => added.into_iter().for_each(|id| tabs.add_child(id)),
        _ => {
            let tabs = tree.tiles.insert_tab_tile(added);
            let mut column = Linear::new(LinearDir::Vertical, vec![root, tabs]);
            column.shares.set_share(root, SHARES[0]);
            column.shares.set_share(tabs, SHARES[1]);
            let column = Container::Linear(column);
            tree.root = Some(tree.tiles.insert_container(column));
        }
    }
    Some(tree)
}

/// The panes of a layout, each once, under one root and with nothing else; `None` = damaged.
fn sound_panes(tree: &Tree<Pane>) -> Option<Vec<Pane>> {
    let mut found = Vec::new();
    let mut seen = HashSet::new();
    let mut next: Vec<TileId> = tree.root.into_iter().collect();
    while let Some(id) = next.pop() {
        // A tile met twice is a loop, or a tile with two parents; a hidden one is lost.
        if !seen.insert(id) || seen.len() > MOST_TILES || !tree.is_visible(id) {
            return None;
        }
        match tree.tiles.get(id) {
            Some(Tile::Pane(pane)) if found.contains(pane) => return None,
            Some(Tile::Pane(pane)) => found.push(*pane),
            Some(Tile::Container(container)) if sound(container) => {
                next.extend(container.children_vec());
            }
            Some(Tile::Container(_)) | None => return None,
        }
    }
    // Without the two views nobody would know it for theirs.
    let views = [Pane::Draft, Pane::Cloth];
    views
        .iter()
        .all(|pane| found.contains(pane))
        .then_some(found)
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

    fn without(panes: &[Pane]) -> Tree<Pane> {
        let mut tree = usual();
        for pane in panes {
            let tile = tree.tiles.find_pane(pane).expect("a pane");
            tree.remove_recursively(tile);
        }
        tree
    }

    #[test]
    fn a_damaged_layout_is_not_taken() {
        assert!(sound_panes(&usual()).is_some_and(|panes| panes.len() == Pane::ALL.len()));
        assert!(completed(without(&[Pane::Cloth])).is_none());

        let mut twice = usual();
        let log = twice.tiles.find_pane(&Pane::Log).expect("a log");
        let tabs = twice.tiles.parent_of(log).expect("tabs");
        let again = twice.tiles.insert_pane(Pane::Log);
        if let Some(Tile::Container(container)) = twice.tiles.get_mut(tabs) {
            container.add_child(again);
        }
        assert!(completed(twice).is_none());

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
        assert!(completed(looped).is_none());
    }

    #[test]
    fn a_layout_from_before_a_pane_keeps_what_was_moved() {
        let below: Vec<Pane> = (Pane::ALL.iter().copied())
            .filter(|pane| !matches!(pane, Pane::Draft | Pane::Cloth))
            .collect();
        // One pane is new, and, where there were no tabs yet, all of them.
        for new in [&below[..1], &below[..]] {
            let mut old = without(new);
            let draft = old.tiles.find_pane(&Pane::Draft).expect("a draft");
            let views = old.tiles.parent_of(draft).expect("views");
            if let Some(Tile::Container(Container::Linear(linear))) = old.tiles.get_mut(views) {
                linear.shares.set_share(draft, 3.5);
            }
            let kept = KeptLayout {
                version: VERSION,
                tree: old,
            };
            let tree = Layout::from_kept(Some(kept)).tree;
            let panes = sound_panes(&tree).expect("sound");
            assert!(
                Pane::ALL.iter().all(|pane| panes.contains(pane)),
                "{panes:?}"
            );
            let Some(Tile::Container(Container::Linear(linear))) = tree.tiles.get(views) else {
                panic!("the views are gone")
            };
            assert!((linear.shares[draft] - 3.5).abs() < 1e-6);
        }
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
