//! Peak memory of a test's process.

/// Peak resident memory since the last reset in bytes; `None` where the system cannot say.
pub fn peak() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    let kilobytes: u64 = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(kilobytes * 1024)
}

/// Sets the peak back to what is resident now, and gives that.
pub fn reset_peak() -> Option<u64> {
    std::fs::write("/proc/self/clear_refs", "5").ok()?;
    peak()
}

/// Which case a process of its own runs.
const CASE: &str = "PICKGLASS_TEST_CASE";

/// Runs a test in processes of its own, one after the other, where peak memory is its alone: in
/// such a process gives the case to run. Where the test was started it gives `None` after all
/// cases have passed. `test` = `concat!(module_path!(), "::name_of_the_test")`.
///
/// # Panics
/// If a case fails, or if no test of that name was run.
pub fn alone<S: AsRef<str>>(test: &str, cases: &[S]) -> Option<String> {
    if let Ok(case) = std::env::var(CASE) {
        return Some(case);
    }
    // The harness leaves out the name of the program.
    let (_, test) = test.split_once("::").expect("a module");
    for case in cases {
        let child = std::process::Command::new(std::env::current_exe().expect("a program"))
            .args([test, "--exact", "--nocapture"])
            .env(CASE, case.as_ref())
            .output()
            .expect("a process");
        let said = String::from_utf8_lossy(&child.stdout);
        let wrong = String::from_utf8_lossy(&child.stderr);
        let ran = child.status.success() && said.contains("1 passed");
        assert!(ran, "{test} {}: {said}{wrong}", case.as_ref());
        for line in said.lines().filter(|line| line.contains("taken")) {
            println!("{line}");
        }
    }
    None
}
