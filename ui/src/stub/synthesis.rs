//! Assignment and edge fixing, measured.

use pickglass::job::{Cancelled, Job};

use super::design::Design;

pub struct Request {
    pub method: &'static str,
    pub rank: u32,
    pub seed: u64,
}

#[derive(Debug, Default)]
pub struct Report {
    pub crossings: u64,
    pub seconds: Vec<(String, f64)>,
    pub total_seconds: f64,
    pub bytes: u64,
    pub consistency_sum: u64,
    pub consistency_max: u64,
    pub continuity_before: u64,
    pub continuity_after: u64,
    pub continuity_max: u64,
    pub seam_rms_before: f64,
    pub seam_rms_after: f64,
}

pub fn measure(design: &Design, _request: &Request, job: &Job) -> Result<Report, Cancelled> {
    job.report("assigning blocks", 0.5);
    job.check()?;
    Ok(Report {
        crossings: u64::from(design.pattern.ends()) * u64::from(design.pattern.picks()),
        ..Report::default()
    })
}
