//! How cloth lies before the eye: which side is up, and which end is at the right. Camera,
//! light, first sight and the window all ask here, by `View::pose` or `StillRequest::pose`; the
//! tracer knows from the camera alone whether it looks up or down.

use glam::Vec3;

/// Turned over about the y axis (the warp), the way one turns a page.
const OVER: Vec3 = Vec3::new(-1.0, 1.0, -1.0);
/// Turned by 180° as it lies.
const ROUND: Vec3 = Vec3::new(-1.0, -1.0, 1.0);

/// How cloth lies before the eye. It may be turned over, and then turned by 180° as it lies;
/// the light stays with the viewer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub struct Pose {
    /// The back is up: x and z change sign between viewer and cloth.
    pub back: bool,
    /// What was below is above: x and y change sign.
    pub turned: bool,
}

impl Pose {
    /// The face is up, end 1 at the left and pick 1 at the bottom.
    pub const FACE: Self = Self {
        back: false,
        turned: false,
    };
    /// Turned over.
    pub const BACK: Self = Self {
        back: true,
        ..Self::FACE
    };
    /// Turned by 180° as it lies.
    pub const TURNED: Self = Self {
        turned: true,
        ..Self::FACE
    };

    /// What a direction of the viewer (x to the right, y up, z towards the eye) is multiplied
    /// by, axis by axis, to be one of the cloth, and one of the cloth to be one of the viewer.
    pub fn turn(self) -> Vec3 {
        let over = if self.back { OVER } else { Vec3::ONE };
        let round = if self.turned { ROUND } else { Vec3::ONE };
        over * round
    }

    /// This one, turned once more as another says.
    pub fn and(self, other: Self) -> Self {
        Self {
            back: self.back != other.back,
            turned: self.turned != other.turned,
        }
    }

    /// Which way the cloth's z runs to the eye: +1 or −1.
    pub fn up(self) -> f32 {
        self.turn().z
    }

    /// Which ways ends and picks run on a picture, to the right and up: +1 or −1.
    pub fn ways(self) -> [f32; 2] {
        self.turn().truncate().to_array()
    }

    /// Whether the warp is seen where it lies on the face, or does not.
    pub fn sees_warp(self, on_face: bool) -> bool {
        on_face != self.back
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_pose_mirrors_the_cloth() {
        let all = [
            Pose::FACE,
            Pose::BACK,
            Pose::TURNED,
            Pose::BACK.and(Pose::TURNED),
        ];
        for pose in all {
            let turn = pose.turn();
            assert!(turn.x * turn.y * turn.z > 0.0, "{pose:?}");
            assert_eq!(turn * turn, Vec3::ONE);
            assert_eq!(pose.and(pose), Pose::FACE);
            // Seen from the back, a weft float of the face is a warp float.
            assert_eq!(pose.sees_warp(false), pose.up() < 0.0);
        }
        // Turned over and turned: in the end about the x axis.
        assert_eq!(all[3].turn(), Vec3::new(1.0, -1.0, -1.0));
        assert_eq!(Pose::BACK.ways(), [-1.0, 1.0]);
        assert_eq!(all[3].ways(), [1.0, -1.0]);
    }
}
