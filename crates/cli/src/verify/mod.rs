//! `manylight verify`.

mod stability;

use crate::args::Verify;
use crate::failure::Failure;
use crate::output::say;
use manylight_recipes::{COMPOSED, MethodInfo, build, compositions, covering, method, methods};
use manylight_scene::Scene;
use manylight_scene_io::{LoadOptions, load};
use manylight_verify::{Built, Effort, Knobs, Outcome, Place, Report, Subject, Verifier};

/// A method of the registry with parameters.
pub struct Registered {
    info: &'static MethodInfo,
    parameters: Vec<(String, String)>,
}

impl Registered {
    /// Can it be built in any of the places?
    fn somewhere(&self, places: &[Place]) -> Result<(), Failure> {
        let mut reason = String::new();
        for place in places {
            match self.build(&place.scene, &[]) {
                Ok(_) => return Ok(()),
                Err(e) => reason = e,
            }
        }
        Err(Failure::Mistake(reason))
    }
}

impl Subject for Registered {
    fn name(&self) -> String {
        let given: Vec<String> = self.parameters.iter().map(|(k, v)| format!("{k}={v}")).collect();
        if given.is_empty() { self.info.name.into() } else { format!("{}:{}", self.info.name, given.join(",")) }
    }
    fn build(&self, scene: &Scene, knobs: &Knobs) -> Result<Built, String> {
        let kept = self.parameters.iter().filter(|p| knobs.iter().all(|k| k.0 != p.0)).cloned();
        let all: Vec<_> = kept.chain(knobs.iter().map(|(k, v)| (k.to_string(), v.to_string()))).collect();
        let recipe = build(self.info.name, &all, scene).map_err(|e| e.to_string())?;
        Ok(Built { method: recipe.method, spp: recipe.spp })
    }
    fn is_path_tracer(&self) -> bool {
        self.info.name == "path"
    }
}

/// Verifies a method, or all of them.
pub fn run(args: &Verify) -> Result<(), Failure> {
    if args.stability {
        let chosen = match &args.method {
            Some(name) => Some(Registered { info: method(name)?, parameters: args.parameters.clone() }),
            None => None,
        };
        return stability::run(args, chosen);
    }
    let places = places(args)?;
    let subjects = match &args.method {
        Some(name) => vec![Registered { info: method(name)?, parameters: args.parameters.clone() }],
        None if args.compositions => composed(args.thorough)?,
        None => all(&places),
    };
    // What is wrong with a parameter is wrong everywhere.
    if let (Some(_), [subject]) = (&args.method, &subjects[..]) {
        subject.somewhere(&places)?;
    }
    let effort = match (args.sees, args.thorough, args.compositions) {
        (Some(percent), ..) => Effort::seeing(percent / 100.0),
        (_, true, _) => Effort::THOROUGH,
        // They are many, and their parts are looked at one by one elsewhere.
        (_, _, true) => Effort { work: Effort::QUICK.work / 3, ..Effort::QUICK },
        _ => Effort::QUICK,
    };
    let verifier = Verifier::new(places, effort, args.seed);
    let mut wrong = Vec::new();
    let mut silent = Vec::new();
    for subject in &subjects {
        let report = verifier.verify(subject)?;
        say(report.to_string().trim_end());
        match (report.fails(), report.says_something()) {
            (true, _) => wrong.push(subject.name()),
            (_, false) => silent.push(report),
            _ => {}
        }
    }
    conclude(subjects.len(), &wrong, &silent)
}

/// Each method as it is; those with a bound also without it, where they are to be unbiased, and those whose variance is infinite also
/// with one.
fn all(places: &[Place]) -> Vec<Registered> {
    let mut all = Vec::new();
    for info in methods() {
        let plain = Registered { info, parameters: Vec::new() };
        let finite = |p: &Place| plain.build(&p.scene, &[]).is_ok_and(|b| b.method.claim().finite_variance);
        let other = match info.params().find(|p| p.name == "bound") {
            Some(p) if p.default != "none" => Some("none"),
            Some(_) if !places.iter().any(finite) => Some("1"),
            _ => None,
        };
        all.push(plain);
        all.extend(other.map(|value| Registered { info, parameters: vec![("bound".into(), value.into())] }));
    }
    all
}

/// Compositions of parts in which every pair of parts stands, or all of them.
fn composed(whole: bool) -> Result<Vec<Registered>, Failure> {
    let sense: Vec<_> = compositions()?.into_iter().filter(|c| c.refused().is_none()).collect();
    let chosen = if whole { sense } else { covering(&sense) };
    let info = method(COMPOSED)?;
    Ok(chosen.iter().map(|c| Registered { info, parameters: c.parameters() }).collect())
}

fn places(args: &Verify) -> Result<Vec<Place>, Failure> {
    let Some(path) = &args.scene else { return Ok(Place::standard()?) };
    let options = LoadOptions { defines: args.defines.clone(), size: Some(args.size), filter: None };
    let loaded = load(path, &options).map_err(Failure::mistake)?;
    loaded.warnings.iter().for_each(|w| eprintln!("warning: {w}"));
    let name = path.file_stem().map_or("scene".into(), |n| n.to_string_lossy().into_owned());
    Ok(vec![Place::new(&name, loaded.scene)])
}

fn conclude(count: usize, wrong: &[String], silent: &[Report]) -> Result<(), Failure> {
    for report in silent {
        let why = report.findings.iter().find(|f| f.outcome != Outcome::Skipped).or(report.findings.first());
        let why = why.map_or("there is no place for it".into(), |f| f.detail.clone());
        say(format!("no verdict on {}: {why}", report.subject));
    }
    match wrong {
        [] => {
            say(format!("{} of {count} keep their claims, as far as could be seen", count - silent.len()));
            Ok(())
        }
        wrong => {
            Err(Failure::CheckFailed(format!("{} of {count} break their claims: {}", wrong.len(), wrong.join("; "))))
        }
    }
}
