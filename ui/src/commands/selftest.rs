//! `pickglass selftest`: hard cases tried on this machine.

use pickglass::selftest::{self, SelftestError, Verdict};
use serde_json::{Value, json};

use crate::cli::SelftestArgs;
use crate::interrupt::Interrupt;
use crate::out::{self, Progress};

/// Tries the cases; an error where one does not hold.
pub fn run(args: &SelftestArgs) -> anyhow::Result<()> {
    let progress = Progress::new();
    let job = progress.job();
    let interrupt = Interrupt::watch(&job);
    let mut said = Ok(());
    let mut say = |verdict: &Verdict| {
        if !args.json && said.is_ok() {
            progress.finish();
            said = out::say(&vec![line(verdict)]);
        }
    };
    let verdicts = selftest::run(&args.cases, &job, &mut say);
    progress.finish();
    said?;
    let verdicts = match verdicts {
        Err(SelftestError::Cancelled(_)) if interrupt.happened() => {
            anyhow::bail!("interrupted before all cases were tried: give it more time")
        }
        verdicts => verdicts?,
    };
    let failed = verdicts.iter().filter(|verdict| verdict.seen.is_err());
    let (failed, all) = (failed.count(), verdicts.len());
    match args.json {
        true => out::say_json(&verdicts_json(&verdicts))?,
        false => {
            let seconds: f64 = verdicts.iter().map(|verdict| verdict.seconds).sum();
            out::say(&vec![format!(
                "{} of {all} hold, {seconds:.1} s",
                all - failed
            )])?;
        }
    }
    match failed {
        0 => Ok(()),
        _ => anyhow::bail!(
            "{failed} of {all} hard cases do not hold here: please report them, with this table \
             and what `pickglass --version` says"
        ),
    }
}

/// A case in a line.
fn line(verdict: &Verdict) -> String {
    let (held, seen) = match &verdict.seen {
        Ok(seen) => ("ok", seen),
        Err(wrong) => ("FAILED", wrong),
    };
    format!(
        "{held:<6} {:<28} {:>6.2} s  {seen}",
        verdict.name, verdict.seconds
    )
}

/// All cases, with the keys that scripts rely on.
fn verdicts_json(verdicts: &[Verdict]) -> Value {
    let cases = verdicts.iter().map(|verdict| {
        let seen = match &verdict.seen {
            Ok(seen) | Err(seen) => seen,
        };
        json!({
            "name": verdict.name,
            "about": verdict.about,
            "ok": verdict.seen.is_ok(),
            "seen": seen,
            "seconds": verdict.seconds,
        })
    });
    json!({ "cases": cases.collect::<Vec<_>>() })
}
