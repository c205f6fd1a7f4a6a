//! The drawdown as textures: tiles of the endless cloth, made where one looks and made
//! again where something changed. A far look is drawn from means of crossings.
//!
//! What is small is made at once, within a budget of time a frame; what is large is made
//! on a thread while the old tile is still shown.

use std::collections::BTreeMap;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use egui::{Color32, ColorImage, TextureHandle, TextureOptions};
use pickglass::design::{Colouring, Design, SwatchWindow, WeavePattern, swatch};
use pickglass::edit::{Change, Document, Touched};

use super::grid::{CellGrid, Look};

/// Pixels along the side of a tile.
const SIDE: i64 = 256;
/// Tiles that are kept, the ones seen last.
const MOST_KEPT: usize = 320;
/// Time that making tiles may take of a frame.
const BUDGET: Duration = Duration::from_millis(5);
/// Tiles and patches of up to so many crossings are made at once.
const AT_ONCE: u64 = 1 << 18;

/// Which tile.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Key {
    colouring: Colouring,
    level: u32,
    column: i64,
    row: i64,
}

impl Key {
    /// Crossings along the side.
    fn crossings(self) -> i64 {
        SIDE << self.level
    }

    fn window(self) -> SwatchWindow {
        SwatchWindow {
            end: self.column * self.crossings(),
            pick: self.row * self.crossings(),
            size: [SIDE as usize; 2],
            level: self.level,
        }
    }
}

struct Tile {
    texture: TextureHandle,
    /// Something in it changed since it was made.
    stale: bool,
    /// The frame that last drew it.
    seen: u64,
}

/// A tile that is to be made, of the document as it was then.
struct Order {
    key: Key,
    revision: u64,
    design: Arc<Design>,
    drawdown: Arc<WeavePattern>,
}

struct Made {
    key: Key,
    revision: u64,
    image: ColorImage,
}

/// The tiles, and the thread that makes the large ones.
#[derive(Default)]
pub struct Tiles {
    tiles: BTreeMap<Key, Tile>,
    frame: u64,
    maker: Option<Maker>,
}

impl Tiles {
    /// Forgets everything, and what is being made: another document is open.
    pub fn clear(&mut self) {
        self.tiles.clear();
        self.maker = None;
    }

    /// Makes patches of what changed, and marks the rest to be made again.
    pub fn changed(&mut self, document: &Document, change: &Change) {
        if change.size || change.lattice {
            self.tiles.clear();
            return;
        }
        let rects = match &change.crossings {
            _ if change.yarns => &[],
            Touched::Rects(rects) => rects.as_slice(),
            Touched::None => return,
            Touched::All => &[],
        };
        let (ends, picks) = (document.design().ends(), document.design().picks());
        let begun = Instant::now();
        for (key, tile) in &mut self.tiles {
            // What is not looked at, or takes too long, waits until it is.
            let unseen = tile.seen < self.frame;
            if rects.is_empty() || unseen || begun.elapsed() > BUDGET {
                tile.stale = true;
                continue;
            }
            let side = key.crossings();
            let (left, below) = (key.column * side, key.row * side);
            // Whatever shows another repeat as well is made again whole.
            let inside = left >= 0
                && below >= 0
                && left + side <= i64::from(ends)
                && below + side <= i64::from(picks);
            tile.stale |= !inside;
            for rect in rects {
                let mask = !((1i64 << key.level) - 1);
                let from = [i64::from(rect.end) & mask, i64::from(rect.pick) & mask];
                let to = [
                    i64::from(rect.end + rect.ends),
                    i64::from(rect.pick + rect.picks),
                ];
                let low = [from[0].max(left), from[1].max(below)];
                let high = [to[0].min(left + side), to[1].min(below + side)];
                if low[0] >= high[0] || low[1] >= high[1] {
                    continue;
                }
                let size = [0, 1].map(|axis| {
                    ((high[axis] - low[axis] + (1 << key.level) - 1) >> key.level) as usize
                });
                let crossings = ((size[0] * size[1]) as u64) << (2 * key.level);
                if crossings > AT_ONCE {
                    tile.stale = true;
                    continue;
                }
                let window = SwatchWindow {
                    end: low[0],
                    pick: low[1],
                    size,
                    level: key.level,
                };
                let image = image(
                    document.design(),
                    document.drawdown(),
                    window,
                    key.colouring,
                );
                let x = ((low[0] - left) >> key.level) as usize;
                let y = SIDE as usize - ((low[1] - below) >> key.level) as usize - size[1];
                (tile.texture).set_partial([x, y], image, TextureOptions::NEAREST);
            }
        }
    }

    /// Draws the visible part of the cloth.
    pub fn show(
        &mut self,
        painter: &egui::Painter,
        grid: &CellGrid,
        look: &Look,
        document: &Document,
        colouring: Colouring,
    ) {
        self.frame += 1;
        let ctx = painter.ctx().clone();
        self.take_made(&ctx, document.revision());
        let begun = Instant::now();
        let mut orders = Vec::new();
        let level = look.level();
        let side = SIDE << level;
        let [ends, picks] = grid.visible();
        for row in picks.start().div_euclid(side)..=picks.end().div_euclid(side) {
            for column in ends.start().div_euclid(side)..=ends.end().div_euclid(side) {
                let key = Key {
                    colouring,
                    level,
                    column,
                    row,
                };
                let fresh = self.tiles.get(&key).is_some_and(|tile| !tile.stale);
                if !fresh {
                    let crossings = (side * side) as u64;
                    if crossings <= AT_ONCE && begun.elapsed() < BUDGET {
                        let (design, drawdown) = (document.design(), document.drawdown());
                        let image = image(design, drawdown, key.window(), colouring);
                        self.put(&ctx, key, image);
                    } else if crossings <= AT_ONCE {
                        ctx.request_repaint();
                    } else {
                        orders.push(Order {
                            key,
                            revision: document.revision(),
                            design: Arc::clone(document.design()),
                            drawdown: Arc::clone(document.drawdown()),
                        });
                    }
                }
                if let Some(tile) = self.tiles.get_mut(&key) {
                    tile.seen = self.frame;
                    let from = (column * side, row * side);
                    let place = grid.rect(from.0, from.1, side, side);
                    painter.image(tile.texture.id(), place, grid.picture_uv(), Color32::WHITE);
                }
            }
        }
        self.order(&ctx, orders);
        self.forget_old();
    }

    fn put(&mut self, ctx: &egui::Context, key: Key, image: ColorImage) {
        match self.tiles.get_mut(&key) {
            Some(tile) => {
                tile.texture.set(image, TextureOptions::NEAREST);
                tile.stale = false;
            }
            None => {
                let texture = ctx.load_texture("draft tile", image, TextureOptions::NEAREST);
                let tile = Tile {
                    texture,
                    stale: false,
                    seen: self.frame,
                };
                self.tiles.insert(key, tile);
            }
        }
    }

    fn take_made(&mut self, ctx: &egui::Context, present: u64) {
        let Some(maker) = &self.maker else { return };
        let made: Vec<Made> = maker.made.try_iter().collect();
        for Made {
            key,
            revision,
            image,
        } in made
        {
            self.put(ctx, key, image);
            // What changed while it was made is ordered again by the next look.
            if let Some(tile) = self.tiles.get_mut(&key) {
                tile.stale = revision != present;
            }
        }
    }

    fn order(&mut self, ctx: &egui::Context, orders: Vec<Order>) {
        if orders.is_empty() && self.maker.is_none() {
            return;
        }
        let maker = match &mut self.maker {
            Some(maker) => maker,
            None => match Maker::start(ctx) {
                Ok(maker) => self.maker.insert(maker),
                Err(error) => {
                    log::error!("the draft cannot be drawn from afar: {error}");
                    return;
                }
            },
        };
        maker.wanted(orders);
    }

    fn forget_old(&mut self) {
        if self.tiles.len() <= MOST_KEPT {
            return;
        }
        let mut seen: Vec<u64> = self.tiles.values().map(|tile| tile.seen).collect();
        seen.sort_unstable_by(|a, b| b.cmp(a));
        let oldest = seen[MOST_KEPT - 1];
        let frame = self.frame;
        self.tiles
            .retain(|_, tile| tile.seen >= oldest || tile.seen == frame);
    }
}

/// A window of the cloth as an image.
pub fn image(
    design: &Design,
    drawdown: &WeavePattern,
    window: SwatchWindow,
    colouring: Colouring,
) -> ColorImage {
    let pixels = swatch(design, drawdown, window, colouring);
    ColorImage::from_rgba_unmultiplied(window.size, pixels.as_flattened())
}

/// The thread that makes large tiles: the newest list of orders counts.
struct Maker {
    orders: Arc<Mutex<Vec<Order>>>,
    wake: Sender<()>,
    made: Receiver<Made>,
}

impl Maker {
    fn start(ctx: &egui::Context) -> std::io::Result<Self> {
        let orders: Arc<Mutex<Vec<Order>>> = Arc::default();
        let (wake, woken) = channel::<()>();
        let (sender, made) = channel();
        let (list, ctx) = (Arc::clone(&orders), ctx.clone());
        std::thread::Builder::new()
            .name("draft tiles".to_owned())
            .spawn(move || {
                // Ends when the window drops the sender.
                while woken.recv().is_ok() {
                    loop {
                        let next = list.lock().unwrap_or_else(PoisonError::into_inner).pop();
                        let Some(order) = next else { break };
                        let window = order.key.window();
                        let image =
                            image(&order.design, &order.drawdown, window, order.key.colouring);
                        let made = Made {
                            key: order.key,
                            revision: order.revision,
                            image,
                        };
                        if sender.send(made).is_err() {
                            return;
                        }
                        ctx.request_repaint();
                    }
                }
            })?;
        Ok(Self { orders, wake, made })
    }

    /// What is wanted now, in place of what was wanted before.
    fn wanted(&mut self, orders: Vec<Order>) {
        let some = !orders.is_empty();
        *self.orders.lock().unwrap_or_else(PoisonError::into_inner) = orders;
        if some {
            let _ = self.wake.send(());
        }
    }
}
