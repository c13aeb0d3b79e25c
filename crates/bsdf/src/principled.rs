//! Burley's principled model: metal, glass, cloth and lacquer by a dozen numbers.

use crate::bsdf::{Bsdf, BsdfSample, Lobe, Mode, Model, Split};
use crate::cone::Cone;
use crate::fresnel;
use crate::microfacet::{Distribution, Microfacets, masking_over_cos, mirror};
use crate::rough_dielectric::RoughDielectric;
use manylight_math::{INV_PI, Spectrum, Vec2, Vec3};
use manylight_sampling::warp;
use std::f32::consts::{PI, TAU};

/// What a [`Principled`] is made of, by the names of Mitsuba 3's plugin. All but `eta` lie in [0, 1]; what does not is clamped.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PrincipledParameters {
    /// Colour of the base, of metal, and (its square root) of what is refracted.
    pub base_color: Spectrum,
    /// Square root of the microfacets' roughness.
    pub roughness: f32,
    /// Stretches the highlight along the tangent.
    pub anisotropic: f32,
    /// Part that is metal.
    pub metallic: f32,
    /// Part of the rest that is glass, not diffuse.
    pub spec_trans: f32,
    /// Index of refraction inside over outside.
    pub eta: f32,
    /// Part of the dielectric's reflection that takes the hue of the base.
    pub spec_tint: f32,
    /// Light along the horizon, as from cloth.
    pub sheen: f32,
    /// Part of the sheen that takes the hue of the base.
    pub sheen_tint: f32,
    /// Part of the diffuse lobe that is made flat, as by scattering below the surface.
    pub flatness: f32,
    /// Strength of a coat of lacquer.
    pub clearcoat: f32,
    /// Polish of the lacquer: roughness 0.1 at 0, 0.001 at 1.
    pub clearcoat_gloss: f32,
}

impl Default for PrincipledParameters {
    fn default() -> Self {
        PrincipledParameters {
            base_color: Spectrum::gray(0.5),
            roughness: 0.5,
            anisotropic: 0.0,
            metallic: 0.0,
            spec_trans: 0.0,
            eta: PrincipledParameters::eta_of_specular(0.5),
            spec_tint: 0.0,
            sheen: 0.0,
            sheen_tint: 0.0,
            flatness: 0.0,
            clearcoat: 0.0,
            clearcoat_gloss: 0.0,
        }
    }
}

impl PrincipledParameters {
    /// The index that reflects 0.08 `specular` at the zenith: 1.5 at 0.5.
    pub fn eta_of_specular(specular: f32) -> f32 {
        2.0 / (1.0 - (0.08 * specular).sqrt()) - 1.0
    }
}

/// A number in [0, 1] to 16 bits: a light carries a dozen.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Unit(u16);

impl Unit {
    /// NaN is 0.
    fn new(x: f32) -> Self {
        Unit((x.clamp(0.0, 1.0) * 65535.0).round() as u16)
    }
    fn get(self) -> f32 {
        f32::from(self.0) / 65535.0
    }
}

const SPECULAR: u8 = 1;
const COAT: u8 = 2;
const DIFFUSE: u8 = 4;

/// Roughness by which the lacquer shadows itself, whatever its own.
const COAT_MASKING: f32 = 0.25;

/// The principled model (Burley 2012, 2015), as Mitsuba 3 defines it: the sum of
///
/// * a rough reflection F D G / (4 cos cos) with GGX, whose F blends a dielectric's with Schlick's of the base colour (`metallic`)
///   and of the base's hue (`spec_tint`),
/// * a rough refraction, `sqrt(base_color)` times that of [`RoughDielectric`], by (1 - `metallic`) `spec_trans`,
/// * a diffuse lobe with retro-reflection (or `flatness`), by (1 - `metallic`) (1 - `spec_trans`), and sheen,
/// * lacquer of 1/4 `clearcoat` F D G with D ~ 1 / (1 + (alpha^2 - 1) cos^2).
///
/// It is reciprocal, and was made to look right: rough, sheeny and lacquered surfaces may reflect half as much again as they get. One-sided
/// without `spec_trans`; with it `wi.z` < 0 is inside, where the glass alone scatters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Principled {
    base: Spectrum,
    roughness: f32,
    eta: f32,
    anisotropic: Unit,
    metallic: Unit,
    spec_trans: Unit,
    spec_tint: Unit,
    sheen: Unit,
    sheen_tint: Unit,
    flatness: Unit,
    clearcoat: Unit,
    clearcoat_gloss: Unit,
    lobes: u8,
}

/// Probabilities with which the lobes are drawn.
struct Chances {
    specular: f32,
    coat: f32,
    diffuse: f32,
}

impl Principled {
    /// Parameters to 16 bits each, but for the base's colour, its roughness and index.
    pub fn new(p: &PrincipledParameters) -> Self {
        let spec_trans = Unit::new(p.spec_trans);
        // Glass that does not refract is no glass (as in Mitsuba).
        let eta = if spec_trans.0 > 0 && (p.eta - 1.0).abs() < 1e-4 { 1.001 } else { p.eta };
        let mut made = Principled {
            base: p.base_color,
            // NaN is 0.
            roughness: if p.roughness > 0.0 { p.roughness.min(1.0) } else { 0.0 },
            eta,
            anisotropic: Unit::new(p.anisotropic),
            metallic: Unit::new(p.metallic),
            spec_trans,
            spec_tint: Unit::new(p.spec_tint),
            sheen: Unit::new(p.sheen),
            sheen_tint: Unit::new(p.sheen_tint),
            flatness: Unit::new(p.flatness),
            clearcoat: Unit::new(p.clearcoat),
            clearcoat_gloss: Unit::new(p.clearcoat_gloss),
            lobes: 0,
        };
        made.lobes = SPECULAR
            | if made.clearcoat.0 > 0 { COAT } else { 0 }
            | if made.diffuse_part() > 0.0 { DIFFUSE } else { 0 };
        made
    }

    fn has(&self, lobe: u8) -> bool {
        self.lobes & lobe != 0
    }
    /// How much of it is glass.
    fn glassy(&self) -> f32 {
        (1.0 - self.metallic.get()) * self.spec_trans.get()
    }
    fn diffuse_part(&self) -> f32 {
        (1.0 - self.metallic.get()) * (1.0 - self.spec_trans.get())
    }
    /// Does light pass through?
    pub fn transmits(&self) -> bool {
        self.has(SPECULAR) && self.glassy() > 0.0
    }
    fn microfacets(&self) -> Microfacets {
        let alpha = self.roughness * self.roughness;
        let aspect = (1.0 - 0.9 * self.anisotropic.get()).sqrt();
        Microfacets::new(Distribution::Ggx, (alpha / aspect).max(0.001), (alpha * aspect).max(0.001))
    }
    /// The glass in it: all of what is refracted, and what is reflected inside.
    pub(crate) fn glass(&self) -> RoughDielectric {
        let m = self.microfacets();
        let (glassy, through) = (self.glassy(), self.base.map(|c| c.max(0.0).sqrt()));
        let alpha = (m.alpha_u, m.alpha_v);
        RoughDielectric::new(m.distribution, alpha, (self.eta, 1.0), Spectrum::gray(glassy), through * glassy)
    }
    /// The base colour without its brightness.
    fn hue(&self) -> Spectrum {
        let luminance = self.base.luminance();
        if luminance > 0.0 { self.base / luminance } else { Spectrum::ONE }
    }
    /// Schlick's weight of grazing light, for light that comes from outside.
    fn schlick(&self, cos: f32) -> f32 {
        fifth(1.0 - if self.eta > 1.0 { cos } else { fresnel::dielectric(cos, self.eta).cos_t })
    }
    /// Fresnel's factor of the outside, from a dielectric's and Schlick's weight.
    fn fresnel(&self, dielectric: f32, schlick: f32) -> Spectrum {
        let (metallic, tint) = (self.metallic.get(), self.spec_tint.get());
        let at = |r0: Spectrum| Spectrum::lerp(r0, Spectrum::ONE, schlick);
        let mut f = Spectrum::gray((1.0 - metallic) * (1.0 - tint) * dielectric);
        if metallic > 0.0 {
            f += at(self.base) * metallic;
        }
        if tint > 0.0 {
            let r0 = ((self.eta - 1.0) / (self.eta + 1.0)).powi(2);
            f += at(self.hue() * r0) * ((1.0 - metallic) * tint);
        }
        f
    }
    fn coat_alpha(&self) -> f32 {
        0.1 + (0.001 - 0.1) * self.clearcoat_gloss.get()
    }
    /// 1/4 strength F D of the lacquer, at the squared slope of the half vector.
    fn coat(&self, schlick: f32, slope2: f32) -> f32 {
        let fresnel = 0.04 + 0.96 * schlick;
        0.25 * self.clearcoat.get() * fresnel * gtr1(self.coat_alpha(), slope2)
    }
    /// The diffuse lobe and sheen without their colours: f and f x cos(wo) of the first, f of the second. `cos_d` to the half vector.
    fn diffuse(&self, cos_i: f32, cos_o: f32, cos_d: f32) -> (f32, f32) {
        let (weight_i, weight_o) = (fifth(1.0 - cos_i), fifth(1.0 - cos_o));
        let retro = 2.0 * self.roughness * cos_d * cos_d;
        let f = (1.0 - 0.5 * weight_i) * (1.0 - 0.5 * weight_o)
            + retro * (weight_o + weight_i + weight_o * weight_i * (retro - 1.0));
        let flatness = self.flatness.get();
        let flat = if flatness > 0.0 {
            let through = |w: f32| 1.0 + (0.5 * retro - 1.0) * w;
            1.25 * (through(weight_o) * through(weight_i) * (1.0 / (cos_o + cos_i) - 0.5) + 0.5)
        } else {
            0.0
        };
        let whole = self.diffuse_part() * INV_PI * (f + (flat - f) * flatness);
        (whole, fifth(1.0 - cos_d))
    }
    fn sheen_colour(&self) -> Spectrum {
        if self.sheen.0 == 0 {
            return Spectrum::BLACK;
        }
        let tinted = Spectrum::lerp(Spectrum::ONE, self.hue(), self.sheen_tint.get());
        tinted * (self.sheen.get() * (1.0 - self.metallic.get()))
    }
    /// From outside. `None` if there is nothing to draw.
    fn chances(&self) -> Option<Chances> {
        let of = |lobe: u8, weight: f32| if self.has(lobe) { weight } else { 0.0 };
        let specular = of(SPECULAR, 1.0);
        let coat = of(COAT, 0.25 * self.clearcoat.get());
        let diffuse = of(DIFFUSE, self.diffuse_part());
        let sum = specular + coat + diffuse;
        (sum > 0.0).then(|| Chances { specular: specular / sum, coat: coat / sum, diffuse: diffuse / sum })
    }
    /// Probability that a facet refracts, from outside; `cos` to its normal.
    fn refracts(&self, cos: f32) -> f32 {
        self.glassy() * fresnel::dielectric(cos, self.eta).transmitted
    }
    pub(crate) fn radiance_factor(&self, wi: Vec3, wo: Vec3) -> f32 {
        self.glass().radiance_factor(wi, wo)
    }
    /// As [`Bsdf::upper_bound`](crate::Bsdf::upper_bound), from both sides and to both.
    pub(crate) fn bound_of_both_sides(&self, wi: Vec3, axis: Vec3, cos_half: f32) -> Lobe {
        let glass = if self.transmits() { self.glass().bound_of_both_sides(wi, axis, cos_half) } else { Lobe::NONE };
        if !(wi.z > 0.0) {
            return glass;
        }
        // The glass' own reflection is bounded with it: more than there is.
        let reflected = Cone::above_surface(axis, cos_half).map_or(Lobe::NONE, |cone| self.reflection_bound(wi, &cone));
        Lobe {
            with_cosine: reflected.with_cosine.max(glass.with_cosine),
            without_cosine: reflected.without_cosine.max(glass.without_cosine),
        }
    }
    /// Each lobe apart. The diffuse one rises with retro-reflection, thus with the cosine to the half vector, and is linear in the
    /// grazing weight of `wo`; flat or not.
    fn reflection_bound(&self, wi: Vec3, cone: &Cone) -> Lobe {
        let (mut with, mut without) = (Spectrum::BLACK, Spectrum::BLACK);
        let m = self.microfacets();
        let bound = m.reflection_bound(wi, cone);
        // Beyond the rounding of the half vector: a fifth power of it may be all there is.
        let (cos_least, cos_most) = ((bound.cos_half_min - 1e-6).max(0.0), bound.cos_half_max);
        let (schlick_least, schlick_most) = (self.schlick(cos_most), self.schlick(cos_least));
        if self.has(SPECULAR) {
            let dielectric = fresnel::dielectric_reflected_bound(cos_least, cos_most, self.eta);
            // Linear in Schlick's weight; a hue may be brighter than white, so that either end may be the largest.
            let ends = [schlick_least, schlick_most].map(|w| self.fresnel(dielectric, w));
            let largest = Spectrum(ends[0].0.max(ends[1].0));
            with += largest * bound.with_cosine;
            without += largest * bound.without_cosine;
        }
        if self.has(COAT) {
            let f = self.coat(schlick_most, bound.slope2_min);
            with += Spectrum::gray(f * cone.cos_max);
            without += Spectrum::gray(f);
        }
        if self.has(DIFFUSE) {
            let (at_least, sheen) = self.diffuse_bound(wi.z, cone.cos_min, cone, cos_least, cos_most);
            let (at_most, _) = self.diffuse_bound(wi.z, cone.cos_max, cone, cos_least, cos_most);
            let sheen = self.sheen_colour() * sheen;
            with += self.base * (at_least.with_cosine.max(at_most.with_cosine)) + sheen * cone.cos_max;
            without += self.base * (at_least.without_cosine.max(at_most.without_cosine)) + sheen;
        }
        let rounding = Cone::ROUNDING * Cone::ROUNDING;
        Lobe { with_cosine: with.largest() * rounding, without_cosine: without.largest() * rounding }
    }
    /// Of the diffuse lobe without flatness at one cosine of `wo`, plus flatness over the cone; and of the sheen.
    fn diffuse_bound(&self, cos_i: f32, cos_o: f32, cone: &Cone, cos_least: f32, cos_most: f32) -> (Lobe, f32) {
        let (weight_i, weight_o) = (fifth(1.0 - cos_i), fifth(1.0 - cos_o));
        let retro = 2.0 * self.roughness * cos_most * cos_most;
        let f = (1.0 - 0.5 * weight_i) * (1.0 - 0.5 * weight_o)
            + retro * (weight_o + weight_i + weight_o * weight_i * (retro - 1.0));
        let flatness = self.flatness.get();
        let (mut with, mut without) = (f * (1.0 - flatness) * cone.cos_max, f * (1.0 - flatness));
        if flatness > 0.0 {
            // What passes both ways is at most this and at least nothing; the rest is taken at its largest.
            let through = |w: f32| 1.0 + (0.5 * retro - 1.0) * w;
            let most = through(fifth(1.0 - cone.cos_max)) * through(weight_i);
            let sum = cone.cos_max + cos_i;
            with += flatness * 1.25 * (most * cone.cos_max / sum + 0.5 * cone.cos_max);
            without += flatness * 1.25 * (most * (1.0 / (cone.cos_min + cos_i) - 0.5).max(0.0) + 0.5);
        }
        let scale = self.diffuse_part() * INV_PI;
        (Lobe { with_cosine: with * scale, without_cosine: without * scale }, fifth(1.0 - cos_least))
    }
}

fn fifth(x: f32) -> f32 {
    x.clamp(0.0, 1.0).powi(5)
}

/// Density of the lacquer's normals, in the wider tails of Burley 2012 (appendix B, gamma = 1), by their squared slope T:
/// D ~ 1 / (alpha^2 cos^2 + sin^2) = (1 + T) / (alpha^2 + T), which falls. [1/sr]
fn gtr1(alpha: f32, slope2: f32) -> f32 {
    let a2 = alpha * alpha;
    (a2 - 1.0) / (PI * a2.ln()) * ((1.0 + slope2) / (a2 + slope2))
}

/// Draws from `gtr1` cos.
fn sample_gtr1(alpha: f32, u: Vec2) -> Vec3 {
    let a2 = alpha * alpha;
    let sin2 = ((a2.powf(1.0 - u.y) - a2) / (1.0 - a2)).clamp(0.0, 1.0);
    let (sin, phi) = (sin2.sqrt(), TAU * u.x);
    Vec3::new(sin * phi.cos(), sin * phi.sin(), (1.0 - sin2).sqrt())
}

/// Square of the tangent of the inclination; finite.
fn slope2(h: Vec3) -> f32 {
    (h.truncate().length_squared() / (h.z * h.z)).min(1e30)
}

impl Model for Principled {
    const SMOOTH: bool = true;
    const DELTA: bool = false;

    /// Of importance.
    fn eval(&self, wi: Vec3, wo: Vec3) -> Spectrum {
        let Some((h, cos)) = Microfacets::half_vector(wi, wo) else {
            return if self.transmits() { self.glass().eval(wi, wo) } else { Spectrum::BLACK };
        };
        let mut f = Spectrum::BLACK;
        let schlick = self.schlick(cos);
        if self.has(SPECULAR) {
            let dielectric = fresnel::dielectric(cos, self.eta).reflected;
            f += self.fresnel(dielectric, schlick) * self.microfacets().reflection(wi, wo, h);
        }
        if self.has(COAT) {
            let a2 = COAT_MASKING * COAT_MASKING;
            let g1 = |w: Vec3| w.z * masking_over_cos(Distribution::Ggx, w.z, a2 * w.truncate().length_squared());
            f += Spectrum::gray(self.coat(schlick, slope2(h)) * g1(wi) * g1(wo));
        }
        if self.has(DIFFUSE) {
            let (diffuse, sheen) = self.diffuse(wi.z, wo.z, cos);
            f += self.base * diffuse + self.sheen_colour() * sheen;
        }
        f
    }
    fn pdf_sa(&self, wi: Vec3, wo: Vec3) -> f32 {
        if let Some((h, cos)) = Microfacets::half_vector(wi, wo) {
            let Some(chance) = self.chances() else { return 0.0 };
            let specular = chance.specular * (1.0 - self.refracts(cos)) * self.microfacets().reflection_pdf_sa(wi, h);
            let coat = if chance.coat > 0.0 { gtr1(self.coat_alpha(), slope2(h)) * h.z * 0.25 / cos } else { 0.0 };
            return specular + chance.coat * coat + chance.diffuse * warp::cosine_hemisphere_pdf(wo);
        }
        if !self.transmits() {
            return 0.0;
        }
        let glass = self.glass().pdf_sa(wi, wo);
        // Inside there is nothing else; from outside a facet refracts where it does not reflect.
        if wi.z < 0.0 { glass } else { self.chances().map_or(0.0, |c| c.specular * self.glassy() * glass) }
    }
    /// `None` where a microfacet sends the path to the wrong side.
    fn sample(&self, wi: Vec3, mode: Mode, u_lobe: f32, u: Vec2) -> Option<BsdfSample> {
        if !(wi.z > 0.0) {
            return if self.transmits() { self.glass().sample(wi, mode, u_lobe, u) } else { None };
        }
        let chance = self.chances()?;
        let wo = if u_lobe < chance.specular || chance.coat + chance.diffuse == 0.0 {
            let m = self.microfacets();
            let h = m.sample_visible(wi, u);
            if u_lobe < chance.specular * self.refracts(wi.dot(h)) {
                // Chosen by what it refracts, of which all but colour and shadowing cancels.
                let s = self.glass().refract(wi, h, mode)?;
                let pdf = self.pdf_sa(wi, s.wo);
                let weight = s.weight * (1.0 / (self.glassy() * chance.specular));
                return (pdf > 0.0).then_some(BsdfSample { weight, pdf, ..s });
            }
            mirror(wi, h)
        } else if u_lobe < chance.specular + chance.coat || chance.diffuse == 0.0 {
            mirror(wi, sample_gtr1(self.coat_alpha(), u))
        } else {
            warp::cosine_hemisphere(u)
        };
        let pdf = if wo.z > 0.0 { self.pdf_sa(wi, wo) } else { 0.0 };
        (pdf > 0.0).then(|| BsdfSample::smooth(wo, self.eval(wi, wo) * (wo.z / pdf), pdf))
    }
    /// The sum of the lobes' mean weights, of importance, each of a Fibonacci lattice: within 0.03.
    fn albedo(&self, wi: Vec3) -> Spectrum {
        let lobe = |lobe: u8| {
            let alone = Principled { lobes: lobe, ..*self };
            lattice_albedo(|u_lobe, u| alone.sample(wi, Mode::Importance, u_lobe, u))
        };
        [SPECULAR, COAT, DIFFUSE].into_iter().filter(|l| self.has(*l)).map(lobe).sum()
    }
    fn upper_bound(&self, wi: Vec3, cone: &Cone) -> Lobe {
        self.bound_of_both_sides(wi, cone.axis, cone.half.cos())
    }
    fn split(&self, wi: Vec3, alpha: f32) -> Option<Split> {
        let mut sharp = if self.microfacets().as_sharp_as(alpha) { SPECULAR } else { 0 };
        if self.coat_alpha() <= alpha {
            sharp |= COAT;
        }
        sharp &= self.lobes;
        if sharp == 0 {
            return None;
        }
        let with = |lobes| Principled { lobes, ..*self };
        let chance = if wi.z < 0.0 {
            f32::from(sharp & SPECULAR != 0)
        } else {
            let of = |lobe: u8, chance: f32| if sharp & lobe != 0 { chance } else { 0.0 };
            self.chances().map_or(0.0, |c| of(SPECULAR, c.specular) + of(COAT, c.coat))
        };
        let rest = self.lobes & !sharp;
        let dull = if rest == 0 { Bsdf::Black } else { with(rest).into() };
        Some(Split { dull, sharp: with(sharp).into(), chance })
    }
}

/// The mean weight of the 233 samples of a Fibonacci lattice.
pub(crate) fn lattice_albedo(sample: impl Fn(f32, Vec2) -> Option<BsdfSample>) -> Spectrum {
    const N: usize = 233;
    const STEPS: [usize; 2] = [144, 55];
    let point = |i: usize| ((i % N) as f32 + 0.5) / N as f32;
    (0..N)
        .filter_map(|i| sample(point(i * STEPS[1]), Vec2::new(point(i), point(i * STEPS[0]))))
        .map(|s| s.weight * (1.0 / N as f32))
        .sum()
}
