//! The pinhole camera.

use crate::SceneError;
use manylight_math::{DAffine3, DVec3, MediumId, Ray, Vec2, Vec3};

/// A pinhole camera, in Mitsuba's convention: in its own frame it looks along +z, with +x to the left and +y up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// The pinhole. \[m\]
    pub origin: Vec3,
    /// Unit, towards the scene.
    pub forward: Vec3,
    /// Film coordinates: a pixel's direction is `forward + right * x + up * y` for film position (x, y) at unit distance.
    pub right: Vec3,
    /// See `right`.
    pub up: Vec3,
    /// Film position of the image's upper left corner.
    corner: Vec2,
    /// Size of a pixel on the film at unit distance.
    pixel: Vec2,
    /// Pixels in a row, and rows.
    pub size: (u32, u32),
    /// What the pinhole is in.
    pub medium: MediumId,
}

impl Camera {
    /// From the camera's frame, the horizontal field of view, and the image size in pixels.
    pub fn perspective(to_world: DAffine3, fov_x_degrees: f64, size: (u32, u32)) -> Result<Self, SceneError> {
        Camera::perspective_shifted(to_world, fov_x_degrees, size, [0.0, 0.0])
    }
    /// The same with the principal point moved, in fractions of the image's width and height.
    pub fn perspective_shifted(
        to_world: DAffine3,
        fov_x_degrees: f64,
        size: (u32, u32),
        principal_point_offset: [f64; 2],
    ) -> Result<Self, SceneError> {
        let bad = |what: &str| Err(SceneError::Camera(what.into()));
        if !(fov_x_degrees > 0.0 && fov_x_degrees < 180.0) {
            return bad(&format!("a field of view of {fov_x_degrees} degrees: expected more than 0 and less than 180"));
        }
        if size.0 == 0 || size.1 == 0 || size.0 as u64 * size.1 as u64 > 1 << 25 {
            return bad(&format!("an image of {}x{} pixels: expected 1x1 to 2^25 pixels", size.0, size.1));
        }
        if !to_world.is_finite() || to_world.matrix3.determinant() == 0.0 {
            return bad("its transform is singular or not finite");
        }
        let axis = |v: DVec3| to_world.transform_vector3(v).normalize();
        let tan = (0.5 * fov_x_degrees).to_radians().tan();
        let pixel = 2.0 * tan / size.0 as f64;
        let half = [
            tan * (1.0 - 2.0 * principal_point_offset[0]),
            0.5 * pixel * size.1 as f64 * (1.0 - 2.0 * principal_point_offset[1]),
        ];
        Ok(Camera {
            origin: to_world.translation.as_vec3(),
            forward: axis(DVec3::Z).as_vec3(),
            right: -axis(DVec3::X).as_vec3(),
            up: axis(DVec3::Y).as_vec3(),
            corner: Vec2::new(-half[0] as f32, half[1] as f32),
            pixel: Vec2::splat(pixel as f32),
            size,
            medium: MediumId::VACUUM,
        })
    }
    /// The same camera in a medium.
    pub fn within(self, medium: MediumId) -> Self {
        Camera { medium, ..self }
    }
    /// The ray through a point of the image: (0, 0) is the upper left corner of the first pixel, y grows downwards. \[pixel\]
    pub fn ray(&self, at: Vec2) -> Ray {
        let film = self.corner + Vec2::new(at.x, -at.y) * self.pixel;
        Ray::new(self.origin, (self.forward + self.right * film.x + self.up * film.y).normalize()).within(self.medium)
    }
    /// Where a direction from the pinhole meets the image \[pixel\], and the cosine of its angle to the axis; `None` from behind.
    pub fn project(&self, dir: Vec3) -> Option<(Vec2, f32)> {
        let z = self.forward.dot(dir);
        if !(z > 0.0) {
            return None;
        }
        let film = Vec2::new(self.right.dot(dir), self.up.dot(dir)) / z;
        let p = (film - self.corner) / self.pixel;
        Some((Vec2::new(p.x, -p.y), z / dir.length()))
    }
    /// Area of a pixel on the film at unit distance. [m^2 at 1 m]
    pub fn pixel_area(&self) -> f32 {
        self.pixel.x * self.pixel.y
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DQuat;
    use proptest::prelude::*;

    fn camera() -> Camera {
        let to_world = DAffine3::from_rotation_translation(DQuat::from_rotation_y(0.4), DVec3::new(1.0, 2.0, 3.0));
        Camera::perspective_shifted(to_world, 50.0, (64, 32), [0.1, -0.05]).unwrap()
    }
    proptest! {
        #[test]
        fn projecting_undoes_shooting(x in 0f32..64.0, y in 0f32..32.0) {
            let c = camera();
            let (p, cos) = c.project(c.ray(Vec2::new(x, y)).dir).unwrap();
            prop_assert!((p - Vec2::new(x, y)).length() < 1e-3 && cos > 0.5);
        }
    }
    #[test]
    fn the_field_of_view_is_horizontal_and_left_is_plus_x() {
        let c = Camera::perspective(DAffine3::IDENTITY, 90.0, (20, 10)).unwrap();
        let left = c.ray(Vec2::new(0.0, 5.0)).dir;
        assert!((left - Vec3::new(1.0, 0.0, 1.0).normalize()).length() < 1e-6, "{left}");
        assert!(c.ray(Vec2::new(10.0, 0.0)).dir.y > 0.4);
        assert!((c.pixel_area() - 0.01).abs() < 1e-7);
    }
    #[test]
    fn bad_cameras_are_refused() {
        for (fov, size) in
            [(0.0, (4, 4)), (180.0, (4, 4)), (f64::NAN, (4, 4)), (40.0, (0, 4)), (40.0, (1 << 20, 1 << 20))]
        {
            assert!(Camera::perspective(DAffine3::IDENTITY, fov, size).is_err());
        }
        assert!(Camera::perspective(DAffine3::from_scale(DVec3::new(1.0, 0.0, 1.0)), 40.0, (4, 4)).is_err());
    }
}
