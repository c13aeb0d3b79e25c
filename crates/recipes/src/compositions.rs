//! Every composition of the parts of `many-lights`, those that make no sense, and a few that cover all pairs.

use crate::RecipeError;
use crate::params::Kind;
use crate::registry::method;
use crate::values::Values;

/// The method whose parts are composed.
pub const COMPOSED: &str = "many-lights";

/// Parameters that choose a part.
const AXES: &[&str] = &["generator", "lights", "kernel", "bound", "compensation"];

/// Values that an axis has besides its words: a sum of generators, a number for a bound.
const MORE: &[(&str, &str)] = &[("generator", "keller+emitters"), ("bound", "1")];

/// Values of the parts, in the order of the axes: generator, light set, kernel, bound, compensation.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Composition(Vec<String>);

/// A row of the table of what makes no sense.
pub struct Refusal {
    /// Parameters with the values that do not go together: all of these at once.
    pub when: &'static [(&'static str, Is)],
    /// Why, and what to say instead.
    pub reason: &'static str,
}

/// What a parameter is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Is {
    /// This value.
    This(&'static str),
    /// Any other value.
    Not(&'static str),
}

/// What makes no sense: the only such table for the axes of a composition.
pub const REFUSED: &[Refusal] = &[Refusal {
    when: &[("kernel", Is::This("sphere")), ("compensation", Is::Not("none")), ("bound", Is::Not("none"))],
    reason: "no bound touches spheres, so that a compensation would bring what is not missing: say bound=none or kernel=point",
}];

impl Composition {
    /// As parameters of [`COMPOSED`].
    pub fn parameters(&self) -> Vec<(String, String)> {
        AXES.iter().map(|a| a.to_string()).zip(self.0.iter().cloned()).collect()
    }
    /// Why it makes no sense; `None`: it does.
    pub fn refused(&self) -> Option<&'static str> {
        refused(|axis| AXES.iter().position(|a| *a == axis).map(|i| self.0[i].as_str()))
    }
}

fn refused<'v>(value: impl Fn(&str) -> Option<&'v str>) -> Option<&'static str> {
    let holds = |&(name, is): &(&str, Is)| match (value(name), is) {
        (Some(v), Is::This(w)) => v == w,
        (Some(v), Is::Not(w)) => v != w,
        (None, _) => false,
    };
    REFUSED.iter().find(|r| r.when.iter().all(holds)).map(|r| r.reason)
}

/// Refuses what the table refuses.
pub(crate) fn check(v: &Values) -> Result<(), RecipeError> {
    refused(|name| Some(v.text(name))).map_or(Ok(()), |reason| Err(RecipeError::Contrary(reason.into())))
}

/// Every composition, whether it makes sense or not: as many as the product of the axes' values.
pub fn compositions() -> Result<Vec<Composition>, RecipeError> {
    let info = method(COMPOSED)?;
    let mut all = vec![Composition(Vec::new())];
    for axis in AXES {
        let param = info.params().find(|p| p.name == *axis);
        let words: &[&str] = match param.map(|p| p.kind) {
            Some(Kind::Choice(words) | Kind::Sum(words) | Kind::NumberOr(words)) => words,
            _ => &[],
        };
        let more = MORE.iter().filter(|m| m.0 == *axis).map(|m| m.1);
        let values: Vec<&str> = words.iter().copied().chain(more).collect();
        let longer = |c: &Composition| {
            let one = |v: &&str| Composition(c.0.iter().cloned().chain([v.to_string()]).collect());
            values.iter().map(one).collect::<Vec<_>>()
        };
        all = all.iter().flat_map(longer).collect();
    }
    Ok(all)
}

/// A few of these compositions in which every pair of values stands that stands in any of them (greedily, the first of equals).
pub fn covering(all: &[Composition]) -> Vec<Composition> {
    type Pair = ((usize, String), (usize, String));
    let pairs = |c: &Composition| -> Vec<Pair> {
        let n = c.0.len();
        let both = (0..n).flat_map(|i| (i + 1..n).map(move |j| (i, j)));
        both.map(|(i, j)| ((i, c.0[i].clone()), (j, c.0[j].clone()))).collect()
    };
    let every: Vec<(usize, Vec<Pair>)> = all.iter().map(pairs).enumerate().collect();
    let mut open: std::collections::BTreeSet<&Pair> = every.iter().flat_map(|e| &e.1).collect();
    let mut chosen = Vec::new();
    while !open.is_empty() {
        let count = |e: &&(usize, Vec<Pair>)| e.1.iter().filter(|p| open.contains(p)).count();
        // `max_by_key` takes the last of equals.
        let Some((at, own)) = every.iter().rev().max_by_key(count) else { break };
        own.iter().for_each(|p| {
            open.remove(p);
        });
        chosen.push(all[*at].clone());
    }
    chosen
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::build;
    use manylight_math::DAffine3;
    use manylight_scene::{Camera, Scene};

    fn nowhere() -> Scene {
        let mut b = Scene::builder();
        b.camera(Camera::perspective(DAffine3::IDENTITY, 45.0, (1, 1)).unwrap());
        b.build().unwrap()
    }
    #[test]
    fn what_the_table_refuses_is_refused_with_its_reason_and_everything_else_is_built() {
        let (all, scene) = (compositions().unwrap(), nowhere());
        assert!(all.len() >= 6 * 5 * 2 * 4 * 4, "{}", all.len());
        let mut refused = 0;
        for c in &all {
            let built = build(COMPOSED, &c.parameters(), &scene).map(|_| ());
            let expected = c.refused().map_or(Ok(()), |r| Err(RecipeError::Contrary(r.into())));
            refused += usize::from(expected.is_err());
            assert_eq!(built, expected, "{c:?}");
        }
        assert!(refused > 0 && refused * 2 < all.len(), "{refused} of {}", all.len());
    }
    #[test]
    fn every_row_of_the_table_refuses_something_and_names_what_there_is() {
        let all = compositions().unwrap();
        for r in REFUSED {
            assert!(all.iter().any(|c| c.refused() == Some(r.reason)), "{}", r.reason);
            assert!(r.when.iter().all(|w| AXES.contains(&w.0)), "{}", r.reason);
        }
    }
    #[test]
    fn all_pairs_that_occur_are_covered_by_a_few() {
        let all: Vec<_> = compositions().unwrap().into_iter().filter(|c| c.refused().is_none()).collect();
        let few = covering(&all);
        assert!(few.len() < all.len() / 10, "{} of {}", few.len(), all.len());
        for c in &all {
            for (i, j) in (0..AXES.len()).flat_map(|i| (0..i).map(move |j| (i, j))) {
                assert!(few.iter().any(|f| f.0[i] == c.0[i] && f.0[j] == c.0[j]), "{c:?}");
            }
        }
    }
}
