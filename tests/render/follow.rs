//! A prepared cloth that follows edits is the cloth of the edited design.
#![allow(clippy::unwrap_used, reason = "a test may fail")]

use std::sync::Arc;

use glam::Vec3;
use pickglass::cloth::{Followed, PreparedCloth};
use pickglass::design::{
    Design, Family, Sett, Srgb, Structure, WeavePattern, Yarn, YarnId, YarnMaps,
};
use pickglass::engine::{StillRequest, follow, prepare};
use pickglass::exemplar::ExemplarStore;
use pickglass::job::Job;
use pickglass::plan::Settings;
use pickglass::random::Random;
use pickglass::render::Voxel;

const SIZE: u32 = 24;

fn yarns() -> Vec<Yarn> {
    let yarn = |name: &str, colour| Yarn::new(name, Family::Cotton, colour);
    vec![
        yarn("navy", Srgb(20, 30, 90)),
        yarn("cream", Srgb(240, 230, 200)),
    ]
}

fn design(weave: WeavePattern, yarns: Vec<Yarn>, maps: YarnMaps) -> Arc<Design> {
    let sett = Sett::per_cm(24.0, 22.0);
    Arc::new(Design::new("follow", Structure::Pattern(weave), yarns, maps, sett).unwrap())
}

fn twill() -> WeavePattern {
    WeavePattern::from_fn(SIZE, SIZE, |end, pick| (end + SIZE - pick) % 4 < 2)
}

fn plain_maps() -> YarnMaps {
    YarnMaps::plain(YarnId(0), YarnId(1))
}

fn request() -> StillRequest {
    StillRequest {
        settings: Settings::default().at_level(3),
        ..StillRequest::default()
    }
}

fn made(design: &Arc<Design>) -> PreparedCloth {
    prepare(design, &request(), &ExemplarStore::user(), &Job::new()).unwrap()
}

/// The cloth after an edit, and whether it had to build exemplars first.
fn followed(cloth: &PreparedCloth, design: &Arc<Design>) -> Option<(PreparedCloth, bool)> {
    let drawdown = Arc::new(design.weave());
    match follow(cloth, design, &drawdown, &request(), &Job::new()).unwrap()? {
        Followed::Ready(cloth) => Some((cloth, false)),
        Followed::Unfinished(cloth) => Some((
            cloth.complete(&ExemplarStore::user(), &Job::new()).unwrap(),
            true,
        )),
    }
}

fn voxels(prepared: &PreparedCloth) -> Vec<Voxel> {
    let cloth = prepared.cloth();
    // The range in which a cloth may hold matter depends on which exemplars are built.
    let (low, high) = (-0.4, 0.4);
    let mut random = Random::new(7, 0, 0);
    (0..20_000)
        .map(|_| {
            let [x, y] = random.pair().map(|u| 14.0 * u - 1.0);
            cloth.voxel_at(Vec3::new(x, y, low + (high - low) * random.uniform()))
        })
        .collect()
}

#[test]
fn following_is_making_anew() {
    let before = design(twill(), yarns(), plain_maps());
    let cloth = made(&before);
    let mut float = twill();
    for end in 4..11 {
        float.set(end, 5, true);
    }
    let mut recoloured = yarns();
    recoloured[1].colour = Srgb(200, 20, 20);
    recoloured[0].gloss = Some(0.05);
    let striped = YarnMaps::orders(vec![YarnId(0), YarnId(0), YarnId(1)], vec![YarnId(1)]);
    let plain = WeavePattern::from_fn(SIZE, SIZE, |end, pick| (end + pick) % 2 == 0);
    let larger = WeavePattern::from_fn(SIZE * 2, 10, |end, pick| (end + pick) % 3 == 0);
    for (what, edited) in [
        ("a float", design(float, yarns(), plain_maps())),
        ("colours", design(twill(), recoloured, plain_maps())),
        ("stripes", design(twill(), yarns(), striped)),
        ("all crossings", design(plain, yarns(), plain_maps())),
        ("another size", design(larger, yarns(), plain_maps())),
    ] {
        let (after, _) = followed(&cloth, &edited).unwrap();
        let anew = voxels(&made(&edited));
        let other = voxels(&after);
        let off = other.iter().zip(&anew).filter(|(a, b)| a != b);
        let off: Vec<_> = off.take(3).collect();
        assert!(other == anew, "{what}: {off:?}");
        assert!(!after.cloth().unbuilt().contains(&true), "{what}");
        // Control: the cloth as it was is another.
        assert!(voxels(&cloth) != anew, "{what}");
        // And back.
        let (back, built) = followed(&after, &before).unwrap();
        assert!(!built, "{what}: back again");
        let (back, own) = (voxels(&back), voxels(&cloth));
        let off = back.iter().zip(&own).filter(|(a, b)| a != b);
        let off: Vec<_> = off.collect();
        assert!(
            back == own,
            "{what}: back again: {} {:?}",
            off.len(),
            off.first()
        );
    }
}

#[test]
fn exemplars_that_an_edit_newly_needs_are_asked_for() {
    let plain = WeavePattern::from_fn(SIZE, SIZE, |end, pick| (end + pick) % 2 == 0);
    let mut float = plain.clone();
    float.set(8, 9, true);
    let before = made(&design(plain, yarns(), plain_maps()));
    let edited = design(float, yarns(), plain_maps());
    let (after, built) = followed(&before, &edited).unwrap();
    assert!(built);
    assert!(voxels(&after) == voxels(&made(&edited)));
}

#[test]
fn other_exemplars_mean_making_anew() {
    let cloth = made(&design(twill(), yarns(), plain_maps()));
    let mut silk = yarns();
    silk[0].family = Family::Silk;
    assert!(followed(&cloth, &design(twill(), silk, plain_maps())).is_none());
    let wide = Design::clone(&design(twill(), yarns(), plain_maps()));
    let wide = Arc::new(wide.with_sett(Sett::per_cm(12.0, 22.0)).unwrap());
    assert!(followed(&cloth, &wide).is_none());
    let same = design(twill(), yarns(), plain_maps());
    let drawdown = Arc::new(same.weave());
    let finer = StillRequest {
        settings: Settings::default().at_level(2),
        ..StillRequest::default()
    };
    assert!(
        follow(&cloth, &same, &drawdown, &finer, &Job::new())
            .unwrap()
            .is_none()
    );
}
