//! A lost graphics device: what is open is written, and the program starts itself again
//! on it.
//!
//! A device is lost while something is drawn, and drawing on may hang or break. So nothing
//! here waits for the window: the driver's call sends an order to the thread of the recovery
//! copies ([`Rescuer`]), and that thread writes, starts the program again and ends this one.

use std::ffi::OsString;
use std::process::Command;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use eframe::wgpu;

use super::autosave::{Rescued, Rescuer};

/// The window is started again at most so often ...
const MOST: usize = 3;
/// ... within so long, s.
const WITHIN: u64 = 60;

/// When the program was started again after a loss, in seconds since 1970; the earliest
/// first.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Restarts(Vec<u64>);

impl Restarts {
    /// With one more restart now; `None` = there were enough of them just before.
    pub fn again(&self, now: u64) -> Option<Self> {
        // A clock that was set back makes no restart older.
        let recent = |at: &&u64| now.saturating_sub(**at) < WITHIN;
        let mut recent: Vec<u64> = self.0.iter().filter(recent).copied().collect();
        if recent.len() >= MOST {
            return None;
        }
        recent.push(now);
        Some(Self(recent))
    }

    /// Whether the program was started again at all.
    pub fn happened(&self) -> bool {
        !self.0.is_empty()
    }
}

impl std::fmt::Display for Restarts {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let times: Vec<String> = self.0.iter().map(u64::to_string).collect();
        f.write_str(&times.join(","))
    }
}

impl std::str::FromStr for Restarts {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let times: Result<Vec<u64>, _> = text.split(',').map(str::parse).collect();
        let wrong = |_| format!("{text}: give seconds since 1970, separated by commas");
        Ok(Self(times.map_err(wrong)?))
    }
}

/// What follows a loss.
#[derive(Debug, PartialEq, Eq)]
pub enum Next {
    /// The program is started with these arguments.
    Again(Vec<OsString>),
    /// It is not: one line that says why, and where the work is.
    Stop(String),
}

/// Decides whether the program is started again, and on what.
pub fn next(rescued: &Rescued, restarts: &Restarts, now: u64) -> Next {
    let work = match rescued {
        Rescued::Nothing => "nothing was open".to_owned(),
        Rescued::File(file) => format!("all work is in {}", file.display()),
        Rescued::Copy(copy) => format!(
            "the work is in {} and is offered at the next start",
            copy.display()
        ),
        // Starting again would lose what is still in no file.
        Rescued::Failed(problem) => {
            return Next::Stop(format!(
                "the graphics device was lost and the work could not be written: {problem}"
            ));
        }
    };
    let Some(restarts) = restarts.again(now) else {
        return Next::Stop(format!(
            "the graphics device was lost {} times within a minute; {work}: update the graphics \
             driver, or set WGPU_BACKEND=gl or vulkan, and start again",
            MOST + 1
        ));
    };
    let mut arguments: Vec<OsString> = vec!["--restarted".into(), restarts.to_string().into()];
    match rescued {
        Rescued::Copy(copy) => arguments.extend(["--recover".into(), copy.into()]),
        Rescued::File(file) => {
            // A name alone could be that of a preset.
            let file = std::path::absolute(file).unwrap_or_else(|_| file.clone());
            arguments.push(file.into());
        }
        Rescued::Nothing | Rescued::Failed(_) => {}
    }
    Next::Again(arguments)
}

/// Does what follows a loss; returns the code to end with, and one line to say.
pub fn follow(rescued: &Rescued, restarts: &Restarts, more: &[OsString]) -> (i32, String) {
    let since = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH);
    let now = since.map_or(0, |since| since.as_secs());
    let arguments = match next(rescued, restarts, now) {
        Next::Again(arguments) => arguments,
        Next::Stop(line) => return (1, line),
    };
    let on = match rescued {
        Rescued::Copy(path) | Rescued::File(path) => format!(" on {}", path.display()),
        Rescued::Nothing | Rescued::Failed(_) => String::new(),
    };
    let started = std::env::current_exe()
        .and_then(|program| Command::new(program).args(arguments).args(more).spawn());
    match started {
        Ok(_) => (
            0,
            format!("the graphics device was lost: started again{on}"),
        ),
        Err(error) => (
            1,
            format!(
                "the graphics device was lost and the program could not be started again \
                 ({error}): start it; unsaved work is offered"
            ),
        ),
    }
}

/// The device that the window is drawn with.
pub struct Guard {
    device: wgpu::Device,
    lost: Arc<AtomicBool>,
}

impl Guard {
    /// Watches a device: when it is lost, `lost` is set, what is open is written, and then
    /// `then` is done on the thread of the copies.
    pub fn new(
        device: &wgpu::Device,
        rescuer: Rescuer,
        lost: Arc<AtomicBool>,
        then: Arc<dyn Fn(Rescued) + Send + Sync>,
    ) -> Self {
        let told = Arc::clone(&lost);
        // Called with the driver's locks held: it only sends.
        device.set_device_lost_callback(move |reason, message| {
            told.store(true, Ordering::SeqCst);
            log::error!("the graphics device was lost ({reason:?}) {message}");
            rescuer.rescue(Arc::clone(&then));
        });
        Self {
            device: device.clone(),
            lost,
        }
    }

    /// Asks the device how it is: one that was destroyed says so only then.
    pub fn ask(&self) {
        if !self.lost.load(Ordering::SeqCst) {
            let _ = self.device.poll(wgpu::PollType::Poll);
        }
    }

    /// Loses the device, to see what follows. It is idle then, so that it says so when it
    /// is asked next.
    pub fn destroy(&self) {
        let _ = self.device.poll(wgpu::PollType::wait_indefinitely());
        self.device.destroy();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::PathBuf;

    fn copy() -> Rescued {
        Rescued::Copy(PathBuf::from("/r/design-1.recovery"))
    }

    #[test]
    fn restarts_end_after_three_within_a_minute() {
        let mut restarts = Restarts::default();
        for now in [1000, 1010, 1020] {
            restarts = restarts.again(now).expect("again");
        }
        assert_eq!(restarts.to_string(), "1000,1010,1020");
        assert_eq!(restarts.again(1059), None);
        // The first of them is a minute ago.
        let later = restarts.again(1060).expect("again");
        assert_eq!(later.to_string(), "1010,1020,1060");
        // Losses that come once in a while never end it.
        let mut seldom = Restarts::default();
        for hour in 0..50 {
            seldom = seldom.again(hour * 3600).expect("again");
            assert_eq!(seldom, Restarts(vec![hour * 3600]));
        }
        // A clock that was set back does not open the way for a loop.
        assert_eq!(restarts.again(5), None);
    }

    #[test]
    fn times_are_read_as_they_are_written() {
        let restarts = Restarts(vec![1_763_800_000, 1_763_800_007]);
        assert_eq!(restarts.to_string().parse(), Ok(restarts));
        for wrong in ["", "now", "1,", "-4", "99999999999999999999999"] {
            assert!(wrong.parse::<Restarts>().is_err(), "{wrong:?}");
        }
    }

    #[test]
    fn the_next_start_is_on_what_was_written() {
        let fresh = Restarts::default();
        let again = |rescued: &Rescued| match next(rescued, &fresh, 77) {
            Next::Again(arguments) => arguments,
            Next::Stop(line) => panic!("{line}"),
        };
        assert_eq!(
            again(&copy()),
            ["--restarted", "77", "--recover", "/r/design-1.recovery"]
        );
        let file = PathBuf::from("/designs/cloth.ron");
        assert_eq!(
            again(&Rescued::File(file)),
            ["--restarted", "77", "/designs/cloth.ron"]
        );
        assert_eq!(again(&Rescued::Nothing), ["--restarted", "77"]);
    }

    #[test]
    fn where_it_ends_one_line_says_where_the_work_is() {
        let often = Restarts(vec![70, 71, 72]);
        let Next::Stop(line) = next(&copy(), &often, 77) else {
            panic!("a loop")
        };
        assert!(line.contains("/r/design-1.recovery") && line.contains("driver"));
        assert!(!line.contains('\n'));
        // Work that is in no file is not left behind by a restart.
        let failed = Rescued::Failed("the disk is full".to_owned());
        let Next::Stop(line) = next(&failed, &Restarts::default(), 77) else {
            panic!("the work is lost")
        };
        assert!(line.contains("the disk is full"));
    }
}
