//! The table of engines.

use super::renderer::Renderer;
use super::{StillError, first_sight, tracer};

/// All engines.
pub static RENDERERS: &[&Renderer] = &[&tracer::CPU, &first_sight::SIGHT];

/// The engine that the others are measured against, and that draws everything.
pub fn reference() -> &'static Renderer {
    &tracer::CPU
}

/// The engine of a name; `auto` is the best that there is.
///
/// # Errors
/// [`StillError::Renderer`].
pub fn renderer(name: &str) -> Result<&'static Renderer, StillError> {
    if name == "auto" {
        return Ok(reference());
    }
    let known = RENDERERS.iter().find(|row| row.name == name).copied();
    match known {
        Some(known) => Ok(known),
        None => {
            let names: Vec<&str> = RENDERERS.iter().map(|row| row.name).collect();
            Err(StillError::Renderer(name.to_owned(), names.join(" or ")))
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;
    use crate::engine::StillRequest;
    use crate::plan::{Effect, Subject};

    #[test]
    fn engines_are_known_by_name_and_the_rest_is_refused() {
        for row in RENDERERS {
            assert_eq!(renderer(row.name).unwrap(), *row);
        }
        assert_eq!(renderer("auto").unwrap(), reference());
        let refused = renderer("gpu").unwrap_err().to_string();
        assert!(
            refused.contains("gpu") && refused.contains("cpu"),
            "{refused}"
        );
    }

    #[test]
    fn what_an_engine_has_none_of_is_off_and_says_so() {
        let request = StillRequest::default();
        let plan = first_sight::SIGHT.plan(&request, Subject::Cloth).unwrap();
        assert!(!plan.on(Effect::Hairs) && !plan.render.shadows);
        assert!(!plan.showing.denoise, "it has no noise");
        let plan = reference().plan(&request, Subject::Cloth).unwrap();
        assert!(plan.on(Effect::Hairs));
        assert!(first_sight::SIGHT.check(Subject::Voxels).is_err());
        assert!(first_sight::SIGHT.check(Subject::Cloth).is_ok());
    }
}
