//! The picture that curves are of, and the same with other settings.

use super::AccuracyError;
use super::axis::{Asked, Axis};
use super::curve::Accuracy;
use super::model::{Choice, PATHS};

/// The same picture with as many paths as it is asked for with: no time or error ends it, as
/// that would depend on what is measured.
pub(super) fn with_paths(asked: &Asked) -> Asked {
    let mut asked = asked.clone();
    let stop = &mut asked.request.stop;
    stop.spp = stop.spp.or(Some(asked.request.settings.render.spp));
    (stop.seconds, stop.error) = (None, None);
    asked
}

/// The picture as options of a command line, as [`Accuracy::picture`] says them.
pub fn options(asked: &Asked) -> String {
    let spp = Some(paths_asked(asked));
    let still = crate::engine::options(&asked.request, asked.renderer.name, spp);
    still.trim().to_owned()
}

/// Paths a pixel of a picture.
pub(super) fn paths_asked(asked: &Asked) -> u32 {
    let request = &asked.request;
    request.stop.spp.unwrap_or(request.settings.render.spp)
}

impl Accuracy {
    /// Whether a picture is the one that was measured, whatever the measured dials and the
    /// paths are set to.
    pub fn is_of(&self, asked: &Asked) -> bool {
        let dials = (self.dials.iter()).filter(|curve| curve.name != PATHS);
        let settings = dials.map(|curve| (&curve.name, &curve.current));
        let Ok(mut same) = set(asked, settings) else {
            return false;
        };
        if self.spp > 0 {
            same.request.stop.spp = Some(self.spp);
        }
        options(&same) == self.picture
    }
}

impl Choice {
    /// A picture with these settings but for its paths: when it ends is said otherwise.
    ///
    /// # Errors
    /// When a dial does not take its setting.
    pub fn set(&self, asked: &Asked) -> Result<Asked, AccuracyError> {
        let dials = (self.settings.iter()).filter(|(name, _)| name != PATHS);
        set(asked, dials.map(|(name, value)| (name, value)))
    }

    /// Paths a pixel.
    pub fn paths(&self) -> Option<u32> {
        let known = self.settings.iter().find(|(name, _)| name == PATHS);
        known.and_then(|(_, value)| value.parse().ok())
    }
}

fn set<'s>(
    asked: &Asked,
    mut settings: impl Iterator<Item = (&'s String, &'s String)>,
) -> Result<Asked, AccuracyError> {
    settings.try_fold(asked.clone(), |asked, (name, value)| {
        let axis = Axis::named(name)?;
        // What it is set to already is not said again.
        match axis.current(&asked) == *value {
            true => Ok(asked),
            false => axis.set(&asked, value),
        }
    })
}
