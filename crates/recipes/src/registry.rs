//! The list of methods.

use crate::error::near;
use crate::params::{BIDIRECTIONAL, COMMON, PATH, TRACERS};
use crate::parts::{MANY_LIGHTS, media, photon, volume};
use crate::values::Values;
use crate::{Param, RecipeError, parts, path_lights, yardsticks};
use manylight_framework::{Claim, Method, PathClasses};
use manylight_scene::Scene;

type Compose = fn(&Values, &Scene) -> Result<Box<dyn Method>, RecipeError>;

/// One method, as data.
#[derive(Debug)]
pub struct MethodInfo {
    /// As written in `--method`.
    pub name: &'static str,
    /// What it is, in a sentence.
    pub summary: &'static str,
    /// Where it was published.
    pub paper: &'static str,
    own: &'static [&'static [Param]],
    /// Defaults that differ from the parameters' own.
    presets: &'static [(&'static str, &'static str)],
    compose: Compose,
}

static METHODS: &[MethodInfo] = &[
    MethodInfo {
        name: "instant-radiosity",
        summary: "virtual point lights at the vertices of light paths, all of them asked at each point",
        paper: "Keller 1997, Instant radiosity",
        own: MANY_LIGHTS,
        presets: &[],
        compose: parts::many_lights,
    },
    MethodInfo {
        name: "power-sampling",
        summary: "virtual point lights, a few of them drawn by power at each point",
        paper: "Shirley, Wang and Zimmerman 1996, Monte Carlo techniques for direct lighting calculations",
        own: MANY_LIGHTS,
        presets: &[("lights", "power"), ("paths", "4096")],
        compose: parts::many_lights,
    },
    MethodInfo {
        name: "lightcuts",
        summary: "virtual point lights in clusters, refined at each point until no cluster can be off by more than 2 % of all light",
        paper: "Walter et al. 2005, Lightcuts: a scalable approach to illumination",
        own: MANY_LIGHTS,
        presets: &[("lights", "lightcuts"), ("direct", "virtual"), ("paths", "4096")],
        compose: parts::many_lights,
    },
    MethodInfo {
        name: "stochastic-lightcuts",
        summary: "virtual point lights in clusters, one light of each of a few clusters drawn to suit the point",
        paper: "Yuksel 2019, Stochastic lightcuts",
        own: MANY_LIGHTS,
        presets: &[("lights", "stochastic-lightcuts"), ("direct", "virtual"), ("paths", "4096")],
        compose: parts::many_lights,
    },
    MethodInfo {
        name: "light-bvh",
        summary: "virtual point lights drawn by intensity, distance and orientation at each point",
        paper: "Conty Estevez and Kulla 2018, Importance sampling of many lights with adaptive tree splitting",
        own: MANY_LIGHTS,
        presets: &[("lights", "light-bvh"), ("samples", "10"), ("direct", "virtual"), ("paths", "4096")],
        compose: parts::many_lights,
    },
    MethodInfo {
        name: "rejection",
        summary: "virtual point lights, of which those are kept that bring the camera something",
        paper: "Georgiev and Slusallek 2010, Simple and robust iterative importance sampling of virtual point lights",
        own: MANY_LIGHTS,
        presets: &[("generator", "rejection"), ("paths", "2048"), ("selectivity", "32")],
        compose: parts::many_lights,
    },
    MethodInfo {
        name: "bidirectional-ir",
        summary: "virtual point lights from light paths and from eye paths, of which those are taken that bring the camera something",
        paper: "Segovia, Iehl, Mitanchey and Peroche 2006, Bidirectional instant radiosity",
        own: MANY_LIGHTS,
        presets: &[("generator", "bidirectional"), ("paths", "1024"), ("importance-floor", "0.3")],
        compose: parts::many_lights,
    },
    MethodInfo {
        name: "metropolis-ir",
        summary: "virtual point lights that Markov chains put where they bring the camera something",
        paper: "Segovia, Iehl and Peroche 2007, Metropolis instant radiosity",
        own: MANY_LIGHTS,
        presets: &[("generator", "metropolis"), ("paths", "256"), ("importance-floor", "0.3")],
        compose: parts::many_lights,
    },
    MethodInfo {
        name: "many-lights",
        summary: "any composition of generator, light set, kernel, bound and compensation",
        paper: "Dachsbacher et al. 2014, Scalable realistic rendering with many-light methods",
        own: MANY_LIGHTS,
        presets: &[],
        compose: parts::many_lights,
    },
    MethodInfo {
        name: "vsl",
        summary: "virtual spherical lights: each spread over a radius, for glossy scenes",
        paper: "Hasan, Krivanek, Walter and Bala 2009, Virtual spherical lights for many-light rendering of glossy scenes",
        own: MANY_LIGHTS,
        presets: &[("kernel", "sphere"), ("paths", "256"), ("bound", "none")],
        compose: parts::many_lights,
    },
    MethodInfo {
        name: "media-vpl",
        summary: "virtual point lights on surfaces and at collisions in media, gathered along the camera's ray too",
        paper: "Raab, Seibert and Keller 2008, Unbiased global illumination with participating media",
        own: media::MEDIA_VPL,
        presets: &[],
        compose: media::vpls,
    },
    MethodInfo {
        name: "vrl",
        summary: "the edges of light paths in media as ray lights, joined to the camera's ray by sampling both at once",
        paper: "Novak, Nowrouzezahrai, Dachsbacher and Jarosz 2012, Virtual ray lights for rendering scenes with participating media",
        own: media::VRL,
        presets: &[],
        compose: media::rays,
    },
    MethodInfo {
        name: "photon-map",
        summary: "photons of light paths within a radius of points on surfaces and along the camera's ray",
        paper: "Jensen and Christensen 1998, Efficient simulation of light transport in scenes with participating media using photon \
                maps; Knaus and Zwicker 2011, Progressive photon mapping: a probabilistic approach",
        own: photon::POINTS,
        presets: &[],
        compose: photon::at_points,
    },
    MethodInfo {
        name: "beam-radiance",
        summary: "photons of light paths within a radius of the camera's ray, all of it at once",
        paper: "Jarosz, Zwicker and Jensen 2008, The beam radiance estimate for volumetric photon mapping",
        own: photon::RAYS,
        presets: &[],
        compose: photon::at_rays,
    },
    MethodInfo {
        name: "photon-beams",
        summary: "the edges of light paths in media as beams of a width, which the camera's ray crosses",
        paper: "Jarosz, Nowrouzezahrai, Sadeghi and Jensen 2011, A comprehensive theory of volumetric radiance estimation using photon \
                points and beams",
        own: photon::BEAMS,
        presets: &[],
        compose: photon::beams,
    },
    MethodInfo {
        name: "lgh",
        summary: "fire: media that shine as one light a voxel, those nearby as they are, those far away averaged on grids; light is \
                  scattered once",
        paper: "Yuksel and Yuksel 2017, Lighting grid hierarchy for self-illuminating explosions",
        own: volume::LGH,
        presets: &[],
        compose: volume::lgh,
    },
    MethodInfo {
        name: "path-lights",
        summary: "path tracing whose next-event estimation is a light set over the emitters",
        paper: "Conty Estevez and Kulla 2018, Importance sampling of many lights with adaptive tree splitting; Yuksel 2019, Stochastic lightcuts",
        own: &[path_lights::PARAMS],
        presets: &[],
        compose: path_lights::path_lights,
    },
    MethodInfo {
        name: "path",
        summary: "path tracing with next-event estimation and multiple importance sampling: the yardstick",
        paper: "Kajiya 1986, The rendering equation; Veach and Guibas 1995, Optimally combining sampling techniques",
        own: &[PATH],
        presets: &[],
        compose: yardsticks::path,
    },
    MethodInfo {
        name: "light-tracing",
        summary: "light paths whose vertices are seen by the camera: a yardstick for caustics",
        paper: "Dutre, Lafortune and Willems 1993, Monte Carlo light tracing with direct computation of pixel intensities",
        own: &[TRACERS],
        presets: &[],
        compose: yardsticks::light_tracing,
    },
    MethodInfo {
        name: "bidirectional",
        summary: "bidirectional path tracing: every way to join a light path with an eye path, by multiple importance sampling",
        paper: "Veach and Guibas 1994, Bidirectional estimators for light transport; 1995, Optimally combining sampling techniques",
        own: &[TRACERS, BIDIRECTIONAL],
        presets: &[],
        compose: yardsticks::bidirectional,
    },
];

/// Methods that scatter in media; the others would leave out what media take and give.
const IN_MEDIA: &[&str] = &["path", "media-vpl", "vrl", "photon-map", "beam-radiance", "photon-beams", "lgh"];
/// Methods that see media shine; the others would leave that light out.
const IN_FIRE: &[&str] = &["path", "lgh"];

impl MethodInfo {
    /// Its parameters.
    pub fn params(&self) -> impl Iterator<Item = Param> + '_ {
        let own = self.own.iter().copied().flatten().chain(COMMON);
        own.map(|p| Param { default: self.default_of(p), ..*p })
    }
    pub(crate) fn default_of(&self, param: &Param) -> &'static str {
        self.presets.iter().find(|p| p.0 == param.name).map_or(param.default, |p| p.1)
    }
}

/// A method, ready to render a scene.
pub struct Recipe {
    /// Its name.
    pub name: &'static str,
    /// What renders.
    pub method: Box<dyn Method>,
    /// What it promises, with these parameters.
    pub claim: Claim,
    /// All its parameters with their values.
    pub parameters: Vec<(String, String)>,
    /// Camera samples a pixel and pass.
    pub spp: u32,
    /// What the user should know about this method on this scene.
    pub warnings: Vec<String>,
}

/// All methods; the first is the default.
pub fn methods() -> &'static [MethodInfo] {
    METHODS
}

/// What renders a scene if nobody says: the first of all methods, or virtual ray lights where there are media, and the lighting grid
/// hierarchy where these shine.
pub fn default_method(scene: &Scene) -> &'static str {
    if scene.media_emit() {
        return "lgh";
    }
    if scene.has_media() { "vrl" } else { METHODS[0].name }
}

/// The method of a name.
pub fn method(name: &str) -> Result<&'static MethodInfo, RecipeError> {
    METHODS
        .iter()
        .find(|m| m.name == name)
        .ok_or_else(|| RecipeError::Method { name: name.into(), near: near(name, METHODS.iter().map(|m| m.name)) })
}

/// The generator of point lights that a composed method would render with, to be looked at without rendering.
pub fn point_lights(name: &str, params: &[(String, String)], scene: &Scene) -> Result<parts::Vpls, RecipeError> {
    let info = method(name)?;
    if !info.params().any(|p| p.name == "generator") {
        let with: Vec<_> =
            METHODS.iter().filter(|m| m.params().any(|p| p.name == "generator")).map(|m| m.name).collect();
        return Err(RecipeError::Contrary(format!(
            "`{name}` has no generator of point lights to show: choose one of {}",
            with.join(", ")
        )));
    }
    // Whatever would be wrong with the method is wrong with its lights.
    build(name, params, scene)?;
    parts::point_lights(&Values::new(info, params)?, scene)
}

/// The method of a name with parameters, for a scene.
pub fn build(name: &str, params: &[(String, String)], scene: &Scene) -> Result<Recipe, RecipeError> {
    let info = method(name)?;
    let values = Values::new(info, params)?;
    if scene.has_media() && !IN_MEDIA.contains(&info.name) {
        return Err(RecipeError::Media { method: name.into(), use_: IN_MEDIA });
    }
    if scene.media_emit() && !IN_FIRE.contains(&info.name) {
        return Err(RecipeError::Fire { method: name.into(), use_: IN_FIRE });
    }
    let method = (info.compose)(&values, scene)?;
    let claim = method.claim();
    let mut warnings = Vec::new();
    if claim.misses == PathClasses::CAUSTICS && scene.has_delta_lobes() {
        warnings.push(format!(
            "the scene has mirrors or glass: `{name}` leaves out the light that reaches a surface through them (caustics); \
             `path` finds some of it"
        ));
    }
    if claim.misses.contains(PathClasses::MIRRORED) && scene.has_delta_lobes() {
        warnings.push(format!(
            "the scene has mirrors or glass: `{name}` leaves black what is seen in them; `bidirectional` and `path` do not"
        ));
    }
    if info.name == "lgh" && !scene.media_emit() {
        warnings.push(
            "no medium of the scene emits, and `lgh` is for light from media: without an `emission` or a `temperature` it shows direct \
             light alone"
                .into(),
        );
    }
    if claim.misses.contains(PathClasses::INDIRECT) && info.name == "lgh" {
        warnings.push(
            "`lgh` scatters light once: what is scattered again is left out, and `path` without max-depth=2 has more"
                .into(),
        );
    }
    if !scene.emitters().shine() && !scene.media_emit() {
        warnings.push("nothing in the scene emits light: the image will be black".into());
    }
    let spp = values.integer("spp")? as u32;
    Ok(Recipe { name: info.name, method, claim, parameters: values.into_pairs(), spp, warnings })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_default_fits_its_own_parameter_and_no_name_stands_twice() {
        for m in methods() {
            let names: Vec<_> = m.params().map(|p| p.name).collect();
            for p in m.params() {
                assert!(p.kind.accepts(p.default), "{}: {}={}", m.name, p.name, p.default);
                assert_eq!(names.iter().filter(|n| **n == p.name).count(), 1, "{}: {}", m.name, p.name);
            }
            for (other, values) in m.params().filter_map(|p| p.part_of) {
                let other = m.params().find(|p| p.name == other).unwrap();
                assert!(values.iter().all(|v| other.kind.accepts(v)), "{}: {} never is {values:?}", m.name, other.name);
            }
            for preset in m.presets {
                assert!(names.contains(&preset.0), "{} presets `{}`, which it does not have", m.name, preset.0);
            }
        }
    }
    #[test]
    fn a_wrong_name_or_value_says_what_would_be_right() {
        let ir = method("instant-radiosity").unwrap();
        let error =
            |name: &str, value: &str| Values::new(ir, &[(name.into(), value.into())]).err().unwrap().to_string();
        assert!(error("pathes", "3").contains("did you mean `paths`?"));
        assert_eq!(error("paths", "0"), "paths=0: expected a whole number from 1 to 16777216");
        assert_eq!(error("bound", "-1"), "bound=-1: expected a positive number, `none` or `auto` or `progressive`");
        assert!(error("zzz", "1").contains("`manylight list instant-radiosity` shows all"));
        assert_eq!(
            error("samples", "3"),
            "`samples` is read only with lights=power|light-bvh, and lights is `all`: leave it out, or say so"
        );
        assert_eq!(
            error("trees", "2"),
            "`trees` is read only with lights=lightcuts, and lights is `all`: leave it out, or say so"
        );
        assert!(
            error("generator", "keller+keller").contains("expected `keller` or ")
                && error("generator", "keller+keller").contains("`, or several joined by `+`")
        );
        let twice = Values::new(ir, &[("paths".into(), "3".into()), ("paths".into(), "4".into())]);
        assert_eq!(twice.err(), Some(RecipeError::Twice("paths".into())));
    }
}
