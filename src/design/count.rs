//! Yarn counts: how thick a yarn is, in the units that spinners and weavers write.
//!
//! Direct units (tex, dtex, denier) grow with the yarn; indirect ones (Nm, Ne, worsted,
//! lea, yd/lb, m/kg) are lengths per weight and fall. A plied yarn of n strands of a count
//! is written 40/2 in indirect units (two strands of 40) and 20×2 in direct ones.

/// Grams in a pound and metres in a yard (international).
const POUND: f64 = 453.592_37;
const YARD: f64 = 0.9144;

/// A unit of yarn count.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum CountUnit {
    /// Grams in 1 000 m.
    #[default]
    Tex,
    /// Grams in 10 000 m.
    Dtex,
    /// Grams in 9 000 m.
    Denier,
    /// Metres in a gram.
    Nm,
    /// English cotton count: hanks of 840 yd in a pound.
    Ne,
    /// Worsted count: hanks of 560 yd in a pound.
    Worsted,
    /// Linen count: leas of 300 yd in a pound.
    Lea,
    /// Yards in a pound.
    YardsPerPound,
    /// Metres in a kilogram.
    MetresPerKilogram,
}

impl CountUnit {
    /// All of them, in the order in which they are offered.
    pub const ALL: [Self; 9] = [
        Self::Tex,
        Self::Dtex,
        Self::Denier,
        Self::Nm,
        Self::Ne,
        Self::Worsted,
        Self::Lea,
        Self::YardsPerPound,
        Self::MetresPerKilogram,
    ];

    /// As it is written behind a number.
    pub fn name(self) -> &'static str {
        match self {
            Self::Tex => "tex",
            Self::Dtex => "dtex",
            Self::Denier => "denier",
            Self::Nm => "Nm",
            Self::Ne => "Ne",
            Self::Worsted => "worsted",
            Self::Lea => "lea",
            Self::YardsPerPound => "yd/lb",
            Self::MetresPerKilogram => "m/kg",
        }
    }

    /// Metres of 1 unit in a gram for indirect units, grams in 1 000 m of 1 unit for
    /// direct ones.
    fn scale(self) -> (bool, f64) {
        match self {
            Self::Tex => (true, 1.0),
            Self::Dtex => (true, 0.1),
            Self::Denier => (true, 1.0 / 9.0),
            Self::Nm => (false, 1.0),
            Self::Ne => (false, 840.0 * YARD / POUND),
            Self::Worsted => (false, 560.0 * YARD / POUND),
            Self::Lea => (false, 300.0 * YARD / POUND),
            Self::YardsPerPound => (false, YARD / POUND),
            Self::MetresPerKilogram => (false, 1e-3),
        }
    }

    /// The tex of `plies` strands of a count. Not finite for a count of 0.
    pub fn to_tex(self, count: f64, plies: u32) -> f64 {
        let (direct, scale) = self.scale();
        let strand = if direct {
            count * scale
        } else {
            1000.0 / (count * scale)
        };
        strand * f64::from(plies.max(1))
    }

    /// The count of each of `plies` strands of a yarn of `tex`.
    pub fn of_tex(self, tex: f64, plies: u32) -> f64 {
        let (direct, scale) = self.scale();
        let strand = tex / f64::from(plies.max(1));
        if direct {
            strand / scale
        } else {
            1000.0 / (strand * scale)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_are_what_tables_say() {
        // Known values: Ne = 590.54/tex, Nm = 1000/tex, worsted = 885.8/tex, lea = 1653.5/tex.
        for (unit, count, plies, tex) in [
            (CountUnit::Ne, 40.0, 2, 29.527),
            (CountUnit::Nm, 48.0, 2, 41.667),
            (CountUnit::Worsted, 40.0, 1, 22.145),
            (CountUnit::Lea, 40.0, 1, 41.337),
            (CountUnit::Denier, 20.0, 1, 2.2222),
            (CountUnit::Dtex, 167.0, 1, 16.7),
            (CountUnit::YardsPerPound, 4960.5, 1, 100.0),
            (CountUnit::MetresPerKilogram, 10_000.0, 1, 100.0),
            (CountUnit::Tex, 50.0, 2, 100.0),
        ] {
            let found = unit.to_tex(count, plies);
            assert!((found - tex).abs() < 1e-3 * tex, "{unit:?}: {found}");
            let back = unit.of_tex(found, plies);
            assert!((back - count).abs() < 1e-9 * count, "{unit:?}: {back}");
        }
    }
}
