//! Cameras with true scale in millimetres, and the named views.
//!
//! Cloth space: x to the right (ends follow each other), y up (picks follow each other),
//! z out of the face. On film up is +y unless a view says otherwise.

use glam::Vec3;
use strum::{Display, EnumMessage, EnumString, IntoStaticStr, VariantArray};

use super::Ray;
use super::pose::Pose;

/// How rays leave the film.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Projection {
    /// All from one eye.
    Perspective,
    /// All in one direction.
    Orthographic,
}

/// A camera whose frame is `width_mm` wide at its target.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    projection: Projection,
    eye: Vec3,
    target: Vec3,
    right: Vec3,
    up: Vec3,
    forward: Vec3,
    width_mm: f32,
    width: u32,
    height: u32,
}

/// The named views of a cloth.
#[derive(
    Debug,
    Clone,
    Copy,
    PartialEq,
    Eq,
    Hash,
    Default,
    Display,
    EnumString,
    EnumMessage,
    IntoStaticStr,
    VariantArray,
)]
#[strum(serialize_all = "kebab-case")]
pub enum View {
    /// Straight on the face, without perspective: true scale everywhere.
    #[default]
    Face,
    /// The other side, after turning the cloth over about its y axis (the warp), as one
    /// turns a page: right and left change places, up stays up.
    Back,
    /// A hand lens: perspective, 20° off the normal, a narrow frame.
    Close,
    /// Perspective from the lower edge, 45° above the cloth.
    Oblique,
    /// Perspective from the lower edge, 18° above the cloth: hairs and sheen.
    Grazing,
}

impl View {
    /// All views, in the order in which they are offered.
    pub const ALL: &'static [Self] = Self::VARIANTS;

    /// The name used on the command line.
    pub fn name(self) -> &'static str {
        self.into()
    }

    /// How the cloth lies in this view, turned by 180° or not.
    pub fn pose(self, turned: bool) -> Pose {
        Pose {
            back: self == Self::Back,
            turned,
        }
    }

    /// Whether it is straight on the cloth, without perspective.
    pub fn is_straight(self) -> bool {
        matches!(self, Self::Face | Self::Back)
    }

    /// The camera of this view at a target (mm, cloth space), `width_mm` across the
    /// frame there, for a film of `width`×`height` pixels.
    pub fn camera(self, target: Vec3, width_mm: f32, width: u32, height: u32) -> Camera {
        let from = |elevation: f32| {
            let (sine, cosine) = elevation.to_radians().sin_cos();
            Vec3::new(0.0, -cosine, sine)
        };
        match self {
            Self::Face | Self::Back => {
                let from = Vec3::Z * self.pose(false).up();
                Camera::orthographic(target, from, Vec3::Y, width_mm, width, height)
            }
            Self::Close => {
                Camera::perspective(target, from(70.0), Vec3::Y, 20.0, width_mm, width, height)
            }
            Self::Oblique => {
                Camera::perspective(target, from(45.0), Vec3::Y, 30.0, width_mm, width, height)
            }
            Self::Grazing => {
                Camera::perspective(target, from(18.0), Vec3::Y, 30.0, width_mm, width, height)
            }
        }
    }
}

impl Camera {
    /// A camera without perspective that looks at `target` from the direction `from`
    /// (target to camera, any length).
    pub fn orthographic(
        target: Vec3,
        from: Vec3,
        up: Vec3,
        width_mm: f32,
        width: u32,
        height: u32,
    ) -> Self {
        // Far enough outside any cloth in view, near enough to keep the digits of t.
        let distance = width_mm.abs().max(10.0) * 2.0;
        Self::new(
            Projection::Orthographic,
            target,
            from,
            up,
            distance,
            width_mm,
            width,
            height,
        )
    }

    /// A camera with perspective: `field_of_view` degrees across the frame, which is
    /// `width_mm` wide at the target.
    pub fn perspective(
        target: Vec3,
        from: Vec3,
        up: Vec3,
        field_of_view: f32,
        width_mm: f32,
        width: u32,
        height: u32,
    ) -> Self {
        let half = (field_of_view.clamp(0.1, 170.0) * 0.5).to_radians();
        let distance = width_mm * 0.5 / half.tan();
        Self::new(
            Projection::Perspective,
            target,
            from,
            up,
            distance,
            width_mm,
            width,
            height,
        )
    }

    #[allow(
        clippy::too_many_arguments,
        reason = "private, called by two constructors"
    )]
    fn new(
        projection: Projection,
        target: Vec3,
        from: Vec3,
        up: Vec3,
        distance: f32,
        width_mm: f32,
        width: u32,
        height: u32,
    ) -> Self {
        let forward = -from.normalize_or(Vec3::Z);
        let right = forward
            .cross(up)
            .try_normalize()
            .unwrap_or_else(|| forward.any_orthonormal_vector());
        Self {
            projection,
            eye: target - forward * distance,
            target,
            right,
            up: right.cross(forward),
            forward,
            width_mm,
            width: width.max(1),
            height: height.max(1),
        }
    }

    /// The camera that sees the cloth turned by 180° as it lies, about the middle of the
    /// picture: what lay below is above, and no Z becomes an S. Straight on the cloth that is
    /// the picture turned by 180°.
    pub fn turned(self) -> Self {
        let turn = Pose::TURNED.turn();
        Self {
            eye: self.target + (self.eye - self.target) * turn,
            right: self.right * turn,
            up: self.up * turn,
            forward: self.forward * turn,
            ..self
        }
    }

    /// The ray through a point of the film, in pixels from its upper left corner.
    #[inline]
    pub fn ray(&self, x: f32, y: f32) -> Ray {
        let mm = self.width_mm / self.width as f32;
        let across = (x - self.width as f32 * 0.5) * mm;
        let upwards = (self.height as f32 * 0.5 - y) * mm;
        let shift = self.right * across + self.up * upwards;
        match self.projection {
            Projection::Orthographic => Ray {
                origin: self.eye + shift,
                direction: self.forward,
            },
            Projection::Perspective => Ray {
                origin: self.eye,
                direction: (self.target + shift - self.eye).normalize_or(self.forward),
            },
        }
    }

    /// Pixels across the film.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Pixels down the film.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// Pixels per millimetre at the target.
    pub fn pixels_per_mm(&self) -> f32 {
        self.width as f32 / self.width_mm
    }

    /// The point in the middle of the picture, mm.
    pub fn target(&self) -> Vec3 {
        self.target
    }

    /// The unit direction in which the camera looks.
    pub fn forward(&self) -> Vec3 {
        self.forward
    }

    /// Film directions in cloth space: to the right and upwards, unit length.
    pub fn film_axes(&self) -> (Vec3, Vec3) {
        (self.right, self.up)
    }
}
