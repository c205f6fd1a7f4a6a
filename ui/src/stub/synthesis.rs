//! Assignment and edge fixing, measured.

use pickglass::design::Design;
use pickglass::job::{Cancelled, Job};
use pickglass::synthesis::SynthesisSettings;

#[derive(Debug, Clone, Copy)]
pub struct Request {
    pub settings: SynthesisSettings,
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
        crossings: u64::from(design.ends()) * u64::from(design.picks()),
        ..Report::default()
    })
}
