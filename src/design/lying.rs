//! How thick yarns lie in the cloth: as thick as they are, unless that cannot be.
//!
//! A yarn somewhat wider than its pitch is squeezed and bulges, as in any dense cloth. One
//! that is much wider has no room there: a wrong unit or a wrong sett. It is taken to touch
//! its neighbours, and that is told.

use std::fmt;

use super::document::Design;
use super::maps::YarnMap;
use super::yarn::{Yarn, YarnId};

/// Widths of its pitch up to which a yarn is believed.
const MOST_COVER: f32 = 1.5;

/// A yarn that has no room in the cloth.
#[derive(Debug, Clone, PartialEq)]
pub struct TooThick {
    /// Its place in the design's list.
    pub yarn: usize,
    /// Its name.
    pub name: String,
    /// Its own diameter, mm.
    pub diameter_mm: f32,
    /// The spacing of the threads it is, and the diameter it is taken to have, mm.
    pub pitch_mm: f32,
}

impl fmt::Display for TooThick {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            name,
            diameter_mm,
            pitch_mm,
            ..
        } = self;
        write!(
            out,
            "yarn \"{name}\" is {diameter_mm:.3} mm thick, and its threads lie {pitch_mm:.3} mm \
             apart: they are taken to touch; correct its thickness or the sett"
        )
    }
}

impl Design {
    /// The yarns in use that have no room.
    pub fn too_thick(&self) -> Vec<TooThick> {
        let directions = [
            (&self.maps().warp, &self.sett().ends),
            (&self.maps().weft, &self.sett().picks),
        ];
        let mut rooms = vec![f32::INFINITY; self.yarns().len()];
        for (map, density) in directions {
            let pitch = density.mean_pitch_mm();
            let mut used = vec![false; rooms.len()];
            let mut see = |id: &YarnId| used[usize::from(id.0)] = true;
            match map {
                YarnMap::Order(order) => order.iter().for_each(&mut see),
                YarnMap::Crossings(grid) => grid.iter().for_each(|id| see(&id)),
            }
            for (room, _) in rooms.iter_mut().zip(used).filter(|(_, used)| *used) {
                *room = room.min(pitch);
            }
        }
        (self.yarns().iter().zip(rooms).enumerate())
            .filter(|(_, (yarn, room))| yarn.diameter() > MOST_COVER * room)
            .map(|(index, (yarn, pitch_mm))| TooThick {
                yarn: index,
                name: yarn.name.clone(),
                diameter_mm: yarn.diameter(),
                pitch_mm,
            })
            .collect()
    }

    /// The design's yarns as thick as they lie in the cloth.
    pub fn lying_yarns(&self) -> Vec<Yarn> {
        let mut yarns = self.yarns().to_vec();
        for thick in self.too_thick() {
            let yarn = &mut yarns[thick.yarn];
            // Its weight goes with its thickness.
            (yarn.diameter_mm, yarn.tex) = (Some(thick.pitch_mm), None);
        }
        yarns
    }

    /// The design with its yarns as thick as they lie in the cloth.
    pub fn lying(&self) -> Self {
        if self.too_thick().is_empty() {
            return self.clone();
        }
        let lying = self
            .clone()
            .with_yarns(self.lying_yarns(), self.maps().clone());
        lying.unwrap_or_else(|_| self.clone())
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;
    use crate::design::{Family, Fill, Filled, Sett, Srgb, Structure, YarnId, YarnMaps};

    /// A warp and a weft of these diameters at 20 ends and 10 picks a cm, and a third yarn
    /// that is not used.
    fn design(warp: f32, weft: f32) -> Design {
        let yarn = |name: &str, mm: f32| Yarn {
            diameter_mm: Some(mm),
            ..Yarn::new(name, Family::Cotton, Srgb(128, 128, 128))
        };
        let fill = Fill::by_notation("2/2 twill").unwrap();
        let structure = Structure::Weave(Filled::new(fill, 4, 4).unwrap());
        let yarns = vec![yarn("a", warp), yarn("b", weft), yarn("idle", 50.0)];
        let maps = YarnMaps::plain(YarnId(0), YarnId(1));
        Design::new("t", structure, yarns, maps, Sett::per_cm(20.0, 10.0)).unwrap()
    }

    #[test]
    fn only_yarns_without_room_are_taken_to_touch() {
        assert_eq!(design(0.7, 1.4).too_thick(), []);
        assert_eq!(design(0.7, 1.4).lying(), design(0.7, 1.4));
        let thick = design(100.0, 1.4);
        let told = thick.too_thick();
        assert_eq!((told.len(), told[0].yarn, told[0].pitch_mm), (1, 0, 0.5));
        assert!(told[0].to_string().contains("they are taken to touch"));
        let lying = thick.lying_yarns();
        assert_eq!(lying[0].diameter(), 0.5);
        assert_eq!((lying[1].diameter(), lying[2].diameter()), (1.4, 50.0));
        // Wefts lie farther apart.
        assert_eq!(design(0.7, 3.0).lying_yarns()[1].diameter(), 1.0);
    }
}
