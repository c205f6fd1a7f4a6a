//! The weave library against drawings made from the textbooks' rules.
//!
//! `tests/fixtures/weaves/` holds a drawing of every weave with the rule it was drawn by:
//! by hand, or by other means than the program's (rows moved sideways, ends picked out of a
//! drawn twill, quarters reversed). What defines each family is checked besides.

#![allow(clippy::unwrap_used, reason = "a test may fail")]

use std::collections::BTreeMap;

use pickglass::design::checks::loose_layer;
use pickglass::design::library::{find, library, read_library};
use pickglass::design::{Fill, LibraryWeave, WeavePattern, floats, satin_moves, weave};

const DRAWINGS: [&str; 12] = [
    include_str!("../fixtures/weaves/plain.txt"),
    include_str!("../fixtures/weaves/rib.txt"),
    include_str!("../fixtures/weaves/basket.txt"),
    include_str!("../fixtures/weaves/twill.txt"),
    include_str!("../fixtures/weaves/fancy-twill.txt"),
    include_str!("../fixtures/weaves/satin.txt"),
    include_str!("../fixtures/weaves/crepe.txt"),
    include_str!("../fixtures/weaves/texture.txt"),
    include_str!("../fixtures/weaves/block.txt"),
    include_str!("../fixtures/weaves/damask.txt"),
    include_str!("../fixtures/weaves/colour.txt"),
    include_str!("../fixtures/weaves/double.txt"),
];

/// Every drawing by name.
fn drawings() -> BTreeMap<String, WeavePattern> {
    let mut drawn = BTreeMap::new();
    for text in DRAWINGS {
        for section in text.split("\n= ").skip(1) {
            let (name, rest) = section.split_once('\n').unwrap();
            let art: Vec<&str> = rest.lines().filter(|line| !line.starts_with(';')).collect();
            let pattern = WeavePattern::parse(&art.join("\n")).unwrap();
            assert!(drawn.insert(name.to_owned(), pattern).is_none(), "{name}");
        }
    }
    drawn
}

#[test]
fn the_embedded_files_can_be_read() {
    let read = read_library().unwrap();
    assert_eq!(read.len(), library().len());
    assert!(read.len() >= 60, "{}", read.len());
    for weave in library() {
        assert!(!weave.usual_use().is_empty() && !weave.notation().is_empty());
        let pattern = weave.pattern();
        assert_eq!(weave.repeat(), (pattern.ends(), pattern.picks()));
    }
}

#[test]
fn every_weave_is_as_it_is_drawn() {
    let mut drawn = drawings();
    for weave in library() {
        let name = weave.name();
        let Some(expected) = drawn.remove(name) else {
            panic!("{name} has no drawing");
        };
        let found = weave.pattern();
        assert!(
            *found == expected,
            "{name}: drawn\n{expected}found\n{found}"
        );
        // A drawing with one mark wrong is another weave.
        let mut wrong = expected.clone();
        wrong.set(0, 0, !wrong.get(0, 0));
        assert!(*found != wrong);
    }
    assert!(drawn.is_empty(), "drawn but not in the library: {drawn:?}");
}

#[test]
fn names_are_notations_in_any_spelling_and_belong_to_one_weave() {
    let mut names = BTreeMap::new();
    for entry in library() {
        for name in std::iter::once(entry.name()).chain(entry.also().iter().map(String::as_str)) {
            assert_eq!(
                names.insert(name.to_lowercase(), entry.name()),
                None,
                "{name}"
            );
            assert_eq!(weave(name).unwrap(), *entry.pattern(), "{name}");
            assert_eq!(
                find(&name.to_uppercase()).map(LibraryWeave::name),
                Some(entry.name())
            );
        }
    }
    assert_eq!(find(" CREPE   8 ").map(LibraryWeave::name), Some("crêpe 8"));
    assert!(find("honeycomb 9").is_none());
    let error = weave("honeycomb 9").unwrap_err().to_string();
    assert!(error.contains("library"), "{error}");
    let fill = Fill::by_notation("honeycomb 8").unwrap();
    assert_eq!(fill.notation(), Some("honeycomb 8"));
    assert_eq!(fill.pattern(), find("waffle").unwrap().pattern());
}

fn family(name: &str) -> Vec<&'static LibraryWeave> {
    let list: Vec<_> = library()
        .iter()
        .filter(|weave| weave.family() == name)
        .collect();
    assert!(!list.is_empty(), "{name}");
    list
}

fn at(pattern: &WeavePattern, end: u32, pick: u32) -> bool {
    pattern.get_wrapped(i64::from(end), i64::from(pick))
}

/// Whether the pattern is the same one pick up and `ends` to the right.
fn moves_by(pattern: &WeavePattern, ends: u32) -> bool {
    (0..pattern.picks()).all(|pick| {
        (0..pattern.ends()).all(|end| at(pattern, end + ends, pick + 1) == pattern.get(end, pick))
    })
}

#[test]
fn every_thread_is_bound_and_only_double_cloths_fall_apart() {
    for weave in library() {
        let found = floats(weave.pattern());
        let name = weave.name();
        assert!(
            found.unbound_ends.is_empty() && found.unbound_picks.is_empty(),
            "{name}"
        );
        assert_eq!(
            loose_layer(weave.pattern()).is_some(),
            weave.preview_only(),
            "{name}"
        );
    }
}

#[test]
fn twill_lines_rise_to_the_right_or_to_the_left() {
    for weave in family("twill") {
        let left = weave.name().starts_with("s ");
        let pattern = weave.pattern();
        let step = if left { pattern.ends() - 1 } else { 1 };
        assert!(moves_by(pattern, step), "{}", weave.name());
        assert!(pattern.get(0, 0) && !at(pattern, 0, pattern.picks() - 1));
        // The ratio runs up end 0.
        let ratio = weave
            .name()
            .trim_start_matches("s ")
            .trim_end_matches(" twill");
        let column: Vec<bool> = (0..pattern.picks())
            .map(|pick| pattern.get(0, pick))
            .collect();
        let runs: Vec<String> = column
            .chunk_by(|a, b| a == b)
            .map(|run| run.len().to_string())
            .collect();
        assert_eq!(runs.join("/"), ratio);
    }
    // The measure can fail.
    assert!(!moves_by(find("s 3/1 twill").unwrap().pattern(), 1));
    assert!(!moves_by(find("2/2 broken twill").unwrap().pattern(), 1));
}

/// Ties of a satin (the rarer mark): their ends by pick, if there is one an end and pick.
fn ties(pattern: &WeavePattern) -> Option<Vec<u32>> {
    let threads = u64::from(pattern.ends());
    let rare = pattern.count_warp_up() == threads;
    let mut ties: Vec<u32> = Vec::new();
    for pick in 0..pattern.picks() {
        let on_pick: Vec<u32> = (0..pattern.ends())
            .filter(|&end| pattern.get(end, pick) == rare)
            .collect();
        match on_pick.as_slice() {
            &[end] if !ties.contains(&end) => ties.push(end),
            _ => return None,
        }
    }
    (ties.len() as u64 == threads).then_some(ties)
}

/// Whether ties of neighbouring picks touch at a corner.
fn touching(ties: &[u32]) -> bool {
    let count = ties.len() as u32;
    (0..ties.len()).any(|pick| {
        let apart = (ties[(pick + 1) % ties.len()] + count - ties[pick]) % count;
        apart == 1 || apart == count - 1
    })
}

#[test]
fn satins_bind_every_thread_once_and_ties_do_not_touch() {
    let mut seen = 0;
    for weave in family("satin") {
        let name = weave.name();
        let found = ties(weave.pattern()).unwrap_or_else(|| panic!("{name} is no satin"));
        // On four ends ties must touch somewhere; the irregular satin keeps that to half.
        assert_eq!(touching(&found), found.len() == 4, "{name}");
        if let Some((_, step)) = name.split_once(" move ") {
            assert!(moves_by(weave.pattern(), step.parse().unwrap()), "{name}");
            seen += 1;
        }
    }
    assert!(seen > 50);
    for ends in 5..=16u32 {
        for step in satin_moves(ends) {
            assert!(find(&format!("1/{} satin move {step}", ends - 1)).is_some());
        }
    }
    // A twill binds every thread once too, but its ties touch.
    assert!(touching(&ties(&weave("1/5 twill").unwrap()).unwrap()));
    assert_eq!(ties(&weave("2/2 twill").unwrap()), None);
}

#[test]
fn ribs_and_baskets_are_plain_weave_drawn_out() {
    for weave in family("rib").into_iter().chain(family("basket")) {
        let pattern = weave.pattern();
        // Every pick is the first or its opposite, and every end likewise.
        for pick in 0..pattern.picks() {
            let same = pattern.get(0, pick) == pattern.get(0, 0);
            for end in 0..pattern.ends() {
                assert_eq!(pattern.get(end, pick) == pattern.get(end, 0), same);
            }
        }
    }
    for weave in family("basket") {
        assert_eq!(weave.pattern().transposed(), *weave.pattern());
    }
    assert_eq!(find("3/3 warp rib").unwrap().repeat(), (2, 6));
    assert_eq!(find("3/3 weft rib").unwrap().repeat(), (6, 2));
}

#[test]
fn corkscrews_show_warp_lines_alone() {
    for (name, over) in [("corkscrew 5", 3), ("corkscrew 7", 4), ("corkscrew 9", 5)] {
        let pattern = find(name).unwrap().pattern();
        let longest = floats(pattern).longest;
        // No weft float on the face passes two ends: neighbours cover the gap.
        assert_eq!(
            (longest.warp_face, longest.weft_face),
            (over, 1),
            "{name}\n{pattern}"
        );
    }
}

#[test]
fn honeycombs_are_symmetric_cells() {
    for name in ["honeycomb 6", "honeycomb 8"] {
        let pattern = find(name).unwrap().pattern();
        let size = pattern.ends();
        for pick in 0..size {
            for end in 0..size {
                let here = pattern.get(end, pick);
                assert_eq!(at(pattern, size - end, pick), here);
                assert_eq!(at(pattern, end, size - pick), here);
            }
        }
        let longest = floats(pattern).longest;
        // Long floats frame the cell, short ones are its floor.
        assert_eq!(
            (longest.warp_face, longest.weft_face),
            (size - 3, size - 1),
            "{name}"
        );
    }
}

#[test]
fn mock_lenos_split_between_their_groups() {
    for (name, group) in [("mock leno 6", 3), ("mock leno 8", 4), ("mock leno 10", 5)] {
        let pattern = find(name).unwrap().pattern();
        for pick in 0..2 * group {
            for end in 0..2 * group {
                // The next quarter is the reverse, sideways and upwards.
                assert_ne!(at(pattern, end + group, pick), pattern.get(end, pick));
                assert_ne!(at(pattern, end, pick + group), pattern.get(end, pick));
            }
            // At the border of a group neighbours are opposed on every pick.
            assert_ne!(
                pattern.get(group - 1, pick),
                pattern.get(group, pick),
                "{name}"
            );
        }
    }
}

#[test]
fn huck_and_overshot_float_on_a_plain_ground() {
    let plain = |pattern: &WeavePattern, pick: u32| {
        (0..pattern.ends()).all(|end| at(pattern, end + 1, pick) != pattern.get(end, pick))
    };
    let huck = find("huck 10").unwrap().pattern();
    let floating: Vec<u32> = (0..10).filter(|&pick| !plain(huck, pick)).collect();
    assert_eq!(floating, [1, 3, 6, 8]);
    assert_eq!(floats(huck).longest.weft_face, 5);
    let overshot = find("overshot 12").unwrap().pattern();
    for pick in 0..16 {
        assert_eq!(
            plain(overshot, pick),
            pick % 2 == 0,
            "tabby on every other pick"
        );
    }
    assert_eq!(floats(overshot).longest.weft_face, 4);
    let winter = find("summer and winter 8").unwrap().pattern();
    assert_eq!(
        floats(winter).longest.weft_face,
        3,
        "tied by every fourth end"
    );
}

#[test]
fn crepes_have_short_floats_and_no_line() {
    for weave in family("crêpe") {
        let pattern = weave.pattern();
        let longest = floats(pattern).longest;
        let most = [
            longest.warp_face,
            longest.warp_back,
            longest.weft_face,
            longest.weft_back,
        ];
        assert!(
            most.iter().all(|&float| float <= 4),
            "{}: {longest:?}",
            weave.name()
        );
        let last = pattern.ends() - 1;
        assert!(
            !moves_by(pattern, 1) && !moves_by(pattern, last),
            "{}",
            weave.name()
        );
    }
}

#[test]
fn damask_checks_are_cut_cleanly() {
    for weave in family("damask") {
        let pattern = weave.pattern();
        let half = pattern.ends() / 2;
        for thread in 0..2 * half {
            for border in [half, 2 * half] {
                assert_ne!(at(pattern, border - 1, thread), at(pattern, border, thread));
                assert_ne!(at(pattern, thread, border - 1), at(pattern, thread, border));
            }
        }
        assert_eq!(
            2 * pattern.count_warp_up(),
            4 * u64::from(half) * u64::from(half)
        );
    }
}

/// The dark and light that show on the face over the common repeat, one line a pick.
fn effect(name: &str, ends: u32, picks: u32) -> String {
    let entry = find(name).unwrap();
    let colours = entry.colours().unwrap();
    let mut rows = Vec::new();
    for pick in (0..picks).rev() {
        let row: String = (0..ends)
            .map(|end| {
                let on_top = if at(entry.pattern(), end, pick) {
                    colours.warp[end as usize % colours.warp.len()]
                } else {
                    colours.weft[pick as usize % colours.weft.len()]
                };
                if on_top == 0 { 'D' } else { '.' }
            })
            .collect();
        rows.push(row);
    }
    rows.join("\n")
}

#[test]
fn colour_and_weave_effects_look_as_they_are_called() {
    // Houndstooth: a dark square, teeth on a slant, and a light square beside it.
    let houndstooth = [
        "..DD....", ".DD.....", "DD......", "D..D....", "DDDDDD..", "DDDDD..D", "DDDD..DD",
        "DDDD.DD.",
    ];
    assert_eq!(effect("houndstooth", 8, 8), houndstooth.join("\n"));
    assert_ne!(effect("shepherd's check", 8, 8), houndstooth.join("\n"));
    assert_eq!(effect("hairline across", 4, 4), "....\nDDDD\n....\nDDDD");
    assert_eq!(effect("hairline along", 4, 4), "D.D.\nD.D.\nD.D.\nD.D.");
    // Log cabin: lines across beside lines along.
    let cabin = effect("log cabin", 16, 16);
    let rows: Vec<&str> = cabin.lines().collect();
    assert_eq!(rows[15], "DDDDDDDD.D.D.D.D");
    assert_eq!(rows[14], ".........D.D.D.D");
    assert_eq!(effect("chambray", 2, 2), ".D\nD.");
    assert_eq!(effect("sharkskin", 4, 4), "..D.\nD.DD\nD...\nDDD.");
}
