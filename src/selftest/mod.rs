//! Hard cases that are tried on a user's machine: does everything hold here as well?
//!
//! Each row of [`CASES`] is one case that once was, or would be, a wrong picture, a hang or a
//! crash. Those of a design are tried with every engine of
//! [`RENDERERS`], so that a new one is tried as soon as it is there. What
//! a case expects is a known value, or is worked out in another way than by what is tried. A
//! case that panics has failed like any other; what takes longer than seconds stands in
//! `tests/hard_cases`, which tries these as well.

mod damage;
mod drawing;
mod fault;
mod files;
mod sums;
mod walks;

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::Instant;

pub use damage::damaged;
use fault::Fault;

use crate::engine::{RENDERERS, Renderer, StillError};
use crate::job::{Cancelled, Job};

/// One hard case.
pub struct Case {
    /// Its name on the command line and in reports.
    pub name: &'static str,
    /// What is tried.
    pub about: &'static str,
    tried: Tried,
}

/// What a case is tried on. Says what was seen.
enum Tried {
    Once(fn(&Job) -> Result<String, Fault>),
    EachRenderer(fn(&Renderer, &Job) -> Result<String, Fault>),
}

/// All cases, in the order in which they are tried.
pub static CASES: &[Case] = &[
    Case {
        name: "rays-that-are-none",
        about: "Rays without a place or a direction end at once, and are counted",
        tried: Tried::Once(walks::rays_that_are_none),
    },
    Case {
        name: "rays-along-axes",
        about: "Rays along axes, through corners and from faces meet what is there",
        tried: Tried::Once(walks::rays_along_axes),
    },
    Case {
        name: "extreme-random-numbers",
        about: "Random numbers of 0 and next to 1 end every walk",
        tried: Tried::Once(walks::extreme_random_numbers),
    },
    Case {
        name: "densest-matter",
        about: "Matter a million times too dense, beside nothing, is within its bounds",
        tried: Tried::Once(walks::densest_matter),
    },
    Case {
        name: "empty-volume",
        about: "Where nothing is the background shows exactly",
        tried: Tried::Once(walks::empty_volume),
    },
    Case {
        name: "white-furnace",
        about: "White fibres in even light cannot be seen, however they lie and shine",
        tried: Tried::Once(walks::white_furnace),
    },
    Case {
        name: "a-million-samples",
        about: "A million samples of a pixel add up without drift",
        tried: Tried::Once(sums::a_million_samples),
    },
    Case {
        name: "poisoned-samples",
        about: "Samples that are no numbers stay out of a picture",
        tried: Tried::Once(sums::poisoned_samples),
    },
    Case {
        name: "threads",
        about: "One, two and five threads make the same picture to the last bit",
        tried: Tried::Once(sums::threads),
    },
    Case {
        name: "smallest-designs",
        about: "One crossing, one end, one pick and one yarn on top throughout",
        tried: Tried::EachRenderer(drawing::smallest_designs),
    },
    Case {
        name: "setts",
        about: "From a fishing net to yarns far thicker than their spacing",
        tried: Tried::EachRenderer(drawing::setts),
    },
    Case {
        name: "noise-as-a-weave",
        about: "A weave without any order, and a stripe that does not fit it",
        tried: Tried::EachRenderer(drawing::noise_as_a_weave),
    },
    Case {
        name: "edge-fixing",
        about: "Seams closed by no profile, by one and by more than there are",
        tried: Tried::EachRenderer(drawing::ranks),
    },
    Case {
        name: "views",
        about: "All views, lowest eyes and lowest suns, near and far",
        tried: Tried::EachRenderer(drawing::views),
    },
    Case {
        name: "far-from-the-origin",
        about: "The cloth is itself kilometres away",
        tried: Tried::EachRenderer(drawing::far_from_the_origin),
    },
    Case {
        name: "damaged-files",
        about: "Damaged designs, drafts and images are read or refused in one line",
        tried: Tried::Once(files::damaged_files),
    },
    Case {
        name: "damaged-recovery",
        about: "Of a damaged recovery copy what is whole comes back",
        tried: Tried::Once(files::damaged_recovery),
    },
];

/// How a case went.
#[derive(Debug, Clone, PartialEq)]
pub struct Verdict {
    /// The case, with the engine's name where it was tried with one.
    pub name: String,
    /// What was tried.
    pub about: &'static str,
    /// What was seen, or what is wrong.
    pub seen: Result<String, String>,
    /// Seconds that it took.
    pub seconds: f64,
}

/// Cases that cannot be tried.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum SelftestError {
    /// No case has this name.
    #[error("no hard case is called {0:?}; the cases are {names}", names = names())]
    Unknown(String),
    /// The job was cancelled.
    #[error("cancelled before all cases were tried")]
    Cancelled(#[from] Cancelled),
}

fn names() -> String {
    let names: Vec<&str> = CASES.iter().map(|case| case.name).collect();
    names.join(", ")
}

/// Tries the cases of these names, or all where there are none, and says of each how it went as
/// soon as that is known.
///
/// # Errors
/// A name that no case has, before anything is tried; and when the job is cancelled.
pub fn run(
    wanted: &[String],
    job: &Job,
    said: &mut dyn FnMut(&Verdict),
) -> Result<Vec<Verdict>, SelftestError> {
    for name in wanted {
        if !CASES.iter().any(|case| case.name == *name) {
            return Err(SelftestError::Unknown(name.clone()));
        }
    }
    let asked = |case: &&Case| wanted.is_empty() || wanted.iter().any(|name| name == case.name);
    let trials: Vec<(&Case, Option<&Renderer>)> = (CASES.iter().filter(asked))
        .flat_map(|case| match case.tried {
            Tried::Once(_) => vec![(case, None)],
            Tried::EachRenderer(_) => RENDERERS.iter().map(|row| (case, Some(*row))).collect(),
        })
        .collect();
    let mut verdicts = Vec::with_capacity(trials.len());
    for (number, (case, renderer)) in trials.iter().enumerate() {
        job.check()?;
        let name = match renderer {
            Some(renderer) => format!("{} ({})", case.name, renderer.name),
            None => case.name.to_owned(),
        };
        job.report(&name, number as f32 / trials.len() as f32);
        let verdict = verdict(name, case.about, || match (&case.tried, renderer) {
            (Tried::Once(tried), _) => tried(&quiet(job)),
            (Tried::EachRenderer(tried), Some(renderer)) => tried(renderer, &quiet(job)),
            (Tried::EachRenderer(_), None) => Ok(String::new()),
        })?;
        said(&verdict);
        verdicts.push(verdict);
    }
    Ok(verdicts)
}

/// The job, which reports cases alone and not what they do.
fn quiet(job: &Job) -> Job {
    job.clone().with_listener(|_, _| {})
}

fn verdict(
    name: String,
    about: &'static str,
    tried: impl FnOnce() -> Result<String, Fault>,
) -> Result<Verdict, Cancelled> {
    let begun = Instant::now();
    let seen = match catch_unwind(AssertUnwindSafe(tried)) {
        Ok(Ok(seen)) => Ok(seen),
        Ok(Err(Fault::Cancelled(cancelled))) => return Err(cancelled),
        Ok(Err(Fault::Picture(StillError::Cancelled(cancelled)))) => return Err(cancelled),
        Ok(Err(fault)) => Err(fault.to_string()),
        Err(panic) => Err(format!("the program broke: {}", message(&*panic))),
    };
    Ok(Verdict {
        name,
        about,
        seen,
        seconds: begun.elapsed().as_secs_f64(),
    })
}

/// What a panic said.
fn message(panic: &(dyn std::any::Any + Send)) -> &str {
    let said = panic.downcast_ref::<&str>().copied();
    let said = said.or_else(|| panic.downcast_ref::<String>().map(String::as_str));
    said.unwrap_or("it did not say why")
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::panic, reason = "a test may fail")]
mod tests {
    use super::*;

    fn of(tried: impl FnOnce() -> Result<String, Fault>) -> Result<Verdict, Cancelled> {
        verdict("case".to_owned(), "about", tried)
    }

    #[test]
    fn what_breaks_or_is_wrong_has_failed_and_says_why() {
        let broken = of(|| panic!("at the seam")).unwrap();
        assert_eq!(
            broken.seen,
            Err("the program broke: at the seam".to_owned())
        );
        let wrong = of(|| {
            Fault::unless(1 + 1 == 3, || "sums".to_owned())?;
            Ok("sound".to_owned())
        });
        assert_eq!(wrong.unwrap().seen, Err("sums".to_owned()));
        assert_eq!(
            of(|| Ok("sound".to_owned())).unwrap().seen.unwrap(),
            "sound"
        );
        assert!(of(|| Err(Cancelled.into())).is_err());
    }

    #[test]
    fn names_are_known_once_and_the_rest_is_refused() {
        for (at, case) in CASES.iter().enumerate() {
            assert!(CASES[..at].iter().all(|other| other.name != case.name));
            assert!(!case.about.ends_with('.'), "{}", case.about);
        }
        let job = Job::new();
        let refused = run(&["glow".to_owned()], &job, &mut |_| {}).unwrap_err();
        let said = refused.to_string();
        assert!(
            said.contains("glow") && said.contains("white-furnace"),
            "{said}"
        );
        job.cancel();
        let cancelled = run(&[], &job, &mut |_| panic!("nothing is tried"));
        assert_eq!(cancelled, Err(SelftestError::Cancelled(Cancelled)));
    }
}
