//! How much blocks of a picture change: plain functions over their means.

/// What is added to a block's light before changes are relative to it: one hundredth of a
/// white diffuser.
pub const DARK: f64 = 0.01;

/// Of 100 blocks, how many have to change by less than a bound.
pub const OF_100: f64 = 95.0;

/// An upper limit of the 95th percentile of what `values` are drawn from, wrong in at most 1
/// of 20 cases: the k-th smallest, where no more than k of them lie below the percentile with a
/// chance of 0.95 (binomial, by its normal limit). Fewer than 59 cannot say so much: their
/// largest, half as much again. None: infinite.
pub fn upper_percentile(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let Some(largest) = sorted.last().copied() else {
        return f64::INFINITY;
    };
    let (count, share) = (sorted.len() as f64, 0.01 * OF_100);
    let place = count * share + 1.645 * (count * share * (1.0 - share)).sqrt() + 0.5;
    match sorted.get(place.ceil() as usize - 1) {
        Some(limit) if place.is_finite() => *limit,
        _ if sorted.len() >= 59 => largest,
        _ => 1.5 * largest,
    }
}

/// Changes of blocks, each relative to its light.
pub fn relative(changes: &[f64], light: &[f64]) -> Vec<f64> {
    let both = changes.iter().zip(light);
    both.map(|(change, light)| change.abs() / (light + DARK))
        .collect()
}

/// The root mean square of what two looks at the same blocks have in common: their noise, which
/// is not the same, has no share in it.
pub fn common(one: &[f64], other: &[f64]) -> f64 {
    let products = one.iter().zip(other).map(|(one, other)| one * other);
    let mean = products.sum::<f64>() / one.len().max(1) as f64;
    mean.max(0.0).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    fn uniform(seed: u64, count: usize) -> Vec<f64> {
        let mut random = Random::new(seed, 0, 0);
        (0..count).map(|_| f64::from(random.uniform())).collect()
    }

    #[test]
    fn the_limit_lies_above_the_percentile_as_often_as_it_says() {
        for count in [60, 96, 192, 1000] {
            let above = (0..2000)
                .filter(|seed| upper_percentile(&uniform(*seed, count)) >= 0.95)
                .count();
            assert!(above >= 1880, "{count}: {above} of 2000");
            // The control: the percentile of the values themselves does so half of the time.
            let plain = (0..2000).filter(|seed| {
                let mut values = uniform(*seed, count);
                values.sort_by(f64::total_cmp);
                values[count * 95 / 100 - 1] >= 0.95
            });
            assert!(plain.count() < 1400, "{count}");
        }
        // It is no more than that of many.
        assert!(upper_percentile(&uniform(7, 1000)) < 0.98);
        assert!(upper_percentile(&[]).is_infinite());
        assert!((upper_percentile(&[2.0]) - 3.0).abs() < 1e-12);
    }

    #[test]
    fn noise_has_no_share_in_what_is_common() {
        let noise = |seed| -> Vec<f64> { uniform(seed, 5000).iter().map(|u| u - 0.5).collect() };
        assert!(common(&noise(1), &noise(2)) < 0.06);
        let shifted = |seed| -> Vec<f64> { noise(seed).iter().map(|n| n + 0.3).collect() };
        assert!((common(&shifted(1), &shifted(2)) - 0.3).abs() < 0.02);
        // The control: of one look alone it is all there.
        assert!(common(&noise(1), &noise(1)) > 0.25);
    }

    #[test]
    fn changes_are_relative_to_light_and_dark_blocks_count_less() {
        let changes = relative(&[0.1, -0.1, 0.1], &[0.99, 0.99, 0.0]);
        assert!((changes[0] - 0.1).abs() < 1e-9 && (changes[1] - 0.1).abs() < 1e-9);
        assert!((changes[2] - 10.0).abs() < 1e-9);
    }
}
