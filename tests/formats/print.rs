//! Print: pages, sizes and words of the PDF.

#![allow(clippy::unwrap_used, reason = "a test may fail")]

use pickglass::design::{
    Design, Draft, Family, Filled, Lifting, Sett, Shed, Srgb, Structure, Ties, WeavePattern, Yarn,
    YarnId, YarnMaps, usual_sett,
};
use pickglass::print::{self, Paper, PdfError, PdfOptions, Raster};

fn design(structure: Structure) -> Design {
    let yarns = vec![
        Yarn::new("navy", Family::Cotton, Srgb(20, 30, 90)),
        Yarn::new("cream (7)", Family::Cotton, Srgb(240, 230, 200)),
    ];
    let order = (0..16).map(|end| YarnId(u16::from(end % 8 >= 6))).collect();
    let maps = YarnMaps::orders(order, vec![YarnId(1)]);
    let sett = usual_sett(&yarns, &maps);
    Design::new("Köper – point twill", structure, yarns, maps, sett).unwrap()
}

/// A point twill on four shafts, four times.
fn point_twill() -> Design {
    let point = [0u16, 1, 2, 3, 2, 1];
    let rows = || Ties::from_rows((0..24).map(|thread| [point[thread % 6]]));
    let lifting = Lifting::Treadled {
        tieup: Ties::from_rows([[0, 1], [1, 2], [2, 3], [0, 3]]),
        treadling: rows(),
    };
    design(Structure::Draft(
        Draft::new(4, 4, Shed::Rising, rows(), lifting).unwrap(),
    ))
}

fn pages(bytes: &[u8]) -> usize {
    String::from_utf8_lossy(bytes)
        .matches("/Type /Page\n")
        .count()
}

#[test]
fn a_draft_its_lists_and_the_cloth_are_three_pages() {
    let design = point_twill();
    let weave = design.weave();
    let bytes = print::write(&design, &weave, &PdfOptions::default()).unwrap();
    assert!(bytes.starts_with(b"%PDF-"));
    assert_eq!(pages(&bytes), 3);
    let lists = PdfOptions {
        draft: false,
        cloth: false,
        ..PdfOptions::default()
    };
    assert_eq!(pages(&print::write(&design, &weave, &lists).unwrap()), 1);
    let text = String::from_utf8_lossy(&bytes).into_owned();
    assert!(text.contains("/MediaBox [0 0 595.27"), "A4");
    let letter = PdfOptions {
        paper: Paper::Letter,
        ..PdfOptions::default()
    };
    let bytes = print::write(&design, &weave, &letter).unwrap();
    assert!(
        String::from_utf8_lossy(&bytes).contains("/MediaBox [0 0 612"),
        "Letter"
    );
    if let Ok(folder) = std::env::var("PICKGLASS_PDF_OUT") {
        std::fs::write(format!("{folder}/point-twill.pdf"), &bytes).unwrap();
        let filled = Filled::once("1/7 satin move 3").unwrap();
        let large = design_of(filled.fill().pattern().repeated(700, 500, (0, 0)));
        let options = PdfOptions {
            draft: false,
            ..PdfOptions::default()
        };
        let bytes = print::write(&large, &large.weave(), &options).unwrap();
        std::fs::write(format!("{folder}/panel.pdf"), &bytes).unwrap();
    }
}

fn design_of(pattern: WeavePattern) -> Design {
    design(Structure::Pattern(pattern))
        .with_sett(Sett::per_cm(30.0, 20.0))
        .unwrap()
}

#[test]
fn what_does_not_fit_is_refused_with_a_remedy() {
    let pattern = WeavePattern::from_fn(5120, 6300, |end, pick| (end ^ pick) & 1 == 0);
    let large = design_of(pattern);
    let weave = large.weave();
    let only = |draft, cloth| PdfOptions {
        draft,
        cloth,
        lists: false,
        ..PdfOptions::default()
    };
    let refused = print::write(&large, &weave, &only(true, false)).unwrap_err();
    assert!(matches!(
        refused,
        PdfError::TooManyPages { part: "draft", .. }
    ));
    assert!(refused.to_string().contains("crop"), "{refused}");
    assert_eq!(
        print::write(&large, &weave, &only(false, false)),
        Err(PdfError::Nothing)
    );
    // 1.7 m × 3.15 m of cloth.
    let refused = print::write(&large, &weave, &only(false, true)).unwrap_err();
    assert!(matches!(
        refused,
        PdfError::TooManyPages { part: "cloth", .. }
    ));
    let sheet = |width, pixels, width_mm| {
        let picture = Some(Raster {
            width,
            pixels,
            width_mm,
        });
        print::write(
            &large,
            &weave,
            &PdfOptions {
                picture,
                ..only(false, true)
            },
        )
    };
    assert_eq!(pages(&sheet(4, &[9; 48], 40.0).unwrap()), 1);
    assert_eq!(pages(&sheet(4, &[9; 48], 400.0).unwrap()), 8);
    for (width, pixels, mm) in [(0, &[9u8; 48][..], 1.0), (5, &[9; 48], 1.0), (4, &[], 1.0)] {
        assert!(matches!(
            sheet(width, pixels, mm),
            Err(PdfError::Picture(_))
        ));
    }
    for mm in [0.0, -1.0, f32::NAN, f32::INFINITY] {
        assert!(
            matches!(sheet(4, &[9; 48], mm), Err(PdfError::Picture(_))),
            "{mm}"
        );
    }
    let refused = sheet(4, &[9; 48], 1e9).unwrap_err().to_string();
    assert!(refused.contains("larger than a page"), "{refused}");
}
