//! Cameras: a pinhole, a thin lens, or parallel rays.

use crate::SceneError;
use manylight_math::{DAffine3, DVec3, MediumId, Ray, Vec2, Vec3};
use manylight_sampling::{Stream, warp};

/// How a camera makes rays of places on its film.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Projection {
    /// All through one point.
    Pinhole,
    /// Through a disc, and each pixel's through one point at a distance along the axis.
    Lens { radius: f32, focus: f32 },
    /// All along the axis.
    Parallel,
}

/// What a camera was made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// From its own frame.
    pub to_world: DAffine3,
    /// Horizontal, in degrees; of no meaning for parallel rays.
    pub fov_x: f64,
    /// Of the principal point, in fractions of the image's width and height.
    pub offset: [f64; 2],
}

/// A camera, in Mitsuba's convention: in its own frame it looks along +z, with +x to the left and +y up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// The pinhole, the middle of the lens, or of the film of parallel rays. \[m\]
    pub origin: Vec3,
    /// Unit, towards the scene.
    pub forward: Vec3,
    /// Film coordinates: a pixel's direction is `forward + right * x + up * y` for film position (x, y) at unit distance; of parallel
    /// rays `right * x + up * y` is where they start from `origin`.
    pub right: Vec3,
    /// See `right`.
    pub up: Vec3,
    /// Film position of the image's upper left corner.
    corner: Vec2,
    /// Size of a pixel on the film at unit distance.
    pixel: Vec2,
    /// Pixels in a row, and rows.
    pub size: (u32, u32),
    /// What it stands in.
    pub medium: MediumId,
    projection: Projection,
    view: View,
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
            projection: Projection::Pinhole,
            view: View { to_world, fov_x: fov_x_degrees, offset: principal_point_offset },
        })
    }
    /// The same camera with a lens of a radius, which shows sharply what lies in the plane at the distance `focus` along the axis. \[m\]
    pub fn with_lens(self, radius: f32, focus: f32) -> Result<Self, SceneError> {
        if !(radius >= 0.0 && radius.is_finite() && focus > 0.0 && focus.is_finite()) {
            return Err(SceneError::Camera(format!("a lens of radius {radius} that focuses at {focus}")));
        }
        let lens = Projection::Lens { radius, focus };
        Ok(Camera { projection: if radius > 0.0 { lens } else { Projection::Pinhole }, ..self })
    }
    /// A camera of parallel rays: in its own frame the image is 2 wide, from x = -1 to 1.
    pub fn orthographic(to_world: DAffine3, size: (u32, u32)) -> Result<Self, SceneError> {
        // An angle of 90 degrees: two wide at unit distance.
        let unit = Camera::perspective(to_world, 90.0, size)?;
        let (wide, high) = (to_world.matrix3.x_axis.length() as f32, to_world.matrix3.y_axis.length() as f32);
        let scale = Vec2::new(wide, high);
        Ok(Camera { corner: unit.corner * scale, pixel: unit.pixel * scale, projection: Projection::Parallel, ..unit })
    }
    /// What it was made of.
    pub fn view(&self) -> View {
        self.view
    }
    /// Radius of its lens and the distance at which it is sharp, if it has one. \[m\]
    pub fn lens(&self) -> Option<(f32, f32)> {
        match self.projection {
            Projection::Lens { radius, focus } => Some((radius, focus)),
            _ => None,
        }
    }
    /// Are its rays parallel?
    pub fn is_parallel(&self) -> bool {
        self.projection == Projection::Parallel
    }
    /// The pinhole camera that a lens is at one of its points: the film is shifted, so that what is sharp stays where it is.
    pub fn at_lens_point(&self, p: Vec3) -> Camera {
        let Projection::Lens { focus, .. } = self.projection else { return *self };
        let aside = p - self.origin;
        let shift = Vec2::new(self.right.dot(aside), self.up.dot(aside)) / focus;
        Camera { origin: p, corner: self.corner - shift, projection: Projection::Pinhole, ..*self }
    }
    /// A ray through a point of the image, and a point of the lens where there is one: only then is anything drawn.
    pub fn sample_ray(&self, at: Vec2, s: &mut Stream) -> Ray {
        let Projection::Lens { radius, .. } = self.projection else { return self.ray(at) };
        let d = warp::disc(s.next_2d()) * radius;
        self.at_lens_point(self.origin + self.right * d.x + self.up * d.y).ray(at)
    }
    /// The point of the camera that sees `p`: itself, or of parallel rays the foot of `p` on the film.
    pub fn seen_from(&self, p: Vec3) -> Vec3 {
        match self.projection {
            Projection::Parallel => p - self.forward * self.forward.dot(p - self.origin),
            _ => self.origin,
        }
    }
    /// The same camera in a medium.
    pub fn within(self, medium: MediumId) -> Self {
        Camera { medium, ..self }
    }
    /// The ray through a point of the image (and the middle of the lens): (0, 0) is the upper left corner of the first pixel, y grows downwards. \[pixel\]
    pub fn ray(&self, at: Vec2) -> Ray {
        let film = self.corner + Vec2::new(at.x, -at.y) * self.pixel;
        let aside = self.right * film.x + self.up * film.y;
        let ray = match self.projection {
            Projection::Parallel => Ray::new(self.origin + aside, self.forward),
            _ => Ray::new(self.origin, (self.forward + aside).normalize()),
        };
        ray.within(self.medium)
    }
    /// Where a point is seen in the image (through the middle of the lens) \[pixel\], and what turns intensity that it sends to the camera
    /// into radiance of a pixel of unit area on the film: 1 / (d^2 cos^3), or 1 for parallel rays. `None` from behind.
    pub fn project(&self, p: Vec3) -> Option<(Vec2, f32)> {
        let dir = p - self.origin;
        let z = self.forward.dot(dir);
        if !(z > 0.0) {
            return None;
        }
        let aside = Vec2::new(self.right.dot(dir), self.up.dot(dir));
        let (film, scale) = match self.projection {
            Projection::Parallel => (aside, 1.0),
            // d^2 cos^3 = z^3 / d.
            _ => (aside / z, dir.length() / (z * z * z)),
        };
        let at = (film - self.corner) / self.pixel;
        Some((Vec2::new(at.x, -at.y), scale))
    }
    /// Area across a ray that a pixel stands for at a distance along it. \[m^2\]
    pub fn area_across(&self, dir: Vec3, distance: f32) -> f32 {
        match self.projection {
            Projection::Parallel => self.pixel_area(),
            _ => self.pixel_area() * self.forward.dot(dir).powi(3) * distance * distance,
        }
    }
    /// Area of a pixel on the film at unit distance [m^2 at 1 m]; of parallel rays, at any. [m^2]
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
            let ray = c.ray(Vec2::new(x, y));
            let (p, scale) = c.project(ray.at(2.0)).unwrap();
            let cos = c.forward.dot(ray.dir);
            prop_assert!((p - Vec2::new(x, y)).length() < 1e-3 && (scale * 4.0 * cos.powi(3) - 1.0).abs() < 1e-4);
        }
    }
    #[test]
    fn a_lens_shows_its_plane_of_focus_where_a_pinhole_does_and_blurs_the_rest() {
        let (pinhole, lens) = (camera(), camera().with_lens(0.3, 4.0).unwrap());
        let (at, mut s) = (Vec2::new(20.0, 9.0), Stream::new(1, [0; 3], manylight_sampling::Purpose::TEST));
        let (mut spread, n) = (0.0f32, 1000);
        for _ in 0..n {
            let ray = lens.sample_ray(at, &mut s);
            assert!((ray.origin - lens.origin).length() < 0.3 && (ray.dir.length() - 1.0).abs() < 1e-5);
            let in_plane =
                |r: &Ray, z: f32| r.at((z - lens.forward.dot(r.origin - lens.origin)) / lens.forward.dot(r.dir));
            let (sharp, blurred) = (in_plane(&ray, 4.0), in_plane(&ray, 8.0));
            assert!((sharp - in_plane(&pinhole.ray(at), 4.0)).length() < 1e-4);
            // From its own point of the lens it is a pinhole camera, which sees both where they are.
            let (seen, _) = lens.at_lens_point(ray.origin).project(blurred).unwrap();
            assert!((seen - at).length() < 1e-2, "{seen}");
            spread += (blurred - in_plane(&pinhole.ray(at), 8.0)).length_squared() / n as f32;
        }
        // Twice as far as the focus a disc of the lens' own size, whose mean square radius is r^2 / 2.
        assert!((spread / (0.5 * 0.09) - 1.0).abs() < 0.1, "{spread}");
        assert_eq!(pinhole.with_lens(0.0, 1.0).unwrap(), pinhole);
        assert!(pinhole.with_lens(-1.0, 1.0).is_err() && pinhole.with_lens(1.0, 0.0).is_err());
    }
    #[test]
    fn parallel_rays_cover_the_film() {
        let to_world = DAffine3::from_scale(DVec3::new(3.0, 2.0, 5.0));
        let c = Camera::orthographic(to_world, (20, 10)).unwrap();
        let ray = c.ray(Vec2::new(0.0, 0.0));
        // x = 1 is the left border; two wide and one high, scaled.
        assert!((ray.origin - Vec3::new(3.0, 1.0, 0.0)).length() < 1e-5 && ray.dir == Vec3::Z, "{ray:?}");
        let (at, scale) = c.project(ray.at(7.0)).unwrap();
        assert!(at.length() < 1e-4 && scale == 1.0 && c.project(ray.at(-1.0)).is_none());
        assert!((c.pixel_area() - 6.0 * 2.0 / 200.0).abs() < 1e-6);
        assert!((c.seen_from(ray.at(7.0)) - ray.origin).length() < 1e-5);
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
