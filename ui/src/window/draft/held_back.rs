//! What a stroke painted on the drawdown of a draft. The draft is derived, or a question is
//! asked, once the stroke ends: until then nothing of the draft changes, so that the
//! drawdown stays where it is under the pointer.

use pickglass::edit::{Cells, Edit};

/// Crossings that were painted.
pub struct HeldBack {
    pub warp_up: Cells,
    pub weft_up: Cells,
}

impl HeldBack {
    /// What an edit paints over what was held `before`; `None` where it is not of the kind
    /// that strokes are made of.
    pub fn of(edit: &Edit, before: Option<Self>) -> Option<Self> {
        let (up, down) = match edit {
            Edit::Paint { cells, warp_up } => {
                let (ends, picks) = cells.size();
                let none = Cells::none(ends, picks);
                match warp_up {
                    true => (cells.clone(), none),
                    false => (none, cells.clone()),
                }
            }
            Edit::Place { cells, values } => {
                let mut down = cells.clone();
                down.subtract(&Cells::of_pattern(values));
                let mut up = cells.clone();
                up.subtract(&down);
                (up, down)
            }
            _ => return None,
        };
        let before = before.filter(|before| before.warp_up.size() == up.size());
        let Some(mut held) = before else {
            return Some(Self {
                warp_up: up,
                weft_up: down,
            });
        };
        held.warp_up.subtract(&down);
        held.weft_up.subtract(&up);
        held.warp_up.extend(&up);
        held.weft_up.extend(&down);
        Some(held)
    }

    /// The one edit that paints all of it.
    pub fn into_edit(self) -> Edit {
        let Self { warp_up, weft_up } = self;
        if weft_up.is_empty() {
            return Edit::Paint {
                cells: warp_up,
                warp_up: true,
            };
        }
        let values = warp_up.bits().clone();
        let mut cells = weft_up;
        if warp_up.is_empty() {
            return Edit::Paint {
                cells,
                warp_up: false,
            };
        }
        cells.extend(&warp_up);
        Edit::Place { cells, values }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use pickglass::design::WeavePattern;

    #[test]
    fn what_is_painted_last_lies_on_top() {
        let cells = |list: &[(u32, u32)]| Cells::of(4, 4, list.iter().copied());
        let paint = |list: &[(u32, u32)], warp_up| Edit::Paint {
            cells: cells(list),
            warp_up,
        };
        let held = HeldBack::of(&paint(&[(0, 0), (1, 0)], true), None).expect("held");
        let held = HeldBack::of(&paint(&[(1, 0), (2, 0)], false), Some(held)).expect("held");
        let mut values = WeavePattern::new(4, 4);
        values.set(2, 0, true);
        let place = Edit::Place {
            cells: cells(&[(2, 0), (3, 0)]),
            values: values.clone(),
        };
        let held = HeldBack::of(&place, Some(held)).expect("held");
        values.set(0, 0, true);
        let Edit::Place {
            cells: all,
            values: painted,
        } = held.into_edit()
        else {
            panic!("not of one kind");
        };
        let crossings: Vec<_> = all.iter().collect();
        assert_eq!(crossings, [(0, 0), (1, 0), (2, 0), (3, 0)]);
        assert_eq!(painted, values);
        let one = HeldBack::of(&paint(&[(3, 3)], true), None).expect("held");
        let Edit::Paint { cells: one, .. } = one.into_edit() else {
            panic!("of two kinds");
        };
        assert_eq!(one.iter().collect::<Vec<_>>(), [(3, 3)]);
        assert!(HeldBack::of(&Edit::Flip(cells(&[(0, 0)])), None).is_none());
    }
}
