//! Largest value of a rough reflection over a cone of directions.
//!
//! The model is F D G1(wi) G1(wo) / (4 cos cos), and each factor is bounded apart.
//!
//! *Half vectors.* Around `wi`, in polar coordinates (theta, phi), taking the half vector with `wo` halves theta and keeps
//! phi. Along theta that shortens an arc to 1/2, across it to sin(theta/2) / sin(theta) = 1 / (2 cos(theta/2)), which is
//! the larger. A cone of half angle b < pi/2 is convex, so that an arc from its axis to any of its directions stays in
//! it, at theta <= `far` = theta(axis) + b: all half vectors lie within b / (2 cos(far/2)) of the axis' one. They also
//! lie between (theta(axis) - b)/2 and far/2 of `wi` itself, which is the better bound for wide cones.
//!
//! *D* in terms of the squared slope T = tan^2 of the half vector and of its stretched slope t (T / alpha^2 if
//! isotropic): (1 + T)^2 g(t) / (pi alpha_u alpha_v), with g(t) = 1 / (1 + t)^2 for GGX and e^-t for Beckmann. g falls, so t
//! is replaced by what it cannot be below: the larger of T / alpha_max^2 and of t at the least |h.x| and |h.y| reached. The
//! result has one maximum in T.
//!
//! *F* is bounded over the cosines to the half vector, cos(theta/2). *G1(wi) / cos(wi)* is known. *G1(wo)* rises with the
//! cosine, so that the largest cosine and the smaller roughness bound it; *G1(wo) / cos(wo)* is at most the largest G1 over
//! the least cosine, and at most its supremum, which is finite.

use crate::cone::{Cone, inclination};
use crate::microfacet::{Distribution, Microfacets, masking_over_cos};
use manylight_math::Vec3;
use std::f32::consts::{FRAC_1_PI, FRAC_PI_2, PI};

/// Bound of the rough reflection, without Fresnel's factor, and the cosines at which that has to be bounded.
pub(crate) struct ReflectionBound {
    /// Of D G / (4 cos(wi)). [1/sr]
    pub with_cosine: f32,
    /// Of D G / (4 cos(wi) cos(wo)). [1/sr]
    pub without_cosine: f32,
    /// Least and largest cosine of `wi` to the half vector.
    pub cos_half_min: f32,
    pub cos_half_max: f32,
    /// Least squared slope of a half vector.
    pub slope2_min: f32,
}

impl Microfacets {
    /// Over all `wo` in the cone and above the surface; `wi.z` > 0.
    pub fn reflection_bound(&self, wi: Vec3, cone: &Cone) -> ReflectionBound {
        let theta = wi.cross(cone.axis).length().atan2(wi.dot(cone.axis));
        let far = (theta + cone.half).min(PI);
        let near = (theta - cone.half).max(0.0);
        let (density, slope2_min) = self.density_bound(wi, cone, near, far);

        let alpha_min = self.alpha_u.min(self.alpha_v);
        let sin2 = 1.0 - cone.cos_max * cone.cos_max;
        // Beckmann's fit exceeds one by 5e-5 just before it is cut off, and is not monotone there.
        let masking =
            1.0001 * masking_over_cos(self.distribution, cone.cos_max, alpha_min * alpha_min * sin2) * cone.cos_max;
        let masking_over_cos = (masking / cone.cos_min).min(self.masking_over_cos_supremum());

        let common = Cone::ROUNDING * 0.25 * density * self.masking_over_cos(wi);
        ReflectionBound {
            with_cosine: common * masking.min(masking_over_cos * cone.cos_max),
            without_cosine: common * masking_over_cos,
            cos_half_min: (0.5 * far).cos().max(0.0),
            cos_half_max: (0.5 * near).cos().min(1.0),
            slope2_min,
        }
    }

    /// Of the density of normals over all normals.
    pub fn density_supremum(&self) -> f32 {
        // In terms of T = tan^2 it is at most (1 + T)^2 g(T / alpha_max^2) / (pi alpha_u alpha_v): see above.
        let alpha2 = self.alpha_u.max(self.alpha_v).powi(2);
        let largest = match self.distribution {
            // ((1 + T) / (1 + T / alpha^2))^2: from 1 at T = 0 to alpha^4.
            Distribution::Ggx => alpha2.powi(2).max(1.0),
            // (1 + T)^2 e^(-T / alpha^2), at T = 2 alpha^2 - 1 if that is positive.
            Distribution::Beckmann if alpha2 > 0.5 => (2.0 * alpha2).powi(2) * (1.0 / alpha2 - 2.0).exp(),
            Distribution::Beckmann => 1.0,
        };
        FRAC_1_PI / (self.alpha_u * self.alpha_v) * largest
    }
    /// Of G1 / cos over all directions.
    pub fn masking_over_cos_supremum(&self) -> f32 {
        let alpha = self.alpha_u.min(self.alpha_v);
        match self.distribution {
            // 2 / (c + sqrt(c^2 (1 - alpha^2) + alpha^2)): the denominator is concave in c, so it is least at an end.
            Distribution::Ggx => (2.0 / alpha).max(1.0),
            // G1 <= 1.0001 and G1 <= 3.535 cot / alpha cross at this value.
            Distribution::Beckmann => (1.0002 + (3.535 / alpha).powi(2)).sqrt(),
        }
    }

    /// Bound of the density of normals over the half vectors, and the least of their squared slopes. `near` and `far`: angles from `wi` to the cone.
    fn density_bound(&self, wi: Vec3, cone: &Cone, near: f32, far: f32) -> (f32, f32) {
        // How angles of directions, and their rounding, grow in the half vector; without bound where it reaches -wi.
        let stretch = if far < PI { 0.5 / (0.5 * far).cos() } else { f32::INFINITY };
        let slack = Cone::SLACK * stretch;
        // How far half vectors are from the axis' one; anywhere, if the cone is not convex.
        let (centre, radius) = match (wi + cone.axis).try_normalize() {
            Some(h) if cone.half < FRAC_PI_2 => (h, cone.half * stretch + slack),
            _ => (Vec3::Z, PI),
        };
        let (inclination_i, inclination_h) = (inclination(wi), inclination(centre));
        let least = (inclination_h - radius)
            .max(inclination_i - 0.5 * far - slack)
            .max(0.5 * near - inclination_i - slack)
            .clamp(0.0, FRAC_PI_2);
        let most = (inclination_h + radius).min(inclination_i + 0.5 * far + slack).min(FRAC_PI_2);
        // |wi + wo| <= 2: a half vector is never lower than this. The floor keeps the square of T finite.
        let cos_most = most.cos().max(0.49999 * wi.z).max(1e-9);
        let cos_least = least.cos().max(cos_most);
        let tan2 = |cos: f32| (1.0 - cos * cos).max(0.0) / (cos * cos);
        let slope2_max = tan2(cos_most);
        let slope2_min = (least.sin() / cos_least).powi(2).min(slope2_max);

        let alpha2 = self.alpha_u.max(self.alpha_v).powi(2);
        let stretched_min = if self.alpha_u == self.alpha_v {
            0.0
        } else {
            // How far the half vectors stay from the planes x = 0 and y = 0.
            let sin_from_plane = |x: f32, rest: f32| (x.abs().atan2(rest) - radius).clamp(0.0, FRAC_PI_2).sin();
            let x = sin_from_plane(centre.x, centre.y.hypot(centre.z)) / self.alpha_u;
            let y = sin_from_plane(centre.y, centre.x.hypot(centre.z)) / self.alpha_v;
            (x * x + y * y) / (cos_least * cos_least)
        };
        // Up to here the bound rises with T.
        let turn = alpha2 * stretched_min;
        let slope2 = match self.distribution {
            Distribution::Ggx if alpha2 > 1.0 => slope2_max,
            Distribution::Ggx => turn.clamp(slope2_min, slope2_max),
            Distribution::Beckmann => turn.max(2.0 * alpha2 - 1.0).clamp(slope2_min, slope2_max),
        };
        let stretched = (slope2 / alpha2).max(stretched_min);
        let normalisation = FRAC_1_PI / (self.alpha_u * self.alpha_v);
        let root = match self.distribution {
            Distribution::Ggx => 1.0 / (1.0 + stretched),
            Distribution::Beckmann => (-0.5 * stretched).exp(),
        };
        (normalisation * ((1.0 + slope2) * root).powi(2), slope2_min)
    }
}
