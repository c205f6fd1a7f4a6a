//! The dividers between panes: dragged, moved with the arrow keys, and known by name.
//!
//! Those that come with the tiles can be come to with Tab, but have no name and do not
//! hear a key, so these lie in their places.

use egui::{CursorIcon, Id, Rect, Response, Sense, Stroke, Ui, vec2};
use egui_tiles::{Container, Linear, LinearDir, Tile, TileId, Tree};

use super::focus;
use super::panes::Pane;
use crate::tokens::{self, Palette};

/// Points to both sides of a divider where it can be taken.
const REACH: f32 = 5.0;
/// Points by which an arrow key moves it.
const KEY_STEP: f32 = 4.0 * tokens::GRID;

/// Two neighbours in a row or a column.
struct Divider {
    row: TileId,
    across: bool,
    beside: [TileId; 2],
    rects: [Rect; 2],
    name: String,
}

/// Shows the dividers of what was just laid out, and moves what lies beside them.
pub fn show(ui: &Ui, tree: &mut Tree<Pane>) {
    for divider in all(tree) {
        let lengths = divider.rects.map(|rect| divider.length(rect));
        let before = lengths[0];
        let wanted = divider.show(ui, lengths);
        let moved = within(wanted, lengths[0] + lengths[1]);
        if let Some(now) = moved.filter(|now| (now - before).abs() > 1e-3) {
            divider.share(tree, now / (lengths[0] + lengths[1]));
        }
    }
}

/// The dividers in the order of the panes.
fn all(tree: &Tree<Pane>) -> Vec<Divider> {
    let mut found = Vec::new();
    let mut next: Vec<TileId> = tree.root.into_iter().collect();
    while let Some(id) = next.pop() {
        let Some(Tile::Container(container)) = tree.tiles.get(id) else {
            continue;
        };
        if let Container::Linear(linear) = container {
            found.extend(between(tree, id, linear));
        }
        let mut children = container.children_vec();
        children.reverse();
        next.extend(children);
    }
    found
}

fn between(tree: &Tree<Pane>, row: TileId, linear: &Linear) -> Vec<Divider> {
    // What is not shown has no place.
    let placed = |&id: &TileId| Some((id, tree.tiles.rect(id)?));
    let shown: Vec<(TileId, Rect)> = linear.children.iter().filter_map(placed).collect();
    let pairs = shown.windows(2).map(|pair| {
        let titles = [pair[0].0, pair[1].0].map(|tile| title(tree, tile));
        Divider {
            row,
            across: linear.dir == LinearDir::Horizontal,
            beside: [pair[0].0, pair[1].0],
            rects: [pair[0].1, pair[1].1],
            name: format!("Divider between {} and {}", titles[0], titles[1]),
        }
    });
    pairs.collect()
}

/// The first pane in a tile.
fn title(tree: &Tree<Pane>, tile: TileId) -> &'static str {
    match tree.tiles.get(tile) {
        Some(Tile::Pane(pane)) => pane.title(),
        Some(Tile::Container(container)) => {
            let first = container.children().next();
            first.map_or("", |child| title(tree, *child))
        }
        None => "",
    }
}

/// The length of the first of two neighbours, so that both stay large enough; `None` where
/// both cannot.
fn within(wanted: f32, both: f32) -> Option<f32> {
    let least = tokens::SMALLEST_PANE;
    (both >= 2.0 * least).then(|| wanted.clamp(least, both - least))
}

impl Divider {
    fn length(&self, rect: Rect) -> f32 {
        match self.across {
            true => rect.width(),
            false => rect.height(),
        }
    }

    /// The gap between the neighbours.
    fn gap(&self) -> Rect {
        let [one, other] = self.rects;
        match self.across {
            true => Rect::from_x_y_ranges(one.right()..=other.left(), one.y_range()),
            false => Rect::from_x_y_ranges(one.x_range(), one.bottom()..=other.top()),
        }
    }

    /// Shows it; returns what length the first of its neighbours is to have.
    fn show(&self, ui: &Ui, lengths: [f32; 2]) -> f32 {
        let gap = self.gap();
        let reach = match self.across {
            true => vec2(REACH - gap.width() / 2.0, 0.0),
            false => vec2(0.0, REACH - gap.height() / 2.0),
        };
        let id = Id::unique(("divider", self.beside));
        let response = ui.interact(gap.expand2(reach), id, Sense::click_and_drag());
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Splitter, true, &self.name));
        self.draw(ui, &response);
        let [right, up] = focus::arrows(ui, &response);
        let (by_key, by_hand) = match self.across {
            true => (right, response.drag_delta().x),
            false => (-up, response.drag_delta().y),
        };
        match response.double_clicked() {
            true => (lengths[0] + lengths[1]) / 2.0,
            false => lengths[0] + by_hand + by_key as f32 * KEY_STEP,
        }
    }

    fn draw(&self, ui: &Ui, response: &Response) {
        let palette = Palette::current(ui);
        let gap = self.gap();
        if response.hovered() || response.dragged() {
            ui.set_cursor_icon(match self.across {
                true => CursorIcon::ResizeHorizontal,
                false => CursorIcon::ResizeVertical,
            });
            let stroke = Stroke::new(tokens::FOCUS, palette.quiet);
            let middle = gap.center();
            match self.across {
                true => ui.painter().vline(middle.x, gap.y_range(), stroke),
                false => ui.painter().hline(gap.x_range(), middle.y, stroke),
            };
        }
        if response.has_focus() {
            focus::ring(ui.painter(), response.rect, &palette);
        }
    }

    /// Gives the first of the neighbours this share of what both have.
    fn share(&self, tree: &mut Tree<Pane>, share: f32) {
        let Some(Tile::Container(Container::Linear(row))) = tree.tiles.get_mut(self.row) else {
            return;
        };
        let [one, other] = self.beside;
        let both = row.shares[one] + row.shares[other];
        row.shares[one] = both * share;
        row.shares[other] = both * (1.0 - share);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neither_neighbour_gets_too_small() {
        let least = tokens::SMALLEST_PANE;
        assert_eq!(within(300.0, 1000.0), Some(300.0));
        assert_eq!(within(-9.0, 1000.0), Some(least));
        assert_eq!(within(990.0, 1000.0), Some(1000.0 - least));
        assert_eq!(within(70.0, 150.0), None);
    }
}
