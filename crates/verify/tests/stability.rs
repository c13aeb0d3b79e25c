//! What breaks is found, and what does not is let pass.

use manylight_framework::{Claim, Film, Method, PassError, Probe, Promise};
use manylight_math::Spectrum;
use manylight_reference::PathTracer;
use manylight_scene::Scene;
use manylight_verify::stability::{Case, Cell, Stability, Units, csv};
use manylight_verify::{Built, Effort, Knobs, Made, Outcome};

type Harm = fn(&Scene, &mut Film, &mut Probe);

/// The path tracer, and what is done to its image.
struct Harmed {
    tracer: PathTracer,
    harm: Harm,
}
impl Promise for Harmed {
    fn claim(&self) -> Claim {
        self.tracer.claim()
    }
}
impl Method for Harmed {
    fn pass(&self, scene: &Scene, film: &mut Film, probe: &mut Probe) -> Result<(), PassError> {
        self.tracer.pass(scene, film, probe)?;
        (self.harm)(scene, film, probe);
        Ok(())
    }
}

fn cell(case: &str, harm: Harm) -> Cell {
    let subject = Made {
        name: "harmed".into(),
        make: move |scene: &Scene, _: &Knobs| {
            let tracer = PathTracer { max_edges: scene.max_depth().unwrap_or(u32::MAX), ..PathTracer::default() };
            Ok(Built { method: Box::new(Harmed { tracer, harm }), spp: 4 })
        },
    };
    let case = Case::all().find(|c| c.name == case).unwrap();
    Stability { effort: Effort { work: 400_000, ..Effort::QUICK }, seed: 1 }.cell(&subject, case)
}
fn times(film: &mut Film, factor: f32) {
    film.image.pixels.iter_mut().for_each(|p| *p *= factor);
}

#[test]
fn a_method_that_is_left_alone_holds_in_each_way_that_is_asked() {
    let c = cell("contrast", |_, _, _| ());
    assert!(matches!(c.outcome, Outcome::Holds { would_have_seen: Some(x) } if x < 0.05), "{c:?}");
    assert_eq!((c.non_finite, c.longer, c.brighter), (0, Some(0.0), Some(0.0)), "{c:?}");
}

#[test]
fn each_harm_is_found_and_named() {
    let harms: [(Harm, &str); 6] = [
        (|_, film, _| times(film, 1.05), "not the truth's"),
        (|_, _, probe| probe.drop_sample(0, 0, 0), "NaN, infinite or negative"),
        (|_, _, probe| probe.broken_paths += 1, "flux that was not finite"),
        (|_, _, _| panic!("out of bounds"), "panic: out of bounds"),
        // An epsilon of a millimetre, as it were: what is smaller is not there.
        (|scene, film, _| times(film, (scene.area() > 1e-6) as u32 as f32), "with the unit of length"),
        // A firefly filter with a fixed brightness.
        (
            |_, film, _| film.image.pixels.iter_mut().for_each(|p| p.0 = p.0.min(Spectrum::gray(2e6).0)),
            "with the unit of light",
        ),
    ];
    for (harm, word) in harms {
        let c = cell("contrast", harm);
        assert!(c.outcome == Outcome::Fails && c.why.contains(word), "{word}: {c:?}");
    }
}

#[test]
fn what_is_black_because_it_is_rare_is_not_called_wrong() {
    // One path in a million collides.
    let c = cell("thin-fog", |_, _, _| ());
    assert!(c.outcome == Outcome::NoVerdict && c.error == Some(-1.0) && c.why.contains("too rare"), "{c:?}");
}

#[test]
fn all_cases_can_be_built_in_all_units() {
    let mut names: Vec<_> = Case::all().map(|c| c.name).collect();
    assert!(names.len() >= 20);
    for case in Case::all() {
        for length in [1.0, 2f64.powi(20), 2f64.powi(-20)] {
            let scene = case.scene(Units { length, light: 1.0 }).unwrap_or_else(|e| panic!("{}: {e}", case.name));
            assert!(scene.emitters().shine() || scene.media_emit(), "{}", case.name);
        }
        assert!(case.truth(2).is_none_or(|t| t.iter().all(|x| x.is_finite() && *x >= 0.0)), "{}", case.name);
    }
    names.dedup();
    assert_eq!(names.len(), Case::all().count());
}

#[test]
fn the_table_is_what_its_columns_say() {
    let cells = [cell("grazing", |_, _, _| ())];
    let text = csv(&cells);
    let lines: Vec<_> = text.lines().collect();
    assert!(lines.len() == 2 && lines[0].starts_with("method,case,outcome,passes,"), "{text}");
    assert!(lines[1].starts_with("harmed,grazing,holds,"), "{text}");
    let names = ["touching-balls", "deep-fog"].map(|n| Case::all().find(|c| c.name == n).unwrap().about);
    assert!(names.iter().all(|a| !a.is_empty()));
}
